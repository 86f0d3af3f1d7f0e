"""Cameras find their place by themselves."""

import numpy as np
import pytest

import radiosity as rad
from radiosity.camera import presets


def test_cornell_box_is_seen_by_its_official_camera() -> None:
    """Position (278, 273, -800) mm, 39.3°, looking at the back wall; x to the left in the box's own frame."""
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=300)
    camera = presets(patches)[0]
    assert (camera.name, camera.fov) == ("front", 39.3)
    distance = np.linalg.norm(np.subtract(camera.position, camera.focal_point))
    low, high = patches.vertices.min(axis=0), patches.vertices.max(axis=0)
    assert distance - (high - low)[2] / 2 == pytest.approx(0.8, abs=2e-3)
    assert camera.position[:2] == pytest.approx(((low + high) / 2)[:2], abs=2e-3)


@pytest.mark.parametrize("name", ["red_rug", "furnace"])
def test_closed_rooms_are_seen_from_within_first(name: str) -> None:
    patches = rad.subdivide(getattr(rad.scenes, name)(), patch_count=300)
    inside, outside = presets(patches)
    low, high = patches.vertices.min(axis=0), patches.vertices.max(axis=0)
    assert (inside.name, outside.name) == ("inside", "outside")
    assert np.all((low < inside.position) & (inside.position < high))
    assert not np.all((low < outside.position) & (outside.position < high))


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_everything_is_in_the_outside_picture(scale: float) -> None:
    points = scale * np.array([[0, 0, 0], [3, 0, 0], [3, 0, 2], [0, 0, 2]])
    patches = rad.subdivide(rad.Scene([rad.Surface("floor", points, [[0, 3, 2, 1]], rad.Material(0.5))], sky=[1.0]))
    outside = next(camera for camera in presets(patches) if camera.name == "outside")
    forward = np.subtract(outside.focal_point, outside.position)
    to_points = points - outside.position
    angle = np.degrees(np.arccos(to_points @ forward / np.linalg.norm(to_points, axis=1) / np.linalg.norm(forward)))
    assert angle.max() < outside.fov / 2
    assert angle.max() > 0.5 * outside.fov / 2  # and fills it
    assert outside.position[1] > 0  # from above, where the floor's front is


def test_vertices_that_no_patch_uses_do_not_move_the_camera() -> None:
    corners = [[0, 0, 0], [1, 0, 0], [1, 0, -1], [0, 0, -1]]
    plain = rad.Surface("floor", corners, [[0, 1, 2, 3]], rad.Material(0.5))
    stray = rad.Surface("floor", [*corners, [1e6, 0, 0]], [[0, 1, 2, 3]], rad.Material(0.5))
    one, other = (presets(rad.subdivide(rad.Scene([surface]))) for surface in (plain, stray))
    assert one == other
