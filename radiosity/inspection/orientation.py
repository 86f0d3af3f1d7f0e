"""Shells and the side that they face: which faces are turned against their neighbours, or a whole shell inside out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .mesh import Mesh

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

LEAST_VOLUME = 1e-9  # of the box around a shell: flatter ones have no inside
MOST_SHELLS = 2000  # largest first; each is compared with all


@dataclass(frozen=True, eq=False)
class Orientation:
    """The S shells of a mesh: faces that hang together by edges which exactly two of them have.

    Attributes
    ----------
    shell : ndarray of int (F,)
        -1 for faces without area.
    turned : ndarray of bool (F,)
        Faces that look to the other side than most of their shell, by area.
    sound : ndarray of bool (S,)
        Whether turning those makes the shell agree with itself; a Möbius strip has no two sides.
    whole : ndarray of bool (S,)
        Without an edge that only one face has, and sound.
    volume : ndarray (S,)
        m³ behind the faces, after turning: positive for the skin of a body, negative for the walls of a room.
    inside_out : ndarray of bool (S,)
        Whole shells that face the wrong way: bodies that face inwards, rooms that face outwards.
    """

    shell: IntArray
    turned: BoolArray
    sound: BoolArray
    whole: BoolArray
    volume: FloatArray
    inside_out: BoolArray


def orientation(mesh: Mesh) -> Orientation:
    """Find the shells of a mesh and the sides that they face.

    Parameters
    ----------
    mesh : Mesh

    Notes
    -----
    Neighbours agree where they run their common edge in opposite directions. Two copies of every face, one for each
    side, are joined accordingly; a shell whose two copies fall apart has two sides, and the faces whose front lies
    with the smaller part are the turned ones.

    A whole shell that lies in another is a body, and faces outwards. One that lies in none and holds something, or
    stands alone in a scene that is declared closed or whose sky is black, is a room and faces inwards. One that
    neither holds nor lies in anything may be either, so that it stays: but if it faces inwards, emits nothing, and all
    lamps are away from it, nobody would ever see it, so that it is a body.
    """
    shell, count = _shells(mesh)
    turned, sound = _turned(mesh, shell, count)
    whole = sound.copy()
    edges = mesh.edges
    whole[shell[edges.face[edges.free]]] = False
    crowded = np.repeat(edges.count >= 3, edges.count)
    whole[shell[edges.face[crowded]]] = False
    volume, low, high = _extent(mesh, shell, turned, count)
    whole &= np.abs(volume) > LEAST_VOLUME * np.prod(high - low, axis=1)
    inside_out = _inside_out(mesh, shell, whole, volume, low, high)
    return Orientation(shell, turned, sound, whole, volume, inside_out)


def _shells(mesh: Mesh) -> tuple[IntArray, int]:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    edges = mesh.edges
    one, other = edges.face[edges.pairs], edges.face[edges.pairs + 1]
    solid = np.flatnonzero(~mesh.flat)
    place = np.full(len(mesh), -1)
    place[solid] = np.arange(len(solid))
    graph = coo_array((np.ones(len(one), bool), (place[one], place[other])), shape=(len(solid),) * 2)
    count, label = connected_components(graph, directed=False)
    place[solid] = label
    return place, int(count)


def _turned(mesh: Mesh, shell: IntArray, count: int) -> tuple[BoolArray, BoolArray]:
    """Faces against the majority of their shell, and which shells have two sides."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    edges, number = mesh.edges, len(mesh)
    one, other = edges.face[edges.pairs], edges.face[edges.pairs + 1]
    away = edges.alike * number  # to the copy of the other side
    begin = np.concatenate([one, one + number])
    end = np.concatenate([other + away, (other + away + number) % (2 * number)])
    graph = coo_array((np.ones(len(begin), bool), (begin, end)), shape=(2 * number,) * 2)
    _, label = connected_components(graph, directed=False)
    front, back = label[:number], label[number:]
    solid = ~mesh.flat
    sound = np.ones(count, dtype=bool)
    sound[shell[solid & (front == back)]] = False
    # Of the two copies of a shell, the one with the lower label counts; where most fronts are in the other, it does.
    in_first = front < back
    balance = np.bincount(shell[solid], np.where(in_first, mesh.area, -mesh.area)[solid], minlength=count)
    majority = balance >= 0
    turned = np.zeros(number, dtype=bool)
    turned[solid] = in_first[solid] != majority[shell[solid]]
    turned[solid] &= sound[shell[solid]]
    return turned, sound


def _extent(mesh: Mesh, shell: IntArray, turned: BoolArray, count: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Volume (S,) behind the faces of each shell, and the box around it (S, 3)."""
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    solid = np.flatnonzero(shell >= 0)
    for k in range(4):
        np.minimum.at(low, shell[solid], mesh.corners[solid, k])
        np.maximum.at(high, shell[solid], mesh.corners[solid, k])
    a, b, c, d = (mesh.corners[solid, k] - low[shell[solid]] for k in range(4))
    six = np.einsum("fx,fx->f", a, np.cross(b, c)) + np.einsum("fx,fx->f", a, np.cross(c, d))
    signed = np.where(turned[solid], -six, six) / 6.0
    volume = np.bincount(shell[solid], signed, minlength=count).astype(np.float64)
    return volume, low, high


def _inside_out(
    mesh: Mesh, shell: IntArray, whole: BoolArray, volume: FloatArray, low: FloatArray, high: FloatArray
) -> BoolArray:
    """Whole shells that face the wrong way (S,); those of two-sided faces alone face both."""
    size = np.prod(high - low, axis=1)
    closed = np.flatnonzero(whole)
    closed = closed[np.argsort(-size[closed], kind="stable")]
    two_sided = np.bincount(shell[shell >= 0], ~mesh.two_sided[shell >= 0], minlength=len(whole)) == 0
    result = np.zeros(len(whole), dtype=bool)
    alone = mesh.scene.closed is True or (len(closed) == len(whole) == 1 and not mesh.scene.sky.any())
    outermost = (low == low.min(axis=0)).all(axis=1) & (high == high.max(axis=0)).all(axis=1)
    room = np.zeros(len(whole), dtype=bool)
    lamp = _emits(mesh, shell, len(whole))
    for s in closed[:MOST_SHELLS].tolist():
        around = room & (low <= low[s]).all(axis=1) & (high >= high[s]).all(axis=1)
        around[s] = False
        holds = (low >= low[s]).all(axis=1) & (high <= high[s]).all(axis=1)
        holds[s] = False
        if around.any():
            result[s] = volume[s] < 0
        elif holds.any() or (alone and outermost[s]):
            room[s] = True
            result[s] = volume[s] > 0
        elif lamp.any():
            near = (low <= high[s]).all(axis=1) & (high >= low[s]).all(axis=1)
            result[s] = volume[s] < 0 and not (near & lamp).any()
    return result & ~two_sided


def _emits(mesh: Mesh, shell: IntArray, count: int) -> BoolArray:
    """Shells with a face that emits (S,)."""
    emits = np.array([surface.material.emission.any() for surface in mesh.scene.surfaces])[mesh.surface]
    return np.bincount(shell[shell >= 0], emits[shell >= 0], minlength=count) > 0
