"""Imports go down only.

The package is a house of floors, one a line of `FLOORS`. A module may import from its own floor's package and from
the floors below, never from above, wherever in the module the import stands. Doors open upward at two places, inside
the functions that need them. Heavy libraries are imported at the top of a module only on the floors that live on them.
"""

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "radiosity"

# Top to bottom. A new module is a new line here: say where it stands.
FLOORS = (
    "__main__",
    "cli",
    "study",
    "lectures",
    "viewer",
    "files",
    "photometry",
    "thermal",
    "solve",
    "solution",
    "accuracy",
    "plan",
    "series",
    "relight",
    "balance",
    "backs",
    "dark",
    "irradiance",
    "hemisphere",
    "shortcuts",
    "path_tracer",
    "render",
    "camera",
    "exchange",
    "certificate",
    "solvers",
    "transport",
    "form_factors",
    "inspection",
    "convex",
    "rays",
    "face_points",
    "nested",
    "patches",
    "contacts",
    "faces",
    "scenes",
    "overlaps",
    "scene",
    "finding",
    "coplanar",
    "trapezoids",
    "polygons",
    "geometry",
    "display",
    "colour",
    "sparse",
    "prefetch",
    "sequences",
    "compiled",
    "ahead",
    "executors",
    "parallel",
    "memory",
    "atomic",
)
LEAVES = ("result", "errors", "statistics", "progress", "_version")  # import nothing of ours, not even each other
HOUSE = FLOORS + LEAVES

# These speak to people, and write what a user would write: `import radiosity as rad`.
MAY_USE_PUBLIC_NAMES = ("cli", "study", "lectures")

# (module, function) → what it may import from above. A picture is a file too, so saving reaches the viewer's figures.
DOORS = {
    ("solution", "Solution.save"): ("files", "viewer"),
    ("solution", "Solution.show"): ("viewer",),
    ("scene", "Scene.validate"): ("inspection",),
    ("scene", "Scene.fixed_normals"): ("inspection",),
}

# Library → the floors whose modules may import it at their top; elsewhere, inside the function that needs it.
HEAVY = {
    "dask": (),
    "distributed": (),
    "embreex": ("rays",),
    "imageio": (),
    "matplotlib": ("viewer", "lectures", "study"),
    "numba": ("compiled",),
    "pyvista": ("viewer",),
    "trimesh": ("files",),
    "vtk": ("viewer",),
    "vtkmodules": ("viewer",),
}


@dataclass(frozen=True)
class Import:
    """One imported name: where it stands in the source, and what it is."""

    place: str  # "solution.py:12"
    module: str  # dotted, inside the package: "form_factors.hemicube"; "" for radiosity/__init__.py
    function: str  # "Solution.save"; "" at the top of the module
    target: str  # "radiosity.files.read_scene", "numpy.linalg"

    @property
    def floor(self) -> str:
        return self.module.partition(".")[0]

    @property
    def top(self) -> str:
        return self.target.partition(".")[0]

    @property
    def target_floor(self) -> str:
        return self.target.split(".")[1] if "." in self.target else ""


def module_name(source: Path, package: Path) -> str:
    parts = source.relative_to(package).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imported_names(node: ast.Import | ast.ImportFrom, source: Path, package: Path) -> list[str]:
    """The full names that an import statement names, the package being called radiosity."""
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    base = node.module or ""
    if node.level:
        folder = source.parents[node.level - 1].relative_to(package.parent)
        base = ".".join(["radiosity", *folder.parts[1:]] + ([base] if base else []))
    return [f"{base}.{alias.name}" for alias in node.names]


def imports_of(source: Path, package: Path) -> Iterator[Import]:
    """Every import of a module, also those inside its functions."""
    module = module_name(source, package)

    def visit(node: ast.AST, inside: tuple[str, ...], called: bool) -> Iterator[Import]:
        for child in ast.iter_child_nodes(node):
            if isinstance(child, (ast.Import, ast.ImportFrom)):
                place = f"{source.relative_to(package)}:{child.lineno}"
                for target in imported_names(child, source, package):
                    yield Import(place, module, ".".join(inside) if called else "", target)
            elif isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef)):
                yield from visit(child, (*inside, child.name), True)
            elif isinstance(child, ast.ClassDef):
                yield from visit(child, (*inside, child.name), called)
            else:
                yield from visit(child, inside, called)

    yield from visit(ast.parse(source.read_text(encoding="utf-8")), (), False)


