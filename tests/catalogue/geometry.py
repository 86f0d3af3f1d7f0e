"""Geometry that is difficult: the right answer, or a name for what is wrong."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np

import radiosity as rad
from radiosity.errors import GeometryError, GeometryWarning, NoSteadyState, OccludedSceneError, SceneError
from radiosity.form_factors.closed_forms import parallel_rectangles, parallel_rectangles_offset

from .case import Case, found, refused, value, warned

GREY, LAMP = rad.Material(0.5), rad.Material(0.5, emission=1.0)
SHEET = rad.Material(0.5, emission=1.0, two_sided=True)
CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
INWARD = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])[:, ::-1]
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
OVER_THE_CORNER = ((0.0, 1e-6), (0.0, 1e-6), (0.0, 1.0), (0.0, 1.0))
RAYS = rad.MonteCarlo(rays=256, light_rays=0)


def furnace(*more, points=CUBE, faces=INWARD, scale=1.0, shift=0.0, **named):
    """A closed room of ρ = 0.5 and E = 1 W/m² with things in it that are alike: B = 2 W/m² everywhere."""
    room = rad.Surface("room", (points + shift) * scale, faces, LAMP)
    others = [rad.Surface(name, (np.asarray(v, float) + shift) * scale, f, m) for name, v, f, m in more]
    return rad.Scene([room, *others], closed=True, **named)


def light(scene, **settings):
    """Radiosity of a scene, all patches and channels."""
    settings = {"patch_count": 150, "estimator": RAYS, **settings}
    return rad.solve(scene, **settings).radiosity


def plates(gap, size=1.0, emission=1.0):
    """Two squares of 1 m² face to face."""
    upper = rad.Surface("upper", SQUARE * size + [0, 0, gap], [[3, 2, 1, 0]], GREY)
    lamp = rad.Material(0.5, emission=emission)
    return rad.Scene([rad.Surface("lower", SQUARE * size, [[0, 1, 2, 3]], lamp), upper])


def between(scene, estimator):
    """The form factor from the first patch to the second."""
    return rad.form_factors(rad.subdivide(scene), estimator, dtype=np.float64).matrix.toarray()[0, 1]


def lamp_of_a_micrometre():
    """A lamp of 1e-12 m² above the corner of a floor of 1 m²."""
    dot = SQUARE * 1e-6 + [0, 0, 1]
    return rad.Scene(
        [rad.Surface("dot", dot, [[3, 2, 1, 0]], LAMP), rad.Surface("floor", SQUARE, [[0, 1, 2, 3]], GREY)]
    )


def halves():
    """The cube with one wall of two halves, whose seam ends on the edges of other walls."""
    points = np.concatenate([CUBE, [[0, 0, 0.5], [0, 1, 0.5]]])
    faces = np.concatenate([INWARD[1:], [[2, 9, 8, 0], [9, 3, 1, 8]]])
    return furnace(points=points, faces=faces)


def sliver():
    """The cube with a wall that a strip of 1e-6 m is cut from."""
    points = np.concatenate([CUBE, [[0, 0, 1e-6], [0, 1, 1e-6]]])
    return furnace(points=points, faces=np.concatenate([INWARD[1:], [[2, 9, 8, 0], [9, 3, 1, 8]]]))


def sliver_light(own):
    """Light of the patches of the strip, or of all others."""
    solution = rad.solve(sliver(), patch_count=150, estimator=RAYS)
    return solution.radiosity[(solution.patches.area < 1e-6) == own]


def doubled():
    return furnace(("wallpaper", CUBE, INWARD[:1], LAMP))


def flat_face():
    points = np.concatenate([CUBE, [[0.5, 0, 0]]])
    faces = np.concatenate([np.column_stack([INWARD]), [[0, 8, 4, -1]]])
    return furnace(points=points, faces=faces)


def turned(scene):
    """Every other face of a scene seen from its back."""

    def half(surface):
        faces = surface.faces.copy()
        faces[::2] = faces[::2, ::-1]
        return replace(surface, faces=faces)

    return replace(scene, surfaces=[half(s) for s in scene.surfaces], closed=None)


def one(material=LAMP, sky=0.0, points=SQUARE, faces=((0, 1, 2, 3),)):
    return rad.Scene([rad.Surface("square", points, faces, material)], sky=sky)


def area(points, faces):
    return rad.subdivide(one(points=np.asarray(points, float), faces=faces)).area.sum()


def box_on_the_floor():
    """A room with a box that stands on its floor, face on face."""
    box = 0.25 + 0.5 * CUBE
    box[:, 2] -= 0.25
    return rad.Scene([rad.Surface("room", CUBE, INWARD, LAMP), rad.Surface("box", box, INWARD[:, ::-1], GREY)])


def balance(scene):
    """Power that is missing at the end, as a share of what was put in."""
    patches = rad.subdivide(scene, patch_count=100)
    factors = rad.form_factors(patches, RAYS, dtype=np.float64).conserved()
    B = rad.Direct().solve(rad.TransportOperator(factors, patches), patches.emission, sky=patches.sky).radiosity
    put_in = (patches.area[:, None] * patches.emission).sum()
    out = patches.area[:, None] * (patches.absorptance * factors.gather(B) + factors.to_sky[:, None] * B)
    return (put_in - out.sum()) / put_in


def mended(scene):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GeometryWarning)
        return scene.fixed_normals()


G = "difficult geometry"
TWO = "B = 2 W/m², as E / (1 - ρ)"
FURNACE = [
    ("zero-area face", "a face without area in a furnace", flat_face),
    ("T-junctions", "a wall of a furnace of two halves", halves),
    ("sheet in a room", "a two-sided sheet in a furnace", lambda: furnace(("sheet", SQUARE * 0.3 + 0.3, [[0, 1, 2, 3]], SHEET))),
    ("three walls at an edge", "a partition that starts at an edge of a furnace",
     lambda: furnace(("fin", [CUBE[0], CUBE[1], [0.3, 0.3, 1], [0.3, 0.3, 0]], [[0, 1, 2, 3]], SHEET))),
    ("scale 1e-9", "a furnace of a nanometre", lambda: furnace(scale=1e-9)),
    ("scale 1e9", "a furnace of a million kilometres", lambda: furnace(scale=1e9)),
    ("origin 1e6 sizes away", "a furnace that far from the origin", lambda: furnace(shift=1e6)),
    ("origin 1e9 sizes away", "a furnace that far from the origin", lambda: furnace(shift=1e9)),
    ("triangles", "a furnace of triangles", lambda: furnace(faces=np.concatenate([INWARD[:, [0, 1, 2]], INWARD[:, [0, 2, 3]]]))),
    ("doubled wall, cut", "a wall twice, by `remove_contacts`", lambda: rad.remove_contacts(doubled())[0]),
    ("flipped normals, mended", "every other wall turned, by `fixed_normals`", lambda: mended(turned(furnace()))),
    ("a room within a room's wall", "a furnace in the cavity of a furnace's wall",
     lambda: furnace(("cavity", 0.4 + 0.2 * CUBE, INWARD[:, ::-1], LAMP), ("inner", 0.45 + 0.1 * CUBE, INWARD, LAMP))),
]  # fmt: skip

CASES = [
    *(Case(G, name, how, TWO, value(lambda make=make: light(make()), 2.0, rel=2e-5)) for name, how, make in FURNACE),
    Case(G, "beside a sliver", "a wall of a furnace with a strip of 1e-6 of its width cut off", "B = 2 W/m² on all else",
         value(lambda: sliver_light(False), 2.0, rel=2e-5)),
    Case(G, "sliver", "the strip itself, a tenth as wide as what rays resolve", "B = 2 W/m² within 3 %: a limit, which a check names",
         value(lambda: sliver_light(True), 2.0, rel=0.03)),
    Case(G, "no leaks between slivers", "rays in the furnace with the sliver", "no ray is lost",
         value(lambda: rad.form_factors(rad.subdivide(sliver()), RAYS).statistics["rays/leaked"], 0.0)),
    Case(G, "zero-area face, named", "a face without area", "said, and left out",
         warned(lambda _: rad.subdivide(flat_face()), GeometryWarning, "1 of 7 faces have no area")),
    Case(G, "surface without area", "a line as a surface", "refused by name",
         refused(lambda _: rad.subdivide(one(points=SQUARE * [1, 0, 0])), GeometryError, "all 1 faces have no area")),
    Case(G, "bow tie", "a quad whose edges cross", "refused by name",
         refused(lambda _: rad.subdivide(one(points=SQUARE[[0, 2, 1, 3]])), GeometryError, "quad 0 cross over")),
    Case(G, "concave quad", "a dart", "its area, 0.2 m²",
         value(lambda: area([[0, 0, 0], [1, 0, 0], [0.2, 0.2, 0], [0, 1, 0]], [[0, 1, 2, 3]]), 0.2, rel=1e-14)),
    Case(G, "bent quad", "a quad with a corner 1 m up", "two triangles along the shorter diagonal, (1 + √3) / 2 m²",
         value(lambda: area(SQUARE + [[0, 0, 0], [0, 0, 0], [0, 0, 1], [0, 0, 0]], [[0, 1, 2, 3]]), 0.5 + np.sqrt(3) / 2,
               rel=1e-14)),
    Case(G, "doubled wall, named", "a wall twice", "named, with its area",
         found(doubled, "coincident surfaces", "'room' and 'wallpaper' .* over 1 m²")),
    Case(G, "sliver, named", "a strip of 1e-6", "named, with its width", found(sliver, "slivers", "1e-06 m wide")),
    Case(G, "T-junctions, named", "a wall of two halves", "named, with places", found(halves, "T-junctions", "2 T-j")),
    Case(G, "flipped normals, named", "every other wall turned", "named, with the remedy",
         found(lambda: turned(furnace()), "flipped normals", "'room' has 3 faces against.*--fix-normals")),
    Case(G, "inside out, named", "a closed box as modelled from outside", "named",
         found(lambda: rad.Scene([rad.Surface("room", CUBE, INWARD[:, ::-1], LAMP)]), "inside out", "faces outwards")),
    Case(G, "open edges, named", "a room that lacks a wall, declared closed", "named, with their length",
         found(lambda: furnace(faces=INWARD[:5]), "open edges", "4 edges .*4 m in all")),
    Case(G, "open shell", "a furnace that lacks a wall", "no power is lost: in = absorbed + out",
         value(lambda: balance(replace(furnace(faces=INWARD[:5]), closed=False)), 0.0, abs_=1e-12)),
    Case(G, "box on the floor", "a box that stands on the floor, face on face, after `remove_contacts`",
         "no power is lost", value(lambda: balance(rad.remove_contacts(box_on_the_floor())[0]), 0.0, abs_=1e-12)),
    Case(G, "box on the floor, named", "the same before", "named, with the area they share",
         found(box_on_the_floor, "touching surfaces", r"'room' and 'box' .* over 0\.25 m²")),
    Case(G, "one patch", "a square that shines into the dark", "B = E = 1", value(lambda: light(one(), patch_count=1), 1.0)),
    Case(G, "one patch under a sky", "the same under L = 1 W/(m² sr)", "B = E + ρ π L",
         value(lambda: light(one(sky=1.0), patch_count=1), 1 + np.pi / 2, rel=1e-7)),
    Case(G, "two-sided sheet under a sky", "a sheet under L = 1", "B = E + ρ π L on both sides",
         value(lambda: light(one(SHEET, sky=1.0), patch_count=2), 1 + np.pi / 2, rel=1e-7)),
    Case(G, "plates at distance 1", "two unit squares, exact", "0.199824895698387",
         value(lambda: between(plates(1.0), rad.Analytic()), 0.199824895698387, rel=1e-14)),
    Case(G, "gap of 1e-3", "two unit squares, exact", "the closed form",
         value(lambda: between(plates(1e-3), rad.Analytic()), parallel_rectangles(1, 1, 1e-3), rel=1e-11)),
    Case(G, "gap of 1e-3, by rays", "two dark unit squares, 65 536 rays", "the closed form",
         value(lambda: between(plates(1e-3, emission=0.0), rad.MonteCarlo(rays=65536)), parallel_rectangles(1, 1, 1e-3),
               rel=1e-3)),
    Case(G, "gap of 1e-6", "two unit squares, exact", "the closed form",
         value(lambda: between(plates(1e-6), rad.Analytic()), parallel_rectangles(1, 1, 1e-6), rel=1e-9)),
    Case(G, "gap of 1e-6, by rays", "a lamp 1e-6 m above a floor", "refused: rays do not resolve it",
         refused(lambda _: light(plates(1e-6)), GeometryError, "nearer than")),
    Case(G, "gap of 1e-6, named", "the same, checked", "named, as an error",
         found(lambda: plates(1e-6), "narrow gap", "^error: .*1e-06 m wide")),
    Case(G, "area ratio 1e12", "a lamp of 1e-12 m² above a corner of a floor, exact", "the closed form",
         value(lambda: between(lamp_of_a_micrometre(), rad.Analytic()), parallel_rectangles_offset(*OVER_THE_CORNER, 1.0), rel=1e-9)),
    Case(G, "area ratio 1e12, reciprocal", "the same, both ways", "A_i F_ij = A_j F_ji",
         value(lambda: _asymmetry(lamp_of_a_micrometre()), 0.0, abs_=1e-12)),
    Case(G, "hidden faces, exact method", "`Analytic` in a room with a box", "refused by name",
         refused(lambda _: rad.form_factors(rad.subdivide(box_on_the_floor()), rad.Analytic()), OccludedSceneError, "Analytic")),
    Case(G, "nothing absorbs", "a closed room of ρ = 1 with a lamp", "refused: light grows for ever",
         refused(lambda _: rad.solve(rad.scenes.furnace(reflectance=1.0), estimator=RAYS, patch_count=96), NoSteadyState,
                 "grow|absorb")),
    Case(G, "absorptance 1e-12", "a furnace that absorbs 1e-12", "B = 1e12 W/m²",
         value(lambda: light(rad.scenes.furnace(absorptance=1e-12), patch_count=24, solver=rad.Direct(), dtype=np.float64),
               1e12, rel=1e-9)),
    Case(G, "far from the origin, named", "1e10 sizes away", "named, with the rounding",
         found(lambda: furnace(shift=1e10), "far from the origin", "rounded to")),
    Case(G, "corners that are no numbers", "a NaN among the corners", "refused by name",
         refused(lambda _: one(points=SQUARE * [[1], [np.nan], [1], [1]]), GeometryError, "not finite: 1")),
    Case(G, "huge corners", "coordinates of 1e80 m", "refused by name",
         refused(lambda _: one(points=SQUARE * 1e80), GeometryError, r"reach 1e\+80 m")),
    Case(G, "corner that does not exist", "a face of corners 0, 1, 2, 9", "refused by name",
         refused(lambda _: one(faces=[[0, 1, 2, 9]]), GeometryError, "index 9 is outside 0 … 3 in faces 0")),
    Case(G, "two surfaces of one name", "'square' twice", "refused by name",
         refused(lambda _: rad.Scene([*one().surfaces, *one().surfaces]), SceneError, "share a name: 'square'")),
    Case(G, "empty scene", "no surfaces", "refused by name", refused(lambda _: rad.Scene([]), SceneError, "is empty")),
    Case(G, "negative light", "an emission of -1", "refused by name",
         refused(lambda _: one(rad.Material(0.5, emission=-1.0)), SceneError, "emission -1 W/m².*negative")),
    Case(G, "reflectance of 1.5", "more out than in", "refused by name",
         refused(lambda _: one(rad.Material(1.5)), SceneError, r"1\.5 in channel 0 is outside \[0, 1\]")),
    Case(G, "no light at all", "a grey square under a black sky", "said, and solved as black",
         warned(lambda _: light(one(GREY), patch_count=1), rad.errors.UnlitSceneWarning, "has no light.*--lamp")),
]  # fmt: skip


def _asymmetry(scene):
    patches = rad.subdivide(scene)
    F = rad.form_factors(patches, rad.Analytic(), dtype=np.float64).matrix.toarray()
    return patches.area[0] * F[0, 1] / (patches.area[1] * F[1, 0]) - 1.0
