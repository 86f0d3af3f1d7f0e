"""Compiled kernels are never older than the sources they are made of."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from radiosity.form_factors import kernel

FOLDER = Path(kernel.__file__).parent

PROGRAM = """
import sys
sys.path.insert(0, {folder!r})
from folder.outer import twice
print(twice(3.0))
"""


def test_every_module_with_kernels_is_counted():
    users = {path.stem for path in FOLDER.glob("*.py") if "@kernel" in path.read_text()}
    assert users | {"kernel", "gauss"} == set(kernel.MODULES)
    assert all((FOLDER / f"{name}.py").exists() for name in kernel.MODULES)


def test_a_change_in_a_file_that_is_called_is_noticed(tmp_path):
    """Numba alone would print 6.0 twice: the file of the function called has not changed."""
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / "__init__.py").write_text("")
    source = (FOLDER / "kernel.py").read_text()
    first, last = source.index("MODULES = ("), source.index(")", source.index("MODULES = ("))
    (folder / "kernel.py").write_text(source[:first] + 'MODULES = ("kernel", "inner", "outer"' + source[last:])
    (folder / "outer.py").write_text(
        "from .inner import factor\nfrom .kernel import kernel\n\n\n@kernel\ndef twice(x):\n    return factor(x)\n"
    )
    inner = "from .kernel import kernel\n\n\n@kernel\ndef factor(x):\n    return {} * x\n"

    def run() -> str:
        program = PROGRAM.format(folder=str(tmp_path))
        return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout

    (folder / "inner.py").write_text(inner.format("2.0"))
    assert run() == "6.0\n"
    assert list((folder / "__pycache__").glob("outer.twice*.nbc")), "kept on disk"
    (folder / "inner.py").write_text(inner.format("3.00"))
    assert run() == "9.0\n"
