"""Work stopped half-way on purpose: killed, interrupted, out of room. What is left is the old file or the new one.

``python -m tests.faults 100`` injects 100 faults into processes that save solutions and scenes again and again, and
prints what came of them as JSON. Each fault is made again by its number.
"""

from __future__ import annotations

import contextlib
import json
import os
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from pathlib import Path

import numpy as np

import radiosity as rad
from radiosity import atomic
from radiosity.cli.interrupts import interruptible
from radiosity.errors import OutputError

NAMES = ("a.npz", "a.vtp", "a.html", "scene.glb", "light.glb")
KINDS = ("kill", "interrupt", "full")
Pair = tuple[rad.Solution, rad.Solution]
FULL, INTERRUPTED, UNEXPECTED = 3, 130, 4


def save(solution: rad.Solution, path: Path) -> None:
    """Write whatever the name says."""
    if path.name == "scene.glb":
        rad.write_scene(solution.scene, path)
    else:
        solution.save(path)


def versions() -> Pair:
    """Two results of different size."""
    scene = rad.scenes.cornell_box()
    return tuple(
        rad.solve(scene, patch_count=count, estimator=rad.MonteCarlo(rays=64, seed=0), bounces=3) for count in (60, 200)
    )  # type: ignore[return-value]


def write_for_ever(solutions: Pair, path: Path, kind: str, room: int) -> None:
    """What the process to be stopped does; it never returns."""
    code = UNEXPECTED
    try:
        atomic._tidied.clear()
        if kind == "full":
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))
            save(solutions[1], path)
        with interruptible(lambda: "interrupted"):
            signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])
            while True:
                for solution in solutions:
                    save(solution, path)
    except KeyboardInterrupt:
        code = INTERRUPTED
    except OutputError:
        code = FULL
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(code)


def inject(number: int, solutions: Pair, whole: dict[str, list[bytes]], folder: Path) -> str:
    """One fault; what came of it in a word."""
    rng = np.random.default_rng(number)
    name, kind = NAMES[number % len(NAMES)], KINDS[number % len(KINDS)]
    path = folder / name
    path.write_bytes(whole[name][0])
    room = int(rng.integers(0, len(whole[name][1])))
    signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])  # until the child listens
    child = os.fork()
    if child == 0:
        write_for_ever(solutions, path, kind, room)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])
    if kind != "full":
        time.sleep(float(rng.uniform(0.0, 0.06)))
        os.kill(child, signal.SIGKILL if kind == "kill" else signal.SIGINT)
    began = time.perf_counter()
    ended, status = 0, 0
    while not ended:
        ended, status = os.waitpid(child, os.WNOHANG)
        if time.perf_counter() - began > 30.0:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            return f"hung: {kind} {name}"
        time.sleep(0.002)
    left = [entry.name for entry in folder.iterdir() if f"-{child}-" in entry.name]
    content = path.read_bytes()
    if content not in whole[name]:
        return f"half: {kind} {name}"
    if kind == "kill":
        return "killed" if os.WIFSIGNALED(status) else f"not killed: {status}"
    if left:
        return f"left {left[0]}: {kind} {name}"
    if kind == "interrupt":
        if time.perf_counter() - began > 2.0:
            return f"late: {name}"
        return "interrupted" if os.WEXITSTATUS(status) == INTERRUPTED else f"ended with {status}: {name}"
    kept = content == whole[name][0]
    return "full" if kept and os.WEXITSTATUS(status) == FULL else f"full disk ended with {status}, kept {kept}: {name}"


def run(count: int) -> dict[str, object]:
    """Inject faults 0 … count - 1."""
    solutions = versions()
    tally: Counter[str] = Counter()
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        whole = {}
        for file in NAMES:
            contents = []
            for solution in solutions:
                save(solution, folder / file)
                contents.append((folder / file).read_bytes())
            whole[file] = contents
        for number in range(count):
            tally[inject(number, solutions, whole, folder)] += 1
        atomic._tidied.clear()
        with contextlib.suppress(OSError):
            save(solutions[0], folder / "a.npz")
        left = [entry.name for entry in folder.iterdir() if entry.name not in NAMES]
    return {"faults": count, "tally": dict(tally), "left": left}


if __name__ == "__main__":
    sys.stdout.write(json.dumps(run(int(sys.argv[1]))) + "\n")
