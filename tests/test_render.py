"""Pictures: closed forms to the last digits, a path tracer's picture of the Cornell box, and what must not matter."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import radiosity as rad
from radiosity.camera import presets
from radiosity.compiled import kernel
from radiosity.errors import FileFormatError, MemoryLimitError, MissingFileError, ParameterError
from radiosity.render import picture as picture_module
from radiosity.render import strips
from radiosity.render.aim import Targets

TRUTH = Path(__file__).parent / "truth" / "cornell_image.npz"
OFFICIAL = rad.Camera("official", (0.278, 0.273, -0.8), (0.278, 0.273, 0.0), fov=2 * np.degrees(np.arctan(12.5 / 35)))
FLOOR = [[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]]  # faces up, y
FROM_ABOVE = rad.Camera("above", (0.5, 2.0, 0.5), (0.5, 0.0, 0.5), up=(0.0, 0.0, 1.0), fov=20.0)


def plate(name, corners, **material):
    return rad.Surface(name, corners, [[0, 1, 2, 3]], rad.Material(**material))


def shifted(corners, height, turned=False):
    moved = np.asarray(corners, dtype=float) + [0.0, height, 0.0]
    return moved[::-1] if turned else moved


def solved(scene, patch_count=400, **settings):
    return rad.solve(scene, patch_count=patch_count, estimator=rad.MonteCarlo(rays=256), **settings)


@pytest.fixture(scope="module")
def box():
    return solved(rad.scenes.cornell_box(), 4000)


@pytest.fixture(scope="module")
def box_picture(box):
    return rad.render(box, OFFICIAL, (128, 128))


# What is known exactly


@pytest.mark.parametrize("reflectance", [0.0, 0.5, 0.9])
def test_a_furnace_is_the_same_everywhere(reflectance):
    """L = E / π (1 - ρ), also in corners, where kernels are singular and patches are near."""
    solution = solved(rad.scenes.furnace(reflectance=reflectance, emission=2.0))
    found = rad.render(solution, size=(48, 32), samples=8)
    np.testing.assert_allclose(found, 2.0 / (np.pi * (1.0 - reflectance)), rtol=2e-6)


@pytest.mark.parametrize("bounces", [0, 1, 2, 5])
def test_a_picture_has_as_many_bounces_as_the_solution(bounces):
    solution = solved(rad.scenes.furnace(reflectance=0.5, emission=1.0), bounces=bounces)
    expected = sum(0.5**k for k in range(bounces + 1)) / np.pi
    np.testing.assert_allclose(rad.render(solution, size=(16, 12), samples=4), expected, rtol=2e-6)


def test_a_lone_plate_under_a_sky():
    """H = π L_sky: every ray goes to the sky, so there is no noise."""
    solution = solved(rad.Scene([plate("plate", FLOOR, reflectance=0.4)], sky=3.0, name="plate"), 4)
    found = rad.render(solution, FROM_ABOVE, (32, 32), samples=4)
    assert found[16, 16] == pytest.approx(0.4 * 3.0, rel=1e-12)
    outside = rad.Camera("up", (0.5, 2.0, 0.5), (0.5, 3.0, 0.5), up=(0.0, 0.0, 1.0))
    np.testing.assert_allclose(rad.render(solution, outside, (8, 8), samples=4), 3.0, rtol=1e-12)


def test_the_camera_sees_through_the_backs_of_one_sided_faces():
    """But light does not: a plate that looks at the black back of another has no light."""
    below = rad.Camera("below", (0.5, -2.0, 0.5), (0.5, 0.0, 0.5), up=(0.0, 0.0, 1.0), fov=20.0)
    plates = [plate("low", FLOOR, reflectance=0.4), plate("high", shifted(FLOOR, 1e-3), reflectance=0.4)]
    solution = solved(rad.Scene(plates, sky=3.0, name="plates"), 4)
    np.testing.assert_array_equal(rad.render(solution, below, (8, 8), samples=4), 3.0)
    assert rad.render(solution, FROM_ABOVE, (8, 8), samples=4)[4, 4] == pytest.approx(1.2)
    between = rad.Camera("between", (0.5, 5e-4, 0.5), (0.5, 0.0, 0.5), up=(0.0, 0.0, 1.0), fov=20.0)
    assert np.all(rad.render(solution, between, (8, 8), samples=4) == 0.0)


def test_two_sided_faces_hide_what_is_behind_them():
    double = plate("double", shifted(FLOOR, -1.0), reflectance=0.4, two_sided=True)
    solution = solved(rad.Scene([plate("plate", FLOOR, reflectance=0.4), double], sky=3.0, name="plates"), 4)
    below = rad.Camera("below", (0.5, -2.0, 0.5), (0.5, 0.0, 0.5), up=(0.0, 0.0, 1.0), fov=20.0)
    np.testing.assert_allclose(rad.render(solution, below, (8, 8), samples=4), 0.4 * 3.0, rtol=1e-12)


def test_a_two_sided_lamp_lights_both_sides():
    """Equal plates above and below it; the direct light is that of the closed form, the rest is small."""
    small = 0.5 + 0.02 * (np.asarray(FLOOR, dtype=float) - [0.5, 0.0, 0.5]) - [0.0, 0.5, 0.0]
    scene = rad.Scene(
        [
            plate("below", shifted(FLOOR, -1.0), reflectance=0.5),
            plate("above", shifted(FLOOR, 1.0, turned=True), reflectance=0.5),
            plate("lamp", small, reflectance=0.0, emission=np.pi * 100.0, two_sided=True),
        ],
        name="two rooms",
    )
    solution = solved(scene, bounces=1)
    kernel_at = lambda x, h: 0.02**2 * 100.0 * h**4 / ((x - 0.5) ** 2 + h**2) ** 2 / h**2  # noqa: E731 (E of a small lamp)
    for height, side in ((-1.0, 1.0), (1.0, -1.0)):
        camera = rad.Camera("", (0.2, height + side * 0.4, 0.5), (0.2, height, 0.5), up=(0.0, 0.0, 1.0), fov=0.1)
        found = rad.render(solution, camera, (8, 8), samples=4)
        np.testing.assert_allclose(found, 0.5 / np.pi * kernel_at(0.2, 1.0), rtol=2e-3)


def test_light_at_a_point_is_that_of_irradiance_at(box):
    """Another estimator: many rays from single points, which also have to find the lamp."""
    points = np.array([[0.45, 0.0, 0.1], [0.2, 0.3, 0.5592], [0.2, 0.165, 0.15]])
    normals = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    expected = box.irradiance_at(points, normals, rays=1 << 17)
    white = np.array([0.725, 0.71, 0.68])
    for point, irradiance in zip(points, expected, strict=True):
        camera = rad.Camera("", (0.278, 0.4, -0.1), tuple(point), fov=0.3)
        found = rad.render(box, camera, (16, 16)).mean(axis=(0, 1))
        np.testing.assert_allclose(found, white * irradiance / np.pi, rtol=0.015)


# A picture that others computed


def against_the_truth(found):
    """Root mean square error over the mean, less the truth's own error, and the ratio of means by channel."""
    with np.load(TRUTH) as file:
        truth, error = (file[name].astype(np.float64) for name in ("radiance", "stderr"))
    fold = truth.shape[0] // found.shape[0]

    def folded(values):
        return values.reshape(found.shape[0], fold, found.shape[1], fold, -1).mean(axis=(1, 3))

    lamp = np.zeros(truth.shape[:2])
    lamp[30:42, 104:152] = 1.0  # and all pixels around its edge
    shown = folded(lamp)[..., 0] == 0.0
    there, squares = folded(truth)[shown], folded(error**2)[shown] / fold**2
    mean_square = ((found[shown] - there) ** 2).mean() - squares.mean()
    return np.sqrt(max(mean_square, 0.0)) / there.mean(), found[shown].mean(axis=0) / there.mean(axis=0)


