"""C of a whole machine: the contact, the body that rests on it, and the drive."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from .._support.wording import commas
from ..plant.drive import servo_numbers
from .contact_source import (
    ContactSource,
    collapse_blank_lines,
    plant_numbers,
    prologue,
    structures_of,
)
from .fragments import Fragments
from .translation import call_graph, dual_of, parse
from .translation.names import nodes
from .translation.tree import Member, Unit

if TYPE_CHECKING:
    from ..plant import Plant

__all__ = ["MachineSource"]

SERVO: Final = {
    "proportional": 1.0,
    "integral": 0.0,
    "derivative": 0.0,
    "duty_limit": 1.0,
    "supply": 1.0,
    "resistance": 1.0,
    "current_limit": math.inf,
}
"""Numbers of a servo, and what they are where they are not stated."""


WATCHED: Final = 4.0
"""Speed from which on down a solver is told to look, in those over which friction falls."""


@dataclass(frozen=True)
class MachineSource:
    """C of a plant that moves.

    Attributes
    ----------
    source : str
        One file, without the interface that calls it.
    effects : tuple of str
        Of the plant, that it has.
    sampled : str
        Why not, "" where it can.
    states : int
        Of these equations.
    temperature : bool
        Whether anything goes by it.
    watches : bool
        Whether there is an event where friction begins to fall.
    goes_by : frozenset of str
        Of "position" and "time", by what the acceleration goes.
    """

    source: str
    effects: tuple[str, ...]
    sampled: str
    states: int
    temperature: bool
    watches: bool
    goes_by: frozenset[str]

    @property
    def exchanges(self) -> bool:
        """Whether it can be stated as differential equations with events."""
        return not self.sampled

    @classmethod
    def of(cls, plant: Plant, interface: tuple[str, ...], numbers: dict[str, Any]) -> MachineSource:
        """Of a plant that is driven, with the fragments of an interface behind it."""
        fragments = Fragments({**plant_numbers(plant), **_servo(plant), **numbers})
        fragments.flags |= {"MACHINE", "POSITION", "TIME", "PATH"}
        fragments.numbers["QUADRATIC_DRAG"] = 0.0
        contact = ContactSource.of(plant, fragments, driven=True)
        fragments.numbers |= _divides(plant, fragments.numbers)
        straining = "LEVELS" in fragments.flags or fragments.numbers["QUADRATIC_DRAG"] > 0.0
        if straining:
            fragments.flags.add("STRAINS")
        sampled = _sampled(plant, fragments)
        if sampled:
            fragments.flags.discard("EXCHANGES")
        own = () if sampled else ("exchange",)
        text = contact.source
        for name in ("init", "way", "machine", "running", *own):
            text += "\n" + fragments.expand(name)
        goes_by: frozenset[str] = frozenset()
        if not sampled:
            parts = map(fragments.expand, ("machine", "exchange"))
            unit = parse("\n".join((structures_of(contact.types), contact.source, *parts)))
            text += dual_of(unit, "evaluate", ("stiction_machine", "acting"))
            goes_by = _goes_by(unit, fragments)
        for name in interface:
            text += "\n" + fragments.expand(name)
        types = "#define STICTION_REAL double\n" + contact.types
        source = types + prologue(text) + fragments.constants(text) + "\n" + text
        states = 3 if "BENDS" in fragments.flags else 2
        temperature = "TEMPERATURE" in fragments.flags
        watches = fragments.numbers["WATCHED"] > 0.0
        return cls(
            collapse_blank_lines(source),
            contact.effects,
            sampled,
            states,
            temperature,
            watches,
            goes_by,
        )


def _servo(plant: Plant) -> dict[str, Any]:
    stated = servo_numbers(plant.drive)
    numbers = {} if stated is None else SERVO | stated
    limit = float(plant.drive.get("limit", math.inf))
    named = {f"SERVO_{name.upper()}": value for name, value in numbers.items()}
    return {"SERVO": stated is not None, "INPUT_LIMIT": limit, **named}


def _divides(plant: Plant, numbers: dict[str, Any]) -> dict[str, float]:
    """What a sample is divided by: the swing that is fastest, and what calms and falls."""
    stiffness = numbers["STIFFEST"] + abs(numbers["GRAVITY"])
    own = [name for name in numbers if name.removesuffix("_STIFFNESS").islower()]
    stiffness += sum(numbers[name] for name in own if name.endswith("_STIFFNESS"))
    damping = numbers["CALMS"]
    if numbers["SERVO"]:
        gain = abs(numbers["GAIN"]) * numbers["SERVO_SUPPLY"] / numbers["SERVO_RESISTANCE"]
        stiffness += gain * abs(numbers["SERVO_PROPORTIONAL"])
        damping += gain * abs(numbers["SERVO_DERIVATIVE"])
        damping += numbers["GAIN"] ** 2 / numbers["SERVO_RESISTANCE"]
    falls, watched = numbers.get("FALLS_BY", 0.0), 0.0
    if falls:
        watched = WATCHED * numbers["STRIBECK_VELOCITY"]
        falls *= max(numbers["STRIBECK_EXPONENT"], 1.0) / numbers["STRIBECK_VELOCITY"]
    inertia = plant.inertia
    return {
        "FASTEST": math.sqrt(stiffness / inertia),
        "CALMING": damping / inertia,
        "FALLING": falls / inertia,
        "WATCHED": watched,
    }


BOOKKEEPING: Final = frozenset(
    {"evaluate", "resistance", "placed", "dry_now", "ambient", "reach", "accept"}
)
"""Functions that lead a contact to where it is asked for, whatever goes by that."""
NEEDS: Final = {
    "position": frozenset({"position", "displacement", "path", "moved"}),
    "time": frozenset({"time", "dt"}),
}
"""Fields that a function reads which goes by position or time."""


def _goes_by(unit: Unit, fragments: Fragments) -> frozenset[str]:
    """What the equations read beside velocity, bristles and what acts on the machine."""
    fields = {
        node.name
        for function in call_graph(unit, "evaluate")
        if function.name not in BOOKKEEPING
        for node in nodes(function.body)
        if isinstance(node, Member)
    }
    # Bristles have a state of their own: their contact is not led along a way.
    fields -= {"displacement", "dt"} if "BENDS" in fragments.flags else set()
    fields |= {"position"} if fragments.numbers["GRAVITY"] != 0.0 else set()
    return frozenset(name for name, read in NEEDS.items() if fields & read)


def _sampled(plant: Plant, fragments: Fragments) -> str:
    """What of a plant is stepped and no equation over time, in words."""
    if "EXCHANGES" not in fragments.flags:
        return f"{plant.friction.law} is stepped, and no equation over time"
    remember = [name for hook in ("remember", "creep") for name in fragments.hooks.get(hook, ())]
    if remember:
        return f"{commas(list(dict.fromkeys(remember)))} remembers from sample to sample"
    if fragments.numbers["SERVO"] and fragments.numbers["SERVO_INTEGRAL"] != 0.0:
        return "the servo sums up from sample to sample"
    late = {"DELAYS", "SLOWS", "LAGS"} & fragments.flags
    return "the input arrives late, sample by sample" if late else ""
