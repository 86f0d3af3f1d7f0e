"""`Solution`: the light of a scene, and everything that it was computed from."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .accuracy import Accuracy
from .balance import PowerBalance, power_balance
from .certificate import Certificate, certify
from .convex import ConvexTracer
from .dark import dark_patches
from .errors import FileFormatError
from .form_factors import FormFactors
from .form_factors.estimate import completed
from .irradiance import irradiance_at
from .patches import Patches
from .plan import Plan
from .relight import relit_patches, relit_scene
from .result import Result
from .scene import Scene
from .series import run
from .solvers import Solver
from .transport import TransportOperator

FloatArray = NDArray[np.float64]

DATA, PAGES, PICTURES = (".npz", ".vtp"), (".html", ".glb"), (".png", ".gif", ".mp4")


class _WholeFactors:
    """The form factors of a solution. Rows that a plan left out are made when the factors are first asked for."""

    def __get__(self, solution: Solution | None, kind: type | None = None) -> FormFactors:
        if solution is None:
            raise AttributeError("factors")  # so that the field has no default
        made: FormFactors = solution.__dict__["made_factors"]
        if made.left_out is None:
            return made
        if "whole_factors" not in solution.__dict__:
            solution.__dict__["whole_factors"] = solution._completed(made)
        whole: FormFactors = solution.__dict__["whole_factors"]
        return whole

    def __set__(self, solution: Solution, factors: FormFactors) -> None:
        solution.__dict__["made_factors"] = factors


@dataclass(frozen=True, eq=False)
class Solution:
    """The light of a scene.

    Attributes
    ----------
    scene : Scene
        The geometry and its materials.
    patches : Patches
        N patches with the emission, reflectance and sky that were solved for.
    factors : FormFactors
        All of them: rows that the plan left out are made when this is first asked for, with the bits that they would
        have had.
    result : Result
        What the solver returned.
    solver : Solver
        The method and its tolerances.
    bounces : int or None
        Where the series was cut on request.
    settings : dict
        What `solve` was asked for, as plain values.
    statistics : dict
        Counters and seconds, named "group/what", in the order of the work.
    plan : Plan or None
        What was left out; None of solutions that were relit or read from a file.
    accuracy : Accuracy or None
        The errors, where a solution to a stated accuracy was asked for.
    """

    scene: Scene
    patches: Patches
    factors: FormFactors = _WholeFactors()  # type: ignore[assignment]
    result: Result  # type: ignore[misc]  # `factors` has no default, whatever it looks like
    solver: Solver  # type: ignore[misc]
    bounces: int | None = None
    settings: dict[str, Any] = field(default_factory=dict)
    statistics: dict[str, Any] = field(default_factory=dict)
    plan: Plan | None = None
    accuracy: Accuracy | None = None

    def _completed(self, made: FormFactors, rows: NDArray[np.bool_] | None = None) -> FormFactors:
        tracer = ConvexTracer(self.patches.grid) if self.plan is not None and self.plan.convex else None
        return completed(made, self.patches, rows, tracer=tracer)

    @cached_property
    def lit_factors(self) -> FormFactors:
        """Form factors that are right wherever there is light; rows of patches that stay dark may be left out.

        Enough for powers, balances and errors of this light. `factors` has all rows.
        """
        if "whole_factors" in self.__dict__ or self.plan is None:
            return self.factors
        made: FormFactors = self.__dict__["made_factors"]
        if made.left_out is None or not (made.left_out & ~self.plan.dark).any():
            return made
        return self._completed(made, ~self.plan.dark)

    @property
    def radiosity(self) -> FloatArray:
        """Light that leaves each patch, B, W/m², (N, C)."""
        return self.result.radiosity

    @property
    def orders(self) -> FloatArray | None:
        """Light by number of bounces, T^k E, W/m², (K + 1, N, C); None from solvers that do not sum the series."""
        return self.result.orders

    @property
    def status(self) -> str:
        """One sentence: converged, or why not and what to try."""
        return self.result.status

    @property
    def converged(self) -> bool:
        """Whether the solver met its tolerance."""
        return self.result.converged

    @property
    def emission(self) -> FloatArray:
        """Light that each patch emits by itself, E, W/m², (N, C)."""
        return self.patches.emission

    @property
    def sky(self) -> FloatArray:
        """Radiance of the surroundings, W/(m² sr), (C,)."""
        return self.patches.sky

    @property
    def irradiance(self) -> FloatArray:
        """Light that arrives at each patch, H = F B + π to_sky L_sky, W/m², (N, C)."""
        factors = self.lit_factors
        return factors.gather(self.radiosity) + np.pi * factors.to_sky[:, None] * self.sky

    @property
    def radiance(self) -> FloatArray:
        """L = B / π, W/(m² sr), (N, C)."""
        return self.radiosity / np.pi

    @property
    def absorbed(self) -> FloatArray:
        """Power that each patch absorbs, A α H, W, (N, C)."""
        return self.patches.area[:, None] * self.patches.absorptance * self.irradiance

    @property
    def net_flux(self) -> FloatArray:
        """Power that each patch gives away, A (B - H), W, (N, C): emitted less absorbed."""
        return self.patches.area[:, None] * (self.radiosity - self.irradiance)

    @property
    def power(self) -> FloatArray | None:
        """Power that leaves the surfaces with each order, Σ A T^k E, W, (K + 1, C); None where there are no orders."""
        if self.orders is None:
            return None
        return np.sum(self.patches.area[:, None] * self.orders, axis=1)

    @property
    def balance(self) -> PowerBalance:
        """Power put in, absorbed, escaped, and what the sum lacks."""
        return power_balance(self.patches, self.lit_factors, self.radiosity, self.irradiance)

    @cached_property
    def certificate(self) -> Certificate:
        """How wrong the light can be, as far as form factors and algebra go; computed when it is first asked for.

        Of a solution to a stated accuracy: judged by that. One standard error has then to fit in, as what was asked for
        is a root mean square, too; and where the estimate of the whole error is larger, that is a doubt of its own.
        """
        T = TransportOperator(self.lit_factors, self.patches)
        asked = self.settings.get("accuracy")
        if asked is None:
            return certify(T, self.emission, self.radiosity, self.sky)
        found = certify(T, self.emission, self.radiosity, self.sky, accuracy=asked, standard_errors=1.0)
        if self.accuracy is None or self.accuracy.reached or found.verdict == "refused":
            return found
        doubt = f"the error with that of the patches is about {self.accuracy.total:.2g}: more than was asked for"
        return replace(found, verdict="uncertified", reasons=(*found.reasons, doubt))

    def relight(
        self,
        *,
        emission: ArrayLike | Mapping[str, ArrayLike] | None = None,
        reflectance: ArrayLike | Mapping[str, ArrayLike] | None = None,
        sky: ArrayLike | None = None,
    ) -> Solution:
        """Solve again with other light or other paint; the geometry and so the form factors stay.

        Parameters
        ----------
        emission : mapping of str to array_like (C,), or array_like (N, C), optional
            Exitance, W/m²: of the surfaces (or materials) named, the others staying as they are; or of every patch.
        reflectance : mapping of str to array_like (C,), or array_like (N, C), optional
        sky : array_like (C,), optional
            Radiance of the surroundings, W/(m² sr).

        Returns
        -------
        Solution
            By the same solver. Values given patch by patch are in its `patches`; its `scene` knows only those
            given by surface.

        Raises
        ------
        ParameterError
            A name that the scene does not have.
        MaterialError
            Values that no surface can have, or a shape that does not fit.
        """
        scene = relit_scene(
            self.scene,
            emission=emission if isinstance(emission, Mapping) else None,
            reflectance=reflectance if isinstance(reflectance, Mapping) else None,
            sky=sky,
        )
        patches = relit_patches(self.patches, scene, emission=emission, reflectance=reflectance)
        factors = self.factors.lit_by(patches)
        result = run(self.solver, TransportOperator(factors, patches), patches, self.bounces)
        statistics = {**factors.statistics, **result.statistics}
        return Solution(
            scene,
            patches,
            factors,
            result,
            self.solver,
            self.bounces,
            {**self.settings, "relit": True},
            statistics,
        )

    def irradiance_at(
        self,
        points: ArrayLike,
        normals: ArrayLike,
        *,
        rays: int = 1024,
        seed: int = 0,
        threads: int | None = None,
    ) -> FloatArray:
        """Irradiance at points, W/m², (P, C): a grid on a desk, say. See `radiosity.irradiance.irradiance_at`.

        Parameters
        ----------
        points : array_like (P, 3)
            m.
        normals : array_like (P, 3) or (3,)
            Which way each point looks.
        rays : int, optional
            For each point; the error falls about as 1 / rays^0.6.
        seed, threads : int, optional
        """
        return irradiance_at(self.patches, self.radiosity, points, normals, rays=rays, seed=seed, threads=threads)

    def save(self, path: str | os.PathLike[str], **settings: Any) -> None:
        """Write the solution; the suffix says what.

        Parameters
        ----------
        path : path
            `.npz`: everything, for `rad.read_solution`. `.vtp`: all orders on the patches, for ParaView and others.
            `.html`: a page with all bounces, for any browser. `.glb`: the light as colours of the patches, for 3D
            programs. `.png`: a picture. `.gif`, `.mp4`: a film of the bounces.
        **settings
            Of what is looked at: see `radiosity.viewer.exports.export`.

        Raises
        ------
        FileFormatError
            Another suffix.
        MissingFileError
            The folder is not there.
        DisplayError
            A picture or film, on a machine that cannot draw.
        MissingDependencyError
            `.mp4` without the optional group `video`.
        """
        file = Path(path)
        suffix = file.suffix.lower()
        if suffix in DATA and settings:
            raise FileFormatError(f"{file}: {', '.join(settings)}: only pictures and pages have settings")
        if suffix not in DATA + PAGES + PICTURES:
            known = ", ".join(DATA + PAGES + PICTURES)
            raise FileFormatError(f"{file}: solutions are not written as {file.suffix!r}; choose from {known}")
        from .files.atomic import replacing
        from .files.solutions import write_solution

        if suffix in DATA:
            write_solution(self, file)
            return
        from .viewer.exports import export

        with replacing(file) as temporary:
            export(self, temporary, **settings)

    def show(self, **settings: Any) -> None:
        """Open the viewer, and return when its window is closed; inside a notebook, show the page there.

        See `radiosity.viewer.view` for the settings, and `radiosity.viewer.notebook.show` for those of a notebook.

        Raises
        ------
        DisplayError
            There is no display, or no GL; with what to do about it.
        """
        from .viewer.notebook import show

        show(self, **settings)

    def __repr__(self) -> str:
        return f"<Solution of {self.patches.name!r}: {len(self.patches):,} patches; {self.status}; print it for more>"

    def __str__(self) -> str:
        """The story in a few lines."""
        factors = self.lit_factors
        lines = [_scene_line(self.patches), _factor_line(factors)]
        lines += filter(None, [dark_patches(self.patches, factors).story])
        if self.power is not None:
            lines.append("by bounce, W: " + power_by_bounce(self.power))
        lines.append("seconds: " + ", ".join(f"{stage} {s:.2f}" for stage, s in seconds(self.statistics).items()))
        lines += [self.statistics[name] for name in ("plan/left out", "accuracy/story") if self.statistics.get(name)]
        return "\n".join([*lines, self.status, str(self.certificate)])


def _scene_line(patches: Patches) -> str:
    enclosure = "closed" if patches.closed else "open"
    names, channels = len(patches.surface_names), patches.channels
    return (
        f"{patches.name}: {len(patches):,} patches on {names} surface{'s' * (names != 1)}, {enclosure}, "
        f"{channels} channel{'s' * (channels != 1)}"
    )


def _factor_line(factors: FormFactors) -> str:
    entries, count = factors.non_zeros, len(factors)
    return f"form factors by {factors.estimator}: {entries:,} non-zeros ({entries / count**2:.2%})"


def power_by_bounce(power: FloatArray, shown: int = 6) -> str:
    """Power of the first orders and the last, all channels together.

    >>> power_by_bounce(2.0 ** -np.arange(12)[:, None])
    '0: 1, 1: 0.5, 2: 0.25, 3: 0.125, 4: 0.0625, 5: 0.03125, … 11: 0.0004883'
    """
    watts = power.sum(axis=1)
    words = [f"{k}: {w:.4g}" for k, w in enumerate(watts)]
    return ", ".join(words) if len(words) <= shown + 1 else ", ".join(words[:shown]) + f", … {words[-1]}"


def seconds(statistics: Mapping[str, Any]) -> dict[str, float]:
    """Seconds of each stage, in the order of the work.

    >>> seconds({"seconds/patches": 0.1, "rays/traced": 5})
    {'patches': 0.1}
    """
    group = "seconds/"
    return {name.removeprefix(group): float(s) for name, s in statistics.items() if name.startswith(group)}
