"""The window, driven by the events that VTK sends for keys, sliders and clocks."""

import ctypes
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import radiosity as rad
from radiosity.errors import DisplayError
from radiosity.viewer import view
from radiosity.viewer import window as window_module
from radiosity.viewer.commands import COMMANDS
from radiosity.viewer.compare import EQUATION
from radiosity.viewer.dashboard import WIDTH
from radiosity.viewer.state import picture
from radiosity.viewer.window import Window
from tests.viewer.test_state import a_state_in_which_every_key_does_something

pytestmark = pytest.mark.usefixtures("gl")


@pytest.fixture
def window(solution: rad.Solution):
    window = Window(solution, off_screen=True, size=(640, 400), order=1, exposure=1.0)
    window.image()
    yield window
    window.close()


def press(window: Window, key: str, code: str = "") -> None:
    """What VTK does when a key goes down: the key event, then the character event of its own commands."""
    interactor = window.plotter.iren.interactor
    interactor.SetKeySym(key)
    interactor.SetKeyCode(code or "\0")
    interactor.InvokeEvent("KeyPressEvent")
    interactor.InvokeEvent("CharEvent")


def drag(slider, value: float) -> None:
    slider.GetRepresentation().SetValue(value)
    slider.InvokeEvent("InteractionEvent")


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.shown)
def test_every_key_does_what_it_says(window: Window, command) -> None:
    window.show(a_state_in_which_every_key_does_something(window.model))
    for key in command.keys:
        before = window.state
        press(window, key, key if len(key) == 1 else "")
        assert window.state == command.change(before, window.model)
        assert (window.state != before) or key != command.keys[0]


def test_keys_of_vtk_are_off(window: Window) -> None:
    """W alone would turn everything to wires, s back to faces, 3 to red-green glasses, j to a joystick."""
    style = type(window.plotter.iren.interactor.GetInteractorStyle())
    for key in "wsp3jfr":
        press(window, key, key)
        press(window, key, key)
    assert window.panes["sum"].actor.prop.style == "Surface"
    assert not window.plotter.render_window.GetStereoRender()
    assert type(window.plotter.iren.interactor.GetInteractorStyle()) is style
    assert window.state.preset == 0


def test_both_panes_show_the_state(window: Window) -> None:
    press(window, "Right")
    for pane, drawing in window.panes.items():
        assert np.array_equal(drawing.colours[:, 0], picture(window.series, window.state, pane))
    assert [words[0].actor.GetInput() for words in window.titles.values()] == ["T² Lₑ", "Σ₀…₂ Tʲ Lₑ"]
    assert "×" not in window.titles["order"][1].actor.GetInput()
    press(window, "n")
    assert window.titles["order"][1].actor.GetInput().startswith("×")


def ends(actor, renderer) -> tuple[float, float]:
    """Left and right end of words, in pixels of their pane."""
    box = [0.0] * 4
    actor.GetBoundingBox(renderer, box)
    x = actor.GetPositionCoordinate().GetComputedViewportValue(renderer)[0]
    return x + box[0], x + box[1]


@pytest.mark.parametrize("projector", [False, True])
@pytest.mark.parametrize("shown", [{"left": "factors", "picked": 40}, {"false_colour": True}, {"left": "wrong"}])
def test_words_above_a_pane_leave_room_for_what_stands_between(solution: rad.Solution, shown, projector) -> None:
    window = Window(solution, off_screen=True, size=(900, 600), projector=projector, **shown)
    window.plotter.render()
    heading, words = (each.actor for each in window.titles["order"])
    renderer = window.title_renderers["order"]
    left, _, right, _ = window.bars["order"].box if window.bars["order"].shown else EQUATION
    assert ends(heading, renderer)[1] < left * renderer.GetSize()[0]
    assert ends(words, renderer)[0] > right * renderer.GetSize()[0]
    window.close()


@pytest.mark.parametrize("side", [0.0, 0.3])
def test_sliders_go_where_their_words_go(solution: rad.Solution, side: float) -> None:
    """Handles are the brightest boxes of the dashboard: each under its words, also beside a lecture's text."""
    window = Window(solution, off_screen=True, size=(1200, 800), side=side)
    for _ in range(2):
        renderer = window.dashboard.renderer
        (left, bottom), (width, height) = renderer.GetOrigin(), renderer.GetSize()
        image = window.image()[::-1]
        for slider in window.dashboard.sliders.values():
            x, y = slider.at
            across = slice(round(left + x * width), round(left + (x + WIDTH) * width))
            middle = round(bottom + y * height)
            row = image[middle - 3 : middle + 4, across].min(axis=-1).max(axis=0)
            assert 5 <= np.sum(row > 225) <= 40, "a handle"
            assert np.mean(row > 100) > 0.6, "and its line"
        window.press("p")
    window.close()


