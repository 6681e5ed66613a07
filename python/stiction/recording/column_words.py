"""What the name of a column says: words for quantities, and units in brackets or at the end."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

from .._support.units import UNITS, Motion, bracketed_unit, find_unit
from ..errors import InputError
from .columns import CANONICAL

Kind = str
"""A role; ``"drive"`` for what may be an input or a measured effort; ``"flag"`` and ``"index"`` for
what is neither motion nor effort."""


@dataclass(frozen=True)
class Word:
    """What one word of a name means.

    Attributes
    ----------
    kinds : tuple of str
        Possible meanings, the likeliest first.
    quantity : str, optional
        Of an input: ``"current"``.
    motion : {"rotary", "linear"}, optional
        What the word is used for.
    """

    kinds: tuple[Kind, ...]
    quantity: str | None = None
    motion: Motion | None = None


@dataclass(frozen=True)
class Written:
    """A unit that a name gives: SI value = ``scale`` · (the cell, converted from ``unit``)."""

    unit: str
    scale: float
    how: str

    @property
    def quantity(self) -> str:
        """What it measures."""
        return UNITS[self.unit].quantity


@dataclass(frozen=True)
class Said:
    """What a name says.

    Attributes
    ----------
    kinds : tuple of str
        Possible meanings, the likeliest first; empty where no word is known.
    quantity, motion
        As in `Word`.
    wanted : bool
        A value that is asked for, not measured (``goal``, ``ref``, ``cmd``).
    measured : bool
        A value that a sensor gave (``meas``, ``cell``).
    word : str
        The word that said it.
    strength : int
        3 for a canonical name, 2 where the word is the whole name, 1 where it is a part.
    unit : Written, optional
    strange_unit : str
        What stands in brackets and is no unit.
    """

    kinds: tuple[Kind, ...] = ()
    quantity: str | None = None
    motion: Motion | None = None
    wanted: bool = False
    measured: bool = False
    word: str = ""
    strength: int = 0
    unit: Written | None = None
    strange_unit: str = ""


def _words(words: str, *kinds: Kind, **more: str) -> dict[str, Word]:
    return {word: Word(kinds, **more) for word in words.split()}  # type: ignore[arg-type]


WORDS: Final[dict[str, Word]] = {
    **_words("time timestamp tout zeit stamp elapsed clock seconds sec", "time"),
    **_words("q qm qa theta th phi psi angle angular ang", "position", motion="rotary"),
    **_words("winkel turns", "position", motion="rotary"),
    **_words("rot rotation rotary joint shaft", motion="rotary"),
    **_words("x y z xm dist distance displ displacement disp stroke", "position", motion="linear"),
    **_words("travel length len weg", "position", motion="linear"),
    **_words("linear carriage slide", motion="linear"),
    **_words("pos position lage enc encoder ticks", "position"),
    **_words("vel velocity speed rate geschwindigkeit", "velocity"),
    **_words("omega w qdot dq dtheta rpm drehzahl gyro", "velocity", motion="rotary"),
    **_words("xdot dx", "velocity", motion="linear"),
    # Names that two habits share; the data decide.
    "t": Word(("time", "temperature", "drive"), "torque"),
    "v": Word(("velocity", "drive"), "voltage"),
    "qd": Word(("velocity", "reference"), motion="rotary"),
    "xd": Word(("velocity", "reference"), motion="linear"),
    **_words("qg qr qref qdes qsp thetad", "reference", motion="rotary"),
    **_words("xr xref xdes xsp", "reference", motion="linear"),
    **_words("i iq cur curr current amps ampere amperage strom", "drive", quantity="current"),
    **_words("voltage volt volts vir uq vm spannung", "drive", quantity="voltage"),
    **_words("torque tau trq tq moment drehmoment gamma", "drive", quantity="torque"),
    **_words("force forc frc f kraft fx fz loadcell", "drive", quantity="force"),
    **_words("u input control effort pwm duty actuation output", "drive"),
    **_words("load ext external disturbance", "load"),
    **_words("temp temperature temperatur celsius", "temperature"),
    **_words("normal preload fn", "normal_force"),
    **_words("friction mu cof", "friction_coefficient"),
    **_words("enable enabled", "enabled"),
    **_words("flag mode status valid error err acc acceleration accel", "flag"),
    **_words("index row sample seq", "index"),
}
"""Words of column names, in small letters."""


def _set(words: str) -> frozenset[str]:
    return frozenset(words.split())


WANTED: Final = _set(
    "ref reference goal target desired des set setpoint sp cmd command commanded demand demanded "
    "soll wanted nominal traj trajectory planned"
)
MEASURED: Final = _set("meas measured sensor cell loadcell")
REPORTED: Final = _set("actual act feedback fb ist istwert")
"""A drive that reports what it gives has no sensor for it at the machine."""
_MODIFIERS: Final = WANTED | MEASURED | REPORTED

# Where a name holds several words the first of these kinds wins: the load_position is a position,
# the load_torque a load, the current_position no current. Single letters count after words, the
# first of them before the others: i_q is a current.
_ORDER: Final = (
    *(
        "enabled",
        "flag",
        "temperature",
        "normal_force",
        "velocity",
        "reference",
        "position",
        "load",
        "drive",
    ),
    *("friction_coefficient", "time", "index"),
)


def _ways(words: str, unit: str, factor: float = 1.0) -> dict[str, tuple[str, float]]:
    return dict.fromkeys(words.split(), (unit, factor))


_ALIASES: Final[dict[str, tuple[str, float]]] = {
    **_ways("sec secs second seconds", "s"),
    **_ways("msec millis millisecond milliseconds", "ms"),
    **_ways("usec micros microsecond microseconds", "us"),
    **_ways("ns nsec nanoseconds", "us", 1e-3),
    **_ways("radian radians", "rad"),
    **_ways("° degree degrees", "deg"),
    **_ways("revs turn turns revolution revolutions", "rev"),
    **_ways("counts cts tick ticks inc increments lsb pulses", "count"),
    **_ways("meter meters metre metres", "m"),
    **_ways("millimeter millimeters millimetres", "mm"),
    **_ways("micron microns micrometer micrometers", "um"),
    **_ways("cm centimeter centimeters", "m", 1e-2),
    **_ways("inch inches", "m", 0.0254),
    **_ways("amp amps ampere amperes", "A"),
    **_ways("milliamp milliamps", "mA"),
    **_ways("volt volts", "V"),
    **_ways("n.m n*m n-m newtonmeter newton-meter", "Nm"),
    "n m": ("Nm", 1.0),
    "ncm": ("Nm", 1e-2),
    **_ways("newton newtons", "N"),
    "lbf": ("N", 4.4482216152605),
    **_ways("rad/sec radps rad_per_s rad_per_sec", "rad/s"),
    **_ways("deg/sec °/s dps deg_per_s degps", "deg/s"),
    **_ways("rev/min r/min 1/min min^-1 U/min u/min", "rpm"),
    **_ways("rev/s rps", "rpm", 60.0),
    **_ways("m/sec mps m_per_s", "m/s"),
    "cm/s": ("m/s", 1e-2),
    **_ways("°c celsius", "degC"),
    "kelvin": ("K", 1.0),
    "kpa": ("Pa", 1e3),
    "gpa": ("MPa", 1e3),
    "-": ("1", 1.0),
}
"""Ways in which others write units: the unit here, and the factor on top."""

_FOLDED: Final = {unit.replace("·", "").casefold(): unit for unit in UNITS if unit != "1"}
_ENDINGS: Final[dict[str, tuple[str, float]]] = {
    **{name.replace("/", "_"): (unit, 1.0) for name, unit in _FOLDED.items()},
    **{name.replace("/", "_"): found for name, found in _ALIASES.items() if name.isascii()},
    "c": ("degC", 1.0),
}
_PARTS: Final = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")
_SEGMENTS: Final = re.compile(r"[^\W\d_]+")
_BRACKETS: Final = re.compile(r"[(\[][^()\[\]]*[)\]]\s*$")
_SHORTEST: Final = 3
"""Letters of a word that is looked for inside a longer one."""


def what_it_says(name: str) -> Said:
    """What a column's name says about its role and unit.

    Parameters
    ----------
    name : str
        As it stands in the file; of dotted names the last part counts most.
    """
    if name in CANONICAL:
        role, own = CANONICAL[name]
        written = Written(own, 1.0, "the name is a canonical one")
        kind = "drive" if role == "input" else role
        return Said((kind,), written.quantity, word=name, strength=3, unit=written)
    unit, strange = _in_brackets(name)
    bare = _BRACKETS.sub("", name).strip() if unit or strange else name
    before, _, last = bare.rpartition(".")
    text = last if _PARTS.search(last) else bare
    parts = [part.casefold() for part in _PARTS.findall(text)]
    words, modifiers = _meanings(parts)
    field = before.rpartition(".")[2].casefold()
    if not words and field in WORDS:
        # position.elbow: the last part names a joint.
        words, parts = [field], [field]
    meant = sorted(
        (word for word in words if WORDS[word].kinds),
        key=lambda word: len(word) == 1 or _ORDER.index(WORDS[word].kinds[0]) - len(_ORDER),
    )
    chosen = meant[0] if meant else ""
    kinds = WORDS[chosen].kinds if chosen else ()
    same = [word for word in words if WORDS[word].kinds == kinds]
    quantity = next((WORDS[w].quantity for w in same if WORDS[w].quantity), None)
    motion = next((WORDS[w].motion for w in [*same, *words] if WORDS[w].motion), None)
    wanted, measured = bool(WANTED & modifiers), bool(MEASURED & modifiers)
    if kinds == ("position",) and wanted:
        kinds = ("reference",)
    if kinds == ("load",) and "loadcell" in "".join(parts):
        kinds, quantity, measured = ("drive",), "force", True
    unit = unit or _at_the_end(text, kinds, motion)
    strength = 0 if not chosen else 2 if parts == [chosen] else 1
    return Said(kinds, quantity, motion, wanted, measured, chosen, strength, unit, strange)


def _meanings(parts: list[str]) -> tuple[list[str], set[str]]:
    """Known words among the parts of a name, and the words that say wanted or measured."""
    words: list[str] = []
    modifiers: set[str] = set()
    for part in parts:
        found = [part] if part in WORDS or part in _MODIFIERS else _inside(part)
        words += [word for word in found if word in WORDS]
        modifiers |= _MODIFIERS & set(found)
    return words, modifiers


def _inside(part: str) -> list[str]:
    """Known words at the beginning and end of an unknown one: ``posref`` -> pos, ref."""
    known = [w for w in (*WORDS, *_MODIFIERS) if len(w) >= _SHORTEST]
    ends = [
        max((w for w in known if part.startswith(w)), key=len, default=""),
        max((w for w in known if part.endswith(w)), key=len, default=""),
    ]
    return [word for word in ends if word]


def _in_brackets(name: str) -> tuple[Written | None, str]:
    text = bracketed_unit(name)
    # Digits in brackets number a joint: q[0].
    if not text or text.isdigit():
        return None, ""
    how = f"the header says [{text}]"
    try:
        return Written(find_unit(text, name).name, 1.0, how), ""
    except InputError:
        found = _ALIASES.get(text.casefold()) or _ENDINGS.get(text.casefold())
        return (Written(found[0], found[1], how), "") if found else (None, text)


def _at_the_end(text: str, kinds: tuple[Kind, ...], motion: Motion | None) -> Written | None:
    """The unit that a name ends in, ``pos_deg``; single letters must suit what the name says."""
    segments = _SEGMENTS.findall(text.replace("µ", "u").replace("\N{GREEK SMALL LETTER MU}", "u"))
    humps = _PARTS.findall(segments[-1]) if segments else []
    # posDeg ends in deg; but the m of mA is no word of its own.
    tried = ["_".join(segments[-number:]) for number in (3, 2, 1) if len(segments) >= number]
    tried += [humps[-1]] if len(humps) > 1 and len(humps[-2]) > 1 else []
    for ending in tried:
        folded = ending.casefold()
        if folded not in _ENDINGS:
            continue
        unit, scale = _ENDINGS[folded]
        # A letter that is the whole of a name is its word: v, m.
        if len(ending) == 1 and (len(segments) == 1 or not _suits(unit, kinds, motion)):
            continue
        return Written(unit, scale, f"its name ends in '{ending}'")
    return None


_LETTERS: Final[dict[str, tuple[Kind, ...]]] = {
    "time": ("time",),
    "length": ("position", "reference"),
    "current": ("drive",),
    "voltage": ("drive",),
    "force": ("drive", "load", "normal_force"),
    "temperature": ("temperature",),
}


def _suits(unit: str, kinds: tuple[Kind, ...], motion: Motion | None) -> bool:
    """Whether a single letter can be a unit here: m is metre in pos_m, measured in theta_m."""
    quantity = UNITS[unit].quantity
    allowed = _LETTERS.get(quantity, ())
    return any(kind in allowed for kind in kinds) and not (
        quantity == "length" and motion == "rotary"
    )
