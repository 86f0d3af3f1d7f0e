"""The page in a real browser: its pixels are the solver's, its controls work, it asks nobody for anything."""

import base64
import dataclasses
import gzip
import html.parser
from pathlib import Path

import numpy as np
import pytest

import radiosity as rad
from radiosity import display
from radiosity.errors import ParameterError
from radiosity.shortcuts import ALL
from radiosity.viewer import page, page_data
from radiosity.viewer.inspect import HemicubeView
from radiosity.viewer.mesh import corner_weights
from radiosity.viewer.state import Series, ViewState, coloured, picture, start
from tests.viewer.browser import Browser, needs_browser

NASTY = "</script><script>document.title='broken'</script> {data} & \"quotes\""


def view_state(browser: Browser, last: int) -> ViewState:
    state = browser.run("viewer.state")
    return ViewState(
        last=last, order=state["k"], exposure=state["ev"], tone=state["tone"], normalised=state["normalised"],
        mark_clipped=state["markClipped"], false_colour=state["falseColour"],
    )  # fmt: skip


def pixels_and_patches(browser: Browser, pane: str) -> tuple[np.ndarray, np.ndarray]:
    """Colours (n, 3) and patches (n,) of all pixels of a pane that lie well within a patch."""
    left, top, width, height = (round(v) for v in browser.box("canvas"))
    if browser.run("viewer.state.show") == "both":
        width //= 2
        left += width if pane == "sum" else 0
    patch = np.array(browser.run(f"Array.from(viewer.patchesOf('{pane}'))")).reshape(height, width)[::-1]
    browser.run("viewer.draw()")
    browser.settle()
    inner = patch >= 0
    for shift in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        inner &= np.roll(patch, shift, axis=(0, 1)) == patch
    return browser.image()[top : top + height, left : left + width][inner].astype(int), patch[inner]


# What is stored ------------------------------------------------------------------------------------------------------


def test_packed_integers_are_small_and_whole() -> None:
    """Unpacked here as data.js unpacks: byte planes, sign in the lowest bit, running sum."""
    rng = np.random.default_rng(3)
    numbers = np.cumsum(rng.integers(-5, 6, size=(3, 1000)), axis=1) - 70_000
    planes = np.frombuffer(gzip.decompress(base64.b64decode(page_data.pack(numbers))), np.uint8).reshape(
        -1, numbers.size
    )
    folded = sum(plane.astype(np.int64) << (8 * byte) for byte, plane in enumerate(planes))
    steps = np.where(folded & 1, -(folded >> 1) - 1, folded >> 1)
    assert np.array_equal(np.cumsum(steps.reshape(3, 1000), axis=1), numbers)
    assert len(page_data.pack(numbers)) < numbers.size  # less than a quarter of their four bytes each


def test_light_is_stored_to_a_third_of_a_per_cent() -> None:
    rng = np.random.default_rng(5)
    planes = rng.lognormal(sigma=3.0, size=(4, 2000)).astype(np.float32)
    planes[1] = 0.0
    planes[2, :1000] = 0.0
    top = planes.max(axis=1)
    codes = page_data.light_codes(planes, top)
    assert codes.min() == 0
    assert codes.max() == page_data.LEVELS
    back = np.where(
        codes > 0, top[:, None] * 2.0 ** (page_data.STOPS * ((codes - 1) / (page_data.LEVELS - 1) - 1)), 0.0
    )
    stored = planes > top[:, None] * 2.0**-page_data.STOPS
    assert np.abs(back[stored] / planes[stored] - 1).max() < 0.0035
    assert back[~stored & (planes <= 0)].max(initial=0) == 0


@pytest.mark.slow
def test_ten_thousand_patches_and_ten_bounces_fit_in_half_a_mebibyte() -> None:
    solution = rad.solve(rad.scenes.cornell_box(), patch_count=10_000, bounces=10)
    size = len(page.page(solution).encode())
    assert 0.9 * 10_000 < len(solution.patches) < 1.15 * 10_000
    assert size < 500 * 1024, f"{size / 1024:.0f} KiB"


class Elements(html.parser.HTMLParser):
    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict]] = []
        self.text = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.text += data


def test_page_names_no_other_file(file: Path) -> None:
    for tag, attributes in Elements(file.read_text(encoding="utf-8")).tags:
        for name in ("src", "href", "action", "poster"):
            assert attributes.get(name, "data:,") == "data:,", (tag, attributes)


