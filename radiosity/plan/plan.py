"""`Plan`: what a scene needs, and what is left out because it does not."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..convex import is_convex_room
from ..form_factors import Analytic, MonteCarlo, TwoLevel
from ..form_factors.direct_light import worthwhile_emitters
from ..form_factors.estimate import Estimator
from ..form_factors.some_rows import RowChoice
from ..patches import Patches
from ..solvers import ConjugateGradient, Neumann, Solver
from . import exact, two_levels
from .channels import Channels, all_channels, find_alike
from .reach import Reach, reach

BoolArray = NDArray[np.bool_]

RAYS = 256
REPLICATES = 2  # the fewest that tell how wrong they are
RTOL = 1e-6
SMALL = 1e-3  # absorptance below which float32 weights, off by 1e-7, move the answer by more than 1e-4
MANY_BOUNCES = 1000  # beyond which conjugate gradients on conserved factors take less
RAY_SECONDS = 1.2e-7  # of one processor: made, traced, counted
TREE_SHARE = 0.4  # of that in a tree, which a convex room does not need
PRODUCT_SECONDS = 1e-9  # an entry and channel
HEAVY = ("embreex", "trimesh", "pyvista", "vtkmodules", "matplotlib", "dask")


@dataclass(frozen=True)
class Item:
    """One thing that a scene might not need.

    Attributes
    ----------
    name : str
    left_out : bool
        Whether it is, in this scene.
    story : str
        Why, or why not.
    seconds : float
        About what that saves.
    bytes : float
        About what that saves.
    """

    name: str
    left_out: bool
    story: str
    seconds: float = 0.0
    bytes: float = 0.0

    def __str__(self) -> str:
        saved = [f"{self.seconds:.2g} s"] * (self.seconds > 0) + [f"{self.bytes / 1e6:.3g} MB"] * (self.bytes > 0)
        return f"{self.name}: {self.story}" + (f" (saves about {', '.join(saved)})" if saved else "")


@dataclass(frozen=True, eq=False)
class Plan:
    """What this scene needs, what is left out and what that saves.

    Nothing that is left out changes the light: it is known beforehand to be zero, to be alike, or not to be asked for.

    Attributes
    ----------
    patches : Patches
    estimator, solver : object
        How form factors are computed, and the light from them.
    dtype : float32 or float64
        Of the form factors.
    conserve : bool
        Whether the form factors are made to close and to be reciprocal.
    convex : bool
        Whether walls are met by arithmetic instead of a ray tree.
    rows : RowChoice
        Which rows of the form factors are made before the light is solved.
    dark : ndarray of bool (N,)
        Patches that no light reaches for certain; their rows are never needed.
    channels : Channels
        Which channels are solved.
    free_solver : bool
        Whether the solver may still change: nobody asked for this one.
    items : tuple of Item
        Each thing that might not be needed.
    seconds, bytes : float or None
        Foretold for form factors and light, where that was asked for.
    """

    patches: Patches
    estimator: Estimator | TwoLevel
    solver: Solver
    dtype: type[np.float32] | type[np.float64]
    conserve: bool
    convex: bool
    rows: RowChoice
    dark: BoolArray
    channels: Channels
    free_solver: bool = False
    items: tuple[Item, ...] = ()
    seconds: float | None = None
    bytes: float | None = None

    def __getitem__(self, name: str) -> Item:
        """The item of a name.

        Raises
        ------
        KeyError
        """
        for item in self.items:
            if item.name == name:
                return item
        raise KeyError(f"the plan has no item {name!r}; it has {', '.join(item.name for item in self.items)}")

    @property
    def left_out(self) -> tuple[Item, ...]:
        """What is left out."""
        return tuple(item for item in self.items if item.left_out)

    @property
    def needed_rows(self) -> RowChoice | None:
        """`rows`, where not all are made; else None."""
        return self.rows if self.rows.left_out is not None or self.rows.open.any() else None

    def with_item(self, item: Item) -> Plan:
        """The plan with what is known better by now."""
        return replace(self, items=tuple(item if old.name == item.name else old for old in self.items))

    def story(self) -> str:
        """One line of what is left out that would have taken time; empty if there is nothing."""
        saved = [item for item in self.left_out if item.seconds > 0]
        if not saved:
            return ""
        return f"left out: {', '.join(item.name for item in saved)} (about {sum(item.seconds for item in saved):.2g} s)"

    def __repr__(self) -> str:
        return f"<Plan for {self.patches!r}: {self.story() or 'all is needed'}>"

    def __str__(self) -> str:
        made, count = int(self.rows.made.sum()), len(self.patches)
        lines = [
            f"{self.patches.name}: {count:,} patches, {made:,} rows by {self.estimator} as {np.dtype(self.dtype)}, "
            f"{len(self.channels.solved)} of {self.patches.channels} channels, {type(self.solver).__name__}"
        ]
        if self.seconds is not None and self.bytes is not None:
            lines.append(f"about {self.seconds:.2g} s and {self.bytes / 1e6:.3g} MB")
        lines += ["left out:", *(f"  {item}" for item in self.items if item.left_out)]
        lines += ["needed:", *(f"  {item}" for item in self.items if not item.left_out)]
        return "\n".join(lines)


def make_plan(
    patches: Patches,
    estimator: Estimator | TwoLevel | None = None,
    solver: Solver | None = None,
    bounces: int | None = None,
    dtype: Any = None,
    threads: int = 1,
    *,
    leave_out: bool = True,
    rows_at_will: bool = True,
    rtol: float = RTOL,
) -> Plan:
    """Decide what patches need.

    Parameters
    ----------
    patches : Patches
    estimator, solver, bounces, dtype
        As `radiosity.solve` takes them; what is None is chosen.
    threads : int
        For what things take.
    leave_out : bool
        Whether anything is left out.
    rows_at_will : bool
        Whether single rows can be left out: not by workers, nor with a checkpoint.
    rtol : float
        Of a solver that is chosen here.

    Returns
    -------
    Plan
    """
    free = estimator is None
    estimator = MonteCarlo(rays=RAYS, replicates=REPLICATES) if estimator is None else estimator
    rows_at_will = rows_at_will and not isinstance(estimator, TwoLevel)
    found = _Found(patches, bounces, solver, threads, leave_out, rows_at_will)
    free = free and leave_out and rows_at_will and isinstance(solver or Neumann(), Neumann)
    if free and two_levels.serve(patches, found.least_absorbed, found.rows(solver or Neumann()).made):
        estimator = TwoLevel()
        found = _Found(patches, bounces, solver, threads, leave_out, at_will=False)
        found.levels_chosen = True
    elif free and exact.serve(patches):
        estimator = Analytic()
    few = solver is None and bounces is None and found.bounces_expected > MANY_BOUNCES
    chosen = (ConjugateGradient(rtol=rtol) if few else Neumann(rtol=rtol)) if solver is None else solver
    if dtype is None:
        digits = few or found.least_absorbed < SMALL or not leave_out or isinstance(estimator, Analytic)
        dtype = np.float64 if digits else np.float32
    plan = Plan(
        patches=patches,
        estimator=estimator,
        solver=chosen,
        dtype=np.dtype(dtype).type,
        conserve=few,
        convex=leave_out and estimator.rays > 0 and is_convex_room(patches.grid.faces, patches.closed),
        rows=found.rows(chosen),
        dark=found.reach.dark,
        channels=find_alike(patches) if leave_out else all_channels(patches.channels),
        free_solver=solver is None,
    )
    return replace(plan, items=tuple(_items(plan, found)))


class _Found:
    """What is seen of patches at once."""

    def __init__(
        self, patches: Patches, bounces: int | None, solver: Solver | None, threads: int, leave_out: bool, at_will: bool
    ) -> None:
        self.patches, self.bounces, self.threads, self.leave_out = patches, bounces, threads, leave_out
        self.solver_given = solver is not None
        self.levels_chosen = False
        nothing = np.zeros(len(patches), dtype=bool)
        self.reach = reach(patches) if leave_out and at_will else Reach(nothing, nothing, nothing)
        self.black = ~(patches.reflectance > 0).any(axis=1) & leave_out & at_will
        lit = patches.absorptance[(patches.reflectance > 0).any(axis=1)]
        self.least_absorbed = float(lit.min(initial=1.0))

    @property
    def bounces_expected(self) -> float:
        """Until a closed scene's light has fallen to the tolerance, were all of it even; 0 for open scenes."""
        if not self.patches.closed:
            return 0.0
        area = self.patches.area
        mean = float((area @ self.patches.absorptance / area.sum()).min(initial=1.0))
        return float("inf") if mean <= 0 else float(np.log(RTOL) / np.log1p(-mean)) if mean < 1 else 1.0

    def rows(self, solver: Solver) -> RowChoice:
        """Rows to make: not of dark patches, and of black ones only where the solver needs them."""
        later = self.later(solver)
        return RowChoice(~(self.reach.dark | self.reach.open | later), self.reach.open & ~self.reach.dark)

    def later(self, solver: Solver) -> BoolArray:
        """Rows that only the irradiance needs: of black patches, from which no light goes on."""
        if not isinstance(solver, Neumann):
            return np.zeros(len(self.patches), dtype=bool)
        return np.asarray(self.black & ~self.reach.dark & ~self.reach.open)


