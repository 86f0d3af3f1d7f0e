"""An assembly that is interrupted, damaged or moved elsewhere gives the same bits in the end."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import CheckpointWarning, MissingFileError, ParameterError
from radiosity.form_factors import checkpoint, monte_carlo

from .test_workers import InTheSameProcess, room, same_bits

METHOD = rad.MonteCarlo(64, 5, replicates=2)


@pytest.fixture(autouse=True)
def _small_blocks(monkeypatch):
    monkeypatch.setattr(checkpoint, "RAYS", 1 << 11)  # 64 rows a file
    monkeypatch.setattr(monte_carlo, "BATCH", 1 << 10)


@pytest.fixture(scope="module")
def patches():
    return room(600)


@pytest.fixture(scope="module")
def whole(patches):
    return rad.form_factors(patches, METHOD, threads=1)


def files(folder):
    return sorted(folder.glob("*/rows-*"))


def stop_after(rows):
    def tell(_stage, done, _total):
        if done >= rows:
            raise KeyboardInterrupt

    return tell


def counted(monkeypatch):
    """Rows that are made from now on."""
    made = []
    make = monte_carlo.MonteCarloRows.__call__
    monkeypatch.setattr(
        monte_carlo.MonteCarloRows, "__call__", lambda self, span: (made.append(span[1] - span[0]), make(self, span))[1]
    )
    return made


def test_interrupted_and_resumed(patches, whole, tmp_path, monkeypatch):
    folder = tmp_path / "rows"
    with pytest.raises(KeyboardInterrupt):
        rad.form_factors(patches, METHOD, checkpoint=folder, progress=stop_after(300))
    kept = files(folder)
    assert 300 // 64 <= len(kept) <= 300 // 64 + 2
    made = counted(monkeypatch)
    assert same_bits(rad.form_factors(patches, METHOD, checkpoint=folder, threads=1), whole)
    assert sum(made) == 2 * len(patches) - 64 * len(kept), "only what was missing"
    assert not list(folder.rglob(".*")), "nothing half-written"
    made.clear()
    assert same_bits(rad.form_factors(patches, METHOD, checkpoint=folder), whole)
    assert made == []


@pytest.mark.parametrize("executor", [None, InTheSameProcess()], ids=["threads", "executor"])
def test_begun_by_one_engine_and_ended_by_another(patches, whole, tmp_path, executor, monkeypatch):
    with pytest.raises(KeyboardInterrupt):
        rad.form_factors(patches, METHOD, checkpoint=tmp_path / "rows", executor=executor, progress=stop_after(500))
    monkeypatch.setattr(monte_carlo, "BATCH", 1 << 12)
    other = InTheSameProcess() if executor is None else None
    assert same_bits(rad.form_factors(patches, METHOD, checkpoint=tmp_path / "rows", executor=other, threads=2), whole)


def damage(content, how):
    """A file that a bad disk, a full one, or a careless hand has left."""
    middle = len(content) // 2
    return {
        "empty": b"",
        "cut": content[:middle],
        "longer": content + b"\0",
        "one bit": content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :],
        "zeros": content[:middle] + bytes(len(content) - middle),
        "text": b"not a block of rows\n" * 100,
    }[how]


@pytest.mark.parametrize("how", ["empty", "cut", "longer", "one bit", "zeros", "text"])
def test_damaged_rows_are_noticed_and_made_again(patches, whole, tmp_path, how):
    rad.form_factors(patches, METHOD, checkpoint=tmp_path)
    path = files(tmp_path)[3]
    good = path.read_bytes()
    path.write_bytes(damage(good, how))
    with pytest.warns(CheckpointWarning, match=f"{path.name} is damaged"):
        assert same_bits(rad.form_factors(patches, METHOD, checkpoint=tmp_path), whole)
    assert path.read_bytes() == good


def test_rows_of_another_assembly_are_not_taken(patches, whole, tmp_path):
    """Moved by hand into the place of others: whole, and still not these."""
    rad.form_factors(patches, METHOD, checkpoint=tmp_path / "mine")
    rad.form_factors(patches, rad.MonteCarlo(64, 6, replicates=2), checkpoint=tmp_path / "other")
    mine, other = files(tmp_path / "mine"), files(tmp_path / "other")
    assert [path.name for path in mine] == [path.name for path in other]
    mine[2].write_bytes(other[2].read_bytes())
    mine[4].write_bytes(mine[5].read_bytes())
    with pytest.warns(CheckpointWarning) as told:
        assert same_bits(rad.form_factors(patches, METHOD, checkpoint=tmp_path / "mine"), whole)
    assert len(told) == 2
    assert all("of another assembly" in str(one.message) for one in told)


def test_what_rows_depend_on_has_a_folder_of_its_own(patches, tmp_path):
    """Patches, which of them emit, estimator, type; not how strongly they emit, nor the paint."""

    def count(which, method=METHOD, dtype=np.float32):
        rad.form_factors(which, method, dtype=dtype, checkpoint=tmp_path)
        return len(list(tmp_path.iterdir()))

    assert count(patches) == 1
    assert count(replace(patches, emission=2 * patches.emission, reflectance=0.5 * patches.reflectance)) == 1
    assert count(patches, dtype=np.float64) == 2
    assert count(patches, rad.MonteCarlo(64, 6, replicates=2)) == 3
    assert count(replace(patches, emission=0 * patches.emission)) == 4
    assert count(room(300)) == 5


def test_a_folder_that_cannot_be_is_refused_before_any_work(patches, tmp_path, monkeypatch):
    made = counted(monkeypatch)
    (tmp_path / "file").write_text("")
    with pytest.raises(ParameterError, match="is a file"):
        rad.form_factors(patches, checkpoint=tmp_path / "file")
    with pytest.raises(MissingFileError, match="there is no folder"):
        rad.form_factors(patches, checkpoint=tmp_path / "no" / "such")
    assert made == []


def test_a_full_disk_says_what_is_kept(patches, tmp_path, monkeypatch):
    write = checkpoint.write_bytes

    def full(path, content):
        if path.name.startswith("rows") and len(files(tmp_path)) >= 3:
            raise OSError(28, "No space left on device")
        write(path, content)

    monkeypatch.setattr(checkpoint, "write_bytes", full)
    with pytest.raises(OSError, match="No space left on device; the blocks before it are kept") as error:
        rad.form_factors(patches, METHOD, checkpoint=tmp_path)
    assert "rows-0-192-256" in str(error.value)
    assert len(files(tmp_path)) == 3


@pytest.mark.slow
def test_ctrl_c_on_the_command_line_says_how_to_go_on(tmp_path, monkeypatch):
    """A signal while form factors are computed; what was finished by then is not computed again."""
    code = (
        "import sys, time\n"
        "from radiosity.form_factors import checkpoint, monte_carlo\n"
        "checkpoint.RAYS, monte_carlo.BATCH = 1 << 12, 1 << 10\n"
        "make = monte_carlo.MonteCarloRows.__call__\n"
        "monte_carlo.MonteCarloRows.__call__ = lambda self, span: (time.sleep(0.02), make(self, span))[1]\n"
        "from radiosity.cli import main\n"
        "sys.exit(main(sys.argv[1:]))\n"
    )
    arguments = ["solve", "cornell_box", "--patches", "500", "--rays", "128", "--checkpoint", "rows", "--quiet"]
    command = [sys.executable, "-c", code, *arguments]
    run = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True, env=os.environ)
    deadline = time.monotonic() + 100
    while len(files(tmp_path / "rows")) < 3 and time.monotonic() < deadline:
        time.sleep(0.01)
    run.send_signal(signal.SIGINT)
    _, told = run.communicate(timeout=30)
    assert run.returncode == 130
    assert "kept in rows: the same command goes on from there" in " ".join(told.split())
    assert not list((tmp_path / "rows").rglob(".*")), "nothing half-written"
    monkeypatch.setattr(checkpoint, "RAYS", 1 << 12)
    kept = len(files(tmp_path / "rows"))
    assert 3 <= kept < 2 * 8
    made = counted(monkeypatch)
    patches = room(500)
    rad.form_factors(patches, rad.MonteCarlo(128, replicates=2), checkpoint=tmp_path / "rows")
    assert sum(made) == 2 * len(patches) - 64 * kept
