"""Cases come out as expected, a broken package makes them fail, and users can write their own."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest

from radiosity.cli import main
from radiosity.errors import MissingFileError, ParameterError
from radiosity.solvers.elimination import eliminate
from radiosity.study.stress import albedo, case, truth
from radiosity.study.stress.curves import curve, exact
from radiosity.study.stress.runner import built_in, cases_of, chosen
from radiosity.study.stress.systems import all_alike, lamp, light_in_a_sphere, operator

QUICK = ("furnace", "checkerboard", "closed and lit", "speck", "plates 5e-6", "one patch", "1e-30 in the next")
CASES = built_in()

OWN = """
from radiosity.study.stress import case, truth, within

@case("one and one", expected="2 within 1e-12")
def sum_of_two():
    return within(1 + 1, 2.0, 1e-12)

more = [truth_case for truth_case in (case("named", "so")(lambda: truth(True, "it is")),)]
"""
FAILING = """
from radiosity.study.stress import case, within

@case("one and one", expected="3")
def sum_of_two():
    return within(1 + 1, 3.0, 1e-12)

@case("a slip", expected="no error")
def slip():
    return 1 / 0
"""


@pytest.mark.parametrize("one", [c for c in CASES if c.group == "poison"], ids=lambda c: c.name)
def test_poison_is_refused(one):
    outcome = one.run()
    assert outcome.good, outcome


@pytest.mark.parametrize(
    "one", [c for c in CASES if c.name.startswith(QUICK) and "leaks" not in c.name], ids=lambda c: c.name
)
def test_quick_cases_come_out_as_expected(one):
    outcome = one.run()
    assert outcome.good, outcome


@pytest.mark.long
@pytest.mark.parametrize("one", [c for c in CASES if c.group != "poison"], ids=lambda c: c.name)
def test_all_others_do_too(one):
    outcome = one.run()
    assert outcome.good, outcome


def test_names_are_unique():
    assert len({c.name for c in CASES}) == len(CASES) > 80


def test_an_absorptance_formed_by_subtraction_fails_its_case(monkeypatch):
    """What is tempting and wrong: 1 - ρ from a ρ that was rounded has lost the fifth digit of 1e-12."""
    (stiffest,) = [c for c in CASES if c.name == "furnace, α = 1e-12"]
    assert stiffest.run().good
    monkeypatch.setattr(albedo, "operator", lambda factors, absorptance: operator(factors, reflectance=1 - absorptance))
    outcome = stiffest.run()
    assert outcome.verdict == "FAILED"
    assert float(outcome.got.split()[2]) == pytest.approx(2.2e-5, rel=0.1)


def test_a_case_that_breaks_is_one_that_failed():
    outcome = case("breaks", "nothing")(lambda: truth(1 / 0, "")).run()
    assert (outcome.verdict, outcome.got) == ("FAILED", "ZeroDivisionError: division by zero")


def test_own_cases_are_found_run_and_written(tmp_path, capsys):
    (tmp_path / "own.py").write_text(OWN)
    assert [c.name for c in cases_of(tmp_path / "own.py")] == ["one and one", "named"]
    out = [str(tmp_path / name) for name in ("a.csv", "a.json")]
    assert main(["stress", str(tmp_path / "own.py"), "-o", out[0], "-o", out[1]]) == 0
    assert "2 cases in 0 s, 0 not as expected" in capsys.readouterr().err
    with open(out[0]) as file:
        rows = list(csv.DictReader(file))
    assert [row["verdict"] for row in rows] == ["as expected"] * 2
    assert json.loads((tmp_path / "a.json").read_text())["cases"][1]["got"] == "it is"


def test_failing_cases_are_the_exit_code(tmp_path, capsys):
    (tmp_path / "failing.py").write_text(FAILING)
    assert main(["stress", str(tmp_path / "failing.py"), "-q"]) == 1
    told = capsys.readouterr()
    assert told.out.count("FAILED") == 2
    assert "ZeroDivisionError" in told.out


def test_no_cases_are_said_to_be_none(tmp_path, capsys):
    (tmp_path / "empty.py").write_text("x = 1\n")
    with pytest.raises(ParameterError, match="holds no case"):
        cases_of(tmp_path / "empty.py")
    with pytest.raises(MissingFileError, match=r"nowhere\.py"):
        cases_of("nowhere.py")
    with pytest.raises(ParameterError, match="no case has 'unheard-of'"):
        chosen(CASES, ["unheard-of"])
    assert main(["stress", "--list", "--only", "furnace", "1e-12"]) == 0
    assert capsys.readouterr().out == "albedo    furnace, α = 1e-12: B = E / α within 1e-9\n"


@pytest.mark.parametrize("alpha", [0.3, 1e-6, 1e-12])
def test_the_curves_truth_is_the_closed_form(alpha):
    factors, emission = all_alike(40), lamp(40)
    true = light_in_a_sphere(factors, np.full((40, 1), alpha), emission)
    found = exact(operator(factors, absorptance=alpha), emission[:, 0])
    np.testing.assert_allclose(found.astype(float), true[:, 0], rtol=1e-12)


def test_the_curves_truth_has_more_digits_than_elimination():
    T, emission = operator(all_alike(40), absorptance=1e-3), lamp(40)
    found = exact(T, emission[:, 0])
    ours = eliminate(T.matrix(0).toarray(), np.full(40, 1e-3)).solve(emission[:, 0])
    np.testing.assert_allclose(ours, found.astype(float), rtol=1e-14)


def test_curves_tell_solvers_from_those_that_stop_being_one():
    points = {(p.solver, p.absorptance): p for p in curve((1e-1, 1e-8))}
    easy = [p for p in points.values() if p.absorptance == 1e-1]
    assert all(p.claimed and p.error < 1e-7 for p in easy)
    for solver in ("ConjugateGradient", "Direct"):
        assert points[solver, 1e-8].error < 1e-9
    for solver in ("Neumann", "GaussSeidel", "Shooting"):
        assert not points[solver, 1e-8].claimed
        assert points[solver, 1e-8].error > 0.9
