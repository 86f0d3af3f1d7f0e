"""Analytic(): exact factors of scenes that hide nothing, and the refusal of all others by name."""

from __future__ import annotations

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import FormFactorError, MemoryLimitError, OccludedSceneError
from radiosity.form_factors import analytic
from radiosity.form_factors import closed_forms as cf
from tests.truths import load

GREY = rad.Material(0.5)
TWO_SIDED = rad.Material(0.5, two_sided=True)


def square(name, at, facing=1, axis=2, side=1.0, material=GREY):
    """A square about the point `at`, its normal along ± an axis."""
    u, v = np.roll(np.eye(3), axis - 2, axis=1)[:2] * side / 2
    corners = [np.array(at, dtype=float) + s * u + t * v for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return rad.Surface(name, corners[::facing], [[0, 1, 2, 3]], material)


def exact(scene, **cut):
    patches = rad.subdivide(scene, **cut)
    return patches, rad.form_factors(patches, rad.Analytic(), dtype=np.float64)


def test_closed_room_rows_close_and_obey_reciprocity():
    _, factors = exact(rad.scenes.red_rug(), patch_count=400)
    assert np.abs(factors.closure_defect).max() < 1e-9
    assert factors.reciprocity_defect < 1e-15
    assert not factors.to_sky.any()
    assert not factors.to_backs.any()
    assert factors.statistics["leaks/share"] < 1e-10
    assert factors.statistics["rays/traced"] == 0


def test_empty_box_against_its_exact_factors_and_light():
    truth = load("empty_box")
    factors = rad.form_factors(truth.patches, rad.Analytic(), dtype=np.float64)
    assert np.abs(factors.matrix.toarray() - truth.data["F"]).max() < 1e-12
    T = rad.TransportOperator(factors, truth.patches)
    orders = T.orders(truth.patches.emission, count=12)
    assert orders == pytest.approx(truth.data["B_disc"], rel=1e-9, abs=1e-12)


def test_float32_weights():
    patches = rad.subdivide(rad.scenes.furnace(), patch_count=150)
    narrow, wide = (rad.form_factors(patches, rad.Analytic(), dtype=kind) for kind in (np.float32, np.float64))
    assert narrow.matrix.dtype == np.float32
    assert narrow.matrix.toarray() == pytest.approx(wide.matrix.toarray(), rel=6e-8, abs=0)
    assert np.abs(narrow.closure_defect).max() < 1e-6


def test_open_plates_send_the_rest_to_the_sky():
    scene = rad.Scene([square("floor", (0, 0, 0)), square("ceiling", (0, 0, 1), facing=-1)], sky=1.0)
    _, factors = exact(scene)
    assert factors.row(0) == pytest.approx([0.0, cf.parallel_rectangles(1, 1, 1)], abs=1e-13)
    assert factors.to_sky == pytest.approx(np.full(2, 1 - cf.parallel_rectangles(1, 1, 1)), abs=1e-13)


def test_plates_a_millionth_apart_which_rays_cannot_tell_from_one():
    gap = 1e-7
    scene = rad.Scene([square("below", (0, 0, 0)), square("above", (0, 0, gap), facing=-1)])
    _, factors = exact(scene)
    assert factors.to_sky == pytest.approx(np.full(2, 1 - cf.parallel_rectangles(1, 1, gap)), abs=1e-12)
    assert factors.to_sky.min() > 1e-7


def test_outside_of_a_convex_body_sees_only_the_sky():
    patches, factors = exact(rad.scenes.uniform_dome(subdivisions=1))
    assert factors.matrix.nnz == 0
    assert (factors.to_sky == 1.0).all()
    assert len(patches) == 80


def test_sphere_factors_are_shares_of_its_area_as_facets_grow_small():
    patches, factors = exact(rad.scenes.integrating_sphere(subdivisions=2))
    assert np.abs(factors.closure_defect).max() < 1e-9
    share = patches.area / patches.area.sum()
    # Facets are not the sphere: about a fiftieth off, root mean square.
    off = factors.matrix.toarray() / share - 1
    assert 0.005 < np.sqrt(np.mean(off[~np.eye(len(share), dtype=bool)] ** 2)) < 0.05


@pytest.mark.parametrize("both", [True, False])
def test_two_sided_plates_that_face_each_other(both):
    upper = square("upper", (0, 0, 1), facing=-1, material=TWO_SIDED)
    lower = square("lower", (0, 0, 0), material=TWO_SIDED if both else GREY)
    _, factors = exact(rad.Scene([lower, upper]))
    inner = cf.parallel_rectangles(1, 1, 1)
    assert sorted(factors.matrix.toarray().ravel())[-2:] == pytest.approx([inner, inner], abs=1e-13)
    assert factors.matrix.nnz == 2
    assert np.count_nonzero(factors.to_sky == 1.0) == (2 if both else 1), "outsides see only the sky"


def test_walls_that_rounding_bends_are_flat():
    """Coordinates stored as float32, of a room turned against the axes; its walls are made of several faces."""
    turn, _ = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))
    turn *= np.linalg.det(turn)
    surfaces = [
        rad.Surface(s.name, (s.vertices @ turn.T).astype(np.float32).astype(float), s.faces, s.material)
        for s in rad.scenes.red_rug().surfaces
    ]
    _, factors = exact(rad.Scene(surfaces, name="turned", closed=True), patch_count=300)
    assert 1e-9 < np.abs(factors.closure_defect).max() < 1e-6, "of the size of the bends"


