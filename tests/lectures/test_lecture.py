"""A lecture goes forward and back, asks before it shows, and can be a teacher's own file."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import radiosity as rad
from radiosity.errors import ParameterError
from radiosity.lectures import Lecture, LectureWindow, Place, Step, export, find, names
from radiosity.lectures.runner import wrap
from radiosity.viewer.state import ViewState

STEPS = (
    Step("begin", "One.\n\nTwo\n   lines.", {"order": 0}),
    Step("ask", "", {"order": 1}, question="How?", answer="So.", reveal={"order": 2, "normalised": True}, minutes=2.5),
    Step("end", "", {"smooth": True}),
)
LECTURE = Lecture("talk", "A talk", lambda: pytest.fail("solved without need"), STEPS)


def test_forward_asks_before_it_reveals() -> None:
    places = Place(LECTURE).all()
    assert [(place.number, place.revealed) for place in places] == [(0, False), (1, False), (1, True), (2, False)]
    assert [place.asking for place in places] == [False, True, False, False]
    assert places[-1].forward() == places[-1]


def test_back_is_the_same_way() -> None:
    places = Place(LECTURE).all()
    for before, after in pairwise(places):
        assert after.back() == before
    assert places[0].back() == places[0]


def test_each_place_has_its_own_view_whichever_way_one_comes() -> None:
    begin = ViewState(last=4, exposure=1.0)
    views = [place.view(begin) for place in Place(LECTURE).all()]
    assert [view.order for view in views] == [0, 1, 2, 0]
    assert [view.normalised for view in views] == [False, False, True, False]
    assert all(view.exposure == 1.0 for view in views)
    assert views[-1].smooth


def test_minutes_add_up() -> None:
    assert LECTURE.minutes == 4.5
    assert [place.minutes_before for place in Place(LECTURE).all()] == [0, 1, 1, 3.5]


def test_paragraphs_are_plain_text() -> None:
    assert STEPS[0].paragraphs == ["One.", "Two lines."]


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"show": {"colour": 1}}, "shows colour; a view has backs"),
        ({"question": "Why?"}, "a question and an answer, or neither"),
        ({"reveal": {"order": 1}}, "reveals something, but asks nothing"),
    ],
)
def test_mistakes_in_a_lecture_are_named(fields: dict, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        Step("step", "text", **fields)


def test_every_lecture_of_the_package_can_be_found() -> None:
    assert "cornell" in names()
    for name in names():
        lecture = find(name)
        assert lecture.name == name
        assert lecture.minutes > 0


def test_a_copy_of_a_lecture_is_a_lecture(tmp_path: Path) -> None:
    """What a teacher does first."""
    source = Path(rad.__file__).parent / "lectures" / "cornell.py"
    mine = tmp_path / "mine.py"
    mine.write_text(source.read_text(encoding="utf-8").replace("A room and its equation", "My room"), encoding="utf-8")
    assert find(str(mine)).steps[0].title == "My room"


def test_unknown_lectures_are_named(tmp_path: Path) -> None:
    with pytest.raises(ParameterError, match=r"no lecture 'physics'; there are cornell"):
        find("physics")
    (tmp_path / "empty.py").write_text("")
    with pytest.raises(ParameterError, match="holds no lecture"):
        find(str(tmp_path / "empty.py"))


def test_lines_fit_the_column() -> None:
    from PIL import ImageFont

    from radiosity.viewer.overlay import font

    text = "The light that leaves a point is what it emits plus what it passes on."
    lines = wrap(text, 200.0, 18.0).splitlines()
    face = ImageFont.truetype(font(), 18)
    assert max(face.getlength(line) for line in lines) <= 200.0
    assert " ".join(lines) == text


@pytest.mark.usefixtures("gl")
def test_the_window_follows_the_lecture(solution: rad.Solution) -> None:
    window = LectureWindow(LECTURE, solution, off_screen=True, size=(800, 450))
    words = lambda: (window.heading.actor.GetInput(), window.question.actor.GetInput(), window.state.order)  # noqa: E731
    seen = [words()]
    for key in ("Next", "Return", "Next", "Next", "Prior", "BackSpace"):
        window.press(key)
        seen.append(words())
    window.press("Right")
    assert window.state.order == 2  # keys of the viewer still work
    window.press("p")
    window.press("Next")
    assert window.state.projector
    window.close()
    assert seen == [
        ("begin", "", 0),
        ("ask", "How?", 1),
        ("ask", "How?\n\nSo.", 2),
        ("end", "", 1),
        ("end", "", 1),
        ("ask", "How?\n\nSo.", 2),
        ("ask", "How?", 1),
    ]


@pytest.mark.usefixtures("gl")
def test_export_writes_each_step_and_each_answer(solution: rad.Solution, tmp_path: Path) -> None:
    written = export(LECTURE, tmp_path / "slides", solution, size=(800, 450))
    assert [path.name for path in written] == ["01.png", "02.png", "02_answer.png", "03.png"]
    images = []
    for path in written:
        with Image.open(path) as file:
            images.append(np.asarray(file))
    assert all(image.shape == (450, 800, 3) for image in images)
    for one, next_one in pairwise(images):
        assert np.mean(np.any(one != next_one, axis=-1)) > 0.01
