"""What the lectures tell is true: of light computed anew, and coarser, for the test."""

import numpy as np
import pytest

import radiosity as rad
from radiosity.lectures import Place, Talk, bounces, find, mean, on
from radiosity.lectures.pinhole import GOAL, races

SMALL = 350


@pytest.fixture(scope="module")
def numbers():
    """The numbers of a lecture, its light computed once."""
    talks: dict[str, Talk] = {}

    def of(name: str) -> dict:
        if name not in talks:
            talks[name] = Talk.prepare(find(name), SMALL)  # fills every text
        return dict(talks[name].numbers) | {"talk": talks[name]}

    return of


def test_equation(numbers) -> None:
    """B = ρ H, L = B / π, the row closes, the cosine of 60° is a half."""
    said = numbers("equation")
    assert said["product"] == pytest.approx(said["B"], rel=2e-3)  # ten bounces of it
    assert said["L"] == pytest.approx(said["B"] / np.pi)
    assert said["closure"] == pytest.approx(1, abs=1e-6)
    assert said["at_60"] == pytest.approx(0.5, abs=0.02)
    assert said["lamp_share"] < 0.02
    assert 0.6 < said["lamp_part"] < 0.85


def test_dome(numbers) -> None:
    """Irradiance π L_i, exitance ρ times that, radiance ρ L_i; and not so beside a wall."""
    said = numbers("dome")
    assert (said["H"], said["B"], said["L"], said["white_L"]) == pytest.approx((np.pi, np.pi / 2, 0.5, 1.0), rel=1e-6)
    assert said["darkest"] == pytest.approx(said["brightest"], rel=1e-6)
    assert 0.45 < said["near_blue"] < said["near_red"] < 0.85
    assert 0.95 < said["far_blue"] < said["far_red"] < 1


def test_rug(numbers) -> None:
    """The ceiling has no direct light, most of the rug's red, and is redder than the wall."""
    said = numbers("rug")
    assert said["direct_ceiling"] == 0
    assert said["wall_1"] == pytest.approx(1, abs=1e-6)
    assert said["to_ceiling"] > 1.2 * said["to_wall"]
    assert said["rug_red"] > 5 * said["rug_blue"]
    assert said["sum_ceiling"] > said["sum_wall"] > 1.2 > said["white_ceiling"] > 1
    assert said["brighter_blue"] > 3 * said["brighter_red"] > 0.3


def test_series(numbers) -> None:
    """Furnaces as by hand; norms fall though two patches in five grow."""
    said = numbers("series")
    assert said["sum_half"] == pytest.approx(2, rel=1e-6)
    assert said["missing_half"] == pytest.approx(0.5**11, rel=1e-6)
    assert said["missing_bright"] == pytest.approx(0.95**11, rel=1e-6)
    assert (said["need_half"], said["need_bright"], said["need_999"]) == (6, 89, 4602)
    assert 0.35 < said["grows"] < 0.48
    assert said["ratio_2"] < said["ratio_last"] < 0.65


def test_darker_paint_makes_each_bounce_a_power_smaller(numbers) -> None:
    """What the last step of `series` says of its slider."""
    box = numbers("series")["talk"].solutions["box"]
    darker = box.relight(reflectance=0.5 * box.patches.reflectance)
    powers = 0.5 ** np.arange(len(bounces(box)))
    np.testing.assert_allclose(bounces(darker), powers[:, None, None] * bounces(box), rtol=1e-9, atol=1e-15)


def test_hemicube(numbers) -> None:
    """Rows add up to 1 with the open front, exchange is mutual, more pixels are better."""
    said = numbers("hemicube")
    assert said["hemicube_sum"] + said["sky"] == pytest.approx(1, abs=0.01)
    assert said["solver_sum"] + said["sky"] == pytest.approx(1, abs=1e-5)
    assert said["G"] == pytest.approx(said["G_back"], rel=0.1)
    assert said["shadow_lamp"] < 0.3 * said["lamp"]
    assert said["fine"] < 0.5 * said["coarse"]


