"""Two levels: the light of the plain factors, order by order, from far fewer numbers."""

import sys
from dataclasses import replace

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import MemoryLimitError, ParameterError
from radiosity.form_factors import level_rows
from radiosity.form_factors.groups import group_patches
from radiosity.form_factors.levels import TwoLevelFactors
from radiosity.solvers.admission import connected_components
from tests.truths import relative_error

COARSE = rad.TwoLevel(rays=512, group_rays=2048, light_rays=256, group=2)


def orders(patches, estimator, count=4):
    T = rad.TransportOperator(rad.form_factors(patches, estimator), patches)
    return T.orders(patches.emission, patches.sky, count)


def errors(patches, found, true):
    return np.array([relative_error(patches, x, y) for x, y in zip(found[1:], true[1:], strict=True)])


@pytest.fixture(scope="module")
def cornell():
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=4000)
    return patches, rad.form_factors(patches, COARSE), orders(patches, rad.MonteCarlo(2048, 11))


@pytest.fixture(scope="module")
def small():
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=1200)
    return patches, rad.form_factors(patches, rad.TwoLevel(rays=32, group_rays=64, group=3))


def test_orders_of_the_cornell_box(cornell):
    """Blocks on the floor, an open front, a lamp: against sixteen times the rays on every patch."""
    patches, factors, true = cornell
    found = rad.TransportOperator(factors, patches).orders(patches.emission, patches.sky, 4)
    wrong = errors(patches, found, true)
    assert wrong[0] < 0.005
    assert wrong[1:].max() < 0.03
    assert factors.statistics["levels/groups"] > 100
    assert factors.statistics["levels/corners"] + factors.statistics["levels/patches alone"] < 0.75 * len(patches)


def test_rows_close_and_are_no_less_than_nothing(cornell):
    _, factors, _ = cornell
    assert np.abs(factors.closure_defect).max() < 5e-7
    for matrix in factors.levels.matrices:
        assert matrix.data.min() >= 0.0
    assert factors.to_sky.min() >= 0.0
    assert factors.to_sky.max() > 0.3  # near the open front


def test_every_way_to_read_the_factors_says_the_same(small):
    patches, factors = small
    plain = factors.assembled()
    light = np.random.default_rng(0).random((len(patches), 2))
    assert factors.gather(light) == pytest.approx(plain.gather(light), rel=1e-12)
    assert factors.scatter(light) == pytest.approx(plain.matrix.T @ light, rel=1e-9)
    for i in (0, 600, len(patches) - 1):
        assert factors.row(i) == pytest.approx(plain.row(i), abs=1e-15)
    assert factors.net_exchange(light, light[::-1]) == pytest.approx(
        plain.closure_defect[:, None] * 0
        + plain.matrix.sum(axis=1)[:, None] * light
        - plain.gather(light - light[::-1])
    )
    table, expected = factors.between_surfaces(), plain.between_surfaces()
    assert table.matrix == pytest.approx(expected.matrix, rel=1e-9, abs=1e-15)
    assert table.row_sums == pytest.approx(np.ones(len(table)), abs=1e-6)
    assert factors.reciprocity_defect == pytest.approx(plain.reciprocity_defect, rel=0.2)


def test_a_matrix_of_many_patches_is_refused_with_its_bytes(small, monkeypatch):
    _, factors = small
    monkeypatch.setattr(sys.modules[TwoLevelFactors.__module__], "MOST_MATRIX_BYTES", 1000)
    with pytest.raises(MemoryLimitError, match=r"1,\d\d\d patches on two levels take 0\.01\d* GB .*row\(i\)"):
        _ = factors.matrix


@pytest.fixture(scope="module")
def corridor():
    patches = rad.subdivide(rad.scenes.corridor(), patch_count=12_000)
    return patches, orders(patches, rad.MonteCarlo(2048, 9), 2)[2]


def worst_in_a_group(patches, true):
    """Of the light of order 2, over its mean: beside door jambs, some of which end at the corner of a group."""
    factors = rad.form_factors(patches, rad.TwoLevel(group=4))
    inside = factors.levels.smooth[group_patches(patches, factors.levels.side).of_patch]
    found = rad.TransportOperator(factors, patches).orders(patches.emission, count=2)[2]
    return (np.abs(found - true)[inside] / patches.reflectance[inside]).max() / (true / patches.reflectance).mean()


