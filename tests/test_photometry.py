"""Lumens in, lux out: conventions, lamps, grids, against closed forms."""

import numpy as np
import pytest

import radiosity as rad
from radiosity import photometry
from radiosity.errors import ParameterError


def test_one_channel_is_luminous_as_it_is_and_three_by_luminance():
    assert photometry.luminous([[7.0], [2.0]]).tolist() == [7.0, 2.0]
    assert photometry.luminous([1.0, 0.0, 0.0]) == pytest.approx(0.2126)
    assert photometry.luminous([0.0, 1.0, 0.0]) == pytest.approx(0.7152)
    assert photometry.luminous([[[0.0, 0.0, 1.0]]]).shape == (1, 1)
    assert photometry.luminous([1.0, 1.0, 1.0], efficacy=photometry.PEAK) == pytest.approx(683.0)
    assert photometry.luminous([1.0, 2.0], weights=[0.25, 0.5]) == pytest.approx(1.25)


@pytest.mark.parametrize("efficacy", [photometry.PHOTOMETRIC, photometry.PEAK, photometry.RADIANCE])
@pytest.mark.parametrize("colour", [[1.0], [17.0, 12.0, 4.0], [0.0, 0.0, 1.0]])
def test_lumens_in_are_lumens_out(efficacy, colour):
    emission = photometry.lamp_exitance(800.0, 0.25, colour=colour, efficacy=efficacy)
    assert 0.25 * photometry.luminous(emission, efficacy=efficacy) == pytest.approx(800.0, rel=1e-14)
    assert emission * np.sum(colour) == pytest.approx(np.array(colour) * emission.sum()), "the colour stays"


def test_all_lumens_of_a_lamp_arrive_in_a_black_closed_room():
    """Σ A H is the flux put in; a two-sided lamp counts both sides."""
    room = rad.scenes.furnace(reflectance=[0.0] * 3, emission=0.0, size=3.0)
    sheet = [[1.0, 1.5, 1.0], [1.0, 1.5, 2.0], [2.0, 1.5, 2.0], [2.0, 1.5, 1.0]]
    lamp = rad.Surface("lamp", sheet, [[0, 1, 2, 3]], rad.Material([0.0] * 3, emission=[2.0, 1.0, 1.0], two_sided=True))
    scene = rad.Scene([*room.surfaces, lamp], closed=True)
    lit = photometry.with_lumens(scene, {"lamp": 1500.0})
    emission = lit.surfaces[-1].material.emission
    assert emission[0] == pytest.approx(2 * emission[1]), "in the lamp's own colour"
    solution = rad.solve(lit, patch_count=500, estimator=rad.MonteCarlo(4096, replicates=4), dtype=np.float64)
    area = solution.patches.area[:, None]
    assert photometry.luminous(np.sum(area * solution.emission, axis=0)) == pytest.approx(1500.0, rel=1e-12)
    arrived = [
        photometry.luminous(np.sum(area * run.gather(solution.radiosity), axis=0))
        for run in solution.factors.replicates
    ]
    error = np.std(arrived, ddof=1) / 2
    assert error < 15.0
    found = photometry.luminous(solution.absorbed.sum(axis=0))
    assert abs(found - 1500.0) < 5 * error + 1e-6, "exact where the lamp's factors are"


