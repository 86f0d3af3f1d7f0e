"""The hemisphere in the viewer: its state, its geometry under the mouse, its numbers, and the recursion by hand."""

import dataclasses

import numpy as np
import pytest

import radiosity as rad
from radiosity import display
from radiosity.errors import ParameterError
from radiosity.viewer.dome import Dome, angles, direction_under, lobe, on_dome
from radiosity.viewer.dome_reading import DIM, DomeReading, dome_pictures
from radiosity.viewer.model import Model
from radiosity.viewer.state import Series, ViewState, start


@pytest.fixture(scope="module")
def model(solution: rad.Solution) -> Model:
    return Model(solution, Series.of(solution))


def nearest(patches: rad.Patches, surface: str, point: tuple[float, float, float]) -> int:
    mine = np.flatnonzero(patches.surface == patches.surface_names.index(surface))
    return int(mine[np.argmin(np.linalg.norm(patches.centroid[mine] - point, axis=1))])


@pytest.fixture(scope="module")
def floor(solution: rad.Solution) -> int:
    return nearest(solution.patches, "floor", (0.35, 0.0, 0.1))


def opened(model: Model, patch: int, **dome) -> ViewState:
    """The hemisphere of a patch, with all light there is."""
    return start(model.series, order=model.series.last, picked=patch, left="hemisphere", dome=Dome(**dome))


# State ---------------------------------------------------------------------------------------------------------------


def test_directions_stay_above_the_horizon() -> None:
    dome = Dome(theta=85.0, azimuth=350.0)
    assert dome.turned(theta=30.0).theta == 90.0
    assert dome.turned(theta=-200.0).theta == 0.0
    assert dome.turned(azimuth=20.0).azimuth == pytest.approx(10.0)
    assert dome.looked_from(95.0, -10.0).theta_out == 90.0
    with pytest.raises(ParameterError, match="cannot show 'glossy'; choose from radiance, cosine, sum"):
        Dome(stage="glossy")  # type: ignore[arg-type]


def test_the_sum_begins_at_the_normal_and_is_played(model: Model, floor: int) -> None:
    state = opened(model, floor, stage="cosine", theta=40.0)
    state = dataclasses.replace(state, dome=state.dome.next_stage())
    assert (state.dome.stage, state.dome.theta) == ("sum", 0.0)
    thetas = []
    for _ in range(20):
        state = state.tick()
        thetas.append(state.dome.theta)
    assert thetas[:3] == [5.0, 10.0, 15.0]
    assert thetas[17:] == [90.0, 0.0, 5.0]
    assert state.order == model.series.last  # bounces stand still meanwhile


def test_walking_the_path_and_back(model: Model, floor: int) -> None:
    state = opened(model, floor)
    onward = state.walk(7).walk(9)
    assert onward.picked == 9
    assert [patch for patch, _ in onward.dome.path] == [floor, 7]
    assert onward.walk_back().walk_back() == state
    assert state.walk_back() == state
    assert state.walk(-1) == state
    assert onward.pick(3).dome.path == ()


def test_one_bounce_leads_to_the_bounce_before(model: Model, floor: int) -> None:
    """Light of bounce k was light of bounce k - 1 where it came from, and what the lamp emits came from nowhere."""
    state = dataclasses.replace(opened(model, floor, single=True), order=2)
    lamp = state.walk(7).walk(9)
    assert (lamp.order, lamp.walk(11)) == (0, lamp)
    assert lamp.walk_back().walk_back().order == 2


# Under the mouse -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("theta", "azimuth"), [(10, 30), (45, 90), (80, 100), (60, 200), (89, 350)])
def test_angles_and_points_are_inverse(theta: float, azimuth: float) -> None:
    assert angles(3.0 * on_dome(theta, azimuth)) == pytest.approx((theta, azimuth))


def test_a_ray_from_above_ends_on_the_floor_where_the_sine_is() -> None:
    eye = np.array([0.0, 0.0, 5.0])
    for theta, azimuth in ((20.0, 10.0), (70.0, 250.0)):
        below = on_dome(theta, azimuth) * [1.0, 1.0, 0.0]
        found = direction_under(eye, below - eye)
        assert found == pytest.approx((theta, azimuth), abs=1e-6)
    assert direction_under(eye, np.array([3.0, 0.0, -5.0])) is None


def test_a_ray_from_aside_ends_inside_on_the_far_half() -> None:
    eye = np.array([0.0, -4.0, 2.0])
    far, near = on_dome(50.0, 80.0), on_dome(60.0, 280.0)
    assert direction_under(eye, far - eye) == pytest.approx((50.0, 80.0), abs=1e-6)
    through = direction_under(eye, near - eye)
    assert through is not None
    assert through != pytest.approx((60.0, 280.0), abs=1.0)  # the near half is open
    assert direction_under(eye, near - eye, near=near) == pytest.approx((60.0, 280.0), abs=1e-6)


def test_dragging_past_the_outline_stays_on_it() -> None:
    eye = np.array([0.0, -4.0, 0.0])
    found = direction_under(eye, np.array([1.6, 4.0, 0.4]), near=on_dome(80.0, 0.0))
    assert found is not None
    assert 60.0 < found[0] < 90.0
    below = direction_under(eye, np.array([0.2, 4.0, -0.5]), near=on_dome(80.0, 0.0))
    assert below is not None
    assert below[0] == 90.0


