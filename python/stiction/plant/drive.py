"""The drive of a plant file: what makes an effort of the input."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from .._support.given import number
from .._support.keys import check_keys, choice
from .._support.wording import commas
from ..errors import InputError
from .parameter import Parameter

__all__ = [
    "GOALS",
    "SERVO_NUMBERS",
    "assumed_gain",
    "check_servo",
    "gain_name",
    "read_drive",
    "servo_numbers",
    "unscaled_unit",
]

INPUTS: Final = ("current_a", "voltage_v", "torque_nm", "force_n")
"""What a drive may be commanded in."""
_UNITS: Final = {
    **dict.fromkeys(("a", "amp", "ampere", "iq", "i"), "current_a"),
    **dict.fromkeys(("v", "volt", "u"), "voltage_v"),
    **dict.fromkeys(("nm", "n·m", "n*m", "effort"), "torque_nm"),
    **dict.fromkeys(("n", "newton"), "force_n"),
}
"""What others call them."""
_NO_EFFORT: Final = {"current_a": "A", "voltage_v": "V"}
"""Inputs that are no effort, and their units."""
GOALS: Final = {"rotary": "goal_rad", "linear": "goal_m"}
"""What a servo is commanded in."""
INPUT_KEYS: Final = ("input", "gain", "limit")
"""Keys of a drive that is not a servo beside its kind."""
KINDS: Final = ("direct", "prescribed_motion", "servo")
LEAST_GAIN: Final = 1e-12
"""Effort per unit of input; no unit of an input is that large."""
SERVO_NUMBERS: Final = {
    "proportional": "proportional",
    "integral": "integral",
    "derivative": "derivative",
    "duty_limit": "duty_limit",
    "supply_v": "supply",
    "resistance_ohm": "resistance",
    "current_limit_a": "current_limit",
}
"""Keys of a servo beside its torque constant, and what ``Motor`` calls them."""

_NEEDED: Final = ("proportional", "supply_v", "resistance_ohm", "torque_constant")
_ABOVE_ZERO: Final = {
    "supply_v": (1e12, "a number of V above 0, up to 1e12"),
    "resistance_ohm": (1e12, "a number of Ω above 0, up to 1e12"),
    "current_limit_a": (float("inf"), "a number of A above 0"),
    "duty_limit": (1.0, "a number above 0, up to 1"),
}
"""What a servo cannot move without: the greatest value that is allowed, and that in words."""
_OTHER_MOTION: Final = {"rotary": "force_n", "linear": "torque_nm"}


def gain_name(drive: Mapping[str, Any]) -> str:
    """What a drive calls its effort per unit: of input, or of a servo's current."""
    return "torque_constant" if drive.get("kind") == "servo" else "gain"


def unscaled_unit(drive: Mapping[str, Any], input_unit: str = "") -> str:
    """Unit of an input that is no effort and whose gain is stated nowhere; "" for any other.

    Parameters
    ----------
    drive : Mapping
    input_unit : str
        Of the recorded input, which counts where the drive names none.
    """
    if gain_name(drive) in drive or drive.get("kind", "direct") != "direct":
        return ""
    unit = _NO_EFFORT.get(drive.get("input", ""), input_unit)
    return unit if unit in _NO_EFFORT.values() else ""


def assumed_gain(drive: Mapping[str, Any], input_unit: str, effort_unit: str) -> str:
    """That the gain of an input which is no effort is stated nowhere, "" where nothing is assumed.

    Parameters
    ----------
    drive : Mapping
    input_unit : str
        Of the recorded input, "" where nothing tells.
    effort_unit : str
        What its effort would be measured in.
    """
    unit = unscaled_unit(drive, input_unit)
    if not unit:
        return ""
    return (
        f"[drive] gain is not stated: every effort, friction and inertia is in {unit} and not in "
        f"{effort_unit}, until you state the {effort_unit}/{unit}"
    )