def _items(plan: Plan, found: _Found) -> Iterator[Item]:
    yield _sampling(plan)
    yield _tracing(plan, found)
    yield from _rows(plan, found)
    yield _channels(plan)
    yield _sky(plan.patches)
    yield _first_order(plan)
    yield Item("tail", True, f"bounces after the light has fallen to {plan.solver.rtol:g} of the source")
    yield from _stiffness(plan, found)
    yield _levels(plan, found)
    yield _digits(plan, found)
    yield _imports(plan)


def _rays_each(plan: Plan) -> int:
    return int(plan.estimator.rays)


def _row_cost(plan: Plan, threads: int) -> tuple[float, float]:
    """About what a row takes: seconds, bytes."""
    entries = min(_rays_each(plan), len(plan.patches)) or len(plan.patches)
    copies = 1 if getattr(plan.estimator, "replicates", 1) == 1 else 2
    seconds = RAY_SECONDS * _rays_each(plan) / threads if _rays_each(plan) else 6e-7 * len(plan.patches) / threads
    return seconds, copies * entries * (4 + np.dtype(plan.dtype).itemsize)


def _sampling(plan: Plan) -> Item:
    count = len(plan.patches)
    if not _rays_each(plan):
        return Item("sampling", True, f"nothing hides anything among {count:,} patches: all pairs are exact")
    if count > exact.MOST:
        return Item("sampling", False, f"{count:,} patches make too many pairs for exact factors")
    return Item("sampling", False, "surfaces may hide each other, or rays were asked for")


