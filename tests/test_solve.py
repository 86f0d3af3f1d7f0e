"""The whole way from a scene to its light."""

import time
import warnings
from dataclasses import replace

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import ParameterError, UnlitSceneWarning
from radiosity.solvers import Solver

DARK = rad.Material(reflectance=[0.5, 0.5, 0.5])


def small(scene, **settings):
    return rad.solve(scene, **{"patch_count": 150, "estimator": rad.MonteCarlo(rays=64), **settings})


@pytest.mark.parametrize("reflectance", [0.2, 0.5, 0.9])
@pytest.mark.parametrize("estimator", [rad.MonteCarlo(rays=64), rad.Hemicube(resolution=8)])
def test_furnace_by_order(reflectance, estimator):
    scene = rad.scenes.furnace(reflectance=reflectance, emission=3.0)
    solution = rad.solve(scene, patch_count=150, estimator=estimator, solver=rad.Neumann(rtol=1e-13), dtype=np.float64)

    k = np.arange(len(solution.orders))
    np.testing.assert_allclose(solution.orders[:, :, 0], np.outer(3.0 * reflectance**k, np.ones(150)), rtol=1e-12)
    np.testing.assert_allclose(solution.radiosity, 3.0 / (1.0 - reflectance), rtol=1e-12)
    assert solution.converged
    assert solution.status.startswith("converged")


def test_it_is_the_steps_a_user_would_write():
    scene = rad.scenes.cornell_box()
    solution = small(scene)

    patches = rad.subdivide(scene, patch_count=150)
    factors = rad.form_factors(patches, rad.MonteCarlo(rays=64))
    result = rad.Neumann(rtol=1e-6).solve(rad.TransportOperator(factors, patches), patches.emission, patches.sky)
    assert solution.radiosity.tobytes() == result.radiosity.tobytes()
    assert solution.orders.tobytes() == result.orders.tobytes()


@pytest.mark.parametrize("bounces", [0, 1, 4])
def test_a_cut_series_says_what_is_left_out(bounces):
    solution = small(rad.scenes.furnace(reflectance=0.5, emission=1.0), bounces=bounces)

    np.testing.assert_allclose(solution.orders[:, 0, 0], 0.5 ** np.arange(bounces + 1), rtol=1e-6)
    np.testing.assert_allclose(solution.radiosity, 2.0 - 0.5**bounces, rtol=1e-6)
    np.testing.assert_allclose(solution.result.history[-1], 0.5 ** (bounces + 1), rtol=1e-6)
    assert not solution.converged
    assert f"cut at {bounces} bounces" in solution.status
    assert f"{0.5 ** (bounces + 1):.2g} of the source" in solution.status


def test_bounces_count_whatever_the_tolerance():
    """Whoever asks for 30 bounces gets 30, though 20 would have met the tolerance, and is told that it was met."""
    solution = small(rad.scenes.furnace(reflectance=0.5), bounces=30)

    assert len(solution.orders) == 31
    assert solution.converged
    assert solution.status.startswith("converged: 30 bounces were asked for")


def test_no_more_bounces_than_there_is_light():
    black = rad.scenes.furnace(reflectance=0.0, emission=1.0)
    solution = small(black, bounces=8)
    assert solution.orders.shape == (1, len(solution.patches), 1)
    assert solution.radiosity.tobytes() == solution.emission.tobytes()


def test_too_few_steps_are_not_called_converged():
    solution = small(rad.scenes.furnace(reflectance=0.9), solver=rad.Neumann(rtol=1e-6, maxiter=3))
    assert not solution.converged
    assert "not converged after 3 bounces" in solution.status
    assert "maxiter" in solution.status


def test_bounces_need_a_series():
    class Gauss(Solver):
        """Any solver that is not the series."""

    with pytest.raises(ParameterError, match=r"bounces is 3, but Gauss does not go by bounces; use Neumann"):
        small(rad.scenes.furnace(), solver=Gauss(), bounces=3)
    with pytest.raises(ParameterError, match="bounces is -1"):
        small(rad.scenes.furnace(), bounces=-1)


def test_a_scene_without_light_is_black_and_says_so():
    scene = rad.scenes.furnace(emission=0.0)
    with pytest.warns(UnlitSceneWarning, match=r"'furnace' has no light.*--sky.*--lamp SURFACE=") as caught:
        solution = small(scene)
    assert len(caught) == 1
    assert caught[0].filename == __file__  # the warning points at who called
    assert not solution.radiosity.any()
    assert solution.converged


def test_a_sky_is_light():
    scene = replace(rad.scenes.cornell_box(), sky=[1.0, 2.0, 3.0])
    dark = replace(scene, surfaces=tuple(replace(s, material=DARK) for s in scene.surfaces))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        solution = small(dark)
    assert not solution.orders[0].any()
    assert (solution.power[1] > 0).all()
    np.testing.assert_allclose(solution.radiosity[:, 1], 2.0 * solution.radiosity[:, 0], rtol=1e-12)


def test_patches_by_size_or_count():
    by_size = small(rad.scenes.furnace(), patch_count=None, patch_size=0.26)
    assert len(by_size.patches) == 6 * 4 * 4
    with pytest.raises(ParameterError, match="not both"):
        small(rad.scenes.furnace(), patch_size=0.25)


@pytest.mark.slow
def test_without_a_size_there_are_ten_thousand_patches():
    solution = rad.solve(rad.scenes.furnace(), estimator=rad.MonteCarlo(rays=4), bounces=1)
    assert 0.85e4 <= len(solution.patches) <= 1.15e4
    assert solution.settings["patch_count"] == 10_000


def test_same_bits_for_any_number_of_threads():
    one, two = (small(rad.scenes.red_rug(), threads=threads) for threads in (1, 2))
    assert one.orders.tobytes() == two.orders.tobytes()


def test_progress_goes_through_the_stages_to_the_end():
    told = []
    small(rad.scenes.red_rug(), progress=lambda *words: told.append(words))

    stages = [stage for stage, _, _ in told]
    assert sorted(set(stages), key=stages.index) == ["patches", "form factors", "bounces"]
    assert sorted(stages, key=["patches", "form factors", "bounces"].index) == stages
    for stage in set(stages):
        done = [(d, total) for s, d, total in told if s == stage]
        assert [d for d, _ in done] == sorted(d for d, _ in done)
        assert all(d <= total for d, total in done)
        assert done[-1][0] == done[-1][1]


@pytest.mark.parametrize("stage", ["patches", "form factors", "bounces"])
def test_an_interrupt_ends_the_work(stage):
    def interrupt(now, done, total):  # noqa: ARG001
        if now == stage:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        small(rad.scenes.red_rug(), progress=interrupt)


def test_seconds_of_each_stage_are_kept():
    began = time.perf_counter()
    solution = small(rad.scenes.furnace())
    elapsed = time.perf_counter() - began

    seconds = {name: s for name, s in solution.statistics.items() if name.startswith("seconds/")}
    assert list(seconds) == [
        "seconds/patches",
        "seconds/plan",
        "seconds/ray tree",
        "seconds/form factors",
        "seconds/solve",
    ]
    assert all(s > 0 for s in seconds.values())
    assert 0.1 * elapsed < sum(seconds.values()) < elapsed
