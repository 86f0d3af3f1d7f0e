"""Kernels compiled ahead, in a second process, on the first run on a machine.

numba compiles one kernel at a time. So other processes compile what will be needed later, and leave it in numba's
cache on disk, while this one is busy with what it needs first. Whatever goes wrong there, nothing is lost but the
head start: numba writes its cache whole or not at all, and this process compiles what it does not find.
"""

from __future__ import annotations

import multiprocessing
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .parallel import thread_count

SECONDS = 120.0  # to wait for at most; compiling takes a tenth
PROGRAM = """
import sys
sys.path.insert(0, sys.argv[1])
from importlib import import_module
getattr(import_module(sys.argv[2]), sys.argv[3])()
"""


@dataclass(eq=False)
class Ahead:
    """What a second process compiles.

    Parameters
    ----------
    module, function : str
        What it calls, without arguments.
    kernel : dispatcher
        One of the kernels: where it is compiled, or kept on disk, no process is needed.
    """

    module: str
    function: str
    kernel: Any
    program: str = PROGRAM
    begun: bool = field(default=False, init=False)
    process: subprocess.Popen[bytes] | None = field(default=None, init=False)

    def begin(self) -> None:
        """Start the process, once, if kernels are not there yet, and if it has a processor to run on."""
        if self.begun:
            return
        self.begun = True
        if thread_count() < 2 or multiprocessing.parent_process() is not None or not sys.executable or self.found():
            return
        package = Path(__file__).resolve().parents[1]
        command = [sys.executable, "-c", self.program, str(package), self.module, self.function]
        silent: dict[str, Any] = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
        try:
            self.process = subprocess.Popen(command, **silent)
        except OSError:
            return

    def ready(self) -> None:
        """Wait for the process, if there is one."""
        process = self.process
        if process is None:
            return
        try:
            process.wait(SECONDS)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        self.process = None

    def found(self) -> bool:
        """Whether kernels are compiled, or kept on disk; also where numba does not tell."""
        index: Any = getattr(getattr(self.kernel, "_cache", None), "_cache_file", None)
        if getattr(self.kernel, "signatures", True) or not hasattr(index, "_load_index"):
            return True
        try:
            return bool(index._load_index())
        except OSError:
            return False
