"""What is saved by leaving out what a scene does not need: seconds, rays and bytes with and without, in one run.

Example: python -m tests.benchmarks.bench_plan --patches 6000
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np

import radiosity as rad
from radiosity.scenes.build import panel, room
from tests.plan.scenes import GREY, LAMP, black_dome, flat, thin_walls, two_flats

RGB = rad.Material([0.7, 0.5, 0.3])


def convex_room() -> rad.Scene:
    """Coloured walls and a lamp let into the ceiling; nothing hides anything."""
    light = ((1.5, 3.0, 1.5), (2.5, 3.0, 2.5))
    lamp = rad.Surface("lamp", *panel(*light, -1), rad.Material([0.5] * 3, emission=[9.0, 8.0, 7.0]))
    return rad.Scene([*room((0, 0, 0), (4, 3, 4), RGB, {"ceiling": [light]}), lamp], name="convex_room", closed=True)


def grey_room() -> rad.Scene:
    """Grey walls, and a lamp that hangs in the room."""
    return rad.Scene([*flat(0, material=GREY), LAMP], name="grey_room")


SCENES: dict[str, Callable[[], rad.Scene]] = {
    "an empty convex room": convex_room,
    "a grey room": grey_room,
    "a room half of whose surfaces no light reaches": thin_walls,
    "a dark adjoining flat": two_flats,
    "a one-bounce dome": black_dome,
}


def measured(scene: rad.Scene, patches: int, leave_out: bool) -> tuple[float, float, int, rad.Solution]:
    """Seconds of the wall and of processors, bytes of factors and orders, and the light."""
    began = time.perf_counter(), time.process_time()
    method = rad.MonteCarlo(rays=256, replicates=2)
    solution = rad.solve(scene, patch_count=patches, estimator=method, dtype=np.float32, leave_out=leave_out)
    seconds = time.perf_counter() - began[0], time.process_time() - began[1]
    made = solution.__dict__["made_factors"]
    stored = sum(part.matrix.data.nbytes + part.matrix.indices.nbytes for part in (made, *made.replicates))
    return *seconds, stored, solution


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--patches", type=int, default=6000)
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    print("| scene | left out | processor s | without | saved | MB | without | rays | without | light |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for name, make in SCENES.items():
        runs: dict[bool, list[tuple[float, float, int, rad.Solution]]] = {True: [], False: []}
        for some in (True, False):
            measured(make(), 500, some)  # kernels are there
        for _ in range(options.repeats):
            for some in (True, False):
                runs[some].append(measured(make(), options.patches, some))
        clock = {some: float(np.median([run[1] for run in runs[some]])) for some in runs}
        size = {some: runs[some][0][2] / 1e6 for some in runs}
        one, other = runs[True][0][3], runs[False][0][3]
        rays = [s.statistics["rays/traced"] + s.statistics["rays/to emitters"] for s in (one, other)]
        same = one.radiosity.tobytes() == other.radiosity.tobytes()
        area = one.patches.area[:, None]
        moved = np.sqrt((area * (one.radiosity - other.radiosity) ** 2).sum() / (area * other.radiosity**2).sum())
        left_out = ", ".join(item.name for item in one.plan.left_out if item.seconds > 0)
        print(
            f"| {name} | {left_out} | {clock[True]:.2f} | {clock[False]:.2f} | {1 - clock[True] / clock[False]:.0%} | "
            f"{size[True]:.1f} | {size[False]:.1f} | {rays[0]:,} | {rays[1]:,} | "
            f"{'same bits' if same else f'{moved:.1g} apart'} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
