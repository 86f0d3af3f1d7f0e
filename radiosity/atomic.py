"""Files that are written whole or not at all."""

from __future__ import annotations

import errno
import os
import platform
import re
import secrets
import stat
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from .errors import MissingFileError, OutputError

CANNOT_SYNC = (errno.EINVAL, errno.ENOSYS, errno.ENOTSUP, errno.EBADF)  # some network folders
REMEDIES = {
    errno.ENOSPC: "make room on the disk",
    errno.EDQUOT: "make room within the quota",
    errno.EFBIG: "raise the limit on the size of files, or write to another disk",
    errno.EACCES: "write to a folder, or over a file, that is yours to write to",
    errno.EPERM: "write to a folder, or over a file, that is yours to write to",
    errno.EROFS: "write to another disk: this one is read-only",
    errno.EIO: "the disk may be failing: write to another one",
    errno.ENAMETOOLONG: "choose a shorter name",
}

_open: set[Path] = set()  # temporaries of this process
_tidied: set[Path] = set()  # folders where those of processes that were killed have been looked for


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a temporary path beside `path` to write to; it takes the place of `path` when all went well.

    Whatever stops the work half-way (an error, a full disk, a power cut) leaves the old file as it was. The
    temporary path keeps the suffix, because many writers choose their format by it or add it unasked. The new file has
    the permissions of the old one; where `path` is a symbolic link, the file that it leads to is replaced. Temporaries
    that a killed process of this machine has left in the folder are removed.

    Parameters
    ----------
    path : str or path-like

    Yields
    ------
    pathlib.Path

    Raises
    ------
    MissingFileError
        The folder is not there.
    OutputError
        It cannot be written to, the disk is full, or something else than a file is in the way.
    """
    target, mode = _checked(Path(path))
    _tidy(target.parent)
    temporary = target.with_name(f".{target.stem[:60]}.{_mark()}-{secrets.token_hex(4)}{target.suffix}")
    _open.add(temporary)
    try:
        try:
            yield temporary
            _flush(temporary)
            if mode is not None:
                temporary.chmod(mode)
            os.replace(temporary, target)
        except BaseException:
            with suppress(OSError):
                temporary.unlink()
            raise
        finally:
            _open.discard(temporary)
        if os.name == "posix":  # elsewhere a folder cannot be opened
            _flush(target.parent)
    except OSError as error:
        raise _named(error, Path(path)) from error


def write_bytes(path: str | os.PathLike[str], content: bytes) -> None:
    """Write a file whole or not at all, as `replacing` does."""
    with replacing(path) as temporary:
        temporary.write_bytes(content)


def discard_temporaries() -> None:
    """Remove what is being written: for a process that is about to end on the spot."""
    for temporary in list(_open):
        with suppress(OSError):
            temporary.unlink()


def _checked(path: Path) -> tuple[Path, int | None]:
    """The file that is meant, links followed, and the permissions of the one that is there, if any."""
    if not path.parent.is_dir():
        raise MissingFileError(f"cannot write {path}: there is no folder {path.parent}; make it first")
    target = Path(os.path.realpath(path))
    if not target.parent.is_dir():
        raise MissingFileError(f"cannot write {path}: it is a link to {target}, and there is no folder {target.parent}")
    try:
        status = target.stat()
    except FileNotFoundError:
        return target, None
    except OSError as error:
        raise _named(error, path) from error
    if not stat.S_ISREG(status.st_mode):
        raise OutputError(f"cannot write {path}: what is there is no file; choose another name")
    if not os.access(target, os.W_OK):
        raise _named(PermissionError(errno.EACCES, "the file is read-only"), path)
    return target, stat.S_IMODE(status.st_mode)


def _named(error: OSError, path: Path) -> OSError:
    """An error of the system as one that says which file was not written, and what to do."""
    if error.errno not in REMEDIES or isinstance(error, OutputError):
        return error
    kept = "the old file is as it was" if os.path.exists(path) else "nothing half-written is left"
    named = OutputError(f"cannot write {path}: {error.strerror}; {kept}; {REMEDIES[error.errno]}")
    named.errno = error.errno
    return named


def _mark() -> str:
    """Words for this machine and process in the names of temporaries."""
    return f"rad{zlib.crc32(platform.node().encode()):08x}-{os.getpid()}"


def _tidy(folder: Path) -> None:
    """Remove temporaries that processes of this machine left when they were killed; once a folder is enough."""
    if folder in _tidied:
        return
    _tidied.add(folder)
    machine = _mark().partition("-")[0]
    name = re.compile(rf"\..*\.{machine}-(\d+)-[0-9a-f]{{8}}(\.[^.]*)?")
    with suppress(OSError):
        for entry in os.scandir(folder):
            found = name.fullmatch(entry.name)
            if found and not _alive(int(found[1])):
                with suppress(OSError):
                    os.unlink(entry.path)


def _alive(process: int) -> bool:
    if os.name != "posix":
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True
    return True


def _flush(path: Path) -> None:
    """Have the system put a file, or the entries of a folder, on the disk."""
    handle = os.open(path, os.O_RDONLY if path.is_dir() or os.name == "posix" else os.O_RDWR)
    try:
        os.fsync(handle)
    except OSError as error:
        if error.errno not in CANNOT_SYNC:
            raise
    finally:
        os.close(handle)
