"""Form factors of one room by another package, in a Python of its own: `python peers.py NAME room.npz out.npz`.

Started by `bench_peers.py`, once for each package and size; imports nothing of radiosity, so that the packages' own
requirements cannot clash with ours. Compilers run first on a small room. Writes F (its non-zeros), seconds by the
clock and of all threads, and the process's largest memory.
"""

from __future__ import annotations

import resource
import sys
import time

import numpy as np


def pyviewfactor(vertices, quads):
    """Exact contour integrals, one ray of visibility a pair, on every thread that numba takes."""
    import pyvista
    from pyviewfactor import compute_viewfactor_matrix

    faces = np.column_stack([np.full(len(quads), 4), quads]).ravel()
    mesh = pyvista.PolyData(vertices, faces)
    return compute_viewfactor_matrix(mesh, obstacles=mesh).T  # theirs is F[to, from]


def raystrack(vertices, quads, rays=4096):
    """Cosine rays from each patch, 2 replicates of 2048."""
    from raystrack import Accuracy, Mesh, Query, Sampling, Scene, SolveOptions, Solver

    halves = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    names = [f"p{k}" for k in range(len(quads))]
    scene = Scene.from_meshes(
        {name: Mesh(vertices[quad].astype(np.float32), halves) for name, quad in zip(names, quads, strict=True)}
    )
    options = SolveOptions(Sampling(density=16, rays_per_cell=rays // 32), Accuracy(2, 0.0, "stderr", 2))
    with Solver(scene, device="cpu") as solver:
        result = solver.solve(Query.matrix(), options)
    number = {name: k for k, name in enumerate(names)}
    column = np.array([number[c.surface_id] if c.kind == "surface" else -1 for c in result.channels])
    F = np.zeros((len(quads), len(quads)))
    row = np.array([number[name] for name in result.sender_ids])[result.data.row_indices]
    there = column[result.data.channel_indices]
    np.add.at(F, (row[there >= 0], there[there >= 0]), result.data.estimates[there >= 0])
    return F


PEERS = {"pyviewfactor": pyviewfactor, "raystrack": raystrack}


def main():
    """Compute, time, write."""
    name, room, out = sys.argv[1:]
    data = np.load(room)
    PEERS[name](data["small_vertices"], data["small_quads"])
    begin, worked = time.perf_counter(), time.process_time()
    F = PEERS[name](data["vertices"], data["quads"])
    seconds, worked = time.perf_counter() - begin, time.process_time() - worked
    row, column = np.nonzero(F)
    peak = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    np.savez(out, seconds=seconds, processor=worked, peak=peak, row=row, column=column, share=F[row, column])


if __name__ == "__main__":
    main()