def test_a_wall_that_ends_at_the_corner_of_a_group(corridor):
    assert worst_in_a_group(*corridor) < 0.2


def test_corners_that_nobody_looked_from_see_into_a_wall(corridor, monkeypatch):
    """Negative control: light of a whole group would be spread from a corner that sees what is near."""
    monkeypatch.setattr(level_rows, "CORNER_SHARE", 1.0)
    assert worst_in_a_group(*corridor) > 0.3


def test_furnace_by_order():
    """Every order is known: all walls emit, and each keeps half."""
    patches = rad.subdivide(rad.scenes.furnace(), patch_count=2400)
    found = orders(patches, rad.TwoLevel(rays=32, group_rays=64, group=4))
    for k, order in enumerate(found):
        assert order == pytest.approx(np.full_like(order, 0.5**k), rel=1e-6)


def test_a_floor_under_the_sky_by_order():
    """No emitter at all: what the sky brings, and what floor and wall pass to each other."""
    patches = rad.subdivide(rad.scenes.open_rug(), patch_count=2000)
    method = rad.TwoLevel(rays=512, group_rays=4096, group=4)
    wrong = errors(patches, orders(patches, method), orders(patches, rad.MonteCarlo(4096, 3)))
    assert wrong[0] < 0.005
    assert wrong[1:].max() < 0.02


def test_a_ball_under_an_even_sky_leaves_that_times_its_reflectance():
    """Convex, all of it sees the sky alone: one order, known exactly, on triangles of sixteen patches each."""
    scene = rad.scenes.uniform_dome(reflectance=0.5, sky=2.0)
    patches = rad.subdivide(scene, patch_count=16 * 320)
    found = orders(patches, rad.TwoLevel(rays=16, group_rays=64, group=4), 2)
    assert found[1] == pytest.approx(np.full((len(patches), 1), np.pi * 0.5 * 2.0), rel=1e-6)
    assert found[2] == pytest.approx(np.zeros((len(patches), 1)), abs=1e-9)


def partitioned():
    """A closed room, one floor for both halves, a thin wall between them, a lamp in the left one."""
    white, lamp = rad.Material(0.7), rad.Material(0.7, emission=5.0)
    corners = np.array([[x, y, z] for x in (0, 4) for y in (0, 2) for z in (0, 2)], float)
    walls = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    inward = [face[::-1] for face in walls]
    middle = np.array([[1.5, 0, 0], [1.5, 2, 0], [1.5, 2, 2], [1.5, 0, 2]], float)
    light = np.array([[0.5, 1.9, 0.5], [1.0, 1.9, 0.5], [1.0, 1.9, 1.0], [0.5, 1.9, 1.0]], float)
    return rad.Scene(
        [
            rad.Surface("room", corners, inward, white),
            rad.Surface("partition", middle, [[0, 1, 2, 3]], rad.Material(0.7, two_sided=True)),
            rad.Surface("lamp", light, [[0, 1, 2, 3]], lamp),
        ],
        closed=True,
    )


def behind_the_wall():
    """Light behind the wall and before it; patches end at the wall, groups do not."""
    patches = rad.subdivide(partitioned(), patch_size=0.125)
    factors = rad.form_factors(patches, rad.TwoLevel(rays=32, group_rays=128, group=3))
    assert factors.statistics["levels/groups"] > 50
    light = rad.TransportOperator(factors, patches).orders(patches.emission, count=6).sum(axis=0)
    dark = (patches.centroid[:, 0] > 1.5 + 1e-6) | ((patches.surface == 1) & (patches.normal[:, 0] > 0))
    label = connected_components(factors)
    return light[dark], light[~dark], np.isin(label[dark], label[~dark])


def test_no_light_goes_through_a_wall_that_stands_on_a_group():
    dark, lit, joined = behind_the_wall()
    assert dark.max() == 0.0
    assert lit.mean() > 0.1
    assert not joined.any()


