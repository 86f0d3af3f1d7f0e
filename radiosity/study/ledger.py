"""Runs that are done, one a line of a file: what is in it need not be done again."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from ..errors import FileFormatError
from ..files.atomic import write_bytes

Record = dict[str, Any]


class Ledger:
    """A file of records, each with a "key" of its own, to which every run is added as soon as it is done.

    The first line says what made them (machine, versions, settings): records of another origin are not mixed in.

    Parameters
    ----------
    path : path
        A .jsonl file; made if it is not there.
    origin : dict
        What all records have in common.

    Raises
    ------
    FileFormatError
        The file is no ledger, or one of another origin; with what differs.
    """

    def __init__(self, path: Path, origin: Record) -> None:
        self.path = path
        self.records: dict[str, Record] = {}
        if path.exists():
            self._read(origin)
        else:
            write_bytes(path, _line({"origin": origin}))

    def __contains__(self, key: str) -> bool:
        return key in self.records

    def add(self, key: str, record: Record) -> None:
        """Add a record, at once on disk."""
        whole = {"key": key, **record}
        with self.path.open("ab") as file:
            file.write(_line(whole))
        self.records[key] = json.loads(_line(whole))

    def of(self, part: str) -> list[Record]:
        """Records of one part of the study."""
        return [record for record in self.records.values() if record["part"] == part]

    def _read(self, origin: Record) -> None:
        content = self.path.read_bytes()
        whole, _, rest = content.rpartition(b"\n")
        if rest:  # a run was stopped while it was written down
            write_bytes(self.path, whole + b"\n" if whole else b"")
        lines = whole.splitlines()
        try:
            found = json.loads(lines[0])["origin"]
            self.records = {record["key"]: record for record in map(json.loads, lines[1:])}
        except (IndexError, KeyError, TypeError, ValueError) as error:
            raise FileFormatError(f"{self.path} holds no runs of a study: {error!r}; give another folder") from error
        wanted = json.loads(_line(origin))
        differing = [name for name in sorted({*found, *wanted}) if found.get(name) != wanted.get(name)]
        if differing:
            name = differing[0]
            raise FileFormatError(
                f"{self.path} holds runs with {name} = {found.get(name)!r}, now it is {wanted.get(name)!r}"
                f"{f' ({len(differing)} things differ)' if len(differing) > 1 else ''}: go on as it was begun, or give "
                "another folder"
            )


def _line(record: Record) -> bytes:
    return json.dumps(_finite(record), ensure_ascii=False, allow_nan=False).encode() + b"\n"


def _finite(value: Any) -> Any:
    """The same with None for numbers that JSON does not have."""
    if isinstance(value, dict):
        return {name: _finite(entry) for name, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
