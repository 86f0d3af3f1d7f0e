"""`import radiosity as rad` gives every public name, and loads nothing before it is used."""

import dataclasses
import inspect
import itertools
import re
import subprocess
import sys
from types import ModuleType

import pytest

import radiosity as rad

SUBMODULES = {"colour", "errors", "photometry", "scenes", "shortcuts", "thermal"}
HEAVY = ("pyvista", "vtk", "vtkmodules", "matplotlib", "dask", "numba", "trimesh", "embreex", "scipy")


def in_a_fresh_python(code: str) -> str:
    """What a few lines print in a Python that has imported nothing."""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert run.returncode == 0, run.stderr
    return run.stdout.strip()


@pytest.mark.parametrize("name", rad.__all__)
def test_name_is_there_and_described(name: str) -> None:
    value = getattr(rad, name)
    if name in SUBMODULES:
        assert isinstance(value, ModuleType)
    elif name == "__version__":
        assert value[0].isdigit()
    else:
        assert inspect.isclass(value) or inspect.isfunction(value), f"rad.{name} is {value!r}"
        assert value.__name__ == name
        assert value.__module__.startswith("radiosity.")
        assert value.__doc__, f"rad.{name} has no docstring"


@pytest.mark.parametrize("name", rad.__all__)
def test_what_a_name_takes_is_described(name: str) -> None:
    """Each parameter of a function, each field of a dataclass heads a paragraph of the docstring."""
    value = getattr(rad, name)
    if inspect.isfunction(value):
        taken = [p.name for p in inspect.signature(value).parameters.values() if p.kind is not p.VAR_KEYWORD]
    elif dataclasses.is_dataclass(value):
        taken = [field.name for field in dataclasses.fields(value) if field.init and field.name.isidentifier()]
        taken = [name for name in taken if not name.startswith("_")]
    else:
        return
    lines = inspect.getdoc(value).splitlines()
    flush = [(line, below) for line, below in itertools.pairwise([*lines, ""]) if not line.startswith(" ")]
    heads = [line for line, below in flush if " : " in line or below.startswith("    ")]
    described = {word for head in heads for word in re.findall(r"\w+", head.partition(" : ")[0])}
    assert sorted(set(taken) - described) == []


@pytest.mark.parametrize("name", rad.__all__)
def test_what_an_object_can_do_is_described(name: str) -> None:
    value = getattr(rad, name)
    if inspect.isclass(value):
        own = {
            m: f
            for m, f in vars(value).items()
            if not m.startswith("_") and (inspect.isfunction(f) or isinstance(f, property))
        }
        assert [m for m, f in own.items() if not inspect.getdoc(f)] == []


def test_a_name_that_does_not_exist_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no_such_name"):
        _ = rad.no_such_name  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    "line",
    [
        "import radiosity",
        "import radiosity.cli",
        "from radiosity import Material, Surface, Scene, errors",
    ],
)
def test_nothing_heavy_is_loaded_before_it_is_used(line: str) -> None:
    loaded = in_a_fresh_python(f"import sys; {line}; print(*[m for m in {HEAVY} if m in sys.modules])")
    assert loaded == ""


@pytest.mark.parametrize(
    "first",
    [
        "import radiosity.form_factors.hemicube, radiosity.solve",
        "from radiosity.form_factors import FormFactors; from radiosity.solve import solve",
        "import importlib; [importlib.import_module('radiosity.' + m) for m in ('form_factors', 'solve')]",
        "rad.MonteCarlo, rad.Solution",
        "rad.solve, rad.form_factors; import radiosity.form_factors.hemicube, radiosity.solve",
    ],
)
def test_functions_are_not_hidden_by_the_modules_of_their_name(first: str) -> None:
    """Importing a submodule binds it on its package, where the function of the same name should be."""
    kinds = in_a_fresh_python(
        f"import radiosity as rad; {first}; print(type(rad.form_factors).__name__, type(rad.solve).__name__)"
    )
    assert kinds == "function function"
