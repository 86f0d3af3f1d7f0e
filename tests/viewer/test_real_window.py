"""A real window on a real (virtual) screen, driven from outside by the X server's own key and mouse events."""

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from radiosity.viewer.changes import Changes
from radiosity.viewer.commands import COMMANDS
from radiosity.viewer.dome import Dome
from radiosity.viewer.state import EXPOSURES, ViewState

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(not (shutil.which("Xvfb") and shutil.which("xdotool")), reason="Xvfb or xdotool is missing"),
    pytest.mark.usefixtures("gl"),
]

WIDTH, HEIGHT = 1280, 720
NAMES = {"ViewState": ViewState, "Dome": Dome, "Changes": Changes}  # to read a state that was printed

SESSION = """
import sys
import radiosity as rad
from radiosity.viewer.window import Window

class Told(Window):
    def show(self, state):
        super().show(state)
        print(repr(self.state), flush=True)

solution = rad.solve(rad.scenes.cornell_box(), patch_count=600, estimator=rad.MonteCarlo(rays=64), bounces=8)
window = Told(solution, order=2)
window.plotter.iren.add_observer("TimerEvent", lambda *_: None)
window.show(window.state)
window.run()
print("closed", flush=True)
"""


@dataclass
class Screen:
    """A virtual screen with the viewer on it."""

    display: str
    said: Path

    def do(self, *words: str | int) -> None:
        """One order to xdotool."""
        subprocess.run(["xdotool", *map(str, words)], env=self.environment, check=True, timeout=60)

    @property
    def environment(self) -> dict[str, str]:
        return {**os.environ, "DISPLAY": self.display}

    @property
    def lines(self) -> list[str]:
        return self.said.read_text().splitlines()

    @property
    def state(self) -> ViewState:
        """What the window shows, as it said last."""
        return eval(next(line for line in reversed(self.lines) if line.startswith("ViewState")), dict(NAMES))

    def wait(self, done: Callable[[], bool], what: str, seconds: float = 90.0) -> None:
        until = time.monotonic() + seconds
        while not done():
            assert time.monotonic() < until, f"{what}: still {self.lines[-1:]}"
            time.sleep(0.03)

    def key(self, key: str, expected: ViewState | None = None) -> ViewState:
        """Press a key and wait for what comes of it."""
        count = len(self.lines)
        self.do("mousemove", WIDTH - 60, 300, "key", key)
        self.wait(lambda: len(self.lines) > count and (expected is None or self.state == expected), key)
        return self.state

    def drag(self, begin: tuple[int, int], end: tuple[int, int]) -> None:
        """Drag from pixel to pixel, counted from the upper left."""
        self.do("mousemove", *begin, "mousedown", 1)
        for share in np.linspace(0.25, 1.0, 4):
            x, y = (round(a + share * (b - a)) for a, b in zip(begin, end, strict=True))
            self.do("mousemove", x, y)
            time.sleep(0.1)
        self.do("mouseup", 1)

    def click(self, x: int, y: int) -> None:
        self.do("mousemove", x, y, "click", 1)


@pytest.fixture(scope="module")
def screen(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Screen]:
    folder = tmp_path_factory.mktemp("screen")
    number = folder / "display"
    with (
        number.open("w+") as file,
        (folder / "said").open("w") as said,
        (folder / "complained").open("w") as complained,
    ):
        server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(file.fileno()), "-screen", "0", f"{WIDTH}x{HEIGHT}x24", "-nolisten", "tcp"],
            pass_fds=[file.fileno()],
            stderr=subprocess.DEVNULL,
        )
        viewer = None
        try:
            while not number.read_text().endswith("\n"):
                time.sleep(0.05)
            screen = Screen(":" + number.read_text().strip(), folder / "said")
            viewer = subprocess.Popen(
                [sys.executable, "-c", SESSION], env=screen.environment, stdout=said, stderr=complained
            )
            screen.wait(lambda: bool(screen.lines) or viewer.poll() is not None, "the window", 180)
            screen.do("search", "--sync", "--name", "Radiosity")
            time.sleep(1.0)
            yield screen
            screen.do("mousemove", WIDTH - 60, 300, "key", "q")
            assert viewer.wait(timeout=60) == 0
            assert screen.lines[-1] == "closed"
            assert "Traceback" not in (folder / "complained").read_text()
        finally:
            for process in (viewer, server):
                if process is not None and process.poll() is None:
                    process.kill()
                    process.wait()


