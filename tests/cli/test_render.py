"""`radiosity render`: the picture of the API, in files."""

import numpy as np
import pytest
from PIL import Image

import radiosity as rad
from radiosity import display
from radiosity.camera import presets
from radiosity.cli import main

SMALL = ["--patches", "100", "--rays", "64", "--bounces", "3", "--size", "24x16", "--pixel-samples", "2"]


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    """Each test works in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def solved(name="cornell_box"):
    estimator = rad.MonteCarlo(rays=64, replicates=2)
    return rad.solve(rad.scenes.BUILT_IN[name](), patch_count=100, estimator=estimator, bounces=3)


def pixels(path):
    with Image.open(path) as image:
        return np.asarray(image)


def test_the_picture_is_that_of_the_api(place, capsys):
    assert main(["render", "cornell_box", *SMALL, "-o", "a.png", "-o", "a.npy"]) == 0
    expected = rad.render(solved(), size=(24, 16), samples=2)
    np.testing.assert_array_equal(np.load("a.npy"), expected.astype(np.float32))
    factor = display.automatic_factor(expected.reshape(-1, 3), np.ones(24 * 16))
    np.testing.assert_array_equal(pixels("a.png"), display.tone_map(expected, factor))
    assert f"wrote a.png, radiance {display.factor_text(factor)}" in capsys.readouterr().err
    assert sorted(path.name for path in place.iterdir()) == ["a.npy", "a.png"]  # nothing half-written


def test_exposure_and_tone_are_taken():
    assert main(["render", "cornell_box", *SMALL, "-o", "a.png", "--exposure", "-1", "--tone", "linear"]) == 0
    expected = rad.render(solved(), size=(24, 16), samples=2)
    factor = 0.5 * display.automatic_factor(expected.reshape(-1, 3), np.ones(24 * 16))
    np.testing.assert_array_equal(pixels("a.png"), display.tone_map(expected, factor, "linear"))


def test_cameras_by_name_and_of_ones_own():
    assert main(["render", "cornell_box", *SMALL, "-q", "-o", "a.npy", "--camera", "outside"]) == 0
    outside = next(camera for camera in presets(solved().patches) if camera.name == "outside")
    np.testing.assert_allclose(np.load("a.npy"), rad.render(solved(), outside, (24, 16), samples=2), rtol=1e-6)

    words = ["--from=-0.1,0.3,0.1", "--to", "0.5,0.1,0.5", "--fov", "50"]
    assert main(["render", "cornell_box", *SMALL, "-q", "-o", "b.npy", *words]) == 0
    own = rad.Camera("own", (-0.1, 0.3, 0.1), (0.5, 0.1, 0.5), fov=50.0)
    np.testing.assert_allclose(np.load("b.npy"), rad.render(solved(), own, (24, 16), samples=2), rtol=1e-6)


def test_a_kept_solution_is_rendered_under_its_own_name():
    solved("red_rug").save("kept.npz")
    assert main(["render", "kept.npz", "--size", "8x8", "--pixel-samples", "1", "-q"]) == 0
    assert pixels("red_rug.png").shape == (8, 8, 3)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["-o", "a.jpg"], "'.jpg' is not written here"),
        (["-o", "none/a.png"], "there is no folder none"),
        (["--camera", "side"], "no camera 'side'; it has front, outside"),
        (["--from", "1,2,3"], "needs both --from and --to"),
        (["--camera", "front", "--from", "1,2,3", "--to", "0,0,0"], "not both"),
        (["--fov", "50"], "--fov is for a camera of your own"),
        (["--size", "24"], "not WIDTHxHEIGHT"),
        (["--from", "1,2"], "not X,Y,Z"),
        (["--from", "1,1,1", "--to", "1,1,1"], "leave open"),
    ],
)
def test_what_does_not_fit_is_said_in_one_line(place, capsys, words, message):
    assert main(["render", "cornell_box", "--patches", "40", "--rays", "16", "--bounces", "1", "-q", *words]) == 2
    told = capsys.readouterr().err
    assert message in told
    assert "Traceback" not in told
    assert not list(place.iterdir())
