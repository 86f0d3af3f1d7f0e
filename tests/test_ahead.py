"""The second process that compiles kernels: those that are called, and never to anyone's harm."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from radiosity import ahead
from radiosity.form_factors.ahead import DIRECT_LIGHT, compile_direct_light
from radiosity.solvers.ahead import BOUNCES, compile_bounces

ROOT = Path(__file__).resolve().parents[1]

WHAT_IS_COMPILED = """
from numba.core.event import Listener, install_listener
import radiosity as rad

class Names(Listener):
    def on_start(self, event):
        print(event.data["dispatcher"].py_func.__name__)

    def on_end(self, event):
        pass

with install_listener("numba:compile", Names()):
    rad.solve(rad.scenes.cornell_box(), patch_count=5000, estimator=rad.MonteCarlo(64))
"""


@pytest.fixture
def first_run(monkeypatch):
    """As on a machine where nothing is compiled yet."""
    monkeypatch.setattr(ahead, "thread_count", lambda: 2)
    monkeypatch.setattr(ahead.Ahead, "found", lambda _: False)
    return monkeypatch


@pytest.mark.parametrize("program", ["raise SystemExit(3)", "import os; os.abort()", "no python"])
@pytest.mark.usefixtures("first_run")
def test_a_second_process_that_fails_changes_nothing(program):
    work = ahead.Ahead("no.module", "function", None, program)
    work.begin()
    process = work.process
    work.ready()
    assert process.returncode != 0
    assert work.process is None
    work.begin()
    assert work.process is None, "once in the life of a process"


def test_a_second_process_that_hangs_is_ended(first_run):
    first_run.setattr(ahead, "SECONDS", 0.1)
    work = ahead.Ahead("no.module", "function", None, "import time; time.sleep(600)")
    work.begin()
    process = work.process
    work.ready()
    assert process.returncode not in (None, 0)


@pytest.mark.parametrize(
    ("owner", "name", "value"), [(ahead, "thread_count", lambda: 1), (ahead.Ahead, "found", lambda _: True)]
)
def test_none_is_started_without_need(first_run, owner, name, value):
    first_run.setattr(owner, name, value)
    work = ahead.Ahead("no.module", "function", None)
    work.begin()
    assert work.process is None


@pytest.mark.parametrize("function", [compile_direct_light, compile_bounces])
def test_what_is_to_be_compiled_can_be_called(function):
    function()


@pytest.mark.long
def test_what_is_compiled_ahead_is_what_is_called(tmp_path):
    place = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    for work in (DIRECT_LIGHT, BOUNCES):
        command = [sys.executable, "-c", ahead.PROGRAM, str(ROOT), work.module, work.function]
        subprocess.run(command, env=place, check=True)
    ran = subprocess.run(
        [sys.executable, "-c", WHAT_IS_COMPILED], env=place, cwd=ROOT, capture_output=True, text=True, check=True
    )
    compiled = set(ran.stdout.split())
    assert {"starts", "_find_patches"} <= compiled, "the listener listens"
    late = {"apart_rows", "frames_of", "_collect", "_merge"} | {"_rows_times_columns", "_union", "_norms"}
    assert not late & compiled
