"""What a scene does not need is left out, and the light is the same: for each item, a scene with it and one without."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import FormFactorError
from radiosity.plan import make_plan, two_levels
from radiosity.plan.channels import find_alike
from radiosity.scenes.build import room
from tests.plan.scenes import GREY, LAMP, black_dome, flat, nested_boxes, thin_walls, two_flats

RAYS = rad.MonteCarlo(rays=64, replicates=2)


def planned(scene, count=300, **settings):
    return rad.plan(scene, patch_count=count, estimator=RAYS, **settings)


def both(scene, count=300, **settings):
    """Solved with and without leaving anything out, float32 and the same method."""
    known = {"patch_count": count, "estimator": RAYS, "dtype": np.float32, "solver": rad.Neumann(), **settings}
    return rad.solve(scene, **known), rad.solve(scene, leave_out=False, **known)


def relative(found, true, area):
    return np.sqrt((area[:, None] * (found - true) ** 2).sum() / (area[:, None] * true**2).sum())


def assert_same_bits(one, other):
    assert one.radiosity.tobytes() == other.radiosity.tobytes()
    assert one.orders.tobytes() == other.orders.tobytes()
    assert one.irradiance.tobytes() == other.irradiance.tobytes()
    assert one.balance.missing.tobytes() == other.balance.missing.tobytes()


# Rows


@pytest.mark.parametrize(
    ("make", "item"),
    [
        (two_flats, "dark patches"),
        (thin_walls, "empty sides"),
        (nested_boxes, "sides that see backs"),
        (black_dome, "black receivers"),
    ],
)
def test_rows_are_left_out_and_the_light_has_the_same_bits(make, item):
    some, everything = both(make())
    assert some.plan[item].left_out
    assert not everything.plan[item].left_out
    assert some.statistics["rays/traced"] == 64 * some.plan.rows.made.sum() < everything.statistics["rays/traced"]
    assert_same_bits(some, everything)
    lit = rad.Scene([*flat(0), LAMP])
    assert not planned(lit)[item].left_out


def test_a_dark_flat_is_exactly_black_and_never_traced():
    some, everything = both(two_flats())
    names = [some.patches.surface_names[s] for s in some.patches.surface[some.plan.dark]]
    assert set(names) == {"block", *("dark " + s.name for s in room((0, 0, 0), (1, 1, 1), GREY))}
    assert not some.radiosity[some.plan.dark].any()
    assert everything.radiosity[~some.plan.dark].min() > 0
    made = some.__dict__["made_factors"]
    told = some.irradiance, some.balance, some.certificate, str(some)  # none of them needs a row of the dark
    assert not told[0][some.plan.dark].any()
    assert "whole_factors" not in some.__dict__
    with pytest.raises(
        FormFactorError, match=r"row \d+ was left out, as no light depends on it: take Solution.factors"
    ):
        made.row(int(np.flatnonzero(some.plan.dark)[0]))


@pytest.mark.parametrize("make", [two_flats, black_dome, nested_boxes])
def test_factors_are_whole_when_they_are_asked_for(make):
    some, everything = both(make())
    assert some.__dict__["made_factors"].left_out is not None
    for one, other in zip(
        (some.factors, *some.factors.replicates), (everything.factors, *everything.factors.replicates), strict=True
    ):
        assert one.left_out is None
        assert (one.matrix != other.matrix).nnz == 0
        assert one.to_sky.tobytes() == other.to_sky.tobytes()
        assert one.to_backs.tobytes() == other.to_backs.tobytes()
    assert some.factors is some.factors
    assert some.factors.statistics["rays/traced"] == everything.statistics["rays/traced"]


def test_other_light_gets_the_rows_that_it_needs():
    """The dark flat is lit afterwards."""
    some, everything = both(two_flats())
    lamp = {"dark ceiling": [5.0, 5.0, 5.0]}
    assert some.relight(emission=lamp).radiosity.tobytes() == everything.relight(emission=lamp).radiosity.tobytes()


def test_nothing_is_dark_that_might_be_lit():
    """Walls away between the flats, a lamp in the dark one, or a lit sky with a wall away: all of it is computed."""
    walls = flat(4.5, "dark ")
    ajar = rad.Scene([*flat(0)[:-1], LAMP, *(wall for wall in walls if "left" not in wall.name)])
    beside_a_closed_room = rad.Scene([*flat(0), LAMP, *walls[:-1]])
    assert not planned(ajar).dark.any()
    shining = replace(walls[0], material=walls[0].material.replace(emission=[1.0, 1.0, 1.0]))
    assert not planned(rad.Scene([*flat(0), LAMP, shining, *walls[1:]])).dark.any()
    assert planned(replace(two_flats(), sky=[1.0, 1.0, 1.0])).dark.any()  # shut in
    assert planned(beside_a_closed_room).dark.any()
    assert not planned(replace(beside_a_closed_room, sky=[1.0, 1.0, 1.0])).dark.any()
    assert not planned(rad.Scene(flat(0))).dark.any()  # no light at all: another warning tells


def test_a_plate_of_two_faces_is_no_room():
    """Its two faces are a closed convex shell without room inside."""
    plate = rad.Surface("plate", [[1, 1, 1], [2, 1, 1], [2, 1, 2], [1, 1, 2]], [[0, 1, 2, 3], [3, 2, 1, 0]], GREY)
    assert not planned(rad.Scene([*flat(0), LAMP, plate])).dark.any()


@pytest.mark.parametrize("scene", [rad.scenes.BUILT_IN[name] for name in sorted(rad.scenes.BUILT_IN)])
def test_what_is_called_dark_is_dark(scene):
    """By the rays' own account, too."""
    size = {"patch_size": 1e3}  # the faces as they are
    solution = rad.solve(scene(), **size, estimator=rad.MonteCarlo(32), leave_out=False, bounces=4)
    assert not solution.radiosity[rad.plan(scene(), **size).dark].any()