def complaint_about_ours(found: Import) -> str | None:
    """What is wrong with an import of the package's own, if anything."""
    if found.target_floor not in HOUSE:  # the package itself, or a public name of it
        if found.floor in MAY_USE_PUBLIC_NAMES:
            return None
        return f"{found.place}: imports {found.target}, which may lead anywhere; import from the module that has it"
    if found.target_floor == found.floor:
        return None
    if found.target_floor in DOORS.get((found.module, found.function), ()):
        return None
    if found.floor in LEAVES:
        return f"{found.place}: {found.module} is a leaf and imports {found.target}"
    if HOUSE.index(found.target_floor) < HOUSE.index(found.floor):
        return f"{found.place}: {found.module} imports {found.target}, which stands above it"
    return None


def complaint_about_others(found: Import) -> str | None:
    """What is wrong with an import of somebody else's, if anything."""
    if found.function or found.top not in HEAVY or found.floor in HEAVY[found.top]:
        return None
    return f"{found.place}: imports {found.target} at the top; import it inside the function that needs it"


def complaints(package: Path) -> list[str]:
    """Everything in a package's imports that breaks the rules of the house, one sentence each."""
    found = []
    for source in sorted(package.rglob("*.py")):
        module = module_name(source, package)
        if module and module.partition(".")[0] not in HOUSE:
            found.append(f"{source.relative_to(package)}: on no floor; add it to FLOORS, where it belongs")
            continue
        for one in imports_of(source, package):
            found.append(complaint_about_ours(one) if one.top == "radiosity" else complaint_about_others(one))
    return [sentence for sentence in found if sentence]


def test_imports_go_down_only() -> None:
    assert not complaints(PACKAGE), "\n".join(complaints(PACKAGE))


def test_the_doors_are_where_the_house_says() -> None:
    """A door that nobody walks through would be a hole in the rule."""
    for module in ("solution", "scene"):
        found = imports_of(PACKAGE / f"{module}.py", PACKAGE)
        used = {one.function for one in found if one.target_floor in ("files", "viewer", "inspection")}
        assert used == {function for door, function in DOORS if door == module}


GOOD = {
    "__init__.py": "import lazy_loader",
    "errors.py": "import numpy as np",
    "scene.py": "from .errors import SceneError",
    "form_factors/__init__.py": "from .hemicube import Hemicube",
    "form_factors/hemicube.py": "import scipy\nfrom .. import patches\nfrom . import factors",
    "solution.py": "class Solution:\n    def save(self):\n        from .files import write\n        import vtk",
    "lectures/cornell.py": "import radiosity as rad\nfrom radiosity.viewer import window",
}


@pytest.mark.parametrize(
    ("file", "code", "sentence"),
    [
        ("scene.py", "from .patches import subdivide", "which stands above it"),
        ("scene.py", "from . import solve", "which stands above it"),
        ("scene.py", "def f():\n    from .patches import subdivide", "which stands above it"),
        ("scene.py", "if TYPE_CHECKING:\n    from .patches import Patches", "which stands above it"),
        ("scene.py", "import radiosity.patches", "which stands above it"),
        ("scene.py", "import radiosity as rad", "which may lead anywhere"),
        ("scene.py", "from radiosity import subdivide", "which may lead anywhere"),
        ("scene.py", "from . import subdivide", "which may lead anywhere"),
        ("solvers/neumann.py", "from .. import certificate", "which stands above it"),
        ("solvers/deep/neumann.py", "from ...viewer.window import Window", "which stands above it"),
        ("solution.py", "from .files import write_solution", "which stands above it"),
        ("solution.py", "class Solution:\n    from .files import write_solution", "which stands above it"),
        ("solution.py", "class Solution:\n    def plot(self):\n        from . import viewer", "which stands above it"),
        ("solution.py", "class Solution:\n    def show(self):\n        from . import cli", "which stands above it"),
        ("errors.py", "from .result import Step", "is a leaf"),
        ("gadgets.py", "", "on no floor"),
        ("gadgets/__init__.py", "", "on no floor"),
        ("scene.py", "import pyvista as pv", "at the top"),
        ("files/vtp.py", "from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter", "at the top"),
        ("viewer/state.py", "import dask.distributed", "at the top"),
        ("geometry.py", "try:\n    import numba\nexcept ImportError:\n    pass", "at the top"),
    ],
)
def test_a_house_built_wrong_is_noticed(tmp_path: Path, file: str, code: str, sentence: str) -> None:
    package = tmp_path / "radiosity"
    for name, text in GOOD.items():
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text(text)
    assert complaints(package) == []

    (package / file).parent.mkdir(parents=True, exist_ok=True)
    (package / file).write_text(code)
    (found,) = complaints(package)
    assert found.startswith(file)
    assert sentence in found
