"""The equations that the code cites are those that the book derives, and the other way round."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def numbers(pattern: str, folder: str, suffix: str) -> dict[int, str]:
    """Numbers found in the files of a folder, each with one place where it stands."""
    found = {}
    for path in sorted((ROOT / folder).rglob(f"*.{suffix}")):
        for number in re.findall(pattern, path.read_text(encoding="utf-8")):
            found[int(number)] = str(path.relative_to(ROOT))
    return found


CITED = numbers(r"Eq\. \((\d+)\)", "radiosity", "py")
DERIVED = numbers(r":label: (\d+)\n", "docs/theory", "md")


def test_each_equation_of_the_code_is_in_the_book() -> None:
    assert {number: CITED[number] for number in CITED if number not in DERIVED} == {}


def test_each_equation_of_the_book_is_in_the_code() -> None:
    assert {number: DERIVED[number] for number in DERIVED if number not in CITED} == {}


def test_equations_are_numbered_in_the_order_of_the_book() -> None:
    pages = sorted((ROOT / "docs" / "theory").glob("*.md"))
    order = [int(n) for page in pages for n in re.findall(r":label: (\d+)\n", page.read_text(encoding="utf-8"))]
    assert order == list(range(1, len(order) + 1))
