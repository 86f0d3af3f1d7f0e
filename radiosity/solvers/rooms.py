"""Weakly coupled rooms of a scene, found from its form factors, and the small system that couples them.

Light spreads over a room in a few bounces and leaks through a door in many. The slow modes of F (eigenvalues near
one) are therefore almost constant in each room: their number is the number of rooms, and they tell the patches
of one room from those of another.
"""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr

from ..form_factors.factors import FormFactors
from ..transport import TransportOperator
from .admission import connected_components
from .elimination import Elimination, eliminate

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

SLOW = 0.7  # eigenvalues of F above it are rooms; what is below, a solver takes in its stride
DENSE = 200  # patches up to which all eigenvalues are computed
DEPTH = 5  # products per block of trial vectors
MOST_ROOMS = 64

_found: WeakKeyDictionary[FormFactors, Rooms] = WeakKeyDictionary()


@dataclass(frozen=True, eq=False)
class Rooms:
    """Which room each patch belongs to.

    Attributes
    ----------
    label : ndarray of int (N,)
        0 … count - 1; patches of one room are in one enclosure.
    asymmetry : float
        |xᵀ G y - yᵀ G x| of trial vectors, relative; 0 to rounding where G is symmetric.
    products : int
        Passes over the matrix that finding them took.
    """

    label: IntArray
    asymmetry: float
    products: int

    @property
    def count(self) -> int:
        """Number of rooms."""
        return int(self.label.max(initial=-1)) + 1


def find_rooms(factors: FormFactors) -> Rooms:
    """Find the rooms of a scene; the answer is remembered with the factors."""
    rooms = _found.get(factors)
    if rooms is None:
        rooms = _found[factors] = _find(factors)
    return rooms


def _find(factors: FormFactors) -> Rooms:
    values, vectors, asymmetry, products = slow_modes(factors)
    label = _clusters(vectors[:, values > SLOW] / np.sqrt(factors.area)[:, None])
    enclosure = connected_components(factors)
    _, label = np.unique(enclosure * (label.max(initial=0) + 1) + label, return_inverse=True)
    return Rooms(label.astype(np.int64), asymmetry, products)


def slow_modes(factors: FormFactors, wanted: int = 4) -> tuple[FloatArray, FloatArray, float, int]:
    """Largest eigenvalues of F with eigenvectors of √A F √A⁻¹, by block Lanczos with Rayleigh–Ritz.

    Returns
    -------
    values : ndarray (k,)
        Falling.
    vectors : ndarray (N, k)
        Orthonormal, in the measure √A.
    asymmetry : float
        See `Rooms`.
    products : int
    """
    count = len(factors)
    root = np.sqrt(factors.area)[:, None]

    def product(block: FloatArray) -> FloatArray:
        return root * factors.gather(block / root)

    products = 0
    while count > max(DENSE, 2 * wanted * DEPTH):
        values, vectors, asymmetry = _block_lanczos(product, root, 2 * wanted)
        products += DEPTH
        if np.sum(values > SLOW) <= wanted or wanted >= MOST_ROOMS:
            return values, vectors, asymmetry, products
        wanted *= 2
    matrix = product(np.eye(count))
    values, vectors = np.linalg.eigh((matrix + matrix.T) / 2.0)
    return values[::-1], vectors[:, ::-1], _asymmetry(matrix), products + 1


def _block_lanczos(product, root, width):  # type: ignore[no-untyped-def]
    """Ritz values, Ritz vectors and asymmetry from DEPTH products of a random block that holds √A."""
    start = np.random.default_rng(0).standard_normal((len(root), width))
    start[:, :1] = root
    basis = [np.linalg.qr(start)[0]]
    images = []
    for depth in range(DEPTH):
        images.append(product(basis[-1]))
        if depth + 1 < DEPTH:
            rest, known = images[-1], np.hstack(basis)
            for _ in range(2):
                rest = rest - known @ (known.T @ rest)
            basis.append(np.linalg.qr(rest)[0])
    space, image = np.hstack(basis), np.hstack(images)
    small = space.T @ image
    values, mix = np.linalg.eigh((small + small.T) / 2.0)
    return values[::-1], space @ mix[:, ::-1], _asymmetry(small)


def _asymmetry(matrix: FloatArray) -> float:
    size = np.linalg.norm(matrix)
    return float(np.linalg.norm(matrix - matrix.T) / size) if size > 0 else 0.0


