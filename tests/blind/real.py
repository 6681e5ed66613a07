"""Recordings of real machines, laid out as sessions: plant and session file for each of them.

The recordings stay where they are, in the folder that STICTION_DATA names, and are named by their
paths; nothing is copied but what has no header. What is not in that folder is left out.
"""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

REPOSITORY = Path(__file__).parents[2]
SERVO_COLUMNS = {
    "time": {"name": "timestamp", "unit": "s"},
    "input": {"name": "goal_position", "unit": "rad"},
    "position": {"name": "position", "unit": "rad"},
    "enabled": {"name": "torque_enable"},
}
DUTY = {"xl330": 0.0028774, "sts3215": 0.166}
"""Duty per rad and unit of the firmware's gain."""
ARM_KG = 0.018
"""At the end of the pendulum of the second servo: pulls as its arm does."""
UR_GAINS = (10.00, 10.70, 8.46, 9.00, 9.48, 10.12)
"""N·m/A of the arm's joints, as its owners identified them."""


@dataclass(frozen=True)
class Machine:
    """A session of a real machine.

    Attributes
    ----------
    name : str
    folder : str
        Of its recordings in the folder of all of them.
    lay : callable
        Lays the session out: from the folder of recordings into another one.
    turn : int or None
        Of machines that were recorded twice over: which of the two this is.
    """

    name: str
    folder: str
    lay: Callable[[Path, Path], Path]
    turn: int | None = None


def data_folder() -> Path:
    """Where real recordings are, whether or not it is there."""
    named = Path(os.environ.get("STICTION_DATA") or "../shared/data")
    return named if named.is_absolute() else REPOSITORY / named


def machines(folder: Path, turn: int | None = None) -> list[Machine]:
    """Machines whose recordings are there; of what was recorded twice one ``turn``, or both."""
    there = [machine for machine in MACHINES if (folder / machine.folder).is_dir()]
    return [machine for machine in there if None in (turn, machine.turn) or turn == machine.turn]


def lay(machine: Machine, folder: Path, where: Path) -> Path:
    """Write the session of a machine into ``where``; returns the path of session.toml."""
    where.mkdir(parents=True, exist_ok=True)
    return machine.lay(folder / machine.folder, where)


# --- files


def write_session(
    where: Path, plant: dict[str, Any], columns: dict[str, Any], recordings: list[dict[str, Any]]
) -> Path:
    """session.toml and plant.toml of plain tables."""
    lines = ['plant = "plant.toml"', "", "[columns]", *_entries(columns)]
    for each in recordings:
        lines += ["", "[[recordings]]", *_entries(each)]
    path = where / "session.toml"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    lines = []
    for name, table in plant.items():
        lines += [f"[{name}]", *_entries(table), ""]
    (where / "plant.toml").write_text("\n".join(lines), encoding="utf-8")
    return path


def _entries(table: dict[str, Any]) -> list[str]:
    return [f"{key} = {_value(value)}" for key, value in table.items()]


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(_entries(value)) + " }"
    return json.dumps(value, ensure_ascii=False)


def _files(source: Path, pattern: str) -> list[dict[str, Any]]:
    return [{"file": str(path.resolve())} for path in sorted(source.glob(pattern))]


def _as_it_is(source: Path, where: Path) -> Path:
    """A session that stands beside its recordings: its files, linked."""
    for path in sorted(source.iterdir()):
        (where / path.name).symlink_to(path.resolve())
    return where / "session.toml"


# --- machines


def _emps(source: Path, where: Path) -> Path:
    plant = {
        "motion": {"kind": "linear"},
        "drive": {"input": "voltage_v", "gain": 35.15065},
        "friction": {"law": "coulomb"},
        "controller": {
            "kind": "position_velocity",
            "kp": 160.18,
            "kv": 243.45,
            "derivative": "backward_of_two_sample_mean",
        },
    }
    columns = {
        "time": {"name": "t", "unit": "s"},
        "input": {"name": "vir", "unit": "V"},
        "position": {"name": "qm", "unit": "m"},
        "reference": {"name": "qg", "unit": "m"},
    }
    return write_session(where, plant, columns, _files(source, "*.mat"))


def _xl330(source: Path, where: Path) -> Path:
    drive = {
        "kind": "servo",
        "proportional": 1.151,
        "supply_v": 7.3,
        "resistance_ohm": 3.5,
        "torque_constant": {"value": 0.4, "min": 0.05, "max": 2.0},
    }
    body = {"inertia": 0.002, "payload_kg": 0.49, "payload_m": 0.1}
    recordings = _servo_logs(source, lambda header: True)
    return write_session(where, _servo(drive, body), SERVO_COLUMNS, recordings)


def sts3215_logs(source: Path, where: Path, number: int) -> Path:
    """A session of so many logs, each with the load that it was made with."""
    recordings = []
    for entry in _servo_logs(source, lambda header: True)[:number]:
        load = json.loads(Path(entry["file"]).read_bytes())["mass"]
        recordings.append(entry | {"payload_kg": load + ARM_KG})
    return _sts3215_session(where, recordings, recordings[0]["payload_kg"])


def _sts3215(mass: float, turn: int) -> Callable[[Path, Path], Path]:
    def laid(source: Path, where: Path) -> Path:
        recordings = _servo_logs(source, lambda header: abs(header["mass"] - mass) < 0.01)
        # Each log and its repeat follow each other.
        return _sts3215_session(where, recordings[turn::2], mass + ARM_KG)

    return laid


