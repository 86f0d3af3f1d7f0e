"""How kernels are compiled: when they are first called, kept on disk, and anew when their sources have changed.

And what they can tell the processor that Python has no words for.
"""

from __future__ import annotations

import hashlib
import re
import sys
from collections.abc import Callable
from functools import cache
from importlib.util import resolve_name
from pathlib import Path
from typing import Any

from llvmlite import ir
from numba import njit
from numba.core import types
from numba.extending import intrinsic

MARK = "@kernel"
READ, NEAREST, DATA = 0, 3, 1  # arguments of `llvm.prefetch`: to read, into the nearest cache, no instructions
IMPORTED = re.compile(r"^from (\.[\w.]*) import", re.MULTILINE)


def kernel(function: Callable[..., Any] | None = None, *, inline: str = "never") -> Any:
    """Compile a function when it is first called, and keep the result on disk.

    Without the interpreter's lock, so that threads run kernels side by side. Division by zero gives infinity, as in
    numpy, instead of a check at each division.

    numba asks only whether the file of a function itself has changed, and would go on using what was compiled with
    older versions of the functions it calls in other files. So the stamp by which it asks is given their sources too.
    And what it kept may speak of names that are gone, which it finds out only by failing: that counts as nothing kept.

    Parameters
    ----------
    function : callable
    inline : {"never", "always"}, optional
        As numba has it.
    """
    if function is None:
        return lambda function: kernel(function, inline=inline)
    compiled = njit(cache=True, nogil=True, error_model="numpy", inline=inline)(function)
    index: Any = getattr(getattr(compiled, "_cache", None), "_cache_file", None)
    if hasattr(index, "_source_stamp") and hasattr(index, "_load_index"):  # else another numba, which does as it does
        index._source_stamp = (index._source_stamp, made_of(function.__module__))
        index._load_index = _forgiving(index._load_index)
    return compiled


def _forgiving(load: Callable[[], Any]) -> Callable[[], Any]:
    """An index that cannot be read is of another version of this package, and holds nothing."""

    def load_index() -> Any:
        try:
            return load()
        except (AttributeError, ImportError):
            return {}

    return load_index


def made_of(module: str) -> str:
    """A hash of the sources of a module and of those with kernels that it imports, and so on; empty without files."""
    seen, found = set(), []
    ahead = [module]
    while ahead:
        name = ahead.pop()
        if name in seen:
            continue
        seen.add(name)
        text, imported = _source(name)
        if name == module or MARK in text:
            found.append((name, text))
            ahead.extend(imported)
    return hashlib.sha256(repr(sorted(found)).encode()).hexdigest() if found[0][1] else ""


@cache
def _source(name: str) -> tuple[str, tuple[str, ...]]:
    """Text of a module that is being imported, and the modules of this package that it imports from."""
    module = sys.modules.get(name)
    file = getattr(module, "__file__", None)
    package = getattr(module, "__package__", None)
    try:
        text = Path(file).read_text(encoding="utf-8") if file else ""
    except OSError:
        text = ""
    return text, tuple(resolve_name(place, package) for place in IMPORTED.findall(text)) if package else ()


@intrinsic
def ask_for(_context, array, place):  # type: ignore[no-untyped-def]
    """Inside a `@kernel`: begin to fetch ``array[place]`` (one axis, contiguous), and go on."""

    def code(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        number, pointer = ir.IntType(32), ir.IntType(8).as_pointer()
        kind = ir.FunctionType(ir.VoidType(), [pointer, number, number, number])
        fetch = builder.module.declare_intrinsic("llvm.prefetch", [pointer], kind)
        address = builder.bitcast(builder.gep(data, [arguments[1]]), pointer)
        builder.call(fetch, [address, *(ir.Constant(number, value) for value in (READ, NEAREST, DATA))])
        return context.get_dummy_value()

    return types.void(array, place), code
