"""Light that black backs take is said, with the surfaces that look away; where none is lost, nothing is said."""

from __future__ import annotations

import re

import numpy as np
import pytest

import radiosity as rad
from radiosity.backs import light_on_backs
from radiosity.errors import GeometryWarning

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
FACES = np.array([[0, 1, 2, 3]])
RAYS = rad.MonteCarlo(rays=256, replicates=2)


def plates(*, turned: bool) -> rad.Scene:
    """A lamp over a floor at its own width: a fifth of its light meets the floor."""
    floor = rad.Surface("floor", SQUARE, FACES, rad.Material(0.5))
    lamp = rad.Surface("lamp", SQUARE + [0, 0, 1], FACES, rad.Material(0.5, emission=1.0)).turned()
    return rad.Scene([floor.turned() if turned else floor, lamp])


def test_a_floor_that_looks_down_is_named() -> None:
    with pytest.warns(GeometryWarning, match=r"20% of the lamps' light falls on the black backs.*'floor' looks away"):
        solution = rad.solve(plates(turned=True), patch_count=32, estimator=RAYS)
    assert solution.balance.to_backs.sum() == pytest.approx(0.1998 * solution.balance.emitted.sum(), rel=0.02)


def test_the_window_tells_of_it_too() -> None:
    from radiosity.viewer.status import balance_line

    with pytest.warns(GeometryWarning):
        turned = rad.solve(plates(turned=True), patch_count=32, estimator=RAYS)
    assert re.match(r"absorbed 0.0%, escaped (79.\d|80.\d)%, on black backs (19.\d|20.\d)%, ", balance_line(turned))
    assert "backs" not in balance_line(rad.solve(plates(turned=False), patch_count=32, estimator=RAYS))


def test_a_floor_that_looks_up_is_not() -> None:
    solution = rad.solve(plates(turned=False), patch_count=32, estimator=RAYS)  # warnings are errors
    assert light_on_backs(solution.patches, solution.factors) == ""


def test_no_surface_is_named_that_sees_anything() -> None:
    """A back that is met while its front is lit, too, is nobody's slip in particular."""
    shade = rad.Surface("shade", SQUARE + [0, 0, 0.5], FACES, rad.Material(0.5))
    lit = rad.Surface("second lamp", SQUARE + [0, 0, 2], FACES, rad.Material(0.5, emission=1.0)).turned()
    below = rad.Surface("first lamp", SQUARE, FACES, rad.Material(0.5, emission=4.0))
    patches = rad.subdivide(rad.Scene([below, shade, lit]), patch_count=48)
    said = light_on_backs(patches, rad.form_factors(patches, RAYS))
    assert re.match(r"\d\d% of the lamps' light falls on the black backs of one-sided faces: turn", said)


def test_a_black_lamp_whose_row_was_left_out_is_not_guessed_at() -> None:
    floor, lamp = plates(turned=False).surfaces
    black = rad.Surface("lamp", lamp.vertices, lamp.faces, rad.Material(0.0, emission=1.0))
    solution = rad.solve(rad.Scene([floor, black]), patch_count=32, estimator=RAYS)  # warnings are errors
    assert solution.lit_factors.to_backs.max() == 0.0


def test_a_sky_alone_sends_no_lamp_light() -> None:
    patches = rad.subdivide(rad.scenes.open_rug(), patch_count=40)
    assert light_on_backs(patches, rad.form_factors(patches, RAYS)) == ""
