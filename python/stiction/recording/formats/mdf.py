"""MDF 4, the logs of measuring programs for vehicles and test stands: a group of columns a group.

Read through `asammdf`, an optional extra.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any, Final

import numpy as np

from ..._support.arrays import FloatArray
from ..._support.units import known_unit
from ...errors import InputError
from ..gathered import Gathered, damage_error, missing_package
from ..table import Table
from .format import Format

_SIGNATURES: Final = (b"MDF     ", b"UnFinMF ")


def read(path: Path) -> Table:
    """Read an MDF file (see the module's text)."""
    with path.open("rb") as file:
        start = file.read(8)
    if start not in _SIGNATURES:
        raise InputError(
            f"{path}: this is not an MDF file (it does not start with MDF); correct the file's "
            "ending"
        )
    try:
        asammdf: Any = import_module("asammdf")
    except ImportError as error:
        raise missing_package(path, "MDF", "asammdf", "mdf", error) from error
    found = Gathered(path)
    try:
        with path.open("rb") as file, asammdf.MDF(file) as stored:
            for place, group in enumerate(stored.groups):
                _add(found, stored, place, group, several=len(stored.groups) > 1)
    except Exception as error:
        raise damage_error(path, "MDF", error) from error
    return found.table("group")


FORMAT = Format("MDF", (".mf4", ".mdf"), read)


def _add(found: Gathered, stored: Any, place: int, group: Any, *, several: bool) -> None:
    rows = int(group.channel_group.cycles_nr)
    master = stored.masters_db.get(place)
    if not rows or master is None:
        return
    name = f"group{place + 1}" if several else ""
    signals: dict[str, FloatArray] = {}
    clock: FloatArray = np.asarray(stored.get_master(place), dtype=np.float64)
    for index, channel in enumerate(group.channels):
        if index == master:
            continue
        found.room(f"channel '{channel.name}'", 2 * rows)
        signal = stored.get(group=place, index=index)
        values = np.asarray(signal.samples)
        if values.dtype.kind not in "biuf" or values.ndim != 1:
            found.unusable[f"{name}.{channel.name}"] = "holds no plain numbers"
            continue
        signals[channel.name] = values.astype(np.float64)
        if known_unit(signal.unit or "") is not None:
            found.units[f"{name}.{channel.name}"] = signal.unit
    found.whole(name, clock, signals)
