"""What is shown is a value, and the picture a function of it."""

import dataclasses

import numpy as np
import pytest

import radiosity as rad
from radiosity import display
from radiosity.errors import ParameterError
from radiosity.viewer.changes import Changes
from radiosity.viewer.commands import COMMANDS, MOUSE
from radiosity.viewer.dome import Dome
from radiosity.viewer.model import Model
from radiosity.viewer.state import EXPOSURES, Series, ViewState, caption, formula, mathtext, picture, start


@pytest.fixture(scope="module")
def series(solution: rad.Solution) -> Series:
    return Series.of(solution)


@pytest.fixture(scope="module")
def model(solution: rad.Solution, series: Series) -> Model:
    return Model(solution, series)


def a_state_in_which_every_key_does_something(model: Model) -> ViewState:
    """A patch picked that came from another, whose ω_i sees something, with paint that was changed."""
    floor = model.solution.patches.surface_names.index("floor")
    patch = int(np.flatnonzero(model.solution.patches.surface == floor)[5])
    dome = Dome(theta=60.0, azimuth=90.0, path=((3, 5),))
    changes = Changes().painted("floor", 0.3).emitting("lamp", 10.0)
    state = start(model.series, order=2, exposure=1.0, picked=patch, dome=dome, changes=changes)
    assert model.ahead(state) >= 0
    return state


def test_series_holds_the_solution(solution: rad.Solution, series: Series) -> None:
    assert series.orders.dtype == np.float32
    np.testing.assert_allclose(series.orders, solution.orders, rtol=1e-6)
    np.testing.assert_allclose(series.sums[-1], solution.radiosity, rtol=1e-5)
    np.testing.assert_allclose(series.sums[2], solution.orders[0] + solution.orders[1] + solution.orders[2], rtol=1e-6)
    np.testing.assert_allclose(series.power, solution.power, rtol=1e-12)


def test_orders_are_computed_where_the_solver_kept_none(solution: rad.Solution) -> None:
    result = dataclasses.replace(solution.result, orders=None)
    series = Series.of(dataclasses.replace(solution, result=result))
    np.testing.assert_allclose(series.orders[:7], solution.orders, rtol=1e-5, atol=1e-12)
    assert series.last == 10


def test_steps_stay_within_the_orders_there_are(series: Series) -> None:
    state = start(series, order=0)
    assert state.step(-1).order == 0
    assert state.step(3).order == 3
    assert state.step(99).order == series.last
    assert [state.at(series.last).tick().order, state.tick().order] == [0, 1]
    assert state.at(2.6).order == 3


def test_exposure_stays_within_the_slider(series: Series) -> None:
    state = start(series)
    assert state.brighter(3).exposure == 1.5
    assert state.brighter(-1000).exposure == EXPOSURES[0]
    assert state.exposed(1000.0).exposure == EXPOSURES[1]


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.shown)
def test_every_key_changes_one_thing_and_leaves_the_old_state_alone(model: Model, command) -> None:
    before = a_state_in_which_every_key_does_something(model)
    copy = dataclasses.replace(before)
    after = command.change(before, model)
    assert before == copy
    changed = {f.name for f in dataclasses.fields(ViewState) if getattr(before, f.name) != getattr(after, f.name)}
    together = {
        **{key: {"dome", "left"} for key in ("a", "k", "l", ",", ".", "<", ">")},
        "x": {"order", "left"},
        "m": {"tone", "mark_clipped"},
        "j": {"picked", "dome"},
        "u": {"picked", "dome", "order"},
    }
    assert changed == together[command.shown] if command.shown in together else len(changed) == 1


def test_the_list_of_keys_is_whole() -> None:
    shown = [command.shown for command in COMMANDS] + [action for action, _ in MOUSE]
    assert len(set(shown)) == len(shown)
    assert all(command.does for command in COMMANDS)


