"""Units that recordings come in, and their way to the SI values used inside.

Temperatures are kept in degrees Celsius (``temperature_c``), everything else in SI.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
import numpy.typing as npt

from ..errors import InputError
from .arrays import FloatArray
from .wording import commas, did_you_mean

Motion = Literal["rotary", "linear"]

_ZERO_CELSIUS_K = 273.15


@dataclass(frozen=True)
class Unit:
    """One unit: SI value = ``factor`` · value + ``offset``.

    ``factor`` is None for ``count``, whose size only the sensor knows.
    """

    name: str
    quantity: str
    factor: float | None
    offset: float = 0.0


_TABLE: Final = (
    Unit("s", "time", 1.0),
    Unit("ms", "time", 1e-3),
    Unit("µs", "time", 1e-6),
    Unit("us", "time", 1e-6),
    Unit("rad", "angle", 1.0),
    Unit("deg", "angle", math.pi / 180.0),
    Unit("rev", "angle", 2.0 * math.pi),
    Unit("count", "count", None),
    Unit("m", "length", 1.0),
    Unit("mm", "length", 1e-3),
    Unit("µm", "length", 1e-6),
    Unit("um", "length", 1e-6),
    Unit("A", "current", 1.0),
    Unit("mA", "current", 1e-3),
    Unit("V", "voltage", 1.0),
    Unit("mV", "voltage", 1e-3),
    Unit("Nm", "torque", 1.0),
    Unit("N·m", "torque", 1.0),
    Unit("mNm", "torque", 1e-3),
    Unit("N", "force", 1.0),
    Unit("kN", "force", 1e3),
    Unit("rad/s", "angular velocity", 1.0),
    Unit("deg/s", "angular velocity", math.pi / 180.0),
    Unit("rpm", "angular velocity", 2.0 * math.pi / 60.0),
    Unit("m/s", "velocity", 1.0),
    Unit("mm/s", "velocity", 1e-3),
    Unit("degC", "temperature", 1.0),
    Unit("K", "temperature", 1.0, -_ZERO_CELSIUS_K),
    Unit("MPa", "pressure", 1e6),
    Unit("Pa", "pressure", 1.0),
    Unit("1", "ratio", 1.0),
)

UNITS: Final[dict[str, Unit]] = {unit.name: unit for unit in _TABLE}
"""Every unit that may be written, by the way it is written."""

SI_UNIT: Final[dict[str, str]] = {
    "time": "s",
    "angle": "rad",
    "length": "m",
    "current": "A",
    "voltage": "V",
    "torque": "N·m",
    "force": "N",
    "angular velocity": "rad/s",
    "velocity": "m/s",
    "temperature": "degC",
    "pressure": "Pa",
    "ratio": "1",
}
"""The unit that values of a quantity have after conversion."""

MOTION_OF_QUANTITY: Final[dict[str, Motion]] = {
    "angle": "rotary",
    "angular velocity": "rotary",
    "torque": "rotary",
    "length": "linear",
    "velocity": "linear",
    "force": "linear",
}
"""The kind of motion that a quantity belongs to; what is not here fits both."""

# Unicode has two micro signs and two centred dots that look alike; both are typed.
_LOOK_ALIKES = str.maketrans(
    {
        "\N{GREEK SMALL LETTER MU}": "µ",
        "\N{DOT OPERATOR}": "·",
        "\N{MASCULINE ORDINAL INDICATOR}": "°",
    }
)
_SIGNS: Final = {
    **{"°": "deg", "°/s": "deg/s", "°C": "degC"},
    **dict.fromkeys(("N*m", "N.m", "N m", "N-m"), "N·m"),
    **dict.fromkeys(("mN·m", "mN*m", "mN.m", "mN m", "mN-m"), "mNm"),
    **dict.fromkeys(("U/min", "1/min", "r/min", "rev/min", "min⁻¹", "min^-1"), "rpm"),
}
"""Other ways in which instruments write a unit."""


_WORDS: Final = {
    "milliamp": "mA",
    "amp": "A",
    "millivolt": "mV",
    "volt": "V",
    "degrees c": "degC",
    "celsius": "degC",
    "degree": "deg",
    "radian": "rad",
    "turn": "rev",
    "revol": "rev",
    "newton m": "Nm",
    "newtonm": "Nm",
    "newton-m": "Nm",
    "newton": "N",
    "sec": "s",
    "millisec": "ms",
    "microsec": "us",
    "millim": "mm",
    "microm": "um",
    "met": "m",
    "tick": "count",
}
"""How people begin to write a unit in words; the longer of two comes first."""
_SHARES: Final = frozenset({"%", "‰", "percent", "permille", "% rated", "pct"})


def known_unit(name: str) -> Unit | None:
    """The unit written ``name``, None where there is none."""
    written = name.strip().translate(_LOOK_ALIKES)
    return UNITS.get(_SIGNS.get(written, written))


def find_unit(name: str, where: str) -> Unit:
    """The unit written ``name``; letter case matters (mN is not MN).

    Parameters
    ----------
    name : str
        The unit as written, for instance ``"deg/s"``.
    where : str
        Start of the error sentence: the file and the field the unit stands in.

    Raises
    ------
    InputError
        If there is no such unit.
    """
    unit = known_unit(name)
    if unit is None and name.strip().casefold() in _SHARES:
        raise InputError(
            f"{where}: '{name}' is a share of a rated value; write the unit of that value, and in "
            "session.toml as scale the value over 100 (over 1000 of ‰)"
        )
    if unit is None:
        raise InputError(
            f"{where}: the unit '{name}' is not known{_meant(name)}; "
            f"write one of {', '.join(UNITS)}"
        )
    return unit


def _meant(name: str) -> str:
    """Which unit somebody may have meant: by its word, else by its letters."""
    word = name.strip().casefold()
    for start, unit in _WORDS.items():
        if word.startswith(start):
            return f" (did you mean '{unit}'?)"
    return did_you_mean(name, UNITS)


def to_si(
    values: npt.ArrayLike, unit: Unit, *, count_size: float | None = None, where: str = "values"
) -> FloatArray:
    """Values in ``unit`` as SI values (degC for temperatures).

    Parameters
    ----------
    values : array_like, any shape
    unit : Unit
    count_size : float, optional
        Size of one count of the position sensor, in rad or m; needed for ``count`` alone.
    where : str
        Start of the error sentence.

    Returns
    -------
    ndarray of float64, shape of ``values``
        A new array.

    Raises
    ------
    InputError
        If the unit is ``count`` and no usable ``count_size`` is given.
    """
    # In place, for a column may be a good part of the memory at hand.
    converted = np.asarray(values, dtype=np.float64) * _factor(unit, count_size, where)
    converted += unit.offset
    return converted


def _factor(unit: Unit, count_size: float | None, where: str) -> float:
    if unit.factor is not None:
        return unit.factor
    if count_size is None:
        raise InputError(
            f"{where}: the unit is count, and the size of a count is not given; "
            "state counts_per_rev or count_m under [sensor] (in Python: count_size, in rad or m)"
        )
    if not (math.isfinite(count_size) and count_size > 0.0):
        raise InputError(
            f"{where}: the size of a count is {count_size!r}; "
            "give a finite number above 0, in rad or m per count"
        )
    return float(count_size)


# How a unit is written as the ending of a column name: rad/s -> _rad_s, N·m -> _nm.
_ENDINGS: Final[dict[str, Unit]] = {
    # Folding the case turns one micro sign into the other; the translation turns it back.
    "_" + unit.name.replace("/", "_").replace("·", "").casefold().translate(_LOOK_ALIKES): unit
    for unit in _TABLE
    if unit.name != "1"
} | {"_c": UNITS["degC"]}
_BY_LENGTH: Final = sorted(_ENDINGS, key=len, reverse=True)
_BRACKETED: Final = re.compile(r"[(\[]\s*([^()\[\]]*?)\s*[)\]]\s*$")


def bracketed_unit(name: str) -> str | None:
    """What a column name says in brackets at its end: ``"Time (s)"`` -> ``"s"``."""
    match = _BRACKETED.search(name)
    return match.group(1) if match else None


def bare_name(name: str) -> str:
    """A column name without the unit in brackets at its end: ``"Time (s)"`` -> ``"Time"``."""
    text = bracketed_unit(name)
    # Digits in brackets number a joint: q[0].
    return name if not text or text.isdigit() else _BRACKETED.sub("", name).strip() or name


def ending_unit(name: str, quantities: tuple[str, ...]) -> Unit | None:
    """The unit a column name ends in (``"pos_deg"``), if it measures one of ``quantities``."""
    folded = name.casefold().translate(_LOOK_ALIKES)
    for ending in _BY_LENGTH:
        if folded.endswith(ending):
            unit = _ENDINGS[ending]
            return unit if unit.quantity in quantities else None
    return None


def unit_names(quantities: tuple[str, ...]) -> str:
    """All units of some quantities, for the end of an error sentence."""
    return commas(unit.name for unit in _TABLE if unit.quantity in quantities)
