"""A lecture as a page: its words in order, questions before answers, and the picture that belongs to each step."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import UnusedFeatureWarning
from radiosity.lectures import Lecture, Step, Talk, export, plot, with_orders
from radiosity.lectures.page import _Steps
from radiosity.viewer.inspect import HemicubeView, factor_colours
from radiosity.viewer.state import Series, ViewState, picture
from tests.viewer.browser import Browser, needs_browser
from tests.viewer.test_page import pixels_and_patches

PLACE = (0.42, 0.0, 0.12)
STEPS = (
    Step("Begin <here>", "One & two: {count} patches.", {"order": 0}, minutes=2),
    Step(
        "Ask", "Think.", {"order": 1}, question="How?", answer="So.", reveal={"order": 4, "normalised": True}, minutes=3
    ),
    Step("Cube", "", {"scene": "cube", "order": 3}),
    Step("Dim", "", {"beside": "dim", "order": 2, "titles": ("a quarter", "")}),
    Step("Plot", "", {"figure": lambda _: plot("x", "y")[0]}),
    Step("Wrong", "", {"left": "wrong", "wrong": 1, "order": 6}),
    Step("Factors", "", {"left": "factors", "pick": PLACE, "order": 6}),
    Step("Sees", "", {"left": "hemicube", "pick": PLACE, "order": 6, "exposure": 1.0}),
    Step("T", "", {"left": "matrix"}),
)


@pytest.fixture(scope="module")
def talk(solution: rad.Solution) -> Talk:
    assert solution.orders is not None
    cube = rad.solve(rad.scenes.furnace(), patch_count=96, bounces=3)
    solved = {"box": solution, "cube": cube, "dim": with_orders(solution, solution.orders / 4)}
    numbers = lambda solved: {"count": len(solved["box"].patches)}  # noqa: E731
    return Talk(Lecture("talk", "A talk", lambda: None, STEPS, numbers=numbers), solved)


@pytest.fixture(scope="module")
def file(talk: Talk, tmp_path_factory: pytest.TempPathFactory) -> Path:
    (path,) = export(talk, tmp_path_factory.mktemp("talk") / "talk.html")
    return path


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    browser = Browser(tmp_path_factory.mktemp("chromium"))
    yield browser
    browser.close()


@pytest.fixture
def shown(browser: Browser, file: Path) -> Iterator[Browser]:
    browser.size(1280, 720)
    browser.open(file)
    yield browser
    assert browser.requests == [file.as_uri()]
    assert browser.complaints == []


def said(browser: Browser) -> str:
    return browser.run("document.getElementById('words').innerText")


def test_a_plot_of_an_answer_covers_what_was_beside(solution: rad.Solution) -> None:
    """As in the window: the answer is the plot, whatever the question showed."""
    step = Step("Dim", "", {"beside": "dim"}, question="?", answer="!", reveal={"figure": lambda _: plot("x", "y")[0]})
    solved = {"box": solution, "dim": solution}
    (data,) = _Steps(Talk(Lecture("talk", "A talk", lambda: None, (step,)), solved)).data()["steps"]
    assert (data["show"]["left"], data["show"]["beside"]) == ("beside", 1)
    assert (data["reveal"]["left"], data["reveal"]["figure"]) == ("figure", 0)


@needs_browser
def test_forward_asks_before_it_answers_and_back_is_the_same_way(shown: Browser, solution: rad.Solution) -> None:
    assert f"One & two: {len(solution.patches)} patches." in said(shown)
    assert "Begin <here>" in said(shown)
    where = lambda: (shown.run("talk.number"), shown.run("talk.revealed"), shown.run("viewer.state.k"))  # noqa: E731
    seen = [where()]
    for key in ("PageDown", "Enter", "PageDown", "PageUp", "Backspace", "PageUp"):
        shown.key(key)
        seen.append(where())
    forth = [(0, False, 0), (1, False, 1), (1, True, 4), (2, False, 3)]
    assert seen == [*forth, *forth[-2::-1]]


@needs_browser
def test_buttons_lead_through_the_lecture(shown: Browser) -> None:
    def press(selector: str) -> None:
        x, y, width, height = shown.box(selector)
        shown.mouse((x + width / 2, y + height / 2))

    press("#talk-on")
    assert "How?" in said(shown)
    assert "So." not in said(shown)
    assert "2 of 9 · minute 2 of 12" in shown.run("document.getElementById('talk-where').textContent")
    press("article:not([hidden]) .reveal")
    assert "So." in said(shown)
    assert shown.run("viewer.state.normalised")
    press("#dots button:nth-child(6)")
    assert "Wrong" in said(shown)
    assert shown.run("[viewer.state.left, viewer.state.wrong]") == ["wrong", 1]
    assert not shown.run("viewer.state.normalised")  # each step has its own view


@needs_browser
def test_pictures_are_those_of_the_steps(shown: Browser, talk: Talk, solution: rad.Solution) -> None:
    series = {name: Series.of(one) for name, one in talk.solutions.items()}

    def expect(number: int, pane: str, colours: np.ndarray) -> None:
        shown.run(f"talk.go({number}, false)")
        shown.settle()
        pixels, patches = pixels_and_patches(shown, pane)
        if number in (6, 7):  # an outline is drawn around the picked patch
            away = ~np.isin(patches, np.flatnonzero(near))
            pixels, patches = pixels[away], patches[away]
        assert len(np.unique(patches)) > 20
        assert np.abs(pixels - colours[patches].astype(int)).max() <= 2, (number, pane)

    picked = talk.picks(place_of(talk, 6))["picked"]
    near = np.linalg.norm(solution.patches.centroid - solution.patches.centroid[picked], axis=1) < 0.1
    last, cube = ViewState(last=6, order=6), ViewState(last=3, order=3)
    expect(2, "order", picture(series["cube"], cube, "order"))
    dim = Series(series["box"].orders / 4, series["box"].sums / 4, series["box"].area, series["box"].power)
    object.__setattr__(dim, "common", series["box"].common)
    expect(3, "order", picture(dim, ViewState(last=6, order=2), "sum"))
    assert shown.run("document.querySelector('.formula').textContent") == "a quarter"
    row = HemicubeView.of(solution.patches, picked).row(len(solution.patches))
    expect(6, "order", factor_colours(row)[0])
    expect(6, "sum", picture(series["box"], last, "sum"))
    expect(7, "sum", picture(series["box"], ViewState(last=6, order=6, exposure=1.0), "sum"))
    assert shown.run("viewer.state.picked") == picked


def place_of(talk: Talk, number: int):
    from radiosity.lectures import Place

    return Place(talk.lecture, number)


@needs_browser
def test_plots_stand_in_the_left_pane(shown: Browser) -> None:
    for number in (4, 8):
        shown.run(f"talk.go({number}, false)")
        shown.run("document.getElementById('figure').decode()")
        left, top, width, height = shown.box("#figure")
        assert (left, top) == shown.box("canvas")[:2]
        assert width == pytest.approx(shown.box("canvas")[2] / 2, abs=1)
        assert height > 250
        assert shown.run("document.getElementById('figure').naturalWidth") > 100
    shown.run("talk.go(0, false)")
    assert shown.run("document.getElementById('figure').hidden")


@needs_browser
def test_a_link_leads_to_a_step(browser: Browser, file: Path) -> None:
    browser.open(file, "#step=3")
    assert browser.run("talk.number") == 2
    browser.key("PageDown")
    assert browser.run("location.hash") == "#step=4"


@needs_browser
def test_the_view_stays_as_the_reader_turned_it_until_the_scene_changes(shown: Browser) -> None:
    camera = lambda: shown.run("camera.position")  # noqa: E731
    first = camera()
    x, y, *_ = shown.box("canvas")
    shown.mouse((x + 100, y + 100), (x + 140, y + 100), (x + 180, y + 110))
    turned = camera()
    shown.key("PageDown")
    assert camera() == turned != first
    shown.run("talk.go(2, false)")
    assert camera() != turned


@needs_browser
def test_a_phone_reads_the_lecture(browser: Browser, file: Path) -> None:
    browser.size(390, 844, phone=True)
    browser.open(file)
    assert browser.run("document.documentElement.scrollWidth") <= 390
    for selector in ("#talk-back", "#talk-on"):
        _, y, _, height = browser.box(selector)
        assert height >= 44
        assert y + height <= 844
    browser.run("talk.go(4, false)")
    assert browser.box("#figure")[2] > 350  # a plot has the whole width
    browser.run("talk.go(3, false)")
    assert browser.run("viewer.state.show") == "both"
    assert browser.complaints == []
    browser.size(1280, 720)


@needs_browser
def test_without_webgl_all_words_are_there(file: Path, tmp_path: Path) -> None:
    browser = Browser(tmp_path, flags=("--disable-3d-apis",))
    try:
        browser.open(file)
        for words in ("Begin <here>", "How?", "So.", "Factors"):
            assert words in said(browser)
    finally:
        browser.close()


def test_what_only_the_window_shows_is_said(solution: rad.Solution, tmp_path: Path) -> None:
    lecture = Lecture("t", "t", lambda: None, (Step("edges", "", {"wireframe": True}),))
    with pytest.warns(UnusedFeatureWarning, match="step 'edges' shows wireframe, which the page leaves out"):
        export(Talk(lecture, solution), tmp_path / "t.html")
