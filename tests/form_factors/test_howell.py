"""Rays and hemicubes on meshes against closed forms of Howell's catalogue, surface to surface, within their errors.

Round bodies are polygons of equal area, so that their closed forms hold up to a tolerance that shrinks with the square
of the number of facets; it is stated with each case.
"""

from typing import NamedTuple

import numpy as np
import pytest

import radiosity as rad
from radiosity.form_factors import closed_forms as cf
from radiosity.scenes.build import sphere

SEGMENTS = 96


class Case(NamedTuple):
    """Surfaces (name: vertices, faces), the pair that is asked for, the closed form, what facets may change."""

    surfaces: dict
    source: str
    target: str
    true: float
    facets: float = 0.0


def rectangle(corner, along, across):
    """One quad that looks along `along` × `across`."""
    corner, along, across = (np.asarray(v, dtype=float) for v in (corner, along, across))
    return np.array([corner, corner + along, corner + along + across, corner + across]), [[0, 1, 2, 3]]


def ring(radius, height):
    """Corners of a polygon with the area of a disk."""
    turn = 2 * np.pi * np.arange(SEGMENTS) / SEGMENTS
    radius *= np.sqrt((2 * np.pi / SEGMENTS) / np.sin(2 * np.pi / SEGMENTS))
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.full(SEGMENTS, height)])


def disk(radius, height, facing):
    """A fan of triangles that looks up (+1) or down (-1)."""
    k = np.arange(SEGMENTS)
    faces = np.column_stack([np.full(SEGMENTS, SEGMENTS), k, (k + 1) % SEGMENTS])
    return np.vstack([ring(radius, height), [0, 0, height]]), faces if facing > 0 else faces[:, ::-1]


def tube(low_radius, high_radius, low, high, facing):
    """The side of a cylinder or cone, in quads (triangles at a tip); looks outwards (+1) or inwards (-1)."""
    k = np.arange(SEGMENTS)
    after = (k + 1) % SEGMENTS
    if high_radius == 0:
        vertices = np.vstack([ring(low_radius, low), [0, 0, high]])
        faces = np.column_stack([k, after, np.full(SEGMENTS, SEGMENTS)])
    else:
        vertices = np.vstack([ring(low_radius, low), ring(high_radius, high)])
        faces = np.column_stack([k, after, SEGMENTS + after, SEGMENTS + k])
    return vertices, faces if facing > 0 else faces[:, ::-1]


def ball(centre, radius, facing, subdivisions=2):
    return sphere(centre, radius, subdivisions, facing)


def equal_area(mesh_radius, subdivisions=2):
    """Radius for a faceted sphere with the area of a true one."""
    vertices, faces = sphere((0, 0, 0), 1.0, subdivisions, 1)
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    return mesh_radius * np.sqrt(4 * np.pi / area)


CYLINDER = {"wall": tube(1, 1, 0, 2, -1), "base": disk(1, 0, +1), "lid": disk(1, 2, -1)}
CONE = {"side": tube(1, 0, 0, 2, -1), "base": disk(1, 0, +1)}
SHELLS = {"inner": tube(0.5, 0.5, 0, 2, +1), "outer": tube(1, 1, 0, 2, -1)}
FLOOR = rectangle((0, 0, 0), (1, 0, 0), (0, 1, 0))

