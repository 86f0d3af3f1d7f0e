"""What is difficult about a scene is found, named by surface and place, and nothing else is."""

from __future__ import annotations

import numpy as np
import pytest

import radiosity as rad
from radiosity.finding import Severity, listed
from radiosity.inspection import findings

GREY = rad.Material(0.5)
SHEET = rad.Material(0.5, two_sided=True)
LAMP = rad.Material(0.5, emission=1.0)
CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
INWARD = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])[:, ::-1]
OUTWARD = INWARD[:, ::-1]
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)


def scene(*parts, sky=1.0, **named):
    """Surfaces from (name, vertices, faces) or (name, vertices, faces, material)."""
    surfaces = [rad.Surface(name, v, f, *(rest or [GREY])) for name, v, f, *rest in parts]
    return rad.Scene(surfaces, sky=sky, **named)


def room(*parts, **named):
    return scene(("room", CUBE, INWARD, LAMP), *parts, sky=0.0, **named)


def small(shift=0.4, size=0.2):
    return shift + size * CUBE


def plate(height, faces=((3, 2, 1, 0),), size=1.0):
    return SQUARE * size + [0, 0, height], faces


FLOOR = ("floor", SQUARE, [[0, 1, 2, 3]], LAMP)
FIN = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, -1, 0], [1, -1, 0], [0, 0, 1], [1, 0, 1]]

