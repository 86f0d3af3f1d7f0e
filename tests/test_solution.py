"""What a solution says about its light: balances, points, other lamps."""

from dataclasses import replace

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import FileFormatError, MaterialError, ParameterError

FLOOR = [[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]]  # faces up, y


def small(scene, **settings):
    return rad.solve(scene, **{"patch_count": 300, "estimator": rad.MonteCarlo(rays=256), **settings})


@pytest.fixture(scope="module")
def rug():
    return small(rad.scenes.red_rug())


@pytest.fixture(scope="module")
def box():
    return small(rad.scenes.cornell_box(), patch_count=600)


def one_plate(radiance, reflectance=0.4):
    """A plate that sees nothing but the sky."""
    surface = rad.Surface("plate", FLOOR, [[0, 1, 2, 3]], rad.Material(reflectance))
    return small(rad.Scene([surface], sky=radiance), patch_count=4)


def test_radiosity_is_emission_and_what_is_reflected(box):
    """B = E + ρ H: the equation, from the outside."""
    again = box.emission + box.patches.reflectance * box.irradiance
    error = np.abs(again - box.radiosity).max() / box.radiosity.max()
    assert error < 1e-5  # the solver's tolerance
    np.testing.assert_array_equal(box.radiance, box.radiosity / np.pi)


def test_net_flux_is_emitted_less_absorbed(box):
    emitted = box.patches.area[:, None] * box.emission
    np.testing.assert_allclose(box.net_flux, emitted - box.absorbed, atol=1e-6 * emitted.max())


def test_orders_add_up(box):
    np.testing.assert_allclose(box.orders.sum(axis=0), box.radiosity, rtol=1e-12)
    np.testing.assert_allclose(box.power.sum(axis=0), box.patches.area @ box.radiosity, rtol=1e-12)
    np.testing.assert_allclose(box.power[0], box.patches.area @ box.emission, rtol=1e-12)


def test_a_furnace_absorbs_what_it_emits():
    solution = small(rad.scenes.furnace(reflectance=0.7, emission=2.0, size=3.0), dtype=np.float64)
    balance = solution.balance
    np.testing.assert_allclose(balance.emitted, [6 * 9.0 * 2.0], rtol=1e-12)
    np.testing.assert_allclose(balance.absorbed, balance.emitted, rtol=2e-6)
    np.testing.assert_array_equal(balance.to_sky, [0.0])
    np.testing.assert_array_equal(balance.from_sky, [0.0])
    assert abs(balance.defect) < 2e-6


def test_a_plate_under_the_sky():
    solution = one_plate([1.0, 2.0])
    np.testing.assert_allclose(solution.irradiance, np.tile(np.pi * np.array([1.0, 2.0]), (4, 1)), rtol=1e-12)
    balance = solution.balance
    np.testing.assert_allclose(balance.from_sky, np.pi * np.array([1.0, 2.0]), rtol=1e-12)
    np.testing.assert_allclose(balance.absorbed, 0.6 * balance.from_sky, rtol=1e-12)
    np.testing.assert_allclose(balance.to_sky, 0.4 * balance.from_sky, rtol=1e-12)
    assert abs(balance.defect) < 1e-12


def test_light_on_black_backs_is_counted():
    """A lamp under a plate whose back is black: what the plate takes is in to_backs, the rest escapes."""
    lamp = rad.Surface("lamp", FLOOR, [[0, 1, 2, 3]], rad.Material(0.0, emission=1.0))
    lid = rad.Surface("lid", np.array(FLOOR) + [0, 1, 0], [[0, 1, 2, 3]], rad.Material(0.9))
    solution = small(rad.Scene([lamp, lid]), estimator=rad.MonteCarlo(rays=1024))
    share = 0.199824895698387  # parallel unit squares at distance 1
    assert solution.balance.to_backs[0] == pytest.approx(share, rel=0.01)
    assert solution.balance.to_sky[0] == pytest.approx(1 - share, rel=0.01)
    assert solution.balance.absorbed[0] == 0.0
    assert abs(solution.balance.defect) < 1e-12


def test_energy_defect_of_raw_factors_is_small_and_told(box):
    assert 0 < abs(box.balance.defect) < 0.01
    assert box.certificate.energy_defect == pytest.approx(box.balance.defect, rel=1e-4)
    assert f"defect {box.certificate.energy_defect:.2g} ±" in str(box)


