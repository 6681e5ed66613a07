"""What a file is, where it was given in the place of another one."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

__all__ = ["kind_of", "kind_of_table"]

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


def kind_of_table(table: Mapping[str, Any]) -> str:
    """``"plant file"`` or ``"session file"`` by the keys of a TOML file, else ""."""
    plant, session = not _OF_PLANT.isdisjoint(table), not _OF_SESSION.isdisjoint(table)
    if plant is session:
        return ""
    return "plant file" if plant else "session file"
