"""FMU: the machine with its contact for co-simulation and model exchange (FMI 3.0 and 2.0)."""

from __future__ import annotations

import html
import uuid
from typing import TYPE_CHECKING, Any, Final

from ..._support.json_text import json_of
from ...errors import InputError
from ...plant.joint import beside
from ..fmi_description import IDENTIFIER, Described, Variable, build_description, fmi2, fmi3
from ..fmu_archive import archive, binary_of
from ..fmu_run import run_windows
from ..fragments import names_of
from ..machine_source import MachineSource
from ..made import Export
from ..runs import MotionRun

if TYPE_CHECKING:
    from ...plant import Plant

SUMMARY = "the machine as an FMU for co-simulation and model exchange, FMI 3.0 and FMI 2.0"
INTERFACE: Final = ("fmi", "fmi3", "fmi2")
NAMESPACE: Final = uuid.UUID("8b6cf1f2-6a1c-4e0e-9d0b-0a5b2d7f5c11")
SHORTEST: Final = 1e-3
"""Position that a solver takes for one where a contact does not yield, rad or m."""
ASCII_UNITS: Final = {"N·m": "N.m", "°C": "degC"}


def write(plant: Plant, speed: float) -> Export:
    """An archive for each version of the standard, with the same sources and the same binary."""
    if plant.prescribed_motion:
        raise InputError(
            f"{plant.source}: fmu: a machine whose motion is prescribed has no equation of motion; "
            "export its friction with --to c"
        )
    if plant.inertia <= 0.0:
        raise InputError(
            f"{plant.source}: fmu: the machine has no inertia, and nothing says how it moves; "
            "state [body] inertia, of a joint of a robot its rotor_inertia"
        )
    law = plant.friction.law
    if law not in names_of("laws"):
        raise InputError(f"{plant.source}: fmu: {law} has no C yet; --to c has its feed-forward")
    numbers = _numbers(plant)
    made = MachineSource.of(plant, INTERFACE, numbers)
    token = "{" + str(uuid.uuid5(NAMESPACE, made.source)) + "}"
    source = made.source.replace(_TOKEN, f'"{token}"')
    binary = binary_of(source)
    held, lost = _held(plant, made), _lost(plant, made, binary)
    of = Described(law, token, _title(plant), _variables(plant, made), made.exchanges)
    common = {
        f"sources/{IDENTIFIER}.c": source,
        "resources/plant.json": json_of(plant.to_dict()) + "\n",
        "documentation/index.html": _page(plant, held, lost),
    }
    third = {"modelDescription.xml": fmi3(of), **common}
    third["sources/buildDescription.xml"] = build_description()
    second = {"modelDescription.xml": fmi2(of), **common}
    files: dict[str, str | bytes] = {}
    for name, inside, place in (("plant.fmu", third, 0), ("plant_fmi2.fmu", second, 1)):
        whole: dict[str, str | bytes] = dict(inside)
        if not isinstance(binary, str):
            platform, library = binary
            whole[f"binaries/{platform[place]}/{IDENTIFIER}.{platform[2]}"] = library
        files[name] = archive(whole)
    return Export("fmu", files, held, lost, {})


def runs(made: Export, plant: Plant) -> tuple[MotionRun]:
    """The FMU of version 3.0 in co-simulation, its contact led to where each window starts."""
    whole = made.files["plant.fmu"]
    assert isinstance(whole, bytes)
    return (MotionRun("", lambda windows: run_windows(whole, windows)),)


_TOKEN: Final = '"@token@"'


def _numbers(plant: Plant) -> dict[str, Any]:
    return {"TOKEN": _TOKEN, "COUNT": plant.count, "NOMINAL": [SHORTEST, SHORTEST, 1.0]}


def _title(plant: Plant) -> str:
    effects = "".join(f" + {effect.name}" for effect in plant.effects)
    return f"A {plant.motion} machine with friction: {plant.friction.law}{effects}"


def _variables(plant: Plant, made: MachineSource) -> tuple[Variable, ...]:
    place = plant.position_unit
    effort = ASCII_UNITS.get(plant.effort_unit, plant.effort_unit)
    given = {"current_a": "A", "voltage_v": "V", "torque_nm": "N.m", "force_n": "N"}
    unit = place if plant.servo else given.get(plant.drive.get("input", ""), effort)
    wanted = "goal of the servo" if plant.servo else "input of the drive"
    found = [
        Variable("time", 0, "independent", "s", "time"),
        Variable("input", 1, "input", unit, wanted, 0.0),
        Variable("load", 2, "input", effort, "external effort, positive along +x", 0.0),
        Variable("enabled", 12, "input", "", "whether the drive is on", 1.0),
    ]
    if made.temperature:
        found.append(Variable("temperature", 3, "input", "degC", "of the contact", 20.0))
    rate, bristles = f"{place}/s", ("bristle_force",) if made.states == 3 else ()
    inputs = tuple(each.name for each in found if each.causality == "input")
    # What the equation of motion goes by.
    by = (*inputs, "velocity", *bristles, *made.goes_by)
    resists = "effort that resists positive motion"
    found += [
        Variable("position", 4, "output", place, "of the body", 0.0, by=("position",)),
        Variable("velocity", 5, "output", rate, "of the body", 0.0, "position", ("velocity",)),
        Variable("friction", 6, "output", effort, resists, by=by),
    ]
    if plant.count:
        shown = "position as the encoder shows it"
        found.append(Variable("measured", 11, "output", place, shown, by=("position",)))
    if made.exchanges:
        second, words = f"{rate}2", "of the body"
        found.append(Variable("acceleration", 7, "local", second, words, None, "velocity", by))
        if bristles:
            own, pace = ("velocity", *bristles), f"{effort}/s"
            found += [
                Variable("bristle_force", 8, "local", effort, "of the bristles", 0.0),
                Variable("bristle_rate", 9, "local", pace, "of their force", None, *bristles, own),
            ]
        words = "of stick, slip, reversal"
        found.append(Variable("event_indicator", 10, "local", effort, words, by=by))
        if made.watches:
            words = "of the fall of friction"
            found.append(Variable("fall_indicator", 13, "local", rate, words, by=("velocity",)))
    return tuple(found)


def _held(plant: Plant, made: MachineSource) -> tuple[str, ...]:
    drive = "a servo" if plant.servo else "a drive"
    what = " + ".join((plant.friction.law, *made.effects))
    ways = "co-simulation and model exchange" if made.exchanges else "co-simulation"
    return (f"{drive}, the body and its contact: {what}", ways)


def _lost(plant: Plant, made: MachineSource, binary: object) -> tuple[str, ...]:
    lost = beside(plant, lambda each: each.name in made.effects, limited=True, yielding=True)
    exchange = () if made.exchanges else (f"model exchange: {made.sampled}; co-simulation has it",)
    none = (f"a binary: {binary}; fmpy compile makes one",) if isinstance(binary, str) else ()
    return (*lost, *exchange, *none)


def _page(plant: Plant, held: tuple[str, ...], lost: tuple[str, ...]) -> str:
    rows = [f"<h1>{html.escape(_title(plant))}</h1>", "<h2>It holds</h2>", "<ul>"]
    rows += [f"<li>{html.escape(each)}</li>" for each in held]
    rows += ["</ul>", "<h2>It cannot hold</h2>", "<ul>"]
    rows += [f"<li>{html.escape(each)}</li>" for each in lost or ("nothing is lost",)]
    return "<!DOCTYPE html>\n<meta charset='utf-8'>\n" + "\n".join([*rows, "</ul>"]) + "\n"


__all__ = ["SUMMARY", "runs", "write"]