def test_lux_below_a_corner_of_a_lamp_are_the_closed_form():
    """A point 2 m below the corner of a lamp of 1 × 1 m: E = M × Howell B-3 (a = b = 1, c = 2)."""
    room = rad.scenes.furnace(reflectance=[0.0], emission=0.0, size=6.0)
    sheet = [[2.0, 3.0, 2.0], [3.0, 3.0, 2.0], [3.0, 3.0, 3.0], [2.0, 3.0, 3.0]]
    lamp = rad.Surface("lamp", sheet, [[0, 1, 2, 3]], rad.Material(0.0))  # looks down
    lit = photometry.with_lumens(rad.Scene([*room.surfaces, lamp], closed=True), {"lamp": 2000.0})
    solution = rad.solve(lit, patch_count=60, estimator=rad.MonteCarlo(64))
    grid = photometry.point_grid([1.9, 1.0, 1.9], [0, 0, 0.2], [0.2, 0, 0], columns=1, rows=1)
    assert grid.points[0, 0] == pytest.approx([2.0, 1.0, 2.0])
    A = B = 0.5
    root = np.sqrt(1 + A * A)
    factor = (A / root * np.arctan(B / root) + B / root * np.arctan(A / root)) / (2 * np.pi)
    reading = photometry.illuminance(solution, grid, rays=1 << 16)
    assert reading.mean == pytest.approx(2000.0 * factor, rel=3e-3)
    assert reading.uniformity == 1.0
    away = photometry.illuminance(solution, photometry.PointGrid(grid.points, -grid.normal), rays=256)
    assert away.mean == 0.0 and away.uniformity == 0.0


def test_a_desk_in_a_white_furnace():
    """In a furnace every point gets E / (1 - ρ), so the grid is even to the last digit."""
    lit = photometry.with_lumens(
        rad.scenes.furnace(reflectance=0.5, emission=0.0, size=2.0),
        dict.fromkeys(rad.scenes.furnace().surface_names, 4.0 * 250.0),
    )
    solution = rad.solve(lit, patch_count=24, estimator=rad.MonteCarlo(64), solver=rad.Neumann(rtol=1e-12))
    grid = photometry.point_grid([0.4, 0.75, 0.5], [0, 0, 0.9], [0.6, 0, 0], columns=3, rows=2)
    assert grid.normal.tolist() == [0.0, 1.0, 0.0]
    reading = photometry.illuminance(solution, grid, rays=64)
    assert reading.lux == pytest.approx(np.full((2, 3), 500.0), rel=1e-6)
    assert reading.uniformity == pytest.approx(1.0, abs=1e-6)
    assert str(reading).splitlines()[-1] == "lux: mean 500.0, least 500.0, most 500.0, uniformity 1.00"


def test_points_are_in_the_middle_of_their_cells():
    grid = photometry.point_grid([0, 0, 0], [0, 0, 4], [2, 0, 0], columns=4, rows=2)
    assert grid.points.shape == (2, 4, 3)
    assert grid.points[:, :, 2] == pytest.approx(np.tile([0.5, 1.5, 2.5, 3.5], (2, 1)))
    assert grid.points[:, 0, 0] == pytest.approx([0.5, 1.5])


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: photometry.luminous([1.0, 2.0]), "has 2 channels: give weights"),
        (lambda: photometry.luminous(3.0), "has 0 channels"),
        (lambda: photometry.luminous([1.0, 2.0], weights=[1.0]), "do not fit 2 channels"),
        (lambda: photometry.luminous([1.0], weights=[-1.0]), "do not fit"),
        (lambda: photometry.lamp_exitance(-1.0, 1.0), "give a flux"),
        (lambda: photometry.lamp_exitance(1.0, 0.0), "give a flux"),
        (lambda: photometry.lamp_exitance(1.0, 1.0, colour=[0.0]), "black to the eye"),
        (lambda: photometry.lamp_exitance(1.0, 1.0, colour=[-1.0, 1.0, 1.0]), "negative somewhere"),
        (lambda: photometry.with_lumens(rad.scenes.red_rug(), {"lamb": 1.0}), "no surface or material is named 'lamb'"),
        (lambda: photometry.with_lumens(rad.scenes.furnace(), {"wall": 1.0}), "'wall' is a material"),
        (lambda: photometry.point_grid([0, 0, 0], [1, 0, 0], [2, 0, 0], 1, 1), "span no rectangle"),
        (lambda: photometry.point_grid([0, 0, 0], [1, 0, 0], [0, 1, 0], 0, 1), "0 × 1 points"),
    ],
)
def test_what_makes_no_light(call, sentence):
    with pytest.raises(ParameterError, match=sentence):
        call()
