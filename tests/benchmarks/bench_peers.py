"""Form factors of one closed room with two boxes, by other packages and by this one, on the same patches in one run.

Example: python tests/benchmarks/bench_peers.py --pythons peers --install --patches 500 2000 8000

Each peer runs in a Python of its own, in the folder named by --pythons; --install makes those with pip. One that is not
there, fails, or takes longer than --timeout gets a line that says so. Seconds are warm (compilers have run on a small
room), by the clock and of all threads, ours included; the latter tell more on a machine that has other work to do.
Closure is the largest |1 - Σ_j F_ij|, reciprocity ‖G - Gᵀ‖ / ‖G‖ of G_ij = A_i F_ij. The error of the light is what F
is for: area-weighted relative L2 of B - E, solved with each F as it is, against a converged answer on the same patches.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from scipy.sparse import csr_array

import radiosity as rad

PEERS = ("pyviewfactor", "raystrack")
OURS = {
    "radiosity, 256 rays": rad.MonteCarlo(256),
    "radiosity, 1024 rays": rad.MonteCarlo(1024),
    "radiosity, 4096 rays": rad.MonteCarlo(4096),
}
BOUNCES = 60


def install(name: str, folder: Path) -> None:
    """A virtual environment with one package in it."""
    subprocess.run([sys.executable, "-m", "venv", folder / name], check=True)
    subprocess.run([folder / name / "bin" / "python", "-m", "pip", "install", "-q", name], check=False)


def room(count: int) -> rad.Patches:
    """Quads of a closed room with two boxes, a lamp at the ceiling."""
    return rad.subdivide(rad.scenes.cluttered_room(2), patch_count=count)


def run_peer(
    name: str, python: Path, patches: rad.Patches, timeout: float
) -> tuple[csr_array, float, float, float] | str:
    """F, seconds by the clock and of all threads, bytes; or what went wrong."""
    if not python.exists():
        return "not installed"
    small = room(100)
    with tempfile.TemporaryDirectory() as folder:
        given, found = Path(folder, "room.npz"), Path(folder, "out.npz")
        small_arrays = {"small_vertices": small.vertices, "small_quads": small.faces}
        np.savez(given, vertices=patches.vertices, quads=patches.faces, **small_arrays)
        command = [python, Path(__file__).with_name("peers.py"), name, given, found]
        try:
            run = subprocess.run(command, timeout=timeout, capture_output=True, text=True, check=False)
        except subprocess.TimeoutExpired:
            return f"stopped after {timeout:.0f} s"
        if run.returncode:
            return f"failed: {(run.stderr.strip() or 'killed').splitlines()[-1][:80]}"
        data = np.load(found)
        entries = (data["share"], (data["row"], data["column"]))
        F = csr_array(entries, shape=(len(patches), len(patches)))
        return F, float(data["seconds"]), float(data["processor"]), float(data["peak"])


def own_peak(method: rad.MonteCarlo, count: int) -> float:
    """Largest memory of a process that computes our factors and nothing else, bytes."""
    code = (
        "import resource, radiosity as rad\n"
        f"patches = rad.subdivide(rad.scenes.cluttered_room(2), patch_count={count})\n"
        f"rad.form_factors(patches, rad.{method})\n"
        "print(1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)"
    )
    return float(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout)


def light(F: csr_array, patches: rad.Patches) -> np.ndarray:
    """B - E after so many bounces that the rest does not matter, (N, C)."""
    term = patches.emission
    total = np.zeros_like(term)
    for _ in range(BOUNCES):
        term = patches.reflectance * (F @ term)
        total += term
    return total


def reference(patches: rad.Patches, rays: int) -> tuple[np.ndarray, float]:
    """Converged B - E, and its own error."""
    found = [
        light(rad.form_factors(patches, rad.MonteCarlo(rays, seed, light_rays=8192), dtype=np.float64).matrix, patches)
        for seed in (1001, 1002)
    ]
    mean = np.mean(found, axis=0)
    return mean, error(found[0], mean, patches)


def error(found: np.ndarray, true: np.ndarray, patches: rad.Patches) -> float:
    """Area-weighted relative L2 over patches and channels."""
    area = patches.area[:, None]
    return float(np.sqrt((area * (found - true) ** 2).sum() / (area * true**2).sum()))


def line(
    name: str, F: csr_array, seconds: float, processor: float, peak: float, patches: rad.Patches, true: np.ndarray
) -> str:
    """One row of the table."""
    G = csr_array(patches.area[:, None] * F)
    defect = np.abs(1.0 - F.sum(axis=1)).max()
    reciprocity = np.sqrt(((G - G.T).data ** 2).sum() / (G.data**2).sum())
    return (
        f"| {len(patches)} | {name} | {seconds:.3g} s | {processor:.3g} s | {peak / 1e6:.0f} MB | "
        f"{100 * defect:.2g} % | {100 * reciprocity:.2g} % | {100 * error(light(F, patches), true, patches):.2g} % |"
    )


def main() -> None:
    """Print a table in markdown."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pythons", type=Path, default=Path("peers"), help="folder of the peers' environments")
    parser.add_argument("--install", action="store_true", help="make them with pip")
    parser.add_argument("--patches", type=int, nargs="+", default=[500, 2000, 8000])
    parser.add_argument("--peers", nargs="*", default=PEERS, choices=PEERS)
    parser.add_argument("--reference", type=int, default=1 << 14, help="rays a patch of the converged answer's halves")
    parser.add_argument("--timeout", type=float, default=300.0, help="seconds for a peer and a size")
    options = parser.parse_args()
    for name in options.peers if options.install else ():
        install(name, options.pythons)
    for method in OURS.values():
        rad.form_factors(room(100), method)
    print("| patches | by | clock | processors | memory | closure | reciprocity | error of the light |")
    print("|---|---|---|---|---|---|---|---|")
    for count in options.patches:
        patches = room(count)
        true, own = reference(patches, options.reference)
        for name in options.peers:
            found = run_peer(name, options.pythons / name / "bin" / "python", patches, options.timeout)
            text = f"| {len(patches)} | {name} | {found} | | | | | |" if isinstance(found, str) else ""
            print(text or line(name, *found, patches, true), flush=True)
        for name, method in OURS.items():
            begin, worked = time.perf_counter(), time.process_time()
            factors = rad.form_factors(patches, method)
            seconds, worked = time.perf_counter() - begin, time.process_time() - worked
            matrix = factors.matrix.astype(np.float64)
            print(line(name, matrix, seconds, worked, own_peak(method, count), patches, true), flush=True)
        print(f"The reference's own error at {len(patches)} patches is {100 * own:.2g} %.", flush=True)


if __name__ == "__main__":
    main()
