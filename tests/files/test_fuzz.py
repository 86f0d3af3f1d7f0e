"""Thousands of damaged files of each format: a scene, or an error with the file's name; in bounded time and memory.

The mutants are those of `tests.files.fuzz`; each is made again by its format and number. They are read in a process of
their own, so that a crash is seen, under a limit of memory.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from .fuzz import FORMATS, MUTATIONS, inside, must_show, mutant, seeds

ROOT = Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits and reads its memory as Linux does")


def read_mutants(form, count, *more):
    words = [sys.executable, "-m", "tests.files.fuzz", form, str(count), *more]
    run = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, timeout=3600)
    assert run.returncode == 0, run.stderr[-2000:]
    assert run.stderr == ""
    return [json.loads(line) for line in run.stdout.splitlines()]


def check(reports, count):
    for report in reports:
        assert report["trouble"] == [], report
        assert report["mutants"] == sum(report["tally"].values()) == count
        assert report["tally"]["refused"] > 0.4 * count, "the mutator does too little"
        assert report["slowest"] < 5


@pytest.mark.slow
def test_two_hundred_mutants_of_each_format():
    reports = read_mutants("all", 200)
    assert [report["format"] for report in reports] == list(FORMATS)
    check(reports, 200)


@pytest.mark.long
@pytest.mark.parametrize("form", FORMATS)
def test_five_thousand_mutants(form):
    check(read_mutants(form, 5000, "deep"), 5000)


@pytest.mark.parametrize("form", FORMATS[:-1])
def test_the_mutator_is_seeded_and_does_every_kind_of_damage(form):
    whole = seeds(form)
    first, again = ([mutant(form, k, whole)[1:] for k in range(300)] for _ in range(2))
    assert first == again
    assert {word for _, done in first for word in done.split(": ")[1].split(" + ")} >= {m.__name__ for m in MUTATIONS}
    changed = [k for k in range(300) if mutant(form, k, whole)[0] != first[k][0]]
    assert len(changed) == 300


def test_what_must_show_is_judged_by_size():
    """The control of the tests above: a reader that took cut files would be caught."""
    (ply, *_) = seeds("PLY")
    cut = {"scene.ply": ply["scene.ply"][:-30]}
    assert must_show("PLY", ply, cut, "scene.ply: cut")
    glb = seeds("GLB")[0]
    assert must_show("GLB", glb, {"scene.glb": glb["scene.glb"][:-8]}, "scene.glb: cut")
    assert not must_show("GLB", glb, glb, "scene.glb: flip")


def test_archives_are_damaged_behind_their_checksums():
    whole = seeds("NPZ")[0]["a.npz"]
    content = bytearray(whole)
    inside(content, np.random.default_rng(0))
    assert content != whole
    assert content[:4] == b"PK\x03\x04"