CASES = {
    "C-11 parallel, equal": Case(
        {"low": FLOOR, "high": rectangle((0, 0, 1), (0, 1, 0), (1, 0, 0))},
        "low",
        "high",
        cf.parallel_rectangles(1, 1, 1),
    ),
    "C-13 parallel, offset": Case(
        {
            "low": rectangle((0, 0, 0), (2, 0, 0), (0, 1, 0)),
            "high": rectangle((0.5, 2, 0.5), (0, 1, 0), (1, 0, 0)),
        },
        "low",
        "high",
        cf.parallel_rectangles_offset((0, 2), (0, 1), (0.5, 1.5), (2, 3), 0.5),
    ),
    "C-14 common edge": Case(
        {"low": FLOOR, "wall": rectangle((0, 0, 0), (0, 1, 0), (0, 0, 2))},
        "low",
        "wall",
        cf.perpendicular_rectangles(1, 2, 1),
    ),
    "C-15 perpendicular, offset": Case(
        {
            "low": rectangle((1, 0, 0), (1, 0, 0), (0, 1, 0)),
            "wall": rectangle((0, 0, 1), (0, 1, 0), (0, 0, 1)),
        },
        "low",
        "wall",
        cf.perpendicular_rectangles_offset((1, 2), (0, 1), (0, 1), (1, 2)),
    ),
    "C-41 disks": Case(
        {"low": disk(1, 0, +1), "high": disk(2, 1, -1)}, "low", "high", cf.coaxial_disks(1, 2, 1), facets=5e-4
    ),
    "C-78 cylinder, wall to itself": Case(
        CYLINDER, "wall", "wall", cf.cylinder_interior(1, 2).wall_to_itself, facets=1e-3
    ),
    "C-79 cylinder, base to wall": Case(CYLINDER, "base", "wall", cf.cylinder_interior(1, 2).base_to_wall, facets=5e-4),
    "C-40 cylinder, base to lid": Case(CYLINDER, "base", "lid", cf.cylinder_interior(1, 2).base_to_base, facets=5e-4),
    "cone, side to base": Case(CONE, "side", "base", cf.cone_interior(1, 2).side_to_base, facets=1e-3),
    "cone, side to itself": Case(CONE, "side", "side", cf.cone_interior(1, 2).side_to_itself, facets=1e-3),
    "C-91 coaxial cylinders, outer to inner": Case(
        SHELLS, "outer", "inner", cf.coaxial_cylinders(0.5, 1, 2).outer_to_inner, facets=1e-3
    ),
    "concentric spheres, outer to inner": Case(
        {"ball": ball((0, 0, 0), 0.5, +1), "shell": ball((0, 0, 0), 1, -1)},
        "shell",
        "ball",
        cf.concentric_spheres(0.5, 1).outer_to_inner,
        facets=1e-12,
    ),
    "sphere to disk": Case(
        {"ball": ball((0, 0, 1), equal_area(0.3), +1), "disk": disk(1, 0, +1)},
        "ball",
        "disk",
        cf.sphere_to_coaxial_disk(1, 1),
        facets=5e-4,
    ),
    "sphere over a corner": Case(
        {"ball": ball((0, 0, 1), equal_area(0.3), +1), "floor": FLOOR},
        "ball",
        "floor",
        cf.sphere_to_rectangle(1, 1, 1),
        facets=5e-4,
    ),
}


def patches_of(case, patch_count):
    black = rad.Material(0.0)
    scene = rad.Scene([rad.Surface(name, *mesh, black) for name, mesh in case.surfaces.items()])
    faces = len(rad.subdivide(scene))
    return rad.subdivide(scene, patch_count=max(patch_count, faces))


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize(
    "method",
    [rad.MonteCarlo(512, 11, "random"), rad.MonteCarlo(1024, 11, replicates=32)],
    ids=["random", "sobol"],
)
def test_rays_within_their_standard_error(name, method):
    case = CASES[name]
    table = rad.form_factors(patches_of(case, 64), method, dtype=np.float64).between_surfaces()
    i, j = (table.names.index(side) for side in (case.source, case.target))
    error = table.standard_error[i, j]
    assert 0.0 < error < 5e-3
    assert abs(table.matrix[i, j] - case.true) < 4.5 * error + case.facets
    leaks = 5e-5 if "cone" in name else 1e-13  # rays that start within their lift off of an acute edge
    assert table.row_sums == pytest.approx(np.ones(len(table)), abs=leaks)


@pytest.mark.parametrize("name", CASES)
def test_hemicube_from_sixteen_points_of_a_patch(name):
    """It has no standard error; within 2.5 %, which long patches beside each other need (1 % the rectangles)."""
    case = CASES[name]
    table = rad.form_factors(patches_of(case, 64), rad.Hemicube(20, samples=16), dtype=np.float64).between_surfaces()
    found = table.factor(case.source, case.target)
    assert found == pytest.approx(case.true, rel=0.025 if case.facets else 0.01, abs=5e-4)
    assert table.standard_error is None


def test_deviations_are_spread_as_standard_errors_say():
    """Over the rectangles, which have no facets, and 12 seeds: neither too small nor too large."""
    deviations = []
    for case in (case for case in CASES.values() if not case.facets):
        patches = patches_of(case, 32)
        for seed in range(12):
            table = rad.form_factors(patches, rad.MonteCarlo(256, seed, "random"), dtype=np.float64).between_surfaces()
            i, j = (table.names.index(side) for side in (case.source, case.target))
            deviations.append((table.matrix[i, j] - case.true) / table.standard_error[i, j])
    assert len(deviations) == 48
    assert abs(np.mean(deviations)) < 3 / np.sqrt(48)
    assert 0.7 < np.std(deviations) < 1.35
