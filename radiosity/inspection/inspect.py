"""Everything that is difficult about a scene, found at once."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from ..coplanar import DEPTH
from ..faces import FLAT
from ..finding import MOST_PLACES, Finding, Severity, counted, names
from ..geometry import quad_bends
from ..scene import Scene
from .close import coincident
from .light import light
from .mesh import Mesh
from .orientation import orientation
from .seams import cracks, open_edges, t_junctions

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

SLENDER = 1e5  # longest edge over height: rays hit the neighbours of slimmer faces now and then
FAR = 1e9  # sizes of the scene from the origin, beyond which float64 rounds its shape visibly


def findings(scene: Scene) -> tuple[Finding, ...]:
    """Report everything about a scene that makes its light wrong, or that its maker would want to know.

    What no scene may have (indices out of range, numbers that are not finite) is refused when it is made; what is
    reported here is legal. Nothing is changed.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    tuple of Finding
        Errors first, then warnings, then notes.

    Examples
    --------
    >>> from radiosity.scenes import cornell_box, furnace
    >>> findings(furnace())
    ()
    >>> [(finding.kind, finding.count) for finding in findings(cornell_box())]
    [('bent quads', 1), ('T-junctions', 22), ('open edges', 6)]
    """
    mesh = Mesh.of(scene)
    found = [one for check in CHECKS for one in check(mesh)]
    return tuple(sorted(found, key=lambda one: -one.severity))


def _finding(
    mesh: Mesh, kind: str, severity: Severity, faces: IntArray, what: str, remedy: str, places: FloatArray | None = None
) -> Finding:
    """A finding about faces; `what` follows the surfaces' names."""
    owners = mesh.names(faces)
    where = mesh.centroid[faces] if places is None else places
    return Finding(kind, severity, owners, len(where), f"{names(owners)} {what}", remedy, where[:MOST_PLACES])


def _flat_faces(mesh: Mesh) -> Iterator[Finding]:
    """Faces without area; a surface of nothing else is refused by a solve."""
    flat = np.flatnonzero(mesh.flat)
    if not len(flat):
        return
    rest = np.bincount(mesh.surface[~mesh.flat], minlength=len(mesh.scene.surfaces))
    empty = rest[mesh.surface[flat]] == 0
    for faces, severity, what, remedy in (
        (flat[empty], Severity.ERROR, "only of them", "leave the surface out"),
        (flat[~empty], Severity.NOTE, "", "they are left out; nothing is lost"),
    ):
        if len(faces):
            only = f" and consists {what}" if what else ""
            what = f"has {counted(len(faces), 'face')} without area{only} (face {mesh.face[faces[0]]})"
            yield _finding(mesh, "zero-area faces", severity, faces, what, remedy)


def _quads(mesh: Mesh) -> Iterator[Finding]:
    """Quads whose edges cross, and bent ones."""
    faces = np.flatnonzero(mesh.crossed)
    if len(faces):
        what = f"has {counted(len(faces), 'quad')} whose edges cross over (face {mesh.face[faces[0]]})"
        remedy = "reorder their corners, or cut them into triangles"
        yield _finding(mesh, "crossed quads", Severity.ERROR, faces, what, remedy)
    quads = np.flatnonzero(mesh.quad & ~mesh.flat & ~mesh.crossed)
    bend = quad_bends(mesh.corners[quads])
    bent = bend > FLAT
    if bent.any():
        faces = quads[bent][np.argsort(-bend[bent])]
        what = f"has {counted(len(faces), 'bent quad')}, by {np.rad2deg(bend[bent].max()):.2g}° at most"
        remedy = "each is taken as two triangles"
        yield _finding(mesh, "bent quads", Severity.NOTE, faces, what, remedy)


def _slivers(mesh: Mesh) -> Iterator[Finding]:
    """Faces so slim that rays cannot tell them from their neighbours."""
    height = np.where(mesh.quad, 1.0, 2.0) * mesh.area / np.where(mesh.longest > 0, mesh.longest, 1.0)
    narrow = ~mesh.flat & ~mesh.crossed & ((height < DEPTH * mesh.size) | (mesh.longest > SLENDER * height))
    faces = np.flatnonzero(narrow)
    if not len(faces):
        return
    faces = faces[np.argsort(height[faces], kind="stable")]
    what = (
        f"has {counted(len(faces), 'sliver')}, down to {height[faces[0]]:.2g} m wide and up to "
        f"{mesh.longest[faces].max():.2g} m long; rays resolve {DEPTH * mesh.size:.2g} m here"
    )
    remedy = "join them with their neighbours: a share of the rays that should meet them meets those"
    yield _finding(mesh, "slivers", Severity.WARNING, faces, what, remedy)


