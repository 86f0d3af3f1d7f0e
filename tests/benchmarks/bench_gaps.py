"""Discretisation error of patches, and of groups of them, over the gap between the two: what `accuracy=` goes by.

Example: python -m tests.benchmarks.bench_gaps --rooms 20

Every scene is cut at several sizes. The truth of patches is the light of the same patches cut three or four times finer
along each edge, by the same rays, so that sampling hardly counts. The table goes by the share of the area that lies in
large faces which are one group each.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from types import SimpleNamespace

import numpy as np

import radiosity as rad
from radiosity.accuracy.grids import first_grid, halved, large_whole, ratios
from radiosity.faces import source_faces
from radiosity.form_factors import FormFactors
from radiosity.form_factors.merged import merged
from radiosity.nested import finer, parents
from radiosity.patches import Grid, Patches, cut
from tests.benchmarks.bench_accuracy import BUILT_IN, scene_of

SHARES = (0.0, 0.02, 0.1, 0.2, 0.35, 0.5)
MOST = 40_000  # patches of the truth


def errors_over_gap(scene: rad.Scene, fine: Grid, coarse: Grid) -> tuple[float, float]:
    """True discretisation errors of patches and of their groups, over the gap between the two."""
    patches = cut(scene, finer(fine, 4 if 16 * fine.patch_count <= MOST else 3))
    factors = rad.form_factors(patches, rad.MonteCarlo(64, seed=7))
    true = _reflected(factors, patches, patches.sky)
    (own, group), (light, group_light) = zip(
        *((p := parents(patches, grid), _together(factors, patches, p)) for grid in (fine, coarse)), strict=True
    )
    gap = _size(group_light - _means(light[own], patches, group), patches, group)
    of_patches = _size(light - _means(true, patches, own), patches, own)
    of_groups = _size(group_light - _means(true, patches, group), patches, group)
    return of_patches / gap, of_groups / gap


def _reflected(factors: FormFactors, materials: Patches | SimpleNamespace, sky: np.ndarray) -> np.ndarray:
    T = rad.TransportOperator(factors, materials)
    return rad.Neumann(rtol=1e-5).solve(T, materials.emission, sky).radiosity - materials.emission


def _together(factors: FormFactors, patches: Patches, group: np.ndarray) -> np.ndarray:
    """Reflected light of groups of patches, by the same rays."""
    count, first = int(group.max()) + 1, np.unique(group, return_index=True)[1]
    names = ("reflectance", "absorptance", "emission")
    materials = SimpleNamespace(**{name: getattr(patches, name)[first] for name in names})
    return _reflected(merged(factors, group, count, replicates=False), materials, patches.sky)


def _means(values: np.ndarray, patches: Patches, group: np.ndarray) -> np.ndarray:
    area = np.bincount(group, patches.area)
    return np.stack([np.bincount(group, column * patches.area) / area for column in values.T], axis=1)


def _size(values: np.ndarray, patches: Patches, group: np.ndarray) -> float:
    return float(np.sqrt((np.bincount(group, patches.area)[:, None] * values**2).sum()))


def cases(scene: rad.Scene) -> Iterator[tuple[float, tuple[float, float], tuple[float, float]]]:
    """Share of whole large faces, true ratios and told ratios, at several sizes."""
    faces, last = source_faces(scene), 0
    for factor in 1.3 ** np.arange(1, 11):
        fine = first_grid(faces, int(max(40, len(faces)) * factor))
        count, coarse = fine.patch_count, halved(fine)
        if count < 1.2 * last or 9 * count > MOST:
            continue
        last = count
        yield large_whole(coarse), errors_over_gap(scene, fine, coarse), ratios(fine, coarse)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rooms", type=int, default=20, help="random cluttered rooms (default: 20)")
    parser.add_argument("--scenes", nargs="*", default=[name for name in BUILT_IN if name != "parallel_plates"])
    options = parser.parse_args()
    rows = [row for n in (*options.scenes, *(f"room {k}" for k in range(options.rooms))) for row in cases(scene_of(n))]
    whole, true, told = (np.array([row[k] for row in rows]) for k in range(3))
    print("| whole large faces | cases | patches: 5 %, median, 95 % | groups: 5 %, median, 95 % |\n|---|---|---|---|")
    for low, high in zip(SHARES, (*SHARES[1:], 1.0), strict=True):
        here = true[(whole >= low) & (whole < high)]
        if len(here):
            spread = [", ".join(f"{q:.2f}" for q in np.quantile(part, (0.05, 0.5, 0.95))) for part in here.T]
            print(f"| {low:.0%} … {high:.0%} | {len(here)} | {spread[0]} | {spread[1]} |")
    spread = [", ".join(f"{q:.2f}" for q in np.quantile(part, (0.05, 0.5, 0.95))) for part in (true / told).T]
    print(f"| true over told | {len(rows)} | {spread[0]} | {spread[1]} |")


if __name__ == "__main__":
    main()