def slider(left: float, height: float, share: float) -> tuple[int, int]:
    """Pixel of a slider's handle, in a window of the usual layout; the ends of its way stand a little inside."""
    return round(WIDTH * left + 16 + share * (WIDTH * 0.15 - 32)), round(HEIGHT * (1.0 - 0.22 * height))


def test_every_key_in_a_real_window(screen: Screen) -> None:
    """Where a key's change is known without the scene, it is held; where it needs the scene, something must change."""
    for command in COMMANDS:
        key = command.keys[0]
        before = screen.state
        try:
            expected = command.change(before, None)  # type: ignore[arg-type]
        except AttributeError:
            assert screen.key(key) != before or command.shown in "ju", command.shown
        else:
            screen.key(key, expected)
        if command.shown in ("p", "?", "v", "space", "y", "n", "m", "f", "w", "b"):
            screen.key(key)
            screen.wait(lambda: not screen.state.playing, "pause")  # a bounce may have come before it
        if command.shown in (",", "d", "End"):
            screen.key("Left")
    assert not screen.state.playing


def test_sliders_drag(screen: Screen) -> None:
    screen.key("Home")
    screen.key("r")
    if screen.state.left != "order":
        screen.key("g")
    begin = screen.state
    screen.drag(slider(0.02, 0.69, 0.0), slider(0.02, 0.69, 1.0))
    screen.wait(lambda: screen.state.order == 8, "bounce slider")
    low, high = EXPOSURES
    zero = (screen.state.exposure - low) / (high - low)
    screen.drag(slider(0.02, 0.22, zero), slider(0.02, 0.22, zero + 0.2))
    screen.wait(lambda: screen.state.exposure > begin.exposure + 2.0, "exposure slider")
    screen.drag(slider(0.195, 0.22, 0.8), slider(0.195, 0.22, 0.3))
    screen.wait(lambda: bool(screen.state.changes.reflectance), "reflectance slider")
    screen.key("r")
    assert not screen.state.changes


def test_pick_dome_walk_and_turn(screen: Screen) -> None:
    screen.key("0")
    screen.key("End")
    screen.click(960, 520)
    screen.wait(lambda: screen.state.picked >= 0, "pick")
    first = screen.state.picked
    if screen.state.left != "hemisphere":
        screen.key("o")
    assert screen.state.left == "hemisphere"
    for x, y in ((320, 300), (250, 420), (400, 420), (200, 340), (440, 340)):  # some directions see the open front
        count = len(screen.lines)
        screen.click(x, y)
        screen.wait(lambda before=count: len(screen.lines) > before, "click on the dome")
        if screen.state.dome.path:
            break
    assert screen.state.dome.path[0][0] == first
    assert screen.state.picked != first
    assert screen.key("u").picked == first
    count = len(screen.lines)
    screen.drag((900, 250), (960, 270))  # turns the scene: nothing of the state
    assert len(screen.lines) == count or screen.state.picked == first


LARGE = """
import radiosity as rad
from radiosity.viewer.window import Window

window = Window(rad.solve(rad.scenes.red_rug(), patch_count=100, bounces=2), size=(1600, 900))
window.plotter.show(interactive_update=True)
print(*window.plotter.render_window.GetSize())
window.close()
"""


def test_a_window_larger_than_the_screen_is_made_to_fit(screen: Screen) -> None:
    command = [sys.executable, "-c", LARGE]
    said = subprocess.run(command, env=screen.environment, check=True, timeout=180, capture_output=True, text=True)
    width, height = map(int, said.stdout.split()[-2:])
    assert (width, height) == (1216, 684)