def servo_numbers(drive: Mapping[str, Any]) -> dict[str, float] | None:
    """The numbers of a servo as ``Motor`` takes them, None where the drive is none."""
    if drive.get("kind") != "servo":
        return None
    return {SERVO_NUMBERS[key]: float(drive[key]) for key in SERVO_NUMBERS if key in drive}


def check_servo(drive: Mapping[str, Any], where: str) -> None:
    """Refuse the numbers of a servo that can move nothing.

    What moves nothing leaves nothing, and would seem to fit perfectly.

    Raises
    ------
    InputError
        A gain below 0; neither a proportional nor an integral gain; a supply, resistance or limit
        that is not above 0 or that no servo has.
    """
    for name in ("proportional", "integral", "derivative"):
        if drive.get(name, 0.0) < 0.0:
            raise InputError(
                f"{where} {name} = {drive[name]:g} drives away from the goal: allowed is 0 or "
                "more; change it, or the sign of goal and position"
            )
    if drive["proportional"] == 0.0 == drive.get("integral", 0.0):
        raise InputError(
            f"{where} proportional = 0 without an integral moves nothing; give the duty per "
            "distance from the goal"
        )
    for name, (most, wanted) in _ABOVE_ZERO.items():
        if name in drive and not 0.0 < drive[name] <= most:
            raise InputError(
                f"{where} {name} = {drive[name]:g} is out of bounds: allowed is {wanted}; change it"
            )


def read_drive(given: Mapping[str, Any], motion: str, where: str) -> dict[str, Any]:
    """Check the table ``[drive]``; a gain that is to be fitted comes back as a ``Parameter``.

    Raises
    ------
    InputError
        Unknown or missing keys, wrong types, values out of bounds.
    """
    kind = choice(given["kind"], KINDS, f"{where} kind") if "kind" in given else None
    drive: dict[str, Any] = {} if kind is None else {"kind": kind}
    if kind == "servo":
        check_keys(given, ("kind", "torque_constant", *SERVO_NUMBERS), f"{where} of kind 'servo'")
        for name in _NEEDED:
            if name not in given:
                raise InputError(
                    f"{where} {name} is missing; a servo needs {commas(_NEEDED)}: state it"
                )
        drive["input"] = GOALS[motion]
        drive |= {
            key: number(given[key], f"{where} {key}") for key in SERVO_NUMBERS if key in given
        }
        check_servo(drive, where)
    else:
        check_keys(given, ("kind", *INPUT_KEYS), where)
        useless = [name for name in INPUT_KEYS if name in given]
        if kind == "prescribed_motion" and useless:
            raise InputError(
                f"{where} {commas(useless)} goes with an input, and a machine whose motion is "
                "prescribed has none; leave it out"
            )
        if "input" in given:
            allowed = [name for name in INPUTS if name != _OTHER_MOTION[motion]]
            drive["input"] = choice(
                given["input"], allowed, f"{where} input of a {motion} plant", _UNITS
            )
        if "limit" in given:
            drive["limit"] = number(given["limit"], f"{where} limit")
            if drive["limit"] <= 0.0:
                raise InputError(f"{where} limit = {drive['limit']} is not above 0")
    name = gain_name(drive)
    if name in given:
        drive[name] = _gain(given[name], f"{where} {name}")
    return drive


def _gain(given: Any, where: str) -> float | Parameter:
    """A gain: exact where it is a plain number, fitted where it is a table that does not fix it."""
    parameter = Parameter.read(given, where)
    gain = parameter.value
    if gain == 0.0:
        raise InputError(f"{where} = 0 moves nothing; give the effort per unit of input")
    if not LEAST_GAIN <= abs(gain) <= 1.0 / LEAST_GAIN:
        raise InputError(
            f"{where} = {gain} is out of bounds: allowed are magnitudes from {LEAST_GAIN:g} "
            f"to {1.0 / LEAST_GAIN:g}"
        )
    fitted = isinstance(given, dict) and not parameter.fixed
    return parameter if fitted else gain
