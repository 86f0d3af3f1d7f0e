"""Pictures show the patches' own colours, at their own places, and words never stand on them."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import radiosity as rad
from radiosity import display
from radiosity.errors import ParameterError
from radiosity.viewer import figures
from radiosity.viewer.coverage import Coverage
from radiosity.viewer.drawing import BACK_COLOUR, BACKGROUND
from radiosity.viewer.sheet import Sheet
from radiosity.viewer.state import PANES, Series, picture, start

pytestmark = pytest.mark.usefixtures("gl")


@pytest.fixture(scope="module")
def series(solution: rad.Solution) -> Series:
    return Series.of(solution)


@pytest.fixture(scope="module")
def stage(solution: rad.Solution):
    with figures.Stage(solution.patches, (400, 400)) as stage:
        yield stage


def colour(name: str) -> list[int]:
    return [int(name[i : i + 2], 16) for i in (1, 3, 5)]


def pixels(path: Path) -> np.ndarray:
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB"))


def patch_of_pixels(stage: figures.Stage, series: Series) -> np.ndarray:
    """Which patch each pixel shows, (height, width); -1 at edges and outside. Found by painting patches in numbers."""
    count = len(series.area)
    code = np.random.default_rng(1).permutation(1 << 16)[:count]  # neighbours are far apart: a mixture is no number
    patch_of_code = np.full(1 << 16, -1)
    patch_of_code[code] = np.arange(count)
    codes = np.column_stack([code & 255, code >> 8, np.full(count, 77)]).astype(np.uint8)
    stage.drawing.draw(series, start(series), codes)
    stage.plotter.render()
    image = np.asarray(stage.plotter.screenshot(return_img=True)).astype(int)
    patch = np.where(image[..., 2] == 77, patch_of_code[image[..., 0] + 256 * image[..., 1]], -1)
    inner = patch >= 0
    for shift in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1), (1, -1), (-1, 1)):
        inner &= np.roll(patch, shift, axis=(0, 1)) == patch
    return np.where(inner, patch, -1)


@pytest.mark.parametrize("pane", PANES)
@pytest.mark.parametrize(
    "settings", [{"order": 2}, {"order": 5, "normalised": True}, {"tone": "linear", "exposure": -1.0}]
)
def test_every_pixel_has_exactly_the_colour_of_its_patch(stage, series, pane, settings) -> None:
    patch = patch_of_pixels(stage, series)
    shown = patch >= 0
    assert np.unique(patch[shown]).size > 250
    state = start(series, **settings)
    image = stage.image(series, state, pane)
    assert np.array_equal(image[shown], picture(series, state, pane)[patch[shown]])


def test_the_official_camera_puts_red_left_green_right_lamp_above(stage, series, solution) -> None:
    patch = patch_of_pixels(stage, series)
    names = np.array([*solution.patches.surface_names, "nothing"])
    surface = names[np.where(patch < 0, len(names) - 1, solution.patches.surface[patch])]
    places = {name: np.mean(np.nonzero(surface == name), axis=1) / 400 for name in np.unique(surface)}
    assert places["red_wall"][1] < 0.2
    assert places["green_wall"][1] > 0.8
    assert places["floor"][0] > 0.8
    assert places["ceiling"][0] < 0.2
    assert places["lamp"] == pytest.approx([0.13, 0.5], abs=0.05)
    image = stage.image(series, start(series, order=6), "sum").astype(int)
    red, green = (image[surface == name].mean(axis=0) for name in ("red_wall", "green_wall"))
    assert red[0] > 2 * red[1]
    assert green[1] > 1.2 * green[0]


def test_smooth_stays_near_flat_but_has_no_steps(stage, series) -> None:
    flat, smooth = (stage.image(series, start(series, order=6, smooth=on), "sum").astype(int) for on in (False, True))
    assert 1.0 < np.abs(flat - smooth).mean() < 12.0
    wall = np.s_[100:160, 110:290]  # the back wall above the blocks
    steps = {name: np.abs(np.diff(image[wall], axis=1)).max() for name, image in (("flat", flat), ("smooth", smooth))}
    assert steps["smooth"] < 0.5 * steps["flat"]


def test_walls_that_look_away_do_not_hide_the_room(solution, series) -> None:
    with figures.Stage(solution.patches, (200, 200), preset=1) as outside:
        patch = patch_of_pixels(outside, series)
        normals = solution.patches.normal[np.unique(patch[patch >= 0])]
        camera = np.array(outside.drawing.renderer.camera.position)
        seen = solution.patches.centroid[np.unique(patch[patch >= 0])]
        assert np.einsum("nc,nc->n", normals, camera - seen).min() > 0
        without = outside.image(series, start(series, order=6), "sum")
        with_backs = outside.image(series, start(series, order=6, backs=True), "sum")
    share = {
        name: np.mean(np.abs(image.astype(int) - colour(BACK_COLOUR)).max(axis=-1) < 4)
        for name, image in (("without", without), ("with", with_backs))
    }
    assert share["without"] == 0.0
    assert share["with"] > 0.2


def test_wireframe_draws_edges(stage, series) -> None:
    plain, wired = (
        stage.image(series, start(series, order=6, wireframe=on), "sum").astype(int) for on in (False, True)
    )
    assert 0.02 < np.mean(np.abs(plain - wired).max(axis=-1) > 20) < 0.6


def test_contact_sheet_keeps_words_off_the_pictures(solution, series, tmp_path: Path) -> None:
    """Every pane of the sheet is, pixel for pixel, the picture alone."""
    figure = figures.contact_sheet(solution, series=series, orders=[0, 1, 5], pane_size=160)
    path = figures.save_figure(figure, tmp_path / "sheet.png")
    sheet = pixels(path)
    assert sheet.shape[:2] == tuple(int(v) for v in figure.get_size_inches()[::-1] * 100)
    with figures.Stage(solution.patches, (480, 480)) as stage:
        stage.plotter.render_window.SetMultiSamples(0)  # the sheet has nine samples a pixel, and these are the same
        for row, (pane, own) in enumerate([("order", False), ("order", True), ("sum", False)]):
            for column, k in enumerate([0, 1, 5]):
                alone = figures.shrunk(stage.image(series, start(series, order=k, normalised=own), pane), 3)
                x = Sheet.left + column * (160 + Sheet.gap)
                y = row * (160 + Sheet.head) + Sheet.head
                pasted = sheet[y : y + 160, x : x + 160]
                assert np.abs(pasted.astype(int) - alone).max() <= 1, (row, column)
    words = [text.get_text() for text in figure.texts]
    assert "$T^{5} L_e$" in words
    assert r"$\sum_{j=0}^{5} T^j L_e$" in words
    assert any(word.startswith("×") and word.endswith(" EV") for word in words)


def test_shrinking_keeps_the_light() -> None:
    """Half the pixels white is half the light, not the half of the codes."""
    board = np.zeros((4, 4, 3), dtype=np.uint8)
    board[::2, ::2] = board[1::2, 1::2] = 255
    assert np.array_equal(figures.shrunk(board, 2), np.full((2, 2, 3), 188))


def test_a_pixel_shows_the_light_of_its_patches_in_their_shares(solution, series) -> None:
    """Patches painted white or black: pixels between two are grey by the share of light, others are as painted."""
    state = start(series)
    with figures.Stage(solution.patches, (300, 300)) as stage:
        coverage = Coverage(stage.drawing, series, state, 3)
        white = np.arange(len(series.area)) % 2 == 0
        image = coverage.picture(np.repeat(np.where(white, 255, 0)[:, None], 3, axis=1).astype(np.uint8))
        again = stage.image(series, state, "sum")
    assert image.shape == (100, 100, 3)
    of_patches = coverage.shares[:, :-1].toarray()
    share = of_patches.sum(axis=1).reshape(100, 100)
    assert coverage.shares.sum(axis=1) == pytest.approx(np.ones(10_000), abs=1e-6)
    lit = of_patches[:, white].sum(axis=1).reshape(100, 100)
    inside = share > 1 - 1e-6
    assert 0.5 < inside.mean() < 1.0
    assert np.abs(display.decode_srgb(image[..., 0])[inside] - lit[inside]).max() < 0.005
    assert np.mean((lit[inside] > 0.05) & (lit[inside] < 0.95)) > 0.05, "there are pixels of two patches"
    with figures.Stage(solution.patches, (300, 300)) as stage:
        assert np.array_equal(stage.image(series, state, "sum"), again), "the drawing is left as it was"


def test_columns_of_a_long_series_reach_its_end() -> None:
    for last in range(60):
        shown = figures.columns(last)
        assert shown[0] == 0
        assert shown[-1] == last
        assert len(shown) <= figures.MOST_COLUMNS
        assert shown == sorted(set(shown))


def test_power_plot_shows_watts_on_a_logarithmic_axis(series) -> None:
    figure = figures.power_plot(series, order=2)
    (axes,) = figure.axes
    assert axes.get_yscale() == "log"
    assert axes.get_ylabel().endswith(", W")
    curves = [line for line in axes.lines if len(line.get_xdata()) == series.last + 1]
    np.testing.assert_allclose([line.get_ydata() for line in curves], series.power.T)
    assert [text.get_text() for text in axes.texts] == ["red", "green", "blue"]


def test_power_plot_of_one_channel_and_of_darkness() -> None:
    for power in (np.array([[3.0], [1.0]]), np.zeros((2, 1))):
        orders = np.broadcast_to(power[:, None, :], (2, 1, 3)).astype(np.float32)
        figures.power_plot(Series(orders, np.cumsum(orders, axis=0), np.ones(1), power)).canvas.draw()


def test_write_pictures(solution, tmp_path: Path) -> None:
    written = figures.write_pictures(solution, tmp_path / "new" / "folder", orders=[1])
    assert [path.name for path in written] == ["orders.png", "power.png", "sum.png", "order_1.png"]
    for path in written:
        assert pixels(path).std() > 5
    total = pixels(written[2])
    assert total[2, 2].tolist() == colour(BACKGROUND)


def test_save_by_suffix(solution, tmp_path: Path) -> None:
    solution.save(tmp_path / "direct.png", order=1, pane="order", size=(90, 60))
    assert pixels(tmp_path / "direct.png").shape == (60, 90, 3)
    with pytest.raises(ParameterError, match="pane 'both' is unknown"):
        solution.save(tmp_path / "direct.png", pane="both")