def test_the_cornell_box_is_the_path_tracers(box_picture):
    error, ratio = against_the_truth(box_picture)
    assert error < 0.02, error
    np.testing.assert_allclose(ratio, 1.0, atol=0.006)


@kernel
def _without_cosine(emitters, pieces, sums):
    """What the shares would be if the lamp shone the same to all sides: no cosine there."""
    for p in range(sums.share.shape[0]):
        for e in range(sums.share.shape[1]):
            away = pieces[p] - emitters.centre[e]
            cosine = np.sum(away * emitters.normal[e]) / np.sqrt(np.sum(away**2))
            sums.share[p, e] /= max(cosine, 1e-3)


def test_a_lost_cosine_would_be_noticed(box, monkeypatch):
    """Negative control of the test above."""
    honest = strips.look_for_emitters

    def forgetful(room, emitters, ground, sums):
        honest(room, emitters, ground, sums)
        place = np.array([ground.points[np.argmax(ground.piece == p)] for p in range(len(sums.looks))])
        _without_cosine(emitters, place, sums)

    monkeypatch.setattr(strips, "look_for_emitters", forgetful)
    error, ratio = against_the_truth(rad.render(box, OFFICIAL, (32, 32), samples=4))
    assert error > 0.1
    assert np.all(ratio > 1.1)