# name → scene, kind, severity, surfaces, count, place, words of the message
CASES = {
    "a face without area": (
        scene(("floor", [*SQUARE, [0.5, 0, 0]], [[0, 1, 2], [0, 4, 1]], LAMP)),
        ("zero-area faces", Severity.NOTE, ("floor",), 1, (0.5, 0, 0), "has 1 face without area (face 1)"),
    ),
    "a surface without area": (
        scene(FLOOR, ("line", [[0, 0, 1], [1, 0, 1], [2, 0, 1]], [[0, 1, 2]])),
        ("zero-area faces", Severity.ERROR, ("line",), 1, (1, 0, 1), "consists only of them"),
    ),
    "a bow tie": (
        scene(("tie", SQUARE[[0, 2, 1, 3]], [[0, 1, 2, 3]])),
        ("crossed quads", Severity.ERROR, ("tie",), 1, (0.5, 0.5, 0), "whose edges cross over (face 0)"),
    ),
    "a bent quad": (
        scene(("sail", SQUARE + [[0, 0, 0], [0, 0, 0], [0, 0, 0.1], [0, 0, 0]], [[0, 1, 2, 3]])),
        ("bent quads", Severity.NOTE, ("sail",), 1, (0.5, 0.5, 0.025), "1 bent quad, by 8.1° at most"),
    ),
    "a sliver": (
        scene(("floor", [[0, 0, 0], [1, 0, 0], [0.5, 2e-6, 0], [0.5, 1, 0]], [[0, 1, 2], [0, 2, 3], [2, 1, 3]], LAMP)),
        ("slivers", Severity.WARNING, ("floor",), 1, (0.5, 2e-6 / 3, 0), "down to 2e-06 m wide and up to 1 m long"),
    ),
    "a floor twice": (
        scene(FLOOR, ("rug", *plate(0.0, [[0, 1, 2, 3]]))),
        ("coincident surfaces", Severity.WARNING, ("floor", "rug"), 2, None, "face the same way, over 1 m²"),
    ),
    "a plate on the floor": (
        scene(FLOOR, ("plate", *plate(0.0))),
        ("touching surfaces", Severity.WARNING, ("floor", "plate"), 2, None, "face opposite ways, over 1 m²"),
    ),
    "a gap of a hair": (
        scene(FLOOR, ("lid", *plate(3e-6))),
        (
            "narrow gap",
            Severity.ERROR,
            ("floor", "lid"),
            2,
            None,
            "3e-06 m wide, 2e-06 of the scene (rays",
        ),
    ),
    "a lamp touches the floor but for rounding": (
        scene(FLOOR, ("lid", *plate(1e-8))),
        ("narrow gap", Severity.ERROR, ("floor", "lid"), 2, None, "one of them a lamp"),
    ),
    "a box touches the floor but for rounding": (
        scene(("floor", SQUARE, [[0, 1, 2, 3]]), ("lid", *plate(1e-8))),
        ("touching surfaces", Severity.WARNING, ("floor", "lid"), 2, None, "face opposite ways, over 1 m²"),
    ),
    "a sheet above the floor": (
        scene(("floor", SQUARE, [[0, 1, 2, 3]]), ("sheet", *plate(3e-6, [[0, 1, 2, 3]]), SHEET)),
        ("narrow gap", Severity.WARNING, ("floor", "sheet"), 2, None, "cannot resolve"),
    ),
    "a sheet above the floor, named before it": (
        scene(("sheet", *plate(3e-6, [[0, 1, 2, 3]]), SHEET), ("floor", SQUARE, [[0, 1, 2, 3]])),
        ("narrow gap", Severity.WARNING, ("sheet", "floor"), 2, None, "cannot resolve"),
    ),
    "two rooms without a wall": (
        scene(("below", *plate(-3e-6)), ("above", SQUARE, [[0, 1, 2, 3]])),
        ("thin wall", Severity.WARNING, ("below", "above"), 2, None, "back to back"),
    ),
    "one wall of a cube turned": (
        room(("box", small(), np.concatenate([OUTWARD[:5], INWARD[5:]]))),
        ("flipped normals", Severity.WARNING, ("box",), 1, (0.5, 0.5, 0.6), "against their neighbours"),
    ),
    "one face of an open shell turned": (
        scene(("roof", FIN, [[0, 1, 2, 3], [0, 1, 5, 4], [4, 5, 7, 6]], LAMP)),
        ("flipped normals", Severity.WARNING, ("roof",), 1, None, "against their neighbours"),
    ),
    "a body inside out": (
        room(("box", small(), INWARD)),
        ("inside out", Severity.WARNING, ("box",), 6, None, "a closed body that faces inwards"),
    ),
    "a room inside out": (
        scene(("room", CUBE, OUTWARD, LAMP), ("box", small(), OUTWARD), sky=0.0),
        ("inside out", Severity.WARNING, ("room",), 6, None, "a closed room that faces outwards"),
    ),
    "a lone room inside out": (
        scene(("room", CUBE, OUTWARD, LAMP), sky=0.0),
        ("inside out", Severity.WARNING, ("room",), 6, None, "a closed room that faces outwards"),
    ),
    "three walls at an edge": (
        scene(("fin", FIN, [[0, 1, 2, 3], [1, 0, 4, 5], [0, 1, 7, 6]], LAMP)),
        ("non-manifold edges", Severity.NOTE, ("fin",), 1, (0.5, 0, 0), "1 edge of three faces or more"),
    ),
    "a wall of two halves": (
        scene(
            ("floor", SQUARE, [[0, 1, 2, 3]], LAMP),
            (
                "wall",
                [[0, 0, 0], [0.5, 0, 0], [1, 0, 0], [0, 0, 1], [0.5, 0, 1], [1, 0, 1]],
                [[1, 0, 3, 4], [2, 1, 4, 5]],
            ),
        ),
        ("T-junctions", Severity.NOTE, ("floor",), 1, (0.5, 0, 0), "in 1 T-junction"),
    ),
    "a crack": (
        scene(FLOOR, ("wall", [[0, 0, 1e-7], [1, 0, 1e-7], [1, 0, 1], [0, 0, 1]], [[1, 0, 3, 2]])),
        ("cracks", Severity.NOTE, ("floor", "wall"), 2, None, "up to 1e-07 m apart"),
    ),
    "a hole in a closed room": (
        scene(("room", CUBE, INWARD[:5], LAMP), closed=True),
        ("open edges", Severity.WARNING, ("room",), 4, None, "has 4 edges that no other face shares (4 m in all)"),
    ),
    "an open box": (
        scene(("crate", CUBE, OUTWARD[:5], LAMP)),
        ("open edges", Severity.NOTE, ("crate",), 4, None, "4 edges"),
    ),
    "far away": (
        scene(("floor", SQUARE + 4e9, [[0, 1, 2, 3]], LAMP)),
        ("far from the origin", Severity.WARNING, ("floor",), 1, None, "rounded to 1e-06 m"),
    ),
    "no light": (
        scene(("floor", SQUARE, [[0, 1, 2, 3]]), sky=0.0),
        ("no light", Severity.WARNING, (), 1, None, "everything will be black"),
    ),
    "light without end": (
        scene(("room", CUBE, INWARD, rad.Material(1.0, emission=1.0)), closed=True),
        ("nothing absorbs", Severity.ERROR, (), 1, None, "grows for ever"),
    ),
    "a mirror of digits": (
        room(("box", small(), OUTWARD, rad.Material(1.0 - 1e-14))),
        ("absorptance rounded", Severity.WARNING, ("box",), 1, None, "keeps no digits"),
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_what_is_difficult_is_named_and_placed(name):
    made, (kind, severity, surfaces, count, place, words) = CASES[name]
    (found,) = [one for one in made.validate() if one.kind == kind]
    assert found.severity is severity
    assert found.surfaces == surfaces
    assert found.count == count
    if place is not None:
        assert found.places == pytest.approx(np.array([place]), abs=1e-12)
    assert words in found.message
    assert found.remedy
    assert str(found).startswith(f"{severity.name.lower()}: ")


@pytest.mark.parametrize("name", CASES)
def test_nothing_else_is_said(name):
    """Beside what was built in, only that the scene is open."""
    made, (kind, *_) = CASES[name]
    others = {one.kind for one in findings(made)} - {kind, "open edges"}
    related = {
        "one wall of a cube turned": set(),
        "a gap of a hair": {"cracks"},
        "a lamp touches the floor but for rounding": {"cracks"},
        "a box touches the floor but for rounding": {"cracks"},
        "a sheet above the floor": {"cracks"},
        "a sheet above the floor, named before it": {"cracks"},
        "two rooms without a wall": {"cracks"},
        "a sliver": set(),
        "light without end": set(),
    }
    assert others <= related.get(name, set()), listed(findings(made))


@pytest.mark.parametrize("name", rad.scenes.BUILT_IN)
def test_built_in_scenes_need_no_warning(name):
    assert all(found.severity is Severity.NOTE for found in findings(rad.scenes.BUILT_IN[name]()))


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("name", ["a sliver", "a floor twice", "a gap of a hair", "a crack", "a wall of two halves"])
def test_scale_changes_nothing(name, scale):
    made, (kind, _, surfaces, count, *_) = CASES[name]
    parts = [rad.Surface(s.name, s.vertices * scale, s.faces, s.material) for s in made.surfaces]
    (found,) = [one for one in findings(rad.Scene(parts, sky=1.0)) if one.kind == kind]
    assert (found.surfaces, found.count) == (surfaces, count)


def test_errors_come_first_and_all_of_it_at_once():
    made = scene(
        ("tie", SQUARE[[0, 2, 1, 3]] + [0, 0, 5], [[0, 1, 2, 3]]), FLOOR, ("rug", *plate(0.0, [[0, 1, 2, 3]])), sky=0.0
    )
    found = made.validate()
    assert [one.kind for one in found] == ["crossed quads", "coincident surfaces", "open edges"]
    assert listed(found).splitlines() == [str(one) for one in found]


def test_a_large_mesh_with_holes_is_reported_in_few_places():
    """2e4 faces, a third of them missing: thousands of open edges, of which the longest are named."""
    n = 100
    x, y = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    points = np.stack([x, y, np.sin(x / 9.0) * np.cos(y / 7.0)], axis=-1).reshape(-1, 3)
    a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    faces = np.concatenate([np.stack([a, a + n + 1, a + n + 2], 1), np.stack([a, a + n + 2, a + 1], 1)])
    keep = np.random.default_rng(0).random(len(faces)) < 2 / 3
    (found,) = [one for one in findings(scene(("hills", points, faces[keep], LAMP))) if one.kind == "open edges"]
    assert found.count > 5_000
    assert len(found.places) == 200


@pytest.mark.parametrize("gap", [0.0, 5e-10, 5e-9, 5e-7, 5e-6, 5e-5])
def test_an_error_is_what_a_solve_refuses(gap):
    """A lid over a lamp, ever closer: the finding and the solve agree about it."""
    made = scene(FLOOR, ("lid", *plate(gap)))
    wrong = [one for one in findings(made) if one.severity is Severity.ERROR]
    if wrong:
        with pytest.raises(rad.errors.GeometryError, match="nearer than"):
            rad.form_factors(rad.subdivide(made), rad.MonteCarlo(rays=16))
    else:
        rad.form_factors(rad.subdivide(made), rad.MonteCarlo(rays=16))
    assert bool(wrong) == (1e-9 < gap < 1e-5)