def _turned(mesh: Mesh) -> Iterator[Finding]:
    """Normals: faces against their neighbours, shells that are inside out."""
    found = orientation(mesh)
    fix = "turn them round (rad.read_scene(…, fix_normals=True), scene.fixed_normals(), --fix-normals)"
    solid = found.shell >= 0
    turned = solid & found.turned & ~mesh.two_sided
    whole = solid & found.whole[found.shell]
    for faces, remedy in (
        (np.flatnonzero(turned & whole), fix),
        (np.flatnonzero(turned & ~whole), "turn them round in the modelling program, or make the surface two-sided"),
    ):
        if len(faces):
            what = f"has {counted(len(faces), 'face')} against their neighbours: it shows backs where they show fronts"
            yield _finding(mesh, "flipped normals", Severity.WARNING, faces, what, remedy)
    for volume, one, many in (
        (found.volume, "closed room that faces outwards", "closed rooms that face outwards"),
        (-found.volume, "closed body that faces inwards", "closed bodies that face inwards"),
    ):
        shells = np.flatnonzero(found.inside_out & (volume > 0))
        faces = np.flatnonzero(solid & np.isin(found.shell, shells))
        if len(shells):
            verb = "belongs" if len(mesh.names(faces)) == 1 else "belong"
            what = f"{verb} to {f'a {one}' if len(shells) == 1 else f'{len(shells)} {many}'}"
            yield _finding(mesh, "inside out", Severity.WARNING, faces, what, fix)


def _edges(mesh: Mesh) -> Iterator[Finding]:
    """Edges that more than two faces share, and edges that only one has."""
    edges = mesh.edges
    if len(edges.crowded):
        verb = "has" if len(mesh.names(edges.face[edges.crowded])) == 1 else "have"
        what = f"{verb} {counted(len(edges.crowded), 'edge')} of three faces or more"
        remedy = "harmless for light, but their shells count as neither open nor closed; is a wall there twice?"
        places = edges.middle[edges.crowded]
        yield _finding(mesh, "non-manifold edges", Severity.NOTE, edges.face[edges.crowded], what, remedy, places)
    seams, faces = t_junctions(mesh)
    if len(seams):
        verb = "meets" if len(mesh.names(faces)) == 1 else "meet"
        what = f"{verb} other faces in {counted(len(seams), 'T-junction')} (a corner of one on an edge of the other)"
        remedy = "no light is lost, but a scene is not found closed across them: declare it (Scene(closed=True))"
        yield _finding(mesh, "T-junctions", Severity.NOTE, faces, what, remedy, seams)
    gaps, owners, widest = cracks(mesh)
    if len(gaps):
        verb = "meets" if len(mesh.names(owners)) == 1 else "meet"
        what = f"nearly {verb} other faces at {counted(len(gaps), 'corner')}, but are up to {widest:.2g} m apart"
        remedy = "weld the corners in the modelling program, so that the scene can be found closed"
        yield _finding(mesh, "cracks", Severity.NOTE, owners, what, remedy, gaps)
    rim = open_edges(mesh)
    rim = rim[~mesh.two_sided[edges.face[rim]]]  # a sheet has edges
    if len(rim) and not len(gaps):
        yield _open(mesh, rim)


def _open(mesh: Mesh, rim: IntArray) -> Finding:
    edges = mesh.edges
    length = np.linalg.norm(edges.end - edges.begin, axis=1)[rim]
    order = rim[np.argsort(-length, kind="stable")]
    what = f"{{}} {counted(len(order), 'edge')} that no other face shares ({length.sum():.3g} m in all)"
    if mesh.scene.closed:
        remedy = "the scene is declared closed: rays that leave through a hole count as leaks, so close it"
        severity = Severity.WARNING
    else:
        remedy = "light leaves there, and one-sided faces are black from behind"
        severity = Severity.NOTE
    verb = "has" if len(mesh.names(edges.face[order])) == 1 else "have"
    return _finding(mesh, "open edges", severity, edges.face[order], what.format(verb), remedy, edges.middle[order])


def _far(mesh: Mesh) -> Iterator[Finding]:
    """A scene so far from the origin that its coordinates have few digits left."""
    middle = 0.5 * (mesh.corners.min(axis=(0, 1)) + mesh.corners.max(axis=(0, 1)))
    distance = float(np.linalg.norm(middle))
    if distance > FAR * mesh.size:
        grain = float(np.spacing(distance))
        yield Finding(
            "far from the origin", Severity.WARNING, mesh.scene.surface_names, len(mesh),
            f"the scene is {mesh.size:.3g} m large and {distance:.3g} m from the origin, "
            f"so that its corners are rounded to {grain:.1g} m",
            "move it near the origin before it is written", np.zeros((0, 3)),
        )  # fmt: skip


CHECKS: tuple[Callable[[Mesh], Iterator[Finding]], ...] = (
    _flat_faces, _quads, _slivers, coincident, _turned, _edges, _far, light,
)  # fmt: skip
