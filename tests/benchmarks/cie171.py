"""CIE 171:2006, tests 5.6, 5.7 and 5.8, through the whole pipeline, as tables.

Example: python tests/benchmarks/cie171.py

The standard, "Test cases to assess the accuracy of lighting computer programs", has analytic answers for diffuse
light. 5.6 and 5.7 ask for the light that points on black surfaces get from one evenly lit diffuse surface S2 after one
reflection, in per cent of illuminance × reflectance; 5.8 for the mean indirect illuminance of a cube with a point
source in its middle. Table 19 (of 5.7) is wrong as printed; the values used here are those of its erratum.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import radiosity as rad

TRUTH = json.loads((Path(__file__).parents[1] / "truth" / "cie171.json").read_text(encoding="utf-8"))
SENSOR = 1e-3  # side of the patches that stand for points, m
FLUX, SIDE = 10_000.0, 4.0  # of test 5.8: lm, m

RAYS = rad.MonteCarlo(1 << 14, 0, replicates=16, light_rays=0)
METHODS = {"16384 rays": RAYS, "hemicube 256²": rad.Hemicube(256)}


def quad(corner, along, across):
    """Corners of a rectangle whose front looks along `along` × `across`."""
    corner, along, across = (np.asarray(v, dtype=float) for v in (corner, along, across))
    return np.array([corner, corner + along, corner + along + across, corner + across])


def surface(name, corners, reflectance=0.0, emission=0.0):
    """A rectangle of one material."""
    return rad.Surface(name, corners, [[0, 1, 2, 3]], rad.Material(reflectance, emission=emission))


def sensor(name, point, normal):
    """A black square millimetre about a point, which looks along `normal`."""
    along = SENSOR * np.array([1.0, 0.0, 0.0])
    across = np.cross(normal, along)
    return surface(name, quad(np.array(point) - (along + across) / 2, along, across))


def scene_5_6():
    """An evenly lit floor S2, ρ = 0.3, seen from points on a wall and on the ceiling; 1 lux falls on it."""
    wall = [sensor(name, (2.0, 0.0, 0.75 + 0.5 * k), (0, 1, 0)) for k, name in enumerate("BCDEF")]
    ceiling = [sensor(name, (2.0, 0.25 + 0.5 * k, 3.0), (0, 0, -1)) for k, name in enumerate("GHIJKLMN")]
    floor = surface("S2", quad((0, 0, 0), (4, 0, 0), (0, 4, 0)), 0.3, emission=0.3)
    return rad.Scene([floor, *wall, *ceiling], name="5.6", closed=False)


def scene_5_7():
    """An evenly lit wall S2, ρ = 0.6, seen over a black box from the opposite wall and the floor; 1 lux falls on it."""
    wall = [sensor(name, (2.0, 0.0, 2.75 - 0.5 * k), (0, 1, 0)) for k, name in enumerate("ABCDEF")]
    floor = [sensor(name, (2.0, 0.25 + 0.5 * k, 0.0), (0, 0, 1)) for k, name in enumerate("GHIJK")]
    lit = surface("S2", quad((0, 4, 0), (4, 0, 0), (0, 0, 3)), 0.6, emission=0.6)
    box = [
        surface("front", quad((0, 2.5, 0), (4, 0, 0), (0, 0, 1))),
        surface("top", quad((0, 2.5, 1), (4, 0, 0), (0, 0.2, 0))),
        surface("back", quad((0, 2.7, 1), (4, 0, 0), (0, 0, -1))),
    ]
    return rad.Scene([lit, *box, *wall, *floor], name="5.7", closed=False)


class Reading(NamedTuple):
    """What one method gives for the points: per cent of E × ρ, and standard errors (None: no estimate)."""

    percent: dict[str, float]
    error: dict[str, float] | None


def read_points(scene: rad.Scene, method: Any) -> Reading:
    """Solve a scene, and read the irradiance of its sensors."""
    solution = rad.solve(scene, patch_count=len(scene.surfaces), estimator=method, dtype=np.float64)
    table = solution.factors.between_surfaces()
    lit = scene.surfaces[0].material.emission[0]
    names = [name for name in scene.surface_names if name in TRUTH[scene.name]["configuration_factor"]]
    places = {name: scene.surface_names.index(name) for name in names}
    percent = {name: 100.0 * solution.irradiance[k, 0] / lit for name, k in places.items()}
    if table.standard_error is None:
        return Reading(percent, None)
    return Reading(percent, {name: 100.0 * table.standard_error[k, 0] for name, k in places.items()})


def read_by_points(scene: rad.Scene, rays: int = 1 << 14) -> Reading:
    """The same by `irradiance_at`: rays from the points into the solved scene."""
    solution = rad.solve(scene, patch_count=len(scene.surfaces), estimator=rad.MonteCarlo(16))
    found = {}
    for one in scene.surfaces:
        if one.name in TRUTH[scene.name]["configuration_factor"]:
            along, across = one.vertices[1] - one.vertices[0], one.vertices[3] - one.vertices[0]
            point, normal = one.vertices.mean(axis=0), np.cross(along, across)
            lit = scene.surfaces[0].material.emission[0]
            found[one.name] = 100.0 * float(solution.irradiance_at(point, normal, rays=rays)[0, 0]) / lit
    return Reading(found, None)


def solid_angle(a, b, c):
    """Solid angle of triangles a, b, c (n, 3) from the origin (A. Van Oosterom, J. Strackee 1983)."""
    length = [np.linalg.norm(v, axis=1) for v in (a, b, c)]
    triple = np.abs(np.einsum("nx,nx->n", a, np.cross(b, c)))
    dots = [np.einsum("nx,nx->n", *pair) for pair in ((a, b), (a, c), (b, c))]
    rest = length[0] * length[1] * length[2] + dots[0] * length[2] + dots[1] * length[1] + dots[2] * length[0]
    return 2.0 * np.arctan2(triple, rest)


class Room(NamedTuple):
    """Test 5.8: patches of the cube, one channel for each reflectance, and light after its first reflection."""

    patches: rad.Patches
    reflectance: list[float]
    emission: Any


def room_5_8(patch_count: int = 384) -> Room:
    """The cube, with what the point source's light is after its first reflection as emission, patch by patch."""
    rho = [float(key) for key in TRUTH["5.8"]["mean_indirect_lux"]]
    cube = rad.scenes.furnace(reflectance=rho, emission=[0.0] * len(rho), size=SIDE)
    patches = rad.subdivide(cube, patch_count=patch_count)
    corners = patches.corners - SIDE / 2
    angle = solid_angle(*(corners[:, k] for k in (0, 1, 2))) + solid_angle(*(corners[:, k] for k in (0, 2, 3)))
    direct = FLUX / (4 * np.pi) * angle / patches.area
    return Room(patches, rho, direct[:, None] * np.array(rho))