def test_groups_kept_under_a_wall_let_light_through(monkeypatch):
    """Negative control: what the survey is for."""
    for share in ("NEAR_SHARE", "CORNER_SHARE"):
        monkeypatch.setattr(level_rows, share, 1.0)
    monkeypatch.setattr(level_rows.Work, "_whole", lambda *given: np.ones(len(given[1]), dtype=bool))
    dark, lit, joined = behind_the_wall()
    assert dark.mean() > 0.05 * np.median(lit)
    assert joined.all()


def test_new_light_on_the_same_factors(cornell):
    """A block that begins to shine: straight paths from it are sought, and the first order is as right as before."""
    patches, factors, _ = cornell
    emission = np.where(patches.surface_names.index("short_block") == patches.surface, 1.0, 0.0)[:, None] * np.ones(3)
    lit = replace(patches, emission=emission)
    true = orders(lit, rad.MonteCarlo(1024, 11), 2)
    found = {
        name: errors(lit, rad.TransportOperator(one, lit).orders(emission, lit.sky, 2), true)
        for name, one in (("as they are", factors), ("lit by", factors.lit_by(lit)))
    }
    assert found["lit by"][0] < 0.01
    assert found["lit by"][1] < 0.03
    assert found["as they are"][0] > 2 * found["lit by"][0]
    assert factors.lit_by(patches) is factors
    both = factors.lit_by(lit)
    assert (both.exact_columns == (patches.emission.any(axis=1) | emission.any(axis=1))).all()


def test_same_bits_for_any_number_of_threads():
    patches = rad.subdivide(rad.scenes.cluttered_room(4), patch_count=2000)
    one, two, other = (
        rad.form_factors(patches, rad.TwoLevel(rays=16, group_rays=64, seed=seed, group=3), threads=threads)
        for seed, threads in ((5, 1), (5, 3), (6, 1))
    )
    for a, b in zip(one.levels.matrices, two.levels.matrices, strict=True):
        assert a.data.tobytes() == b.data.tobytes()
        assert a.indices.tobytes() == b.indices.tobytes()
    assert one.to_sky.tobytes() == two.to_sky.tobytes()
    assert one.levels.exchange.data.tobytes() != other.levels.exchange.data.tobytes()


def test_the_whole_way(tmp_path):
    """Solved, certified, written, read, relit: as with plain factors."""
    solution = rad.solve(rad.scenes.cornell_box(), patch_count=1500, estimator=rad.TwoLevel(64, 256, group=3))
    assert solution.converged
    assert solution.certificate.algebraic < 1e-4
    assert "TwoLevel" in str(solution)
    solution.save(tmp_path / "levels.npz")
    again = rad.read_solution(tmp_path / "levels.npz")
    light = np.random.default_rng(0).random((len(again.patches), 3))
    assert (again.factors.gather(light) == solution.factors.gather(light)).all()
    assert again.factors.estimator == solution.factors.estimator
    assert again.certificate.sampling == solution.certificate.sampling > 0.005
    relit = [one.relight(emission={"lamp": 0.0, "tall_block": 1.0}).radiosity for one in (solution, again)]
    assert (relit[0] == relit[1]).all()
    assert relit[0].max() > 0.0


def test_a_picture_of_the_operator_without_its_matrix(small):
    from radiosity.viewer.inspect import MatrixView

    patches, factors = small
    names = patches.surface_names
    views = [
        MatrixView.of_operator(rad.TransportOperator(one, patches), 0, patches.surface, names)
        for one in (factors, factors.assembled())
    ]
    assert views[0].means == pytest.approx(views[1].means, rel=1e-9, abs=1e-15)


def test_what_is_refused():
    for wrong in ({"rays": 0}, {"group_rays": 0}, {"light_rays": 0}, {"group": 1}, {"seed": -1}):
        with pytest.raises(ParameterError):
            rad.TwoLevel(**wrong)
    ball = rad.scenes.lit_sphere()
    shining = replace(
        ball, surfaces=tuple(replace(s, material=s.material.replace(emission=1.0)) for s in ball.surfaces)
    )
    with pytest.raises(ParameterError, match=r"faces emit, .*Use MonteCarlo"):
        rad.form_factors(rad.subdivide(shining), rad.TwoLevel())
