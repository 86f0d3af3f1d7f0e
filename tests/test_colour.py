"""Spectra to colours: the observer against an independent fit and known colours, and what is refused."""

import numpy as np
import pytest

from radiosity import colour
from radiosity.display import LUMINANCE_WEIGHTS
from radiosity.errors import ParameterError
from radiosity.scenes.cornell_data import WAVELENGTHS

LENGTHS = np.arange(380, 781, 4)

# The table of the 2° observer in CIE 15 (Colorimetry), as printed to five digits
PRINTED = {
    400: (0.01431, 0.00040, 0.06785),
    420: (0.13438, 0.00400, 0.64560),
    440: (0.34828, 0.02300, 1.74706),
    460: (0.29080, 0.06000, 1.66920),
    480: (0.09564, 0.13902, 0.81295),
    500: (0.00490, 0.32300, 0.27200),
    520: (0.06327, 0.71000, 0.07825),
    540: (0.29040, 0.95400, 0.02030),
    560: (0.59450, 0.99500, 0.00390),
    580: (0.91630, 0.87000, 0.00165),
    600: (1.06220, 0.63100, 0.00080),
    620: (0.85445, 0.38100, 0.00019),
    640: (0.44790, 0.17500, 0.00002),
    660: (0.16490, 0.06100, 0.00000),
    680: (0.04677, 0.01700, 0.00000),
    700: (0.01136, 0.00410, 0.00000),
}


def lobe(wavelength, mean, below, above):
    return np.exp(-0.5 * ((wavelength - mean) * np.where(wavelength < mean, below, above)) ** 2)


def fitted(wavelength):
    """The observer as a sum of lobes: C. Wyman, P.-P. Sloan, P. Shirley, JCGT 2 (2013) 2, section 2.2."""
    w = np.asarray(wavelength, dtype=float)
    x = 1.056 * lobe(w, 599.8, 0.0264, 0.0323) + 0.362 * lobe(w, 442.0, 0.0624, 0.0374)
    x = x - 0.065 * lobe(w, 501.1, 0.0490, 0.0382)
    y = 0.821 * lobe(w, 568.8, 0.0213, 0.0247) + 0.286 * lobe(w, 530.9, 0.0613, 0.0322)
    z = 1.217 * lobe(w, 437.0, 0.0845, 0.0278) + 0.681 * lobe(w, 459.0, 0.0385, 0.0725)
    return np.stack([x, y, z], axis=1)


def test_every_value_of_the_table_is_near_the_fit():
    """The fit is good to 0.014, 0.008, 0.022 at worst: a slip of a digit in one of 303 numbers would show."""
    assert (np.abs(colour.COLOUR_MATCHING - fitted(LENGTHS)) <= [0.0141, 0.0081, 0.0222]).all()


def test_known_points_of_the_observer():
    found = colour.colour_matching(list(PRINTED))
    assert found == pytest.approx(np.array(list(PRINTED.values())), abs=6e-6)
    assert colour.colour_matching([300.0, 379.0, 781.0]).tolist() == [[0, 0, 0]] * 3
    assert len(colour.COLOUR_MATCHING) == len(LENGTHS)
    both = colour.colour_matching([500.0, 502.0, 504.0])
    assert both[1] == pytest.approx((both[0] + both[2]) / 2), "linear in between"


def test_equal_energy_is_the_middle_of_the_chart():
    """By the standard's own scaling, the three functions have equal integrals: x = y = 1/3."""
    xyz = colour.spectrum_to_xyz(np.full(101, 7.0), LENGTHS)
    assert xyz[1] == pytest.approx(7.0, rel=1e-15)
    assert xyz == pytest.approx(np.full(3, 7.0), rel=2e-4)
    assert colour.chromaticity(xyz) == pytest.approx([4 / 19, 9 / 19], abs=1e-4)


def test_a_black_body_has_the_colour_that_the_cie_gives():
    """Illuminant A, Planck's law at 2848 K with the c₂ of its time, 1.435e-2 m K: x = 0.44758, y = 0.40745 (CIE 15)."""
    w = LENGTHS * 1e-9
    planck = w**-5.0 / np.expm1(1.435e-2 / (w * 2848.0))
    X, Y, Z = colour.spectrum_to_xyz(planck / planck.max(), LENGTHS)
    total = X + Y + Z
    assert [X / total, Y / total] == pytest.approx([0.44758, 0.40745], abs=2e-4)


def test_srgb():
    assert colour.RGB_TO_XYZ[1] == pytest.approx(LUMINANCE_WEIGHTS, abs=1e-4), "the luminance of the display"
    published = [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]
    assert pytest.approx(np.array(published), abs=4e-4) == colour.XYZ_TO_RGB, "IEC 61966-2-1, rounded"
    rgb = np.random.default_rng(0).random((5, 4, 3))
    assert colour.xyz_to_rgb(colour.rgb_to_xyz(rgb)) == pytest.approx(rgb, abs=1e-14)
    green = colour.spectrum_to_rgb((LENGTHS == 520).astype(float), LENGTHS)
    assert green[0] < 0 < green[1], "a spectral line is outside the gamut, and is left there"


def test_differences_of_colour():
    red, white = colour.RGB_TO_XYZ[:, 0], colour.RGB_TO_XYZ.sum(axis=1)
    assert colour.chromaticity(white) == pytest.approx([0.1978, 0.4683], abs=1e-4), "D65"
    assert colour.chromaticity(red) == pytest.approx([0.4507, 0.5229], abs=1e-4)
    assert colour.colour_difference(red, 5 * red) == pytest.approx(0.0, abs=1e-15), "brightness does not count"
    assert colour.colour_difference([red, white], white) == pytest.approx([0.2587, 0.0], abs=1e-4)
    assert np.isnan(colour.chromaticity([0.0, 0.0, 0.0])).all()


def test_luminous_weights_of_the_measured_bands():
    weights = colour.luminous_weights(WAVELENGTHS)
    assert weights.shape == (76,)
    assert 4 * weights.sum() == pytest.approx(106.8, rel=1e-3), "∫ V dλ is 106.86 nm, all but 0.1 % between 400 and 700"


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: colour.colour_matching([400e-9]), "give nanometres"),
        (lambda: colour.colour_matching(555.0), "give nanometres"),
        (lambda: colour.spectrum_to_xyz([1.0, 2.0], [400.0, 500.0, 600.0]), "has not the 3 bands"),
        (lambda: colour.spectrum_to_xyz([1.0, 2.0, 1.0], [400.0, 500.0, 650.0]), "step by 100 to 150 nm"),
        (lambda: colour.spectrum_to_xyz([1.0, 2.0], [900.0, 904.0]), "no eye sees 900 … 904 nm"),
    ],
)
def test_what_has_no_colour(call, sentence):
    with pytest.raises(ParameterError, match=sentence):
        call()
