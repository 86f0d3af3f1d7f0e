"""Shortcuts are shown beside the truth, labelled, and by how much they are off."""

import numpy as np
import pytest

import radiosity as rad
from radiosity import display
from radiosity.shortcuts import ALL
from radiosity.viewer.compare import equation_image
from radiosity.viewer.state import Series, coloured, start
from radiosity.viewer.window import Window


@pytest.fixture
def window(solution: rad.Solution):
    window = Window(solution, off_screen=True, size=(800, 500), order=1)
    window.image()
    yield window
    window.close()


@pytest.mark.usefixtures("gl")
def test_every_shortcut_beside_the_truth(window: Window, solution: rad.Solution) -> None:
    for number, shortcut in enumerate(ALL):
        window.press("x")
        state = window.state
        assert (state.left, state.wrong, state.order) == ("wrong", number, state.last)
        wrong = shortcut.radiosity(solution.patches, solution.factors, solution.radiosity)
        expected = coloured(window.series, state, "sum", wrong.astype(np.float32))
        assert np.array_equal(window.panes["order"].colours[:, 0], expected)
        assert window.titles["order"][0].actor.GetInput() == "WRONG"
        assert window.titles["order"][1].actor.GetInput() == shortcut.name
        said = window.dashboard.status.actor.GetInput()
        assert said.startswith(f"WRONG: {shortcut.name} · off by ")
        assert said.split("\n", 1)[1].replace("\n", " ") == shortcut.sentence
    window.press("x")
    assert window.state.left == "order"
    assert window.titles["order"][0].actor.GetInput().startswith("T")


@pytest.mark.usefixtures("gl")
def test_difference_is_relative_to_the_truth(window: Window, solution: rad.Solution) -> None:
    window.press("x")
    window.press("d")
    direct = display.luminance(solution.orders[0] + solution.orders[1])
    truth = display.luminance(solution.radiosity)
    off = window.inspector.compare.difference(0)
    np.testing.assert_allclose(off, direct / truth - 1, atol=1e-5)
    ceiling = solution.patches.surface == solution.patches.surface_names.index("ceiling")
    shown = window.panes["order"].colours[:, 0]
    assert np.all(shown[ceiling] == display.DIVERGING[0])  # black instead of lit: 100 % too dark
    typical = np.sum(solution.patches.area * np.abs(off)) / solution.patches.area.sum()
    assert f"off by {typical:.0%} on average" in window.dashboard.status.actor.GetInput()
    assert "blue: too dark" in window.dashboard.status.actor.GetInput()


@pytest.mark.usefixtures("gl")
def test_the_label_stays_in_smooth_and_false_colour(window: Window) -> None:
    window.press("x")
    for key in ("s", "f", "n", "Left"):
        window.press(key)
        assert window.titles["order"][0].actor.GetInput() == "WRONG", key


def test_equations_are_typeset() -> None:
    sizes = [equation_image(shortcut.equation).shape for shortcut in ALL]
    assert all(height > 30 and width > 100 and depth == 3 for height, width, depth in sizes)
    assert len({size[:2] for size in sizes}) > 3


def test_from_the_wrong_pane_to_the_others(solution: rad.Solution) -> None:
    state = start(Series.of(solution)).next_wrong()
    assert state.next_left().left == "order"
    assert state.pick(3).left == "wrong"
