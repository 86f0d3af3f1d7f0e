"""The page's controls in a real browser: keys, sliders, clicks and fingers do what they say."""

from pathlib import Path

import numpy as np
import pytest

import radiosity as rad
from radiosity.viewer.state import Series
from tests.viewer.browser import Browser, needs_browser


@needs_browser
def test_bounce_slider_acts_while_it_is_dragged(shown: Browser, series: Series) -> None:
    x, y, width, height = shown.box("#k")
    thumb = [x + 8 + (width - 16) * k / series.last for k in range(series.last + 1)]
    shown.run(
        "window.seen = []; document.getElementById('k').addEventListener('input', () => seen.push(viewer.state.k))"
    )
    shown.mouse(*[(there, y + height / 2) for there in (thumb[1], thumb[2], thumb[4], thumb[5])])
    assert shown.run("viewer.state.k") == 5
    assert set(shown.run("seen")) >= {2, 4, 5}
    assert shown.run("document.querySelector('.formula').textContent") == "T5 Le"


@needs_browser
def test_exposure_slider(shown: Browser) -> None:
    before = shown.image()
    x, y, width, height = shown.box("#ev")
    middle = x + 8 + (width - 16) / 3
    shown.mouse((middle, y + height / 2), (middle + (width - 16) / 9, y + height / 2))
    assert shown.run("viewer.state.ev") == pytest.approx(2.0, abs=0.3)
    assert "exposure +" in shown.run("document.querySelectorAll('.note')[1].textContent")
    assert shown.image().astype(int).mean() > before.astype(int).mean() + 3


@needs_browser
def test_every_key(shown: Browser, series: Series) -> None:
    for key, name, value in [
        ("ArrowRight", "k", 2), ("End", "k", series.last), ("ArrowRight", "k", series.last),
        ("ArrowLeft", "k", series.last - 1), ("Home", "k", 0),
        ("ArrowUp", "ev", 0.5), ("ArrowDown", "ev", 0), ("ArrowDown", "ev", -0.5), ("0", "ev", 0),
        ("n", "normalised", True), ("t", "tone", "linear"), ("m", "markClipped", True), ("f", "falseColour", True),
        ("s", "smooth", True), ("x", "left", "wrong"), ("x", "wrong", 1), ("d", "difference", True),
        ("g", "left", "sees"), ("g", "left", "order"), ("c", "camera", 1),
        ("v", "show", "order"), ("v", "show", "sum"), ("v", "show", "both"),
    ]:  # fmt: skip
        shown.key(key)
        assert shown.run("viewer.state")[name] == value, key
    shown.key("?")
    assert shown.run("document.getElementById('help').open")
    shown.key("n")
    assert shown.run("viewer.state.normalised")  # keys wait while the list is open


@needs_browser
def test_controls_do_what_the_keys_do(shown: Browser) -> None:
    for selector, name, value in [
        ("#on", "k", 2), ("#back", "k", 1), ("#normalised", "normalised", True), ("#falseColour", "falseColour", True),
        ("#markClipped", "markClipped", True), ("#smooth", "smooth", True), ("#camera", "camera", 1),
        ("#play", "playing", True),
    ]:  # fmt: skip
        x, y, width, height = shown.box(selector)
        shown.mouse((x + width / 2, y + height / 2))
        assert shown.run("viewer.state")[name] == value, selector


@needs_browser
def test_play_goes_on_by_itself_and_stops_at_the_slider(shown: Browser) -> None:
    shown.key(" ")
    moved = """new Promise((done) => {
        const from = viewer.state.k;
        const look = () => (viewer.state.k === from ? setTimeout(look, 20) : done(viewer.state.k));
        look();
    })"""
    assert [shown.run(moved), shown.run(moved)] == [2, 3]
    shown.key(" ")
    assert not shown.run("viewer.state.playing")


@needs_browser
def test_click_reads_the_values_of_a_patch(shown: Browser, solution: rad.Solution) -> None:
    shown.run("viewer.set({ k: 3 })")
    x, y, width, height = shown.box("canvas")
    shown.mouse((x + 0.75 * width, y + 0.45 * height))
    patch = shown.run("viewer.state.picked")
    words = shown.run("document.getElementById('pick').textContent")
    name = solution.patches.surface_names[solution.patches.surface[patch]]
    assert f"patch {patch} of {name}, " in words
    area = float(words.split(", ")[1].split(" cm²")[0])
    assert area == pytest.approx(solution.patches.area[patch] * 1e4, rel=0.006)
    for line, light in zip(words.splitlines()[1:3], (solution.orders[3], solution.orders[:4].sum(axis=0)), strict=True):
        values = [float(v.replace(" × 10^", "e")) for v in line.split("B = ")[1].removesuffix(" W/m²").split(" / ")]
        assert values == pytest.approx(light[patch], rel=0.01)
    shown.mouse((x + 3, y + 3))
    assert shown.run("viewer.state.picked") == -1


@needs_browser
def test_drag_turns_wheel_zooms_shift_moves(shown: Browser) -> None:
    x, y, width, height = shown.box("canvas")
    centre = (x + width / 2, y + height / 2)
    seen = [shown.image()]
    for act in (
        lambda: shown.mouse(centre, (centre[0] + 30, centre[1]), (centre[0] + 60, centre[1] + 20)),
        lambda: shown.mouse(centre, wheel=-240),
        lambda: shown.mouse(centre, (centre[0] + 40, centre[1]), modifiers=8),
    ):
        act()
        seen.append(shown.image())
        assert np.mean(np.any(seen[-1] != seen[-2], axis=-1)) > 0.02
    assert shown.run("viewer.state.picked") == -1  # a drag is no click


@needs_browser
def test_a_phone_shows_one_picture_and_takes_fingers(browser: Browser, file: Path) -> None:
    browser.size(390, 844, phone=True)
    browser.open(file)
    assert browser.run("viewer.state.show") == "sum"
    assert browser.run("document.documentElement.scrollWidth") <= 390
    x, y, width, height = browser.box("canvas")
    assert width > 350
    assert height > 300
    for selector in ("#back", "#play", "#on", "#camera", "#show"):
        assert browser.box(selector)[3] >= 44  # as high as a finger
    before = browser.image()
    browser.touch([(200, y + 100)], [(230, y + 110)], [(280, y + 120)])
    turned = browser.image()
    assert np.mean(np.any(turned != before, axis=-1)) > 0.02
    browser.touch([(150, y + 100), (250, y + 100)], [(130, y + 100), (270, y + 100)], [(100, y + 100), (300, y + 100)])
    assert np.mean(np.any(browser.image() != turned, axis=-1)) > 0.02
    browser.touch([(x + width / 2, y + height / 2)])
    assert browser.run("viewer.state.picked") >= 0
    assert browser.complaints == []
    browser.size(1000, 640)