def test_light_of_the_sky_counts_as_power_that_is_put_in() -> None:
    """Nothing emits in a room with a window; yet what its walls pass on is measured against something."""
    room = rad.solve(rad.scenes.window_room(), patch_count=100, estimator=rad.MonteCarlo(rays=64), bounces=3)
    window = Window(room, off_screen=True, size=(640, 400), order=2)
    said = window.dashboard.status.actor.GetInput().replace("\n", " ")
    share = room.power[:3].sum() / room.balance.put_in.sum()
    assert f"all so far: {share:.3f} × the power put in" in said
    window.close()


def test_every_step_reaches_the_screen(solution: rad.Solution) -> None:
    """Pixels over the whole of both panes, after each of some steps, have the colours of the patches they show."""
    window = Window(solution, off_screen=True, size=(640, 400), order=1)
    window.plotter.render_window.SetMultiSamples(0)
    pixels = [(x, y) for x in range(20, 640, 30) for y in range(100, 360, 20)]
    seen = {pixel: window.inspector.patch_at(*pixel) for pixel in pixels}
    assert sum(patch >= 0 for patch in seen.values()) > 100
    for key in ("Right", "Up", "n", "t", "Left"):
        window.press(key)
        image = window.image()
        shown = {pane: picture(window.series, window.state, pane).astype(int) for pane in window.panes}
        off = [
            np.abs(image[-1 - y, x] - shown["order" if x < 320 else "sum"][patch]).max()
            for (x, y), patch in seen.items()
            if patch >= 0
        ]
        assert np.mean(np.array(off) <= 1) > 0.97, (key, off)  # a ray and a pixel may differ at an edge
    window.close()


def test_sliders_act_while_they_are_dragged(window: Window) -> None:
    drag(window.dashboard.sliders["reel"].widget, 3.4)
    assert window.state.order == 3
    assert window.titles["order"][0].actor.GetInput() == "T³ Lₑ"
    drag(window.dashboard.sliders["exposure"].widget, 2.5)
    assert window.state.exposure == 2.5
    assert window.dashboard.sliders["exposure"].words.actor.GetInput() == "exposure  +2.5 EV"


def test_sliders_follow_the_keys(window: Window) -> None:
    press(window, "End")
    press(window, "Down")
    assert window.dashboard.sliders["reel"].look.GetValue() == window.series.last
    assert window.dashboard.sliders["exposure"].look.GetValue() == 0.5


def test_play_goes_round_and_stops(window: Window) -> None:
    tick = window.plotter.iren.interactor.InvokeEvent
    tick("TimerEvent")
    assert window.state.order == 1
    press(window, "space")
    orders = []
    for _ in range(window.series.last + 1):
        tick("TimerEvent")
        orders.append(window.state.order)
    assert orders == [2, 3, 4, 5, 6, 0, 1]
    drag(window.dashboard.sliders["reel"].widget, 4)
    tick("TimerEvent")
    assert window.state.order == 4


def test_panes_turn_together(window: Window) -> None:
    assert window.panes["order"].renderer.camera is window.panes["sum"].renderer.camera
    before = window.panes["sum"].renderer.camera.position
    press(window, "c")
    assert window.panes["sum"].renderer.camera.position != before
    press(window, "c")
    assert window.panes["sum"].renderer.camera.position == pytest.approx(before)


def test_the_picture_changes_when_the_state_does(window: Window) -> None:
    seen = [window.image()]
    for key in ("Right", "n", "s", "t", "f", "question", "question", "p", "p", "o", "o", "y"):
        press(window, key)
        seen.append(window.image())
        assert np.mean(np.any(seen[-1] != seen[-2], axis=-1)) > 0.002, key
    assert all(image.shape == (400, 640, 3) for image in seen)


def test_the_help_lists_every_key(window: Window) -> None:
    listed = dict(window.keys_list.listed)
    for command in COMMANDS:
        assert listed[command.shown] == command.does
    press(window, "question")
    heights = np.unique([words.actor.GetPosition()[1] for words in window.keys_list.words])
    room = window.veil.GetSize()[1] * np.diff(heights).min()  # pixels for a line of the list, in this window
    assert max(words.property.GetFontSize() for words in window.keys_list.words) < room


def test_scale_bar_appears_with_false_colour(window: Window) -> None:
    bar = window.bars["sum"]
    assert not bar.strip.actor.GetVisibility()
    press(window, "f")
    assert bar.strip.actor.GetVisibility()
    ticks = [words.actor.GetInput() for words in bar.words if words.actor.GetVisibility()]
    assert len(ticks) > 1
    assert ticks[-1].endswith("W/m²")


def test_the_dashboard_says_where_the_power_goes_and_how_sure_that_is(window: Window, solution: rad.Solution) -> None:
    said = window.dashboard.status.actor.GetInput().replace("\n", " ")
    absorbed = solution.balance.absorbed.sum() / solution.balance.put_in.sum()
    assert f"absorbed {absorbed:.1%}" in said
    assert f"defect {solution.balance.defect:+.2%}".replace("-", "−") in said
    assert f"closure defect {np.abs(solution.factors.closure_defect).max():.1g}" in said
    assert str(solution.certificate).splitlines()[0] in said
    press(window, "v")
    said = window.dashboard.status.actor.GetInput()
    assert said.replace("\n", " ") == str(solution.certificate).replace("\n", " ")


