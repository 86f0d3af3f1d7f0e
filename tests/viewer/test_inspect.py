"""What a picked patch sees is what the solver's methods say it sees."""

import numpy as np
import pytest

import radiosity as rad
from radiosity.viewer.inspect import (
    OUTSIDE,
    UNSEEN,
    HemicubeView,
    MatrixView,
    factor_colours,
    factor_sum,
    patch_lines,
    patch_on_ray,
)
from radiosity.viewer.state import Series, start
from radiosity.viewer.window import Window


@pytest.fixture(scope="module")
def patches(solution: rad.Solution) -> rad.Patches:
    return solution.patches


def nearest(patches: rad.Patches, surface: str, point: tuple[float, float, float]) -> int:
    mine = np.flatnonzero(patches.surface == patches.surface_names.index(surface))
    return int(mine[np.argmin(np.linalg.norm(patches.centroid[mine] - point, axis=1))])


# Rays under the mouse ------------------------------------------------------------------------------------------------


def test_a_ray_at_each_patch_meets_it_or_one_before_it(patches: rad.Patches) -> None:
    rng = np.random.default_rng(1)
    eye = np.array([0.278, 0.273, -0.8])
    met = 0
    facing = np.flatnonzero(np.einsum("nx,nx->n", patches.normal, eye - patches.centroid) > 0)
    for i in rng.choice(facing, 150, replace=False):
        towards = patches.centroid[i] - eye
        hit = patch_on_ray(patches, eye, towards)
        if hit == i:
            met += 1
        else:
            assert np.linalg.norm(patches.centroid[hit] - eye) < np.linalg.norm(towards) + 0.05
    assert met > 60


def test_backs_do_not_stop_a_ray(patches: rad.Patches) -> None:
    """From above, the ceiling is not drawn, and what is drawn is picked."""
    hit = patch_on_ray(patches, np.array([0.5, 2.0, 0.05]), np.array([0.0, -1.0, 0.0]))
    assert patches.surface_names[patches.surface[hit]] == "floor"
    assert patch_on_ray(patches, np.array([0.5, 2.0, 0.05]), np.array([0.0, 1.0, 0.0])) == -1


def test_both_halves_of_quads_and_triangles_are_met() -> None:
    corners = [[0, 0, 0], [1, 0, 0], [1, 0, -1], [0, 0, -1], [2, 0, 0]]
    floor = rad.Surface("floor", corners, [[0, 1, 2, 3], [1, 4, 2, -1]], rad.Material(0.5))
    patches = rad.subdivide(rad.Scene([floor]))
    down = np.array([0.0, -1.0, 0.0])
    hits = [
        patch_on_ray(patches, np.array([x, 1.0, z]), down)
        for x, z in ((0.9, -0.2), (0.1, -0.8), (1.2, -0.2), (1.9, -0.8))
    ]
    assert hits == [0, 0, 1, -1]


# The hemicube --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("surface", ["floor", "back_wall", "tall_block", "lamp"])
def test_the_row_is_that_of_the_hemicube_method(patches: rad.Patches, surface: str) -> None:
    patch = nearest(patches, surface, (0.3, 0.2, 0.2))
    view = HemicubeView.of(patches, patch, resolution=32)
    factors = rad.form_factors(patches, rad.Hemicube(resolution=32), dtype=np.float64)
    np.testing.assert_allclose(view.row(len(patches)), factors.row(patch), atol=1e-14)


def test_the_cross_is_whole_and_shows_every_pixel_once(patches: rad.Patches) -> None:
    view = HemicubeView.of(patches, nearest(patches, "floor", (0.1, 0, 0.1)), resolution=16)
    cross = view.cross()
    assert cross.shape == (32, 32)
    assert np.sum(cross == OUTSIDE) == 4 * 8 * 8
    assert np.array_equal(np.sort(cross[cross != OUTSIDE]), np.sort(view.items))


def test_neighbouring_faces_of_the_cross_meet(patches: rad.Patches) -> None:
    """Across each fold of the cross the same things are seen: no face is turned or mirrored."""
    view = HemicubeView.of(patches, nearest(patches, "floor", (0.45, 0, 0.1)), resolution=128)
    cross = view.cross()
    surface = np.where(cross >= 0, patches.surface[cross], cross)
    first, last = 64, 64 + 127
    for inner, outer in (
        (surface[first, first : last + 1], surface[first - 1, first : last + 1]),
        (surface[last, first : last + 1], surface[last + 1, first : last + 1]),
        (surface[first : last + 1, first], surface[first : last + 1, first - 1]),
        (surface[first : last + 1, last], surface[first : last + 1, last + 1]),
    ):
        assert len(np.unique(inner)) > 1 or inner[0] == outer[0]
        assert np.mean(inner == outer) > 0.9


