"""An ordinary session as a user has it: session.toml, plant.toml and recordings of one format.

The same session has the same bytes: what writes a date into a file is given none.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from importlib import import_module
from io import BytesIO
from pathlib import Path
from typing import Any, Final

import numpy as np

from ..._support.atomic_files import atomic_write, write_text
from .draw import Log, Ordinary
from .signals import FloatArray

__all__ = ["write"]

_MAT_HEADER: Final = b"MATLAB 5.0 MAT-file".ljust(116)
"""Text at the head of a MAT file; scipy.io writes the time of day into it."""


def write(made: Ordinary, folder: Path) -> Path:
    """Write all files of a session.

    Parameters
    ----------
    made : Ordinary
    folder : Path
        Made where it is not there.

    Returns
    -------
    Path
        Of session.toml.

    Raises
    ------
    OSError
        A file cannot be written.
    ImportError
        Its files are Parquet, and pyarrow is not installed.
    """
    folder.mkdir(parents=True, exist_ok=True)
    names = _names(made)
    lines = ['plant = "plant.toml"', ""]
    if made.foreign_columns:
        lines += ["[columns]", *(_column(role, *names[role]) for role in names), ""]
    for k, log in enumerate(made.logs):
        file = f"run_{k + 1:02d}.{made.spec.file_format}"
        table = {names[role][0]: column for role, column in _columns(made, log).items()}
        _WRITERS[str(made.spec.file_format)](folder / file, table)
        lines += ["[[recordings]]", f'file = "{file}"', f'kind = "{log.kind}"']
        if made.roles:
            lines.append(f'role = "{made.roles[k % len(made.roles)]}"')
        if made.clock:
            lines.append(f"start_s = {log.start_s!r}")
        lines.append("")
    write_text(folder / "session.toml", "\n".join(lines))
    write_text(folder / "plant.toml", _toml(_plant(made)))
    return folder / "session.toml"


def _plant(made: Ordinary) -> dict[str, dict[str, Any]]:
    """What a user states of the machine: never its friction, nor what is hidden."""
    spec, radius = made.spec, made.radius or 1.0
    plant: dict[str, dict[str, Any]] = {"motion": {"kind": "linear" if made.radius else "rotary"}}
    drive = dict(made.drive)
    if made.radius and drive.get("input") == "torque_nm":
        drive["input"] = "force_n"
    elif made.radius:
        drive["gain"] /= radius
    if spec.kind == "moved":
        drive = {"kind": "prescribed_motion"}
        plant["body"] = {"inertia": made.machine.inertia}
    if spec.kind == "servo":
        plant["body"] = {"inertia": {"value": made.machine.inertia, "fixed": True}}
    plant["drive"] = drive
    plant["friction"] = {"law": spec.law}
    if made.stated_sensor:
        count = 2.0 * math.pi / spec.counts * radius
        plant["sensor"] = {"count_m": count} if made.radius else {"counts_per_rev": spec.counts}
    if made.controller:
        # An input of effort is divided by the radius, as is a position multiplied by it.
        per = radius**2 if drive.get("input") == "force_n" else radius
        gains = {name: made.controller[name] / per for name in ("kp", "kd")}
        plant["controller"] = made.controller | gains
    return plant


def _columns(made: Ordinary, log: Log) -> dict[str, FloatArray]:
    """By role, in the units that the columns are written in."""
    radius, direct = made.radius or 1.0, made.drive.get("input") == "torque_nm"
    effort = 1.0 / radius if direct else 1.0
    columns = {
        "time": log.time,
        "effort" if made.spec.kind == "moved" else "input": log.input * effort,
        "position": log.position * radius,
    }
    if log.reference is not None and made.controller:
        columns["reference"] = log.reference * radius
    return {role: column * _names(made)[role][2] for role, column in columns.items()}


def _names(made: Ordinary) -> dict[str, tuple[str, str, float]]:
    """By role: name, unit, and units in one of SI."""
    linear = bool(made.radius)
    unit = "m" if linear else "rad"
    kind, given = made.spec.kind, made.drive.get("input", "")
    effort = ("force_n", "N") if linear else ("torque_nm", "Nm")
    inputs = {"current_a": ("current_a", "A"), "voltage_v": ("voltage_v", "V")}
    name, of_input = inputs.get(given, effort)
    if kind == "servo":
        name, of_input = "goal_rad", "rad"
    elif kind == "moved":
        name, of_input = effort
    role = "effort" if kind == "moved" else "input"
    names = {
        "time": ("time_s", "s", 1.0),
        role: (name, of_input, 1.0),
        "position": (f"position_{unit}", unit, 1.0),
    }
    if made.controller:
        names["reference"] = (f"reference_{unit}", unit, 1.0)
    if not made.foreign_columns:
        return names
    scale, place = (1e3, "mm") if linear else (180.0 / math.pi, "deg")
    fine = {"A": (1e3, "mA"), "V": (1e3, "mV"), "Nm": (1e3, "mNm"), "N": (1.0, "N")}
    own, small = (scale, place) if kind == "servo" else fine[of_input]
    foreign = {
        "time": ("stamp", "ms", 1e3),
        role: ("u", small, own),
        "position": ("x", place, scale),
    }
    return foreign | ({"reference": ("goal", place, scale)} if made.controller else {})


def _column(role: str, name: str, unit: str, _: float) -> str:
    return f'{role} = {{ name = "{name}", unit = "{unit}" }}'


def _toml(plant: dict[str, dict[str, Any]]) -> str:
    lines = []
    for table, entries in plant.items():
        lines += [f"[{table}]", *(f"{key} = {_value(each)}" for key, each in entries.items()), ""]
    return "\n".join(lines)


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{k} = {_value(v)}" for k, v in value.items()) + " }"
    return json.dumps(value)


# --- formats


def _csv(path: Path, table: dict[str, FloatArray]) -> None:
    rows = zip(*(column.tolist() for column in table.values()), strict=True)
    lines = [",".join(table), *(",".join(_cell(value) for value in row) for row in rows)]
    write_text(path, "\n".join(lines) + "\n")


def _cell(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.12g}"


def _npz(path: Path, table: dict[str, FloatArray]) -> None:
    with atomic_write(path) as file:
        np.savez_compressed(file, **table)  # type: ignore[arg-type]


def _mat(path: Path, table: dict[str, FloatArray]) -> None:
    from scipy.io import savemat

    made = BytesIO()
    savemat(made, {name: column[:, None] for name, column in table.items()})
    with atomic_write(path) as file:
        file.write(_MAT_HEADER + made.getvalue()[len(_MAT_HEADER) :])


def _json(path: Path, table: dict[str, FloatArray]) -> None:
    cells = (
        [None if math.isnan(value) else value for value in column.tolist()]
        for column in table.values()
    )
    rows = [dict(zip(table, row, strict=True)) for row in zip(*cells, strict=True)]
    write_text(path, json.dumps({"made_by": "a logger", "entries": rows}))


def _parquet(path: Path, table: dict[str, FloatArray]) -> None:
    pyarrow: Any = import_module("pyarrow")
    parquet: Any = import_module("pyarrow.parquet")
    columns = {name: list(column) for name, column in table.items()}
    with atomic_write(path) as file:
        parquet.write_table(pyarrow.table(columns), file)


_WRITERS: Final[dict[str, Callable[[Path, dict[str, FloatArray]], None]]] = {
    "csv": _csv,
    "npz": _npz,
    "mat": _mat,
    "json": _json,
    "parquet": _parquet,
}
