"""Errors, exponents, fronts: against numbers that are known."""

from __future__ import annotations

import numpy as np
import pytest

from radiosity.study.fits import cost_exponent, exponent
from radiosity.study.fronts import cheapest, pareto, sentences
from radiosity.study.measures import Light, errors


def light(patches=50, orders=4, seed=0):
    series = np.random.default_rng(seed).random((orders, patches, 3)) * 0.5 ** np.arange(orders)[:, None, None]
    return Light(series.sum(axis=0), series)


def test_the_error_of_light_that_is_too_bright_by_a_share_is_that_share():
    true = light()
    emission = true.orders[0]
    found = Light(emission + 1.1 * (true.radiosity - emission), np.concatenate([emission[None], 1.1 * true.orders[1:]]))
    measured = errors(found, true, np.random.default_rng(1).random(50))
    assert (measured.l2, measured.maximum, measured.median, measured.p95) == pytest.approx((0.1,) * 4)
    assert measured.by_order == pytest.approx((0.1,) * 3)


def test_one_wrong_patch_of_a_hundred_weighs_by_its_area():
    true, area = light(100), np.ones(100)
    area[7] = 4.0
    wrong = true.radiosity.copy()
    wrong[7] = true.orders[0][7]  # gets no light at all
    measured = errors(Light(wrong, true.orders), true, area)
    got = np.sum(area[:, None] * (true.radiosity - true.orders[0]) ** 2, axis=1)
    assert measured.l2 == pytest.approx(np.sqrt(got[7] / got.sum()))
    assert (measured.maximum, measured.median, measured.p95) == (pytest.approx(1.0), 0.0, 0.0)
    assert measured.by_order == (0.0, 0.0, 0.0)


def test_dark_orders_and_dark_scenes():
    orders = np.zeros((3, 5, 1))
    orders[0] = orders[1] = 1.0
    true = Light(orders.sum(axis=0), orders)
    assert errors(true, true, np.ones(5)).by_order == (0.0, None)
    black = Light(np.zeros((5, 1)), np.zeros((3, 5, 1)))
    assert errors(black, black, np.ones(5)).l2 == 0.0
    assert errors(true, black, np.ones(5)).l2 == np.inf


@pytest.mark.parametrize("power", [-0.5, -0.66, 1.0, 2.0])
def test_an_exponent_is_found_within_its_error(power):
    """Two thirds of standard errors hold the truth; of 300 fits, that is 200 ± 8."""
    rng = np.random.default_rng(0)
    x = np.repeat([1.0, 4.0, 16.0, 64.0], 3)
    fits = [exponent(x, x**power * np.exp(0.1 * rng.normal(size=12))) for _ in range(300)]
    inside = np.mean([abs(fit.value - power) < fit.error for fit in fits])
    assert 0.58 < inside < 0.74  # Student's t of ten degrees of freedom: 0.659
    assert np.mean([fit.value for fit in fits]) == pytest.approx(power, abs=0.005)


def test_too_few_places_are_no_fit():
    assert exponent([1, 1, 2, 2], [1.0, 1.1, 2.0, 2.1]) is None
    assert exponent([1, 2, 4], [1.0, 2.0, 0.0]) is None


def test_a_run_that_is_only_repeated_says_nothing_new():
    once = exponent([1, 2, 4, 8], [1.0, 2.1, 3.8, 8.3])
    assert exponent([1, 2, 4, 8] * 3, [1.0, 2.1, 3.8, 8.3] * 3) == once
    assert once.error > 0.02


def test_the_cost_of_one_error_grows_by_both_error_and_time():
    """Error ∝ x rays^-½, seconds ∝ √x rays: rays have to grow as x², so the time as x^2.5."""
    x, rays = (grid.ravel() for grid in np.meshgrid([1.0, 2.0, 4.0, 8.0], [16.0, 64.0, 256.0]))
    fit = cost_exponent(list(x), list(rays), list(x * rays**-0.5), list(np.sqrt(x) * rays))
    assert fit.value == pytest.approx(2.5)
    assert fit.error < 1e-6
    assert cost_exponent(list(x), list(rays), list(x), list(rays)) is None  # never converges


def row(family, seconds, error, **more):
    return {
        "family": family, "budget": "64 rays", "patches": 100, "seconds": seconds, "bytes_peak": 5e6,
        "total_l2": error, "total_l2_most": 1.1 * error, **more,
    }  # fmt: skip


def test_nothing_on_the_front_is_beaten_and_all_else_is():
    rng = np.random.default_rng(0)
    rows = [row("apart", *pair) for pair in rng.random((200, 2))]
    front = pareto(rows, "seconds", "total_l2")

    def beaten(one):
        return any(
            other["seconds"] <= one["seconds"] and other["total_l2"] <= one["total_l2"] and other is not one
            for other in rows
        )

    assert 2 < len(front) < 20
    assert {id(one) for one in front} == {id(one) for one in rows if not beaten(one)}


def test_the_best_method_is_the_cheapest_whose_worst_run_is_good_enough():
    rows = [row("random", 0.1, 0.095), row("apart", 0.5, 0.04), row("hemicube", 2.0, 0.02)]
    assert list(cheapest(rows, 0.1)) == ["apart", "hemicube"]  # the worst random run is 10.45 % off
    said = sentences(rows)
    assert said[0].startswith("To 10 %: Monte Carlo, direct light apart, 64 rays on 100 patches, in 0.5 s and 5 MB")
    assert "hemicube (64 rays) takes 4.0 × as long; not reached by: random rays." in said[0]
    assert said[-1] == "To 2 %: nothing that was run gets there."
