"""Exact factors where nobody asked for a method: in small scenes in which nothing hides anything, and only there."""

import numpy as np
import pytest

import radiosity as rad
from radiosity.plan.plan import make_plan
from tests.truths import load, relative_error

FLOOR = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]], float)
WALL = np.array([[0, 0, 0], [0, 1, 0], [0, 1, 1], [0, 0, 1]], float)


def wall_and_floor(*more):
    surfaces = [
        rad.Surface("floor", FLOOR, [[0, 1, 2, 3]], rad.Material(0.5)),
        rad.Surface("wall", WALL, [[0, 1, 2, 3]], rad.Material(0.5)),
    ]
    return rad.Scene([*surfaces, *more], sky=1.0)


def rug(height=0.0, scale=0.5):
    return rad.Surface("rug", FLOOR * scale + [0.2, height, 0.2], [[0, 1, 2, 3]], rad.Material(0.1))


def chosen(scene, count=100, **settings):
    return make_plan(rad.subdivide(scene, patch_count=count), **settings).estimator


@pytest.mark.parametrize("name", ["furnace", "parallel_plates", "open_rug", "red_rug"])
def test_small_scenes_without_anything_in_between(name):
    solution = rad.solve(rad.scenes.BUILT_IN[name](), patch_count=300)
    assert solution.factors.estimator == rad.Analytic()
    assert solution.plan["sampling"].left_out and "all pairs are exact" in str(solution.plan)
    assert solution.certificate.verdict == "certified" and solution.certificate.sampling == 0.0


def test_orders_of_a_wall_under_the_sky():
    """As they come from `solve`: no sampling error is left."""
    scene, patches, data = load("openrug")
    solution = rad.solve(scene, patch_count=len(patches), bounces=6)
    assert solution.factors.estimator == rad.Analytic()
    for k in range(1, 7):
        assert relative_error(patches, solution.orders[k], data["B_disc"][k]) < 1e-5


def test_the_same_light_as_by_rays():
    one, other = (rad.solve(rad.scenes.open_rug(), patch_count=300, leave_out=left) for left in (True, False))
    assert isinstance(other.factors.estimator, rad.MonteCarlo)
    apart = relative_error(one.patches, other.radiosity, one.radiosity)
    assert 0.0 < apart < 3.0 * other.certificate.sampling


def test_not_where_something_may_be_hidden():
    assert isinstance(chosen(rad.scenes.cornell_box()), rad.MonteCarlo)
    assert isinstance(chosen(wall_and_floor(rug(height=0.3))), rad.MonteCarlo)


def test_not_of_many_patches():
    assert chosen(wall_and_floor(), 900) == rad.Analytic()
    assert isinstance(chosen(wall_and_floor(), 1100), rad.MonteCarlo)


def test_not_where_rays_or_rows_were_asked_for():
    scene = wall_and_floor()
    for settings in (
        {"estimator": rad.MonteCarlo(64)},
        {"leave_out": False},
        {"rows_at_will": False},
        {"solver": rad.Shooting()},
    ):
        assert isinstance(chosen(scene, **settings), rad.MonteCarlo)


def test_not_where_surfaces_lie_in_each_other():
    assert chosen(wall_and_floor()) == rad.Analytic()
    assert isinstance(chosen(wall_and_floor(rug())), rad.MonteCarlo)


def test_what_lies_in_each_other_would_be_seen_twice():
    """Negative control: what the look for such surfaces is for."""
    scene = wall_and_floor(rug(scale=0.75))
    patches = rad.subdivide(scene, patch_count=100)
    wall = patches.surface == 1
    rays = rad.form_factors(patches, rad.MonteCarlo(1024)).to_sky[wall]
    twice = rad.form_factors(patches, rad.Analytic()).to_sky[wall]
    assert rays.mean() > 1.05 * twice.mean()


def test_a_stiff_room():
    """Exact factors balance as conjugate gradients need them."""
    room = rad.scenes.furnace()
    white = rad.Scene(
        [rad.Surface(s.name, s.vertices, s.faces, rad.Material(absorptance=1e-9, emission=1.0)) for s in room.surfaces],
        closed=True,
    )
    solution = rad.solve(white, patch_count=96)
    assert solution.factors.estimator == rad.Analytic()
    assert solution.radiosity == pytest.approx(np.full_like(solution.radiosity, 1e9), rel=1e-6)
