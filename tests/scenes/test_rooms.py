"""Closed rooms enclose their volume, with normals inwards."""

import numpy as np
import pytest

from radiosity.errors import MaterialError
from radiosity.scenes import furnace, red_rug

from .areas import enclosed_volume, vector_areas


@pytest.mark.parametrize(("scene", "volume"), [(furnace(size=2.0), 8.0), (red_rug(), 4 * 2.6 * 4)])
def test_closed_rooms_enclose_their_volume(scene, volume):
    found, total = enclosed_volume(scene.surfaces)
    assert scene.closed is True
    assert found == pytest.approx(-volume, rel=1e-12)  # normals point inwards
    assert np.abs(total).max() < 1e-12


def test_furnace_walls_are_alike():
    scene = furnace(absorptance=[1e-12, 0.5], emission=[2.0, 3.0])
    assert scene.channels == 2
    for surface in scene.surfaces:
        assert surface.material.given == "absorptance"
        assert surface.material.absorptance[0] == 1e-12
        assert np.array_equal(surface.material.emission, [2.0, 3.0])
    assert furnace().surfaces[0].material.reflectance == 0.5
    with pytest.raises(MaterialError):
        furnace(reflectance=0.5, absorptance=0.5)


def test_rug_and_lamp_fill_their_holes():
    scene = red_rug()
    area = {s.name: np.linalg.norm(vector_areas(s), axis=1).sum() for s in scene.surfaces}
    assert area["floor"] + area["rug"] == pytest.approx(16.0, rel=1e-12)
    assert area["ceiling"] + area["lamp"] == pytest.approx(16.0, rel=1e-12)
    assert area["rug"] == pytest.approx(9.0, rel=1e-12)
    lit = [s.name for s in scene.surfaces if s.material.emission.any()]
    assert lit == ["lamp"]
