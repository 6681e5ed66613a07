"""Entries of ``stiction library``, made of recordings (``STICTION_DATA``) and published files.

    python -m benches.library emps ur10e_wrist   # those; all without a name
    python -m benches.library mx64 --bam FOLDER  # FOLDER holds a checkout of Rhoban/bam

Each is fitted as a user fits it: a session is laid out, diagnosed (or its plant, whose effects are
known from docs/servo.md, fitted) and the extended plant fitted to all rows. What is written is
numbers; no recording goes anywhere. The same package and seed give the same file.
"""

from __future__ import annotations

import argparse
import json
import re
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from tests.blind import real

import stiction as st
from stiction.bam import read_bam
from stiction.fitting import FitResult
from stiction.library.comparison import fix_drive
from stiction.plant.plant_file import render

ENTRIES = Path(__file__).parents[1] / "python" / "stiction" / "library" / "entries"
SEED = 0
SHORTEST_S = 10.0
"""Of a session."""
BAM_COMMIT = "1b5a1cee2e6dcd2ab8c12b013f1e05482b16cb96"
NO_FLOOR = (
    "No floor is stated: what noise alone would leave is estimated at {value:.4g} {unit}, and the "
    "plant leaves {left:.4g}."
)
NOT_STATED = "the recordings state no licence and are not in the package; the numbers are its own"


@dataclass(frozen=True)
class Recipe:
    """How an entry comes about.

    Attributes
    ----------
    machine : str
    source : dict
    machines : tuple of str
        Of ``tests.blind.real``; several are units, of which each is fitted by itself.
    plant : dict
        Tables in place of those of the session's plant.
    diagnosed : bool
        Whether a diagnosis names the effects; else they stand in ``plant``.
    left_out : tuple of str
        Endings of recordings that are not used.
    floor : callable or None
        Of a session and its fitted plant; without one the noise of the diagnosis is the floor.
    notes : tuple of str
    shared : tuple of str
        Of units: numbers that are those of the drive, and not of what it carries.
    session_of : callable or None
        Of a recording what it has in common with others of one session of a minute or less; each
        session is fitted by itself from where the entry ends. None where there is one.
    """

    machine: str
    source: dict[str, str]
    machines: tuple[str, ...]
    plant: dict[str, Any] = field(default_factory=dict)
    diagnosed: bool = True
    left_out: tuple[str, ...] = ()
    floor: Callable[[st.Session], dict[str, Any]] | None = None
    notes: tuple[str, ...] = ()
    shared: tuple[str, ...] = ()
    session_of: Callable[[st.Recording], Any] | None = None


def alone(recording: st.Recording) -> Any:
    """Each recording is a session, but for those of a few seconds."""
    return recording.path if recording.duration > SHORTEST_S else None


def repeats(session: st.Session) -> dict[str, Any]:
    """What one log of a servo differs from its repeat by, of which neither is the truth."""
    groups: dict[tuple[Any, ...], list[st.Recording]] = {}
    for recording in session:
        key = (recording.kind, *sorted(recording.settings.items()))
        groups.setdefault(key, []).append(recording)
    power = []
    for group in groups.values():
        for one, other in zip(group[::2], group[1::2], strict=False):
            assert one.position is not None
            assert other.position is not None
            there = np.interp(one.time - one.time[0], other.time - other.time[0], other.position)
            # A reading of each that failed is no repeat.
            power.append(np.median(np.abs(one.position - there)) ** 2)
    text = f"median distance of a log from its repeat, rms over {len(power)} pairs"
    return {"value": float(np.sqrt(np.mean(power))), "unit": "rad", "text": text}