def test_the_story_is_told_in_a_few_lines(box):
    lines = str(box).splitlines()
    assert len(lines) == 9
    assert lines[0].startswith("cornell_box: ")
    assert "8 surfaces, open, 3 channels" in lines[0]
    assert f"{box.factors.matrix.nnz:,} non-zeros" in lines[1]
    assert f"0: {box.power[0].sum():.4g}, 1: {box.power[1].sum():.4g}" in lines[2]
    assert all(stage in lines[3] for stage in ("patches", "ray tree", "form factors", "solve"))
    assert lines[4] == box.status
    assert "\n".join(lines[5:]) == str(box.certificate)
    assert lines[5].startswith("uncertified to 1 %: algebra within ")


# Relighting


def test_relighting_with_the_same_light_gives_the_same_bits(rug):
    again = rug.relight(emission=rug.emission, reflectance=rug.patches.reflectance, sky=rug.sky)
    assert again.orders.tobytes() == rug.orders.tobytes()
    assert again.factors is rug.factors


def test_lamps_add_up(rug):
    """Light is linear: two lamps together are the sum of each by itself."""
    off = {"lamp": np.zeros(3)}
    red, white = {"lamp": [30.0, 0.0, 0.0]}, {"rug": [1.0, 1.0, 1.0]}
    apart = [rug.relight(emission={**off, **light}).radiosity for light in (red, white)]
    together = rug.relight(emission={**red, **white}).radiosity
    np.testing.assert_allclose(together, sum(apart), rtol=1e-4, atol=1e-6 * together.max())


def test_by_name_of_surface_or_material_or_by_patch(rug):
    by_surface = rug.relight(emission={"lamp": [5.0, 4.0, 3.0]}, reflectance={"rug": [0.1, 0.1, 0.9]})
    patches = rug.patches
    lamp, carpet = (patches.surface == patches.surface_names.index(name) for name in ("lamp", "rug"))
    by_patch = rug.relight(
        emission=np.where(lamp[:, None], [5.0, 4.0, 3.0], patches.emission),
        reflectance=np.where(carpet[:, None], [0.1, 0.1, 0.9], patches.reflectance),
    )
    assert by_surface.radiosity.tobytes() == by_patch.radiosity.tobytes()
    assert by_surface.scene.surfaces[-1].material.emission.tolist() == [5.0, 4.0, 3.0]
    assert by_patch.scene.surfaces[-1].material.emission.tolist() == rug.scene.surfaces[-1].material.emission.tolist()

    white = rug.relight(reflectance={"white": 0.3})  # the material of walls and ceiling
    walls = np.isin(patches.surface, [patches.surface_names.index(n) for n in ("ceiling", "back_wall", "left_wall")])
    assert (white.patches.reflectance[walls] == 0.3).all()
    assert (white.patches.reflectance[carpet] == patches.reflectance[carpet]).all()


def test_a_furnace_repainted():
    furnace = small(rad.scenes.furnace(reflectance=0.5, emission=1.0))
    repainted = furnace.relight(reflectance=np.full(len(furnace.patches), 0.8))
    np.testing.assert_allclose(repainted.radiosity, 5.0, rtol=1e-5)
    np.testing.assert_allclose(repainted.patches.absorptance, 0.2, rtol=1e-15)


def test_absorptance_given_survives_relighting():
    furnace = small(rad.scenes.furnace(absorptance=1e-3, emission=1.0), bounces=2)
    relit = furnace.relight(emission={"floor": 7.0})
    material = relit.scene.surfaces[0].material
    assert (material.given, material.absorptance.tolist()) == ("absorptance", [1e-3])
    assert relit.patches.absorptance is furnace.patches.absorptance
    assert relit.bounces == 2
    assert len(relit.orders) == 3


def test_a_sky_comes_through_the_open_front(box):
    lit = box.relight(emission={"lamp": 0.0}, sky=[1.0, 1.0, 1.0])
    assert not lit.orders[0].any()
    assert (lit.balance.from_sky > 0).all()
    assert lit.scene.sky.tolist() == [1.0, 1.0, 1.0]
    np.testing.assert_allclose(lit.orders[1], box.patches.reflectance * np.pi * box.factors.to_sky[:, None], rtol=1e-12)


def test_what_cannot_be_relit_is_refused(rug):
    with pytest.raises(ParameterError, match=r"emission: no surface or material is named 'lampe'; there are .*'lamp'"):
        rug.relight(emission={"lampe": 1.0})
    with pytest.raises(MaterialError, match=r"surface 'rug'.*1\.5 in channel 1"):
        rug.relight(reflectance={"rug": [0.1, 1.5, 0.1]})
    with pytest.raises(MaterialError, match=rf"shape \(3,\); give \({len(rug.patches)}, 3\)"):
        rug.relight(emission=[1.0, 1.0, 1.0])
    bad = rug.emission.copy()
    bad[7, 2] = -1.0
    with pytest.raises(MaterialError, match="emission -1 of patch 7, channel 2, is negative"):
        rug.relight(emission=bad)


