"""From spectra to colours: the CIE 1931 standard observer and linear sRGB. Arrays only.

A spectrum is one number for each of B bands, evenly spaced in wavelength. Its colour is what the three colour-matching
functions make of it; they are scaled so that the same number in every band, equal energy, has luminance Y = that
number. Three channels that a spectrum becomes are then in the unit of its bands and can stand beside RGB light.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ParameterError

FloatArray = NDArray[np.float64]

TABULATED = (380.0, 780.0, 4.0)  # first and last wavelength of the table, and its step, nm

# fmt: off
COLOUR_MATCHING = np.array([
    (0.001368, 3.9e-05, 0.006450001), (0.001995757, 5.71764e-05, 0.009414544),
    (0.003300829, 9.350816e-05, 0.01558805), (0.005330048, 0.000151492, 0.02520288),
    (0.008751373, 0.0002469067, 0.04143771), (0.01431, 0.000396, 0.06785001),
    (0.02074801, 0.0005722187, 0.09854048), (0.03388092, 0.00094116, 0.1613035),
    (0.0550226, 0.001530752, 0.2626114), (0.08695811, 0.0024548, 0.4162091), (0.13438, 0.004, 0.6456),
    (0.198611, 0.00654616, 0.959439), (0.2587773, 0.00976768, 1.2581233), (0.3048965, 0.01358272, 1.4948035),
    (0.3343513, 0.01800736, 1.6564048), (0.34828, 0.023, 1.74706), (0.349287, 0.02835125, 1.7804334),
    (0.3418088, 0.03452112, 1.7791982), (0.3300411, 0.041768, 1.764039), (0.3140251, 0.05024368, 1.7335595),
    (0.2908, 0.06, 1.6692), (0.2604227, 0.07091109, 1.564528), (0.2184072, 0.0836668, 1.3898799),
    (0.1733273, 0.09904584, 1.1878243), (0.1321786, 0.117532, 0.9941976), (0.09564, 0.13902, 0.8129501),
    (0.06458099, 0.1627177, 0.6521049), (0.04115088, 0.1912735, 0.5203376), (0.0241444, 0.2267345, 0.4161836),
    (0.01216179, 0.2701849, 0.3348578), (0.0049, 0.323, 0.272), (0.002236293, 0.3892875, 0.2234533),
    (0.00517484, 0.4633944, 0.1792254), (0.01553588, 0.544512, 0.1383758), (0.03481485, 0.6293456, 0.1039048),
    (0.06327, 0.71, 0.07824999), (0.09945645, 0.7778368, 0.06078835), (0.1423679, 0.8363068, 0.04775276),
    (0.18914, 0.8849624, 0.03693564), (0.2383209, 0.9237348, 0.02771181), (0.2904, 0.954, 0.0203),
    (0.3454828, 0.9760225, 0.01458461), (0.4033784, 0.9903128, 0.01037792), (0.464336, 0.9980983, 0.0073816),
    (0.5282959, 0.9998567, 0.0053036), (0.5945, 0.995, 0.0039), (0.6615697, 0.9827241, 0.0029348),
    (0.7288284, 0.9638568, 0.0023094), (0.7948256, 0.9384992, 0.0019482), (0.8579325, 0.9070064, 0.001766267),
    (0.9163, 0.87, 0.001650001), (0.9672179, 0.8275813, 0.001458533), (1.0090892, 0.781192, 0.001205),
    (1.040986, 0.7324224, 0.0010494), (1.0597944, 0.6822192, 0.00096864), (1.0622, 0.631, 0.0008),
    (1.0509768, 0.5796379, 0.00064544), (1.0226662, 0.5283528, 0.0004354), (0.9793314, 0.4780304, 0.00028316),
    (0.923194, 0.42908, 0.0002295467), (0.8544499, 0.381, 0.00019), (0.772954, 0.3328176, 0.0001168533),
    (0.6856022, 0.2865936, 6.5e-05), (0.6011138, 0.2448896, 3.948e-05), (0.5225995, 0.2081616, 2.765333e-05),
    (0.4479, 0.175, 2e-05), (0.3775333, 0.1451259, 1.213333e-05), (0.3130192, 0.1187792, 3.2e-06),
    (0.2561184, 0.09618864, 0.0), (0.2070971, 0.07712064, 0.0), (0.1649, 0.061, 0.0),
    (0.1291467, 0.04754965, 0.0), (0.09969044, 0.03656384, 0.0), (0.07680428, 0.02807664, 0.0),
    (0.05980685, 0.02180077, 0.0), (0.04677, 0.017, 0.0), (0.03540461, 0.01283478, 0.0),
    (0.02634484, 0.009533311, 0.0), (0.01959988, 0.007085424, 0.0), (0.01479064, 0.005343059, 0.0),
    (0.01135916, 0.004102, 0.0), (0.008678854, 0.003134093, 0.0), (0.006627313, 0.002393244, 0.0),
    (0.005052583, 0.00182458, 0.0), (0.003833913, 0.001384496, 0.0), (0.002899327, 0.001047, 0.0),
    (0.002196616, 0.0007932384, 0.0), (0.00166011, 0.000599496, 0.0), (0.001246275, 0.0004500528, 0.0),
    (0.0009287358, 0.0003353835, 0.0), (0.0006900786, 0.0002492, 0.0), (0.000512429, 0.0001850475, 0.0),
    (0.0003829814, 0.0001383016, 0.0), (0.0002888871, 0.0001043224, 0.0), (0.000219171, 7.914667e-05, 0.0),
    (0.0001661505, 6e-05, 0.0), (0.000125852, 4.544747e-05, 0.0), (9.539445e-05, 3.444868e-05, 0.0),
    (7.231304e-05, 2.611356e-05, 0.0), (5.477028e-05, 1.977855e-05, 0.0), (4.150994e-05, 1.499e-05, 0.0),
])
# fmt: on
"""x̄, ȳ, z̄ of the CIE 1931 2° standard observer from 380 to 780 nm in steps of 4 nm, (101, 3).

