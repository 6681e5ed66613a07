"""The text of the files of a draft: every guess with its reason."""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Mapping, Sequence
from itertools import takewhile
from pathlib import Path
from textwrap import wrap

from .._support.units import SI_UNIT, find_unit
from .._support.wording import commas
from ..errors import InputError
from ..recording.columns import CANONICAL
from ..recording.guess import ColumnGuess, Guess

__all__ = [
    "GAIN_UNIT",
    "column_value",
    "comment",
    "kinds_of",
    "plant_text",
    "printable",
    "session_text",
    "toml_string",
]

_WIDTH = 98
_MOST_STATED = 12
GAIN_UNIT = {"current_a": "A", "voltage_v": "V"}
"""Inputs that are no effort: what their gain is per."""
_EXAMPLES = {
    "time": 'time = { name = "…", unit = "s" }',
    "position": 'position = { name = "…", unit = "rad" }',
    "input": 'input = { name = "…", unit = "A" }',
}
_ENDS = re.compile(r"[^A-Za-z]+")


def plant_text(found: Guess, *, law: str = "coulomb", gain: float | None = None) -> str:
    """A plant.toml for what was guessed, with a law and a gain that are stated."""
    effort, body, rate = ("N·m", "kg·m²", "rad") if found.motion == "rotary" else ("N", "kg", "m")
    measured = _measured_unit(found, effort)
    start = f"{measured}; " if measured else ""
    damping = f"{measured}·s/{rate}" if measured else f"s/{rate}"
    other = "linear" if found.motion == "rotary" else "rotary"
    lines = [
        *comment(
            "A plant, drafted by stiction init. Every line is a guess: read it, correct it, and "
            "state what you know of the machine. What is left out starts from the data."
        ),
        "",
        "[motion]",
        *comment(f"{found.motion}: {found.motion_reason}. The other kind is {other}."),
        f'kind = "{found.motion}"',
        "",
        "[drive]",
        *_drive(found, effort, gain),
        "",
        "[body]",
        *_body(found, body, effort),
        "",
        "[friction]",
        *_law(law, damping, start),
        "",
        *_sensor(found),
    ]
    return "\n".join(lines).rstrip("\n") + "\n"


def _law(law: str, damping: str, start: str) -> list[str]:
    if law != "coulomb":
        told = f"As stated. `stiction laws {law}` lists its parameters; naming it is enough."
        return [*comment(told), f'law = "{law}"']
    return [
        *comment(
            f"Dry friction with true stick, and viscous friction in {damping}: the "
            "plainest law. `stiction laws` lists the others, `stiction laws coulomb` the "
            "parameters of this one. Naming the law is enough to fit it."
        ),
        'law = "coulomb"',
        f"# coulomb = 0.1  # {start}a number here is where the fit starts",
    ]


def _drive(found: Guess, effort: str, gain: float | None) -> list[str]:
    if found.prescribed:
        return [
            *comment(
                f"{found.drive_reason}: the machine is moved, and its effort measured. If that "
                f"effort drives the machine instead, write input = "
                f'"{"torque_nm" if effort == "N·m" else "force_n"}" and gain = 1.0 here, and '
                "input in place of effort in session.toml."
            ),
            'kind = "prescribed_motion"',
        ]
    own = "torque_nm" if effort == "N·m" else "force_n"
    if found.drive is None:
        return [
            *comment(
                f"{found.drive_reason}. Take away the # when session.toml names one: current_a, "
                f'voltage_v or {own}; or write kind = "prescribed_motion" where the machine is '
                "moved and its effort measured." + _servo(found)
            ),
            '# input = "current_a"',
            f"# gain = 1.0  # {effort} per unit of the input",
        ]
    lines = [
        *comment(f"{found.drive_reason}. The others are current_a, voltage_v and {own}."),
        f'input = "{found.drive}"',
    ]
    unit = GAIN_UNIT.get(found.drive)
    if gain is not None:
        return [*lines, *comment(f"{effort}/{unit or effort}, as stated."), f"gain = {gain!r}"]
    if unit is None:
        return [*lines, *comment(f"The input is in {effort} already."), "gain = 1.0"]
    return [
        *lines,
        *comment(
            f"TO DO: state the gain in {effort}/{unit} (motor constant, transmission). Inertia and "
            f"friction scale with it: without it they come out in {unit} instead of {effort}."
            + _numbers_beside(found)
        ),
        "# gain = 1.0",
    ]


def _servo(found: Guess) -> str:
    """What a servo that is given positions needs, where a goal may be among the columns."""
    if all(one.role != "reference" for one in found.columns):
        return ""
    return (
        ' A servo that is given positions is kind = "servo", with proportional (duty per '
        "distance from the goal), supply_v, resistance_ohm and torque_constant; its input is "
        "the goal."
    )