def test_the_official_camera(box_picture):
    """Red on the left, green on the right, and the lamp where the truth has it."""
    red, green = box_picture[64, 8], box_picture[64, 120]
    assert red[0] > 5 * red[1]
    assert green[1] > 1.5 * green[0]
    lamp = np.argwhere(box_picture[..., 0] > 10.0)
    assert lamp.min(axis=0) == pytest.approx([31 / 2, 105 / 2], abs=1.0)
    assert lamp.max(axis=0) == pytest.approx([40 / 2, 150 / 2], abs=1.0)


def test_patches_are_not_to_be_seen(box_picture):
    """Forty patches give nearly the picture of four thousand: light near to what is seen is worked out anew."""
    coarse = rad.render(solved(rad.scenes.cornell_box(), 40), OFFICIAL, (128, 128))
    lit = box_picture[..., 0] < 10.0
    error = np.sqrt(((coarse - box_picture)[lit] ** 2).mean()) / box_picture[lit].mean()
    assert error < 0.1
    np.testing.assert_allclose(coarse[lit].mean(axis=0), box_picture[lit].mean(axis=0), rtol=0.04)


# Noise


def test_noise_of_direct_light_falls_faster_than_random():
    """In the penumbra, between pictures of two seeds: low-discrepancy points do better than 1/√rays."""
    direct = solved(rad.scenes.cornell_box(), 200, bounces=1)
    edge = rad.Camera("", (0.278, 0.4, -0.1), (0.045, 0.0, 0.158), fov=10.0)  # the shadow of the short block
    counts, noise = [2, 8, 32], []
    for samples in counts:
        one, other = (rad.render(direct, edge, (48, 48), samples=samples, seed=seed)[..., 0] for seed in (1, 2))
        noise.append(np.std(one - other) / one.mean())
    rate = np.polyfit(np.log(counts), np.log(noise), 1)[0]
    assert -1.2 < rate < -0.6, noise


def test_rays_aimed_at_bright_patches_change_the_noise_and_not_the_mean(monkeypatch):
    """A lamp close under a ceiling: what outshines all else is a small strip around it."""
    high = np.asarray(FLOOR, dtype=float) * 4.0 - [1.5, 0.0, 1.5]
    scene = rad.Scene(
        [
            plate("floor", high, reflectance=0.5),
            plate("ceiling", shifted(high, 2.0, turned=True), reflectance=0.8),
            plate("lamp", shifted(FLOOR, 1.95), reflectance=0.5, emission=10.0, two_sided=False),
        ],
        name="lamp under a ceiling",
    )
    solution = solved(scene, 2000)
    looking = rad.Camera("", (0.5, 1.0, 0.5), (0.0, 0.0, 0.6), fov=40.0)
    aimed = [rad.render(solution, looking, (32, 32), samples=8, seed=seed) for seed in (1, 2)]
    asked = []

    def no_targets(patches, *_):
        asked.append(patches)
        none = np.empty(0, dtype=np.int32)
        return Targets(none, none, np.empty(0), np.zeros(len(patches)))

    monkeypatch.setattr(picture_module, "bright_patches", no_targets)
    random = [rad.render(solution, looking, (32, 32), samples=8, seed=seed) for seed in (1, 2)]
    assert len(asked) == 2
    assert np.mean(aimed) == pytest.approx(np.mean(random), rel=0.01)
    spread = [np.std(one - other) for one, other in (aimed, random)]
    assert spread[0] < 0.5 * spread[1]