Every fourth value of the 1 nm table of ISO/CIE 11664-1:2019. Taken over from the package colour-science 0.4.7
(BSD-3-Clause), which has it from the Colour & Vision Research Laboratory, http://www.cvrl.org.
Linear between two of them a value is off by at most 0.0023, 0.0016 and 0.011.
"""

PRIMARIES = np.array([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]])  # x, y of sRGB's red, green, blue (IEC 61966-2-1)
D65 = np.array([0.3127, 0.3290])  # x, y of its white


def _xyz_of(chromaticity: FloatArray) -> FloatArray:
    """XYZ with Y = 1 of chromaticities x, y, (…, 2) → (…, 3)."""
    x, y = chromaticity[..., 0], chromaticity[..., 1]
    return np.stack([x / y, np.ones_like(x), (1.0 - x - y) / y], axis=-1)


def _rgb_to_xyz() -> FloatArray:
    """Columns are XYZ of the primaries, such that (1, 1, 1) is the white."""
    columns = _xyz_of(PRIMARIES).T
    return columns * np.linalg.solve(columns, _xyz_of(D65))


RGB_TO_XYZ = _rgb_to_xyz()
XYZ_TO_RGB = np.linalg.inv(RGB_TO_XYZ)


def colour_matching(wavelengths: ArrayLike) -> FloatArray:
    """x̄, ȳ, z̄ of the CIE 1931 2° observer, linear between the table's values; 0 outside 380 … 780 nm.

    Parameters
    ----------
    wavelengths : array_like (B,)
        nm.

    Returns
    -------
    ndarray (B, 3)

    Raises
    ------
    ParameterError
        Wavelengths that are no nanometres.
    """
    length = np.asarray(wavelengths, dtype=np.float64)
    if length.ndim != 1 or not np.all((length >= 1.0) & np.isfinite(length)):
        raise ParameterError(f"wavelengths {wavelengths!r} have shape {length.shape}; give nanometres, (B,)")
    first, last, step = TABULATED
    table = np.linspace(first, last, round((last - first) / step) + 1)
    return np.stack([np.interp(length, table, column, 0.0, 0.0) for column in COLOUR_MATCHING.T], axis=1)


def luminous_weights(wavelengths: ArrayLike) -> FloatArray:
    """V(λ) = ȳ(λ) of the bands, (B,): weights of watts, with an efficacy of 683 lm/W, for `radiosity.photometry`.

    >>> luminous_weights([448.0, 556.0, 660.0]).round(4)
    array([0.0345, 0.9999, 0.061 ])
    """
    return colour_matching(wavelengths)[:, 1]


def spectrum_to_xyz(spectrum: ArrayLike, wavelengths: ArrayLike) -> FloatArray:
    """CIE XYZ of spectra, with Y = 1 where every band is 1: Σ S x̄ / Σ ȳ, and so on.

    Parameters
    ----------
    spectrum : array_like (…, B)
        Light of each band, any unit.
    wavelengths : array_like (B,)
        Their centres, nm, evenly spaced.

    Returns
    -------
    ndarray (…, 3)
        In the unit of the spectrum.

    Raises
    ------
    ParameterError
        Wavelengths that do not fit the bands, or are not evenly spaced, or that nobody sees.
    """
    light = np.asarray(spectrum, dtype=np.float64)
    length = np.asarray(wavelengths, dtype=np.float64)
    matching = colour_matching(length)
    if not light.ndim or light.shape[-1] != len(length):
        raise ParameterError(f"a spectrum of shape {light.shape} has not the {len(length)} bands of the wavelengths")
    steps = np.diff(length)
    if steps.size and not (np.all(steps > 0) and np.ptp(steps) <= 1e-6 * steps[0]):
        raise ParameterError(f"wavelengths step by {steps.min():g} to {steps.max():g} nm; give even, rising steps")
    seen = matching[:, 1].sum()
    if not seen > 0:
        raise ParameterError(f"no eye sees {length[0]:g} … {length[-1]:g} nm; give wavelengths between 380 and 780 nm")
    return light @ matching / seen


def xyz_to_rgb(xyz: ArrayLike) -> FloatArray:
    """Linear sRGB of CIE XYZ, (…, 3) each. A colour outside the gamut keeps its channel below 0.

    >>> xyz_to_rgb(RGB_TO_XYZ.sum(axis=1)).round(12)
    array([1., 1., 1.])
    """
    return np.asarray(xyz, dtype=np.float64) @ XYZ_TO_RGB.T


def rgb_to_xyz(rgb: ArrayLike) -> FloatArray:
    """CIE XYZ of linear sRGB, (…, 3) each."""
    return np.asarray(rgb, dtype=np.float64) @ RGB_TO_XYZ.T


def spectrum_to_rgb(spectrum: ArrayLike, wavelengths: ArrayLike) -> FloatArray:
    """Linear sRGB of spectra, (…, B) → (…, 3): `xyz_to_rgb` of `spectrum_to_xyz`.

    Equal energy is not white in sRGB, whose white is daylight D65, but a little pink:

    >>> spectrum_to_rgb(np.ones(101), np.arange(380, 781, 4)).round(3)
    array([1.205, 0.948, 0.909])
    """
    return xyz_to_rgb(spectrum_to_xyz(spectrum, wavelengths))


def chromaticity(xyz: ArrayLike) -> FloatArray:
    """u′, v′ of the CIE 1976 uniform chromaticity scale, (…, 3) → (…, 2); brightness does not count.

    u′ = 4X / (X + 15Y + 3Z), v′ = 9Y / (X + 15Y + 3Z) (CIE 15). Two lights side by side are just
    told apart at a distance of about 0.004. Not a number where there is no light.
    """
    colour = np.asarray(xyz, dtype=np.float64)
    total = colour @ np.array([1.0, 15.0, 3.0])
    parts = np.stack([4.0 * colour[..., 0], 9.0 * colour[..., 1]], axis=-1)
    return np.divide(parts, total[..., None], out=np.full(parts.shape, np.nan), where=total[..., None] != 0)


def colour_difference(first: ArrayLike, second: ArrayLike) -> NDArray[Any]:
    """Distance in u′, v′ between colours given as XYZ, (…, 3) each → (…)."""
    return np.linalg.norm(chromaticity(first) - chromaticity(second), axis=-1)
