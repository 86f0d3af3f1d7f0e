"""Whether solutions to a stated accuracy have it: true errors of many rooms against far finer, converged answers.

Example: python -m tests.benchmarks.bench_accuracy --rooms 20 --record accuracy.jsonl

The truth of each run is the light of the run's own patches cut k × k, with independent rays, taken back to means. A run
that is in the record already is not made again, so that a long table can be made in pieces. With --by-hand, fixed
numbers of patches and rays are tried on one scene, and the fastest that has the accuracy is named.
"""

from __future__ import annotations

import argparse
import json
import time
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import radiosity as rad
from radiosity.nested import means, refined

BUILT_IN = (
    "cornell_box",
    "red_rug",
    "two_rooms",
    "hidden_lamp",
    "corridor",
    "window_room",
    "open_rug",
    "parallel_plates",
)
OBJECTS = (3, 6, 10, 15, 20)  # of the random rooms, in turn
FINE = 14_000  # patches of the truth, about


def scene_of(name: str) -> rad.Scene:
    """A built-in scene by its name, or a random cluttered room as "room 7"."""
    if name.startswith("room "):
        number = int(name.split()[1])
        return rad.scenes.cluttered_room(OBJECTS[number % len(OBJECTS)], seed=100 + number)
    return rad.scenes.BUILT_IN[name]()


def truth_of(scene: rad.Scene, patches: rad.Patches, rays: int) -> np.ndarray:
    """Reflected light (N, C) of finer patches, as means over these."""
    fine = refined(scene, patches, max(2, round((FINE / len(patches)) ** 0.5)))
    factors = rad.form_factors(fine, rad.MonteCarlo(rays, seed=4242))
    light = rad.Neumann(rtol=1e-4).solve(rad.TransportOperator(factors, fine), fine.emission, fine.sky).radiosity
    return means(light - fine.emission, fine, patches)


def error_of(patches: rad.Patches, found: np.ndarray, true: np.ndarray) -> float:
    """Area-weighted relative L2."""
    area = patches.area[:, None]
    return float(np.sqrt((area * (found - true) ** 2).sum() / (area * true**2).sum()))


def run(name: str, target: float, rays: int) -> dict[str, Any]:
    """One row of the table."""
    scene = scene_of(name)
    began = time.perf_counter(), time.process_time()
    solution = rad.solve(scene, accuracy=target)
    seconds = time.perf_counter() - began[0], time.process_time() - began[1]
    patches, accuracy = solution.patches, solution.accuracy
    last = accuracy.trials[-1]
    true = truth_of(scene, patches, rays)
    return {
        "scene": name,
        "target": target,
        "true": error_of(patches, solution.radiosity - solution.emission, true),
        "total": accuracy.total,
        "sampling": accuracy.sampling,
        "discretisation": accuracy.discretisation,
        "truncation": accuracy.truncation,
        "patches": last.patches,
        "rays": last.rays,
        "trials": len(accuracy.trials),
        "seconds": seconds[0],
        "processor": seconds[1],
    }


def by_hand(name: str, targets: list[float]) -> Iterator[str]:
    """Processor time by itself against that of the best fixed setting, for each target.

    A fixed setting has the accuracy if both of two seeds have it, against the truth on its own patches. What is
    compared is measured in turn, so that a busy machine slows down both.
    """
    scene = scene_of(name)
    tried = list(_settings(scene, min(targets)))
    for target in targets:
        chosen = rad.solve(scene, accuracy=target).accuracy.trials[-1]
        good = sorted((row for row in tried if row[1] <= target), key=lambda row: row[0])[:3]
        runs: list[Any] = [lambda t=target: rad.solve(scene, accuracy=t)]
        runs += [lambda s=row[4], t=target: rad.solve(scene, **s, solver=rad.Neumann(rtol=0.02 * t)) for row in good]
        own, *others = np.median([[_timed(run) for run in runs] for _ in range(9)], axis=0)
        best = int(np.argmin(others))
        yield (
            f"| {name} | {target:.0%} | {own:.3f} s: {chosen.patches} patches, {chosen.rays} rays | "
            f"{others[best]:.3f} s: {good[best][2]} patches, {good[best][3]} rays | {own / others[best]:.1f} × |"
        )


