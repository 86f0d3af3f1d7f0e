"""The wrong operators are wrong in the way they say, and no way else."""

import dataclasses

import numpy as np
import pytest

import radiosity as rad
from radiosity import shortcuts
from radiosity.errors import FormFactorError, ParameterError
from radiosity.shortcuts import Ambient, AmbientOcclusion, CutAt, DirectOnly, NoCosine, NoVisibility
from tests.form_factors.test_surfaces import OPPOSITE
from tests.truths import relative_error


def furnace(rho, rays=256):
    """Patches of a furnace with E = 1, and their form factors."""
    patches = rad.subdivide(rad.scenes.furnace(reflectance=rho), patch_count=96)
    return patches, rad.form_factors(patches, rad.MonteCarlo(rays), dtype=np.float64)


@pytest.fixture(scope="module")
def cornell():
    """Patches, factors and the truth of the Cornell box."""
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=600)
    factors = rad.form_factors(patches, rad.MonteCarlo(512))
    result = rad.Neumann(rtol=1e-7).solve(rad.TransportOperator(factors, patches), patches.emission)
    return patches, factors, result.radiosity


# In a furnace


@pytest.mark.parametrize("rho", [0.2, 0.7])
def test_direct_only_in_a_furnace(rho):
    patches, factors = furnace(rho)
    found = DirectOnly().radiosity(patches, factors)
    assert found == pytest.approx(np.full((96, 1), 1 + rho), rel=1e-12)


@pytest.mark.parametrize("k", [0, 1, 5])
def test_a_cut_series_in_a_furnace(k):
    patches, factors = furnace(0.7)
    found = CutAt(k).radiosity(patches, factors)
    assert found == pytest.approx(np.full((96, 1), (1 - 0.7 ** (k + 1)) / 0.3), rel=1e-12)


def test_a_constant_ambient_is_right_in_a_furnace_and_nowhere_else():
    patches, factors = furnace(0.7)
    assert Ambient().radiosity(patches, factors) == pytest.approx(np.full((96, 1), 1 / 0.3), rel=1e-5)


def test_without_the_cosine_rows_sum_to_two():
    patches, _ = furnace(0.7)
    wrong = NoCosine(bounces=3).exchange(patches)
    assert wrong.row_sums == pytest.approx(np.full(96, 2.0), abs=1e-12)
    orders = wrong.orders(patches, 3)
    assert orders[:, 0, 0] == pytest.approx([1.0, 1.4, 1.96, 2.744], rel=1e-12)
    assert NoCosine(bounces=3).radiosity(patches, None) == pytest.approx(np.full((96, 1), 7.104), rel=1e-12)


@pytest.mark.parametrize(("rho", "diverges"), [(0.3, False), (0.49, False), (0.51, True), (0.9, True)])
def test_without_the_cosine_light_grows_past_a_reflectance_of_a_half(rho, diverges):
    patches, _ = furnace(rho)
    factor = NoCosine().exchange(patches).spectral_radius(patches.reflectance)[0]
    assert factor == pytest.approx(2 * rho, rel=1e-6)
    assert (factor >= 1) == diverges


def test_visibility_does_not_matter_in_a_convex_room():
    """The very same rays as `MonteCarlo` sends, so the very same rows."""
    patches, _ = furnace(0.5)
    right = rad.form_factors(patches, rad.MonteCarlo(256, seed=3, light_rays=0), dtype=np.float64)
    wrong = NoVisibility(rays=256, seed=3).exchange(patches)
    assert abs(wrong.matrix - right.matrix).max() < 1e-12
    assert wrong.row_sums == pytest.approx(np.ones(96), abs=1e-12)
    assert (wrong.to_sky == 0).all()


# The exchanges against closed forms


def sensor_below_a_plate():
    """A small patch that looks up, straight below the middle of a square of 2 × 2 m at 1 m, which looks down."""
    tiny = 1e-3 * np.array([[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]])
    plate = np.array([[-1.0, 1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1]])
    black = rad.Material(0.0)
    faces = [[0, 1, 2, 3]]
    return rad.Scene([rad.Surface("sensor", tiny, faces, black), rad.Surface("plate", plate, faces, black)])


def test_the_cosine_forgotten_is_the_solid_angle():
    """A square of half-side a at distance a fills one of six faces of a cube: Ω = 4π / 6, and Ω / π = 2 / 3."""
    patches = rad.subdivide(sensor_below_a_plate())
    wrong = NoCosine(rays=1 << 14).exchange(patches)
    assert wrong.matrix[0, 1] == pytest.approx(2 / 3, abs=5e-3)
    assert wrong.to_sky[0] == pytest.approx(4 / 3, abs=5e-3)
    right = rad.form_factors(patches, rad.MonteCarlo(1 << 14)).matrix[0, 1]
    assert right == pytest.approx(0.5541, abs=3e-3), "four times Howell's B-3 with a = b = c: the cosine makes it less"


