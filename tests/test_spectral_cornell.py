"""The measured Cornell box in 76 bands, beside three channels. The table: tests/benchmarks/spectral_cornell.py."""

import numpy as np
import pytest

import radiosity as rad
from radiosity import colour, photometry
from radiosity.scenes import cornell_data
from tests.benchmarks.spectral_cornell import compare, differences, from_spectra

JUST_SEEN = 0.004  # in u′, v′


@pytest.fixture(scope="module")
def boxes():
    return compare(patch_count=300, rays=256)


def test_the_values_in_use_are_not_those_of_the_spectra(boxes):
    """A whiter lamp and brighter walls, which can be seen on every surface."""
    luminance, difference = differences(boxes.in_use, boxes.spectral)
    place = boxes.names.index
    assert difference[place("lamp")] == pytest.approx(0.0227, abs=5e-4)
    assert ((difference > 2 * JUST_SEEN) & (difference < 0.03)).all()
    assert luminance[place("green_wall")] == pytest.approx(1.25, abs=0.02)
    assert luminance[place("red_wall")] == pytest.approx(1.29, abs=0.02)
    white = [place(name) for name in ("floor", "ceiling", "back_wall", "short_block", "tall_block")]
    assert luminance[white] == pytest.approx(np.ones(5), abs=0.015), "as bright, if not of that colour"


def test_three_values_made_from_the_spectra_nearly_do(boxes):
    """What is left is what three channels cannot do: products of spectra are not products of means."""
    luminance, difference = differences(boxes.from_spectra, boxes.spectral)
    place = boxes.names.index
    assert difference[place("lamp")] < 2e-5, "its own light, and 1 % of reflected"
    red, green = difference[place("red_wall")], difference[place("green_wall")]
    assert red == pytest.approx(0.0041, abs=5e-4)
    assert green == pytest.approx(0.0009, abs=3e-4)
    others = np.delete(difference, [place("red_wall"), place("green_wall")])
    assert others.max() < 5e-4 < JUST_SEEN
    assert luminance == pytest.approx(np.ones(8), abs=0.004)
    assert luminance[place("red_wall")] < 1.0, "red on red keeps more than the mean does"


def test_first_reflections_have_the_same_colour_either_way():
    """Negative control: up to order 1 three values made under the lamp's light are exact, so orders 2 … differ."""
    paints, lamp = from_spectra()
    spectrum = np.interp(cornell_data.WAVELENGTHS, *np.array(cornell_data.LAMP_SPECTRUM).T)
    for name, reflectance in cornell_data.REFLECTANCE.items():
        once = colour.spectrum_to_rgb(spectrum * np.array(reflectance), cornell_data.WAVELENGTHS)
        assert paints[name] * lamp == pytest.approx(once, rel=1e-12)
        twice = colour.spectrum_to_rgb(spectrum * np.array(reflectance) ** 2, cornell_data.WAVELENGTHS)
        wrong = np.abs(paints[name] ** 2 * lamp - twice).max() / twice.max()
        assert wrong > 0.05 if name != "white" else wrong < 0.005


def test_equal_spectra_make_equal_boxes():
    """A grey box in 76 bands is the grey box in three channels, band by band."""
    bands = rad.scenes.furnace(reflectance=np.full(76, 0.5), emission=np.linspace(0, 1, 76))
    solution = rad.solve(bands, patch_count=24, estimator=rad.MonteCarlo(64), solver=rad.Neumann(rtol=1e-10))
    expected = 2 * colour.spectrum_to_rgb(np.linspace(0, 1, 76), cornell_data.WAVELENGTHS)
    found = colour.spectrum_to_rgb(solution.radiosity, cornell_data.WAVELENGTHS)
    assert found == pytest.approx(np.tile(expected, (24, 1)), rel=1e-6)


def test_lux_of_a_spectrum():
    """683 lm/W of ȳ: the lamp's own lumens, by quadrature of the table."""
    scene = rad.scenes.cornell_box(spectral=True)
    lamp = next(s for s in scene.surfaces if s.name == "lamp")
    weights = colour.luminous_weights(cornell_data.WAVELENGTHS)
    flux = photometry.luminous(lamp.material.emission, efficacy=photometry.PEAK, weights=weights)
    Y = colour.spectrum_to_xyz(lamp.material.emission, cornell_data.WAVELENGTHS)[1]
    assert flux == pytest.approx(683.0 * Y * weights.sum(), rel=1e-12)
