"""Compiled kernels are never older than the sources they are made of, and what was kept is never in the way."""

from __future__ import annotations

import importlib
import subprocess
import sys
from pathlib import Path

import pytest

from radiosity import compiled

OUTER = """
from typing import NamedTuple
from .compiled import kernel
from .inner import factor


class {name}(NamedTuple):
    x: float


@kernel
def twice(pair):
    return factor(pair.x)
"""

INNER = """
from .compiled import kernel


@kernel
def factor(x):
    return {factor} * x
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A small package with a kernel that calls another file's."""
    place = tmp_path / "folder"
    place.mkdir()
    (place / "__init__.py").write_text("")
    (place / "compiled.py").write_text(Path(compiled.__file__).read_text())
    (place / "outer.py").write_text(OUTER.format(name="Pair"))
    (place / "inner.py").write_text(INNER.format(factor="2.0"))
    return place


def run(folder: Path, name: str = "Pair") -> str:
    program = f"import sys\nsys.path.insert(0, {str(folder.parent)!r})\n" + (
        f"from folder.outer import {name}, twice\nprint(twice({name}(3.0)))\n"
    )
    ran = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


def test_a_change_in_a_file_that_is_called_is_noticed(folder: Path) -> None:
    """Numba alone would print 6.0 twice: the file of the function called has not changed."""
    assert run(folder) == "6.0\n"
    assert list((folder / "__pycache__").glob("outer.twice*.nbc")), "kept on disk"
    (folder / "inner.py").write_text(INNER.format(factor="3.00"))
    assert run(folder) == "9.0\n"


def test_what_was_kept_of_names_that_are_gone_is_forgotten(folder: Path) -> None:
    """Numba alone would end in an AttributeError, for ever."""
    assert run(folder) == "6.0\n"
    (folder / "outer.py").write_text(OUTER.format(name="Couple"))
    assert run(folder, "Couple") == "6.0\n"


def test_the_same_sources_are_compiled_once(folder: Path) -> None:
    run(folder)
    kept = {path: path.stat().st_mtime_ns for path in (folder / "__pycache__").glob("*.nb?")}
    run(folder)
    assert {path: path.stat().st_mtime_ns for path in (folder / "__pycache__").glob("*.nb?")} == kept


def test_a_kernel_is_made_of_all_that_it_calls() -> None:
    importlib.import_module("radiosity.form_factors.monte_carlo")
    assert compiled.made_of("radiosity.rays") != compiled.made_of("radiosity.form_factors.monte_carlo")
    with pytest.MonkeyPatch.context() as patch:
        before = compiled.made_of("radiosity.form_factors.monte_carlo")
        text, imported = compiled._source("radiosity.rays")
        known = compiled._source
        changed = (text + "#", imported)
        patch.setattr(compiled, "_source", lambda name: changed if name == "radiosity.rays" else known(name))
        assert compiled.made_of("radiosity.form_factors.monte_carlo") != before