# Numbers -------------------------------------------------------------------------------------------------------------


def test_what_leaves_is_emission_and_what_arrived(model: Model, solution: rad.Solution) -> None:
    """L_o of the dome, with all light, is the radiance that was solved: 4 % in the root mean square over the room."""
    patches = solution.patches
    points = np.linspace(0, len(patches) - 1, 40).astype(int)
    readings = [DomeReading.of(model, model.series, opened(model, int(i))) for i in points]
    solved = solution.radiosity[points] / np.pi
    arrived = solution.factors.gather(solution.orders[:-1].sum(axis=0))  # the last bounce has not gone on
    found = np.array([reading.outgoing for reading in readings])
    weight = patches.area[points, None] * (solution.emission[points] == 0.0)
    error = np.sqrt(np.sum(weight * (found - solved) ** 2) / np.sum(weight * solved**2))
    assert error < 0.04
    for reading, patch in zip(readings, points, strict=True):
        if patches.reflectance[patch].min() > 0.0:
            np.testing.assert_allclose(reading.solved, arrived[patch], rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize("order", [1, 2, 4])
def test_one_bounce_arrives_as_the_bounce_before(model: Model, solution: rad.Solution, floor: int, order: int) -> None:
    state = dataclasses.replace(opened(model, floor, single=True), order=order)
    reading = DomeReading.of(model, model.series, state)
    found, solved = (display.luminance(light) for light in (np.pi * reading.outgoing, solution.orders[order, floor]))
    assert found == pytest.approx(solved, rel=0.07)  # a row of 256 rays; the next bounce is half of this one
    np.testing.assert_allclose(reading.solved * reading.reflectance, solution.orders[order, floor], rtol=1e-5)


def test_nothing_arrives_before_the_first_bounce(model: Model, solution: rad.Solution) -> None:
    lamp = int(np.flatnonzero(solution.emission.any(axis=1))[0])
    reading = DomeReading.of(model, model.series, dataclasses.replace(opened(model, lamp, single=True), order=0))
    assert not reading.radiance.any()
    np.testing.assert_allclose(reading.outgoing, solution.emission[lamp] / np.pi)


def test_the_sum_so_far(model: Model, floor: int) -> None:
    whole = DomeReading.of(model, model.series, opened(model, floor, stage="sum", theta=90.0))
    half = DomeReading.of(model, model.series, opened(model, floor, stage="sum", theta=45.0))
    np.testing.assert_array_equal(whole.so_far, whole.irradiance)
    np.testing.assert_array_equal(half.so_far, whole.running[60])
    assert np.all(half.so_far < whole.so_far)


def test_sky_light_arrives_with_the_first_bounce() -> None:
    solution = rad.solve(rad.scenes.open_rug(), patch_count=200, estimator=rad.MonteCarlo(rays=64), bounces=3)
    model = Model(solution, Series.of(solution))
    patch = int(np.argmax(solution.factors.to_sky))
    for order, lit in ((0, False), (1, True), (2, False)):
        state = start(model.series, order=order, picked=patch, left="hemisphere", dome=Dome(single=True))
        seen = model.hemisphere(patch).seen
        arrives = DomeReading.of(model, model.series, state).radiance[seen == -1]
        assert bool(arrives.any()) is lit


# Colours and lobes ---------------------------------------------------------------------------------------------------


def test_colours_of_the_dome(model: Model, floor: int) -> None:
    """L_i looks as the patches do in the room; with the cosine it darkens towards the horizon; the sum stops at θ."""
    from radiosity.viewer.state import picture

    state = opened(model, floor)
    seen = model.hemisphere(floor).seen
    dome, ground = dome_pictures(DomeReading.of(model, model.series, state), model.series, state)
    room = picture(model.series, state.at(state.order - 1), "sum")
    assert np.abs(dome[seen >= 0].astype(int) - room[seen[seen >= 0]]).max() <= 1
    assert np.array_equal(dome, ground)
    state = opened(model, floor, stage="cosine")
    darker, same = dome_pictures(DomeReading.of(model, model.series, state), model.series, state)
    assert np.array_equal(same, ground)
    assert np.all(darker <= dome)
    assert darker[-1].max() < 60
    state = opened(model, floor, stage="sum", theta=30.0)
    summed, _ = dome_pictures(DomeReading.of(model, model.series, state), model.series, state)
    assert np.array_equal(summed[:40], darker[:40])
    assert summed[40:].max() <= 255 // 5 + DIM


def test_lambert_is_the_same_in_all_directions_and_the_glossy_lobe_is_a_mirror_blurred() -> None:
    directions = np.array([on_dome(theta, azimuth) for theta in (0, 30, 60) for azimuth in range(0, 360, 30)])
    into = on_dome(30.0, 0.0)
    assert np.all(lobe(directions, into, 0.6) == 0.6)
    glossy = lobe(directions, into, 0.6, glossy=True)
    assert angles(directions[np.argmax(glossy)]) == pytest.approx((30.0, 180.0))
    assert glossy.max() == pytest.approx(0.6)
    assert glossy[np.argmin(directions @ on_dome(30.0, 180.0))] == 0.0
