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


def by_hand(name: str, target: float) -> None:
    """Time of fixed settings that have the accuracy, each against the truth on its own patches."""
    scene = scene_of(name)
    chosen = rad.solve(scene, accuracy=target)  # warm
    times = sorted(_timed(lambda: rad.solve(scene, accuracy=target)) for _ in range(3))
    good = []
    sides = len(rad.subdivide(scene))
    for count in sorted({max(100, sides), *(int(max(100, sides) * 2.0**k) for k in range(1, 5))}):
        patches = rad.subdivide(scene, patch_count=count)
        true = truth_of(scene, patches, 1024)
        for rays in (32, 64, 128, 256, 512, 1024, 2048):
            if len(patches) * rays > 6_000_000:
                continue
            method = rad.MonteCarlo(rays, light_rays=max(4, rays // 2))
            settings = {"patch_count": count, "estimator": method, "solver": rad.Neumann(rtol=0.02 * target)}
            found = rad.solve(scene, **settings)
            if error_of(patches, found.radiosity - found.emission, true) <= target:
                clock = sorted(_timed(lambda s=settings: rad.solve(scene, **s)) for _ in range(3))
                good.append((clock[1], len(patches), rays))
                break
    best = min(good)
    last = chosen.accuracy.trials[-1]
    print(
        f"{name}, {target:.0%}: by itself {times[1]:.3f} s of processors ({last.patches} patches, {last.rays} rays), "
        f"by hand {best[0]:.3f} s ({best[1]} patches, {best[2]} rays): {times[1] / best[0]:.1f} ×"
    )


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
        for target in options.targets:
            by_hand(options.by_hand, target)
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