def _numbers_beside(found: Guess) -> str:
    """The file may hold the gain itself, as a single number beside the vectors."""
    scalars = [one.column for one in found.columns if one.reason == "is a scalar"]
    if not scalars:
        return ""
    return f" The file also holds the single numbers {commas(scalars)}: one may be the gain."


def _body(found: Guess, unit: str, effort: str) -> list[str]:
    if found.prescribed:
        return [
            *comment(
                f"What of the mass moves between the effort sensor and the friction, in {unit}."
            ),
            "inertia = 0.0",
        ]
    lines = comment(
        f"In {unit}. Left out, it is fitted from the data. Where you know it, take away the #: "
        "fixed = true keeps it."
    )
    lines.append("# inertia = { value = 0.01, fixed = true }")
    if found.motion == "rotary":
        lines += comment(
            f"A pendulum or an arm under gravity: greatest torque in {effort}, and the angle at "
            "which it hangs."
        )
        return [*lines, "# gravity_amplitude = 0.1", "# gravity_zero_rad = 0.0"]
    lines += comment(f"An axis that is not level: the force against positive motion, in {effort}.")
    return [*lines, "# weight_n = 0.0"]


def _sensor(found: Guess) -> list[str]:
    key = "counts_per_rev" if found.motion == "rotary" else "count_m"
    if found.counts_per_rev:
        told = (
            "The counter runs over after as many."
            if found.counts_needed
            else "Steps that the readings of the position come in; it is not fitted."
        )
        return ["[sensor]", *comment(told), f"counts_per_rev = {found.counts_per_rev}"]
    if not found.counts_needed:
        return []
    size = "4096" if found.motion == "rotary" else "1e-6"
    return [
        "[sensor]",
        *comment(
            "TO DO: the position is in counts, so state "
            + ("how many make a turn." if found.motion == "rotary" else "the size of one in m.")
        ),
        f"# {key} = {size}",
    ]


def session_text(
    found: Guess,
    paths: Sequence[Sequence[Path]],
    left_out: Sequence[tuple[Path, str]],
    where: Path,
    joints: Sequence[str] = (),
    headers: Sequence[Mapping[str, float | str]] = (),
) -> str:
    """A session.toml for what was guessed, to stand in the folder ``where``.

    Each recording has a file, or one for each signal; of files of several ``joints`` the first of
    them is that of the columns. ``headers`` is what each of the files states once.

    Raises
    ------
    InputError
        A path that cannot be written in a TOML file.
    """
    lines = [
        *comment(
            "Recordings of one machine, drafted by stiction init. Every line is a guess with its "
            "reason: read it, correct it. Paths are relative to this file."
        ),
        "",
        'plant = "plant.toml"',
        "",
        *comment(_joint(joints)),
        *comment(
            "Columns by role. SI value = scale·value + offset, after conversion from the unit; "
            "scale = -1 flips a sensor."
        ),
        "[columns]",
    ]
    by_role = found.by_role
    for role in ("time", "input", "effort", "position"):
        if role in by_role:
            lines += _column(by_role[role])
        elif role in found.missing:
            lines += _missing(role, found)
    for role, one in by_role.items():
        if role not in ("time", "input", "effort", "position"):
            lines += _column(one)
    unused = [one for one in found.columns if one.role is None]
    if unused:
        lines += ["", "# Not used:"]
        for one in unused:
            lines += comment(f"{toml_string(one.column)}: {one.reason}", "#   ")
    lines += ["", *_recordings(paths, left_out, where, headers)]
    return "\n".join(lines) + "\n"


def _joint(joints: Sequence[str]) -> str:
    if not joints:
        return ""
    return (
        f"Joint {joints[0]} alone: the recordings hold {commas(joints[1:])} as well, which init "
        "--joint takes. What the others do to it (inertia, gravity) is not in this plant."
    )


def _column(one: ColumnGuess) -> list[str]:
    lines = ["", *comment(f"{printable(one.reason)}.")]
    if one.alternatives:
        lines += comment(f"Instead: {printable(', '.join(one.alternatives))}.")
    return [*lines, f"{one.role} = {column_value(one)}"]


def column_value(one: ColumnGuess) -> str:
    """A column as it stands in TOML."""
    name = toml_string(one.column)
    if one.column in CANONICAL and one.scale == 1.0:
        return name
    scale = "" if one.scale == 1.0 else f", scale = {one.scale!r}"
    return f"{{ name = {name}, unit = {toml_string(one.unit or '1')}{scale} }}"