# Tracing


def test_convex_rooms_are_lit_without_a_tree():
    some, everything = both(rad.scenes.red_rug())
    assert some.plan["tracing"].left_out
    assert not everything.plan["tracing"].left_out
    assert relative(some.radiosity, everything.radiosity, some.patches.area) < 1e-3  # a ray in a million hits an edge
    assert some.statistics["rays/leaked"] == 0
    assert not planned(rad.scenes.cornell_box())["tracing"].left_out


def test_exact_factors_send_no_rays():
    assert rad.plan(rad.scenes.furnace(), patch_count=54, estimator=rad.Analytic())["tracing"].left_out


# Channels


def test_grey_rooms_are_solved_once():
    some, everything = both(rad.Scene([*flat(0), LAMP]))
    assert some.plan["channels"].story == "2 of 3 follow from the others"
    assert_same_bits(some, everything)
    assert not planned(rad.scenes.red_rug())["channels"].left_out
    assert not planned(rad.scenes.furnace())["channels"].left_out


def test_a_coloured_lamp_in_a_grey_room_is_a_multiple():
    lamp = replace(LAMP, material=rad.Material([0.5] * 3, emission=[12.0, 11.0, 0.0]))
    some, everything = both(rad.Scene([*flat(0), lamp], sky=[2.4, 2.2, 0.0]))
    assert len(some.plan.channels.solved) == 1
    np.testing.assert_allclose(some.radiosity, everything.radiosity, rtol=1e-5)
    np.testing.assert_allclose(some.result.history, everything.result.history, rtol=1e-5)
    assert not some.radiosity[:, 2].any()
    sky = rad.subdivide(rad.Scene([*flat(0), lamp], sky=[2.4, 2.3, 0.0]))
    assert find_alike(sky).spared == 1  # only the channel without light


# Series, factors, digits


def test_little_absorbed_is_left_to_conjugate_gradients():
    stiff = rad.solve(rad.scenes.furnace(absorptance=1e-6), patch_count=54, estimator=RAYS)
    np.testing.assert_allclose(stiff.radiosity, 1e6, rtol=1e-5)
    assert isinstance(stiff.solver, rad.ConjugateGradient)
    assert stiff.converged
    assert not stiff.plan["acceleration"].left_out
    assert not stiff.plan["conserved factors"].left_out
    assert not stiff.plan["float64"].left_out
    assert stiff.factors.reciprocity_defect < 1e-12
    easy = planned(rad.scenes.furnace(absorptance=0.5))
    assert easy["acceleration"].left_out
    assert easy["conserved factors"].left_out
    assert easy["float64"].left_out


def test_an_open_scene_shows_by_its_factors_that_little_is_lost():
    """A closed furnace that is declared open: known to be stiff only when the rows are there."""
    scene = replace(rad.scenes.furnace(absorptance=1e-5), closed=False)
    assert planned(scene)["acceleration"].left_out
    solution = rad.solve(scene, patch_count=54, estimator=RAYS)
    assert not solution.plan["acceleration"].left_out
    np.testing.assert_allclose(solution.radiosity, 1e5, rtol=1e-5)


