"""Other light and paint by slider is what `relight` gives, bounce by bounce, on the exposure that it had."""

import numpy as np
import pytest

import radiosity as rad
from radiosity.viewer.changes import LARGEST_REFLECTANCE, Changes, Sliders, next_surface, relit
from radiosity.viewer.model import Model
from radiosity.viewer.state import Series


@pytest.fixture(scope="module")
def model(solution: rad.Solution) -> Model:
    return Model(solution, Series.of(solution))


def test_the_same_light_as_relight(solution: rad.Solution, model: Model) -> None:
    lamp = next(s.material for s in solution.scene.surfaces if s.name == "lamp")
    wall = next(s.material for s in solution.scene.surfaces if s.name == "red_wall")
    changes = Changes().emitting("lamp", 2.0 * float(lamp.emission.mean())).painted("red_wall", 0.1)
    found, series = model.lit(changes)
    paint = wall.reflectance * 0.1 / wall.reflectance.mean()
    expected = solution.relight(emission={"lamp": 2.0 * lamp.emission}, reflectance={"red_wall": paint})
    np.testing.assert_allclose(found.orders, expected.orders, rtol=1e-12)
    np.testing.assert_allclose(series.orders, expected.orders, rtol=1e-6)
    assert series.common == model.series.common
    assert series.last == model.series.last


def test_twice_the_lamp_is_twice_the_light(solution: rad.Solution, model: Model) -> None:
    lamp = Sliders.of(solution.scene, Changes())
    assert lamp.surface == "lamp"
    found, _ = model.lit(Changes().emitting("lamp", 2.0 * lamp.emission))
    np.testing.assert_allclose(found.radiosity, 2.0 * solution.radiosity, rtol=1e-9)
    dark, series = model.lit(Changes().emitting("lamp", 0.0))
    assert not dark.radiosity.any()
    assert np.all(series.own == 1.0)


def test_unchanged_light_is_the_solution_itself(solution: rad.Solution, model: Model) -> None:
    assert model.lit(Changes("floor")) == (solution, model.series)
    assert relit(solution, Changes("floor"), 3) is solution


def test_the_last_change_is_kept(model: Model) -> None:
    changes = Changes().painted("floor", 0.2)
    assert model.lit(changes)[0] is model.lit(changes.on("lamp"))[0]


def test_black_paint_becomes_grey_and_a_wall_a_lamp(solution: rad.Solution, model: Model) -> None:
    scene = solution.relight(reflectance={"floor": [0.0, 0.0, 0.0]}).scene
    held = Sliders.of(scene, Changes("floor"))
    assert (held.reflectance, held.most_reflectance) == (0.0, LARGEST_REFLECTANCE)
    found, _ = model.lit(Changes().emitting("floor", 4.0))
    floor = solution.patches.surface == solution.patches.surface_names.index("floor")
    assert np.all(found.emission[floor] == 4.0)


@pytest.mark.parametrize("surface", ["floor", "red_wall", "lamp"])
def test_sliders_reach_no_paint_that_there_cannot_be(solution: rad.Solution, surface: str) -> None:
    held = Sliders.of(solution.scene, Changes(surface))
    changes = held.lighter(Changes(surface), 100)
    paint = relit(solution, changes, 2).patches.reflectance
    mine = solution.patches.surface == solution.patches.surface_names.index(surface)
    assert paint[mine].max() == pytest.approx(LARGEST_REFLECTANCE)
    assert Sliders.of(solution.scene, held.lighter(changes, -100)).reflectance == 0.0
    assert Sliders.of(solution.scene, held.brighter(changes, -100)).emission == 0.0
    most = held.brighter(changes, 100)
    assert dict(most.emission)[surface] == held.most_emission > 0.0


def test_going_through_the_surfaces(solution: rad.Solution) -> None:
    names = [surface.name for surface in solution.scene.surfaces]
    changes, seen = Changes(), []
    for _ in names:
        changes = next_surface(solution.scene, changes)
        seen.append(changes.surface)
    assert sorted(seen) == sorted(names)
    assert changes.painted("floor", 0.3).undone() == Changes("floor")
    assert not changes
    assert changes.painted("floor", 0.3)


def test_a_solver_without_bounces_gets_bounces() -> None:
    other = rad.solve(
        rad.scenes.cornell_box(),
        patch_count=100,
        estimator=rad.MonteCarlo(rays=64, light_rays=None),
        solver=rad.GaussSeidel(),
    )
    series = Series.of(other)
    found, lit = Model(other, series).lit(Changes().painted("floor", 0.2))
    assert len(found.orders) == series.last + 1 == lit.last + 1