@pytest.mark.parametrize(("patches", "rays"), [(6, 2048), (4096, 2048), (4097, 1024), (10_000, 512), (200_000, 256)])
def test_few_patches_get_many_rays_so_that_pictures_are_not_mottled(patches, rays):
    assert NoCosine().rays_for(range(patches)) == rays
    assert NoVisibility(rays=7).rays_for(range(patches)) == 7


def test_the_default_halves_the_noise_of_fewer_rays():
    """Of the direct light of a lamp, against many rays: error falls with the number, and the lamp is seen evenly."""
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=300)
    exact = NoCosine(rays=1 << 14).exchange(patches).matrix @ patches.emission[:, 0]

    def off(shortcut):
        return np.linalg.norm(shortcut.exchange(patches).matrix @ patches.emission[:, 0] - exact)

    assert off(NoCosine()) < 0.5 * off(NoCosine(rays=256))


def plates_with_a_screen():
    """Unit squares at distance 1 with a black one-sided screen half-way, larger than both."""
    scene = rad.scenes.parallel_plates()
    screen = rad.Surface(
        "screen", [[-2, 0.5, -2], [-2, 0.5, 3], [3, 0.5, 3], [3, 0.5, -2]], [[0, 1, 2, 3]], rad.Material(0.0)
    )
    return rad.Scene([*scene.surfaces, screen])


def test_without_visibility_light_goes_through_a_screen():
    patches = rad.subdivide(plates_with_a_screen(), patch_count=120)
    wrong = NoVisibility(rays=1 << 14).exchange(patches)
    factors = rad.form_factors(patches, rad.MonteCarlo(1 << 10))
    assert factors.between_surfaces().factor("lower", "upper") == 0.0
    lower, upper = (patches.surface == k for k in (0, 1))
    share = wrong.matrix.toarray()[np.ix_(lower, upper)].sum(axis=1)
    assert np.average(share, weights=patches.area[lower]) == pytest.approx(OPPOSITE, abs=2e-3)
    screen = wrong.matrix.toarray()[np.ix_(lower, patches.surface == 2)]
    assert (screen == 0).all(), "its back is passed through, and counts nothing"


def test_rays_through_walls_count_each_front_once():
    """In two rooms with a small hole in between, every wall sees the far room's walls too: all that faces it."""
    patches = rad.subdivide(rad.scenes.two_rooms(door=0.5), patch_count=400)
    wrong = NoVisibility(rays=256).exchange(patches)
    right = rad.form_factors(patches, rad.MonteCarlo(256))
    assert wrong.row_sums.max() > 1.2, "more than all around"
    left = patches.surface == patches.surface_names.index("left_wall")
    far = patches.surface == patches.surface_names.index("right_wall")
    through = wrong.matrix.toarray()[np.ix_(left, far)].sum(axis=1)
    seen = right.matrix.toarray()[np.ix_(left, far)].sum(axis=1)
    # Howell C-11 for 4 × 2.6 m at 8 m
    assert np.average(through, weights=patches.area[left]) == pytest.approx(0.04643, abs=1e-3)
    assert seen.max() < 0.01
    diagonal = wrong.matrix.diagonal()
    assert (diagonal == 0).all(), "nothing flat meets itself"


def test_forgetting_the_cosine_flattens_a_ball():
    """A small lamp ten radii away, c the cosine at the ball's centre: E ~ (10c - 1)(10 - c) / d⁴, d² = 101 - 20c.

    Without the cosine only (10 - c) / d³ is left: the rim is nearly as bright as the middle.
    """
    patches = rad.subdivide(rad.scenes.lit_sphere(reflectance=0.8, subdivisions=3))
    lamp = patches.surface == 1
    c = patches.normal @ (patches.centroid[lamp].mean(axis=0) / 10.0)
    distance = np.sqrt(101 - 20 * c)
    middle, rim = ~lamp & (c > 0.9), ~lamp & (c > 0.2) & (c < 0.4)

    def ratio(light):
        return light[rim].mean() / light[middle].mean()

    factors = rad.form_factors(patches, rad.MonteCarlo(1 << 11))
    right = DirectOnly().radiosity(patches, factors)[:, 0]
    wrong = NoCosine(rays=1 << 11, bounces=1).radiosity(patches, factors)[:, 0]
    assert ratio(right) == pytest.approx(ratio((10 * c - 1) * (10 - c) / distance**4), rel=0.06)
    assert ratio(wrong) == pytest.approx(ratio((10 - c) / distance**3), rel=0.06)
    assert ratio(wrong) > 0.7 > 0.3 > ratio(right)


# In the Cornell box


@pytest.mark.parametrize("shortcut", [Ambient(), AmbientOcclusion()], ids=lambda s: s.name)
def test_an_ambient_has_the_right_mean_and_is_wrong_all_the_same(shortcut, cornell):
    patches, factors, truth = cornell
    found = shortcut.radiosity(patches, factors, truth)
    area = patches.area[:, None]
    assert np.sum(area * found, axis=0) == pytest.approx(np.sum(area * truth, axis=0), rel=1e-12)
    dark = patches.emission.sum(axis=1) == 0
    error = np.sqrt(np.sum((area * (found - truth) ** 2)[dark]) / np.sum((area * truth**2)[dark]))
    assert 0.1 < error < 0.3
    again = shortcut.radiosity(patches, factors)
    assert again == pytest.approx(found, rel=1e-4), "the truth is solved for where it is not given"


