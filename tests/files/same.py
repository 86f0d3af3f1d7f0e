"""Whether two scenes are the same to the last bit, written for the tests."""

import numpy as np


def assert_same_bits(found, expected, what):
    assert found.dtype == expected.dtype, what
    assert found.shape == expected.shape, what
    assert found.tobytes() == expected.tobytes(), what


def assert_same_scene(found, expected):
    assert found.name == expected.name
    assert found.closed is expected.closed
    assert_same_bits(found.sky, expected.sky, "sky")
    assert found.surface_names == expected.surface_names
    for one, other in zip(found.surfaces, expected.surfaces, strict=True):
        assert_same_bits(one.vertices, other.vertices, f"{other.name}: vertices")
        assert_same_bits(one.faces, other.faces, f"{other.name}: faces")
        a, b = one.material, other.material
        assert (a.given, a.two_sided, a.name) == (b.given, b.two_sided, b.name)
        for what in ("reflectance", "absorptance", "emission"):
            assert_same_bits(getattr(a, what), getattr(b, what), f"{other.name}: {what}")


def triangle_soup(surface):
    """Corners (T, 3, 3) of a surface, quads as a, b, c and a, c, d."""
    corners = []
    for face in surface.faces:
        corners.append(surface.vertices[face[:3]])
        if len(face) == 4 and face[3] >= 0:
            corners.append(surface.vertices[face[[0, 2, 3]]])
    return np.array(corners)
