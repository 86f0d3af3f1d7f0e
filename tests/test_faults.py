"""Processes that are killed, interrupted or run out of room while they save: the old file or the new one is left."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals and limits as POSIX has them")


def inject(count):
    words = [sys.executable, "-m", "tests.faults", str(count)]
    run = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, timeout=3000)
    assert run.returncode == 0, run.stderr
    report = json.loads(run.stdout)
    assert set(report["tally"]) == {"killed", "interrupted", "full"}, report
    assert sum(report["tally"].values()) == count
    assert min(report["tally"].values()) >= count // 3
    assert report["left"] == []


@pytest.mark.slow
def test_a_few_faults():
    inject(20)


@pytest.mark.long
def test_three_hundred_faults():
    inject(300)
