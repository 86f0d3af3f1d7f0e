"""Files are written whole or not at all, where they were meant to be, with the rights they had."""

from __future__ import annotations

import errno
import os
import stat
import subprocess
import sys

import pytest

from radiosity import atomic
from radiosity.atomic import discard_temporaries, replacing, write_bytes
from radiosity.errors import MissingFileError, OutputError, RadiosityError

posix = pytest.mark.skipif(os.name != "posix", reason="links and rights as POSIX has them")


@pytest.fixture(autouse=True)
def fresh(monkeypatch):
    monkeypatch.setattr(atomic, "_tidied", set())


def names(folder):
    return sorted(entry.name for entry in folder.iterdir())


def test_a_new_file_takes_the_place_of_the_old_one(tmp_path):
    path = tmp_path / "a.txt"
    for content in (b"old", b"new"):
        write_bytes(path, content)
        assert path.read_bytes() == content
    assert names(tmp_path) == ["a.txt"]


def test_an_error_leaves_the_old_file_and_nothing_else(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")

    def fail(temporary):
        temporary.write_text("half")
        assert temporary.parent == tmp_path
        assert temporary.suffix == ".txt"
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError), replacing(path) as temporary:
        fail(temporary)
    assert path.read_text() == "old"
    assert names(tmp_path) == ["a.txt"]


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EROFS])
@pytest.mark.parametrize("place", ["write", "fsync", "replace"])
@pytest.mark.parametrize("before", [True, False], ids=["over an old file", "new"])
def test_what_the_disk_refuses_is_named_and_keeps_the_old_file(tmp_path, monkeypatch, code, place, before):
    """A full disk may tell only when the data are flushed."""
    path = tmp_path / "a.txt"
    if before:
        path.write_text("old")

    def refuse(*_):
        raise OSError(code, os.strerror(code))

    if place != "write":
        monkeypatch.setattr(os, place, refuse)

    def write(temporary):
        temporary.write_text("new")
        if place == "write":
            refuse()

    with pytest.raises(OutputError) as caught, replacing(path) as temporary:
        write(temporary)
    assert isinstance(caught.value, OSError) and isinstance(caught.value, RadiosityError)
    assert caught.value.errno == code
    assert str(caught.value).startswith(f"cannot write {path}: {os.strerror(code)}; ")
    assert ("the old file is as it was" in str(caught.value)) == before
    assert names(tmp_path) == (["a.txt"] if before else [])
    assert not before or path.read_text() == "old"


def test_folders_that_cannot_be_flushed_are_no_error(tmp_path, monkeypatch):
    def refuse(*_):
        raise OSError(errno.EINVAL, "no such operation")

    monkeypatch.setattr(os, "fsync", refuse)
    write_bytes(tmp_path / "a.txt", b"new")
    assert (tmp_path / "a.txt").read_bytes() == b"new"


def test_both_file_and_folder_are_flushed_and_in_order(tmp_path, monkeypatch):
    done = []
    monkeypatch.setattr(os, "fsync", lambda handle: done.append(stat.S_IFMT(os.fstat(handle).st_mode)))
    move = os.replace
    monkeypatch.setattr(os, "replace", lambda *paths: (done.append("move"), move(*paths)))
    write_bytes(tmp_path / "a.txt", b"new")
    assert done == [stat.S_IFREG, "move", stat.S_IFDIR][: 3 if os.name == "posix" else 2]


@posix
def test_rights_stay(tmp_path):
    path = tmp_path / "a.txt"
    write_bytes(path, b"new")
    mask = os.umask(0)
    os.umask(mask)
    assert stat.S_IMODE(path.stat().st_mode) == 0o666 & ~mask
    for mode in (0o600, 0o640, 0o664):
        path.chmod(mode)
        write_bytes(path, b"again")
        assert stat.S_IMODE(path.stat().st_mode) == mode


@posix
def test_a_link_stays_a_link(tmp_path):
    (tmp_path / "data").mkdir()
    link = tmp_path / "latest.txt"
    link.symlink_to("data/a.txt")
    for content in (b"new", b"newer"):  # also when it leads to nothing yet
        write_bytes(link, content)
        assert link.is_symlink()
        assert (tmp_path / "data" / "a.txt").read_bytes() == content
    assert names(tmp_path / "data") == ["a.txt"]
    link.unlink()
    link.symlink_to("nowhere/a.txt")
    with pytest.raises(MissingFileError, match="it is a link to .*nowhere"):
        write_bytes(link, b"new")


@posix
def test_what_is_no_file_is_not_replaced(tmp_path):
    (tmp_path / "folder.txt").mkdir()
    os.mkfifo(tmp_path / "pipe.txt")
    for path in (tmp_path / "folder.txt", tmp_path / "pipe.txt"):
        with pytest.raises(OutputError, match="what is there is no file; choose another name"):
            write_bytes(path, b"new")
    with pytest.raises(OutputError, match="no file"):
        write_bytes("/dev/null", b"new")
    with pytest.raises(OutputError, match="choose a shorter name"):
        write_bytes(tmp_path / ("x" * 300), b"new")
    with pytest.raises(MissingFileError, match="there is no folder"):
        write_bytes(tmp_path / "none" / "a.txt", b"new")


@posix
def test_a_read_only_file_is_kept(tmp_path, monkeypatch):
    path = tmp_path / "a.txt"
    path.write_text("old")
    monkeypatch.setattr(os, "access", lambda *_: False)  # as for anybody but root
    with pytest.raises(OutputError, match="the file is read-only"):
        write_bytes(path, b"new")
    assert path.read_text() == "old"


@posix
def test_what_killed_processes_left_is_removed_and_nothing_else(tmp_path):
    code = (
        "import os, signal, sys\n"
        "from radiosity.atomic import replacing\n"
        "with replacing(sys.argv[1]) as temporary:\n"
        "    temporary.write_text('half')\n"
        "    os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    path = tmp_path / "a.txt"
    path.write_text("old")
    run = subprocess.run([sys.executable, "-c", code, str(path)], check=False)
    assert run.returncode == -9
    assert path.read_text() == "old"
    assert len(names(tmp_path)) == 2
    for name in (".a.txt", ".a.1234abcd.txt", ".a.rad00000000-1-00000000.txt"):  # another program's, another machine's
        (tmp_path / name).touch()
    with replacing(tmp_path / "other.txt") as mine:
        mine.touch()
        write_bytes(tmp_path / "b.txt", b"new")
        assert mine.exists()
    strange = [".a.1234abcd.txt", ".a.rad00000000-1-00000000.txt", ".a.txt"]
    assert names(tmp_path) == [*strange, "a.txt", "b.txt", "other.txt"]


def test_a_process_that_ends_on_the_spot_cleans_up(tmp_path):
    working = replacing(tmp_path / "a.txt")
    working.__enter__().touch()
    assert len(names(tmp_path)) == 1
    discard_temporaries()
    assert names(tmp_path) == []
    with pytest.raises(FileNotFoundError):
        working.__exit__(None, None, None)
    assert not atomic._open