def test_noise(numbers) -> None:
    """Errors fall as the root of the number of paths; low-discrepancy rays are better, and better yet with more."""
    said = numbers("noise")
    assert said["slope"] == pytest.approx(0.5, abs=0.06)
    assert said["second"] / said["first"] == pytest.approx(0.5, abs=0.1)
    assert said["ceiling"] > 1.5 * said["floor"]
    assert said["sobol"] < 0.8 * said["random"]
    assert said["sobol_slope"] > said["random_slope"] + 0.02


def test_pinhole(numbers) -> None:
    """The second room is late, and fades by less than ρ; both together by exactly ρ. Conjugate gradients win."""
    said = numbers("pinhole")
    assert said["peak_2"] >= 3
    assert said["mean_2"] > said["mean_1"] + 2
    assert said["share_2"] < 0.3 * said["share_2_door"]
    assert said["late_1"] < 0.9 < said["late_2"]
    hole = said["talk"].solutions["hole"]
    power = np.einsum("n,kn->k", hole.patches.area, bounces(hole)[..., 0])
    np.testing.assert_allclose(power[2:] / power[1:-1], 0.9, rtol=1e-6)
    assert said["ConjugateGradient"] * 4 < said["Shooting"] < said["GaussSeidel"] <= said["Neumann"] + 2


def test_a_race_ends_at_the_goal_and_counts_every_product(numbers) -> None:
    """Against each solver's own account of a solve to the residual that it had at the goal."""
    hole = numbers("pinhole")["talk"].solutions["hole"]
    T = rad.TransportOperator(hole.factors, hole.patches)
    truth = rad.Direct().solve(T, hole.emission).radiosity
    for name, run in races(hole).items():
        assert run.error[-1] <= GOAL < run.error[-2]
        assert np.all(np.diff(run.products) > 0)
        assert np.all(np.diff(run.seconds) > 0)
        steps = 4 * (len(run.error) - 1) if name == "ConjugateGradient" else len(run.error) - 1
        result = getattr(rad, name)(rtol=0.0, maxiter=steps).solve(T, hole.emission)
        counted = result.statistics["solver/products"] + result.statistics.get("solver/shots", 0) / len(hole.patches)
        assert run.products[-1] == pytest.approx(counted, abs=1)
        error = T.norm(result.radiosity - truth)[0] / T.norm(truth - hole.emission)[0]
        assert run.error[-1] == pytest.approx(error, rel=1e-3)


def test_shortcuts(numbers) -> None:
    """The best constant has the right mean, a cut series is too dark, without the cosine rows add up to 2."""
    said = numbers("shortcuts")
    assert said["ambient_mean"] == pytest.approx(1, abs=1e-6)
    assert said["row_sum"] == pytest.approx(2, abs=0.01)
    assert said["radius"] > 1
    assert 0 < said["cut_missing"] < said["missing"] < 0.4
    assert said["shadow"] > 5
    assert said["ambient_dark"] > 1.5


def test_daylight(numbers) -> None:
    """The back of the room lives of bounces, and white paint is worth several times the light."""
    said = numbers("daylight")
    assert said["dark_patches"] == 1
    assert said["far_direct"] < 0.3 < said["near_direct"]
    assert said["gain"] > 4
    assert said["paint_gain"] > 3
    assert said["far_sky"] < said["dark_desk"] < said["far_desk"] < said["near_desk"]


def test_every_plot_can_be_drawn(numbers) -> None:
    for name in ("equation", "dome", "rug", "series", "pinhole", "daylight"):
        talk = numbers(name)["talk"]
        drawn = [talk.figure(place) for place in Place(talk.lecture).all()]
        for figure in filter(None, drawn):
            (axes,) = figure.axes
            assert axes.get_xlabel()
            assert all(len(line.get_xdata()) for line in axes.lines)
        assert any(drawn), name


def test_means_are_over_area() -> None:
    room = rad.solve(rad.scenes.red_rug(), patch_count=60, bounces=1)
    light = np.arange(len(room.patches), dtype=float)
    there = on(room, "rug", "floor")
    area = room.patches.area
    assert mean(room, light, "rug", "floor") == pytest.approx((light * area)[there].sum() / area[there].sum())
    assert mean(room, light) == pytest.approx((light * area).sum() / area.sum())
    with pytest.raises(rad.errors.ParameterError, match="there is no surface carpet; there are floor"):
        on(room, "carpet")