UR = {
    "text": "S. Mamedov, S. Mikhel, Practical aspects of model-based collision detection, "
    "Frontiers in Robotics and AI 7 (2020) 571574, and the recordings published with it",
    "url": "https://github.com/shamilmamedov/dynamic_calibration",
    "license": NOT_STATED,
}
UR_NOTES = (
    "One joint of an arm of six that all move: inertia, and what goes with the position, are those "
    "of the arm. Gains of the drive, in N·m/A, are those that its owners identified.",
)
RECIPES: dict[str, Recipe] = {
    "emps": Recipe(
        "EMPS, a prismatic axis: DC motor, ball screw, carriage",
        {
            "text": "A. Janot, M. Gautier, M. Brunot, Data set and reference models of EMPS, "
            "Workshop on Nonlinear System Identification Benchmarks (2019)",
            "url": "https://www.nonlinearbenchmark.org/benchmarks/emps",
            "license": NOT_STATED,
        },
        ("emps",),
        notes=(
            "Published for the same recordings: M = 95.109 kg, Fv = 203.5 N·s/m, Fc = 20.39 N, "
            "offset -3.165 N.",
        ),
    ),
    "xl330": Recipe(
        "Dynamixel XL330 servo on a pendulum of 0.49 kg at 0.1 m, 7.3 V",
        {
            "text": "M. Duclusaud, G. Passault, V. Padois, O. Ly, Extended friction models for the "
            "physics simulation of servo actuators, ICRA (2025), and the logs of Rhoban/bam",
            "url": "https://github.com/Rhoban/bam",
            "license": "Apache-2.0 (Duclusaud, Passault)",
        },
        ("xl330",),
        {
            "friction": {"law": "load_dependent"},
            "effects": [{"name": "torque_constant_saturation"}],
        },
        diagnosed=False,
        session_of=lambda recording: recording.kind,
        notes=("Gain of the firmware: 0.0028774 duty per rad and unit of its P gain.",),
    ),
    "sts3215": Recipe(
        "Feetech STS3215 servo, 12 V, on a pendulum of 0.535 to 1.168 kg at 0.1 m",
        {
            "text": "K-Scale Labs, sysid, data/feetech/STS_3215_12V_20250317 (2025)",
            "url": "https://github.com/kscalelabs/sysid",
            "license": NOT_STATED,
        },
        ("sts3215 all",),
        {
            "effects": [
                {"name": "input_delay"},
                {"name": "goal_rate_limit", "slowness": 0.1},
                {"name": "load_dependent_friction"},
            ]
        },
        diagnosed=False,
        left_out=("183154",),
        floor=repeats,
        # Every other log of one mass: all trajectories under both gains.
        session_of=lambda recording: (recording.settings["payload_kg"], repeat_of(recording)),
        notes=(
            "Gain of the firmware: 0.166 duty per rad and unit of its P gain, a guess; resistance "
            "3.7 Ω is assumed, and the torque constant goes with it.",
            "One log is left out, in which the arm rests where its repeat does not. The payload of "
            "the plant is the heaviest; each log has its own.",
        ),
    ),
    "ak80_6": Recipe(
        "T-Motor AK80-6 quasi-direct drive on a pendulum",
        {
            "text": "F. Wiebe et al., Torque-limited simple pendulum: a toolkit for getting "
            "familiar with control algorithms in underactuated robotics, JOSS 7 (2022) 3884",
            "url": "https://github.com/dfki-ric-underactuated-lab/torque_limited_simple_pendulum",
            "license": "BSD-3-Clause (DFKI RIC Underactuated Robotics Lab)",
        },
        ("dfki",),
        left_out=("pd_system_identification", "torque_limited_swingup"),
        session_of=alone,
        notes=(
            "Torque is an estimate of the drive's, from its current.",
            "The three runs of 0.5 kg. Of the two left out, one carries less, and the other rests "
            "and turns so slowly that its inertia does not show.",
            "Published, of the run that carries less: inertia 0.0626 kg·m², viscous 0.047 "
            "N·m·s/rad, Coulomb 0.184 N·m, offset -0.076 N·m.",
        ),
    ),
    "mr_damper": Recipe(
        "magneto-rheological damper on a shaking table, passive",
        {
            "text": "Labcontrol (A. N. Vargas, UTFPR), mr-damper (2021)",
            "url": "https://github.com/labcontrol-data/mr-damper",
            "license": "MIT (Labcontrol)",
        },
        ("mr_damper",),
        {"friction": {"law": "dahl"}, "effects": [{"name": "torque_bias"}]},
        session_of=alone,
        notes=("The bias is that of the force sensor, which drifts.",),
    ),
    "basalt_fault": Recipe(
        "basalt under 20 MPa in the rock deformation apparatus BRAVA, stepped from 3 to 10 µm/s",
        {
            "text": "P. Giacomel, steadystate, velstep4_BRAVA_expb819_basalt (2024)",
            "url": "https://github.com/pgiacomel/steadystate",
            "license": "MIT (P. Giacomel)",
        },
        ("rock_rsf",),
        diagnosed=False,
    ),
    "ur10e_shoulder": Recipe(
        "shoulder joint of a UR10e arm (drive of size 4), which moves alone",
        UR,
        ("ur10e joint 2",),
        {"body": {"gravity_amplitude": 100.0, "gravity_zero_rad": 1.5}},
        left_out=("load", "harm"),
        notes=(
            "The others stand still, the elbow straight: inertia and gravity are those of the arm. "
            "The gain of the drive, in N·m/A, is the one that its owners identified.",
            "Published: viscous 20.2 N·m·s/rad, Coulomb 13.3 N·m.",
        ),
    ),
    "ur10e_wrist": Recipe(
        "wrist joints of a UR10e arm (three drives of size 2)",
        UR,
        ("ur10e joint 4", "ur10e joint 5", "ur10e joint 6"),
        {"drive": {"input": "current_a"}},
        diagnosed=False,
        notes=(
            *UR_NOTES,
            "Published for the three: viscous 3.6, 2.5, 3.0 N·m·s/rad, Coulomb 2.0, 2.7, 2.3 N·m.",
            "The plant is that of the last joint, which carries least; units are the three drives.",
        ),
        shared=("friction.coulomb", "friction.viscous"),
    ),
}
"""Of recordings, by the name of the entry."""
BAM_ENTRIES = {
    "mx64": "Dynamixel MX-64 servo",
    "mx106": "Dynamixel MX-106 servo",
    "xl320": "Dynamixel XL-320 servo",
    "erob80_50": "ZeroErr eRob80 actuator with a harmonic drive of 50:1",
    "erob80_100": "ZeroErr eRob80 actuator with a harmonic drive of 100:1",
}
"""Published files of parameters: of each actuator M4, which knows load and Stribeck effect."""