def test_marker_stands_at_the_bounce(window: Window) -> None:
    for order in (0, 6):
        drag(window.dashboard.sliders["reel"].widget, order)
        plot = window.dashboard.plot
        points = plot.marker.mapper.GetInput().points
        assert points[:, 0].mean() == pytest.approx(plot.x((order + 0.5) / 7), abs=1e-6)


def test_screenshot_needs_no_display(solution: rad.Solution, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    state = view(solution, screenshot=tmp_path / "shot.png", size=(640, 400), order=3)
    assert state.order == 3
    with Image.open(tmp_path / "shot.png") as file:
        image = np.asarray(file)
    assert image.shape == (400, 640, 3)
    assert len(np.unique(image.reshape(-1, 3), axis=0)) > 100


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="these systems always have a screen")
def test_a_window_without_display_is_a_named_error(solution: rad.Solution, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(DisplayError, match="DISPLAY is not set"):
        view(solution)


SESSION = """
import radiosity as rad
from radiosity.viewer.window import Window

solution = rad.solve(rad.scenes.cornell_box(), patch_count=100, estimator=rad.MonteCarlo(rays=16), bounces=8)
window = Window(solution, order=0)
keys = iter(["Right", "space", None, None, "Up", "q"])

def act(*_):
    key = next(keys, None)
    if key:
        window.plotter.iren.interactor.SetKeySym(key)
        window.plotter.iren.interactor.InvokeEvent("KeyPressEvent")

window.plotter.iren.add_observer("TimerEvent", act)
window.run()
print(type(window.plotter.render_window).__name__ if window.plotter.render_window else "closed", window.state)
"""


@pytest.mark.skipif(shutil.which("Xvfb") is None, reason="Xvfb is not installed")
def test_a_real_window_opens_plays_and_closes(tmp_path: Path) -> None:
    with (tmp_path / "display").open("w+") as number:
        screen = subprocess.Popen(
            ["Xvfb", "-displayfd", str(number.fileno()), "-screen", "0", "1300x800x24", "-nolisten", "tcp"],
            pass_fds=[number.fileno()],
            stderr=subprocess.DEVNULL,
        )
        try:
            for _ in range(100):
                if (tmp_path / "display").read_text().strip():
                    break
                time.sleep(0.1)
            display = ":" + (tmp_path / "display").read_text().strip()
            run = subprocess.run(
                [sys.executable, "-c", SESSION],
                env={**os.environ, "DISPLAY": display},
                capture_output=True,
                text=True,
                timeout=120,
            )
        finally:
            screen.terminate()
            screen.wait()
    assert run.returncode == 0, run.stderr
    assert "order=5" in run.stdout, run.stdout  # one by the key, four by playing
    assert "exposure=0.5" in run.stdout


@pytest.mark.benchmark
@pytest.mark.parametrize(("patches", "limit"), [(10_000, 0.033), (100_000, 0.1)])
def test_a_step_of_the_slider_is_quick_without_a_graphics_card(patches: int, limit: float) -> None:
    """Both panes, without smoothed edges, as in a window that the processor draws."""
    solution = rad.solve(rad.scenes.cornell_box(), patch_count=patches, estimator=rad.MonteCarlo(rays=16), bounces=10)
    window = Window(solution, off_screen=True)
    window.plotter.render_window.SetMultiSamples(0)
    window.plotter.screenshot(return_img=True)  # before it, nothing is drawn
    times = []
    for k in range(12):
        begin = time.perf_counter()
        drag(window.dashboard.sliders["reel"].widget, k % 11)
        times.append(time.perf_counter() - begin)
    window.close()
    assert float(np.median(times)) <= limit, times


def ticks_until_the_verdict(window: Window, monkeypatch, most: int = 30) -> int:
    """Between the ticks of a real window, VTK waits for events and lets no other thread run."""
    _ = window.solution.__dict__.pop("certificate", None)

    def slow(solution: rad.Solution) -> str:
        end = time.thread_time() + 0.3
        while time.thread_time() < end:  # of the interpreter's work
            pass
        solution.__dict__["certificate"] = "sure"
        return "sure"

    monkeypatch.setattr(type(window.solution), "certificate", property(slow))
    hold = ctypes.PyDLL(None).usleep
    for count in range(most):
        if window._certify():
            return count
        hold(20_000)
    return most


@pytest.mark.skipif(os.name != "posix", reason="usleep")
def test_the_verdict_comes_although_vtk_holds_the_interpreter(window: Window, monkeypatch) -> None:
    assert ticks_until_the_verdict(window, monkeypatch) < 15


@pytest.mark.skipif(os.name != "posix", reason="usleep")
def test_without_a_turn_of_its_own_the_verdict_does_not_come(window: Window, monkeypatch) -> None:
    """Negative control."""
    monkeypatch.setattr(window_module, "TURN", 0.0)
    assert ticks_until_the_verdict(window, monkeypatch) == 30
