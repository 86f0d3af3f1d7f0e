"""A lecture goes forward and back, asks before it shows, and can be a teacher's own file."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import radiosity as rad
from radiosity.display import tone_map
from radiosity.errors import FileFormatError, ParameterError
from radiosity.lectures import Lecture, LectureWindow, Place, Step, Talk, export, nearest, plot, with_orders
from radiosity.lectures.window import wrap
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
        ({"show": {"colour": 1}}, "shows colour; a step can show backs"),
        ({"question": "Why?"}, "a question and an answer, or neither"),
        ({"reveal": {"order": 1}}, "reveals something, but asks nothing"),
    ],
)
def test_mistakes_in_a_lecture_are_named(fields: dict, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        Step("step", "text", **fields)


# Words with numbers, and several solutions ---------------------------------------------------------------------------


def talk(solved, *steps: Step, numbers=None) -> Talk:
    return Talk(Lecture("talk", "A talk", lambda: None, steps, numbers=numbers), solved)


def test_another_solution_beside_stands_under_its_name(solution: rad.Solution) -> None:
    step = Step("Both", "…", {"scene": "b", "beside": "a"})
    named = replace(step, show={**step.show, "titles": ("this", "that")})
    lecture = Lecture("talk", "A talk", lambda: None, (step, named))
    both = Talk(lecture, {"a": solution, "b": solution})
    first = Place(lecture)
    assert both.titles(first) == {"order": "a"}
    assert both.titles(first.forward()) == {"order": "this", "sum": "that"}


def test_numbers_of_the_solution_stand_in_the_text(solution: rad.Solution) -> None:
    step = Step("Of {count}", "Half is {half:.0%}.", question="{{braces}}?", answer="{count:,} patches")
    numbers = lambda solved: {"count": len(solved.patches), "half": 0.5}  # noqa: E731
    words = talk(solution, step, numbers=numbers).words(Place(Lecture("t", "t", lambda: None, (step,))))
    count = len(solution.patches)
    assert (words.title, words.text) == (f"Of {count}", ["Half is 50%."])
    assert (words.question, words.answer) == (["{braces}?"], [f"{count:,} patches"])


@pytest.mark.parametrize(
    ("step", "message"),
    [
        (Step("s", "{nothing}"), r"'s' has \{nothing\} in its text; the lecture's numbers are half"),
        (Step("s", "{half:.1q}"), r"'s': its text has braces that are no number"),
        (Step("s", "{"), r"'s': its text has braces that are no number"),
        (Step("s", "", {"scene": "cellar"}), "'s' shows 'cellar'; the lecture has solved scene"),
        (Step("s", "", {"beside": "attic"}), "'s' shows 'attic'; the lecture has solved scene"),
        (Step("s", "", {"pick": (1, 2)}), r"'s': pick is \(1, 2\); give x, y, z in metres"),
    ],
)
def test_what_a_lecture_does_not_have_is_named_before_it_begins(solution, step: Step, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        talk(solution, step, numbers=lambda _: {"half": 0.5})


def test_light_beside_must_be_on_the_same_patches(solution: rad.Solution) -> None:
    other = rad.solve(rad.scenes.furnace(), patch_count=24, bounces=1)
    with pytest.raises(ParameterError, match=r"'other' \(24 patches\) beside a scene of"):
        talk({"box": solution, "other": other}, Step("s", "", {"beside": "other"}))


def test_a_place_picks_the_nearest_patch(solution: rad.Solution) -> None:
    step = Step("s", "", {"pick": (0.1, 0.0, 0.5), "pick_other": (0.1, 0.5488, 0.5)})
    one = talk(solution, step)
    view = one.view(Place(one.lecture), ViewState(last=3))
    names_of = solution.patches.surface_names
    assert [names_of[solution.patches.surface[i]] for i in (view.picked, view.other)] == ["floor", "ceiling"]
    assert view.picked == nearest(solution, (0.1, 0.0, 0.5))


def test_fewer_patches_only_where_the_lecture_takes_them() -> None:
    with pytest.raises(ParameterError, match="its function solve takes no patch_count"):
        Talk.prepare(LECTURE, 100)


def test_light_of_other_origin_is_shown_as_a_solution(solution: rad.Solution) -> None:
    assert solution.orders is not None
    half = with_orders(solution, solution.orders / 2, "half as much")
    np.testing.assert_allclose(half.radiosity, solution.orders.sum(axis=0) / 2)
    assert half.patches is solution.patches
    assert half.status == "half as much"
    with pytest.raises(ParameterError, match="orders have shape"):
        with_orders(solution, solution.orders[:, 1:])


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
    window = LectureWindow(Talk(LECTURE, solution), off_screen=True, size=(800, 450))
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
    written = export(Talk(LECTURE, solution), tmp_path / "slides", size=(800, 450))
    assert [path.name for path in written] == ["01.png", "02.png", "02_answer.png", "03.png"]
    images = []
    for path in written:
        with Image.open(path) as file:
            images.append(np.asarray(file))
    assert all(image.shape == (450, 800, 3) for image in images)
    for one, next_one in pairwise(images):
        assert np.mean(np.any(one != next_one, axis=-1)) > 0.01


@pytest.mark.usefixtures("gl")
def test_the_window_goes_from_scene_to_scene(solution: rad.Solution) -> None:
    """Another scene, other light beside it, a plot: and back again, as it was."""
    assert solution.orders is not None
    dim = with_orders(solution, solution.orders / 4)
    furnace = rad.solve(rad.scenes.furnace(), patch_count=24, bounces=3)
    steps = (
        Step("box", "", {"order": 2}),
        Step("cube", "", {"scene": "cube", "order": 3}),
        Step("dim", "", {"beside": "dim", "order": 2, "titles": ("a quarter", "")}),
        Step("plot", "", {"figure": lambda _: plot("x", "y")[0]}),
    )
    lecture = talk({"box": solution, "cube": furnace, "dim": dim}, *steps)
    window = LectureWindow(lecture, off_screen=True, size=(800, 450))
    seen = []
    for key in ("", "Next", "Next", "Next", "Prior", "Prior", "Prior"):
        window.press(key)
        picture = window.panes["order"].colours[:, 0].copy()
        seen.append((len(window.solution.patches), window.state.order, window.inspector.raster.actor.GetVisibility()))
        if window.place.number == 2:
            light = solution.orders[:3].sum(axis=0) / 4 * window.series.factor(window.state, "sum")
            np.testing.assert_allclose(picture, tone_map(light), atol=1)
            assert window.titles["order"][0].actor.GetInput() == "a quarter"
    box, cube = len(solution.patches), len(furnace.patches)
    there = [(box, 2, 0), (cube, 3, 0), (box, 2, 0), (box, 1, 1)]
    assert seen == [*there, *there[-2::-1]]
    window.press("Right")
    assert window.state.order == 3  # one key, one step: nobody listens twice
    window.close()


@pytest.mark.usefixtures("gl")
def test_long_texts_shrink_until_they_fit(solution: rad.Solution) -> None:
    long = talk(solution, Step("short", "Few words."), Step("long", "Many words. " * 120))
    window = LectureWindow(long, off_screen=True, size=(1200, 675))
    sizes = []
    for key in ("", "Next"):
        window.press(key)
        sizes.append(window.body.property.GetFontSize())
    window.close()
    assert sizes[1] < 0.85 * sizes[0]


@pytest.mark.usefixtures("gl")
def test_slides_can_have_a_name(solution: rad.Solution, tmp_path: Path) -> None:
    written = export(talk(solution, *STEPS[:1]), tmp_path / "box.png", size=(400, 225))
    assert [path.name for path in written] == ["box_01.png"]


def test_a_lecture_is_written_as_what_it_can_be(solution: rad.Solution, tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match=r"written as \.html, as \.png"):
        export(talk(solution, *STEPS[:1]), tmp_path / "box.pdf")