def main() -> None:
    """Make the entries that are named, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--bam", type=Path, help="checkout of Rhoban/bam")
    chosen = parser.parse_args()
    names = chosen.names or [*RECIPES, *(BAM_ENTRIES if chosen.bam else ())]
    for name in names:
        began = time.process_time()
        if name in RECIPES:
            text = entry_of(name, RECIPES[name])
        elif chosen.bam is None:
            parser.error(f"{name}: give --bam, a checkout of Rhoban/bam")
        else:
            text = bam_entry(name, chosen.bam)
        (ENTRIES / f"{name}.toml").write_text(text, encoding="utf-8")
        print(f"{name}: {time.process_time() - began:.0f} s", flush=True)


# --- of recordings


def entry_of(name: str, recipe: Recipe) -> str:
    """The text of an entry."""
    fits, floors, seconds, recordings = [], [], 0.0, 0
    notes = list(recipe.notes)
    for machine in recipe.machines:
        session = session_of(machine, recipe)
        plant = session.plant
        assert plant is not None
        if recipe.diagnosed:
            found = st.diagnose(plant, session, seed=SEED)
            plant = found.plant
            notes.append(f"A diagnosis says: {found.sentence}")
            floor = noise_floor(found)
            floors += [floor] if floor["value"] < floor["left"] else []
            notes += [] if floors else [NO_FLOOR.format(**floor)]
        if recipe.floor is not None:
            floors.append(recipe.floor(session))
        fits.append(st.fit(plant, session))
        notes += fits[-1].undetermined
        seconds += sum(float(each.time[-1] - each.time[0]) for each in session)
        recordings += len(session)
    result = fits[-1]
    notes.append(error_of(result))
    units = {path: [fit[path].value for fit in fits] for path in recipe.shared if len(fits) > 1}
    table = {
        "machine": recipe.machine,
        "kind": "recordings",
        "notes": notes,
        "source": recipe.source,
        "made": {
            "version": st.__version__,
            "command": f"python -m benches.library {name}",
            "seed": SEED,
            "units": len(fits),
            "recordings": recordings,
            "seconds": round(seconds, 1),
        },
    }
    if floors:
        table["floor"] = {key: floors[-1][key] for key in ("value", "unit", "text")}
    single = sessions_of(recipe, session, result)
    numbers = {path: number_of(result, path, units, single) for path in shown(result, recipe)}
    return written(table, numbers, result.plant)


def session_of(machine: str, recipe: Recipe) -> st.Session:
    """The session of a machine, its plant as the recipe has it."""
    known = {each.name: each for each in real.MACHINES}
    known["sts3215 all"] = real.Machine("sts3215 all", "sts3215", every_servo_log)
    with tempfile.TemporaryDirectory() as folder:
        session = st.load(real.lay(known[machine], real.data_folder(), Path(folder)))
        assert session.plant is not None
        own = session.plant.to_dict()
    tables = dict(recipe.plant)
    if "drive" in tables:
        tables["drive"] = {**own["drive"], **tables["drive"]}
    plant = st.Plant.from_dict({**own, **tables}, source=machine)
    kept = [
        recording
        for recording in session
        if not (recording.path and any(end in recording.path.name for end in recipe.left_out))
    ]
    return st.Session(kept, plant)


def repeat_of(recording: st.Recording) -> int:
    """Which of two repeats a log of the second servo is: they follow each other in time."""
    assert recording.path is not None
    same = sorted(
        path.name for path in recording.path.parent.glob("*.json") if _like(path, recording)
    )
    return same.index(recording.path.name) % 2


def _like(path: Path, recording: st.Recording) -> bool:
    header = json.loads(path.read_bytes())
    mass, gain = header["mass"] + real.ARM_KG, header["kp"] * real.DUTY["sts3215"]
    settings = recording.settings
    own = (settings["payload_kg"], settings["proportional"], recording.kind)
    return bool((mass, gain, header["trajectory"]) == own)


def every_servo_log(source: Path, where: Path) -> Path:
    """All logs of the second servo, each with its own mass."""
    path = real._sts3215(1.168, 0)(source, where)
    recordings = real._servo_logs(source, lambda header: True)
    for each in recordings:
        header = json.loads(Path(each["file"]).read_bytes())
        each["payload_kg"] = header["mass"] + real.ARM_KG
        each["payload_m"] = 0.1
    plant = st.Plant.load(where / "plant.toml").to_dict()
    real.write_session(where, plant, real.SERVO_COLUMNS, recordings)
    return path


def noise_floor(found: st.Diagnosis) -> dict[str, Any]:
    """What noise alone would leave of the residual of a diagnosis, and what the plant leaves."""
    extended = found.extended
    assert extended is not None
    left = extended.train_rms
    text = (
        "rms that noise alone would leave in the rows that the diagnosis fitted, where the plant "
        f"leaves {left:.4g} {extended.unit}"
    )
    return {
        "value": extended.noise_floor_rms,
        "unit": extended.unit,
        "text": text,
        "left": left,
    }


def error_of(result: FitResult) -> str:
    """By how much the fitted plant is off, in a sentence."""
    line = next(line for line in str(result).splitlines() if "where fitted" in line)
    return f"{line[0].upper()}{line[1:]}."


def shown(result: FitResult, recipe: Recipe) -> list[str]:
    """Paths of the numbers that an entry states."""
    return [path for path in result.parameters if not recipe.shared or path in recipe.shared]


def sessions_of(recipe: Recipe, session: st.Session, result: FitResult) -> list[FitResult]:
    """Fits of single sessions of a unit, from where the fit of all of them ends."""
    if recipe.session_of is None:
        return []
    groups: dict[Any, list[st.Recording]] = {}
    for recording in session:
        groups.setdefault(recipe.session_of(recording), []).append(recording)
    groups.pop(None, None)
    plant, _ = fix_drive(result.plant)
    return [st.fit(plant, group) for group in groups.values()]


def number_of(
    result: FitResult, path: str, units: dict[str, list[float]], single: list[FitResult]
) -> dict[str, Any]:
    """A number with its interval, and the values of units and of single sessions."""
    found = result[path]
    low, high = found.ci95
    table: dict[str, Any] = {"unit": found.unit}
    if np.isfinite(low) and np.isfinite(high):
        table = {"ci95": [float(low), float(high)], **table}
    if path in units:
        table["units"] = units[path]
    values = [fit[path].value for fit in single if path in fit.parameters]
    if len(values) > 1:
        table["sessions"] = values
    return table


# --- of published files


def bam_entry(name: str, folder: Path) -> str:
    """The text of an entry that stands in a file of better-actuator-models."""
    place = f"bam/params/{name}/m4.json"
    found = read_bam(folder / place)
    table = {
        "machine": BAM_ENTRIES[name],
        "kind": "published",
        "notes": [f"{each}." for each in (*found.at_bounds, *found.notes)],
        "source": {
            "text": "M. Duclusaud, G. Passault, V. Padois, O. Ly, Extended friction models for the "
            f"physics simulation of servo actuators, ICRA (2025); {place} of Rhoban/bam",
            "url": f"https://github.com/Rhoban/bam/blob/{BAM_COMMIT}/{place}",
            "license": "Apache-2.0 (Duclusaud, Passault)",
        },
    }
    plant = replace(found.plant, source=name)
    paths = [path for path in plant.parameters if not path.startswith("effects")]
    units = {each.name: each.unit for each in plant.friction.record.parameters}
    numbers = {
        path: {"unit": units.get(path.partition(".")[2], UNITS.get(path, ""))} for path in paths
    }
    return written(table, numbers, plant)


UNITS = {"body.inertia": "kg·m²", "body.gravity_zero_rad": "rad"}


# --- text


def written(table: dict[str, Any], numbers: dict[str, Any], plant: st.Plant) -> str:
    """An entry as TOML."""
    lines = [
        "# Made by benches/library.py; made again, not edited.",
        *(f"{key} = {toml(value)}" for key, value in table.items() if not isinstance(value, dict)),
        "",
    ]
    for key, value in table.items():
        if isinstance(value, dict):
            lines += [f"[{key}]", *(f"{k} = {toml(v)}" for k, v in value.items()), ""]
    for path, value in numbers.items():
        lines += [f"[numbers.{json.dumps(path)}]", *(f"{k} = {toml(v)}" for k, v in value.items())]
        lines.append("")
    text = re.sub(r"^(\[+)(\w+)(\]+)$", r"\1plant.\2\3", render(plant.to_dict()), flags=re.M)
    return "\n".join(lines) + "\n" + text


def toml(value: Any) -> str:
    """A value of TOML: lists of sentences one a line."""
    if isinstance(value, list) and value and isinstance(value[0], str):
        return "[\n" + "".join(f"    {json.dumps(v, ensure_ascii=False)},\n" for v in value) + "]"
    return json.dumps(value, ensure_ascii=False)


if __name__ == "__main__":
    main()