def test_switches_turn_back(series: Series) -> None:
    state = start(series)
    for name in ("normalised", "smooth", "wireframe", "backs", "photometric", "playing", "help", "projector"):
        assert state.toggled(name) != state
        assert state.toggled(name).toggled(name) == state
    assert state.toned().tone == "linear"
    assert state.toned().toned() == state
    with pytest.raises(ParameterError, match="not a switch"):
        state.toggled("order")


def test_no_key_does_two_things() -> None:
    keys = [key for command in COMMANDS for key in command.keys]
    assert len(keys) == len(set(keys))


def test_unknown_settings_are_named(series: Series) -> None:
    with pytest.raises(ParameterError, match=r"no setting colour; it has backs, changes, difference, dome, exposure"):
        start(series, colour="red")
    with pytest.raises(ParameterError, match="'aces' is unknown"):
        start(series, tone="aces")


def test_the_ceiling_is_black_at_order_1_and_lit_at_order_2(solution: rad.Solution, series: Series) -> None:
    ceiling = solution.patches.surface == solution.patches.surface_names.index("ceiling")
    emits = solution.patches.emission.any(axis=1)
    direct, twice = (picture(series, start(series, order=k), "order")[ceiling & ~emits] for k in (1, 2))
    assert direct.max() == 0
    assert twice.min() > 20


def test_picture_is_the_tone_map_of_the_light(series: Series) -> None:
    state = start(series, order=3, exposure=1.0)
    expected = display.tone_map(series.sums[3], 2.0 * series.common)
    assert np.array_equal(picture(series, state, "sum"), expected)
    assert picture(series, state, "sum").dtype == np.uint8


@pytest.mark.parametrize("order", [1, 2, 6])
def test_normalised_orders_are_equally_bright(series: Series, order: int) -> None:
    state = start(series, order=order, normalised=True)
    shown = series.light(state, "order") * series.factor(state, "order")
    assert display.reference_level(shown, series.area) == pytest.approx(display.MIDDLE, rel=1e-5)
    assert display.factor_text(float(series.own[order])) == caption(series, state, "order")
    assert np.array_equal(picture(series, state, "sum"), picture(series, start(series, order=order), "sum"))


def test_factors_grow_as_the_light_fades(series: Series) -> None:
    assert np.all(np.diff(series.own) > 0)
    assert series.own[1] > 1.0  # direct light is less than all reflected light


def test_an_order_without_light_is_black_and_says_so() -> None:
    lamp = np.zeros((3, 2, 3))
    lamp[0, 0] = 5.0
    series = Series(lamp.astype(np.float32), np.cumsum(lamp, axis=0).astype(np.float32), np.ones(2), lamp.sum(axis=1))
    state = start(series, order=2, normalised=True)
    assert caption(series, state, "order") == "no light of this order"
    assert picture(series, state, "order").max() == 0
    assert picture(series, state, "sum")[0].min() > 100


def test_false_colour_shows_numbers(series: Series) -> None:
    state = start(series, order=6, false_colour=True)
    low, high = series.scale(state, "sum")
    reflected = display.luminance(series.sums[-1] - series.orders[0]).max()
    assert reflected <= high <= 2.5 * reflected
    expected = display.false_colour(display.luminance(series.sums[6]), low, high, logarithmic=True)
    assert np.array_equal(picture(series, state, "sum"), expected)


def test_titles() -> None:
    assert formula(0, "order") == "T⁰ Lₑ"
    assert formula(12, "sum") == "Σ₀…₁₂ Tʲ Lₑ"
    assert mathtext(12, "sum") == r"$\sum_{j=0}^{12} T^j L_e$"


def test_captions_name_the_exposure(series: Series) -> None:
    assert caption(series, start(series), "sum") == "common exposure"
    assert caption(series, start(series, exposure=-1.5), "sum") == "exposure −1.5 EV"
    assert caption(series, start(series, false_colour=True), "sum").endswith("W/m²")
    assert caption(series, start(series, false_colour=True, photometric=True), "sum").endswith("lux")
