"""A machine that cannot draw is told what to install; it never crashes."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from radiosity.errors import DisplayError
from radiosity.viewer import probe


@pytest.fixture(autouse=True)
def _forget() -> Iterator[None]:
    for answer in (probe._drawn, probe._begun):
        answer.cache_clear()
    yield
    for answer in (probe._drawn, probe._begun):
        answer.cache_clear()


@pytest.mark.usefixtures("gl")
def test_a_picture_is_really_drawn() -> None:
    run = probe._drawn("off-screen", None)
    assert run is not None
    assert run.returncode == 0, run.stderr
    assert "OpenGL" in run.stdout


def test_a_crash_of_the_graphics_library_is_a_message(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(probe, "DRAW", "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)")
    assert not probe.can_draw()
    with pytest.raises(DisplayError, match=r"ended by signal 11.*apt-get install libgl1 libegl1 libgl1-mesa-dri"):
        probe.require()


def test_a_missing_library_is_quoted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(probe, "DRAW", "raise ImportError('libGL.so.1: cannot open shared object file')")
    with pytest.raises(DisplayError, match=r"exit code 1.*libGL\.so\.1.*Install the GL libraries"):
        probe.require()


def test_wrong_colours_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(probe, "DRAW", "import sys; sys.exit(3)")
    with pytest.raises(DisplayError, match="wrong colours"):
        probe.require()


def test_a_display_that_hangs_does_not_hang_us(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(probe, "DRAW", "import time; time.sleep(60)")
    monkeypatch.setattr(probe, "SECONDS", 0.5)
    with pytest.raises(DisplayError, match="did not end"):
        probe.require()


def test_the_answer_is_kept(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """One process, however often and early one asks."""
    runs = tmp_path / "runs"
    monkeypatch.setattr(probe, "DRAW", f"open({str(runs)!r}, 'a').write('x'); print('llvmpipe')")
    probe.begin()
    probe.require()
    probe.require()
    assert runs.read_text() == "x"
    assert probe.smoothing_samples("off-screen") == 4


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="these systems always have a screen")
def test_no_display_leads_to_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(DisplayError, match=r"DISPLAY is not set.*--screenshot FILE"):
        probe.require("window")


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="these systems always have a screen")
@pytest.mark.usefixtures("gl")
def test_a_dead_display_is_not_mistaken_for_a_window(monkeypatch: pytest.MonkeyPatch) -> None:
    """VTK would draw into memory, and wait for ever for keys that nobody can press."""
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setenv("DISPLAY", ":6543")
    with pytest.raises(DisplayError, match=r"':6543' cannot be reached"):
        probe.require("window")
