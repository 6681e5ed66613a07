"""TDMS, the logs of LabVIEW and DIAdem: groups of channels.

Times are a channel of the group that says so, or follow from ``wf_increment``. Read through
`nptdms`, an optional extra.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any, Final

import numpy as np

from ..._support.arrays import FloatArray
from ..._support.units import known_unit
from ...errors import InputError
from ..column_words import what_it_says
from ..gathered import Gathered, damage_error, missing_package
from ..table import Table
from .format import Format

_SIGNATURE: Final = b"TDSm"


def read(path: Path) -> Table:
    """Read a TDMS file (see the module's text)."""
    with path.open("rb") as file:
        start = file.read(len(_SIGNATURE))
    if start != _SIGNATURE:
        raise InputError(
            f"{path}: this is not a TDMS file (it does not start with TDSm); correct the file's "
            "ending"
        )
    try:
        nptdms: Any = import_module("nptdms")
    except ImportError as error:
        raise missing_package(path, "TDMS", "nptdms", "tdms", error) from error
    found = Gathered(path)
    try:
        # Of the file itself: the library would look for an index beside it.
        with (
            path.open("rb") as file,
            nptdms.TdmsFile(file, read_metadata_only=True, keep_open=True) as stored,
        ):
            groups = stored.groups()
            for group in groups:
                _add(found, group, "" if len(groups) == 1 else group.name)
    except Exception as error:
        raise damage_error(path, "TDMS", error) from error
    return found.table("group")


FORMAT = Format("TDMS", (".tdms",), read)


def _add(found: Gathered, group: Any, name: str) -> None:
    signals: dict[str, FloatArray] = {}
    clock: FloatArray | None = None
    for channel in group.channels():
        full = f"{name}.{channel.name}" if name else channel.name
        dtype = np.dtype(channel.dtype)
        if dtype.kind not in "biuf" and dtype.kind != "M":
            found.unusable[full] = "holds no numbers"
            continue
        found.room(f"channel '{full}'", 2 * len(channel))
        values = channel[:]
        stamps = dtype.kind == "M"
        column = _seconds(values) if stamps else np.asarray(values, dtype=np.float64)
        if clock is None and (stamps or what_it_says(channel.name).kinds[:1] == ("time",)):
            clock = column
            continue
        signals[channel.name] = column
        unit = str(channel.properties.get("unit_string", ""))
        if known_unit(unit) is not None:
            found.units[f"{name}.{channel.name}"] = unit
        step = channel.properties.get("wf_increment")
        if clock is None and isinstance(step, float) and step > 0.0:
            start = float(channel.properties.get("wf_start_offset", 0.0))
            clock = start + step * np.arange(len(column), dtype=np.float64)
    if clock is None:
        if signals:
            found.unusable[name or group.name] = "has no channel of times, and no wf_increment"
        return
    found.whole(name, clock, signals)


def _seconds(stamps: Any) -> FloatArray:
    since = (stamps - stamps[:1]).astype("timedelta64[ns]").astype(np.float64)
    seconds: FloatArray = 1e-9 * since
    return seconds