def _tracing(plan: Plan, found: _Found) -> Item:
    if plan.convex:
        seconds, _ = _row_cost(plan, found.threads)
        saved = TREE_SHARE * seconds * int(plan.rows.made.sum())
        return Item("tracing", True, "the room is convex: a ray meets the wall whose plane it reaches first", saved)
    if not _rays_each(plan):
        return Item("tracing", True, "exact factors send no rays")
    why = "faces may hide each other" if plan.patches.closed else "the scene is open"
    return Item("tracing", False, f"{why}: rays go through a tree")


def _rows(plan: Plan, found: _Found) -> Iterator[Item]:
    """Patches whose rows are not made, and why."""
    seconds, size = _row_cost(plan, found.threads)

    def item(name: str, which: BoolArray, why: str, why_not: str) -> Item:
        count = int(which.sum())
        story = f"{count:,} patches {why}" if count else why_not
        return Item(name, count > 0, story, count * seconds, count * size)

    dark, backs, empty = found.reach
    yield item("empty sides", empty, "have nothing before them: their light goes to the sky", "all see something")
    yield item("sides that see backs", backs, "see black backs only, and stay dark", "no side sees black backs only")
    yield item("dark patches", dark & ~backs, "stay dark: no light can get there", "light may get everywhere")
    why = "need a row for their irradiance only, made when it is asked for"
    yield item("black receivers", found.later(plan.solver), why, "every patch sends light on, or is needed whole")


