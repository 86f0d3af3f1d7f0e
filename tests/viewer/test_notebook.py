"""`show` in a notebook shows the page there; in a plain Python, or IPython in a terminal, it opens a window."""

import sys
import types
from pathlib import Path

import pytest

import radiosity as rad
from radiosity.viewer import notebook, window
from tests.viewer.browser import Browser, needs_browser


def pretend(monkeypatch: pytest.MonkeyPatch, shell: object) -> list[dict]:
    """IPython is loaded, with a shell; what it is asked to show."""
    shown: list[dict] = []
    ipython, display = types.ModuleType("IPython"), types.ModuleType("IPython.display")
    ipython.get_ipython = lambda: shell  # type: ignore[attr-defined]
    display.display = lambda bundle, raw: shown.append(bundle) if raw else None  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    return shown


def test_in_a_notebook_the_page_is_shown_there(solution: rad.Solution, monkeypatch: pytest.MonkeyPatch) -> None:
    shown = pretend(monkeypatch, types.SimpleNamespace(kernel=object()))
    solution.show(order=2, wrong=False, height=500)
    (bundle,) = shown
    assert bundle["text/plain"].startswith(f"cornell_box: {len(solution.patches)} patches; cut at 6 bounces")
    assert bundle["text/html"].startswith("<iframe srcdoc=")
    assert "height: 500px" in bundle["text/html"]


@pytest.mark.parametrize("shell", [None, types.SimpleNamespace()])
def test_elsewhere_a_window_opens(solution: rad.Solution, monkeypatch: pytest.MonkeyPatch, shell: object) -> None:
    shown = pretend(monkeypatch, shell)
    opened = []
    monkeypatch.setattr(window, "view", lambda *args, **settings: opened.append((args, settings)))
    solution.show(order=2)
    assert opened == [((solution,), {"order": 2})]
    assert shown == []


def test_without_ipython_there_is_no_notebook(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "IPython", raising=False)
    assert not notebook.in_notebook()
    assert "IPython" not in sys.modules


def test_kernels_of_notebooks_have_a_kernel_and_terminals_have_none() -> None:
    """What `in_notebook` goes by, where IPython and its kernel are installed."""
    terminal = pytest.importorskip("IPython.terminal.interactiveshell", reason="IPython is not installed")
    kernel = pytest.importorskip("ipykernel.zmqshell", reason="ipykernel is not installed")
    assert "kernel" in kernel.ZMQInteractiveShell.class_trait_names()
    assert not hasattr(terminal.TerminalInteractiveShell, "kernel")


@needs_browser
def test_the_page_lives_inside_another_page(solution: rad.Solution, tmp_path: Path) -> None:
    """Closed off from it, and drawing: its picture has the red and the green of the walls."""
    file = tmp_path / "notebook.html"
    inside = notebook.frame(solution, 620, wrong=False, order=6)
    file.write_text(f"<!doctype html><body style='margin:0'>{inside}</body>", encoding="utf-8")
    browser = Browser(tmp_path / "chromium")
    try:
        browser.size(1000, 640)
        browser.open(file)
        for _ in range(40):
            browser.run("new Promise((done) => setTimeout(done, 100))")
            image = browser.image().astype(int)
            red, green = (image[..., c] - image[..., 1 - c] > 30 for c in (0, 1))
            if red.sum() > 2000 and green.sum() > 2000:
                break
        assert red.sum() > 2000
        assert green.sum() > 2000
        assert browser.run("document.querySelector('iframe').contentDocument") is None
        assert browser.complaints == []
    finally:
        browser.close()
