"""Pictures against the clock: the official Cornell box beside a path tracer's picture of it, and the Blender studio.

Example: python tests/benchmarks/bench_render.py --repeats 3

Seconds are from the scene to the picture, with patches, form factors and solve. They stand beside bare tracing in the
same run: Embree's own call on as many rays as the picture needed, made beforehand, on the same threads; half of them
coherent. The error is that of all pixels but the lamp's and those on its edge, relative to the mean, the truth's own
standard errors taken off (in quadrature).
"""

from __future__ import annotations

import argparse
import statistics
import time
from pathlib import Path

import numpy as np

import radiosity as rad
from radiosity.camera import presets
from radiosity.geometry import unit
from radiosity.parallel import ordered_map
from radiosity.rays import Tracer

ROOT = Path(__file__).resolve().parents[2]
OFFICIAL = rad.Camera("official", (0.278, 0.273, -0.8), (0.278, 0.273, 0.0), fov=2 * np.degrees(np.arctan(12.5 / 35)))
BATCH = 1 << 16


class Count:
    """How many rays a picture needs: counts what goes through the tracer."""

    def __init__(self) -> None:
        self.rays = 0
        self.kept = {name: getattr(Tracer, name) for name in ("run", "hits")}

    def __enter__(self) -> Count:
        for name, method in self.kept.items():

            def counted(tracer, origins, directions, method=method):
                self.rays += len(origins)
                return method(tracer, origins, directions)

            setattr(Tracer, name, counted)
        return self

    def __exit__(self, *_: object) -> None:
        for name, method in self.kept.items():
            setattr(Tracer, name, method)


def bare_seconds(solution, camera, rays, threads):
    """Seconds that Embree takes for so many rays: half from the camera, half from patches in all directions."""
    tracer = Tracer(solution.patches.grid)
    rng = np.random.default_rng(0)
    eye, target = (tracer.to_unit(np.asarray(point)) for point in (camera.position, camera.focal_point))
    out = (target - eye) / np.linalg.norm(target - eye) + 0.3 * np.sort(rng.uniform(-1, 1, (BATCH, 3)), axis=0)
    centre = tracer.to_unit(solution.patches.centroid) + 1e-4 * solution.patches.normal
    patch = np.sort(rng.integers(len(centre), size=BATCH))
    scattered = solution.patches.normal[patch] + 0.99 * unit(rng.normal(size=(BATCH, 3)))
    batches = [(np.broadcast_to(eye, (BATCH, 3)), out), (centre[patch], scattered)]
    ready = [tuple(np.ascontiguousarray(part, dtype=np.float32) for part in batch) for batch in batches]
    begin = time.perf_counter()
    for _ in ordered_map(lambda k: tracer._scene.run(*ready[k % 2]), range(-(-rays // BATCH)), threads):
        pass
    return time.perf_counter() - begin


def error(picture):
    """Root mean square over the mean of a 256 × 256 picture of the Cornell box."""
    with np.load(ROOT / "tests" / "truth" / "cornell_image.npz") as file:
        truth, standard_error = (file[name].astype(np.float64) for name in ("radiance", "stderr"))
    shown = np.ones(truth.shape[:2], dtype=bool)
    shown[30:42, 104:152] = False
    mean_square = ((picture - truth)[shown] ** 2).mean() - (standard_error[shown] ** 2).mean()
    return np.sqrt(max(0.0, mean_square)) / truth[shown].mean()


def measure(name, scene, camera, size, options):
    """Solve and render a few times, and print medians."""
    solution = rad.solve(scene, threads=options.threads)
    camera = camera or presets(solution.patches)[0]
    with Count() as count:
        picture = rad.render(solution, camera, size, samples=options.samples, threads=options.threads)
    times = []
    for _ in range(options.repeats):
        begin = time.perf_counter()
        solution = rad.solve(scene, threads=options.threads)
        solved = time.perf_counter()
        picture = rad.render(solution, camera, size, samples=options.samples, threads=options.threads)
        ended = time.perf_counter()
        times.append((solved - begin, ended - solved, bare_seconds(solution, camera, count.rays, options.threads)))
    solving, rendering, bare = (statistics.median(column) for column in zip(*times, strict=True))
    words = f", error {error(picture):.2%}" if picture.shape[:2] == (256, 256) else ""
    print(
        f"{name} {size[0]} × {size[1]}: solve {solving:.2f} + render {rendering:.2f} = {solving + rendering:.2f} s; "
        f"{count.rays / 1e6:.1f} M rays, {rendering / bare:.2f} × bare tracing{words}",
        flush=True,
    )


def main() -> None:
    """Print one line a picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--threads", type=int, default=None)
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    box = rad.scenes.cornell_box()
    measure("Cornell box", box, OFFICIAL, (256, 256), options)
    measure("Cornell box", box, OFFICIAL, (512, 512), options)
    measure("studio", rad.read_scene(ROOT / "meshes" / "studio.glb"), None, (640, 400), options)


if __name__ == "__main__":
    main()