def _channels(plan: Plan) -> Item:
    spared = plan.channels.spared
    if not spared:
        one = plan.patches.channels == 1
        return Item("channels", False, "there is one" if one else "paint or light differs between them")
    entries = int(plan.rows.made.sum()) * min(_rays_each(plan) or len(plan.patches), len(plan.patches))
    saved = spared * PRODUCT_SECONDS * entries * 20
    return Item("channels", True, f"{spared} of {plan.patches.channels} follow from the others", saved)


def _sky(patches: Patches) -> Item:
    if not patches.sky.any():
        return Item("sky", True, "it is black")
    if patches.closed:
        return Item("sky", True, "no light of it gets into a closed scene")
    return Item("sky", False, "it shines into an open scene")


def _first_order(plan: Plan) -> Item:
    method, emitters = plan.estimator, None
    if isinstance(method, MonteCarlo):
        each = method.rays // method.replicates, method.light_rays // method.replicates
        emitters = worthwhile_emitters(plan.patches, *each)
    if emitters is None:
        return Item("order 1", False, "comes with the rest of the factors")
    lit = int(emitters.columns.sum())
    return Item("order 1", True, f"comes from {lit:,} emitting patches alone, which are looked at apart: few rays do")


def _stiffness(plan: Plan, found: _Found) -> Iterator[Item]:
    expected = found.bounces_expected
    if plan.conserve:
        yield Item("acceleration", False, f"{expected:,.0f} bounces would be needed: conjugate gradients need some 20")
        yield Item("conserved factors", False, "conjugate gradients need them, and so little absorptance")
        return
    why = "as was asked for" if found.solver_given else "bounce by bounce is quick enough"
    if expected and not found.solver_given:
        why = f"some {expected:,.0f} bounces are quick enough"
    yield Item("acceleration", isinstance(plan.solver, Neumann), why)
    yield Item("conserved factors", True, f"raw ones serve absorptances as here ({found.least_absorbed:.3g} and more)")


def _levels(plan: Plan, found: _Found) -> Item:
    count, least = len(plan.patches), two_levels.LEAST
    if found.levels_chosen:
        one = replace(plan, estimator=MonteCarlo(rays=RAYS, replicates=REPLICATES))
        seconds, size = (count * part for part in _row_cost(one, found.threads))
        story = (
            f"{count:,} patches: instead of one matrix by {one.estimator}, as good from {least:,} on; "
            "a spot check tells how wrong they are"
        )
        return Item("two levels", False, story, two_levels.SAVED_SECONDS * seconds, two_levels.SAVED_BYTES * size)
    if isinstance(plan.estimator, TwoLevel):
        return Item("two levels", False, "as was asked for")
    if count < least:
        return Item("two levels", True, f"{count:,} patches fit into one matrix")
    return Item("two levels", True, f"{count:,} patches are in one matrix, as was asked for or as this scene needs")


def _digits(plan: Plan, found: _Found) -> Item:
    entries = _row_cost(plan, 1)[1] * int(plan.rows.made.sum()) / (4 + np.dtype(plan.dtype).itemsize)
    if plan.dtype is np.float32:
        story = f"float32 is enough for absorptances of {found.least_absorbed:.3g} and more"
        return Item("float64", True, story, bytes=4 * entries)
    story = "asked for, or factors are exact, or so little is absorbed that float32 would move the answer"
    return Item("float64", False, story)


def _imports(plan: Plan) -> Item:
    spared = [name for name in HEAVY if name not in sys.modules and (name != "embreex" or plan.convex)]
    return Item("imports", bool(spared), f"{', '.join(spared)} are not loaded" if spared else "all are loaded already")
