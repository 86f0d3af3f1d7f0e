"""From light to the bytes of a picture: exposure, tone mapping, sRGB, false colour. Arrays only.

Light is linear RGB, one row per patch, in any unit. A picture is made in three steps: multiply by an exposure
factor, press [0, ∞) into [0, 1] by a tone operator, encode as sRGB bytes. Nothing is clipped without a word:
`clipped` says which patches the linear operator cannot show.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ParameterError

FloatArray = NDArray[np.floating[Any]]
ByteArray = NDArray[np.uint8]
Tone = Literal["reinhard", "linear"]

TONES: tuple[Tone, ...] = ("reinhard", "linear")
LUMINANCE_WEIGHTS = (0.2126, 0.7152, 0.0722)  # ITU-R BT.709, the primaries of sRGB
MIDDLE = 0.3  # what the exposure makes of the reference level: light enough to see, with room for highlights
CLIPPED_COLOUR = (255, 0, 255)  # magenta: no wall has it
LIT = 1e-6  # a patch with less than this share of the brightest one counts as unlit

DIVERGING = ((33, 102, 214), (216, 216, 216), (230, 97, 1))

# Seventeen evenly spaced colours of viridis (van der Walt and Smith 2015, CC0): its lightness rises evenly, also for
# readers who do not tell red from green and on a grey printer.
FALSE_COLOURS = np.array(
    [
        (68, 1, 84), (72, 24, 106), (71, 45, 123), (66, 64, 134), (59, 82, 139), (51, 99, 141), (44, 114, 142),
        (38, 130, 142), (33, 145, 140), (31, 160, 136), (40, 174, 128), (63, 188, 115), (94, 201, 98), (132, 212, 75),
        (173, 220, 48), (216, 226, 25), (253, 231, 37),
    ],
    dtype=np.float64,
)  # fmt: skip


def as_rgb(light: ArrayLike) -> FloatArray:
    """Light of any number of channels as linear RGB.

    Parameters
    ----------
    light : array_like (…, C)
        Three channels are RGB. One channel is grey. Of any other number, such as a spectrum, the mean is shown as
        grey: a colour would need the wavelengths, which a picture is not told.

    Returns
    -------
    ndarray (…, 3)
        Floating point, of the precision that was given.
    """
    array = np.asarray(light)
    if not np.issubdtype(array.dtype, np.floating):
        array = array.astype(np.float64)
    if array.shape[-1] == 3:
        return array
    return np.repeat(array.mean(axis=-1, keepdims=True), 3, axis=-1)


def luminance(rgb: FloatArray) -> FloatArray:
    """Brightness of linear RGB (…, 3) → (…), in the unit of its channels (weights of ITU-R BT.709)."""
    return rgb @ np.asarray(LUMINANCE_WEIGHTS, dtype=rgb.dtype)


def exposure_factor(ev: float) -> float:
    """Factor of an exposure value: each step of +1 EV doubles the light.

    >>> exposure_factor(-1)
    0.5
    """
    return 2.0**ev


def exposure_value(factor: float) -> float:
    """Exposure value log₂(factor) of a positive factor.

    >>> round(exposure_value(453), 1)
    8.8
    """
    return math.log2(factor)


SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def factor_text(factor: float) -> str:
    """A factor for a label, with its exposure value.

    >>> factor_text(452.7)
    '×453, +8.8 EV'
    >>> factor_text(0.118)
    '×0.118, −3.1 EV'
    >>> factor_text(139_800.0)
    '×1.4·10⁵, +17.1 EV'
    """
    ev = exposure_value(factor)
    number = f"{factor:.3g}"
    if factor >= 1e4:
        digits, exponent = f"{factor:.1e}".split("e")
        number = f"{digits}·10{str(int(exponent)).translate(SUPERSCRIPTS)}"
    return f"×{number}, {'−' if round(ev, 1) < 0 else '+'}{abs(ev):.1f} EV"


def reference_level(rgb: FloatArray, area: FloatArray) -> float:
    """Luminance of the middle lit patch: half of the lit area is brighter.

    The median hardly feels a lamp, a black corner or a noisy patch, and doubles when the light doubles.

    Parameters
    ----------
    rgb : ndarray (N, 3)
        Linear light.
    area : ndarray (N,)
        m².

    Returns
    -------
    float
        In the unit of the light; 0 where no patch is lit.
    """
    brightness = luminance(rgb)
    brightest = brightness.max(initial=0.0)
    lit = np.flatnonzero(brightness > LIT * brightest)
    if lit.size == 0:
        return 0.0
    rising = lit[np.argsort(brightness[lit], kind="stable")]
    share = np.cumsum(np.asarray(area, dtype=np.float64)[rising])
    return float(brightness[rising[np.searchsorted(share, 0.5 * share[-1])]])


def automatic_factor(rgb: FloatArray, area: FloatArray) -> float:
    """Exposure factor that shows the middle lit patch of (N, 3) as mid-grey; 1 where nothing is lit."""
    level = reference_level(rgb, area)
    return MIDDLE / level if level > 0.0 else 1.0


def reinhard(light: FloatArray) -> FloatArray:
    """Press [0, ∞) into [0, 1) by x / (1 + x), each channel by itself.

    Reinhard et al. (2002), DOI 10.1145/566654.566575, eq. 3, who apply it to luminance; by channel a strong colour
    pales as on film instead of leaving the gamut.
    """
    return light / (light + light.dtype.type(1.0))


def linear(light: FloatArray) -> FloatArray:
    """Clip to [0, 1]; `clipped` tells where this lost something."""
    return np.clip(light, 0.0, 1.0)


TONE_OPERATORS = {"reinhard": reinhard, "linear": linear}


def clipped(light: FloatArray) -> NDArray[np.bool_]:
    """Rows of (…, 3) in which a channel passes 1, so that the linear operator does not show it: (…)."""
    return np.any(light > 1.0, axis=-1)


def encode_srgb(linear_light: FloatArray) -> ByteArray:
    """Linear light in [0, 1] as sRGB bytes (IEC 61966-2-1).

    >>> encode_srgb(np.array([0.0, 0.002, 0.18, 1.0]))
    array([  0,   7, 118, 255], dtype=uint8)
    """
    low = linear_light * 12.92
    high = 1.055 * np.maximum(linear_light, 0.0031308) ** (1.0 / 2.4) - 0.055
    encoded = np.where(linear_light <= 0.0031308, low, high)
    return (np.clip(encoded, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)


def decode_srgb(code: ByteArray) -> FloatArray:
    """Linear light in [0, 1] that sRGB bytes stand for."""
    encoded = code / 255.0
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def tone_map(rgb: FloatArray, factor: float = 1.0, tone: Tone = "reinhard", *, mark_clipped: bool = False) -> ByteArray:
    """Picture bytes of linear light.

    Parameters
    ----------
    rgb : ndarray (…, 3)
        Linear light, any unit.
    factor : float
        Exposure factor.
    tone : {"reinhard", "linear"}
    mark_clipped : bool
        Show what the linear operator cannot show in magenta.

    Returns
    -------
    ndarray of uint8 (…, 3)

    Raises
    ------
    ParameterError
        Unknown tone operator.
    """
    exposed = rgb * rgb.dtype.type(factor)
    if tone not in TONE_OPERATORS:
        raise ParameterError(f"tone {tone!r} is unknown; choose from {', '.join(TONES)}")
    codes = encode_srgb(TONE_OPERATORS[tone](exposed))
    if mark_clipped and tone == "linear":
        codes[clipped(exposed)] = CLIPPED_COLOUR
    return codes


def false_colour(values: FloatArray, low: float, high: float, *, logarithmic: bool = False) -> ByteArray:
    """Colours of numbers on a scale from low to high.

    Parameters
    ----------
    values : ndarray (…)
    low, high : float
        Ends of the scale; values outside take the colour of the end.
    logarithmic : bool
        Equal steps of colour are equal factors; `low` must be positive.

    Returns
    -------
    ndarray of uint8 (…, 3)

    Raises
    ------
    ParameterError
        A scale without length, or a logarithmic one that touches zero.
    """
    if not high > low or (logarithmic and not low > 0.0):
        kind = "logarithmic " if logarithmic else ""
        raise ParameterError(
            f"a {kind}scale cannot go from {low:g} to {high:g}; give 0 {'<' if kind else '≤'} low < high"
        )
    numbers = np.asarray(values, dtype=np.float64)
    if logarithmic:
        numbers, low, high = np.log(np.maximum(numbers, low)), math.log(low), math.log(high)
    place = np.clip((numbers - low) / (high - low), 0.0, 1.0) * (len(FALSE_COLOURS) - 1)
    stops = np.arange(len(FALSE_COLOURS))
    channels = [np.interp(place, stops, FALSE_COLOURS[:, c]) for c in range(3)]
    return (np.stack(channels, axis=-1) + 0.5).astype(np.uint8)


def diverging_colours(values: FloatArray, limit: float) -> ByteArray:
    """Colours of numbers on both sides of zero: blue below, grey at zero, orange above, full at ± `limit`.

    Blue and orange differ for every kind of colour vision.

    Parameters
    ----------
    values : ndarray (…)
    limit : float
        Positive.

    Returns
    -------
    ndarray of uint8 (…, 3)

    >>> diverging_colours(np.array([-2.0, 0.0, 1.0]), 1.0).tolist()
    [[33, 102, 214], [216, 216, 216], [230, 97, 1]]
    """
    share = np.clip(np.asarray(values, dtype=np.float64) / limit, -1.0, 1.0)
    channels = [np.interp(share, [-1.0, 0.0, 1.0], stops) for stops in zip(*DIVERGING, strict=True)]
    return (np.stack(channels, axis=-1) + 0.5).astype(np.uint8)


def round_up(value: float) -> float:
    """The next of 1, 2, 5, 10, 20, … that is not below a positive value.

    >>> round_up(0.3), round_up(20)
    (0.5, 20.0)
    """
    decade = 10.0 ** math.floor(math.log10(value))
    return float(f"{next(decade * f for f in (1, 2, 5, 10) if decade * f >= value * (1 - 1e-9)):.12g}")


def scale_ticks(low: float, high: float, *, logarithmic: bool = False, count: int = 5) -> list[float]:
    """Round numbers to print beside a scale, about `count` of them, all inside [low, high].

    >>> scale_ticks(0, 0.93)
    [0.0, 0.2, 0.4, 0.6, 0.8]
    >>> scale_ticks(0.02, 30, logarithmic=True)
    [0.1, 1.0, 10.0]
    """
    if logarithmic:
        first, last = math.ceil(math.log10(low) - 1e-9), math.floor(math.log10(high) + 1e-9)
        step = max(1, math.ceil((last - first + 1) / (count + 1)))
        decades = [10.0**power for power in range(first, last + 1, step)]
        return decades if len(decades) > 1 else scale_ticks(low, high, count=count)
    rough = (high - low) / count
    decade = 10.0 ** math.floor(math.log10(rough))
    step_size = next(decade * f for f in (1, 2, 2.5, 5, 10) if decade * f >= rough * (1 - 1e-9))
    ticks: Sequence[int] = range(math.ceil(low / step_size - 1e-9), math.floor(high / step_size + 1e-9) + 1)
    return [float(f"{tick * step_size:.12g}") for tick in ticks]
