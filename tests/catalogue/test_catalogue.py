"""Every case of the catalogue gives what is expected of it, and the page in the book has them all."""

from __future__ import annotations

from pathlib import Path

import pytest

from .table import CASES

PAGE = Path(__file__).resolve().parents[2] / "docs" / "evidence" / "catalogue.md"


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.group}: {case.name}")
def test_case(case, tmp_path):
    assert case.run(tmp_path)


def test_there_are_enough_and_none_twice():
    assert len(CASES) >= 60
    assert len({(case.group, case.name) for case in CASES}) == len(CASES)


def test_the_page_has_them_all():
    text = PAGE.read_text(encoding="utf-8")
    assert f"All {len(CASES)} cases pass." in text
    assert all(f"| {case.name} |" in text for case in CASES)