def _clusters(modes: FloatArray) -> IntArray:
    """Group the rows of a few modes (N, k) into at most k rooms, without a starting guess.

    Column-pivoted QR picks k rows as unlike each other as possible, a rotation turns modes into indicators (Damle,
    Minden & Ying 2019, doi:10.1093/imaiai/iay008).
    """
    if modes.shape[1] < 2:
        return np.zeros(len(modes), dtype=np.int64)
    length = np.linalg.norm(modes, axis=1)
    rows = modes / np.where(length > 0, length, 1.0)[:, None]
    _, pivots = qr(rows.T, mode="r", pivoting=True)
    left, _, right = np.linalg.svd(rows[pivots[: modes.shape[1]]].T)
    return np.argmax(np.abs(rows @ (left @ right)), axis=1)


@dataclass(frozen=True, eq=False)
class CoarseSystem:
    """Energy balance of the rooms, for one channel, in the irradiance form of `ConjugateGradient`.

    K h = ρ [Σ_j F_ij ((h_i - h_j) + α_j h_j) + outside_i h_i], Z the indicators of the rooms (0 where ρ = 0).

    Attributes
    ----------
    label : ndarray (N,)
    weight : ndarray (N,)
        Area where the patch reflects, else 0.
    exchange : ndarray (N, rooms)
        ρ_i Σ_{j in room} F_ij ρ_j.
    excess : ndarray (N,)
        ρ_i (Σ_j F_ij α_j + outside_i): row sums of K.
    elimination : Elimination
        Of Zᵀ A K Z.
    """

    label: IntArray
    weight: FloatArray
    exchange: FloatArray
    excess: FloatArray
    elimination: Elimination

    def restrict(self, field: FloatArray) -> FloatArray:
        """Zᵀ A field, (rooms, M) for (N, M)."""
        return _sum_rooms(self.label, self.weight[:, None] * field, self.exchange.shape[1])

    def prolong(self, values: FloatArray) -> FloatArray:
        """Z values, (N, M)."""
        return values[self.label] * (self.weight > 0)[:, None]

    def apply(self, values: FloatArray) -> FloatArray:
        """K Z values without subtracting what is nearly equal, (N, M)."""
        own = values[self.label]
        out = self.excess[:, None] * own
        for room in range(self.exchange.shape[1]):
            out += self.exchange[:, room, None] * (own - values[room])
        return out

    def apply_transposed(self, field: FloatArray) -> FloatArray:
        """(K Z)ᵀ A field, (rooms, M)."""
        leaving = self.excess + self.exchange.sum(axis=1)
        inner = np.take_along_axis(self.exchange, self.label[:, None], axis=1)[:, 0]
        kept = self.restrict((leaving - inner)[:, None] * field)
        others = self.exchange.copy()
        np.put_along_axis(others, self.label[:, None], 0.0, axis=1)
        return kept - np.einsum("ir,i,im->rm", others, self.weight, field)

    def solve(self, right: FloatArray) -> FloatArray:
        """(Zᵀ A K Z)⁻¹ right, without subtraction."""
        return self.elimination.solve(right)


def coarse_system(T: TransportOperator, channel: int, rooms: Rooms) -> CoarseSystem:
    """Sum the exchange and the losses of one channel over rooms: two passes over the matrix."""
    rho, alpha = T.reflectance[:, channel], T.absorptance[:, channel]
    members = np.zeros((len(rho), rooms.count))
    members[np.arange(len(rho)), rooms.label] = rho
    gathered = T.factors.gather(np.column_stack([members, alpha]), T.threads)
    exchange = rho[:, None] * gathered[:, :-1]
    excess = rho * (gathered[:, -1] + T.to_outside)
    weight = np.where(rho > 0, T.area, 0.0)
    between = _sum_rooms(rooms.label, weight[:, None] * exchange, rooms.count)
    loss = _sum_rooms(rooms.label, (weight * excess)[:, None], rooms.count)[:, 0]
    return CoarseSystem(rooms.label, weight, exchange, excess, eliminate(between, loss))


def _sum_rooms(label: IntArray, columns: FloatArray, count: int) -> FloatArray:
    """Sum of each room, (rooms, M) for (N, M), in the order of the patches."""
    return np.array([np.bincount(label, column, count) for column in columns.T]).T
