"""What people see while a command runs: progress, remarks, warnings, errors. All of it on stderr."""

from __future__ import annotations

import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from functools import cached_property
from typing import TYPE_CHECKING, Any

from ..errors import RadiosityWarning
from ..progress import Progress

if TYPE_CHECKING:
    from rich.console import Console

NO_WINDOW = 3  # exit code: what was asked for as a window has been written instead


class Screen:
    """The terminal.

    Parameters
    ----------
    quiet : bool
        Say only what is wrong.
    """

    def __init__(self, quiet: bool = False) -> None:
        self.quiet = quiet
        self.told_of_compiling = False

    @cached_property
    def err(self) -> Console:
        """For everything but results."""
        from rich.console import Console

        return Console(stderr=True)

    @cached_property
    def out(self) -> Console:
        """For results."""
        from rich.console import Console

        return Console()

    def error(self, message: str) -> None:
        """Say in one line why the command ends."""
        self._line("error: ", "bold red", message)

    def warn(self, message: str) -> None:
        """Say in one line what to look out for."""
        self._line("warning: ", "yellow", message)

    def say(self, message: str) -> None:
        """Say what is going on."""
        if not self.quiet:
            self._line("", "", message)

    def _line(self, head: str, style: str, message: str) -> None:
        from rich.text import Text

        self.err.print(Text.assemble((head, style), " ".join(message.split())), soft_wrap=True)

    @contextmanager
    def warnings(self) -> Iterator[None]:
        """Show the package's warnings as lines of their own; leave others as they are."""
        with warnings.catch_warnings():
            other = warnings.showwarning
            warnings.simplefilter("always", RadiosityWarning)

            def show(message: Warning | str, category: type[Warning], *where: Any, **named: Any) -> None:
                if issubclass(category, RadiosityWarning):
                    self.warn(str(message))
                else:
                    other(message, category, *where, **named)

            warnings.showwarning = show
            yield

    @contextmanager
    def progress(self) -> Iterator[Progress]:
        """Bars for the stages of the work, one below the other, gone when it is done."""
        from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn

        columns = (TextColumn("{task.description:<13}"), BarColumn(), TaskProgressColumn(), TimeElapsedColumn())
        shown = not self.quiet and self.err.is_terminal
        bars = Progress(*columns, console=self.err, transient=True, disable=not shown)
        with bars if shown else nullcontext(), self._compiling():  # older rich ends disabled bars by an empty line
            stages: dict[str, Any] = {}

            def tell(stage: str, done: int, total: int) -> None:
                if stage not in stages:
                    stages[stage] = bars.add_task(stage, total=total)
                bars.update(stages[stage], completed=done, total=total)

            yield tell

    @contextmanager
    def working(self, what: str) -> Iterator[None]:
        """A sign of life for work that does not tell how far it is."""
        shown = not self.quiet and self.err.is_terminal
        with self.err.status(what) if shown else nullcontext(), self._compiling():
            yield

    @contextmanager
    def _compiling(self) -> Iterator[None]:
        """Say so when kernels have to be compiled, which happens once on a machine."""
        from numba.core.event import install_listener

        listener = _listener(self)
        with install_listener("numba:compile", listener):
            yield
        if listener.seconds > 1.0:
            self.say(f"compiled {listener.count} kernels in {listener.seconds:.1f} s; the next run finds them ready")


def _listener(screen: Screen) -> Any:
    """A listener that announces the first compilation and adds up the time of all."""
    from numba.core.event import Listener

    class CompileListener(Listener):  # type: ignore[misc]  # numba has no types
        """Compilations nest: a kernel compiles those that it calls."""

        def __init__(self) -> None:
            self.count, self.depth, self.began, self.seconds = 0, 0, 0.0, 0.0

        def on_start(self, _event: Any) -> None:
            if self.count == 0 and not screen.told_of_compiling:
                screen.told_of_compiling = True
                screen.say("first run of its kind here: compiling kernels, which takes some 20 s and is done once")
            if self.depth == 0:
                self.began = time.perf_counter()
            self.count += 1
            self.depth += 1

        def on_end(self, _event: Any) -> None:
            self.depth -= 1
            if self.depth == 0:
                self.seconds += time.perf_counter() - self.began

    return CompileListener()