# Points


def test_any_point_of_a_furnace_is_lit_alike():
    furnace = small(rad.scenes.furnace(reflectance=0.5, emission=1.0))
    points = np.random.default_rng(1).uniform(0.05, 0.95, (20, 3))
    normals = np.random.default_rng(2).normal(size=(20, 3))
    np.testing.assert_allclose(furnace.irradiance_at(points, normals), 2.0, rtol=1e-5)


def test_points_on_patches_agree_with_the_patches(rug):
    """Where light is smooth, that at the middle of a patch is near the patch's mean."""
    shining = {name: [1.0, 0.5, 0.1] for name in ("ceiling", "left_wall", "rug")}
    smooth = rug.relight(emission={"lamp": 0.0, **shining})
    wall = rug.patches.surface == rug.patches.surface_names.index("back_wall")
    found = smooth.irradiance_at(rug.patches.centroid[wall], rug.patches.normal[wall], rays=4096)
    expected = smooth.irradiance[wall]
    assert found.shape == expected.shape
    error = np.sqrt(((found - expected) ** 2).sum() / (expected**2).sum())
    assert 0 < error < 0.03  # the patches' own sampling error, with 256 rays
    assert found.sum() == pytest.approx(expected.sum(), rel=0.01)


def test_a_point_sees_a_parallel_square_as_the_closed_form_says():
    """Lamp 1 × 1 m, 1 m above the point below its middle: F = 4 × that of a quarter, Howell's B-3."""
    lamp = rad.Surface("lamp", np.array(FLOOR) + [0, 1, 0], [[3, 2, 1, 0]], rad.Material(0.0, emission=10.0))
    solution = small(rad.Scene([lamp]))
    half = 0.5
    root = np.sqrt(1 + half**2)
    exact = 10.0 * 4 * (2 * half / root * np.arctan(half / root)) / (2 * np.pi)
    found = solution.irradiance_at([0.5, 0.0, 0.5], [0, 3.0, 0], rays=1 << 14)
    assert found.shape == (1, 1)
    assert found[0, 0] == pytest.approx(exact, rel=5e-3)
    # From behind only its black back is seen, and beside it the black sky.
    assert solution.irradiance_at([0.5, 2.0, 0.5], [0, -1, 0])[0, 0] == 0.0


def test_a_point_under_the_sky():
    solution = one_plate([1.0, 2.0])
    np.testing.assert_allclose(solution.irradiance_at([0.3, 0.0, 0.3], [0, 1, 0]), np.pi * np.array([[1.0, 2.0]]))


def test_points_have_the_same_bits_for_any_threads_and_company(box):
    points = box.patches.centroid[::7] + 0.01 * box.patches.normal[::7]
    normals = box.patches.normal[::7]
    one, two = (box.irradiance_at(points, normals, rays=512, threads=threads) for threads in (1, 2))
    assert one.tobytes() == two.tobytes()
    assert not np.array_equal(one, box.irradiance_at(points, normals, rays=512, seed=1))


@pytest.mark.parametrize(
    ("points", "normals", "words"),
    [
        ([[0, 0]], [0, 1, 0], r"shape \(1, 2\)"),
        (np.zeros((2, 3)), np.ones((3, 3)), r"normals \(3, 3\)"),
        ([[0, np.nan, 0]], [0, 1, 0], "point 0"),
        ([[0, 0, 0]], [0, 0, 0], "normals with a length"),
    ],
)
def test_points_that_are_none_are_refused(rug, points, normals, words):
    with pytest.raises(ParameterError, match=words):
        rug.irradiance_at(points, normals)


# Files


def test_an_unknown_suffix_names_those_that_there_are(rug, tmp_path):
    with pytest.raises(FileFormatError, match=r"as '\.docx'; choose from \.npz, \.vtp, \.html, \.glb, \.png"):
        rug.save(tmp_path / "rug.docx")
    with pytest.raises(FileFormatError, match="exposure: only pictures and pages have settings"):
        rug.save(tmp_path / "rug.npz", exposure=1.0)
    assert list(tmp_path.iterdir()) == []
    rug.save(tmp_path / "rug.html", title="A rug")
    assert "A rug" in (tmp_path / "rug.html").read_text(encoding="utf-8")


def test_other_solvers_may_have_no_orders(rug):
    solution = replace(rug, result=replace(rug.result, orders=None))
    assert solution.orders is None
    assert solution.power is None
    assert "by bounce" not in str(solution)
