"""Finished rows kept in a folder, so that an interrupted assembly goes on where it was.

Each file holds a block of rows with a checksum over all of it, and is written whole or not at all. The blocks are cut
by the number of rays alone: threads, workers and what was interrupted when do not matter. Every estimate has a folder
of its own within the one that is given, named by its fingerprint, so that other patches or parameters do not meet these
rows.
"""

from __future__ import annotations

import hashlib
import json
import os
import warnings
from collections.abc import Generator, Iterable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np

from ..atomic import write_bytes
from ..errors import CheckpointWarning, MissingFileError, ParameterError
from ..parallel import blocks
from .assembly import ARRAYS, RowBlock, joined
from .workers import RowsToMake, Span

RAYS = 1 << 21  # in one file: a fifth of a second of work, up to 16 MB
MAGIC = b"radiosity rows 1\n"
DIGEST = hashlib.sha256().digest_size
ABOUT = """\
Finished rows of form factors: {story}.
The same command or call, with the same checkpoint folder, goes on from here. When it is done, this folder can go.
"""


class Checkpoint:
    """Blocks of rows of one estimate in a folder.

    Parameters
    ----------
    folder : path
        Made if it is not there; its own parent must be.
    key : str
        Fingerprint of the estimate.
    story : str
        What the rows are, for whoever finds the folder.

    Raises
    ------
    MissingFileError
        The folder's parent is not there.
    ParameterError
        There is a file of that name.
    PermissionError
        The folder may not be written to.
    """

    def __init__(self, folder: str | os.PathLike[str], key: str, story: str) -> None:
        top = Path(folder)
        if top.exists() and not top.is_dir():
            raise ParameterError(f"checkpoint {top} is a file; give a folder, which is made if it is not there")
        if not top.absolute().parent.is_dir():
            raise MissingFileError(f"cannot make the checkpoint {top}: there is no folder {top.absolute().parent}")
        self.key = key
        self.folder = top / key[:16]
        self.folder.mkdir(parents=True, exist_ok=True)
        for left in self.folder.glob(".rows*"):  # by a process that was killed while it wrote
            left.unlink(missing_ok=True)
        write_bytes(self.folder / "about.txt", ABOUT.format(story=story).encode())

    def rows(self, work: RowsToMake, count: int, rays: int) -> Generator[RowBlock]:
        """All rows in order: those kept from before, and the others as they are made, which are then kept too.

        Parameters
        ----------
        work : RowsToMake
        count : int
            Rows in all.
        rays : int
            Of each row.
        """
        spans = blocks(count, max(1, RAYS // max(1, rays)))
        missing = [span for span in spans if not self._path(work.replicate, span).exists()]
        lacking = set(missing)
        with closing(work.make(missing)) as made:
            for span in spans:
                block = None if span in lacking else self._read(work.replicate, span)
                if block is None:
                    source = made if span in lacking else work.make([span])
                    block = joined(list(_until(span[1], source)))
                    self._write(work.replicate, block)
                yield block

    def _path(self, replicate: int, span: Span) -> Path:
        return self.folder / f"rows-{replicate}-{span[0]}-{span[1]}"

    def _write(self, replicate: int, block: RowBlock) -> None:
        path = self._path(replicate, (block.begin, block.end))
        arrays = [np.ascontiguousarray(getattr(block, name)) for name in ARRAYS]
        head = {
            "key": self.key,
            "replicate": replicate,
            "begin": block.begin,
            "shadow_rays": int(block.shadow_rays),
            "arrays": [[array.dtype.str, len(array)] for array in arrays],
        }
        body = json.dumps(head).encode() + b"\n" + b"".join(array.tobytes() for array in arrays)
        try:
            write_bytes(path, MAGIC + hashlib.sha256(body).digest() + body)
        except OSError as error:
            told = f"{error.strerror or error}; the blocks before it are kept: make room and run again"
            raise type(error)(error.errno, told, str(path)) from error

    def _read(self, replicate: int, span: Span) -> RowBlock | None:
        """A block as it was written; None, with a warning, if it is anything else."""
        path = self._path(replicate, span)
        try:
            content = path.read_bytes()
        except OSError as error:
            return _warned(path, f"cannot be read ({error.strerror})")
        digest, body = content[len(MAGIC) : len(MAGIC) + DIGEST], content[len(MAGIC) + DIGEST :]
        if not content.startswith(MAGIC) or hashlib.sha256(body).digest() != digest:
            return _warned(path, f"is damaged ({len(content)} bytes, and the checksum does not fit)")
        line, _, data = body.partition(b"\n")
        head = json.loads(line)
        block = RowBlock(head["begin"], **_arrays(data, head["arrays"]), shadow_rays=head["shadow_rays"])
        if (head["key"], head["replicate"], block.begin, block.end) != (self.key, replicate, *span):
            return _warned(path, f"holds rows {block.begin} … {block.end - 1} of another assembly")
        return block


def _until(end: int, made: Iterable[RowBlock]) -> Iterator[RowBlock]:
    """Blocks up to row `end`."""
    for block in made:
        yield block
        if block.end == end:
            return


def _arrays(data: bytes, kinds: list[list[Any]]) -> dict[str, Any]:
    place, arrays = 0, {}
    for name, (kind, length) in zip(ARRAYS, kinds, strict=True):
        arrays[name] = np.frombuffer(data, dtype=kind, count=length, offset=place)
        place += arrays[name].nbytes
    return arrays


def _warned(path: Path, why: str) -> RowBlock | None:
    """No block, and why."""
    warnings.warn(f"checkpoint {path} {why}: its rows are computed again", CheckpointWarning, stacklevel=2)
    return None
