"""What a file is, where it was given in the place of another one."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from ..errors import InputError

__all__ = ["kind_of", "kind_of_table", "refuse_findings"]

_OF_PLANT: Final = frozenset({"motion", "drive", "body", "friction"})
_OF_SESSION: Final = frozenset({"plant", "columns", "recordings"})


def kind_of(path: Path) -> str:
    """``"recording"`` by its ending, else "".

    Parameters
    ----------
    path : Path
    """
    from ..recording.formats import FORMATS

    endings = [suffix for known in FORMATS for suffix in known.suffixes]
    return "recording" if path.suffix.casefold() in endings and os.path.isfile(path) else ""


def refuse_findings(path: Path) -> None:
    """Of a file that holds what was found: what to read in its place.

    Raises
    ------
    InputError
        It is one, by its name.
    """
    if path.name == "findings.json":
        raise InputError(
            f"{path}: holds what a diagnosis found; read it as JSON, or load plant.toml beside "
            "it, the plant with what was found"
        )


def kind_of_table(table: Mapping[str, Any]) -> str:
    """``"plant file"``, ``"robot file"`` or ``"session file"`` by the keys of a table, else ""."""
    if "robot" in table:
        return "robot file"
    plant, session = not _OF_PLANT.isdisjoint(table), not _OF_SESSION.isdisjoint(table)
    if plant is session:
        return ""
    return "plant file" if plant else "session file"
