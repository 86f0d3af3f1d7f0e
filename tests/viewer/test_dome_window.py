"""The hemisphere, the solvers and the light sliders in the window, driven by the events that VTK sends."""

import numpy as np
import pytest

import radiosity as rad
from radiosity.viewer.dome import Dome, on_dome
from radiosity.viewer.state import coloured
from radiosity.viewer.window import Window
from tests.viewer.test_dome import nearest

pytestmark = pytest.mark.usefixtures("gl")


@pytest.fixture
def window(solution: rad.Solution):
    floor = nearest(solution.patches, "floor", (0.35, 0.0, 0.1))
    window = Window(solution, off_screen=True, size=(800, 500), order=6, left="hemisphere", picked=floor)
    window.image()
    yield window
    window.close()


def send(window: Window, event: str, x: float, y: float) -> None:
    interactor = window.plotter.iren.interactor
    interactor.SetEventInformation(round(x), round(y), 0, 0)
    interactor.InvokeEvent(event)


def click(window: Window, x: float, y: float) -> None:
    send(window, "LeftButtonPressEvent", x, y)
    send(window, "LeftButtonReleaseEvent", x, y)


def said(window: Window) -> str:
    return window.dashboard.status.actor.GetInput().replace("\n", " ")


def test_the_dome_takes_the_left_pane_and_gives_it_back(window: Window) -> None:
    dome = window.inspector.dome
    left, right = (window.panes[pane].renderer for pane in ("order", "sum"))
    assert left.camera is dome.camera
    assert not window.panes["order"].actor.visibility
    window.press("o")
    assert left.camera is right.camera
    assert window.panes["order"].actor.visibility
    assert not any(actor.visibility for actor in dome.actors)
    window.press("o")
    assert left.camera is dome.camera


def test_dragging_a_direction_moves_it_and_nothing_else(window: Window) -> None:
    dome = window.inspector.dome
    before, camera = window.state, dome.camera.position
    x, y = dome._on_screen(on_dome(before.dome.theta, before.dome.azimuth))
    goal = Dome(theta=55.0, azimuth=110.0)
    to_x, to_y = dome._on_screen(on_dome(goal.theta, goal.azimuth))
    send(window, "LeftButtonPressEvent", x, y)
    send(window, "MouseMoveEvent", to_x, to_y)
    send(window, "LeftButtonReleaseEvent", to_x, to_y)
    assert window.state.dome.theta == pytest.approx(55.0, abs=1.5)
    assert window.state.dome.azimuth == pytest.approx(110.0, abs=1.5)
    assert (window.state.picked, window.state.dome.path) == (before.picked, ())
    assert dome.camera.position == camera
    assert dome.labels["theta"].actor.GetInput() == f"θ = {window.state.dome.theta:.0f}°"
    send(window, "MouseMoveEvent", x, y)  # let go of
    assert window.state.dome.theta == pytest.approx(55.0, abs=1.5)
    x, y = dome._on_screen(on_dome(before.dome.theta_out, before.dome.azimuth_out))
    outgoing = window.inspector.reading.outgoing
    send(window, "LeftButtonPressEvent", x, y)
    send(window, "MouseMoveEvent", x + 20, y + 25)
    send(window, "LeftButtonReleaseEvent", x + 20, y + 25)
    assert window.state.dome.theta_out < before.dome.theta_out - 3.0
    np.testing.assert_array_equal(window.inspector.reading.outgoing, outgoing)  # Lambert: whatever ω_o


def test_beside_the_directions_the_mouse_turns_the_dome(window: Window) -> None:
    dome = window.inspector.dome
    before, state = dome.camera.position, window.state
    scene = window.panes["sum"].renderer.camera.position
    send(window, "LeftButtonPressEvent", 200, 170)
    send(window, "MouseMoveEvent", 240, 190)
    send(window, "LeftButtonReleaseEvent", 240, 190)
    assert dome.camera.position != before
    assert window.panes["sum"].renderer.camera.position == scene
    assert window.state == state


def test_a_click_goes_to_what_is_seen_and_the_path_is_drawn(window: Window) -> None:
    """The recursion, walked by hand: to what the dome shows under the mouse, and back."""
    model, dome = window.model, window.inspector.dome
    begin = window.state
    theta, azimuth = 70.0, 85.0
    x, y = dome._on_screen(on_dome(theta, azimuth))
    expected = model.hemisphere(begin.picked).seen_at(*dome.direction_at(round(x), round(y)))
    assert expected >= 0
    click(window, x, y)
    assert window.state.picked == expected
    assert window.state.dome.path == ((begin.picked, begin.order),)
    marks = dome.marks
    centroid = window.solution.patches.centroid
    assert marks.path.n_points == 2
    np.testing.assert_allclose(marks.path.points, centroid[[begin.picked, expected]], atol=3e-3)
    assert [words.actor.GetVisibility() for words in marks.names[:3]] == [1, 1, 0]
    assert [words.actor.GetInput() for words in marks.names[:2]] == ["p0", "p1"]
    names = window.solution.patches.surface_names
    assert f"→ {names[window.solution.patches.surface[expected]]}" in said(window)
    window.press("u")
    assert window.state.picked == begin.picked
    assert marks.path.n_points == 1


