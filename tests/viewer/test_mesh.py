"""Patches become meshes without changing places or numbers."""

import numpy as np
import pytest

import radiosity as rad
from radiosity.viewer.mesh import corner_points, corner_weights, patch_mesh


@pytest.fixture(scope="module")
def mixed() -> rad.Patches:
    """A quad and two triangles of one surface in one plane, and a wall of another at their edge."""
    vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 1, 0.001], [0, 0, 1], [1, 0, 1]]
    paint = rad.Material(0.5)
    floor = rad.Surface("floor", vertices, [[0, 1, 2, 3], [1, 4, 2, -1], [4, 5, 2, -1]], paint)
    wall = rad.Surface("wall", vertices, [[0, 6, 7, 1]], paint)
    return rad.subdivide(rad.Scene([floor, wall]))


def test_cell_is_patch(mixed: rad.Patches) -> None:
    mesh = patch_mesh(mixed)
    assert (mesh.n_cells, mesh.n_points) == (len(mixed), 4 * len(mixed))
    np.testing.assert_allclose(mesh.compute_cell_sizes(length=False, volume=False)["Area"], mixed.area, rtol=1e-6)
    np.testing.assert_allclose(
        mesh.compute_normals(flip_normals=False, consistent_normals=False)["Normals"].shape[1], 3
    )
    for i in range(len(mixed)):
        points = corner_points(mixed)[i][: mesh.get_cell(i).n_points]
        np.testing.assert_allclose(mesh.get_cell(i).points, points)


def test_corners_blend_within_a_surface_and_not_across_a_crease(mixed: rad.Patches) -> None:
    """Each corner against a plain search for the patches that meet there."""
    points, weights = corner_points(mixed), corner_weights(mixed).toarray()
    assert weights.shape == (4 * len(mixed), len(mixed))
    for i in range(len(mixed)):
        for c in range(4):
            meet = [
                j
                for j in range(len(mixed))
                if mixed.surface[j] == mixed.surface[i]
                and mixed.normal[i] @ mixed.normal[j] > np.cos(np.radians(30))
                and np.linalg.norm(points[j] - points[i, c], axis=1).min() < 1e-9
            ]
            expected = np.zeros(len(mixed))
            expected[meet] = 1.0 / len(meet)
            np.testing.assert_allclose(weights[4 * i + c], expected, atol=1e-15)


def test_constant_light_stays_constant(solution: rad.Solution) -> None:
    weights = corner_weights(solution.patches)
    np.testing.assert_allclose(weights @ np.ones(len(solution.patches)), 1.0, rtol=1e-14)


def test_blending_does_not_leave_the_range_of_the_light(solution: rad.Solution) -> None:
    light = solution.radiosity[:, 0]
    blended = corner_weights(solution.patches) @ light
    assert light.min() - 1e-12 <= blended.min() < blended.max() <= light.max() * (1 + 1e-12)


def test_edges_of_the_blocks_stay_sharp(solution: rad.Solution) -> None:
    """Corners of a block keep to the side that they belong to: at least two values at each vertex."""
    patches = solution.patches
    block = patches.surface == patches.surface_names.index("tall_block")
    weights = corner_weights(patches)[np.repeat(block, 4)].tocoo()
    owner = np.repeat(np.flatnonzero(block), 4)[weights.row]
    aligned = np.einsum("pc,pc->p", patches.normal[owner], patches.normal[weights.col])
    assert aligned[weights.data > 0].min() > 0.999999
