"""How far, how fast and how hard the joints of a robot may move."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from .._support.arrays import FloatArray
from .._support.given import brief, number
from .._support.keys import check_keys
from .._support.wording import commas
from ..errors import InputError
from ..plan.limits import MARGIN
from .description import JointLimits

if TYPE_CHECKING:
    from .robot import Robot

__all__ = ["ArmLimits", "arm_limits", "limits_table"]

_KEYS: Final = ("position", "speed", "effort")
_HALF_TURN: Final = math.pi
"""Either way, where a joint turns without end and nothing says how far it may."""


@dataclass(frozen=True)
class ArmLimits:
    """Limits of the joints of an arm, as they are planned for: margins are taken off.

    Attributes
    ----------
    home : numpy.ndarray, shape (joints,)
        Where every signal begins and ends: the middle of the box of positions, rad or m.
    reach : numpy.ndarray, shape (joints,)
        Greatest distance from there.
    speed : numpy.ndarray, shape (joints,)
        rad/s or m/s.
    effort : numpy.ndarray, shape (joints,)
        Of the drive at the joint, N·m or N.
    """

    home: FloatArray
    reach: FloatArray
    speed: FloatArray
    effort: FloatArray


def limits_table(table: Mapping[str, Any], where: str) -> dict[str, Any]:
    """The ``limits`` of a joint in a robot file, checked.

    Parameters
    ----------
    table : mapping
        ``position`` (two numbers, rad or m), ``speed``, ``effort``.
    where : str
        What messages call it.

    Raises
    ------
    InputError
        An unknown key, positions that are no two rising numbers, a limit not above 0.
    """
    check_keys(table, _KEYS, where)
    found: dict[str, Any] = {}
    if "position" in table:
        told = table["position"]
        if not isinstance(told, list) or len(told) != 2:
            raise InputError(
                f"{where} position = {brief(told)}: give from and to, as in [-1.5, 1.5]"
            )
        low, high = (number(one, f"{where} position") for one in told)
        if not (math.isfinite(low) and math.isfinite(high) and low < high):
            raise InputError(
                f"{where} position = [{low:g}, {high:g}]: give two finite numbers, the lower first"
            )
        found["position"] = [low, high]
    for key in ("speed", "effort"):
        if key in table:
            found[key] = _above_zero(table[key], f"{where} {key}")
    return found


def arm_limits(
    robot: Robot,
    *,
    position: float | None = None,
    speed: float | None = None,
    effort: float | None = None,
) -> tuple[ArmLimits, list[str]]:
    """Limits of a robot: its file's, where that is silent the URDF's; and what was assumed.

    Parameters
    ----------
    robot : Robot
    position, speed, effort : float, optional
        Of every joint, where they are narrower: distance from the middle of its positions,
        speed, effort.

    Raises
    ------
    InputError
        A joint whose limits nobody states; a number not above 0.
    """
    given = {
        name: None if value is None else _above_zero(value, name)
        for name, value in (("position", position), ("speed", speed), ("effort", effort))
    }
    endless: list[str] = []
    rows = []
    for joint in robot.joints:
        own = _of_joint(robot.stated_limits[joint.name], joint.limits)
        where = f"{robot.source}: joint '{joint.name}'"
        if own.position is None and joint.motion == "rotary":
            reach = given["position"] or _HALF_TURN
            own = replace(own, position=(-reach, reach))
            if given["position"] is None:
                endless.append(joint.name)
        missing = [name for name in _KEYS if getattr(own, name) is None and given[name] is None]
        if missing:
            example = {"position": "[-0.5, 0.5]", "speed": "1.0", "effort": "50.0"}[missing[0]]
            raise InputError(
                f"{where}: neither its file nor the URDF states a limit of {missing[0]}; write "
                f"limits = {{ {missing[0]} = {example} }} in its table"
            )
        low, high = own.position or (-math.inf, math.inf)
        home = 0.5 * (low + high) if math.isfinite(high - low) else 0.0
        narrower = [math.inf if given[name] is None else given[name] for name in _KEYS]
        rows.append(
            (
                home,
                MARGIN * min(0.5 * (high - low), narrower[0] or math.inf),
                MARGIN * min(_or_none(own.speed), narrower[1] or math.inf),
                MARGIN * min(_or_none(own.effort), narrower[2] or math.inf),
            )
        )
    notes = [
        f"{robot.source} states no limits of position of {commas(endless)}: moved by half a turn "
        "either way at most; narrow limits.position where cables would wind up"
    ]
    return ArmLimits(*np.array(rows).T), notes if endless else []


def _of_joint(urdf: JointLimits, stated: Mapping[str, Any]) -> JointLimits:
    position = stated.get("position")
    return JointLimits(
        urdf.position if position is None else (position[0], position[1]),
        stated.get("speed", urdf.speed),
        stated.get("effort", urdf.effort),
    )


def _or_none(value: float | None) -> float:
    return math.inf if value is None else value


def _above_zero(value: object, where: str) -> float:
    found = number(value, where)
    if not (math.isfinite(found) and found > 0.0):
        raise InputError(f"{where} = {found:g} is out of bounds: give a finite number above 0")
    return found