def test_those_who_do_not_see_the_picture_get_the_numbers(solution: rad.Solution, file: Path) -> None:
    elements = Elements(file.read_text(encoding="utf-8"))
    tags = [tag for tag, _ in elements.tags]
    assert {"h1", "table", "caption", "noscript", "title"} <= set(tags)
    assert tags.count("tr") == len(solution.power) + 1
    for watts in solution.power.ravel():
        assert f"{watts:.4g}" in elements.text
    for tag, attributes in elements.tags:
        if tag in ("canvas", "svg"):
            assert "aria-label" in attributes or "aria-hidden" in attributes or attributes.get("role") == "img"
        if attributes.get("type") in ("range", "checkbox"):
            assert "id" in attributes


# In the browser ------------------------------------------------------------------------------------------------------


@needs_browser
@pytest.mark.parametrize(
    "link",
    [
        "#k=2&show=both",
        "#k=6&normalised=1",
        "#k=4&ev=1.5&tone=linear",
        "#k=4&ev=2&tone=linear&markClipped=1",
        "#k=5&falseColour=1",
    ],
)
@pytest.mark.parametrize("pane", ["order", "sum"])
def test_pixels_are_the_tone_mapped_values_of_the_solver(browser, file, series, link, pane) -> None:
    browser.size(1000, 640)
    browser.open(file, link)
    pixels, patches = pixels_and_patches(browser, pane)
    expected = picture(series, view_state(browser, series.last), pane)[patches].astype(int)
    assert len(np.unique(patches)) > 250
    assert expected.std() > 3
    assert np.abs(pixels - expected).max() <= 2
    assert browser.complaints == []


@needs_browser
@pytest.mark.parametrize("number", range(len(ALL)))
def test_wrong_pictures_are_those_of_the_shortcuts(browser, file, solution, series, number) -> None:
    """Labelled WRONG, with the equation, the sentence and how far off they are; beside all the light there is."""
    browser.size(1000, 640)
    browser.open(file, f"#wrong={number}&ev=1")
    light = ALL[number].radiosity(solution.patches, solution.factors, solution.radiosity)
    state = view_state(browser, series.last)
    assert state.order == series.last
    pixels, patches = pixels_and_patches(browser, "order")
    expected = coloured(series, state, "sum", display.as_rgb(light).astype(np.float32))[patches].astype(int)
    assert np.abs(pixels - expected).max() <= 2
    assert browser.run("document.querySelector('.title.wrong .formula').textContent") == "WRONG"
    words = browser.run("document.getElementById('wrong').innerText")
    truth, wrong = (display.luminance(display.as_rgb(values)) for values in (solution.radiosity, light))
    off = np.average(np.abs(wrong - truth) / truth, weights=solution.patches.area)
    assert f"WRONG: {ALL[number].name}" in words
    assert ALL[number].sentence in words
    assert f"Off by {100 * off:.0f}" in words
    assert browser.run("document.getElementById('equation').naturalWidth") > 100
    browser.key("d")
    pixels, patches = pixels_and_patches(browser, "order")
    expected = display.diverging_colours((wrong - truth) / truth, 1.0)[patches].astype(int)
    assert np.abs(pixels - expected).max() <= 3  # stored light is 0.3 % off, which is 0.7 of 255 steps of the scale
    assert browser.complaints == []


@needs_browser
def test_darker_paint_is_what_the_solver_finds_for_it(shown: Browser, solution: rad.Solution, series: Series) -> None:
    """T^k E with all reflectances times s is s^k T^k E: the slider solves nothing, and is right."""
    x, y, width, height = shown.box("#paint")
    shown.mouse((x + width / 2, y + height / 2))
    paint = shown.run("viewer.state.paint")
    assert 0.4 < paint < 0.6
    darker = solution.relight(reflectance=paint * solution.patches.reflectance)
    pixels, patches = pixels_and_patches(shown, "sum")
    light = darker.orders[: shown.run("viewer.state.k") + 1].sum(axis=0)
    expected = display.tone_map(light, series.common)[patches].astype(int)
    assert np.abs(pixels - expected).max() <= 2


@needs_browser
def test_smooth_light_is_that_of_the_window(shown: Browser, solution: rad.Solution, series: Series) -> None:
    found = np.array(shown.run("Array.from(atCorners(scene, scene.sums[3]))")).reshape(-1, 3)
    expected = corner_weights(solution.patches) @ series.sums[3]
    np.testing.assert_allclose(found[: len(expected)], expected, rtol=0.004, atol=1e-4 * expected.max())


