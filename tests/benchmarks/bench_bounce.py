"""One bounce beside one reading of the matrix, in one run.

Example: python tests/benchmarks/bench_bounce.py --patches 10000 --rays 256

Reading is a sum over columns and weights on the same number of threads: no product can move fewer bytes. scipy's
product stands beside, on its one thread.
"""

from __future__ import annotations

import argparse
import statistics
import time

import numba
import numpy as np

import radiosity as rad
from radiosity.parallel import blocks, ordered_map, thread_count


@numba.njit(nogil=True)
def read(indices, weights, begin, end):
    """Touch every entry once."""
    total = 0.0
    places = 0
    for p in range(begin, end):
        total += weights[p]
        places += indices[p]
    return total + places


def seconds(work) -> float:
    """Time of one call."""
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def main() -> None:
    """Print milliseconds of each, and the ratio."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--patches", type=int, default=10_000)
    parser.add_argument("--rays", type=int, default=256)
    parser.add_argument("--threads", type=int, default=None)
    parser.add_argument("--repeats", type=int, default=15)
    options = parser.parse_args()
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=options.patches)
    factors = rad.form_factors(patches, rad.MonteCarlo(options.rays))
    matrix, light = factors.matrix, np.random.default_rng(0).random((len(patches), 3))
    share = -(-matrix.nnz // thread_count(options.threads))

    def read_all() -> None:
        spans = blocks(matrix.nnz, share)
        list(ordered_map(lambda span: read(matrix.indices, matrix.data, *span), spans, options.threads))

    work = {
        "read": read_all,
        "gather": lambda: factors.gather(light, options.threads),
        "scipy": lambda: matrix @ light,
    }
    times: dict[str, list[float]] = {name: [] for name in work}
    for _ in range(options.repeats + 1):
        for name, call in work.items():
            times[name].append(seconds(call))
    median = {name: statistics.median(values[1:]) for name, values in times.items()}
    megabytes = (matrix.indices.nbytes + matrix.data.nbytes) / 1e6
    print(
        f"{len(patches):,} patches, {matrix.nnz:,} non-zeros, {megabytes:.0f} MB: "
        + ", ".join(f"{name} {1e3 * value:.2f} ms" for name, value in median.items())
        + f"; gather / read {median['gather'] / median['read']:.2f}, "
        f"scipy / gather {median['scipy'] / median['gather']:.1f}"
    )


if __name__ == "__main__":
    main()
