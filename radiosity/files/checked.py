"""Values out of a JSON document that nobody has checked: each of the expected kind, or a named error."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from ..errors import FileFormatError

JSON = dict[str, Any]


def integer(
    obj: Mapping[str, Any], key: str, where: str, default: int | None = None, low: int = 0, high: int = 2**53
) -> int:
    """A whole number in [low, high]; required if there is no default."""
    value = obj.get(key, default)
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise FileFormatError(f"{where}.{key} is {_shown(value)}; expected a whole number in {low} … {high}")
    return value


def index(obj: Mapping[str, Any], key: str, where: str, count: int, of: str) -> int:
    """An index into a list of `count` things named `of`."""
    value = integer(obj, key, where)
    if value >= count:
        raise FileFormatError(f"{where}.{key} is {value}, but the file has {count} {of}")
    return value


def numbers(obj: Mapping[str, Any], key: str, where: str, count: int | None, default: Sequence[float]) -> list[float]:
    """A list of `count` finite numbers (of any length if None)."""
    value = obj.get(key, default)
    if not isinstance(value, Sequence) or isinstance(value, str) or count not in (None, len(value)):
        raise FileFormatError(f"{where}.{key} is {_shown(value)}; expected {count or 'a list of'} numbers")
    return [_finite(item, f"{where}.{key}") for item in value]


def number(obj: Mapping[str, Any], key: str, where: str, default: float) -> float:
    """One finite number."""
    return _finite(obj.get(key, default), f"{where}.{key}")


def text(obj: Mapping[str, Any], key: str, where: str, default: str = "") -> str:
    """A string."""
    value = obj.get(key, default)
    if not isinstance(value, str):
        raise FileFormatError(f"{where}.{key} is {_shown(value)}; expected a string")
    return value


def flag(obj: Mapping[str, Any], key: str, where: str, default: bool = False) -> bool:
    """True or false."""
    value = obj.get(key, default)
    if not isinstance(value, bool):
        raise FileFormatError(f"{where}.{key} is {_shown(value)}; expected true or false")
    return value


def mapping(obj: Mapping[str, Any], key: str, where: str) -> JSON:
    """An object; an empty one if there is none."""
    value = obj.get(key, {})
    if not isinstance(value, dict):
        raise FileFormatError(f"{where}.{key} is {_shown(value)}; expected an object")
    return value


def mappings(obj: Mapping[str, Any], key: str, where: str) -> list[JSON]:
    """A list of objects; an empty one if there is none."""
    value = obj.get(key, [])
    if not isinstance(value, list) or not all(isinstance(item, dict) for item in value):
        raise FileFormatError(f"{where}.{key} is {_shown(value)}; expected a list of objects")
    return value


def indices(obj: Mapping[str, Any], key: str, where: str, count: int, of: str) -> list[int]:
    """A list of indices into a list of `count` things; an empty one if there is none."""
    value = obj.get(key, [])
    if not isinstance(value, list):
        raise FileFormatError(f"{where}.{key} is {_shown(value)}; expected a list of indices")
    return [index({key: item}, key, where, count, of) for item in value]


def _finite(value: Any, where: str) -> float:
    try:
        if not isinstance(value, bool) and isinstance(value, (int, float)) and math.isfinite(value):
            return float(value)
    except OverflowError:  # a whole number beyond 1e308
        pass
    raise FileFormatError(f"{where} holds {_shown(value)}; expected finite numbers")


def _shown(value: Any) -> str:
    shown = repr(value)
    return shown if len(shown) <= 60 else shown[:57] + "…"
