"""Conjugate gradients on the symmetric form, with the light level of each room solved exactly."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..errors import SolverError
from ..result import Step
from .base import Problem, Solver
from .direct import channels_alike
from .rooms import CoarseSystem, Rooms, coarse_system, find_rooms

FloatArray = NDArray[np.float64]

ASYMMETRY = 1e-10  # of trial vectors; conserved factors have 1e-16, raw ones 1e-3 and more

DRIFT = 0.1  # of the recursive residual from the true one, beyond which the directions are forgotten
INDEFINITE = 1e-10  # relative; less is rounding
PATIENCE = 8  # checks without progress: rounding is reached, more iterations are in vain


@dataclass(frozen=True)
class ConjugateGradient(Solver):
    """Few products whatever the absorptance: 10 to 30 down to 1e-12, where `Neumann` would need 1e13.

    Solves for the irradiance h, with B = E + ρ h, the symmetric system (scaled by √(ρ A) it is
    I - √(ρ/A) G √(ρ/A), Eq. (21)):

        A_i ρ_i [ Σ_j F_ij ((h_i - h_j) + α_j h_j) + outside_i h_i ] = A_i (T E + ρ π to_sky L_sky)_i,

    preconditioned by its diagonal and deflated by one constant per weakly coupled room, which it finds itself
    (`radiosity.solvers.rooms`). The light level y of the rooms is solved by an elimination without subtraction, and
    kept apart from the rest v until the end: h = Z y + v. So every step leaves each room's energy balance exact,
    and residuals mean something where y is 1e12 times v.

    Needs conserved (symmetric) factors, and does not change those it is given.

    Parameters
    ----------
    rtol, atol, maxiter
        See `Solver`. The residual that is tested is that of Z y + v before both are rounded into one float64.
    check : int
        A `Step` is yielded, and the residual recomputed from the equation, every so many iterations; in
        between the iteration's own recursion is trusted.

    Raises
    ------
    SolverError
        Form factors that are not symmetric (G ≠ Gᵀ), with the defect and the remedy.

    References
    ----------
    Hestenes & Stiefel (1952); Saad, Yeung, Erhel & Guyomarc'h (2000), doi:10.1137/S1064829598339761 (deflation);
    van der Vorst & Ye (2000), doi:10.1137/S1064827599353865 (residual replacement).
    """

    check: int = 4

    advice = "Raise maxiter or rtol; if the residual stands still, its rounding is reached"

    def steps(self, problem: Problem) -> Iterator[Step]:
        """Yield a step at the start and after every `check` iterations."""
        rooms = find_rooms(problem.T.stored_factors)
        problem.count("solver/products", rooms.products)
        problem.statistics["solver/rooms"] = rooms.count
        if not rooms.asymmetry <= ASYMMETRY:
            raise SolverError(
                f"ConjugateGradient needs symmetric exchange areas, but ‖G - Gᵀ‖ / ‖G‖ = "
                f"{problem.T.stored_factors.reciprocity_defect:.3g}: use factors.conserved(), or Neumann on raw factors"
            )
        system = _Irradiance(problem, rooms)
        before = np.zeros_like(problem.source)
        order, least, stands = 0, np.inf, 0
        while True:
            residual = system.balance_rooms()
            light = system.radiosity()
            size = problem.measure(residual)
            yield problem.step(order, light - before, light, size)
            problem.scratch["converged"] = problem.reached(size)
            worst = float(np.max(np.abs(residual / system.scale_of(residual)), initial=0.0))
            least, stands = (worst, 0) if worst < 0.9 * least else (least, stands + 1)
            if problem.scratch["converged"] or order >= self.maxiter or stands >= PATIENCE:
                return
            before = light
            order += system.iterate(min(self.check, self.maxiter - order))


@dataclass(eq=False)
class _Irradiance:
    """The system in h, its state h = Z (y + y_low) + v, and one direction p. Arrays are (N, C, S).

    Each enclosure is scaled by its own brightest source, so that sources of 1e30 and 1e-30 in separate
    enclosures are equally well served.
    """

    problem: Problem
    rooms: Rooms
    coarse: list[CoarseSystem] = field(init=False)

    def __post_init__(self) -> None:
        T, rooms = self.problem.T, self.rooms
        self.coarse = [None] * T.channels  # type: ignore[list-item]  # filled below
        for channels in channels_alike(T):
            made = coarse_system(T, channels[0], rooms)
            self.problem.count("solver/products")
            for c in channels:
                self.coarse[c] = made
        self.rho, self.alpha = T.reflectance[:, :, None], T.absorptance[:, :, None]
        self.outside, self.area = T.to_outside[:, None, None], T.area[:, None, None]
        self.emission = self.problem.emission.reshape(*self.problem.emission.shape[:2], -1)
        from_sky = (self.problem.source - self.problem.emission).reshape(self.emission.shape)
        self.right = self._scaled(self.problem.product(self.problem.emission).reshape(self.emission.shape) + from_sky)
        self.diagonal = self._diagonal()
        shape = (rooms.count, *self.emission.shape[1:])
        self.level, self.level_low = np.zeros(shape), np.zeros(shape)
        self.rest = self._start()
        self.residual = self._residual()
        self.direction: FloatArray | None = None
        self.energy = np.zeros(self.emission.shape[1:])

    def _scaled(self, right: FloatArray) -> FloatArray:
        """Divide by the largest entry of each enclosure and column; remember it."""
        label = self.problem.label
        largest = np.zeros((int(label.max(initial=0)) + 1, *right.shape[1:]))
        np.maximum.at(largest, label, np.abs(right))
        self.scale = np.where(largest > 0, largest, 1.0)[label]
        return right / self.scale

    def _diagonal(self) -> FloatArray:
        """Diagonal of K: ρ_i (Σ_{j≠i} F_ij + F_ii α_i + outside_i)."""
        matrix = self.problem.T.factors.matrix
        own = matrix.diagonal().astype(np.float64)[:, None, None]
        others = np.maximum(1.0 - self.problem.T.to_outside[:, None, None] - own, 0.0)
        return self.rho * (others + own * self.alpha + self.outside)

    def _start(self) -> FloatArray:
        """Irradiance of the first guess, or none."""
        if self.problem.start is None:
            return np.zeros_like(self.emission)
        self.problem.count("solver/products")
        irradiance = self.problem.T.factors.gather(self.problem.start).reshape(self.emission.shape)
        from_sky = (self.problem.source - self.problem.emission).reshape(self.emission.shape)
        reflected_sky = np.divide(from_sky, self.rho, out=np.zeros_like(from_sky), where=self.rho > 0)
        start = (irradiance + reflected_sky) * (self.rho > 0) / self.scale
        for c, coarse in enumerate(self.coarse):  # its level apart, so that the rest stays small
            room_area = np.maximum(coarse.restrict(np.ones((len(start), 1))), np.finfo(float).tiny)
            self.level[:, c] = coarse.restrict(start[:, c]) / room_area
            start[:, c] -= coarse.prolong(self.level[:, c])
        return start

    def _residual(self) -> FloatArray:
        """Right-hand side - K (Z (y + y_low) + v), part by part."""
        residual = self.right - self._product(self.rest)
        for c, coarse in enumerate(self.coarse):
            residual[:, c] -= coarse.apply(self.level[:, c])
            residual[:, c] -= coarse.apply(self.level_low[:, c])
        return residual

    def _product(self, h: FloatArray) -> FloatArray:
        """K h, counted."""
        self.problem.count("solver/products")
        return self.rho * (self.problem.T.net_exchange(h, self.alpha * h) + self.outside * h)

    def _inner(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Σ A x y per column, (C, S)."""
        return np.sum(self.area * x * y, axis=0)

    def balance_rooms(self) -> FloatArray:
        """Solve the light level of the rooms for the residual of the rest; gives the residual left, as a field.

        The level is kept in two float64: at α = 1e-12 one would round it by more than the rest is.
        """
        for c, coarse in enumerate(self.coarse):
            step = coarse.solve(coarse.restrict(self.residual[:, c]))
            self.residual[:, c] -= coarse.apply(step)
            self.level[:, c], low = _two_sum(self.level[:, c], step)
            self.level_low[:, c] += low
        return (self.residual * self.scale).reshape(self.problem.source.shape)

    def radiosity(self) -> FloatArray:
        """B = E + ρ (Z y + v), rounded to float64."""
        h = self.rest.copy()
        for c, coarse in enumerate(self.coarse):
            h[:, c] += coarse.prolong(self.level_low[:, c])
            h[:, c] += coarse.prolong(self.level[:, c])
        return (self.emission + self.rho * self.scale * h).reshape(self.problem.source.shape)

    def iterate(self, count: int) -> int:
        """Up to `count` iterations on the rest; then its residual from the equation. Gives how many were made."""
        aim = self._aim()
        made = 0
        while made < count and self._advance():
            made += 1
            if np.all(np.max(np.abs(self.residual), axis=0) <= aim):
                break
        recursive, self.residual = self.residual, self._residual()
        drift = self._inner(self.residual - recursive, self.residual - recursive)
        if np.any(drift > DRIFT**2 * self._inner(self.residual, self.residual)):
            self.direction = None  # what the directions knew no longer holds: begin anew from here
        return made

    def scale_of(self, field: FloatArray) -> FloatArray:
        """What the arrays were divided by, in the shape of a field."""
        return self.scale.reshape(field.shape)

    def _aim(self) -> FloatArray:
        """Largest residual, (C, S), that surely meets the tolerance of all lit enclosures."""
        first = np.unique(self.problem.label, return_index=True)[1]
        shape = len(first), *self.right.shape[1:]
        scaled = self.problem.tolerance.reshape(shape) / self.scale[first]
        return np.min(np.where(self.problem.size.reshape(shape) > 0, scaled, np.inf), axis=0)

    def _advance(self) -> bool:
        """One iteration of preconditioned, deflated conjugate gradients; False where nothing is left to do."""
        z = np.divide(self.residual, self.diagonal, out=np.zeros_like(self.residual), where=self.diagonal > 0)
        energy = self._inner(self.residual, z)
        if not np.any(energy > 0):
            return False
        fresh = z - self._deflated(z)
        if self.direction is None:
            self.direction = fresh
        else:
            beta = np.divide(energy, self.energy, out=np.zeros_like(energy), where=self.energy > 0)
            self.direction = fresh + beta * self.direction
        image = self._product(self.direction)
        curvature = self._inner(self.direction, image)
        if np.any(curvature < -INDEFINITE * self._inner(self.direction, self.diagonal * self.direction)):
            raise SolverError("the system is not positive definite: form factors are not symmetric or not closed")
        # (r, p), not (r, z): equal in exact arithmetic, but where only rounding is left, p is a rounding error of z.
        along = self._inner(self.residual, self.direction)
        length = np.divide(along, curvature, out=np.zeros_like(along), where=curvature > 0)
        self.rest = self.rest + length * self.direction
        self.residual = self.residual - length * image
        self.energy = energy
        return True

    def _deflated(self, z: FloatArray) -> FloatArray:
        """Z (Zᵀ A K Z)⁻¹ (K Z)ᵀ A z: what makes a direction conjugate to the rooms."""
        out = np.empty_like(z)
        for c, coarse in enumerate(self.coarse):
            out[:, c] = coarse.prolong(coarse.solve(coarse.apply_transposed(z[:, c])))
        return out


def _two_sum(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Sum a + b and its rounding error (Knuth)."""
    total = a + b
    seen = total - a
    return total, (a - (total - seen)) + (b - seen)