# Refusals

LAMP_ABOVE = square("lamp", (0, 0, 2), facing=-1, side=0.5)
FLOOR = square("floor", (0, 0, 0))


@pytest.mark.parametrize(
    ("surfaces", "says"),
    [
        # A plate between two others hides them from each other.
        ([FLOOR, LAMP_ABOVE, square("table", (0, 0, 1), side=0.2)], "face 2 of surface 'table' shows its back to"),
        ([FLOOR, LAMP_ABOVE, square("table", (0, 0, 1), side=0.2, material=TWO_SIDED)], "on the other side, of face 2"),
        # A back is black: light that falls on it goes nowhere.
        ([FLOOR, square("shelf", (0, 0, 1))], "face 1 of surface 'shelf' shows its back to face 0 of surface 'floor'"),
        # A wall across the middle of a floor.
        (
            [FLOOR, square("wall", (0, 0, 0.5), axis=0)],
            "surface 'floor' reaches through the plane of face 1 of surface 'wall'",
        ),
        # A two-sided plate under a floor sees its back.
        ([FLOOR, square("rug", (0, 0, -1), material=TWO_SIDED)], "face 1 of surface 'rug' is two-sided and behind"),
    ],
)
def test_what_may_hide_something_is_refused_by_name(surfaces, says):
    patches = rad.subdivide(rad.Scene(surfaces))
    with pytest.raises(OccludedSceneError, match=says):
        rad.form_factors(patches, rad.Analytic())


@pytest.mark.parametrize("scene", [rad.scenes.cornell_box, rad.scenes.hidden_lamp, rad.scenes.two_rooms])
def test_scenes_with_obstacles_are_refused_and_told_what_to_do(scene):
    with pytest.raises(OccludedSceneError, match=r"MonteCarlo\(\) or Hemicube\(\)"):
        rad.form_factors(rad.subdivide(scene()), rad.Analytic())


def test_a_concave_room_is_refused():
    """An L seen from above: its inner corner hides one arm from the other."""
    outline = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], dtype=float)
    walls = []
    for k, (a, b) in enumerate(zip(outline, np.roll(outline, -1, axis=0), strict=True)):
        corners = [[*b, 0], [*a, 0], [*a, 1], [*b, 1]]
        walls.append(rad.Surface(f"wall {k}", corners, [[0, 1, 2, 3]], GREY))
    with pytest.raises(OccludedSceneError, match="wall"):
        rad.form_factors(rad.subdivide(rad.Scene(walls)), rad.Analytic())


def test_doubled_surfaces_are_refused():
    """They would take the same light twice."""
    surfaces = list(rad.scenes.furnace().surfaces)
    top = surfaces[0]
    twice = [*surfaces, rad.Surface("again", top.vertices, top.faces, top.material)]
    with pytest.raises(FormFactorError, match="overlap"):
        rad.form_factors(rad.subdivide(rad.Scene(twice, closed=True)), rad.Analytic())


def test_more_patches_than_memory_has_room_for():
    """All pairs at once take 8 bytes each beside the rows."""
    patches = rad.subdivide(rad.scenes.furnace(), patch_count=96)
    with pytest.raises(MemoryLimitError, match=r"96 patches.*would take \d+ kB.*fewer patches"):
        rad.form_factors(patches, rad.Analytic(), memory_limit=8 * 96**2 + 50_000)
    rad.form_factors(patches, rad.Analytic(), memory_limit=8 * 96**2 + 70_000)


def test_rows_by_themselves_are_the_rows_of_all_pairs():
    """A worker makes rows without the others; the lower patch of a pair comes first, from either side."""
    patches = rad.subdivide(rad.scenes.furnace(), patch_count=96)
    alone, together = analytic.ExactRows(patches), analytic.ExactRows(patches).at_once()
    for span in ((0, 7), (7, 50), (50, 96)):
        for one, other in zip(alone(span), together(span), strict=True):
            assert np.array_equal(one, other)


# Against the sampling estimators


def test_rays_and_hemicubes_agree_within_their_errors():
    patches, factors = exact(rad.scenes.furnace(), patch_count=96)
    true = factors.matrix.toarray()
    sampled = rad.form_factors(patches, rad.MonteCarlo(rays=4096, seed=1, sampling="random")).matrix.toarray()
    error = np.sqrt(true * (1 - true) / 4096)
    seen = true > 0
    deviation = (sampled - true)[seen] / error[seen]
    assert 0.9 < np.sqrt(np.mean(deviation**2)) < 1.1, "binomial, neither more nor less"
    assert not sampled[~seen].any()
    cubed = rad.form_factors(patches, rad.Hemicube(resolution=64, samples=4)).matrix.toarray()
    assert 1e-5 < np.abs(cubed - true).max() < 1e-2
