"""Work that cannot be finished: nothing half-written is left, and the reason has a name."""

from __future__ import annotations

import errno
import hashlib
import os
from unittest import mock

import numpy as np

import radiosity as rad
from radiosity.errors import FileFormatError, MemoryLimitError, MissingFileError, OutputError, ParameterError

from ..files.test_kept import KEPT, LIGHT
from .case import Case, Run, refused

G = "work and results"


def solution():
    return rad.read_solution(KEPT / "solution_v1.npz")


def kept(do, error, words) -> Run:
    """The error that a case ends in; the old file has to be as it was, and alone."""
    told = refused(do, error, words)

    def run(folder):
        (folder / "a.npz").write_text("old")
        message = told(folder)
        assert (folder / "a.npz").read_text() == "old"
        assert [entry.name for entry in folder.iterdir()] == ["a.npz"]
        return message

    return run


def full(folder, place="fsync", code=errno.ENOSPC):
    with mock.patch.object(os, place, side_effect=OSError(code, os.strerror(code))):
        solution().save(folder / "a.npz")


def interrupted(folder) -> str:
    """KeyboardInterrupt when the file is about to take its place."""
    (folder / "a.npz").write_text("old")
    with mock.patch.object(os, "replace", side_effect=KeyboardInterrupt):
        try:
            solution().save(folder / "a.npz")
        except KeyboardInterrupt:
            assert [entry.name for entry in folder.iterdir()] == ["a.npz"]
            assert (folder / "a.npz").read_text() == "old"
            return "the old file, alone"
    raise AssertionError("the interrupt was lost")


def link(folder) -> str:
    (folder / "real.npz").write_text("old")
    (folder / "link.npz").symlink_to("real.npz")
    solution().save(folder / "link.npz")
    assert (folder / "link.npz").is_symlink()
    rad.read_solution(folder / "real.npz")
    return "the link leads to the new file"


def rights(folder) -> str:
    path = folder / "a.npz"
    path.touch(0o600)
    path.chmod(0o600)
    solution().save(path)
    mode = oct(path.stat().st_mode & 0o777)
    assert mode == "0o600"
    return mode


def opens(name) -> Run:
    def run(_) -> str:
        found = hashlib.sha256(rad.read_solution(KEPT / name).radiosity.tobytes()).hexdigest()
        assert found == LIGHT
        return f"SHA-256 of its light {found[:12]}…, as it was written"

    return run


def same_bits(_) -> str:
    """One seed, one and four threads."""
    patches = rad.subdivide(rad.scenes.red_rug(), patch_count=200)
    one, four = (rad.form_factors(patches, rad.MonteCarlo(rays=64), threads=n).matrix for n in (1, 4))
    assert np.array_equal(one.data, four.data) and np.array_equal(one.indices, four.indices)
    return f"{one.nnz:,} entries, all bits alike"


CASES = [
    Case(G, "full disk", "no space when the data are flushed", "the old file, and the reason",
         kept(full, OutputError, "No space left on device; the old file is as it was; make room")),
    Case(G, "full quota", "no quota when the file takes its place", "the old file, and the reason",
         kept(lambda f: full(f, "replace", errno.EDQUOT), OutputError, "quota")),
    Case(G, "failing disk", "an input/output error", "the old file, and the reason",
         kept(lambda f: full(f, "fsync", errno.EIO), OutputError, "the disk may be failing")),
    Case(G, "read-only folder", "a disk that is read-only", "the old file, and the reason",
         kept(lambda f: full(f, "replace", errno.EROFS), OutputError, "this one is read-only")),
    Case(G, "interrupt", "Ctrl-C at the last step", "the old file, alone", interrupted),
    Case(G, "no such folder", "none/a.npz", "refused: make it first",
         kept(lambda f: solution().save(f / "none" / "a.npz"), MissingFileError, "there is no folder .*make it first")),
    Case(G, "a folder in the way", "a folder named b.npz", "refused by name",
         refused(lambda f: ((f / "b.npz").mkdir(), solution().save(f / "b.npz")), OutputError, "no file; choose another name")),
    Case(G, "unknown suffix", "a.docx", "refused: what is written",
         kept(lambda f: solution().save(f / "a.docx"), FileFormatError, r"choose from \.npz")),
    Case(G, "link", "a symbolic link to a file", "the link stays, the file is new", link),
    Case(G, "rights", "a file that only its owner reads", "0o600 stays", rights),
    Case(G, "file of the first format", "a .npz without versions and hash", "opens, the light to the last bit",
         opens("solution_v1_first.npz")),
    Case(G, "file of today's format", "a .npz with them", "opens, the light to the last bit", opens("solution_v1.npz")),
    Case(G, "threads", "one seed, one thread and four", "the same bits", same_bits),
    Case(G, "no threads", "threads=0", "refused by name",
         refused(lambda _: rad.form_factors(rad.subdivide(rad.scenes.furnace()), threads=0), ParameterError, "threads")),
    Case(G, "too little memory", "form factors of 2 000 patches in 100 kB", "refused before, with the bytes",
         refused(lambda _: rad.form_factors(rad.subdivide(rad.scenes.furnace(), patch_count=2000), memory_limit=1e5),
                 MemoryLimitError, "B|bytes")),
]  # fmt: skip
