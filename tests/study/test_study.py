"""A study from end to end: shuffled, kept run by run, gone on with, and written down."""

from __future__ import annotations

import csv
import json
import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import FileFormatError, ParameterError
from radiosity.study import study as module
from radiosity.study.families import SCENE_FAMILIES, by_parameter
from radiosity.study.ledger import Ledger
from radiosity.study.memory import PeakMemory
from radiosity.study.methods import methods
from radiosity.study.outputs import findings, write
from radiosity.study.plots import SOLVERS
from radiosity.study.reference import Effort
from radiosity.study.solving import run_method
from radiosity.study.study import Settings, run_study
from radiosity.study.subject import by_patches

TINY = Settings(repeats=2, few=True, effort=Effort(rays=512, replicates=2, factor=2, paths=16))


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A small study of a room with boxes, and where it is."""
    folder = tmp_path_factory.mktemp("study")
    subjects = by_patches(rad.scenes.cornell_box(), (40, 90))
    return run_study("cornell_box", subjects, TINY, folder), folder


def test_every_method_is_run_as_often_as_asked_and_judged(made):
    study, _ = made
    records = study.records
    kinds = {(record["subject"], record["family"], record["budget"]) for record in records}
    assert len(records) == 2 * len(kinds)
    assert {family for _, family, _ in kinds} == {
        "apart", "sobol", "random", "hemicube", "hemicube points", "walks", "continuous walks"
    }  # fmt: skip
    for record in records:
        assert 0.0 < record["sampling_l2"] < 2.0
        assert record["seconds"] >= record["factor_seconds"] + record["solve_seconds"] - 1e-3
        if not record["family"].endswith("walks"):
            assert record["bytes_predicted"] == pytest.approx(record["bytes_matrix"], rel=0.2)
        assert len(record["sampling_by_order"]) == 8
    worst = {record["family"]: record["sampling_l2"] for record in records if record["budget"] == "1024 rays"}
    assert worst["apart"] < 0.5 * worst["sobol"] < worst["random"]


@pytest.mark.parametrize(
    ("scene", "count", "special"),
    [
        (rad.scenes.cornell_box(), 100, set()),
        (rad.scenes.cornell_box(), 1000, {"two levels"}),
        (rad.scenes.open_rug(), 100, {"analytic"}),
        (rad.scenes.open_rug(), 1000, {"analytic", "two levels"}),
    ],
)
def test_methods_are_compared_where_they_fit(scene, count, special):
    found = {method.family for method in methods(rad.subdivide(scene, patch_count=count))}
    assert found & {"analytic", "two levels"} == special
    assert len(found - special) == 7


def test_runs_are_shuffled(made):
    families = [record["family"] for record in made[0].records]
    changes = sum(a != b for a, b in pairwise(families))
    assert changes > len(families) / 2


def test_a_seed_gives_the_same_errors_again(made):
    study, _ = made
    record = next(
        r
        for r in study.records
        if r["family"] == "apart" and r["seed"] == 1 and r["subject"] == study.subjects[-1].name
    )
    patches = study.subjects[-1].patches
    light, _ = run_method(patches, rad.MonteCarlo(record["work"], 1))
    again = module.judged(light, study.references[-1], patches.area)
    assert again["total_l2"] == record["total_l2"]


def test_bounces_and_solvers_end_at_their_own_truth(made):
    bounces = {(r["bounces"], r["tail"]): r["truncation"] for r in made[0].ledger.of("bounces")}
    assert bounces[0, False] == 1.0
    assert bounces[24, False] < 1e-3 * bounces[2, False]
    assert bounces[4, True] < 0.5 * bounces[4, False]
    tight = [r for r in made[0].ledger.of("solvers") if r["rtol"] == 1e-8]
    assert {r["solver"] for r in tight} == set(SOLVERS)
    assert all(r["converged"] and r["algebra"] < 1e-6 for r in tight)


def test_going_on_does_only_what_is_missing(made, monkeypatch):
    study, folder = made
    kept = (folder / "runs.jsonl").read_bytes()
    lines = kept.splitlines(keepends=True)
    (folder / "runs.jsonl").write_bytes(b"".join(lines[:-3]) + lines[-3][:20])  # stopped while writing
    calls = []
    monkeypatch.setattr(module, "run_method", lambda *args: calls.append(args) or run_method(*args))
    monkeypatch.setattr(module, "_warm", lambda *_: None)
    monkeypatch.setattr(module, "reference", lambda *_: pytest.fail("worked out again"))
    again = run_study("cornell_box", study.subjects, TINY, folder)
    assert set(again.ledger.records) == set(study.ledger.records)
    assert len((folder / "runs.jsonl").read_bytes().splitlines()) == len(lines)
    assert len(calls) <= 3


def test_an_interrupt_keeps_what_is_done(tmp_path):
    def interrupt(stage, done, _total):
        if stage == "runs" and done == 3:
            raise KeyboardInterrupt

    subjects = by_patches(rad.scenes.furnace(), (24,))
    with pytest.raises(KeyboardInterrupt):
        run_study("furnace", subjects, replace(TINY, parts=("methods",)), tmp_path, interrupt)
    kept = [line for line in (tmp_path / "runs.jsonl").read_text().splitlines() if '"methods"' in line]
    assert len(kept) == 3


def test_another_origin_is_not_mixed_in(tmp_path):
    Ledger(tmp_path / "runs.jsonl", {"title": "a", "numpy": "1"}).add("x", {"part": "methods"})
    assert "x" in Ledger(tmp_path / "runs.jsonl", {"title": "a", "numpy": "1"})
    with pytest.raises(FileFormatError, match=r"numpy = '1', now it is '2'"):
        Ledger(tmp_path / "runs.jsonl", {"title": "a", "numpy": "2"})
    (tmp_path / "runs.jsonl").write_text("no ledger\n")
    with pytest.raises(FileFormatError, match="no runs of a study"):
        Ledger(tmp_path / "runs.jsonl", {})


def test_a_scene_without_light_is_refused(tmp_path):
    with pytest.raises(ParameterError, match="no light"):
        run_study("dark", by_patches(rad.scenes.furnace(emission=0.0), (24,)), TINY, tmp_path)


@pytest.mark.slow
def test_what_is_written_is_whole_and_says_the_same(made):
    study, folder = made
    found = findings(study)
    names = {path.name for path in write(found, folder)}
    assert {"report.html", "study.json", "methods.csv", "error_against_time.svg", "error_against_time.png"} <= names
    text = json.loads((folder / "study.json").read_text())
    with (folder / "methods.csv").open() as file:
        table = list(csv.DictReader(file))
    assert [float(row["total_l2"]) for row in table] == [row["total_l2"] for row in text["tables"]["methods"]]
    assert text["origin"]["radiosity"] == rad.__version__
    page = (folder / "report.html").read_text()
    assert page.count("<svg") == len([name for name in names if name.endswith(".svg")])
    assert not re.search(r'(src|href)="(?!#)', page.replace("xlink:href", "").replace("xmlns:xlink", ""))
    assert all(sentence.split(":")[0] in page for sentence in found.sentences)


def test_peak_memory_is_that_of_the_work():
    with PeakMemory() as memory:
        block = np.ones(8_000_000)
        del block
    assert memory.bytes is None or 60e6 < memory.bytes < 75e6


@pytest.mark.parametrize("name", SCENE_FAMILIES)
def test_families_are_lit_scenes_along_one_parameter(name):
    subjects = by_parameter(name)
    values = [subject.value for subject in subjects]
    assert values == sorted(values, reverse=values[0] > values[-1])
    assert len({subject.fingerprint for subject in subjects}) == len(values) >= 5
    for subject in subjects:
        assert (subject.patches.emission > 0).any()
        assert len(subject.patches) < 2000
        assert subject.patches.closed == (name != "singularity")


def test_blockers_keep_their_share_of_the_room():
    for subject in by_parameter("occlusion"):
        blockers = [name.startswith("blocker") for name in subject.patches.surface_names]
        area = subject.patches.area[np.array(blockers)[subject.patches.surface]].sum()
        assert area == pytest.approx(2 * 4.0)  # both sides of a quarter of 16 m²
        assert sum(blockers) == subject.value
