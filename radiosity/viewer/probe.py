"""Can this machine draw? Found out in a process of its own, because VTK without GL ends the process it runs in."""

from __future__ import annotations

import functools
import os
import re
import subprocess
import sys
from typing import Literal, NamedTuple

from ..errors import DisplayError

Where = Literal["off-screen", "window"]

SECONDS = 60.0  # a first import from a cold disk may take long; a hanging display must not hang us
INSTALL = (
    "Install the GL libraries: on Debian or Ubuntu `sudo apt-get install libgl1 libegl1 libgl1-mesa-dri libxcursor1`, "
    "on Fedora `sudo dnf install mesa-libGL mesa-libEGL mesa-dri-drivers libXcursor`."
)
INSTEAD = (
    "Without one there are pictures (`radiosity view SCENE --screenshot FILE`, solution.save('picture.png')) and pages "
    "for a browser (`radiosity export SCENE -o FILE.html`, `radiosity lecture NAME -o FILE.html`); "
    "over ssh, try `ssh -X`."
)
DRAW = """
import sys
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow, vtkWindowToImageFilter
window = vtkRenderWindow()
window.SetOffScreenRendering(sys.argv[1] == "off-screen")
window.SetSize(16, 16)
renderer = vtkRenderer()
renderer.SetBackground(1.0, 0.5, 0.0)
window.AddRenderer(renderer)
window.Render()
if sys.argv[1] == "window" and any(kind in window.GetClassName() for kind in ("EGL", "OSOpenGL")):
    sys.exit(4)  # VTK found no screen and drew into memory
sys.stdout.write(window.ReportCapabilities())
image = vtkWindowToImageFilter()
image.SetInput(window)
image.Update()
red, green, blue = (image.GetOutput().GetScalarComponentAsDouble(8, 8, 0, c) for c in range(3))
sys.exit(0 if red > 250 and 120 < green < 136 and blue < 5 else 3)
"""


class Drawn(NamedTuple):
    """How the process ended, and what it wrote."""

    returncode: int
    stdout: str
    stderr: str


def has_display() -> bool:
    """Whether there is a screen to open a window on. Windows and macOS always have one."""
    if sys.platform in ("win32", "darwin"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


@functools.cache
def _begun(where: Where, display: str | None) -> subprocess.Popen[str]:  # noqa: ARG001 (what the answer depends on)
    """Start to draw one picture in a fresh Python."""
    return subprocess.Popen(
        [sys.executable, "-c", DRAW, where], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


@functools.cache
def _drawn(where: Where, display: str | None) -> Drawn | None:
    """How drawing one picture ended; None if it did not end in time."""
    process = _begun(where, display)
    try:
        said, complained = process.communicate(timeout=SECONDS)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return None
    return Drawn(process.returncode, said, complained)


def begin(where: Where = "off-screen") -> None:
    """Start the test picture now, so that a later `require` need not wait for it: it takes about a second."""
    if where == "off-screen" or has_display():
        _begun(where, os.environ.get("DISPLAY"))


def can_draw(where: Where = "off-screen") -> bool:
    """Whether pictures can be drawn off-screen, or in a window."""
    try:
        require(where)
    except DisplayError:
        return False
    return True


def require(where: Where = "off-screen") -> None:
    """Go on only if drawing works. The answer is kept for the life of the process.

    Raises
    ------
    DisplayError
        With what is missing and what to do about it.
    """
    if where == "window" and not has_display():
        raise DisplayError(f"there is no display to open a window on (DISPLAY is not set). {INSTEAD}")
    run = _drawn(where, os.environ.get("DISPLAY"))
    if run is None:
        instead = f" {INSTEAD}" if where == "window" else ""
        raise DisplayError(
            f"drawing a test picture ({where}) did not end within {SECONDS:.0f} s; is the display alive?{instead}"
        )
    if run.returncode != 0:
        raise DisplayError(_explanation(where, run))


def smoothing_samples(where: Where = "off-screen") -> int:
    """Samples a pixel that this machine can afford: one where the processor does the drawing in a window."""
    run = _drawn(where, os.environ.get("DISPLAY"))
    software = run is None or any(name in run.stdout for name in ("llvmpipe", "softpipe", "swrast", "SWR"))
    return 1 if software and where == "window" else 4


def hush() -> None:
    """Keep VTK from warning that there is no display when nobody asked for one; its errors are still shown."""
    if not has_display():
        from vtkmodules.vtkCommonCore import vtkLogger

        vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)


def _plain(line: str) -> str:
    r"""A line of VTK's log without colours, time and place.

    >>> _plain("\x1b[33m2026-11-26 00:24:06 ( 2.4s) [7F80]vtkOSOpenGL:150  WARN| no library\x1b[0m")
    'no library'
    """
    return re.sub(r"\x1b\[[0-9;]*m", "", line).rpartition("| ")[2].strip()


def _explanation(where: Where, run: Drawn) -> str:
    """What to tell a person about a test picture that failed."""
    said = [line for line in map(_plain, run.stderr.splitlines()) if line]
    last = f" ({said[-1][:200]})" if said else ""
    if run.returncode == 3:
        return f"a test picture ({where}) came out in wrong colours{last}. {INSTALL}"
    if run.returncode == 4:
        return f"the display {os.environ.get('DISPLAY')!r} cannot be reached, so no window can open{last}. {INSTEAD}"
    how = f"ended by signal {-run.returncode}" if run.returncode < 0 else f"failed with exit code {run.returncode}"
    return f"VTK cannot draw here: a test picture ({where}) {how}{last}. {INSTALL}"
