"""Validation at the door: what is wrong, where, the number."""

from __future__ import annotations

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import GeometryError, MaterialError, SceneError

SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
GREY = rad.Material(0.5)


def square(name="wall", vertices=SQUARE, faces=((0, 1, 2, 3),), material=GREY):
    return rad.Surface(name, vertices, faces, material)


def test_the_given_one_of_reflectance_and_absorptance_is_kept_exactly():
    assert rad.Material(absorptance=1e-12).absorptance[0] == 1e-12
    assert rad.Material(reflectance=1e-12).reflectance[0] == 1e-12
    assert rad.Material(reflectance=[0.25, 0.5]).absorptance.tolist() == [0.75, 0.5]


def test_one_number_serves_all_channels():
    material = rad.Material(0.5, emission=[1.0, 2.0, 3.0])
    assert material.channels == 3
    scene = rad.Scene([square(material=material), square("grey")], sky=2.0)
    assert scene.channels == 3
    assert scene.sky.tolist() == [2.0, 2.0, 2.0]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({}, "either reflectance or absorptance"),
        ({"reflectance": 0.5, "absorptance": 0.5}, "either reflectance or absorptance"),
        ({"reflectance": [[0.5]]}, r"shape \(1, 1\)"),
        ({"reflectance": "red"}, "'red'"),
        ({"reflectance": [0.5, 0.5], "emission": [1, 1, 1]}, "2 channels and emission 3"),
    ],
)
def test_materials_that_make_no_sense(values, message):
    with pytest.raises(MaterialError, match=message):
        rad.Material(**values)


@pytest.mark.parametrize(
    ("material", "message"),
    [
        ({"reflectance": [0.5, 1.5, 0.5]}, "surface 'wall': reflectance 1.5 in channel 1 is outside"),
        ({"reflectance": -0.1}, "reflectance -0.1"),
        ({"reflectance": np.nan}, "reflectance nan"),
        ({"absorptance": 1.0001}, "absorptance 1.0001"),
        ({"reflectance": 0.5, "emission": -1.0}, "emission -1 W/m²"),
        ({"reflectance": 0.5, "emission": np.inf}, "emission inf"),
    ],
)
def test_values_outside_physics_name_surface_value_and_channel(material, message):
    with pytest.raises(MaterialError, match=message):
        square(material=rad.Material(**material))


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"vertices": [[0, 0, np.nan], *SQUARE[1:]]}, "not finite: 0"),
        ({"faces": [[0, 1, 2, 4]]}, "index 4 is outside 0 … 3"),
        ({"faces": [[0, 1, -1, 2]]}, "index -1"),
        ({"faces": [[0, 1, 2, -2]]}, "index -2"),
        ({"faces": np.empty((0, 3), int)}, "no faces"),
        ({"faces": [[0.0, 1.0, 2.0]]}, "integer"),
        ({"faces": [[0, 1]]}, r"\(1, 2\)"),
        ({"vertices": [[0, 0]]}, r"\(1, 2\)"),
    ],
)
def test_meshes_that_are_no_surface_name_it(parts, message):
    with pytest.raises(GeometryError, match=f"surface 'wall'.*{message}"):
        square(**parts)


def test_scenes_that_cannot_be_lit():
    with pytest.raises(SceneError, match="empty"):
        rad.Scene([])
    with pytest.raises(SceneError, match="share a name: 'wall'"):
        rad.Scene([square(), square()])
    with pytest.raises(SceneError, match="channels differ"):
        rad.Scene([square(material=rad.Material([0.5, 0.5]))], sky=[1, 1, 1])
    with pytest.raises(SceneError, match="negative or not finite"):
        rad.Scene([square()], sky=-1)
    with pytest.raises(SceneError, match="is named ''"):
        square(name="")


def test_all_that_is_wrong_comes_in_one_message():
    with pytest.raises(SceneError, match=r"share a name(.|\n)*channels differ(.|\n)*sky"):
        rad.Scene([square(), square(material=rad.Material([0.5, 0.5]))], sky=[-1, 0, 0])


def test_arrays_cannot_be_changed_behind_the_checks():
    surface = square()
    with pytest.raises(ValueError, match="read-only"):
        surface.vertices[0, 0] = np.nan
    given = np.array(SQUARE, dtype=float)
    surface = square(vertices=given)
    given[0, 0] = np.nan
    assert np.isfinite(surface.vertices).all()


def test_what_python_shows_of_large_objects_is_a_line() -> None:
    scene = rad.scenes.cornell_box()
    solution = rad.solve(scene, patch_count=100)
    T = rad.TransportOperator(solution.factors, solution.patches)
    shown = [scene, solution, solution.patches, solution.factors, solution.result, solution.certificate, T]
    assert {type(one).__name__: len(repr(one)) for one in shown if not 20 < len(repr(one)) < 250} == {}
    assert repr(scene) == (
        "<Scene 'cornell_box': 8 surfaces (floor, ceiling, lamp, back_wall, green_wall, red_wall …), "
        "33 faces, sky [0. 0. 0.]>"
    )


def test_a_surface_turned_twice_is_itself() -> None:
    """Quads, and triangles padded among them, keep their corners and show them from the other side."""
    mixed = square(faces=[[0, 1, 2, 3], [0, 1, 2, -1]])
    assert mixed.turned().faces.tolist() == [[0, 3, 2, 1], [2, 1, 0, -1]]
    assert mixed.turned([1]).faces.tolist() == [[0, 1, 2, 3], [2, 1, 0, -1]]
    assert mixed.turned().turned().faces.tolist() == mixed.faces.tolist()
