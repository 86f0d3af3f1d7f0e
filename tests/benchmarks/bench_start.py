"""How long `import radiosity` and `radiosity --help` take, each in processes of their own.

`python tests/benchmarks/bench_start.py`. Warm: the files are in the machine's memory. Cold: those of the environment
and of Python itself have been put out of it (as far as no running process uses them), as after the machine was started.
"""

import argparse
import os
import statistics
import subprocess
import sys
import sysconfig
import time
from pathlib import Path

BESIDE = "import numpy, scipy.sparse"
RUNS = {
    "python alone": ["-c", "pass"],
    "numpy and scipy.sparse": ["-c", BESIDE],
    "numpy, scipy.sparse and radiosity": ["-c", f"{BESIDE}, radiosity"],
    "radiosity": ["-c", "import radiosity"],
    "radiosity --help": ["-m", "radiosity", "--help"],
}


def seconds(words: list[str]) -> float:
    """Of one process, from its start to its end."""
    begin = time.perf_counter()
    subprocess.run([sys.executable, *words], check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - begin


def forget() -> None:
    """Ask the system to drop the files of the environment, the package and Python's library from its memory."""
    folders = {sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")}
    folders.add(str(Path(__file__).resolve().parents[2] / "radiosity"))
    for folder in folders:
        for path in Path(folder).rglob("*"):
            if path.is_file():
                handle = os.open(path, os.O_RDONLY)
                os.posix_fadvise(handle, 0, 0, os.POSIX_FADV_DONTNEED)
                os.close(handle)


def main() -> None:
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("--runs", type=int, default=21)
    words.add_argument("--cold-runs", type=int, default=5)
    args = words.parse_args()
    warm: dict[str, list[float]] = {name: [] for name in RUNS}
    for _ in range(args.runs):  # in turn, so that all have the same weather
        for name, command in RUNS.items():
            warm[name].append(seconds(command))
    for name, taken in warm.items():
        print(f"warm  {name:<36} {statistics.median(taken):6.3f} s   ({min(taken):.3f} … {max(taken):.3f})")
    apart = [both - one for both, one in zip(warm["numpy, scipy.sparse and radiosity"],
                                             warm["numpy and scipy.sparse"], strict=True)]  # fmt: skip
    print(f"warm  {'radiosity over the two':<36} {statistics.median(apart):6.3f} s")
    cold: list[float] = []
    for _ in range(args.cold_runs):
        forget()
        cold.append(seconds(RUNS["radiosity --help"]))
    print(f"cold  {'radiosity --help':<36} {statistics.median(cold):6.3f} s   ({min(cold):.3f} … {max(cold):.3f})")


if __name__ == "__main__":
    main()