def _measured_unit(found: Guess, effort: str) -> str:
    """Unit of the measured effort: of a sliding test that records a ratio it may be a stress."""
    units = {one.role: one.unit for one in found.columns}
    if "friction_coefficient" not in units:
        return effort
    if "normal_force" not in units:
        return ""
    return SI_UNIT[find_unit(units["normal_force"] or "N", "normal_force").quantity]


def _missing(role: str, found: Guess) -> list[str]:
    lines = ["", *comment(f"TO DO: {printable(found.missing[role])}.")]
    candidates = [one for one in found.columns if one.candidate == role]
    for one in candidates:
        lines += comment(f"{printable(one.reason)}:")
        lines.append(f"# {role} = {column_value(one)}")
    return lines if candidates else [*lines, f"# {_EXAMPLES[role]}"]


def _recordings(
    paths: Sequence[Sequence[Path]],
    left_out: Sequence[tuple[Path, str]],
    where: Path,
    headers: Sequence[Mapping[str, float | str]],
) -> list[str]:
    kinds = kinds_of([files[0] for files in paths])
    lines = comment(
        "Recordings of one machine in one state: with another load or another arm it is another "
        'session. A recording may have role = "train" (it is fitted), "select" (it decides '
        'which effects, and how many) or "test" (it is opened once, after the last decision); '
        "without roles they are assigned in turn."
        + (" The kinds are from the names of the files." if any(kinds) else "")
    )
    for files, kind, header in zip(paths, kinds, headers or [{}] * len(paths), strict=True):
        named = [toml_string(_relative(path, where)) for path in files]
        told = named[0] if len(named) == 1 else f"[{', '.join(named)}]"
        lines += ["", "[[recordings]]", f"file = {told}"]
        lines += [f"kind = {toml_string(kind)}"] if kind else []
        lines += _stated(header)
    for path, why in left_out:
        told = why.removeprefix(f"{path}: ")
        lines += ["", *comment(f"Left out: {printable(told)}")]
        lines += ["# [[recordings]]", f"# file = {toml_string(_relative(path, where))}"]
    return lines


def _stated(header: Mapping[str, float | str]) -> list[str]:
    """What a file states of its recording: a payload as settings, all else as a comment."""
    mass, length = header.get("mass"), header.get("length")
    lines = []
    rest = dict(header)
    if (
        isinstance(mass, float)
        and isinstance(length, float)
        and 0.0 <= mass < math.inf
        and 0.0 < length < math.inf
    ):
        lines = [f"payload_kg = {mass!r}", f"payload_m = {length!r}"]
        del rest["mass"], rest["length"]
    if rest:
        told = ", ".join(f"{name} {value}" for name, value in list(rest.items())[:_MOST_STATED])
        lines += comment(f"The file says {printable(told)}.")
    return lines


def kinds_of(paths: Sequence[Path]) -> list[str]:
    """Kinds of recordings from the words of their file names, "" where they tell none.

    Digits (dates, numbers) and words that all names begin or end with say nothing.  Where no kind
    occurs twice they say nothing either: each recording would be one of its kind.
    """
    names = [[word for word in _ENDS.split(path.stem) if word] for path in paths]
    start = _shared(names)
    names = [words[start:] for words in names]
    end = _shared([words[::-1] for words in names])
    kinds = ["_".join(words[: len(words) - end]) for words in names]
    distinct = set(kinds)
    return kinds if 1 < len(distinct) < len(kinds) else [""] * len(kinds)


def _shared(names: Sequence[Sequence[str]]) -> int:
    """How many words all names begin with."""
    columns = zip(*names, strict=False)
    return sum(1 for _ in takewhile(lambda words: len(set(words)) == 1, columns))


def _relative(path: Path, where: Path) -> str:
    full, start = path.resolve(), where.resolve()
    try:
        return Path(os.path.relpath(full, start)).as_posix()
    except ValueError:  # another drive
        return full.as_posix()


def toml_string(text: str) -> str:
    """A TOML string. JSON's escapes are TOML's, but for one control character."""
    quoted = json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007F")
    try:
        quoted.encode()
    except UnicodeEncodeError:
        raise InputError(
            f"{text!r}: this name is no text in UTF-8, so no TOML file can hold it; rename it"
        ) from None
    return quoted


def printable(text: str) -> str:
    """Text that may stand in a comment: no line ends, no control characters."""
    one_line = " ".join(text.split())
    return "".join(letter if letter.isprintable() else "?" for letter in one_line)


def comment(text: str, start: str = "# ") -> list[str]:
    """A comment of as many lines as it needs."""
    lines = wrap(printable(text), _WIDTH - len(start), break_long_words=False)
    return [(start if k == 0 else start.replace("   ", "     ")) + x for k, x in enumerate(lines)]