def test_the_cross_stands_upright_and_is_not_mirrored(patches: rad.Patches) -> None:
    """Somebody who leans on the back wall has the ceiling above, the floor below, the red wall on the right."""
    view = HemicubeView.of(patches, nearest(patches, "back_wall", (0.278, 0.5, 0.56)), resolution=64)
    cross = view.cross()
    names = np.array([*patches.surface_names, "none", "none", "none"])
    seen = names[np.where(cross >= 0, patches.surface[cross], len(names) - 1)]
    rows, columns = np.mgrid[:128, :128]
    assert rows[seen == "ceiling"].mean() < 40
    assert rows[seen == "floor"].mean() > 80
    assert columns[seen == "red_wall"].mean() > 100
    assert columns[seen == "green_wall"].mean() < 30


def test_colours_of_the_cross(patches: rad.Patches) -> None:
    view = HemicubeView.of(patches, 0, resolution=16)
    colours = np.random.default_rng(0).integers(0, 255, (len(patches), 3)).astype(np.uint8)
    image, cross = view.picture(colours), view.cross()
    assert np.array_equal(image[cross >= 0], colours[cross[cross >= 0]])
    assert np.array_equal(image[0, 0], UNSEEN)


# Rows and matrices as numbers and colours ----------------------------------------------------------------------------


def test_colours_of_a_row() -> None:
    colours, low, high = factor_colours(np.array([0.0, 1e-9, 0.003, 0.03]))
    assert (low, high) == (5e-5, 0.05)
    assert colours[0].tolist() == list(UNSEEN)
    assert colours[1].tolist() != list(UNSEEN)
    assert colours[3].sum() > colours[2].sum() > colours[1].sum()


def test_factors_of_a_patch_add_up_to_one_in_words(solution: rad.Solution) -> None:
    words = factor_sum(solution, 5)
    assert words.endswith("= 1.0000")
    assert f"Σ = {solution.factors.row(5).sum():.4f}" in words


def test_exchange_of_two_patches_is_reciprocal_but_for_sampling(solution: rad.Solution, patches: rad.Patches) -> None:
    series = Series.of(solution)
    one, two = nearest(patches, "floor", (0.2, 0, 0.05)), nearest(patches, "lamp", (0.278, 0.55, 0.28))
    forth, back = patch_lines(solution, series, 3, one, two), patch_lines(solution, series, 3, two, one)
    assert forth[0].startswith(f"patch {one} of floor, ")
    assert f"to patch {two} of lamp: F = " in forth[3]
    pair = [forth[3].split("F = ")[1].split(", back "), back[3].split("F = ")[1].split(", back ")]
    assert pair[0] == pair[1][::-1]
    exchange = [float(text) for text in forth[4].removeprefix("A F = ").split(" cm²")[0].split(" and ")]
    assert exchange[0] == pytest.approx(1e4 * patches.area[one] * solution.factors.row(one)[two], rel=0.01)


def test_hemicubes_see_that_exchange_is_reciprocal(patches: rad.Patches) -> None:
    one, two = nearest(patches, "floor", (0.45, 0, 0.05)), nearest(patches, "ceiling", (0.1, 0.55, 0.1))
    there, back = (HemicubeView.of(patches, i, 256).row(len(patches))[j] for i, j in ((one, two), (two, one)))
    assert there > 1e-3
    assert patches.area[one] * there == pytest.approx(patches.area[two] * back, rel=0.06)


