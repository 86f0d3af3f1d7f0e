"""Gathering against shooting: frames are what the solvers do, row by row and column by column."""

import numpy as np
import pytest

import radiosity as rad
from radiosity.viewer.curves import power_curves, race_curves, sum_curves
from radiosity.viewer.race import SWEEPS, Race, work
from radiosity.viewer.state import FRAMES, Series, start


@pytest.fixture(scope="module")
def race(solution: rad.Solution) -> Race:
    race = Race(solution)
    race[FRAMES - 1]
    return race


@pytest.mark.parametrize("patches", [6, 100, 10_000])
def test_work_grows_to_the_end(patches: int) -> None:
    rows = work(patches)
    assert rows[:4] == [0, 1, 2, 3]
    assert rows[-1] == SWEEPS * patches
    assert np.all(np.diff(rows) > 0)
    assert len(rows) <= FRAMES


def test_gathering_takes_in_one_row_after_the_other(solution: rad.Solution, race: Race) -> None:
    """The first patches by hand: each has gathered from the newest light, the others have not yet."""
    patches, factors = solution.patches, solution.factors
    light = patches.emission.copy()
    for i in range(5):
        light[i] = patches.emission[i] + patches.reflectance[i] * (factors.row(i) @ light)
    np.testing.assert_allclose(race[5].gathered, light, rtol=1e-6, atol=1e-12)
    assert race[5].row == 5


def test_whole_sweeps_are_those_of_the_solver(solution: rad.Solution, race: Race) -> None:
    patches = solution.patches
    steps = list(rad.GaussSeidel(rtol=0.0, maxiter=SWEEPS).iterate(race.T, patches.emission))
    last = race[FRAMES - 1]
    assert last.rows == SWEEPS * len(patches)
    np.testing.assert_array_equal(last.gathered, steps[SWEEPS].radiosity)
    within = next(frame for frame in race.frames if len(patches) < frame.rows < 2 * len(patches))
    here = within.rows - len(patches)
    np.testing.assert_array_equal(within.gathered[:here], steps[2].radiosity[:here])
    np.testing.assert_array_equal(within.gathered[here:], steps[1].radiosity[here:])


@pytest.mark.parametrize("number", [1, 7, 30])
def test_shooting_goes_on_as_if_it_had_never_stopped(solution: rad.Solution, race: Race, number: int) -> None:
    patches, frame = solution.patches, race[number]
    solver = rad.Shooting(rtol=0.0, shots=frame.rows, maxiter=1)
    once = list(solver.iterate(race.T, patches.emission, patches.sky))[-1]
    np.testing.assert_allclose(frame.shot, once.radiosity, rtol=1e-6)  # rows of float32 close to 6e-8
    np.testing.assert_allclose(frame.unshot, once.unshot, rtol=1e-5, atol=1e-7)


def test_the_first_shots_come_from_the_lamp_and_unshot_power_falls(solution: rad.Solution, race: Race) -> None:
    lamps = np.flatnonzero(solution.emission.any(axis=1))
    assert [race[i].column in lamps for i in range(len(lamps))] == [True] * len(lamps)
    unshot = [frame.unshot_power for frame in race.frames]
    assert unshot[0] == pytest.approx(float((solution.patches.area @ solution.emission).sum()))
    assert np.all(np.diff(unshot) < 0)
    assert unshot[-1] < 0.05 * unshot[0]


def test_shooting_shows_the_room_first(race: Race) -> None:
    """With a tenth of the rows: the reason why progressive refinement was invented."""
    tenth = next(frame for frame in race.frames if frame.rows >= len(race.solution.patches) // 10)
    assert tenth.missing_shot < 0.6
    assert tenth.missing_gathered > 0.9
    assert race[0].missing_shot == pytest.approx(1.0)
    assert race[FRAMES - 1].missing_gathered < 0.1


# Curves --------------------------------------------------------------------------------------------------------------


def test_curves_of_the_race(race: Race) -> None:
    curves = race_curves(race, 10)
    gathering, shooting = curves.curves
    assert len(gathering.points) == len(shooting.points) == 11
    np.testing.assert_allclose(shooting.points[:, 1], [race[i].missing_shot for i in range(11)])
    assert curves.marker == gathering.points[-1, 0]


def test_curves_of_power(solution: rad.Solution) -> None:
    series = Series.of(solution)
    curves = power_curves(series, start(series, order=3))
    assert len(curves.curves) == 3
    assert curves.marker == pytest.approx(3.5 / 7)
    ticks = {words: share for share, words in curves.up}
    heights = curves.curves[0].points[:, 1]
    fall = (heights[1] - heights[2]) / (ticks["1"] - ticks["10⁻²"]) * 2
    assert 10**fall == pytest.approx(series.power[1, 0] / series.power[2, 0], rel=1e-9)
    assert len(power_curves(series, start(series, picked=5)).curves) == 4
    assert power_curves(series, start(series, photometric=True)).title.endswith("lm")


def test_curves_of_the_sum() -> None:
    running = np.linspace(0.0, 1.0, 91)[:, None] * [1.0, 0.5, 0.25]
    curves = sum_curves(running, running[-1], theta=45.0)
    assert curves.marker == 0.5
    for c in range(3):
        assert curves.curves[c].points[-1, 1] == pytest.approx(curves.curves[3 + c].points[0, 1])
    assert np.all(sum_curves(np.zeros((91, 3)), np.zeros(3), 0.0).curves[0].points[:, 1] == 0.0)
