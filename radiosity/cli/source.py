"""From a word of the command line to a scene or a solution: a file, or the name of a built-in scene."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import Literal

import radiosity as rad

from .arguments import refuse_solve_settings, solve_settings
from .console import Screen

DEFAULT = "cornell_box"
MESH = Path("meshes") / f"{DEFAULT}.glb"


def scene(word: str, args: argparse.Namespace, contacts: Literal["cut", "keep"] | None = None) -> rad.Scene:
    """The scene that a word names, with the lamps and the sky of the command line; `contacts` as for `read_scene`.

    Raises
    ------
    RadiosityError
        No such file or scene, or one that cannot be read.
    """
    lamps = dict(args.lamp)
    if not Path(word).is_file() and word in rad.scenes.BUILT_IN:
        if args.unit:
            raise rad.errors.ParameterError(f"--unit is for files; the built-in scene {word!r} is in metres")
        if args.fix_normals:
            raise rad.errors.ParameterError(f"--fix-normals is for files; the normals of {word!r} are right")
        if args.turn:
            raise rad.errors.ParameterError(f"--turn is for files; the faces of {word!r} look the right way")
        return _lit(rad.scenes.BUILT_IN[word](), lamps, args.sky)
    if not Path(word).exists() and not Path(word).suffix:
        known = ", ".join(rad.scenes.BUILT_IN)
        raise rad.errors.MissingFileError(f"{word!r} is neither a file nor a built-in scene; there are {known}")
    return rad.read_scene(
        word,
        unit=args.unit,
        lamps=lamps or None,
        sky=args.sky,
        contacts=contacts,
        fix_normals=bool(args.fix_normals),
        turn=args.turn or (),
    )


def _lit(scene: rad.Scene, lamps: Mapping[str, list[float]], sky: list[float] | None) -> rad.Scene:
    from ..relight import relit_scene

    return relit_scene(scene, emission=lamps, sky=sky)


def default() -> str:
    """The Cornell box: the file of a checkout, if this is one, else the built-in scene."""
    for folder in (Path(), Path(__file__).resolve().parents[2]):
        if (folder / MESH).is_file():
            return str(folder / MESH)
    return DEFAULT


def solution(word: str, args: argparse.Namespace, screen: Screen) -> rad.Solution:
    """The solution that a word names: read from .npz, or solved.

    Raises
    ------
    RadiosityError
    """
    if Path(word).suffix.lower() == ".npz":
        return _read(word, args)
    settings = solve_settings(args)
    with screen.progress() as tell:
        return rad.solve(scene(word, args), progress=tell, **settings)


def _read(word: str, args: argparse.Namespace) -> rad.Solution:
    """A solution as it was saved, under the lamps and the sky of the command line."""
    refuse_solve_settings(args, f"{word} is solved already")
    found = rad.read_solution(word)
    if args.lamp or args.sky:
        return found.relight(emission=dict(args.lamp) or None, sky=args.sky)
    return found