def _sts3215_session(where: Path, recordings: list[dict[str, Any]], payload_kg: float) -> Path:
    drive = {
        "kind": "servo",
        "proportional": 3.0,
        "supply_v": 12.0,
        "resistance_ohm": 3.7,
        "torque_constant": {"value": 2.0, "min": 0.2, "max": 20.0},
    }
    body = {"inertia": 0.02, "payload_kg": payload_kg, "payload_m": 0.1}
    return write_session(where, _servo(drive, body), SERVO_COLUMNS, recordings)


def _servo(drive: dict[str, Any], body: dict[str, Any]) -> dict[str, dict[str, Any]]:
    return {
        "motion": {"kind": "rotary"},
        "drive": drive,
        "body": body,
        "friction": {"law": "coulomb"},
        "sensor": {"counts_per_rev": 4096},
    }


def _servo_logs(source: Path, wanted: Callable[[dict[str, Any]], bool]) -> list[dict[str, Any]]:
    found = []
    for entry in _files(source, "*.json"):
        header = json.loads(Path(entry["file"]).read_bytes())
        if wanted(header):
            settings = {"proportional": header["kp"] * DUTY[source.name]}
            found.append(entry | {"kind": header["trajectory"]} | settings)
    return found


def _dfki(*stems: str) -> Callable[[Path, Path], Path]:
    def laid(source: Path, where: Path) -> Path:
        plant = {
            "motion": {"kind": "rotary"},
            "drive": {"input": "torque_nm", "gain": 1.0},
            "body": {"gravity_amplitude": 1.0, "gravity_zero_rad": 0.0},
            "friction": {"law": "coulomb"},
        }
        columns = {
            "time": {"name": "time", "unit": "s"},
            "input": {"name": "torque", "unit": "Nm"},
            "position": {"name": "position", "unit": "rad"},
            "velocity": {"name": "velocity", "unit": "rad/s"},
        }
        recordings = [entry for stem in stems for entry in _files(source, f"{stem}.csv")]
        return write_session(where, plant, columns, recordings)

    return laid


def _damper(source: Path, where: Path) -> Path:
    plant = {
        "motion": {"kind": "linear"},
        "drive": {"kind": "prescribed_motion"},
        "friction": {"law": "bouc_wen"},
    }
    columns = {
        "time": {"name": "Tout", "unit": "s"},
        "position": {"name": "dist", "unit": "mm"},
        "effort": {"name": "forc", "unit": "N"},
    }
    return write_session(where, plant, columns, _files(source, "*.mat"))


def _rock(source: Path, where: Path) -> Path:
    plant = {
        "motion": {"kind": "linear"},
        "drive": {"kind": "prescribed_motion"},
        "friction": {
            "law": "rate_and_state",
            "evolution": "ageing",
            "compliance": 1e-11,
            "viscous": {"value": 0.0, "fixed": True},
        },
    }
    columns = {
        "time": {"name": "Time(s)", "unit": "s"},
        "position": {"name": "Displ(microns)", "unit": "µm"},
        "friction_coefficient": {"name": "Friction"},
        "normal_force": {"name": "Normal_stress(MPa)", "unit": "MPa"},
    }
    return write_session(where, plant, columns, _files(source, "*.txt"))


def _head(source: Path, where: Path) -> Path:
    plant = {
        "motion": {"kind": "linear"},
        "drive": {"input": "voltage_v"},
        "friction": {"law": "coulomb"},
    }
    columns = {
        "time": {"name": "t", "unit": "s"},
        "input": {"name": "u", "unit": "V"},
        "position": {"name": "y", "unit": "m"},
    }
    return write_session(where, plant, columns, _files(source, "*.mat"))


def _arm(joint: int) -> Callable[[Path, Path], Path]:
    """One joint of an arm of six; its logs have no header, so they get one."""

    def laid(source: Path, where: Path) -> Path:
        plant = {
            "motion": {"kind": "rotary"},
            "drive": {"input": "current_a", "gain": UR_GAINS[joint - 1]},
            "friction": {"law": "coulomb"},
        }
        columns = {
            "time": {"name": "time_s"},
            "input": {"name": "current_a"},
            "position": {"name": "position_rad"},
        }
        recordings = []
        for entry in _files(source, "*.csv"):
            path = Path(entry["file"])
            if "joint_2" in path.name and joint != 2:
                continue  # the others stand still in it
            own = where / path.name
            with path.open(encoding="utf-8") as log, own.open("w", encoding="utf-8") as file:
                file.write("time_s,position_rad,current_a\n")
                for row in csv.reader(log):
                    file.write(f"{row[0]},{row[joint]},{row[12 + joint]}\n")
            recordings.append({"file": own.name})
        return write_session(where, plant, columns, recordings)

    return laid


MACHINES = (
    Machine("emps", "emps", _emps),
    Machine("xl330", "xl330", _xl330),
    *(
        Machine(f"sts3215 {mass:g} kg {'ab'[turn]}", "sts3215", _sts3215(mass, turn), turn)
        for mass in (0.535, 0.741, 0.969, 1.168)
        for turn in (0, 1)
    ),
    Machine(
        "dfki",
        "dfki_simple_pendulum",
        _dfki(
            "direct_collocation",
            "energy_shaping",
            "pd_system_identification",
            "sac",
            "torque_limited_swingup",
        ),
    ),
    Machine("dfki 1 kg", "dfki_simple_pendulum", _dfki("energy_shaping_1kg")),
    Machine("mr_damper", "mr_damper", _damper),
    Machine("rock_rsf", "rock_rsf", _rock),
    Machine("pick_and_place", "pick_and_place", _head),
    Machine("dd2dof_presliding", "dd2dof_presliding", _as_it_is),
    Machine("report_views", "report_views", _as_it_is),
    Machine("ordinary_null", "ordinary_null", _as_it_is),
    *(Machine(f"ur10e joint {joint}", "ur10e", _arm(joint)) for joint in range(1, 7)),
)