@needs_browser
def test_what_a_patch_sees_is_its_hemicube(shown: Browser, solution: rad.Solution) -> None:
    """The graphics card draws the item buffer that the solver's hemicube traces."""
    ceiling = np.flatnonzero(solution.patches.surface == solution.patches.surface_names.index("ceiling"))
    patch = int(ceiling[len(ceiling) // 3])
    shown.run(f"viewer.set({{ left: 'sees', picked: {patch} }})")
    _, _, width, height = (round(v) for v in shown.box("canvas"))
    width //= 2
    seen = np.array(shown.run("Array.from(viewer.patchesOf('order'))")).reshape(height, width)[::-1]
    quarter = min(width, height) // 4
    x, y = width // 2, height - height // 2
    seen = seen[y - 2 * quarter : y + 2 * quarter, x - 2 * quarter : x + 2 * quarter]
    traced = np.maximum(HemicubeView.of(solution.patches, patch, 2 * quarter).cross(), -1)
    assert len(np.unique(traced)) > 100
    assert np.mean(seen == traced) > 0.97


@needs_browser
def test_a_click_into_what_a_patch_sees_goes_there(shown: Browser, solution: rad.Solution) -> None:
    """The recursion of the rendering equation, walked by hand."""
    shown.run("viewer.set({ left: 'sees', picked: 0 })")
    x, y, width, height = shown.box("canvas")
    middle = (x + width / 4, y + height / 2)
    here = [0]
    for _ in range(3):
        shown.mouse(middle)
        here.append(shown.run("viewer.state.picked"))
    normal = solution.patches.normal[here]
    assert all(here[i] != here[i + 1] for i in range(3))
    assert all(normal[i] @ normal[i + 1] < 0.5 for i in range(3))  # straight ahead of a wall is another one
    assert f"what patch {here[-1]} sees" in shown.run("document.querySelector('.formula').textContent")
    shown.mouse((x + 3, y + 3))  # where nothing is drawn
    assert shown.run("viewer.state.picked") == here[-1]


@needs_browser
def test_a_page_begins_as_it_is_told(browser: Browser, solution: rad.Solution, tmp_path: Path) -> None:
    settings = {"order": 3, "exposure": 1.5, "tone": "linear", "picked": 7, "left": "hemicube"}
    browser.open(page.write_page(solution, tmp_path / "box.html", wrong=False, title="A box", **settings))
    state = browser.run("viewer.state")
    assert (state["k"], state["ev"], state["tone"], state["picked"], state["left"]) == (3, 1.5, "linear", 7, "sees")
    assert browser.run("document.querySelector('h1').textContent") == "A box"
    assert browser.run("[...document.getElementById('left').options].length") == 2  # no shortcuts are inside
    browser.key("x")
    assert browser.run("viewer.state.left") == "sees"
    assert browser.complaints == []


def test_what_a_page_cannot_show_is_refused(solution: rad.Solution) -> None:
    with pytest.raises(ParameterError, match="a page cannot show wireframe; it can"):
        page.page(solution, wrong=False, wireframe=True)
    with pytest.raises(ParameterError, match="left pane of a page cannot show 'matrix'; it can order, hemicube, wrong"):
        page.page(solution, wrong=False, left="matrix")


CANVAS = """(() => {
    const gl = viewer.painter.gl, { width, height } = gl.canvas, pixels = new Uint8Array(4 * width * height);
    viewer.draw();
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    return btoa(pixels.reduce((text, byte) => text + String.fromCharCode(byte), ""));
})()"""


@needs_browser
@pytest.mark.parametrize(
    "link", ["#show=both&k=2&picked=30", "#show=both&left=sees&picked=30", "#show=sum&falseColour=1", "#wrong=3"]
)
def test_a_view_shown_again_has_the_same_pixels(browser: Browser, file: Path, link: str) -> None:
    """Drawn from the patches, from the numbers of the patches in each pixel, and from those in other light and back."""
    browser.size(900, 480)
    browser.open(file, link)
    browser.run("viewer.painter.views.clear()")
    drawn = browser.run(CANVAS)
    assert browser.run("[...viewer.painter.views.values()].every((view) => !view)")
    looked_up = browser.run(CANVAS)
    assert browser.run("[...viewer.painter.views.values()].every((view) => view)")
    assert looked_up == drawn
    before = browser.run("viewer.state.k")
    browser.run("viewer.set({ k: 0 })")
    assert browser.run(CANVAS) != drawn
    browser.run(f"viewer.set({{ k: {before} }})")
    assert browser.run(CANVAS) == drawn
    assert browser.run("camera.position[0] += 0.05 * radius, " + CANVAS) != drawn
    assert browser.run("[...viewer.painter.views.values()].some((view) => !view)")  # another view is drawn at first
    assert browser.complaints == []


@needs_browser
def test_light_on_the_card_makes_room_for_other_light(shown: Browser) -> None:
    """However much light has been shown, what is kept stays within bounds, and the picture right."""
    first = shown.run("viewer.set({ k: 2 }), " + CANVAS)
    shown.run("for (let i = 0; i < 200; i++) { viewer.set({ paint: 0.9 + 0.0004 * i }); viewer.draw(); }")
    kept = shown.run("[viewer.painter.kept, viewer.painter.lights.size]")
    assert kept[0] <= 12e6
    per_light = 3 * 1024 * -(-shown.run("viewer.meta.patches") // 1024)
    assert kept[1] * per_light == kept[0]
    assert shown.run("viewer.set({ paint: 1 }), " + CANVAS) == first


@needs_browser
def test_names_in_a_scene_are_only_names(browser: Browser, solution: rad.Solution, tmp_path: Path) -> None:
    names = (NASTY, *solution.patches.surface_names[1:])
    patches = dataclasses.replace(solution.patches, surface_names=names, name=NASTY)
    file = page.write_page(dataclasses.replace(solution, patches=patches), tmp_path / "nasty.html")
    browser.size(1000, 640)
    browser.open(file)
    assert browser.run("document.title") == f"Light in {NASTY}, bounce by bounce"
    assert browser.run("viewer.meta.surfaceNames[0]") == NASTY
    assert browser.complaints == []


@needs_browser
@pytest.mark.parametrize("channels", [1, 4])
def test_grey_light_and_spectra_are_shown(browser: Browser, tmp_path: Path, channels: int) -> None:
    floor = rad.Surface(
        "floor", [[0, 0, 0], [1, 0, 0], [1, 0, -1], [0, 0, -1]], [[0, 1, 2, 3]], rad.Material([0.5] * channels)
    )
    solution = rad.solve(rad.Scene([floor], sky=np.arange(1.0, channels + 1)), patch_count=16, bounces=2)
    browser.size(1000, 640)
    browser.open(page.write_page(solution, tmp_path / "floor.html"))
    series = Series.of(solution)
    pixels, patches = pixels_and_patches(browser, "sum")
    assert len(np.unique(patches)) == len(solution.patches)
    assert np.abs(pixels - picture(series, start(series, order=1), "sum")[patches]).max() <= 2
    assert browser.complaints == []


@needs_browser
def test_without_webgl_the_page_says_so(file: Path, tmp_path: Path) -> None:
    browser = Browser(tmp_path, flags=("--disable-3d-apis",))
    try:
        browser.size(800, 600)
        browser.open(file)
        assert "cannot draw with WebGL2: the numbers are in the table below" in browser.run(
            "document.getElementById('trouble').textContent"
        )
        assert browser.box("#trouble")[3] > 20
        assert browser.complaints == []
    finally:
        browser.close()


STEPS = """(() => {
    const gl = viewer.painter.gl, times = [], pixel = new Uint8Array(4);
    for (let i = 0; i < 22; i++) {
        const begin = performance.now();
        viewer.set({ k: i % 11 });
        viewer.draw();
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
        times.push(performance.now() - begin);
    }
    return times;
})()"""


@needs_browser
@pytest.mark.benchmark
@pytest.mark.parametrize(("patches", "limit"), [(10_000, 16.0), (100_000, 33.0)])
def test_a_step_is_quick_without_a_graphics_card(browser: Browser, tmp_path: Path, patches: int, limit: float) -> None:
    solution = rad.solve(rad.scenes.cornell_box(), patch_count=patches, estimator=rad.MonteCarlo(rays=16), bounces=10)
    browser.size(1280, 800)
    browser.open(page.write_page(solution, tmp_path / "big.html"), "#show=sum")
    times = browser.run(STEPS)
    assert float(np.median(times)) <= limit, times
