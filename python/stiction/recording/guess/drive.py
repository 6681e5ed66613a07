"""What drives the machine: an input, or a motion that is forced on it and an effort measured."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from ..._support.units import Motion
from ..._support.wording import plural
from ..mapping import PRESCRIBED
from .evidence import Column, goes_both_ways
from .result import DRIVE_OF

STALE_ROWS: Final = 10
"""A measured effort that usually holds for this many rows was read more slowly than they were
written."""
SUPPLY: Final = 0.5
"""A voltage that never strays further from its mean than this share of it is a supply's."""
ZERO: Final = 0.05
"""A magnitude comes this near to 0, as a share of its range."""

_SUPPLY: Final = re.compile(
    r"supply|(?<![a-z])(vin|vbus|v_bus|vcc|vdd|vbat|batt?(ery)?|mains|dc_?link|bus_?volt\w*)(?![a-z])"
    r"|input_?volts?|input_?voltage|volt(age)?_?in(?![a-z])|link_?volt",
    re.IGNORECASE,
)
_PERCENT: Final = re.compile(r"%|‰|percent|per_?mille?|\bpct\b|_pct", re.IGNORECASE)
_OTHER: Final[dict[Motion, str]] = {"rotary": "force", "linear": "torque"}
# A torque or force needs no gain; of the others current is nearest to it.
_RANK: Final = ("torque", "force", "current", "voltage", "")


@dataclass(frozen=True)
class Drive:
    """What drives: ``[drive]`` input or kind, why, by which column, and those that do not.

    ``unknown`` where nothing tells what it is measured in.
    """

    name: str | None
    reason: str
    column: Column | None = None
    quantity: str = ""
    others: tuple[Column, ...] = ()
    refused: Mapping[str, str] = field(default_factory=dict)
    unknown: bool = False


def choose_drive(
    able: Sequence[Column],
    motion: Motion,
    position: Column | None,
    referenced: bool,
    names: Collection[str] = (),
) -> Drive:
    """Choose among the columns that may be an input or a measured effort.

    Parameters
    ----------
    able : sequence of Column
    motion : {"rotary", "linear"}
    position : Column or None
    referenced : bool
        A reference is recorded, so the machine is driven.
    names : collection of str
        Of all columns.
    """
    refused = {column.name: _fault(column, motion, position) for column in able}
    refused = {name: fault for name, fault in refused.items() if fault}
    fit = [column for column in able if column.name not in refused]
    if not fit:
        return Drive(None, "no column is known to be the input", refused=refused)
    fit.sort(
        key=lambda c: (-(c.said.strength == 3), _RANK.index(quantity_of(c)), c.said.wanted,
                       -c.said.strength)
    )  # fmt: skip
    # A force beside a current is what a sensor felt, not what drives.
    inputs = [c for c in fit if quantity_of(c) != "force" or c.said.strength == 3 or c.said.wanted]
    # No sensor at the machine reads amperes or volts: a current that was measured is the drive's.
    sensed = [c for c in fit if c.said.measured and quantity_of(c) not in ("current", "voltage")]
    felt = [c for c in fit if c in sensed or c not in inputs]
    felt_only = len(felt) == len(fit)
    if felt_only and position is not None and not referenced:
        chosen = felt[0]
        quantity = quantity_of(chosen) or "force"
        why = f"'{chosen.name}' is a measured {quantity}, and no column drives the machine"
        return Drive(PRESCRIBED, why, chosen, quantity, tuple(felt[1:]), refused)
    chosen = (inputs or fit)[0]
    quantity = quantity_of(chosen)
    why = f"by column '{chosen.name}'"
    unknown = not quantity
    if unknown and _of_joint_state(chosen, names):
        quantity = "torque" if motion == "rotary" else "force"
        why += (
            f"; sensor_msgs/JointState has its effort in {'N·m' if motion == 'rotary' else 'N'}, "
            "and drivers that write current or per cent there exist"
        )
    elif unknown:
        quantity = "voltage"
        why += "; nothing tells what it is measured in, and volts are a guess"
    others = tuple(c for c in fit if c is not chosen)
    return Drive(DRIVE_OF[quantity], why, chosen, quantity, others, refused, unknown)


def quantity_of(column: Column) -> str:
    """Current, voltage, torque, force, or "" where nothing tells."""
    if column.said.unit is not None:
        return column.said.unit.quantity
    return column.said.quantity or ""


def _of_joint_state(column: Column, names: Collection[str]) -> bool:
    """Whether a column is the effort of a ROS JointState: position and velocity stand beside it."""
    return "effort" in column.name and {
        column.name.replace("effort", word) for word in ("position", "velocity")
    } <= set(names)


def runs_backward(position: Column, effort: Column) -> bool:
    """Whether an effort gives, on the whole, what only a machine that drives itself can give."""
    power = size = 0.0
    for x, f in zip(position.arrays, effort.arrays, strict=True):
        steps = np.diff(x)
        felt = 0.5 * (f[1:] + f[:-1])
        felt = felt - felt.mean()
        power += float(steps @ felt)
        size += float(np.abs(steps) @ np.abs(felt))
    return power < -0.2 * size


def _fault(column: Column, motion: Motion, position: Column | None) -> str:
    """Why a column cannot be the input, "" where it can."""
    if _PERCENT.search(column.said.strange_unit or column.name):
        return (
            f"in parts of a rated value ('{column.said.strange_unit or column.name}'), which the "
            "file does not say: give the unit of that value, and as scale the value over 100"
        )
    quantity = quantity_of(column)
    if quantity not in _RANK:
        return f"{quantity} is no quantity of an input"
    if column.constant:
        return f"it is {column.arrays[0][0]:.6g} in every row"
    if quantity == _OTHER[motion]:
        own = "torque" if motion == "rotary" else "force"
        return (
            f"a {quantity}, and the motion is {motion}: give it as {own}, with a scale for the "
            f"lever, radius or lead, or correct the kind of motion"
        )
    if quantity == "voltage" and _SUPPLY.search(column.name):
        return "a supply by its name, not what drives"
    low, high = column.low, column.high
    mean = 0.5 * (low + high)
    if quantity == "voltage" and low * high > 0.0 and high - low < 2.0 * SUPPLY * abs(mean):
        return f"it stays between {low:.4g} and {high:.4g}: a supply, not what drives"
    if column.whole and low >= 0.0 and high > 60_000.0:
        return f"it reaches {high:.6g}: a signed number stored without its sign"
    if quantity not in ("current", "torque", "force") or column.said.wanted:
        return ""
    held = column.hold_length
    if held >= STALE_ROWS:
        return f"it changes only every {plural(round(held), 'row')}: it was read too slowly"
    unsigned = low >= 0.0 and low < ZERO * high
    if unsigned and position is not None and goes_both_ways(position):
        return "it is never negative while the machine moves both ways: a magnitude without sign"
    return ""
