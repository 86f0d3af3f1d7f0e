"""A lamp nearer to what it shines on than rays can tell apart is refused; one that looks away is not."""

from __future__ import annotations

import sys

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import GeometryError

LAMP, DARK = rad.Material(0.5, emission=1.0), rad.Material(0.5)


def square(name, height, facing, material=DARK, low=0.0, high=1.0):
    corners = np.array([[low, height, low], [low, height, high], [high, height, high], [high, height, low]])
    return rad.Surface(name, corners, [[0, 1, 2, 3]] if facing > 0 else [[3, 2, 1, 0]], material)


def sampled(*surfaces):
    patches = rad.subdivide(rad.Scene(surfaces, closed=False))
    return rad.form_factors(patches, rad.MonteCarlo(1 << 12, light_rays=0))


@pytest.mark.parametrize("estimator", [rad.MonteCarlo(64), rad.Hemicube(8)])
def test_too_near_is_refused_with_names_and_distances(estimator):
    patches = rad.subdivide(rad.scenes.parallel_plates(distance=0.9e-5))
    with pytest.raises(GeometryError, match=r"'lower' shines on 'upper' from 9e-06 m.*1\.41e-05 m.*Analytic"):
        rad.form_factors(patches, estimator)
    exact = rad.form_factors(patches, rad.Analytic())
    assert 1.0 - 1e-4 < exact.row(0)[1] < 1.0


def test_far_enough_off_rays_are_right():
    """Just above what is refused, all but the gap's own share arrives."""
    factors = sampled(square("lower", 0.0, +1, LAMP), square("upper", 2e-5, -1))
    assert 1.0 - 1e-3 < factors.row(0)[1] <= 1.0


def test_without_the_refusal_all_light_would_be_lost(monkeypatch):
    monkeypatch.setattr(sys.modules["radiosity.form_factors.estimate"], "check_gaps", lambda _: None)
    factors = sampled(square("lower", 0.0, +1, LAMP), square("upper", 0.9e-5, -1))
    assert factors.row(0)[1] == 0.0


def test_a_lamp_that_looks_away_from_a_near_wall_is_taken():
    """A panel a hair below the ceiling, shining down: the usual lamp."""
    lamp, floor = square("lamp", 1.0 - 5e-6, -1, LAMP, 0.3, 0.6), square("floor", 0.0, +1)
    below_a_ceiling, alone = sampled(square("ceiling", 1.0, -1), lamp, floor), sampled(lamp, floor)
    assert below_a_ceiling.row(1)[2] == pytest.approx(alone.row(0)[1], rel=0.02)
    assert alone.row(0)[1] > 0.2


def test_the_back_of_a_two_sided_lamp_shines_too():
    both = LAMP.replace(two_sided=True)
    with pytest.raises(GeometryError, match="'lamp' shines on 'ceiling'"):
        sampled(square("ceiling", 1.0, -1), square("lamp", 1.0 - 5e-6, -1, both, 0.3, 0.6), square("floor", 0.0, +1))


def test_what_touches_is_left_to_others():
    """Back to back at one height up to rounding, as boards are put together."""
    height = 0.1 + 0.2
    assert len(sampled(square("top", height, +1, LAMP), square("bottom", 0.3, -1))) == 2
