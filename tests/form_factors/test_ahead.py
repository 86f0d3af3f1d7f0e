"""The second process that compiles kernels: those that are called, and never to anyone's harm."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from radiosity.form_factors import ahead

ROOT = Path(__file__).resolve().parents[2]

WHAT_IS_COMPILED = """
from numba.core.event import Listener, install_listener
import radiosity as rad

class Names(Listener):
    def on_start(self, event):
        print(event.data["dispatcher"].py_func.__name__)

    def on_end(self, event):
        pass

with install_listener("numba:compile", Names()):
    rad.form_factors(rad.subdivide(rad.scenes.cornell_box(), patch_count=300), rad.MonteCarlo(64))
"""


@pytest.fixture
def first_run(monkeypatch):
    """As on a machine where nothing is compiled yet."""
    for name, value in (("_begun", False), ("_found", lambda: False), ("_running", []), ("thread_count", lambda: 2)):
        monkeypatch.setattr(ahead, name, value)
    return monkeypatch


@pytest.mark.parametrize("program", ["raise SystemExit(3)", "import os; os.abort()", "no python"])
def test_a_second_process_that_fails_changes_nothing(first_run, program):
    first_run.setattr(ahead, "PROGRAM", program)
    ahead.begin()
    (process,) = ahead._running
    ahead.ready()
    assert process.returncode != 0
    assert ahead._running == []
    ahead.begin()
    assert ahead._running == [], "once in the life of a process"


def test_a_second_process_that_hangs_is_ended(first_run):
    first_run.setattr(ahead, "PROGRAM", "import time; time.sleep(600)")
    first_run.setattr(ahead, "SECONDS", 0.1)
    ahead.begin()
    (process,) = ahead._running
    ahead.ready()
    assert process.returncode not in (None, 0)


@pytest.mark.parametrize(("name", "value"), [("thread_count", lambda: 1), ("_found", lambda: True)])
def test_none_is_started_without_need(first_run, name, value):
    first_run.setattr(ahead, name, value)
    ahead.begin()
    assert ahead._running == []


@pytest.mark.long
def test_what_is_compiled_ahead_is_what_is_called(tmp_path):
    place = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    subprocess.run([sys.executable, "-c", ahead.PROGRAM, str(ROOT)], env=place, check=True)
    ran = subprocess.run(
        [sys.executable, "-c", WHAT_IS_COMPILED], env=place, cwd=ROOT, capture_output=True, text=True, check=True
    )
    compiled = set(ran.stdout.split())
    assert {"starts", "_find_patches"} <= compiled, "the listener listens"
    assert not {"apart_rows", "frames_of", "_collect", "_merge"} & compiled