def test_the_ray_ends_at_the_patch_that_is_named(window: Window) -> None:
    window.change(dome=window.state.dome.aimed(60.0, 90.0))
    ahead = window.model.ahead(window.state)
    assert f"sees patch {ahead} of" in said(window)
    patches = window.solution.patches
    end = window.inspector.dome.marks.ray.points[1]
    assert (end - patches.centroid[ahead]) @ patches.normal[ahead] == pytest.approx(0.0, abs=1e-6)
    assert np.linalg.norm(end - patches.centroid[ahead]) < 2.0 * np.sqrt(patches.area[ahead])


def test_the_dashboard_adds_up_to_what_leaves(window: Window) -> None:
    reading = window.inspector.reading
    assert "H = Σ Lᵢ cos θ Δω = " + " / ".join(f"{v:.3g}" for v in reading.irradiance) in said(window)
    assert " / ".join(f"{v:.3g}" for v in reading.outgoing) in said(window)
    curves = window.dashboard._curves()
    assert curves.title.startswith("Σ Lᵢ cos θ Δω")
    assert curves.marker == pytest.approx(window.state.dome.theta / 90.0)
    window.press("l")
    assert "glossy lobe: not solved here" in window.inspector.dome.labels["lobe"].actor.GetInput()


def test_without_a_pick_the_dome_asks_for_one(window: Window) -> None:
    window.show(window.state.pick(-1))
    assert window.state.left == "hemisphere"
    assert "click on a surface" in window.inspector.dome.labels["hint"].actor.GetInput()
    assert window.inspector.reading is None
    click(window, 600, 300)
    assert window.state.picked >= 0
    assert window.inspector.reading is not None


def test_stages_and_switches_change_the_picture(window: Window) -> None:
    seen = [window.image()]
    for key in ("a", "a", "a", "l", "k", "f", "f", "Left", "period", "greater", "p"):
        window.press(key)
        seen.append(window.image())
        assert np.mean(np.any(seen[-1] != seen[-2], axis=-1)) > 0.001, key


def test_the_solvers_take_both_panes(window: Window) -> None:
    window.press("y")
    for _ in range(12):
        window.press("Right")
    frame = window.inspector.race.frame
    assert frame.rows == 12
    for pane, light in (("order", frame.gathered), ("sum", frame.shot)):
        shown = window.panes[pane].colours[:, 0]
        assert np.array_equal(shown, coloured(window.series, window.state, "sum", light.astype(np.float32)))
    assert [window.titles[pane][0].actor.GetInput() for pane in ("order", "sum")] == ["gathering", "shooting"]
    assert f"unshot power {frame.unshot_power:.3g} W" in said(window)
    assert all(raster.actor.GetVisibility() for raster in window.inspector.race.corners.values())
    window.press("space")
    window.plotter.iren.interactor.InvokeEvent("TimerEvent")
    assert window.inspector.race.frame.rows > 12
    window.press("y")
    assert not any(raster.actor.GetVisibility() for raster in window.inspector.race.corners.values())
    assert window.titles["sum"][0].actor.GetInput().startswith("Σ")


def test_sliders_of_light_and_paint_act_while_they_are_dragged(window: Window, solution: rad.Solution) -> None:
    window.press("o")
    window.show(window.state.pick(-1))
    sliders = window.dashboard.sliders
    assert sliders["emission"].words.actor.GetInput().startswith("E of lamp")
    half = float(sliders["emission"].look.GetValue()) / 2.0
    sliders["emission"].look.SetValue(half)
    sliders["emission"].widget.InvokeEvent("InteractionEvent")
    np.testing.assert_allclose(window.solution.radiosity, solution.radiosity / 2.0, rtol=1e-9)
    assert f"changed: lamp E = {half:.3g} W/m²" in said(window)
    window.press("e")
    name = window.model.sliders(window.state).surface
    sliders["reflectance"].look.SetValue(0.1)
    sliders["reflectance"].widget.InvokeEvent("InteractionEvent")
    mine = solution.patches.surface == solution.patches.surface_names.index(name)
    np.testing.assert_allclose(window.solution.patches.reflectance[mine].mean(), 0.1)
    window.press("r")
    assert window.solution is solution


def test_what_cannot_be_computed_is_said_and_nothing_changes(window: Window, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_):
        raise rad.errors.SolverError("this needs stored form factors")

    before = window.state
    monkeypatch.setattr(type(window.model), "race", refuse)
    window.press("y")
    assert window.state == before
    assert said(window) == "this needs stored form factors"
    window.press("a")
    assert "this needs" not in said(window)


def test_picking_a_patch_hands_its_surface_to_the_sliders(window: Window, solution: rad.Solution) -> None:
    wall = nearest(solution.patches, "red_wall", (0.55, 0.3, 0.3))
    window.show(window.state.pick(wall))
    assert window.dashboard.sliders["reflectance"].words.actor.GetInput().startswith("ρ of red_wall")
