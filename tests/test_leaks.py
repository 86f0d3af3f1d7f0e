"""No ray leaves a closed room: ten million of them, at any size, up to a thousand million sizes from the origin."""

from __future__ import annotations

import pytest

import radiosity as rad

from .benchmarks.leaks import SCALES, SCENES, SHIFTS, Leaks, aimed_rays, placed, random_rays


@pytest.mark.parametrize("scale", SCALES)
def test_a_few_random_and_aimed_rays(scale):
    for where in ("corner", "edge"):
        assert aimed_rays("furnace", scale, 1e6, where, rays=5000).lost == 0
    found = random_rays("furnace", scale, 1e6, rays=5000)
    assert found.rays >= 5000
    assert found.lost == 0


def test_a_hole_is_noticed():
    """The control: a room without one of its walls, declared closed."""
    room = placed("furnace", 1.0, 0.0)
    factors = rad.form_factors(
        rad.subdivide(rad.Scene(room.surfaces[1:], closed=True)), rad.MonteCarlo(rays=64, light_rays=0)
    )
    assert factors.statistics["rays/leaked"] > 30


@pytest.mark.long
@pytest.mark.parametrize("name", SCENES)
def test_ten_million_random_rays(name):
    total = Leaks(0, 0)
    for scale in SCALES:
        for shift in SHIFTS:
            total += random_rays(name, scale, shift)
    assert total.rays > 2_000_000
    assert total.lost == 0
