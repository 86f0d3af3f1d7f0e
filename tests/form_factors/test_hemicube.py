"""Hemicubes: exact delta form factors, closed rows, errors that fall with resolution and sample points."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import dblquad

import radiosity as rad
from radiosity.errors import ParameterError
from radiosity.form_factors.hemicube import delta_form_factors, pixels, sample_points
from tests.truths import load


@pytest.mark.parametrize("resolution", [2, 8, 64, 256])
def test_delta_form_factors_add_up_to_one(resolution):
    top, side = delta_form_factors(resolution)
    assert (top > 0).all() and (side > 0).all()
    assert top.sum() + 4 * side.sum() == pytest.approx(1.0, abs=1e-13)


def test_delta_form_factors_are_integrals_over_their_pixels():
    top, side = delta_form_factors(4)
    lower = np.linspace(-1, 1, 5)
    for i in range(4):
        for j in range(4):
            true, _ = dblquad(lambda y, x: 1 / (np.pi * (1 + x * x + y * y) ** 2), *lower[i : i + 2], *lower[j : j + 2])
            assert top[i, j] == pytest.approx(true, rel=1e-10)
        for j in range(2):
            rows = lower[j + 2 : j + 4]
            true, _ = dblquad(lambda z, x: z / (np.pi * (1 + x * x + z * z) ** 2), *lower[i : i + 2], *rows)
            assert side[i, j] == pytest.approx(true, rel=1e-10)


def test_pixels_cover_the_hemisphere_once():
    directions, weights = pixels(32)
    assert len(directions) == len(weights) == 3 * 32**2
    unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    assert len(np.unique(np.round(unit, 12), axis=0)) == len(unit)
    assert weights @ unit[:, :2] == pytest.approx([0.0, 0.0], abs=1e-15), "even in all four directions"
    assert weights @ unit[:, 2] == pytest.approx(2 / 3, abs=1e-3), "∫ cos² / π over the hemisphere"


@pytest.mark.parametrize("samples", [1, 2, 3, 4, 5, 6, 7, 9, 12, 16, 100])
def test_sample_points_are_even(samples):
    points = sample_points(samples)
    assert points.shape == (samples, 2)
    assert points.mean(axis=0) == pytest.approx([0.5, 0.5], abs=1e-12)
    assert (points > 0).all() and (points < 1).all()


def test_the_error_falls_with_resolution_until_the_points_limit_it():
    """Four points a patch. By the centre rule the error of F is that of one point at any resolution: 3 % here."""
    _, patches, data = load("empty_box")
    true = data["F"]

    def error(resolution, samples):
        factors = rad.form_factors(patches, rad.Hemicube(resolution, samples), dtype=np.float64)
        assert np.abs(factors.closure_defect).max() < 1e-13
        return np.linalg.norm(factors.matrix.toarray() - true) / np.linalg.norm(true)

    by_resolution = [error(r, 4) for r in (16, 32, 64)]
    assert by_resolution[0] > 1.5 * by_resolution[1] > 2 * by_resolution[2]
    assert 0.02 < by_resolution[2] < 0.045
    assert error(64, 1) > 2 * by_resolution[2]


def test_one_point_sees_what_its_patch_sees_from_the_middle():
    """Element to parallel square overhead, four corner factors: 0.2395 for a unit square at distance 1."""
    floor = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    ceiling = [[0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]]
    scene = rad.Scene([rad.Surface(n, v, [[0, 1, 2, 3]], rad.Material(0.5)) for n, v in (("f", floor), ("c", ceiling))])
    factors = rad.form_factors(rad.subdivide(scene), rad.Hemicube(512))
    half = 0.5
    root = np.sqrt(1 + half**2)
    true = 4 / (2 * np.pi) * 2 * half / root * np.arctan(half / root)
    assert factors.row(0)[1] == pytest.approx(true, abs=2e-4)
    assert factors.to_sky[0] == pytest.approx(1 - true, abs=2e-4)


@pytest.mark.parametrize(("kwargs", "message"), [({"resolution": 7}, "even"), ({"samples": 0}, "samples is 0")])
def test_parameters_that_make_no_hemicube(kwargs, message):
    with pytest.raises(ParameterError, match=message):
        rad.Hemicube(**kwargs)
