"""What a point sees, held against closed forms, against rays of other kinds, and against the solver's own factors."""

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import ParameterError
from radiosity.form_factors.closed_forms.elements import element_to_parallel_rectangle
from radiosity.hemisphere import hemisphere_at
from radiosity.rays import BACK, MISS, Tracer


@pytest.fixture(scope="module")
def box() -> rad.Solution:
    return rad.solve(rad.scenes.cornell_box(), patch_count=600, estimator=rad.MonteCarlo(rays=1024), bounces=8)


def nearest(patches: rad.Patches, surface: str, point: tuple[float, float, float]) -> int:
    mine = np.flatnonzero(patches.surface == patches.surface_names.index(surface))
    return int(mine[np.argmin(np.linalg.norm(patches.centroid[mine] - point, axis=1))])


@pytest.mark.parametrize(("rings", "sectors"), [(90, 360), (1, 1), (7, 3)])
def test_cells_add_up_to_pi(box: rad.Solution, rings: int, sectors: int) -> None:
    view = hemisphere_at(box.patches, 0, rings=rings, sectors=sectors)
    assert view.seen.shape == (rings, sectors)
    assert view.weights.sum() * sectors == pytest.approx(np.pi, rel=1e-14)


def test_furnace() -> None:
    """The same radiance from everywhere: H = π L_i, and L_o = L_e + ρ L_i is that radiance again."""
    solution = rad.solve(rad.scenes.furnace(reflectance=0.7), patch_count=96, dtype=np.float64)
    for patch in (0, 40, 95):
        view = hemisphere_at(solution.patches, patch)
        radiance = view.radiance(solution.radiosity)
        np.testing.assert_allclose(view.irradiance(radiance), solution.radiosity[patch], rtol=3e-6)
        leaving = (solution.emission[patch] + 0.7 * view.irradiance(radiance)) / np.pi
        np.testing.assert_allclose(leaving, radiance[0, 0], rtol=3e-6)


def test_a_plate_under_the_sky() -> None:
    plate = rad.Surface("plate", [[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]], [[0, 1, 2, 3]], rad.Material(0.5))
    patches = rad.subdivide(rad.Scene([plate], sky=[1.0, 2.0]), 4)
    view = hemisphere_at(patches, 2)
    assert np.all(view.seen == MISS)
    np.testing.assert_allclose(view.irradiance(view.radiance(np.zeros((4, 2)), [1.0, 2.0])), [np.pi, 2 * np.pi])
    np.testing.assert_array_equal(view.irradiance(view.radiance(np.ones((4, 2)))), 0.0)


def test_black_backs_send_nothing() -> None:
    """A plate above that looks away: it is met, and it is black."""
    paint = rad.Material(0.5)
    below = rad.Surface("below", [[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]], [[0, 1, 2, 3]], paint)
    above = rad.Surface("above", [[-9, 1, -9], [-9, 1, 9], [9, 1, 9], [9, 1, -9]], [[0, 1, 2, 3]], paint)
    patches = rad.subdivide(rad.Scene([below, above], sky=[1.0]))
    view = hemisphere_at(patches, 0)
    assert view.seen[0, 0] == BACK
    assert view.seen[-1, 0] == MISS
    assert view.irradiance(view.radiance(np.ones((2, 1)), [1.0]))[0] < 0.05 * np.pi


def test_a_lamp_against_its_closed_form() -> None:
    """A square lamp above a floor: H / B is the factor of an element to a rectangle; off by half a cell at its rim."""
    high, half = 0.8, 0.25
    floor = rad.Surface("floor", [[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]], [[0, 1, 2, 3]], rad.Material(0.5))
    lamp = rad.Surface(
        "lamp",
        [[-half, high, -half], [half, high, -half], [half, high, half], [-half, high, half]],
        [[0, 1, 2, 3]],
        rad.Material(0.0, emission=3.0),
    )
    patches = rad.subdivide(rad.Scene([floor, lamp]))
    view = hemisphere_at(patches, 0)
    found = view.irradiance(view.radiance(patches.emission))[0]
    exact = 3.0 * 4.0 * element_to_parallel_rectangle(half, half, high)
    assert found == pytest.approx(exact, rel=0.01)
    fine = hemisphere_at(patches, 0, rings=720, sectors=2880)
    assert fine.irradiance(fine.radiance(patches.emission))[0] == pytest.approx(exact, rel=1e-3)


