"""Form factors on two levels: direct light on all patches, the rest between groups of them where light is smooth.

A million patches are needed to draw the edge of a shadow, not to carry what the walls send back. So every patch gets
exact factors × visibility from what emits, as in `MonteCarlo`; all other light is exchanged between groups of patches,
each with as many rays as a group is worth, and spread smoothly over their patches. Where something stands close by
(corners, contacts, small things), light is not smooth: groups there are given up, and their patches send rays of
their own. What is a group and what is not is found out by a few rays of each.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_array

from ..errors import ParameterError
from ..memory import limit_bytes, refuse_above
from ..patches import Patches
from ..progress import Progress, quiet
from ..rays import Tracer
from ..sequences import seed_key
from .assembly import Float
from .direct_light import Emitters, first_rays, worthwhile_emitters
from .elements import Receivers, Senders, senders_of
from .groups import group_patches
from .level_rows import Work
from .levels import Levels, TwoLevelFactors

GROUPS = 4096  # by default, about
MOST_LAMPS = 64  # emitting faces: every patch looks at each of them
ENTRY = 8  # bytes


@dataclass(frozen=True)
class TwoLevel:
    """Form factors for more patches than a matrix of their own serves, from about 20 000.

    Parameters
    ----------
    rays : int
        Rays of each patch where geometry is near.
    group_rays : int
        Most rays of a group of patches; fewer where it has so few that theirs are not as many.
    light_rays : int
        Shadow rays between a patch and an emitting face where the first few disagree; see `MonteCarlo`.
    group : int, optional
        Patches along the side of a group. By default as many as make about 4096 groups of all patches, and at least 2.
    seed : int

    Raises
    ------
    ParameterError
        Numbers that make no sense; from `form_factors`, more emitting faces than every patch can look at.

    Examples
    --------
    >>> import radiosity as rad
    >>> patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=3000)
    >>> factors = rad.form_factors(patches, TwoLevel(group_rays=256))
    >>> float(abs(factors.closure_defect).max()) < 1e-6
    True
    """

    rays: int = 128
    group_rays: int = 2048
    light_rays: int = 64
    group: int | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        seed_key(self.seed)
        for name in ("rays", "group_rays", "light_rays"):
            if getattr(self, name) < 1:
                raise ParameterError(f"{name} is {getattr(self, name)}; give at least 1")
        if self.group is not None and self.group < 2:
            raise ParameterError(f"group is {self.group}; give at least 2 patches along the side, or use MonteCarlo()")

    def side(self, count: int) -> int:
        """Patches along the side of a group, of `count` patches in all."""
        return self.group or max(2, round(math.sqrt(count / GROUPS)))

    def factors(
        self,
        patches: Patches,
        tracer: Tracer,
        dtype: Float = np.float32,
        threads: int | None = None,
        memory_limit: float | None = None,
        progress: Progress = quiet,
    ) -> TwoLevelFactors:
        """The form factors.

        Raises
        ------
        ParameterError
            Too many faces emit.
        MemoryLimitError
            More than the memory limit, foretold once it is known how many patches send rays of their own.
        """
        emitters = lamps(patches, self.light_rays)
        begin = time.perf_counter()
        groups = group_patches(patches, self.side(len(patches)))
        work = Work(self, patches, tracer, groups, threads, progress)
        smooth, looks = work.survey()
        senders = senders_of(groups, smooth)
        receivers = Receivers.of(groups, senders, self.rays, self.group_rays)
        self._check_memory(patches, senders, receivers, emitters, memory_limit)
        surveyed = time.perf_counter()
        rows = work.exchange(receivers, senders, dtype)
        exchanged = time.perf_counter()
        levels = Levels(
            senders.means(patches.area, dtype),
            rows.matrix,
            csr_array((len(patches), len(receivers) + len(senders)), dtype=dtype),
            senders.of_patch,
            np.zeros(len(senders), dtype=bool),
            rows.to_sky,
            rows.to_backs,
            smooth,
            self.side(len(patches)),
        )
        made = work.lit(levels, emitters, dtype, straight_to_new)
        made.statistics.update(
            {
                "levels/groups": len(senders.group),
                "levels/corners": len(receivers.group),
                "levels/patches alone": len(senders.patch),
                "rays/traced": int(receivers.rays.sum()) + looks + (made.check.rays if made.check else 0),
                "seconds/levels": surveyed - begin,
                "seconds/exchange": exchanged - surveyed,
                "seconds/direct light": time.perf_counter() - exchanged - made.statistics["seconds/spot check"],
            }
        )
        return made

    def _check_memory(
        self, patches: Patches, senders: Senders, receivers: Receivers, emitters: Emitters | None, limit: float | None
    ) -> None:
        """Refuse what would not fit: no row has more entries than rays, most have fewer."""
        straight = 0
        if emitters is not None:
            shining = len(np.unique(senders.of_patch[emitters.columns]))
            straight = min(len(emitters) * first_rays(self.light_rays), shining)
        entries = receivers.entries(len(senders)) + len(patches) * (5 + straight)
        refuse_above(
            limit_bytes(limit),
            ENTRY * entries,
            f"form factors of {len(patches):,} patches on two levels, {len(senders.patch):,} of them by themselves,",
            f"take rays below {self.rays}, groups larger than {self.side(len(patches))} (group=), or fewer patches",
        )


def lamps(patches: Patches, light_rays: int) -> Emitters | None:
    """What emits, as `worthwhile_emitters` finds it.

    Raises
    ------
    ParameterError
        More emitting faces than every patch can look at.
    """
    emitting = (patches.emission > 0).any(axis=1)
    if not emitting.any() or (patches.closed and emitting.all()):
        return None
    emitters = worthwhile_emitters(patches, len(patches) << 20, light_rays)  # however many there are
    assert emitters is not None
    if len(emitters) > MOST_LAMPS:
        raise ParameterError(
            f"{len(emitters)} faces emit, and on two levels every patch looks at each: more than {MOST_LAMPS} take too "
            "long. Use MonteCarlo(), or make fewer faces shine"
        )
    return emitters


def straight_to_new(factors: TwoLevelFactors, patches: Patches) -> TwoLevelFactors:
    """The same factors with straight paths from what emits in `patches`, besides those that they have."""
    method = factors.estimator
    assert isinstance(method, TwoLevel)
    known = np.zeros(len(patches), dtype=bool) if factors.exact_columns is None else factors.exact_columns
    bright = (patches.emission > 0).any(axis=1) | known
    emitters = lamps(replace(patches, emission=bright[:, None].astype(np.float64)), method.light_rays)
    levels = factors.levels
    work = Work(method, patches, Tracer(patches.grid), group_patches(patches, levels.side), None, quiet)
    made = work.lit(levels, emitters, levels.exchange.dtype.type, straight_to_new)
    return TwoLevelFactors(
        made.levels,
        made.to_sky,
        made.to_backs,
        made.area,
        made.surface,
        made.surface_names,
        method,
        {**factors.statistics, **made.statistics},
        made.exact_columns,
        straight_to_new,
        made.check,
    )
