"""A fit of one's own as an entry: what a later session of the same machine is held against."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any, Final

from .._support import given
from ..errors import InputError
from ..plant import Plant
from .entry_file import Entry, EntryNumber

__all__ = ["entry_of_fit"]

_FILES: Final = ("fit.json", "plant.toml")


def entry_of_fit(path: str | Path) -> Entry:
    """The numbers of a fit, with their intervals, and its plant.

    Parameters
    ----------
    path : str or Path
        Folder that ``stiction fit`` wrote, or a file in it.

    Raises
    ------
    InputError
        It is none.
    """
    path = given.path(path, "library.entry_of_fit")
    folder = path if path.is_dir() else path.parent
    for name in _FILES:
        if not (folder / name).is_file():
            raise InputError(
                f"{path}: is no entry of the library and no folder of stiction fit, for there is "
                f"no {name} in it; name one of them"
            )
    file = folder / "fit.json"
    try:
        table = json.loads(file.read_text(encoding="utf-8"))
        numbers = {
            name: EntryNumber(float(each["value"]), _interval(each["ci95"]), str(each["unit"]))
            for name, each in table["parameters"].items()
        }
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        raise InputError(f"{file}: is not what stiction fit writes; fit once more") from None
    return Entry(
        name=str(folder),
        machine="a fit of your own",
        kind="recordings",
        plant=Plant.load(folder / "plant.toml"),
        numbers=numbers,
        source={"text": "stiction fit", "url": str(file), "license": "your own"},
    )


def _interval(ends: Any) -> tuple[float, float] | None:
    low, high = (math.nan if end is None else float(end) for end in ends)
    return (low, high) if math.isfinite(low) and math.isfinite(high) else None