@pytest.mark.parametrize("most", [1000, 37])
def test_matrix_picture_holds_the_means_of_its_entries(solution: rad.Solution, patches: rad.Patches, most: int) -> None:
    matrix = rad.TransportOperator(solution.factors, patches).matrix(0)
    view = MatrixView.of(matrix, patches.surface, patches.surface_names, most)
    side = min(most, len(patches))
    assert view.means.shape == (side, side)
    order = np.argsort(patches.surface, kind="stable")
    dense = matrix.toarray()[np.ix_(order, order)]
    bins = np.arange(len(patches)) * side // len(patches)
    for row, column in ((0, side // 2), (side - 1, 3), (side // 3, side // 3)):
        expected = dense[np.ix_(bins == row, bins == column)].mean()
        assert view.means[row, column] == pytest.approx(expected, rel=1e-6, abs=1e-15)
    assert view.borders[-1] == (patches.surface_names[-1], 1.0)


def test_row_and_column_of_the_pick_are_lit_up(solution: rad.Solution, patches: rad.Patches) -> None:
    matrix = rad.TransportOperator(solution.factors, patches).matrix(0)
    view = MatrixView.of(matrix, patches.surface, patches.surface_names, 100)
    changed = np.any(view.picture(17) != view.picture(), axis=-1)
    assert changed[view.place[17]].all()
    assert changed[:, view.place[17]].all()
    assert changed.sum() == 199


# In the window -------------------------------------------------------------------------------------------------------


@pytest.fixture
def window(solution: rad.Solution):
    window = Window(solution, off_screen=True, size=(800, 500), order=3)
    window.image()
    yield window
    window.close()


def click(window: Window, x: int, y: int, *, drag: int = 0, ctrl: bool = False) -> None:
    interactor = window.plotter.iren.interactor
    interactor.SetEventInformation(x, y, int(ctrl), 0)
    interactor.InvokeEvent("LeftButtonPressEvent")
    interactor.SetEventInformation(x + drag, y, int(ctrl), 0)
    interactor.InvokeEvent("MouseMoveEvent")
    interactor.InvokeEvent("LeftButtonReleaseEvent")


@pytest.mark.usefixtures("gl")
def test_a_click_picks_what_is_seen_there(window: Window, patches: rad.Patches) -> None:
    """Every picked patch against the picture painted in patch numbers."""
    count = len(patches)
    number = np.arange(1, count + 1)
    codes = np.column_stack([number & 255, number >> 8, np.full(count, 77)]).astype(np.uint8)
    for drawing in window.panes.values():
        drawing.draw(window.series, window.state, codes)
    image = window.image().astype(int)[::-1]  # from the lower left, as events count
    rng = np.random.default_rng(2)
    checked = 0
    for x, y in rng.integers([5, 110], [795, 450], size=(80, 2)):
        around = image[y - 1 : y + 2, x - 1 : x + 2]
        if np.any(around[..., 2] != 77) or np.ptp(around.reshape(-1, 3), axis=0).any():
            continue
        assert window.inspector.patch_at(x, y) == image[y, x, 0] + 256 * image[y, x, 1] - 1
        checked += 1
    assert checked > 25
    click(window, 600, 300)
    assert window.state.picked == window.inspector.patch_at(600, 300) >= 0


@pytest.mark.usefixtures("gl")
def test_picking_in_the_window(window: Window) -> None:
    before = window.image()
    click(window, 600, 300, drag=20)
    assert window.state.picked == -1  # a drag turns the camera
    click(window, 600, 300)
    first = window.state.picked
    assert window.dashboard.status.actor.GetInput().startswith(f"patch {first} of ")
    assert np.mean(np.any(window.image() != before, axis=-1)) > 0.001
    click(window, 650, 200, ctrl=True)
    assert (window.state.picked, window.state.other) == (first, window.inspector.patch_at(650, 200))
    assert "to patch" in window.dashboard.status.actor.GetInput()
    assert "by hemicubes" in window.dashboard.status.actor.GetInput()
    click(window, 405, 130)  # beside the room
    assert window.state.picked == -1
    assert window.dashboard.status.actor.GetInput().startswith("k = 3")


@pytest.mark.usefixtures("gl")
def test_the_left_pane_shows_factors_hemicube_and_matrix(window: Window) -> None:
    window.press("g")
    assert window.state.left == "matrix"  # without a patch, nothing else is possible
    window.press("g")
    assert window.state.left == "order"
    click(window, 600, 300)
    images = [window.image()]
    for left in ("factors", "hemicube", "matrix", "order"):
        window.press("g")
        assert window.state.left == left
        images.append(window.image())
        assert np.mean(np.any(images[-1] != images[-2], axis=-1)) > 0.02, left
    assert np.array_equal(images[-1], images[0])
    window.press("g")
    row = window.model.hemicube(window.state.picked).row(len(window.solution.patches))
    assert np.array_equal(window.panes["order"].colours[:, 0], factor_colours(row)[0])
    assert not window.bars["sum"].strip.actor.GetVisibility()
    assert window.bars["order"].strip.actor.GetVisibility()


def test_picks_in_the_state(solution: rad.Solution) -> None:
    state = start(Series.of(solution))
    assert state.pick(3).pick_other(5).other == 5
    assert state.pick(3).pick_other(3).other == -1
    assert state.pick_other(5).picked == 5
    assert state.pick(3).next_left().left == "factors"
    assert state.pick(3).next_left().pick(-1).left == "order"
    with pytest.raises(rad.RadiosityError, match=f"picked is patch 99999; there are {len(solution.patches)}"):
        start(Series.of(solution), picked=99999)
