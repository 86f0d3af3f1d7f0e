"""What the built-in scenes are for: the light in them does what their docstrings say."""

import numpy as np
import pytest

import radiosity as rad
from radiosity import scenes


def solved(scene, patch_count=None, rays=256, bounces=6):
    patches = rad.subdivide(scene, patch_count=patch_count)
    factors = rad.form_factors(patches, rad.MonteCarlo(rays=rays, seed=0))
    operator = rad.TransportOperator(factors, patches)
    return patches, factors, operator.orders(patches.emission, sky=patches.sky, count=bounces)


def of(patches, name):
    return patches.surface == patches.surface_names.index(name)


@pytest.mark.parametrize("reflectance", [0.2, 0.5, 0.9])
def test_ball_under_a_uniform_dome_leaves_rho_times_the_sky(reflectance):
    _, _, orders = solved(scenes.uniform_dome(reflectance, sky=3.0))
    radiance = orders.sum(axis=0) / np.pi
    assert np.abs(radiance - 3.0 * reflectance).max() < 1e-12


def test_hidden_lamp_gives_no_direct_light_below_its_height():
    patches, _, orders = solved(scenes.hidden_lamp(), patch_count=600)
    for name in ("floor", "chest", "back_wall", "front_wall", "left_wall", "right_wall"):
        assert (orders[1][of(patches, name)] == 0).all(), name
        assert (orders[2][of(patches, name)] > 0).any(), name
    assert (orders[1][of(patches, "ceiling")] > 0).all()


def test_integrating_sphere_lights_itself_evenly():
    """Irradiance of every order: power × ρ^(k-1) / area; facets and rays cost some percent."""
    patches, _, orders = solved(scenes.integrating_sphere(0.9, emission=7.0), rays=1024, bounces=4)
    area = patches.area.sum()
    power = (patches.area[:, None] * patches.emission).sum()
    for k in range(2, 5):
        irradiance = orders[k][:, 0] / 0.9
        expected = power * 0.9 ** (k - 1) / area
        assert np.average(irradiance, weights=patches.area) == pytest.approx(expected, rel=0.005)
        assert np.std(irradiance) / expected < 0.03


def test_lit_ball_fades_by_the_cosine():
    """Radiosity of order 1 is ρ π cos θ on the lit side and nothing behind the terminator."""
    patches, _, orders = solved(scenes.lit_sphere(0.8, subdivisions=3), rays=64, bounces=1)
    lamp = of(patches, "lamp")
    ball = patches.surface != patches.surface[lamp][0]
    facing = patches.normal[lamp][0]
    middle = np.average(patches.centroid[lamp], axis=0, weights=patches.area[lamp])
    ray = middle - patches.centroid[ball]
    distance = np.linalg.norm(ray, axis=1)
    cosine = np.einsum("nx,nx->n", patches.normal[ball], ray) / distance
    radiance = patches.emission[lamp][0, 0] / np.pi
    expected = 0.8 * radiance * patches.area[lamp].sum() * cosine * (-ray @ facing) / distance**3
    light = orders[1][ball, 0]
    assert (light[cosine < -0.2] == 0).all()
    lit = cosine > 0.2
    assert light[lit] == pytest.approx(expected[lit], rel=0.03)  # a lamp of 2 m is no point
    assert light.max() == pytest.approx(0.8 * np.pi, rel=0.05)


def test_parallel_plates_see_each_other_by_howell():
    _, factors, _ = solved(scenes.parallel_plates(), rays=4096)
    assert factors.matrix.toarray()[0, 1] == pytest.approx(0.199824895698387, abs=0.003)


def test_pink_walls_come_with_order_two():
    """White walls beside a red rug: under direct light grey, and red from order 2 on."""
    patches, _, orders = solved(scenes.red_rug(), patch_count=500)
    wall = of(patches, "left_wall")
    warm = [np.average(order[wall], axis=0, weights=patches.area[wall]) for order in orders]
    redness = [light[0] / light[2] / (12.0 / 9.5) for light in warm[1:3]]
    assert redness[0] == pytest.approx(1.0, abs=1e-6)
    assert redness[1] > 1.4
    assert (orders[1][of(patches, "ceiling")] == 0).all()


def test_rooms_farther_down_the_corridor_are_fainter_and_later():
    patches, _, orders = solved(scenes.corridor(rooms=3), patch_count=900, bounces=12)
    power = np.array([[np.sum(o[m, 0] * patches.area[m]) for o in orders] for m in (
        of(patches, "floor_1"), of(patches, "floor_2"), of(patches, "floor_3"))])  # fmt: skip
    total = power.sum(axis=1)
    assert total[0] > 5 * total[1] > 25 * total[2] > 0
    assert np.all(np.diff(power @ np.arange(13) / total) > 1)  # later by more than a bounce a room, on average


def test_pinhole_passes_its_share():
    """What reaches the far room per bounce is the pinhole's share: ten times the side, a hundred times the light."""
    arrived = []
    for door in (0.1, 1.0):
        patches, _, orders = solved(scenes.two_rooms(door=door), patch_count=700, rays=4096, bounces=8)
        far = np.isin(patches.surface, [k for k, n in enumerate(patches.surface_names) if n.endswith("_2")])
        arrived.append(np.sum(orders.sum(axis=0)[far, 0] * patches.area[far]))
    assert arrived[1] / arrived[0] == pytest.approx(100, rel=0.25)


def test_window_room_is_lit_from_the_window():
    patches, _, orders = solved(scenes.window_room(), patch_count=500)
    assert (orders[0] == 0).all()
    near = of(patches, "floor") & (patches.centroid[:, 0] < 1.2)
    far = of(patches, "floor") & (patches.centroid[:, 0] > 4.0)
    assert orders[1][near].mean() > 5 * orders[1][far].mean() > 0
