"""What the suffix of a file says about how a solution is shown in it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import FileFormatError

if TYPE_CHECKING:
    from ..solution import Solution

SUFFIXES = (".png", ".gif", ".mp4", ".html", ".glb")


def export(solution: Solution, path: str | Path, **settings: Any) -> Path:
    """Write a solution to be looked at: picture, film, page or baked scene.

    Parameters
    ----------
    solution : Solution
    path : path
        `.png`: one picture (`figures.save_picture`). `.gif`, `.mp4`: a film of the bounces
        (`animation.write_animation`). `.html`: the page (`page.write_page`). `.glb`: the light as colours of the
        patches (`baked.write_baked`).
    **settings
        What the writer takes.

    Returns
    -------
    Path

    Raises
    ------
    FileFormatError
        Another suffix.
    """
    return _writer(Path(path))(solution, path, **settings)


def _writer(path: Path) -> Callable[..., Path]:
    """The function for a suffix; what it needs is loaded now."""
    suffix = path.suffix.lower()
    if suffix == ".png":
        from .figures import save_picture

        return save_picture
    if suffix in (".gif", ".mp4"):
        from .animation import write_animation

        return write_animation
    if suffix == ".html":
        from .page import write_page

        return write_page
    if suffix == ".glb":
        from .baked import write_baked

        return write_baked
    raise FileFormatError(f"{path}: nothing to look at is written as {suffix!r}; choose from {', '.join(SUFFIXES)}")
