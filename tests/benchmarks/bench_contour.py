"""Microseconds per pair of exact exchange areas, by how the pairs lie, with one thread and with two.

Example: python tests/benchmarks/bench_contour.py --pairs 50000

Beside it, in the same run, pyviewfactor's contour integrals on some of the same pairs, if it is installed
(pip install --no-deps pyviewfactor): one pair a call, as its users call it.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import radiosity as rad
from radiosity.form_factors.contour import exchange_area_matrix, exchange_areas

Pairs = tuple[NDArray[np.float64], NDArray[np.float64]]


def box_pairs(random: np.random.Generator, count: int) -> Pairs:
    """Random pairs of the patches of a room, 600 quads."""
    corners = rad.subdivide(rad.scenes.furnace(), patch_count=600).corners
    i, j = random.integers(len(corners), size=(2, count))
    return corners[i], corners[j]


def sphere_pairs(random: np.random.Generator, count: int) -> Pairs:
    """Random pairs of the facets of a sphere, 1280 triangles."""
    corners = rad.subdivide(rad.scenes.integrating_sphere()).corners
    i, j = random.integers(len(corners), size=(2, count))
    return corners[i], corners[j]


def neighbours(random: np.random.Generator, count: int) -> Pairs:
    """Facets of a sphere that share a corner or an edge."""
    corners = rad.subdivide(rad.scenes.integrating_sphere()).corners
    shared = (np.abs(corners[:, None, :3, None] - corners[None, :, None, :3]).sum(axis=-1) < 1e-9).any(axis=(2, 3))
    i, j = np.nonzero(shared & ~np.eye(len(corners), dtype=bool))
    pick = random.integers(len(i), size=count)
    return corners[i[pick]], corners[j[pick]]


def general(corners: int) -> Callable[[np.random.Generator, int], Pairs]:
    """Polygons of unit size in general position, their centres about one and a half apart, both facing the other."""

    def pairs(random: np.random.Generator, count: int) -> Pairs:
        made = []
        for side in (1.0, -1.0):
            turn = np.sort(random.uniform(0, 2 * np.pi, (count, 4)), axis=1)[:, :: int(side)]
            if corners == 3:
                turn[:, 3] = turn[:, 2]
            flat = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
            height = 0.75 - side * 0.75 + side * 0.2 * random.normal(size=(count, 1, 2)) * flat
            made.append(np.concatenate([flat, height.sum(axis=2, keepdims=True)], axis=2))
        return made[0], made[1]

    return pairs


def microseconds(work: Callable[[], object], count: int, repeats: int) -> float:
    """Median time of a call, per pair."""
    times = []
    for _ in range(repeats + 1):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return 1e6 * statistics.median(times[1:]) / count


def pyviewfactor_microseconds(pairs: Pairs, limit: int) -> str:
    """Time per pair of pyviewfactor, and the largest difference from ours; or why there is none."""
    try:
        import pyvista as pv
        from pyviewfactor import compute_viewfactor
    except ImportError as error:
        return f"not measured ({error})"
    ours = exchange_areas(*pairs)
    chosen = np.flatnonzero(ours > 0)[:limit]
    cells = [[_cell(pv, polygon) for polygon in polygons[chosen]] for polygons in pairs]
    compute_viewfactor(cells[0][0], cells[1][0])  # compiles
    begin = time.perf_counter()
    factors = [compute_viewfactor(a, b) for a, b in zip(*cells, strict=True)]
    each = 1e6 * (time.perf_counter() - begin) / len(chosen)
    senders = np.array([cell.area for cell in cells[1]])  # its factor is from the second to the first
    return f"{each:8.1f}   largest difference {np.abs(np.array(factors) * senders - ours[chosen]).max():.1e} m²"


def _cell(pv, polygon: NDArray[np.float64]):
    corners = polygon[:3] if (polygon[3] == polygon[2]).all() else polygon
    return pv.PolyData(corners, np.array([len(corners), *range(len(corners))]))


def main() -> None:
    """Print one line for each kind of pairs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", type=int, default=50_000)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--peer-pairs", type=int, default=300, help="pairs given to pyviewfactor")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    kinds = {
        "patches of a box": box_pairs,
        "facets of a sphere": sphere_pairs,
        "facets that touch": neighbours,
        "triangles nearby": general(3),
        "quads nearby": general(4),
    }
    begin = time.perf_counter()
    exchange_area_matrix(np.zeros((1, 4, 3)))
    print(f"{time.perf_counter() - begin:.1f} s to compile, or to load what was compiled before")
    print(f"{'µs per pair':20}{'1 thread':>10}{f'{options.threads} threads':>11}   pyviewfactor")
    for name, kind in kinds.items():
        pairs = kind(np.random.default_rng(options.seed), options.pairs)
        times = [
            microseconds(lambda pairs=pairs, n=n: exchange_areas(*pairs, threads=n), options.pairs, options.repeats)
            for n in (1, options.threads)
        ]
        print(f"{name:20}{times[0]:10.2f}{times[1]:11.2f}   {pyviewfactor_microseconds(pairs, options.peer_pairs)}")


if __name__ == "__main__":
    main()
