"""Factors to emitters: exact in full light, right in half shadow, and the rest of the row gives way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import ParameterError
from radiosity.form_factors import direct_light, monte_carlo
from radiosity.form_factors.contour import exchange_area_matrix
from radiosity.form_factors.direct_light import first_rays, worthwhile_emitters
from tests.truths import load, relative_error


def panel(name, x, z, height, material, up=True):
    """A rectangle x[0] … x[1], z[0] … z[1] at one height, its front up or down."""
    corners = np.array([[x[0], height, z[0]], [x[0], height, z[1]], [x[1], height, z[1]], [x[1], height, z[0]]])
    return rad.Surface(name, corners if up else corners[::-1], [[0, 1, 2, 3]], material)


def floor_and_lamp(*more, two_sided=False):
    grey, lamp = rad.Material(0.5), rad.Material(0.5, emission=2.0, two_sided=two_sided)
    floor = panel("floor", (0, 2), (0, 2), 0.0, grey)
    light = panel("lamp", (0.8, 1.3), (0.7, 1.3), 1.0, lamp, up=False)
    return rad.Scene([floor, light, *more])


def to_emitters(factors, patches):
    """Sum of each row over the columns of emitters, (N,)."""
    return factors.matrix @ (patches.emission[:, 0] > 0).astype(float)


def exact_to_emitters(patches):
    exchange = exchange_area_matrix(patches.corners)
    return exchange @ (patches.emission[:, 0] > 0) / patches.area


def test_in_full_light_the_factor_to_a_lamp_is_exact():
    """Whatever the seed and however few the rays; and the row closes."""
    patches = rad.subdivide(floor_and_lamp(), patch_count=150)
    assert (patches.emission[:, 0] > 0).sum() > 4
    for seed in (0, 1):
        factors = rad.form_factors(patches, rad.MonteCarlo(16, seed, light_rays=32), dtype=np.float64)
        assert to_emitters(factors, patches) == pytest.approx(exact_to_emitters(patches), rel=1e-10, abs=1e-15)
        assert factors.closure_defect == pytest.approx(np.zeros(len(patches)), abs=1e-14)
        assert (factors.exact_columns == (patches.emission[:, 0] > 0)).all()
    sampled = rad.form_factors(patches, rad.MonteCarlo(16, light_rays=0), dtype=np.float64)
    assert np.abs(to_emitters(sampled, patches) - exact_to_emitters(patches)).max() > 0.01
    assert sampled.exact_columns is None


def test_single_patches_of_a_lamp_are_right_on_average():
    """One polygon stands for the lamp; which of its patches gets what is sampled, without bias."""
    patches = rad.subdivide(floor_and_lamp(), patch_count=80)
    lamp = np.flatnonzero(patches.emission[:, 0])
    exact = (exchange_area_matrix(patches.corners) / patches.area[:, None])[:, lamp]
    runs = [rad.form_factors(patches, rad.MonteCarlo(16, seed, light_rays=64), dtype=np.float64) for seed in range(64)]
    found = np.array([run.matrix.toarray()[:, lamp] for run in runs])
    error = found.std(axis=0, ddof=1) / 8
    seen = exact > 0
    assert (found[:, ~seen] == 0).all()
    z = (found.mean(axis=0) - exact)[seen] / error[seen]
    assert np.abs(z).max() < 5 and np.mean(z**2) == pytest.approx(1.0, abs=0.3)


def test_a_large_emitter_keeps_what_sampling_rays_know_of_its_patches():
    """A luminous ceiling of 150 patches: sums over it are exact, single factors at least as good as counted ones."""
    room = rad.scenes.furnace(emission=0.0, size=2.0)
    glow = rad.Material(0.5, emission=1.0)
    surfaces = [replace(s, material=glow) if s.name == "ceiling" else s for s in room.surfaces]
    patches = rad.subdivide(rad.Scene(surfaces, closed=True), patch_count=900)
    lit = patches.emission[:, 0] > 0
    exact = (exchange_area_matrix(patches.corners) / patches.area[:, None])[:, lit]
    apart, plain = (
        rad.form_factors(patches, rad.MonteCarlo(512, light_rays=n), dtype=np.float64).matrix.toarray()[:, lit]
        for n in (256, 0)
    )
    assert apart.sum(axis=1) == pytest.approx(exact.sum(axis=1), rel=1e-9, abs=1e-15)
    errors = [np.linalg.norm(found - exact) / np.linalg.norm(exact) for found in (apart, plain)]
    assert errors[0] < 1.02 * errors[1]


def test_glowing_plates_under_a_sky_are_exact():
    """All of it emits; what goes to the sky gives way."""
    patches = rad.subdivide(rad.scenes.parallel_plates(), patch_count=200)
    patches = replace(patches, emission=np.ones_like(patches.emission))
    assert not patches.closed
    factors = rad.form_factors(patches, rad.MonteCarlo(64), dtype=np.float64)
    exact = exchange_area_matrix(patches.corners).sum(axis=1) / patches.area
    assert factors.to_sky == pytest.approx(1 - exact, abs=1e-9)


def test_both_sides_of_a_two_sided_lamp():
    ceiling = panel("ceiling", (0, 2), (0, 2), 1.5, rad.Material(0.5), up=False)
    patches = rad.subdivide(floor_and_lamp(ceiling, two_sided=True), patch_count=150)
    emitters = worthwhile_emitters(patches, 64, 256)
    assert emitters.side.tolist() == [-1, 1]
    factors = rad.form_factors(patches, rad.MonteCarlo(16, light_rays=32), dtype=np.float64)
    lit = exact_to_emitters(patches)  # the lamp's own rim hides nothing of the side that faces a patch
    assert to_emitters(factors, patches) == pytest.approx(lit, rel=1e-10, abs=1e-15)
    assert (lit[patches.surface == 2] > 0).all()


def under_a_plate(patch_size, rays=1 << 17):
    """A plate between floor and lamp: patches, their factors to the lamp by plain counting, and with no plate."""
    plate = panel("plate", (0.6, 1.2), (0.6, 1.4), 0.6, rad.Material(0.5, two_sided=True))
    patches = rad.subdivide(floor_and_lamp(plate), patch_size=patch_size)
    counted = rad.form_factors(patches, rad.MonteCarlo(rays, light_rays=0), dtype=np.float64)
    return patches, to_emitters(counted, patches), exact_to_emitters(patches)


def test_full_shadow_is_black_and_half_shadow_as_many_rays_say():
    patches, true, full = under_a_plate(0.2)
    found = to_emitters(rad.form_factors(patches, rad.MonteCarlo(64, light_rays=4096), dtype=np.float64), patches)
    floor = patches.surface == 0
    dark, half = floor & (true == 0), floor & (true > 0) & (true < 0.98 * full)
    assert dark.sum() >= 4 and half.sum() >= 20
    assert (found[dark] == 0).all()
    assert np.sqrt(np.mean((found - true)[half] ** 2) / np.mean(true[half] ** 2)) < 0.01
    assert (found - true)[half].mean() / true[half].mean() == pytest.approx(0.0, abs=0.003)


def relative_errors(truth, method, orders=6, seeds=(0,)):
    """Area-weighted relative L2 of the orders 1 … against the discrete truth: the mean square over seeds, rooted."""
    patches = truth.patches
    squares = np.zeros(orders)
    for seed in seeds:
        factors = rad.form_factors(patches, replace(method, seed=seed))
        found = rad.TransportOperator(factors, patches).orders(patches.emission, patches.sky, orders)
        squares += [relative_error(patches, found[k], truth.data["B_disc"][k]) ** 2 for k in range(1, orders + 1)]
    return np.sqrt(squares / len(seeds))


def test_cornell_order_by_order():
    """The goal at 4096 rays; the plain estimator misses it by far at order 1."""
    cornell = load("cornell")
    errors = relative_errors(cornell, rad.MonteCarlo(4096), seeds=(0, 1))
    assert errors[0] < 0.003 and errors[1] < 0.01
    assert (errors[2:] < 0.005).all()
    plain = relative_errors(cornell, rad.MonteCarlo(4096, light_rays=0))
    assert plain[0] > 0.03 and plain[1] > 0.011


def test_both_budgets_are_chosen_apart():
    """Shadow rays set the error of order 1, sampling rays that of the others."""
    cornell = load("cornell")
    few, many_shadow, many = (
        relative_errors(cornell, method, orders=3)
        for method in (rad.MonteCarlo(128), rad.MonteCarlo(128, light_rays=1024), rad.MonteCarlo(1024))
    )
    assert many[0] == few[0] and 0.1 < many_shadow[0] / few[0] < 0.5
    assert many_shadow[1] == pytest.approx(few[1], rel=0.05) and (many[1:] < 0.5 * few[1:]).all()


def test_only_emitters_columns_change_and_the_rest_keeps_its_proportions():
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=400)
    plain, apart = (rad.form_factors(patches, rad.MonteCarlo(256, light_rays=n), dtype=np.float64) for n in (0, 256))
    lamp = apart.exact_columns
    rest_plain, rest = plain.matrix.toarray()[:, ~lamp], apart.matrix.toarray()[:, ~lamp]
    scale = rest.sum(axis=1) / rest_plain.sum(axis=1)
    assert rest == pytest.approx(rest_plain * scale[:, None], rel=1e-12, abs=1e-15)
    assert apart.to_sky == pytest.approx(plain.to_sky * scale, rel=1e-12, abs=1e-15)
    assert apart.to_backs == pytest.approx(plain.to_backs * scale, rel=1e-12, abs=1e-15)
    assert np.abs(apart.closure_defect).max() < 1e-14
    assert 0.9 < scale.min() < 0.999 and 1.001 < scale.max() < 1.1


def test_factors_know_nothing_of_how_strong_the_light_is():
    """The same bits with the lamp dimmed; and a lamp that was not on in time is still right, as plain rays would be."""
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=400)
    dim = replace(patches, emission=1e-3 * patches.emission)
    first, second = (rad.form_factors(p, rad.MonteCarlo(64)) for p in (patches, dim))
    assert (first.matrix != second.matrix).nnz == 0
    other = np.zeros_like(patches.emission)
    other[patches.surface == patches.surface_names.index("red_wall")] = 1.0
    plain, apart, reference = (
        rad.TransportOperator(rad.form_factors(patches, method), patches).orders(other, count=2)
        for method in (rad.MonteCarlo(256, light_rays=0), rad.MonteCarlo(256), rad.MonteCarlo(1 << 14, 5, light_rays=0))
    )
    for order in (1, 2):
        errors = [relative_error(patches, found[order], reference[order]) for found in (plain, apart)]
        assert errors[1] < 1.1 * errors[0]


def test_without_light_rays_rows_are_plain_counts():
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=300)
    for method in (rad.MonteCarlo(64, light_rays=0), rad.MonteCarlo(64, sampling="random")):
        factors = rad.form_factors(patches, method)
        hits = 64 * factors.matrix.data
        assert (hits == np.rint(hits)).all()
        assert factors.statistics["rays/to emitters"] == 0
        assert (factors.closure_defect == 0).all()


@pytest.mark.parametrize("scene", ["furnace", "many"])
def test_emitters_that_are_all_there_is_or_many_are_left_to_the_rays(scene):
    if scene == "furnace":
        patches = rad.subdivide(rad.scenes.furnace(), patch_count=150)
    else:
        spots = [
            panel(f"spot {k}", (k / 20, k / 20 + 0.01), (0, 0.01), 1.0, rad.Material(0.5, emission=1.0), up=False)
            for k in range(20)
        ]
        patches = rad.subdivide(floor_and_lamp(*spots), patch_size=0.2)
        assert worthwhile_emitters(patches, rays=168, light_rays=64) is not None  # 21 × (16 + 16) / 4
        assert worthwhile_emitters(patches, rays=167, light_rays=64) is None
    plain, same = (rad.form_factors(patches, rad.MonteCarlo(64, light_rays=n)) for n in (0, 64))
    assert (plain.matrix != same.matrix).nnz == 0
    assert same.exact_columns is None


def test_random_numbers_serve_too():
    """Independent shadow rays: the same mean, more noise."""
    cornell = load("cornell")
    sobol, random = (relative_errors(cornell, rad.MonteCarlo(64, 0, s, light_rays=256), 1) for s in ("sobol", "random"))
    assert sobol[0] < random[0] < 0.02


def test_the_same_bits_for_any_threads_and_batches(monkeypatch):
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=500)
    method = rad.MonteCarlo(96, 3, replicates=2)
    first = rad.form_factors(patches, method, threads=1)
    for threads, batch in ((2, 1 << 16), (2, 500), (4, 5_000)):
        monkeypatch.setattr(monte_carlo, "BATCH", batch)
        again = rad.form_factors(patches, method, threads=threads)
        assert (again.matrix.indices == first.matrix.indices).all()
        assert (again.matrix.data == first.matrix.data).all()
        assert (again.to_sky == first.to_sky).all()
        assert again.statistics["rays/to emitters"] == first.statistics["rays/to emitters"] > 0


def test_replicates_agree_where_nothing_is_in_the_way():
    patches = rad.subdivide(floor_and_lamp(), patch_count=150)
    factors = rad.form_factors(patches, rad.MonteCarlo(64, replicates=4), dtype=np.float64)
    runs = np.array([to_emitters(run, patches) for run in factors.replicates])
    assert runs.std(axis=0).max() < 1e-15
    assert (factors.exact_columns == (patches.emission[:, 0] > 0)).all()


def merged_slowly(counts, rays, exact, entries):
    """The readable twin of `_merge`, on dense rows with the sky and the backs in the last two columns."""
    out = np.empty(counts.shape)
    for row, count, new in zip(out, counts, entries, strict=True):
        others = rays - count[:-2][exact].sum()
        if others == 0 or new.sum() >= 1:
            row[:] = count / rays
        else:
            row[:] = count * (1 - new.sum()) / others
            row[:-2][exact] = new[exact]
    return out


def test_the_kernel_that_merges_and_its_readable_twin_agree():
    """With rows that see nothing but emitters, whole rows of sky, and more exact light than there is room for."""
    rng = np.random.default_rng(1)
    rows, count, rays = 40, 12, 64
    exact = rng.random(count) < 0.4
    counts = rng.multinomial(rays, rng.dirichlet(np.full(count + 2, 0.3)), rows)
    counts[0], counts[1] = 0, 0
    counts[0, np.flatnonzero(exact)[0]] = rays
    counts[1, -2] = rays
    entries = np.where(exact & (rng.random((rows, count)) < 0.5), rng.random((rows, count)), 0.0) / 4
    entries[2, exact] = 0.9
    (row, column), (new_row, new_column) = np.nonzero(counts[:, :count]), np.nonzero(entries)
    merged = direct_light._merge(
        np.bincount(row, minlength=rows), column.astype(np.int32), counts[row, column].astype(np.int32),
        counts[:, -2], counts[:, -1], rays, exact,
        np.bincount(new_row, minlength=rows), new_column.astype(np.int32), entries[new_row, new_column],
    )  # fmt: skip
    lengths, indices, weights, sky, backs = merged
    found = np.zeros((rows, count + 2))
    found[np.repeat(np.arange(rows), lengths), indices] = weights
    found[:, -2], found[:, -1] = sky, backs
    expected = merged_slowly(counts, rays, exact, entries)
    assert found == pytest.approx(expected, rel=1e-13, abs=1e-16)
    assert expected.sum(axis=1) == pytest.approx(np.ones(rows), rel=1e-13)
    assert all((np.diff(part) > 0).all() for part in np.split(indices, np.cumsum(lengths)[:-1]))


@pytest.mark.parametrize(("inside", "least", "most"), [(direct_light.CORNER, 1.0, 1.1), (1, 8.0, 9.0)])
def test_lamps_of_many_faces_side_by_side_hide_nothing_from_each_other(monkeypatch, inside, least, most):
    """In a sphere all see all: the first rays are enough. At the very corners they meet neighbours (a control)."""
    monkeypatch.setattr(direct_light, "CORNER", inside)
    patches = rad.subdivide(rad.scenes.integrating_sphere())
    emitters = int((patches.emission > 0).any(axis=1).sum())
    factors = rad.form_factors(patches, rad.MonteCarlo(512, light_rays=256))
    of_first = emitters * (len(patches) - 1) * (first_rays(256) + direct_light.CORNER_RAYS)
    assert least <= factors.statistics["rays/to emitters"] / of_first < most


@pytest.mark.parametrize(
    ("kwargs", "message"),
    [({"light_rays": -1}, "light_rays is -1"), ({"rays": 64, "light_rays": 10, "replicates": 4}, "multiple")],
)
def test_light_rays_that_make_no_estimate(kwargs, message):
    with pytest.raises(ParameterError, match=message):
        rad.MonteCarlo(**kwargs)


def test_the_default_balances_direct_and_indirect_light():
    budgets = {(64, 1): 256, (1024, 1): 256, (4096, 1): 1024, (16384, 1): 4096, (300, 3): 384, (2048, 16): 512}
    assert {key: rad.MonteCarlo(key[0], replicates=key[1]).light_rays for key in budgets} == budgets
    assert rad.MonteCarlo(4096, sampling="random").light_rays == 0


def test_sixteen_are_sent_first_or_a_sixteenth():
    assert [first_rays(n) for n in (8, 64, 256, 1024)] == [8, 16, 16, 64]


def nothing_hides(ground, pairs, met):
    """Every shadow ray reaches some patch of its emitter."""
    first = np.array([np.flatnonzero((ground.face == f) & (ground.side == s))[0]
                      for f, s in zip(ground.emitter_face, ground.emitter_side, strict=True)])  # fmt: skip
    met[:] = first[pairs[:, 1]][:, None]


def never_in_doubt(met, weight):  # noqa: ARG001
    return np.zeros(len(met), dtype=bool)


@pytest.mark.parametrize(
    ("name", "broken", "least"),
    [("_only_emitters", nothing_hides, 0.05), ("_disagree", never_in_doubt, 0.008), ("CORNER_RAYS", 1, 0.0028)],
)
def test_a_broken_kernel_is_noticed(monkeypatch, name, broken, least):
    """No shadows; half shadows never looked at twice; shadows' edges missed between the first few rays."""
    cornell = load("cornell")
    assert relative_errors(cornell, rad.MonteCarlo(64), orders=1)[0] < 0.002
    monkeypatch.setattr(direct_light, name, broken)
    assert relative_errors(cornell, rad.MonteCarlo(64), orders=1)[0] > least


def test_visibility_counts_where_the_light_comes_from(monkeypatch):
    """Negative control: rays of a large patch that count alike, near and far. The one big floor patch is 2 × 2 m."""
    patches, true, _ = under_a_plate(2.0, rays=1 << 20)
    method = rad.MonteCarlo(256, light_rays=1 << 14)
    found = to_emitters(rad.form_factors(patches, method, dtype=np.float64), patches)
    assert found[0] == pytest.approx(true[0], rel=0.01)
    weighted = direct_light._shadow_rays

    def all_alike(*args):
        weighted(*args)
        args[-1][args[-1] > 0] = 1.0

    monkeypatch.setattr(direct_light, "_shadow_rays", all_alike)
    found = to_emitters(rad.form_factors(patches, method, dtype=np.float64), patches)
    assert abs(found[0] / true[0] - 1) > 0.1
