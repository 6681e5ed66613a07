"""A plant from a file of parameters of `better-actuator-models` (BAM)."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from .._support import given
from .._support.given import number
from .._support.keys import choice
from .._support.wording import commas
from ..errors import InputError
from .format import ACTUATORS, BESIDE, GOAL, MODELS, RELEASE, Actuator, Searched, search_space

if TYPE_CHECKING:
    from ..plant import Plant

__all__ = ["BamReading", "read_bam"]

_LARGEST: Final = 2**20
"""Bytes of a file; there are two dozen numbers in one."""
AT_BOUND: Final = 1e-3
"""Share of its range within which a number counts as at the end of it: the search of BAM (CMA-ES)
comes near an end and does not stand on it."""
EXPONENTS: Final = (0.3, 5.0)
"""That laws here take; BAM's search goes to 10."""


@dataclass(frozen=True)
class BamReading:
    """A plant, and what its file tells beside it.

    Attributes
    ----------
    plant : Plant
    model : str
        ``"m1"`` to ``"m6"``.
    actuator : str
        As the file calls it.
    at_bounds : tuple of str
        Numbers that stand at an end of BAM's search, or beyond it, a sentence each: such a number
        says where the search ended, and not what the actuator is.
    notes : tuple of str
        What is not in the file, or could not be taken as it is, likewise.
    """

    plant: Plant
    model: str
    actuator: str
    at_bounds: tuple[str, ...]
    notes: tuple[str, ...]

    def __str__(self) -> str:
        head = f"{self.model.upper()} of {self.actuator}: law {self.plant.friction.law}"
        return "\n".join([head, *(f"  {each}" for each in (*self.at_bounds, *self.notes))])

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain data, the plant as the tables of its file."""
        return {
            "schema": 1,
            "model": self.model,
            "actuator": self.actuator,
            "at_bounds": list(self.at_bounds),
            "notes": list(self.notes),
            "plant": self.plant.to_dict(),
        }


def read_bam(path: str | Path, *, kp: float | None = None, vin: float | None = None) -> BamReading:
    """Read a file of parameters, as `bam.fit` writes it and `bam/params` holds them.

    Parameters
    ----------
    path : str or Path
        JSON: ``model`` ("m1" to "m6"), ``actuator``, and numbers by their names in BAM.
    kp : float, optional
        Gain of the firmware's controller, in BAM's unit; without it that of the file, or of the
        actuator as BAM has it.
    vin : float, optional
        Supply, V; likewise.

    Returns
    -------
    BamReading
        Of M1 and M2 the law is ``coulomb``, of the others ``load_dependent``. Servos that BAM knows
        come with their own loop (drive of kind "servo"); of others the input is voltage, current or
        torque, whichever the numbers lead to.

    Raises
    ------
    InputError
        No such file, no JSON, no such model, a number that is none or that no plant takes.
    """
    from ..plant import Plant

    file = given.path(path, "read_bam")
    source = str(file)
    table = _content(file)
    model, actuator = _names(table, source)
    ranges = search_space(model, actuator)
    told = {**table, **{k: v for k, v in (("kp", kp), ("vin", vin)) if v is not None}}
    known = [name for name in told if name in (*ranges, *BESIDE[:-1])]
    stated = {name: _finite(told[name], f"{source}: {name}") for name in known}
    foreign = [name for name in table if name not in (*known, "model", "actuator", "input")]
    notes = _left_out(stated, ranges, foreign, model)
    numbers = {name: stated.get(name, each.start) for name, each in ranges.items()}
    friction, more = _friction(model, numbers)
    drive = _Drive(actuator, numbers, stated, table.get("input"), source)
    friction["viscous"] += drive.viscous
    tables: dict[str, Any] = {
        "motion": {"kind": "rotary"},
        "drive": drive.table,
        "body": _body(numbers, stated),
        "friction": friction,
    }
    if drive.effects:
        tables["effects"] = drive.effects
    return BamReading(
        Plant.from_dict(tables, source=source),
        model,
        actuator,
        tuple(_at_bounds(stated, ranges)),
        (*notes, *more, *drive.notes),
    )


def _content(path: Path) -> dict[str, Any]:
    wanted = "a file of parameters of better-actuator-models is one object of names and numbers"
    try:
        if given.regular(path).st_size > _LARGEST:
            raise InputError(f"{path}: is larger than 1 MiB, and {wanted}; check the path")
        content = json.loads(path.read_bytes().decode("utf-8-sig"))
    except OSError as error:
        raise InputError(
            f"{path}: cannot be read ({error.strerror}); check the path and its rights"
        ) from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not text in UTF-8; save it as UTF-8") from None
    except json.JSONDecodeError as error:
        raise InputError(
            f"{path}: line {error.lineno} is not JSON ({error.msg}), and {wanted}; check the path"
        ) from None
    except InputError:
        raise
    except (ValueError, RecursionError):
        raise InputError(f"{path}: cannot be read as JSON: {wanted}; check the path") from None
    if not isinstance(content, dict) or not {"model", "actuator"} <= content.keys():
        raise InputError(f'{path}: names no "model" and "actuator": {wanted}; check the path')
    return content


def _names(table: Mapping[str, Any], source: str) -> tuple[str, str]:
    model = choice(table["model"], MODELS, f"{source}: model")
    return model, given.word(table["actuator"], f"{source}: actuator")


def _finite(value: Any, where: str) -> float:
    found = number(value, where)
    if math.isinf(found):
        raise InputError(f"{where} = {found}: give a finite number")
    return found


def _left_out(
    stated: Mapping[str, float],
    ranges: Mapping[str, Searched],
    foreign: list[str],
    model: str,
) -> tuple[str, ...]:
    """What the file does not say, and what it says that no model asks for."""
    notes = [
        f"{name} is not in the file: {each.start:g} is taken, the start of BAM's search"
        for name, each in ranges.items()
        if name not in stated and name != "q_offset" and math.isfinite(each.start)
    ]
    if "armature" not in stated and math.isnan(ranges["armature"].start):
        notes.append("armature is not in the file: state [body] inertia to simulate")
    if foreign:
        notes.append(f"{commas(foreign)}: no number of {model.upper()}, and left out as BAM does")
    return tuple(notes)


def _at_bounds(stated: Mapping[str, float], ranges: Mapping[str, Searched]) -> list[str]:
    lines = []
    for name, each in ranges.items():
        if name not in stated or (name == "q_offset" and stated[name] == 0.0):
            continue
        value, near = stated[name], AT_BOUND * (each.most - each.least)
        if not math.isfinite(near):
            # Nobody searched for it within bounds.
            continue
        search = f"that the search of BAM {RELEASE} takes"
        for end, word, side in ((each.least, "least", -1.0), (each.most, "most", 1.0)):
            beyond = side * (value - end)
            if beyond > near:
                lines.append(f"{name} = {value:.6g} is beyond {end:g}, the {word} {search}")
            elif beyond >= -near:
                lines.append(f"{name} = {value:.6g} stands at {end:g}, the {word} {search}")
    return lines


def _friction(model: str, numbers: Mapping[str, float]) -> tuple[dict[str, Any], list[str]]:
    """The table [friction], and what could not be taken as it is."""
    base, notes = numbers["friction_base"], []
    table: dict[str, Any] = {"law": "coulomb", "coulomb": base}
    if "friction_stribeck" in numbers:
        exponent = min(max(numbers["alpha"], EXPONENTS[0]), EXPONENTS[1])
        table["breakaway"] = base + numbers["friction_stribeck"]
        table["stribeck_velocity"] = numbers["dtheta_stribeck"]
        table["stribeck_exponent"] = exponent
        if exponent != numbers["alpha"]:
            notes.append(_other_exponent(numbers["alpha"], exponent))
    names = MODELS[model]
    if "load_friction_base" in names:
        table["law"] = "load_dependent"
        table["drive"] = table["back_drive"] = numbers["load_friction_base"]
        steep = numbers.get("load_friction_stribeck", 0.0)
        table["drive_stribeck"] = table["back_drive_stribeck"] = steep
    elif "load_friction_motor" in names:
        table["law"] = "load_dependent"
        table["drive"] = numbers["load_friction_motor"]
        table["back_drive"] = numbers["load_friction_external"]
        table["drive_stribeck"] = numbers["load_friction_motor_stribeck"]
        table["back_drive_stribeck"] = numbers["load_friction_external_stribeck"]
    if "load_friction_motor_quad" in names:
        # BAM calls a term by the effort that is squared, and acts with it the other way.
        table["drive_quadratic"] = numbers["load_friction_external_quad"]
        table["back_drive_quadratic"] = numbers["load_friction_motor_quad"]
    table["viscous"] = numbers["friction_viscous"]
    return table, notes


def _other_exponent(alpha: float, taken: float) -> str:
    speeds = np.geomspace(1e-3, 1e3, 4001)
    with np.errstate(over="ignore"):
        off = np.abs(np.exp(-(speeds**alpha)) - np.exp(-(speeds**taken)))
    at = speeds[int(np.argmax(off))]
    return (
        f"alpha = {alpha:.4g} is out of bounds of the laws here, {EXPONENTS[0]:g} to "
        f"{EXPONENTS[1]:g}: {taken:g} is taken, which changes what falls with speed by up to "
        f"{100.0 * np.max(off):.3g} % of itself, at {at:.3g} of dtheta_stribeck"
    )


def _body(numbers: Mapping[str, float], stated: Mapping[str, float]) -> dict[str, float]:
    body = {"inertia": numbers["armature"]} if math.isfinite(numbers["armature"]) else {}
    if numbers["q_offset"] != 0.0:
        body["gravity_zero_rad"] = -numbers["q_offset"]
    if "mass" in stated and "length" in stated:
        body |= {"payload_kg": stated["mass"], "payload_m": stated["length"]}
    return body


class _Drive:
    """The table [drive], its effects, what it adds to viscous friction, and what is to be told."""

    def __init__(
        self,
        name: str,
        numbers: Mapping[str, float],
        stated: Mapping[str, float],
        input: Any,
        source: str,
    ) -> None:
        self.table: dict[str, Any] = {}
        self.effects: list[dict[str, Any]] = []
        self.notes: list[str] = []
        self.viscous = 0.0
        self._numbers, self._stated, self._name = numbers, stated, name
        self._kt, self._resistance = (numbers.get(key, math.nan) for key in ("kt", "R"))
        for key in ("kt", "R", "max_velocity"):
            if numbers.get(key, 1.0) <= 0.0:
                raise InputError(
                    f"{source}: {key} = {numbers[key]:g} is not above 0; give what the motor has"
                )
        if stated.get("vin", 1.0) <= 0.0:
            raise InputError(
                f"{source}: vin = {stated['vin']:g} is not above 0; give the supply in V"
            )
        known = ACTUATORS.get(name)
        if input is not None:
            self._open(choice(input, ("voltage_v", "current_a", "torque_nm"), f"{source}: input"))
        elif known is None:
            self._foreign()
        elif known.kind == "voltage":
            self._voltage(known)
        elif known.kind == "current":
            self._current(known)
        else:
            self._other()

    def _open(self, input: str) -> None:
        """A drive that was written from a plant without a loop."""
        gain = self._kt / self._resistance if input == "voltage_v" else self._kt
        self.table = {"input": input, "gain": gain}

    def _foreign(self) -> None:
        """An actuator of somebody's own: its controller stands in no file."""
        told = f"{self._name} is no actuator of BAM {RELEASE}, whose controllers are known:"
        if math.isfinite(self._kt) and math.isfinite(self._resistance):
            self.table = {"input": "voltage_v", "gain": self._kt / self._resistance}
            self.viscous = self._kt * (self._kt / self._resistance)
            self.notes.append(
                f"{told} the input is the motor's voltage, and kt²/R = {self.viscous:.4g} "
                "N·m·s/rad of its own voltage stands in viscous friction"
            )
        elif math.isfinite(self._kt):
            self.table = {"input": "current_a", "gain": self._kt}
            self.notes.append(f"{told} the input is the motor's current")
        else:
            self._other()

    def _other(self) -> None:
        if "current_limit" in self._numbers:
            limit = self._numbers["current_limit"]
            self.table = {"input": "current_a", "gain": self._kt, "limit": limit}
            self.notes.append(
                f"{self._name} controls its current, and a servo here its voltage: the input is "
                "the motor's current"
            )
            return
        self.table = {"input": "torque_nm", "gain": 1.0}
        if "max_torque" in self._numbers:
            self.table["limit"] = self._numbers["max_torque"]
        self.notes.append(
            f"the drive of {self._name} is none that a plant here has: the input is the torque of "
            "its motor"
        )

    def _voltage(self, known: Actuator) -> None:
        kp, supply = self._stated.get("kp", known.kp), self._stated.get("vin", known.supply)
        assert kp is not None
        for key, value in (("kp", kp), ("vin", supply)):
            if key not in self._stated:
                self.notes.append(
                    f"{key} is that of BAM's {self._name}, {value:g}; give yours where it differs"
                )
        self.table = {
            "kind": "servo",
            "proportional": kp * known.error_gain * self._numbers.get("error_gain_ratio", 1.0),
            "supply_v": supply,
            "resistance_ohm": self._resistance,
            "torque_constant": self._kt,
        }
        if known.duty_limit != 1.0:
            self.table["duty_limit"] = known.duty_limit
        if math.isfinite(known.current_limit):
            self.table["current_limit_a"] = known.current_limit
        if "max_velocity" in self._numbers:
            slowness = 1.0 / self._numbers["max_velocity"]
            self.effects.append({"name": GOAL, "slowness": slowness})

    def _current(self, known: Actuator) -> None:
        """A PD controller of the current, which is one of the voltage as well."""
        kt, resistance = self._kt, self._resistance
        kp, supply = self._stated.get("kp"), self._stated.get("vin", known.supply)
        if kp is None:
            self.table = {"input": "current_a", "gain": kt, "limit": known.current_limit}
            self.notes.append(
                f"{self._name} has no kp of its own, and the file states none: the input is the "
                "motor's current; give kp for its loop"
            )
            return
        # kp·(goal − q) − damping·√kp·q' in A is that of a voltage which overcomes kt·q' as well.
        derivative = (known.damping * math.sqrt(max(kp, 0.0)) * resistance - kt) / supply
        if derivative < 0.0:
            self.table = {"input": "current_a", "gain": kt, "limit": known.current_limit}
            self.notes.append(
                f"kp = {kp:g} damps less than the motor's own voltage does, and a servo here makes "
                "a voltage: the input is the motor's current"
            )
            return
        self.table = {
            "kind": "servo",
            "proportional": kp * resistance / supply,
            "derivative": derivative,
            "supply_v": supply,
            "resistance_ohm": resistance,
            "torque_constant": kt,
            "current_limit_a": known.current_limit,
        }
