"""Groups of patches: every patch in one, and what is linear along a face stays so."""

import numpy as np
import pytest

import radiosity as rad
from radiosity.face_points import patch_point
from radiosity.form_factors.groups import CORNER_SAMPLES, group_patches
from radiosity.rays import Tracer


def scene():
    """A rectangle, a two-sided triangle and a trapezoid."""
    square = [[0, 0, 0], [2, 0, 0], [2, 3, 0], [0, 3, 0]]
    sail = [[0, 0, 1], [1, 0.2, 1], [0.3, 1.1, 1.5]]
    trapezoid = [[0, 0, 3], [2, 0, 3], [1.6, 1, 3], [0.2, 1, 3]]
    return rad.Scene(
        [
            rad.Surface("square", np.array(square, float), [[0, 1, 2, 3]], rad.Material(0.5)),
            rad.Surface("sail", np.array(sail, float), [[0, 1, 2]], rad.Material(0.5, two_sided=True)),
            rad.Surface("trapezoid", np.array(trapezoid, float), [[0, 1, 2, 3]], rad.Material(0.5)),
        ]
    )


@pytest.fixture(scope="module", params=[2, 3, 5])
def grouped(request):
    patches = rad.subdivide(scene(), patch_count=1000)
    return patches, group_patches(patches, request.param)


def corner_places(patches, groups):
    """Coordinates (M, 4, 3) of the corners of groups, as rays start from them."""
    tracer = Tracer(patches.grid)
    table = tracer.table._replace(columns=groups.grid.columns, rows=groups.grid.rows)
    places = np.empty((len(groups), 4, 3))
    for g in range(len(groups)):
        f, first = groups.face[g], groups.grid.front if groups.side[g] > 0 else groups.grid.back
        for k, (s, t) in enumerate(CORNER_SAMPLES[0 if patches.grid.faces.quad[f] else 1]):
            patch_point(table, f, g - first[f], float(groups.side[g]), s, t, places[g, k])
    return places / tracer.scale + tracer.centre


def test_a_group_holds_neighbours_of_one_side_of_one_face(grouped):
    patches, groups = grouped
    assert (groups.face[groups.of_patch] == patches.face).all()
    assert (groups.side[groups.of_patch] == patches.side).all()
    assert groups.patches.sum() == len(patches)
    places = corner_places(patches, groups)
    low, high = (end(places, axis=1)[groups.of_patch] for end in (np.min, np.max))
    size = (high - low).max()
    assert (patches.centroid > low - 0.05 * size).all()
    assert (patches.centroid < high + 0.05 * size).all()


def test_neighbours_share_their_corners(grouped):
    """Corners of one number are one place (but for the hair by which rays start inside), and none is counted twice."""
    patches, groups = grouped
    points, places = groups.corners.ravel(), corner_places(patches, groups).reshape(-1, 3)
    order = np.argsort(points, kind="stable")
    same = points[order][1:] == points[order][:-1]
    assert same.sum() > len(groups)
    assert np.linalg.norm(np.diff(places[order], axis=0)[same], axis=1).max() < 0.01 * np.sqrt(groups.area.max())
    columns, rows, quad = groups.grid.columns, groups.grid.rows, groups.grid.faces.quad
    expected = np.where(quad, (columns + 1) * (rows + 1), (columns + 1) * (columns + 2) // 2)
    assert len(np.unique(points)) == (expected * (1 + groups.grid.faces.two_sided)).sum()


def test_what_is_linear_is_spread_without_error(grouped):
    """Places of the corners, spread, are the places of the patches; weights are shares."""
    patches, groups = grouped
    where = np.zeros((groups.corners.max() + 1, 3))
    where[groups.corners] = corner_places(patches, groups)
    points, weights = groups.spread(np.arange(len(patches)))
    assert weights.min() >= 0.0
    assert weights.sum(axis=1) == pytest.approx(np.ones(len(patches)), abs=1e-12)
    found = (weights[..., None] * where[points]).sum(axis=1)
    error = np.linalg.norm(found - patches.centroid, axis=1)
    straight = patches.surface != 2  # a trapezoid's middle in (u, v) is not its centre of area
    assert error[straight].max() < 0.01 * np.sqrt(groups.area.max())
    assert error.max() < 0.1 * np.sqrt(patches.area.max())
    left_out = np.abs(np.where(weights > 0.5, 0.0, weights)[..., None] * where[points]).sum(axis=1)
    assert np.linalg.norm(left_out - patches.centroid, axis=1).max() > 0.1  # negative control
