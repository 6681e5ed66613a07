"""JSON: a list of records, or an object whose one list of records is the table.

Numbers and words beside that list are said of all its rows: the mass and the length of a pendulum.
"""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Any, Final

import numpy as np

from ..._support.wording import commas, plural, printable
from ...errors import InputError
from ..expansion import Expansion
from ..table import CELLS_KEPT, Cell, Table
from .format import Format

# Bytes that Python takes for an object, a list and a value: a file of brackets grows fiftyfold.
_TAKEN: Final = {b"{": 240, b"[": 90, b",": 40}
_KINDS: Final[dict[type, str]] = {list: "[...]", dict: "{...}"}
_SHAPE: Final = 'write [{"time_s": 0.0, ...}, ...], or an object that holds one such list'


def read(path: Path) -> Table:
    """Read a JSON file of records; true and false count as 1 and 0, null as missing."""
    expansion = Expansion(path)
    content = _content(path, expansion)
    records = _records(path, content)
    names = list(dict.fromkeys(name for record in records for name in record))
    wanted = f"{len(records)} records of {plural(len(names), 'name')}"
    expansion.numbers(wanted, len(records) * len(names))
    columns = {name: np.full(len(records), np.nan) for name in names}
    cells: list[Cell] = []
    kept = dict.fromkeys(names, 0)
    for row, record in enumerate(records):
        for name, value in record.items():
            if isinstance(value, (int, float)):
                columns[name][row] = _double(value)
            elif value is not None and kept[name] < CELLS_KEPT:
                text = value if isinstance(value, str) else _KINDS[type(value)]
                cells.append(Cell(row, name, text))
                kept[name] += 1
    return Table(path, columns, tuple(cells), header=_header(content))


def _header(content: Any) -> dict[str, float | str]:
    """What the object states once, beside its list of records."""
    beside = content.items() if isinstance(content, dict) else ()
    return {
        name: value if isinstance(value, str) else _double(value)
        for name, value in beside
        if isinstance(value, (str, int, float)) and not isinstance(value, bool)
    }


FORMAT = Format("JSON", (".json",), read)


def _content(path: Path, expansion: Expansion) -> Any:
    def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        values = dict(pairs)
        if len(values) < len(pairs):
            twice = Counter(name for name, _ in pairs).most_common(1)[0][0]
            raise InputError(
                f"{path}: one object names '{printable(twice)}' twice; write each name once"
            )
        return values

    data = path.read_bytes()
    expansion.bytes("its values", len(data) + sum(data.count(c) * n for c, n in _TAKEN.items()))
    try:
        return json.loads(data, object_pairs_hook=unique)
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: the text is not UTF-8; save it as UTF-8") from error
    except json.JSONDecodeError as error:
        raise InputError(
            f"{path}: line {error.lineno} is not JSON ({error.msg}); was the file cut off?"
        ) from error
    except InputError:
        raise
    except ValueError as error:
        raise InputError(
            f"{path}: the JSON cannot be read, for a number in it has thousands of digits; write "
            "it as a decimal number"
        ) from error
    except RecursionError as error:
        raise InputError(f"{path}: the JSON is nested too deeply; {_SHAPE}") from error


def _records(path: Path, content: Any) -> list[dict[str, Any]]:
    if _is_table(content):
        return list(content)
    if isinstance(content, dict):
        tables = [name for name, value in content.items() if _is_table(value)]
        if len(tables) == 1:
            return list(content[tables[0]])
        if tables:
            raise InputError(
                f"{path}: the object holds {plural(len(tables), 'list')} of records "
                f"({commas(tables)}), and it may hold one; save the others apart"
            )
    raise InputError(f"{path}: there is no list of records in this file; {_SHAPE}")


def _is_table(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(item, dict) for item in value)


def _double(value: float) -> float:
    try:
        return float(value)
    except OverflowError:  # JSON has no largest integer
        return float("inf") if value > 0 else float("-inf")
