"""What a solver refuses, or must know, before it begins: separate enclosures, light without an end, overflow."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..compiled import kernel
from ..errors import NoSteadyState, SolverError
from ..form_factors.factors import FormFactors
from ..form_factors.levels import TwoLevelFactors
from ..form_factors.on_demand import RowsOnDemand
from ..parallel import blocks
from ..transport import TransportOperator

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int64]

OVERFLOW = 1e300
COLLATZ_PASSES = 200
BLOCK_ROWS = 1 << 16

_components: WeakKeyDictionary[FormFactors, IntArray] = WeakKeyDictionary()


def connected_components(factors: FormFactors | RowsOnDemand) -> IntArray:
    """Number of the enclosure each patch belongs to, (N,): patches that exchange no light are in different ones.

    Remembered with the factors. Rows on demand are taken as one enclosure.
    """
    if isinstance(factors, RowsOnDemand):
        return np.zeros(len(factors), dtype=np.int64)
    labels = _components.get(factors)
    if labels is None:
        if isinstance(factors, TwoLevelFactors):
            labels = _components_of_levels(factors)
        else:
            matrix = factors.matrix
            labels = _union(matrix.indptr, matrix.indices, matrix.data)
        _components[factors] = labels
    return labels


def _components_of_levels(factors: TwoLevelFactors) -> IntArray:
    """Enclosures of patches (N,): of senders and receivers, joined where a patch is both or takes from several."""
    levels, receivers = factors.levels, factors.levels.receivers
    exchange, spread = levels.exchange, levels.spread
    count = receivers + len(levels.emits)
    pointers = np.append(exchange.indptr, np.full(len(levels.emits), exchange.nnz, dtype=exchange.indptr.dtype))
    label = _union(pointers, exchange.indices + receivers, exchange.data)
    found = int(label.max(initial=0)) + 1
    if found > 1:
        joined = csr_array((found, found))
        for begin, end in blocks(len(factors), BLOCK_ROWS):
            entries = slice(spread.indptr[begin], spread.indptr[end])
            sender = label[receivers + levels.sender[begin:end]]
            here = np.repeat(sender, np.diff(spread.indptr[begin : end + 1]))
            there = label[spread.indices[entries]]
            joined = joined + csr_array((np.ones(len(here)), (here, there)), shape=(found, found))
        label = _union(joined.indptr, joined.indices, joined.data)[label]
    assert len(label) == count
    first, number = np.unique(label[receivers + levels.sender], return_index=True, return_inverse=True)[1:]
    order = np.empty(len(first), dtype=np.int64)
    order[np.argsort(first)] = np.arange(len(first))
    return order[number.ravel()]


@kernel
def _union(indptr, indices, weights):  # type: ignore[no-untyped-def]
    """Union-find over the entries above zero; stops as soon as all patches are joined."""
    count = len(indptr) - 1
    parent = np.arange(count)
    left = count
    for i in range(count):
        if left == 1:
            break
        a = i
        while parent[a] != a:
            parent[a] = parent[parent[a]]
            a = parent[a]
        for p in range(indptr[i], indptr[i + 1]):
            if weights[p] > 0:
                b = indices[p]
                while parent[b] != b:
                    parent[b] = parent[parent[b]]
                    b = parent[b]
                if a != b:
                    left -= 1
                    if b < a:
                        a, b = b, a
                    parent[b] = a
    labels = np.empty(count, np.int64)
    found = 0
    for i in range(count):  # a root is the lowest patch of its enclosure, so it is met first
        a = i
        while parent[a] != a:
            a = parent[a]
        if a == i:
            labels[i] = found
            found += 1
        else:
            labels[i] = labels[a]
    return labels


def row_excess(T: TransportOperator) -> FloatArray:
    """1 - Σ_j T_ij = α + ρ (sky + backs + defect) without subtraction, (N, C): what a patch takes out of a bounce."""
    return T.absorptance + T.reflectance * T.to_outside[:, None]


def without_end(T: TransportOperator, channel: int) -> BoolArray:
    """Patches (N,) from which light can never get lost: it is neither absorbed there nor wherever it goes."""
    losing = row_excess(T)[:, channel] > 0
    if losing.all():
        return ~losing
    if isinstance(T.factors, TwoLevelFactors):
        return _without_end_by_products(T.factors, losing)
    matrix = T.factors.matrix
    pattern = csr_array((matrix.data > 0, matrix.indices, matrix.indptr), shape=matrix.shape).astype(np.float32)
    while True:
        rest = np.flatnonzero(~losing)
        reached = pattern[rest] @ losing.astype(np.float32) > 0
        if not reached.any():
            return ~losing
        losing[rest[reached]] = True


def _without_end_by_products(factors: TwoLevelFactors, losing: BoolArray) -> BoolArray:
    """`without_end`, from the patches that lose light at once: whoever sends them some loses it, too."""
    while True:
        reached = ~losing & (factors.gather(losing.astype(np.float64)) > 0)
        if not reached.any():
            return ~losing
        losing = losing | reached


def check_steady(T: TransportOperator, source: FloatArray) -> list[str]:
    """Refuse light that grows for ever; give notes about dark enclosures that would keep it.

    Parameters
    ----------
    T : TransportOperator
    source : ndarray (N, C) or (N, C, S)
        E + ρ π to_sky L_sky, W/m².

    Raises
    ------
    NoSteadyState
        A lit enclosure without any loss: which one, and the watts put into it.
    SolverError
        A spectral radius of one or more, or one that cannot be shown to be less.
    """
    notes = []
    excess = row_excess(T)
    for c in range(T.channels):
        if excess[:, c].min(initial=1.0) < 0:
            check_spectral_radius(T, c)
            continue
        endless = without_end(T, c)
        if not endless.any():
            continue
        lit = endless & (source[:, c].reshape(len(endless), -1) != 0).any(axis=1)
        if lit.any():
            raise NoSteadyState(_endless_message(T, source, endless, lit, c))
        notes.append(
            f"{endless.sum()} patches ({where(T.factors, endless)}) lose no light of channel {c} and none reaches "
            "them: they are given 0"
        )
    return notes


def _endless_message(T: TransportOperator, source: FloatArray, endless: BoolArray, lit: BoolArray, channel: int) -> str:
    label = connected_components(T.factors)
    enclosure = endless & (label == label[np.argmax(lit)])
    columns = source[:, channel].reshape(len(source), -1)
    watts = float(np.max(np.sum(T.area[enclosure, None] * columns[enclosure], axis=0)))
    return (
        f"{watts:.6g} W are put into an enclosure that absorbs nothing of channel {channel}: {enclosure.sum()} patches "
        f"({where(T.factors, enclosure)}) with reflectance 1 and no way out. Give some surface there an absorptance "
        "above 0 (rad.Material(absorptance=…) keeps small ones exactly; float32 rounds 1 - 1e-8 to 1), or an opening"
    )


def where(factors: FormFactors | RowsOnDemand, patches: BoolArray | IntArray) -> str:
    """Name the surfaces of some patches, or give their numbers where there are no names."""
    numbers = np.flatnonzero(patches) if patches.dtype == bool else patches
    if factors.surface is None or not factors.surface_names:
        shown = ", ".join(map(str, numbers[:5]))
        return f"patches {shown}{', …' if len(numbers) > 5 else ''}"
    names = [factors.surface_names[s] for s in np.unique(factors.surface[numbers])]
    return ", ".join(names[:5]) + (f" and {len(names) - 5} more surfaces" if len(names) > 5 else "")


def check_spectral_radius(T: TransportOperator, channel: int) -> None:
    """Refuse a channel whose spectral radius is one or more, by the bounds of Collatz and Wielandt.

    For a positive w: min (T w / w) ≤ spectral radius ≤ max (T w / w). Needed only where rows of T sum to
    more than one; w is improved by w ← w + T w.

    Raises
    ------
    SolverError
    """
    product = T.channel(channel)
    w = np.ones(T.shape[0])
    least, most = 0.0, np.inf
    for _ in range(COLLATZ_PASSES):
        image = product @ w
        ratio = image / w
        least, most = max(least, float(ratio.min())), min(most, float(ratio.max()))
        if most < 1.0:
            return
        if least >= 1.0:
            break
        w = np.maximum((w + image) / np.max(w + image), 1e-250)
    worst = int(np.argmax(row_excess(T)[:, channel] * -1.0))
    raise SolverError(
        f"spectral radius of channel {channel} lies between {least:.9g} and {most:.9g}: light would grow "
        f"with each bounce. Row {worst} of F, its sky and backs sum to {1.0 - T.factors.closure_defect[worst]:.9g}: "
        "use conserved factors (factors.conserved()), or compute them again"
    )


def check_overflow(T: TransportOperator, source: FloatArray) -> None:
    """Refuse sources whose steady light would not fit a float64.

    Raises
    ------
    SolverError
    """
    label = connected_components(T.factors)
    columns = np.abs(source).reshape(*source.shape[:2], -1).max(axis=2, initial=0.0)
    total = np.bincount(label, T.area)
    for c in range(T.channels):
        loss = np.bincount(label, T.area * np.maximum(row_excess(T)[:, c], 0.0))
        brightest = np.zeros(len(total))
        np.maximum.at(brightest, label, columns[:, c])
        lit = brightest > 0
        with np.errstate(over="ignore", divide="ignore"):
            steady = brightest[lit] * (total[lit] / loss[lit]) * max(1.0, float(T.area.max()))
        if np.any(~(steady < OVERFLOW)):
            raise SolverError(
                f"channel {c} would reach about {brightest[lit].max():.3g} × {np.max(total[lit] / loss[lit]):.3g} "
                "W/m², more than a float64 holds: give the emission in a larger unit"
            )
