"""Gives a lecture: in a window, or as a page or pictures to hand out."""

from __future__ import annotations

from pathlib import Path

from ..errors import FileFormatError
from .lecture import Lecture, Place
from .talk import Talk

SIZE = (1600, 900)


def run(lecture: Lecture | Talk, size: tuple[int, int] = SIZE) -> None:
    """Give a lecture in a window, and wait until it is closed.

    Parameters
    ----------
    lecture : Lecture or Talk
        A `Talk` has its light computed already.
    size : (int, int)
        Pixels.

    Raises
    ------
    DisplayError
        No display; `export` works without.
    """
    from .window import LectureWindow

    LectureWindow(_talk(lecture), size=size).run()


def export(lecture: Lecture | Talk, path: str | Path, size: tuple[int, int] = SIZE) -> list[Path]:
    """Write a lecture to be handed out.

    Parameters
    ----------
    lecture : Lecture or Talk
    path : path
        ``talk.html``: one page with everything in it, to be read and played with in a browser. A folder (made if it
        is not there): every step as a picture, ``01.png``, ``02.png``, ``02_answer.png``, …, for slides.
        ``talk.png``: the same with ``talk_`` in front of their names.
    size : (int, int)
        Pixels of a picture.

    Returns
    -------
    list of Path
        What was written.

    Raises
    ------
    FileFormatError
        Another suffix.
    DisplayError
        Pictures, on a machine that cannot draw.
    """
    path = Path(path)
    check(path)
    if path.suffix.lower() == ".html":
        from .page import write_lecture

        return [write_lecture(_talk(lecture), path)]
    if path.suffix.lower() == ".png":
        return _pictures(_talk(lecture), path.parent, f"{path.stem}_", size)
    path.mkdir(parents=True, exist_ok=True)
    return _pictures(_talk(lecture), path, "", size)


def check(path: Path) -> None:
    """Refuse what a lecture cannot be written as, before any work.

    Raises
    ------
    FileFormatError
    """
    if path.suffix.lower() not in ("", ".html", ".png") and not path.is_dir():
        raise FileFormatError(f"{path}: a lecture is written as .html, as .png (one a step), or into a folder")


def _talk(lecture: Lecture | Talk) -> Talk:
    return lecture if isinstance(lecture, Talk) else Talk.prepare(lecture)


def _pictures(talk: Talk, folder: Path, before: str, size: tuple[int, int]) -> list[Path]:
    """One picture for each step, and one for each answer."""
    from ..viewer.figures import save_image
    from .window import LectureWindow

    window = LectureWindow(talk, off_screen=True, size=size)
    written = []
    for place in Place(talk.lecture).all():
        window.go(place)
        written.append(folder / f"{before}{place.number + 1:02d}{'_answer' if place.revealed else ''}.png")
        save_image(written[-1], window.image())
    window.close()
    return written
