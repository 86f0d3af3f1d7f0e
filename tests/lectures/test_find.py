"""Lectures are found by name, and a teacher's own by file; mistakes in it are named with their line."""

from pathlib import Path

import pytest

import radiosity as rad
from radiosity.errors import ParameterError
from radiosity.lectures import Talk, find, names

SOURCES = Path(rad.__file__).parent / "lectures"
OWN = """\
import radiosity as rad
from radiosity.lectures import Lecture, Step

LECTURE = Lecture("mine", "Mine", lambda: None, (Step("one", "Text."),))
"""


def test_there_are_ten_in_the_order_of_a_course() -> None:
    assert names() == [
        "equation", "dome", "cornell", "rug", "series", "hemicube", "noise", "pinhole", "shortcuts", "daylight",
    ]  # fmt: skip


@pytest.mark.parametrize("name", names())
def test_every_lecture_can_be_found_and_asks(name: str) -> None:
    lecture = find(name)
    assert lecture.name == name
    assert 10 < lecture.minutes < 40
    assert sum(bool(step.question) for step in lecture.steps) >= 3


@pytest.mark.parametrize("name", names())
def test_a_copy_of_a_lecture_is_a_lecture(tmp_path: Path, name: str) -> None:
    """What a teacher does first."""
    source = (SOURCES / f"{name}.py").read_text(encoding="utf-8")
    title = find(name).steps[0].title
    mine = tmp_path / "mine.py"
    mine.write_text(source.replace(f'title="{title}"', 'title="My room"', 1), encoding="utf-8")
    assert find(str(mine)).steps[0].title == "My room"
    assert list(tmp_path.iterdir()) == [mine]  # nothing is left beside it


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "holds no lecture; set LECTURE"),
        (OWN.replace('"Text."', "Text"), r"mine\.py, line 4: NameError: name 'Text' is not defined"),
        (OWN.replace('"Text.")', '"Text."'), r"mine\.py, line 4: SyntaxError"),
        (OWN.replace('"Text."', '"Text.", {"ordre": 1}'), r"mine\.py, line 4: ParameterError: step 'one' shows ordre;"),
    ],
)
def test_mistakes_in_a_file_are_named_with_their_line(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "mine.py").write_text(text, encoding="utf-8")
    with pytest.raises(ParameterError, match=message):
        find(str(tmp_path / "mine.py"))


@pytest.mark.parametrize(
    ("solve", "numbers", "message"),
    [
        ("lambda: 1 / 0", "None", r"mine\.py, line 4: ZeroDivisionError"),
        (
            "lambda: rad.solve(rad.scenes.furnace(), patch_count=6, bounces=1)",
            "lambda s: s.nothing",
            "line 4: Attribute",
        ),
        ("lambda: rad.solve(rad.scenes.furnace(), patch_count=6, bounces=-1)", "None", "line 4: .*bounces is -1"),
    ],
)
def test_mistakes_in_its_functions_have_a_line(tmp_path: Path, solve: str, numbers: str, message: str) -> None:
    text = OWN.replace("lambda: None", solve).replace('"Text."),)', f'"Text."),), {numbers}')
    (tmp_path / "mine.py").write_text(text, encoding="utf-8")
    with pytest.raises(ParameterError, match=message):
        _ = Talk.prepare(find(str(tmp_path / "mine.py"))).numbers


def test_unknown_lectures_are_named() -> None:
    with pytest.raises(ParameterError, match=r"no lecture 'physics'; there are equation, dome, cornell"):
        find("physics")
