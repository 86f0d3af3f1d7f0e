"""What the lecture on the Cornell box tells is true of the light that it shows."""

import numpy as np
import pytest

import radiosity as rad
from radiosity.display import luminance
from radiosity.lectures import find


@pytest.fixture(scope="module")
def orders(solution: rad.Solution) -> np.ndarray:
    assert solution.orders is not None
    return solution.orders


def of(solution: rad.Solution, name: str) -> np.ndarray:
    return solution.patches.surface == solution.patches.surface_names.index(name)


def test_ceiling_is_black_at_order_1_and_brighter_than_the_floor_at_order_2(solution, orders) -> None:
    ceiling, floor = of(solution, "ceiling"), of(solution, "floor")
    assert orders[1][ceiling].max() == 0.0
    assert luminance(orders[2][ceiling]).mean() > luminance(orders[2][floor]).mean()


def test_two_patches_in_five_receive_more_from_the_second_bounce(orders) -> None:
    grows = luminance(orders[2]) > luminance(orders[1])
    assert 0.33 < np.mean(grows) < 0.47


def test_block_sides_take_the_colour_of_the_wall_they_face(solution, orders) -> None:
    sides = of(solution, "tall_block") | of(solution, "short_block")
    centre = solution.patches.centroid
    to_red = np.sign(centre[of(solution, "red_wall"), 0].mean() - centre[of(solution, "green_wall"), 0].mean())
    facing_red = to_red * solution.patches.normal[:, 0]
    red, green = (orders[2][sides & there].sum(axis=0) for there in (facing_red > 0.8, facing_red < -0.8))
    lamp = orders[0].sum(axis=0)
    assert red[0] / red[1] > 2.5 * lamp[0] / lamp[1]
    assert green[1] / green[0] > 1.3 * lamp[1] / lamp[0]


def test_blue_dies_first_and_the_terms_shrink_by_a_steady_factor(solution) -> None:
    power = solution.power
    shrink = power[1:] / power[:-1]
    assert np.all(shrink[2:, 2] < shrink[2:, 0])
    assert shrink[-1, 0] == pytest.approx(shrink[-2, 0], rel=0.05)


def test_sum_hardly_changes_after_six_bounces(solution, orders) -> None:
    total = orders.sum(axis=0)
    lit = ~(solution.patches.emission.any(axis=1))
    missing = luminance(orders[6][lit]) / luminance(total[lit])
    assert np.median(missing) < 0.03


def test_the_steps_show_what_they_speak_of() -> None:
    steps = {step.title: step for step in find("cornell").steps}
    assert steps["One bounce: direct light"].reveal["order"] == 1
    assert steps["Two bounces"].reveal["order"] == 2
    assert steps["Many bounces"].show == {"order": 8, "normalised": True}