def test_the_sum_is_what_other_rays_find_there(box: rad.Solution) -> None:
    """At 40 points of the Cornell box, against 32768 cosine rays each: 1.5 % in the root mean square."""
    patches, tracer = box.patches, Tracer(box.patches.grid)
    points = np.linspace(0, len(patches) - 1, 40).astype(int)
    expected = box.irradiance_at(patches.centroid[points], patches.normal[points], rays=1 << 15).sum(axis=1)
    views = [hemisphere_at(patches, int(i), tracer=tracer) for i in points]
    found = np.array([view.irradiance(view.radiance(box.radiosity)).sum() for view in views])
    off = found / expected - 1.0
    assert np.sqrt(np.mean(off**2)) < 0.015
    assert np.abs(off).max() < 0.05


def test_the_sum_is_the_irradiance_of_the_patch(box: rad.Solution) -> None:
    """The dome stands at the patch's middle and the solver knows the mean over it: 5 % in the root mean square here."""
    patches, tracer = box.patches, Tracer(box.patches.grid)
    points = np.linspace(3, len(patches) - 4, 60).astype(int)
    views = [hemisphere_at(patches, int(i), tracer=tracer) for i in points]
    found = np.array([view.irradiance(view.radiance(box.radiosity)).sum() for view in views])
    weight, solved = patches.area[points], box.irradiance[points].sum(axis=1)
    error = np.sqrt(np.sum(weight * (found - solved) ** 2) / np.sum(weight * solved**2))
    assert error < 0.05
    mean = np.sum(weight * found) / np.sum(weight * solved)
    assert mean == pytest.approx(1.0, abs=0.02)


def test_the_running_sum_grows_to_the_whole(box: rad.Solution) -> None:
    view = hemisphere_at(box.patches, nearest(box.patches, "floor", (0.3, 0.0, 0.1)))
    radiance = view.radiance(box.radiosity)
    running = view.running_sum(radiance)
    assert running.shape == (121, 3)
    assert np.all(running[0] == 0.0)
    assert np.all(np.diff(running, axis=0) >= 0.0)
    theta = np.radians(0.75 * (np.arange(120) + 0.5))
    by_hand = np.sum(radiance * (np.cos(theta) * np.sin(theta))[:, None, None], axis=(0, 1)) * np.radians(0.75) ** 2
    np.testing.assert_allclose(running[-1], by_hand, rtol=1e-3)


def test_directions_stand_upright_and_see_what_is_there(box: rad.Solution) -> None:
    patches = box.patches
    patch, lamp = nearest(patches, "floor", (0.3, 0.0, 0.1)), nearest(patches, "lamp", (0.278, 0.55, 0.28))
    view = hemisphere_at(patches, patch)
    np.testing.assert_allclose(view.frame @ view.frame.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(view.frame) == pytest.approx(1.0)
    np.testing.assert_allclose(view.direction(0.0, 123.0), patches.normal[patch], atol=1e-12)
    assert view.direction(90.0, 90.0) @ [0.0, 0.0, -1.0] > 0.99
    x, y, z = view.frame @ (patches.centroid[lamp] - view.point)
    theta, azimuth = np.degrees(np.arctan2(np.hypot(x, y), z)), np.degrees(np.arctan2(y, x))
    assert patches.surface_names[patches.surface[view.seen_at(theta, azimuth)]] == "lamp"
    wall = hemisphere_at(patches, nearest(patches, "back_wall", (0.278, 0.3, 0.56)))
    np.testing.assert_allclose(wall.direction(90.0, 90.0), [0.0, 1.0, 0.0], atol=1e-6)


def test_there_is_no_such_patch(box: rad.Solution) -> None:
    with pytest.raises(ParameterError, match=f"no patch {len(box.patches)}; there are {len(box.patches)}"):
        hemisphere_at(box.patches, len(box.patches))
    with pytest.raises(ParameterError, match="0 rings and 5 sectors"):
        hemisphere_at(box.patches, 0, rings=0, sectors=5)