def mean_indirect(room: Room, factors: rad.FormFactors, bounces: int | None = None):
    """Mean illuminance of the cube by reflected light, lux, for each reflectance; up to a number of reflections."""
    T = rad.TransportOperator(factors, room.patches)
    solver = rad.Neumann(rtol=1e-9, maxiter=5000, keep_bytes=0)
    if bounces is not None:  # the emission is the first reflection, and arriving is not yet another
        solver = rad.Neumann(rtol=0.0, maxiter=bounces - 1)
    light = solver.solve(T, room.emission).radiosity
    return np.average(factors.gather(light), axis=0, weights=room.patches.area)


def print_points(scene: rad.Scene) -> None:
    """One line for each point: the standard, the closed form, and what every method reads."""
    truth = TRUTH[scene.name]
    readings = {name: read_points(scene, method) for name, method in METHODS.items()}
    readings["from the points"] = read_by_points(scene)
    try:
        readings["contour integrals"] = read_points(scene, rad.Analytic())
    except rad.errors.OccludedSceneError as error:
        print(f"\n{scene.name}: Analytic() refuses, as it should: {error}")
    print(f"\nCIE 171:2006, {scene.name}: per cent of E × ρ at the points")
    print("point   table    exact" + "".join(f"{name:>18}" for name in readings))
    for name, factor in truth["configuration_factor"].items():
        cells = [
            f"{one.percent[name]:8.3f}" + (f" ± {one.error[name]:.4f} " if one.error else " " * 10)
            for one in readings.values()
        ]
        print(f"{name:5} {truth['published_percent'][name]:7.2f} {100 * factor:8.3f}  " + " ".join(cells))


def print_room(patch_count: int) -> None:
    """One line for each reflectance, exact factors and rays, to the end and cut at 8 reflections."""
    room = room_5_8(patch_count)
    exact = rad.form_factors(room.patches, rad.Analytic(), dtype=np.float64)
    rays = rad.form_factors(room.patches, rad.MonteCarlo(1024, 0, replicates=8), dtype=np.float64)
    whole, cut = mean_indirect(room, exact), mean_indirect(room, exact, bounces=8)
    raw = mean_indirect(room, rays)
    error = np.std([mean_indirect(room, run) for run in rays.replicates], axis=0, ddof=1) / np.sqrt(8)
    conserved = mean_indirect(room, rays.conserved())
    print(f"\nCIE 171:2006, 5.8: mean indirect illuminance, lux ({len(room.patches)} patches)")
    print("    ρ   table      formula  exact factors     conserved        1024 rays          8 reflections")
    for c, rho in enumerate(room.reflectance):
        key = str(rho)
        formula = FLUX * rho / (6 * SIDE**2 * (1 - rho))
        print(
            f"{rho:5.2f} {TRUTH['5.8']['published_lux'][key]:7} {formula:12.4f} {whole[c]:14.4f} {conserved[c]:13.4f} "
            f"{raw[c]:10.2f} ± {error[c]:<6.2f} {cut[c]:10.2f} ({cut[c] / formula - 1:+.1%})"
        )


def main() -> None:
    """Print the three tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--patches", type=int, default=384, help="of the cube in 5.8")
    options = parser.parse_args()
    print_points(scene_5_6())
    print_points(scene_5_7())
    print_room(options.patches)


if __name__ == "__main__":
    main()
