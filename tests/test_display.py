"""Light becomes bytes: exposure, tone operators, sRGB, false colour."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radiosity import display
from radiosity.errors import ParameterError

# Linear value → sRGB byte, by IEC 61966-2-1 in exact arithmetic.
SRGB = {0.0: 0, 0.0031308: 10, 0.01: 25, 0.18: 118, 0.5: 188, 0.9: 243, 1.0: 255}


def patches(seed: int = 1, count: int = 200) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    return rng.lognormal(size=(count, 3)), rng.uniform(0.1, 1.0, size=count)


def test_srgb_against_the_standard() -> None:
    assert display.encode_srgb(np.array(list(SRGB))).tolist() == list(SRGB.values())


def test_every_byte_survives_decoding_and_encoding() -> None:
    codes = np.arange(256, dtype=np.uint8)
    assert np.array_equal(display.encode_srgb(display.decode_srgb(codes)), codes)


def test_float32_and_float64_give_the_same_bytes() -> None:
    light, _ = patches(count=5000)
    single = display.tone_map(light.astype(np.float32)).astype(int)
    assert np.abs(single - display.tone_map(light)).max() <= 1
    assert np.mean(single != display.tone_map(light)) < 1e-3


@given(st.floats(1e-30, 1e12))
def test_reinhard_stays_below_one_and_keeps_order(light: float) -> None:
    pressed = display.reinhard(np.array([light, light * 1.01]))
    assert 0.0 <= pressed[0] <= pressed[1] <= 1.0
    assert pressed[0] == pytest.approx(light / (1 + light), rel=1e-12)


def test_light_beyond_the_screen_never_wraps_around() -> None:
    light = np.array([[1e9, 1e3, 2.0]])
    assert display.tone_map(light, tone="linear").tolist() == [[255, 255, 255]]
    assert display.tone_map(light, tone="reinhard").min() > 200


def test_clipped_marks_exactly_what_linear_cannot_show() -> None:
    light = np.array([[0.2, 0.2, 0.2], [0.2, 1.01, 0.2], [1.0, 1.0, 1.0]])
    assert display.clipped(light).tolist() == [False, True, False]
    codes = display.tone_map(light, tone="linear", mark_clipped=True)
    assert codes[1].tolist() == list(display.CLIPPED_COLOUR)
    assert codes[0].tolist() == [124] * 3
    assert codes[2].tolist() == [255] * 3


def test_unknown_tone_operator_is_refused_by_name() -> None:
    with pytest.raises(ParameterError, match="'filmic' is unknown; choose from reinhard, linear"):
        display.tone_map(np.ones((1, 3)), tone="filmic")  # type: ignore[arg-type]


def test_one_stop_doubles_the_light() -> None:
    assert display.exposure_factor(1.0) == 2.0
    assert display.exposure_value(display.exposure_factor(-3.25)) == -3.25


@pytest.mark.parametrize(
    ("factor", "text"),
    [
        (1.0, "×1, +0.0 EV"),
        (0.99, "×0.99, +0.0 EV"),
        (453, "×453, +8.8 EV"),
        (0.5, "×0.5, −1.0 EV"),
        (2e6, "×2.0·10⁶, +20.9 EV"),
    ],
)
def test_factors_are_printed_with_their_exposure_value(factor: float, text: str) -> None:
    assert display.factor_text(factor) == text


@given(st.floats(1e-9, 1e9))
def test_automatic_exposure_undoes_a_change_of_the_lamp(dimmer: float) -> None:
    light, area = patches()
    assert display.automatic_factor(light * dimmer, area) * dimmer == pytest.approx(
        display.automatic_factor(light, area), rel=1e-12
    )


def test_automatic_exposure_shows_the_middle_of_the_lit_area() -> None:
    light = np.array([[0.0] * 3, [1.0] * 3, [2.0] * 3, [100.0] * 3])
    area = np.array([50.0, 1.0, 1.5, 1.0])
    assert display.reference_level(light, area) == pytest.approx(2.0)
    assert display.automatic_factor(light, area) * 2.0 == pytest.approx(display.MIDDLE)
    assert display.automatic_factor(np.zeros((4, 3)), area) == 1.0


def test_channels_other_than_three_are_grey() -> None:
    spectrum = np.array([[0.0, 1.0, 2.0, 5.0]])
    assert display.as_rgb(spectrum).tolist() == [[2.0, 2.0, 2.0]]
    assert display.as_rgb(np.array([[3.0]])).tolist() == [[3.0] * 3]
    assert display.as_rgb([[1, 2, 3]]).tolist() == [[1.0, 2.0, 3.0]]


def test_white_has_luminance_one() -> None:
    assert display.luminance(np.ones(3)) == pytest.approx(1.0, abs=1e-15)
    assert display.luminance(np.array([0.0, 1.0, 0.0])) == 0.7152


def lightness(codes: np.ndarray) -> np.ndarray:
    """CIE L* of sRGB bytes."""
    relative = display.luminance(display.decode_srgb(codes))
    return np.where(relative > 0.008856, 116 * np.cbrt(relative) - 16, 903.3 * relative)


def test_false_colour_rises_in_lightness_without_a_step() -> None:
    """What makes a scale readable in grey, and for the colour-blind."""
    steps = np.diff(lightness(display.false_colour(np.linspace(0, 1, 101), 0, 1)))
    assert steps.min() > 0.3
    assert steps.max() < 1.5


def test_false_colour_scales() -> None:
    ends = display.FALSE_COLOURS[[0, 8, 16]].astype(int).tolist()
    assert display.false_colour(np.array([-5.0, 1.0, 99.0]), 0.0, 2.0).tolist() == ends
    assert display.false_colour(np.array([0.0, 1.0, 100.0]), 0.01, 100.0, logarithmic=True).tolist() == ends


@pytest.mark.parametrize(("low", "high", "logarithmic"), [(1.0, 1.0, False), (2.0, 1.0, False), (0.0, 1.0, True)])
def test_impossible_scales_are_refused(low: float, high: float, logarithmic: bool) -> None:
    with pytest.raises(ParameterError, match="scale cannot go from"):
        display.false_colour(np.ones(3), low, high, logarithmic=logarithmic)


@given(st.floats(-1e3, 1e3), st.floats(1e-6, 1e6))
def test_ticks_are_round_and_inside(lengths: float, length: float) -> None:
    low = lengths * length
    ticks = display.scale_ticks(low, low + length)
    assert 1 <= len(ticks) <= 8
    assert all(low - 1e-6 * length <= tick <= low + length * (1 + 1e-6) for tick in ticks)


@given(st.floats(1e-12, 1e12))
def test_rounding_up_never_loses_and_never_more_than_doubles_and_a_half(value: float) -> None:
    assert value * (1 - 1e-8) <= display.round_up(value) <= 2.5 * value * (1 + 1e-8)


def test_diverging_colours_tell_the_sides_apart() -> None:
    codes = display.diverging_colours(np.linspace(-2, 2, 41), 2.0).astype(int)
    assert np.all(np.diff(codes[:21, 0]) > 0)  # from blue
    assert np.all(np.diff(codes[20:, 2]) < 0)  # to orange
    assert np.ptp(codes[20]) == 0
