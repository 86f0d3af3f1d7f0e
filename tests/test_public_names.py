"""`import radiosity as rad` gives every public name, and loads nothing before it is used."""

import inspect
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