def _settings(scene: rad.Scene, least: float) -> Iterator[tuple[float, float, int, int, dict[str, Any]]]:
    """Seconds, error (the larger of two seeds), patches, rays, and the setting itself."""
    sides = len(rad.subdivide(scene))
    for count in sorted({sides, *(int(max(50, sides) * 2.0**k) for k in range(5))}):
        patches = rad.subdivide(scene, patch_count=count)
        true = truth_of(scene, patches, 512)
        for rays in (16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 768, 1024, 1536):
            if len(patches) * rays > 3_000_000:
                break
            errors = []
            for seed in range(2):
                method = rad.MonteCarlo(rays, seed, light_rays=max(4, 1 << round(np.log2(rays / 2))))
                began = time.process_time()
                found = rad.solve(scene, patch_count=count, estimator=method, solver=rad.Neumann(rtol=0.02 * least))
                seconds = time.process_time() - began
                errors.append(error_of(patches, found.radiosity - found.emission, true))
            yield seconds, max(errors), len(patches), rays, {"patch_count": count, "estimator": method}
            if max(errors) <= least:
                break


def _timed(function: Any) -> float:
    began = time.process_time()
    function()
    return time.process_time() - began


def table(rows: list[dict[str, Any]]) -> Iterator[str]:
    """A line for each target, and the runs that missed theirs."""
    yield "| target | runs | met | true / target: median | 5 % … 95 % | true / told: median | processor, median |"
    yield "|---|---|---|---|---|---|---|"
    for target in sorted({row["target"] for row in rows}, reverse=True):
        here = [row for row in rows if row["target"] == target]
        share = np.array([row["true"] / target for row in here])
        told = np.array([row["true"] / max(row["total"], 1e-12) for row in here])
        low, high = np.quantile(share, [0.05, 0.95])
        seconds = np.median([row["processor"] for row in here])
        met = f"{int((share <= 1).sum())} ({(share <= 1).mean():.0%})"
        yield (
            f"| {target:.0%} | {len(here)} | {met} | {np.median(share):.2f} | {low:.2f} … {high:.2f} | "
            f"{np.median(told):.2f} | {seconds:.2f} s |"
        )
    for row in rows:
        if row["true"] > row["target"]:
            yield f"missed: {row['scene']}, {row['target']:.0%}: {row['true']:.2%}, told {row['total']:.2%}"


def main() -> None:
    """Make the runs that are missing, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rooms", type=int, default=20, help="random cluttered rooms (default: 20)")
    parser.add_argument("--scenes", nargs="*", default=list(BUILT_IN), help="built-in scenes")
    parser.add_argument("--targets", type=float, nargs="+", default=[0.05, 0.02, 0.01])
    parser.add_argument("--rays", type=int, default=512, help="rays a patch of the truth (default: 512)")
    parser.add_argument("--record", type=Path, help="a file that keeps finished runs, one a line")
    parser.add_argument("--minutes", type=float, default=1e9, help="make no new run after so long")
    parser.add_argument("--by-hand", metavar="SCENE", help="compare with fixed settings on one scene instead")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    if options.by_hand:
        print("\n".join(by_hand(options.by_hand, options.targets)))
        return
    rows = []
    if options.record is not None and options.record.is_file():
        rows = [json.loads(line) for line in options.record.read_text(encoding="utf-8").splitlines()]
    done = {(row["scene"], row["target"]) for row in rows}
    names = [*options.scenes, *(f"room {k}" for k in range(options.rooms))]
    end = time.monotonic() + 60.0 * options.minutes
    for name in names:
        for target in options.targets:
            if (name, target) in done or time.monotonic() > end:
                continue
            rows.append(run(name, target, options.rays))
            if options.record is not None:
                with options.record.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(rows[-1]) + "\n")
    print("\n".join(table(rows)))


if __name__ == "__main__":
    main()