def test_what_was_asked_for_is_done():
    scene = rad.scenes.furnace(absorptance=1e-4)
    solution = rad.solve(scene, patch_count=54, estimator=RAYS, solver=rad.Neumann(maxiter=3))
    assert solution.solver == rad.Neumann(maxiter=3)
    assert isinstance(rad.solve(scene, patch_count=54, estimator=RAYS, bounces=2).solver, rad.Neumann)
    assert rad.plan(scene, patch_count=54, dtype=np.float32).dtype is np.float32


def test_the_sky_of_a_closed_scene():
    assert planned(replace(rad.scenes.red_rug(), sky=[1.0, 1.0, 1.0]))["sky"].story == (
        "no light of it gets into a closed scene"
    )
    assert not planned(rad.scenes.open_rug())["sky"].left_out


def test_small_scenes_need_one_level():
    assert planned(rad.scenes.furnace())["two levels"].left_out
    assert not rad.plan(rad.scenes.furnace(), patch_count=54, estimator=rad.TwoLevel())["two levels"].left_out


def test_two_levels_are_taken_where_they_are_as_good():
    many, few = (rad.subdivide(rad.scenes.cornell_box(), patch_count=count) for count in (51_000, 49_000))
    plan = make_plan(many)
    item = plan["two levels"]
    assert isinstance(plan.estimator, rad.TwoLevel)
    assert (item.left_out, item.seconds > 0, item.bytes > 0) == (False, True, True)
    assert "patches: instead of one matrix by MonteCarlo" in str(plan) and "as good from 50,000 on" in str(plan)
    assert isinstance(make_plan(few).estimator, rad.MonteCarlo)
    asked = rad.MonteCarlo(256, replicates=2)
    assert make_plan(many, asked).estimator is asked
    for settings in ({"leave_out": False}, {"rows_at_will": False}, {"solver": rad.Shooting()}):
        assert isinstance(make_plan(many, **settings).estimator, rad.MonteCarlo)


@pytest.mark.parametrize(
    "scene",
    [
        two_flats(),  # half of it dark
        rad.scenes.open_rug(),
        rad.scenes.furnace(),  # no lamp: everything shines
        rad.scenes.furnace(absorptance=1e-3),
    ],
)
def test_two_levels_are_not_taken_where_nothing_speaks_for_them(scene, monkeypatch):
    monkeypatch.setattr(two_levels, "LEAST", 1000)
    patches = rad.subdivide(scene, patch_count=1500)
    assert isinstance(make_plan(patches).estimator, rad.MonteCarlo)


def test_two_levels_that_were_chosen_give_the_same_light(monkeypatch):
    scene = rad.scenes.cornell_box()
    one = rad.solve(scene, patch_count=2000)
    monkeypatch.setattr(two_levels, "LEAST", 1000)
    two = rad.solve(scene, patch_count=2000)
    assert isinstance(two.factors.estimator, rad.TwoLevel)
    found, true = (solution.radiosity - solution.emission for solution in (two, one))
    area = one.patches.area[:, None]
    apart = np.sqrt((area * (found - true) ** 2).sum() / (area * true**2).sum())
    assert 0.0 < apart < 0.03
    assert isinstance(rad.solve(scene, patch_count=2000, leave_out=False).factors.estimator, rad.MonteCarlo)


def test_emitters_give_the_first_order_alone():
    assert planned(rad.scenes.red_rug())["order 1"].left_out
    assert not planned(rad.scenes.furnace())["order 1"].left_out  # everything emits


def test_the_tail_says_where_the_series_ended():
    solution = rad.solve(rad.scenes.red_rug(), patch_count=150, estimator=RAYS)
    assert solution.plan["tail"].story.startswith(f"bounces after {len(solution.orders) - 1}; converged")


# Words


def test_a_plan_is_foretold_and_printed():
    plan = planned(two_flats())
    assert 0 < plan.seconds < 60
    solution = rad.solve(two_flats(), patch_count=300, estimator=RAYS)
    made = solution.__dict__["made_factors"]
    stored = sum(f.matrix.data.nbytes + f.matrix.indices.nbytes for f in (made, *made.replicates))
    assert 0.5 * stored < plan.bytes < 3 * (stored + solution.orders.nbytes)
    text = str(plan)
    assert "left out:" in text
    assert f"dark patches: {plan.dark.sum()} patches stay dark" in text
    with pytest.raises(KeyError, match="no item 'sleep'; it has sampling, tracing, empty sides"):
        plan["sleep"]


def test_a_solution_says_what_was_left_out():
    assert "left out: dark patches, channels (about" in str(rad.solve(two_flats(), patch_count=300, estimator=RAYS))
