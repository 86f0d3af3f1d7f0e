"""The Cornell box: measured corners and spectra, no face covered or doubled."""

import numpy as np
import pytest

from radiosity.scenes import cornell_box, cornell_data

from .areas import vector_areas


@pytest.fixture(scope="module")
def box():
    return cornell_box()


def areas(scene):
    return {s.name: np.linalg.norm(vector_areas(s), axis=1).sum() for s in scene.surfaces}


def test_names_and_openness(box):
    assert box.surface_names == (
        "floor", "ceiling", "lamp", "back_wall", "green_wall", "red_wall", "short_block", "tall_block",
    )  # fmt: skip
    assert box.closed is False
    assert not any(s.material.two_sided for s in box.surfaces)
    assert (box.sky == 0).all()


def test_areas_by_hand(box):
    """Trapezoid less footprints, ceiling less lamp; mm² by the shoelace formula."""
    found = areas(box)
    assert found["floor"] == pytest.approx((308231.04 - 27633.0 - 27626.5) * 1e-6, rel=1e-12)
    assert found["ceiling"] == pytest.approx((556 * 559.2 - 130 * 105) * 1e-6, rel=1e-12)
    assert found["lamp"] == pytest.approx(130 * 105e-6, rel=1e-12)
    assert found["green_wall"] == pytest.approx(559.2 * 548.8e-6, rel=1e-12)
    assert found["back_wall"] == pytest.approx((549.6 + 556) / 2 * 548.8e-6, rel=1e-12)


def test_normals_point_into_the_room(box):
    middle = np.array([0.278, 0.274, 0.280])
    for surface in box.surfaces:
        inward = 1 if "block" not in surface.name else -1
        centre = middle if inward == 1 else surface.vertices.mean(axis=0)
        for corners, area in zip(surface.vertices[surface.faces], vector_areas(surface), strict=False):
            assert inward * (centre - corners.mean(axis=0)) @ area > 0, surface.name


def test_red_wall_keeps_its_measured_bend(box):
    """Its fourth corner lies 3.1997 mm off the plane of the first three."""
    a, b, c, d = box.surfaces[box.surface_names.index("red_wall")].vertices
    normal = np.cross(b - a, c - a)
    assert abs((d - a) @ normal) / np.linalg.norm(normal) == pytest.approx(3.199730043265466e-3, rel=1e-9)


def test_blocks_meet_the_floor_edge_to_edge(box):
    """Whatever the floor lost is ringed by the blocks: the same corners, to the last bit."""
    floor = {tuple(v) for v in box.surfaces[0].vertices}
    for name in ("short_block", "tall_block"):
        vertices = box.surfaces[box.surface_names.index(name)].vertices
        feet = {tuple(v) for v in vertices if v[1] == 0}
        assert len(feet) == 4
        assert feet <= floor


def test_light_is_pi_times_radiance(box):
    lamp = box.surfaces[box.surface_names.index("lamp")].material
    assert np.array_equal(lamp.emission, np.pi * np.array([17.0, 12.0, 4.0]))
    assert np.array_equal(lamp.reflectance, [0.78, 0.78, 0.78])


def test_spectral_box_has_the_measured_bands():
    box = cornell_box(spectral=True)
    assert box.channels == len(cornell_data.WAVELENGTHS) == 76
    red = box.surfaces[box.surface_names.index("red_wall")].material.reflectance
    assert red[0] == 0.040
    assert red[-1] == 0.642
    lamp = box.surfaces[box.surface_names.index("lamp")].material.emission / np.pi
    assert lamp[[0, 25, 50, 75]] == pytest.approx([0.0, 8.0, 15.6, 18.4])


def test_table_by_its_landmarks():
    """Lengths, sums and extrema of the transcribed table, so that no row can slip."""
    nm = np.array(cornell_data.WAVELENGTHS)
    table = {paint: np.array(values) for paint, values in cornell_data.REFLECTANCE.items()}
    assert {paint: len(values) for paint, values in table.items()} == {"white": 76, "green": 76, "red": 76}
    assert nm[np.argmax(table["green"])] == 528
    assert table["green"].max() == 0.481
    assert nm[np.argmin(table["white"])] == 400
    assert nm[np.argmax(table["red"])] == 688
    assert {paint: round(values.sum(), 3) for paint, values in table.items()} == {
        "white": 54.923,
        "green": 15.067,
        "red": 18.464,
    }