def test_every_shortcut_is_wrong_in_the_cornell_box(cornell):
    patches, factors, truth = cornell
    dark = patches.emission.sum(axis=1) == 0
    errors = {}
    for shortcut in shortcuts.ALL:
        found = shortcut.radiosity(patches, factors, truth)
        assert found.shape == truth.shape and np.isfinite(found).all() and (found >= 0).all()
        lit = patches.area[dark, None]
        errors[shortcut.name] = np.sqrt(np.sum(lit * (found - truth)[dark] ** 2) / np.sum(lit * truth[dark] ** 2))
    assert len(errors) == 6
    assert min(errors.values()) > 0.1, errors
    assert relative_error(patches, CutAt(60).radiosity(patches, factors), truth) < 1e-6, "but the one with an end"


def test_what_no_lamp_sees_is_black_by_direct_light(cornell):
    patches, factors, truth = cornell
    ceiling = patches.surface == patches.surface_names.index("ceiling")
    direct = DirectOnly().radiosity(patches, factors)[ceiling]
    assert (direct == 0).all()
    assert truth[ceiling, 0].min() > 0.05
    with_ambient = Ambient().radiosity(patches, factors, truth)[ceiling]
    assert np.ptp(with_ambient, axis=0) == pytest.approx(np.zeros(3), abs=1e-12), "a flat colour"


def test_ambient_occlusion_darkens_corners_and_nothing_else():
    patches = rad.subdivide(rad.scenes.furnace(reflectance=0.5, emission=0.0), patch_count=600)
    share = shortcuts.lighting.openness(patches, 0.1, 256, 0)
    near_edge = (np.abs(patches.centroid - 0.5) > 0.44).sum(axis=1) > 1
    inside = (np.abs(patches.centroid - 0.5) > 0.30).sum(axis=1) == 1
    assert share[inside] == pytest.approx(np.ones(inside.sum()), abs=1e-12), "farther than 0.1 × √3 from all walls"
    assert 0.3 < share[near_edge].mean() < 0.75
    assert shortcuts.lighting.openness(patches, 2.0, 16, 0).max() == 0.0, "closed"
    alone = rad.subdivide(rad.scenes.uniform_dome())
    assert shortcuts.lighting.openness(alone, 2.0, 16, 0).min() == 1.0, "a ball under the sky"


# What they are, and what they are not


def test_nothing_wrong_gets_into_the_certified_path():
    patches, _ = furnace(0.7)
    for shortcut in (NoCosine(), NoVisibility()):
        wrong = shortcut.exchange(patches)
        assert not isinstance(wrong, rad.FormFactors)
        with pytest.raises((AttributeError, TypeError)):
            rad.TransportOperator(wrong, patches)
    with pytest.raises(FormFactorError, match="more than 1 leaves patch"):
        rad.FormFactors.from_matrix(NoCosine().exchange(patches).matrix, patches.area)


def test_same_seed_same_bits_for_any_threads_and_blocks(monkeypatch):
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=150)
    first = [s.exchange(patches, 1).matrix.toarray() for s in (NoCosine(seed=5), NoVisibility(seed=5))]
    monkeypatch.setattr("radiosity.shortcuts.rays.BATCH", 1 << 10)
    again = [s.exchange(patches, 3).matrix.toarray() for s in (NoCosine(seed=5), NoVisibility(seed=5))]
    assert all((a == b).all() for a, b in zip(first, again, strict=True))
    assert (NoCosine(seed=6).exchange(patches).matrix.toarray() != first[0]).any()


@pytest.mark.parametrize("shortcut", shortcuts.ALL, ids=lambda s: s.name)
def test_each_says_what_it_strikes_out(shortcut):
    from matplotlib.mathtext import MathTextParser

    assert shortcuts.WRONG == "WRONG"
    assert shortcut.name and shortcut.sentence.endswith(".") and shortcut.sentence.count(".") == 1
    assert shortcuts.base.STROKE in shortcut.equation
    MathTextParser("path").parse(shortcut.equation)
    with pytest.raises(dataclasses.FrozenInstanceError):
        shortcut.rays = 3


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: CutAt(-1), "bounces is -1"),
        (lambda: NoCosine(rays=0), "rays 0"),
        (lambda: NoVisibility(bounces=-2), "bounces is -2"),
        (lambda: AmbientOcclusion(distance=0.0), "distance is 0.0"),
        (lambda: DirectOnly().radiosity(furnace(0.5)[0], six_factors()), "factors are of 6 patches, and there are 96"),
        (lambda: Ambient().radiosity(*furnace(0.5), np.ones((3, 1))), r"truth has shape \(3, 1\)"),
    ],
)
def test_what_they_refuse(call, sentence):
    with pytest.raises(ParameterError, match=sentence):
        call()


def six_factors():
    return rad.form_factors(rad.subdivide(rad.scenes.furnace()), rad.MonteCarlo(16))