# What must not matter, and what must


def test_threads_do_not_matter_and_seeds_do(box):
    one = rad.render(box, OFFICIAL, (40, 30), samples=4, threads=1)
    np.testing.assert_array_equal(one, rad.render(box, OFFICIAL, (40, 30), samples=4, threads=3))
    assert not np.array_equal(one, rad.render(box, OFFICIAL, (40, 30), samples=4, seed=1))


def test_scale_does_not_matter():
    """A room a million times as large has the same radiance."""

    def room(scale):
        parts = rad.scenes.red_rug().surfaces
        surfaces = [rad.Surface(s.name, np.asarray(s.vertices) * scale, s.faces, s.material) for s in parts]
        return solved(rad.Scene(surfaces, name="rug", closed=True), 300)

    small, large = (rad.render(room(scale), size=(24, 16), samples=4) for scale in (1.0, 2.0**20))
    np.testing.assert_allclose(large, small, rtol=1e-5)


def test_the_default_camera_is_the_first_preset(box):
    first = rad.render(box, presets(box.patches)[0], (12, 12), samples=1)
    np.testing.assert_array_equal(rad.render(box, size=(12, 12), samples=1), first)


def test_spectra_have_all_their_channels():
    spectral = solved(rad.scenes.cornell_box(spectral=True), 100, bounces=3)
    found = rad.render(spectral, OFFICIAL, (12, 12), samples=2)
    assert found.shape == (12, 12, 76)
    assert np.all(np.isfinite(found)) and np.all(found >= 0.0)


def test_progress_is_told_and_may_stop_the_work(box):
    told = []
    rad.render(box, OFFICIAL, (20, 10), samples=1, progress=lambda *step: told.append(step))
    assert ("render", 200, 200) in told
    assert told[-1][0] == "share" and told[-1][1] == told[-1][2]

    def stop(*_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        rad.render(box, OFFICIAL, (20, 10), samples=1, progress=stop)


@pytest.mark.parametrize(
    ("settings", "error", "words"),
    [
        ({"size": (0, 10)}, ParameterError, "size is"),
        ({"size": (10.5, 10)}, ParameterError, "size is"),
        ({"size": (10, 10, 3)}, ParameterError, "size is"),
        ({"size": (100_000, 100_000)}, MemoryLimitError, "GB"),
        ({"samples": 0}, ParameterError, "samples is 0"),
        ({"samples": 5000}, ParameterError, "samples is 5000"),
        ({"seed": -1}, ParameterError, "seed is -1"),
        ({"camera": rad.Camera("", (0, 0, 0), (0, 0, 0))}, ParameterError, "leave open"),
        ({"camera": rad.Camera("", (0, 0, 0), (0, 5, 0))}, ParameterError, "leave open"),
        ({"camera": rad.Camera("", (0, 0, 0), (0, 0, np.nan))}, ParameterError, "no pinhole"),
        ({"camera": rad.Camera("", (0, 0, 0), (0, 0, 1), fov=180.0)}, ParameterError, "no pinhole"),
    ],
)
def test_bad_settings_are_named(box, settings, error, words):
    with pytest.raises(error, match=words):
        rad.render(box, **settings)


def test_pictures_are_written_as_bytes_and_as_numbers(tmp_path, box_picture):
    assert rad.write_picture(box_picture, tmp_path / "a.npy") == 1.0
    np.testing.assert_array_equal(np.load(tmp_path / "a.npy"), box_picture.astype(np.float32))
    factor = rad.write_picture(box_picture, tmp_path / "a.png", exposure=1.0)
    with Image.open(tmp_path / "a.png") as image:
        assert image.size == (128, 128)
    assert factor == pytest.approx(2.0 * rad.write_picture(box_picture, tmp_path / "b.png"))
    with pytest.raises(FileFormatError, match=r"\.jpg"):
        rad.write_picture(box_picture, tmp_path / "a.jpg")
    with pytest.raises(MissingFileError, match="no folder"):
        rad.write_picture(box_picture, tmp_path / "none" / "a.png")
    with pytest.raises(ParameterError, match="shape"):
        rad.write_picture(box_picture[0], tmp_path / "a.png")
