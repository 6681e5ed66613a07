"""In which unit a column is: what its name says, or else what its numbers make likely."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ..._support.units import UNITS, Motion
from .evidence import Column, counts_in_a_turn, rate_of

TURNS: Final = 2.0
"""Degrees are likelier than radians beyond this many turns, where the name is that of an angle."""
MANY_TURNS: Final = 10.0
"""And beyond this many for any other name: a q is seldom in degrees, a motor turns often."""
LONGEST_M: Final = 5.0
"""A travel beyond this is no travel in metres."""
LONGEST_MM: Final = 2e4
AGREES: Final = 1.35
"""A velocity agrees with the motion up to this factor: speeds that drives report are filtered."""
DISAGREES: Final = 3.0
"""Beyond this factor no filter explains it: the unit is another one, or a gear lies between."""

_ANGLE_UNITS: Final = ("rad", "deg", "rev")
_RATE_UNITS: Final[dict[Motion, tuple[str, ...]]] = {
    "rotary": ("rad/s", "deg/s", "rpm"),
    "linear": ("m/s", "mm/s"),
}


@dataclass(frozen=True)
class UnitGuess:
    """A unit, the factor on top, why, what else it could be, whether the motion contradicts it."""

    unit: str
    scale: float = 1.0
    reason: str = ""
    alternatives: tuple[str, ...] = ()
    disagrees: bool = False

    @property
    def factor(self) -> float:
        """SI values over cells, 1 for counts."""
        return (UNITS[self.unit].factor or 1.0) * self.scale


def unit_in_name(column: Column, quantities: Sequence[str]) -> UnitGuess | None:
    """The unit that the name gives, if it measures one of these quantities."""
    written = column.said.unit
    if written is None or written.quantity not in quantities:
        return None
    return UnitGuess(written.unit, written.scale, f"{written.unit}: {written.how}")


def time_unit(column: Column) -> UnitGuess:
    """Seconds, or parts of them, from the usual step."""
    step = column.step
    if step < 0.5:
        return UnitGuess("s", 1.0, f"s: a step is {step:.3g}")
    if step < 100.0:
        return UnitGuess("ms", 1.0, f"ms: a step is {step:.3g}, too long for seconds", ("s",))
    if step < 1e5:
        return UnitGuess("us", 1.0, f"us: a step is {step:.3g}, too long for ms", ("s", "ms"))
    return UnitGuess("us", 1e-3, f"nanoseconds: a step is {step:.3g}", ("us",))


def position_unit(
    column: Column, motion: Motion, velocity: Column | None, clock: Sequence[FloatArray]
) -> UnitGuess:
    """The unit of a position from the steps of its sensor, a velocity, and its range."""
    if column.whole and column.span > (1000.0 if motion == "linear" else 720.0):
        return UnitGuess("count", 1.0, "count: whole numbers over a wide range", ("deg", "mm"))
    if motion == "linear":
        return _length_unit(column)
    for unit, turn in (("rad", 2.0 * math.pi), ("deg", 360.0)):
        number = counts_in_a_turn(column.count, turn)
        # A step of 0.01 deg may be a rounded number: only a power of two is an encoder's.
        if number and (unit == "rad" or number & (number - 1) == 0):
            other = "deg" if unit == "rad" else "rad"
            told = f"{unit}: readings come in steps of {column.count:.4g}, {number} to a turn"
            return UnitGuess(unit, 1.0, told, (other,))
    if velocity is not None and velocity.said.unit is not None and clock:
        told_rate = velocity.said.unit
        ratio, fit = rate_of(column, clock, velocity)
        if told_rate.quantity == "angular velocity" and abs(fit) > 0.8:
            factor = (UNITS[told_rate.unit].factor or 1.0) * told_rate.scale * abs(ratio)
            unit = min(_ANGLE_UNITS, key=lambda u: abs(math.log((UNITS[u].factor or 1.0) / factor)))
            return UnitGuess(unit, 1.0, f"{unit}: so it agrees with '{velocity.name}'")
    turns = column.span / (2.0 * math.pi)
    limit = TURNS if column.said.word in ("angle", "ang", "winkel", "angular") else MANY_TURNS
    if turns > limit:
        told = f"deg: its range is {column.span:.4g}, which in rad would be {turns:.3g} turns"
        return UnitGuess("deg", 1.0, told, ("rad", "rev"))
    told = f"rad: its range is {column.span:.4g}, {turns:.2g} turns"
    return UnitGuess("rad", 1.0, told, ("deg",))


def _length_unit(column: Column) -> UnitGuess:
    if column.span > LONGEST_MM:
        return UnitGuess("um", 1.0, f"um: its range is {column.span:.4g}", ("mm",))
    if column.span > LONGEST_M:
        told = f"mm: its range is {column.span:.4g}, too long a travel in m"
        return UnitGuess("mm", 1.0, told, ("m", "um"))
    told = f"m: its range is {column.span:.4g}, {1e3 * column.span:.3g} mm"
    return UnitGuess("m", 1.0, told, ("mm",))


def reference_unit(column: Column, position: Column, unit: UnitGuess) -> UnitGuess:
    """That of the position where the ranges are alike, or else the one that makes them so."""
    kind = UNITS[unit.unit].quantity
    allowed = [name for name, u in UNITS.items() if u.quantity == kind and u.factor is not None]
    if not allowed or column.span <= 0.0 or position.span <= 0.0:
        return UnitGuess(unit.unit, unit.scale, f"{unit.unit}: as the position")
    apart = column.span / position.span
    if 0.1 < apart < 10.0:
        return UnitGuess(unit.unit, unit.scale, f"{unit.unit}: its range is like the position's")
    want = unit.factor / apart
    best = min(allowed, key=lambda name: abs(math.log((UNITS[name].factor or 1.0) / want)))
    return UnitGuess(best, 1.0, f"{best}: brings its range nearest to the position's", (unit.unit,))


def velocity_unit(
    column: Column, motion: Motion, position: Column | None, factor: float, clock: list[FloatArray]
) -> UnitGuess:
    """The unit under which a velocity is the rate of change of the position.

    Parameters
    ----------
    factor : float
        SI values of the position over its cells.
    """
    units = _RATE_UNITS[motion]
    told = unit_in_name(column, ("angular velocity", "velocity"))
    ratio, fit = (0.0, 0.0) if position is None else rate_of(position, clock, column)
    if abs(fit) < 0.5:
        seen = "it does not follow the changes of position; check it, or drop it"
        if position is None or not clock:
            seen = "nothing to compare it with"
        guess = told or UnitGuess(units[0], 1.0, f"{units[0]}: the SI unit", units[1:])
        return UnitGuess(guess.unit, guess.scale, f"{guess.reason}; {seen}", guess.alternatives)
    sign = 1.0 if ratio > 0.0 else -1.0
    flipped = "" if sign > 0.0 else "; scale -1, for it runs against the position"
    per_si = abs(ratio) / factor
    if told is not None:
        off = told.factor * per_si
        seen = "" if 1.0 / AGREES < off < AGREES else f"; it is {off:.3g} times the motion's rate"
        reason = told.reason + seen + flipped
        return UnitGuess(told.unit, sign * told.scale, reason, disagrees=_far(off))
    unit = min(units, key=lambda name: abs(math.log((UNITS[name].factor or 1.0) * per_si)))
    off = (UNITS[unit].factor or 1.0) * per_si
    others = tuple(name for name in units if name != unit)
    agrees = 1.0 / AGREES < off < AGREES
    seen = "so it agrees with the changes of position" if agrees else (
        f"the nearest; it is {off:.3g} times the rate of the position"
    )  # fmt: skip
    return UnitGuess(unit, sign, f"{unit}: {seen}{flipped}", others, disagrees=_far(off))


def _far(off: float) -> bool:
    return not 1.0 / DISAGREES < off < DISAGREES


def drive_unit(column: Column, quantity: str) -> UnitGuess:
    """The unit of an input or effort by its size."""
    largest = max(abs(column.low), abs(column.high))
    if quantity == "current" and largest > 100.0:
        return UnitGuess("mA", 1.0, f"mA: it reaches {largest:.4g}", ("A",))
    if quantity == "voltage" and largest > 1000.0:
        return UnitGuess("mV", 1.0, f"mV: it reaches {largest:.4g}", ("V",))
    unit, other = {
        "current": ("A", "mA"),
        "voltage": ("V", "mV"),
        "torque": ("Nm", "mNm"),
        "force": ("N", "kN"),
    }[quantity]
    return UnitGuess(unit, 1.0, f"{unit}: it reaches {largest:.4g}", (other,))


def temperature_unit(column: Column) -> UnitGuess:
    """Degrees Celsius, or kelvin where it would be hot."""
    # The median: a reading that failed is no temperature.
    usual = float(np.median(np.concatenate(column.arrays)))
    if usual > 200.0:
        return UnitGuess("K", 1.0, f"K: it is around {usual:.4g}", ("degC",))
    return UnitGuess("degC", 1.0, f"degC: it is around {usual:.4g}", ("K",))
