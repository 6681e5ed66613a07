"""Plant files: TOML in, checked tables out, and back."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from .._support.file_kinds import kind_of, kind_of_table
from .._support.given import number, regular
from .._support.keys import check_keys, choice
from .._support.units import Motion
from .._support.wording import commas, nearest_file
from ..errors import InputError
from .drive import INPUT_KEYS, read_drive
from .parameter import Parameter

__all__ = ["Parts", "check_payload", "parse", "read", "read_toml", "render"]

MOTIONS: Final = ("rotary", "linear")
_LARGEST: Final = 2**21
_DEEPEST: Final = 64
_WORD: Final = re.compile(r"[^\s.=,\[\]{}#]+")
# In decimal digits Python itself refuses it.
_LONG_NUMBER: Final = re.compile(r"\b0[xob][0-9a-fA-F_]{1000}")
_MOTIONS: Final = {
    **dict.fromkeys(("rotational", "rotation", "revolute", "continuous", "angular"), "rotary"),
    **dict.fromkeys(("translational", "translation", "prismatic", "sliding"), "linear"),
}
"""What others call the kind of a motion."""
_TABLES: Final = ("motion", "drive", "body", "friction", "effects", "sensor", "controller")
_BODY: Final = (
    "inertia",
    "gravity_amplitude",
    "gravity_zero_rad",
    "weight_n",
    "payload_kg",
    "payload_m",
)
_PAYLOAD: Final = ("payload_kg", "payload_m")
"""What hangs on the machine is weighed and measured, never fitted."""
_DERIVATIVES: Final = ("backward", "backward_of_two_sample_mean", "measured")
_CONTROLLERS: Final = {
    "pd": (("kp",), ("kd",)),
    "pid": (("kp", "ki"), ("kd",)),
    "position_velocity": (("kp", "kv"), ()),
}
"""Gains that each kind of controller needs, and those that it may have."""


@dataclass(frozen=True)
class Parts:
    """The checked tables of a plant file."""

    motion: Motion
    drive: dict[str, Any]
    body: dict[str, Parameter]
    law: str
    friction: dict[str, Parameter]
    options: dict[str, str]
    effects: list[tuple[str, dict[str, Parameter]]]
    sensor: dict[str, float]
    controller: dict[str, Any]


def read_toml(path: Path, *, least: str = "[friction] law") -> dict[str, Any]:
    """Read a TOML file.

    Parameters
    ----------
    path : Path
    least : str
        What an empty file lacks first of all, for the sentence.

    Raises
    ------
    InputError
        Missing, no file that can be read to its end, not UTF-8, not TOML, too large, empty.
    """
    try:
        if regular(path).st_size > _LARGEST:
            raise InputError(
                f"{path}: is larger than {_LARGEST // 2**20} MiB, and no plant or session file is; "
                "check the path"
            )
        text = path.read_bytes().decode("utf-8-sig")
        _check_plain(path, text)
        table = tomllib.loads(text)
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such file{_near(path)}; check the path") from None
    except IsADirectoryError:
        raise InputError(f"{path}: is a directory; give the file in it") from None
    except OSError as error:
        raise InputError(
            f"{path}: cannot be read ({error.strerror}); check the path and its rights"
        ) from None
    except UnicodeDecodeError:
        raise InputError(
            _another_kind(path) or f"{path}: is not text in UTF-8; save it as UTF-8"
        ) from None
    except tomllib.TOMLDecodeError as error:
        if told := _another_kind(path):
            raise InputError(told) from None
        raise InputError(f"{path}: is not TOML: {error}; {_mend(text, str(error))}") from None
    except InputError:
        raise
    except ValueError:
        raise InputError(_too_long(path)) from None
    except RecursionError:
        raise InputError(_too_deep(path)) from None
    if not table:
        raise InputError(f"{path}: is empty; state at least {least}")
    return table


def _another_kind(path: Path) -> str:
    """What a file is that is no TOML and known otherwise, a sentence; "" of others."""
    kind = kind_of(path)
    wanted = "a plant or session file (TOML) is wanted here; stiction init writes both"
    return f"{path}: is a {kind}, and {wanted}" if kind else ""


def _near(path: Path) -> str:
    """A file beside it that may be meant."""
    try:
        files = list(path.parent.iterdir())
    except OSError:
        return ""
    # An ending that was left out may be that of a recording too.
    names = [each.name for each in files if each.suffix == ".toml" or each.stem == path.name]
    near = nearest_file(path.name, names)
    return f" (did you mean '{near}'?)" if near else ""


_LINE: Final = re.compile(r"at line (\d+)")
_BARE_TEXT: Final = re.compile(r"^\s*\w+\s*=\s*[A-Za-z./]")
_COLON: Final = re.compile(r"^\s*[\"']?[\w.]+[\"']?\s*:")
_COMMA: Final = re.compile(r"=\s*-?\d+,\d+\s*(#.*)?$")


def _mend(text: str, error: str) -> str:
    """What to do about a line that is no TOML."""
    found, lines = _LINE.search(error), text.splitlines()
    line = lines[int(found[1]) - 1] if found and int(found[1]) <= len(lines) else ""
    if _COMMA.search(line):
        return f"write a decimal point in place of the comma in {line.strip()}"
    if _BARE_TEXT.search(line) and '"' not in line:
        return f"put the text behind = into quotes in {line.strip()}"
    if _COLON.search(line):
        return f"write name = value, without a colon, in {line.strip()}"
    if line.rstrip().endswith(";"):
        return f"leave out the semicolon in {line.strip()}"
    if "\\" in line:
        return f"write / in place of \\ in {line.strip()}"
    return "mend that line"


def _check_plain(path: Path, text: str) -> None:
    """Refuse what is TOML and takes hours to read, or cannot be shown."""
    if _LONG_NUMBER.search(text):
        raise InputError(_too_long(path))
    # The time for a dotted key goes with the square of its parts.
    words = _WORD.sub("k", text).replace(" ", "").replace("\t", "")
    if "k." * _DEEPEST in words:
        raise InputError(_too_deep(path))


def _too_long(path: Path) -> str:
    return f"{path}: cannot be read as TOML, for a number in it has thousands of digits; shorten it"


def _too_deep(path: Path) -> str:
    return f"{path}: is nested too deeply; write plain tables"


def read(path: Path) -> tuple[dict[str, Any], str]:
    """The raw tables of a plant file and the name to use in messages."""
    return read_toml(path), str(path)


def parse(table: Mapping[str, Any], source: str) -> Parts:
    """Check the tables of a plant file.

    Raises
    ------
    InputError
        Unknown or missing keys, wrong types, values out of bounds.
    """
    if kind_of_table(table) == "session file":
        raise InputError(
            f"{source}: is a session file, and a plant file is wanted; give the one that it names"
        )
    if "robot" in table:
        raise InputError(
            f"{source}: is the file of a robot, and a plant of one axis is wanted here; stiction "
            "export writes one of each joint"
        )
    _check_tables(table, source)
    motion_table = section(table, "motion", source)
    check_keys(motion_table, ("kind",), f"{source}: [motion]")
    stated = motion_table.get("kind", "rotary")
    kind = choice(stated, MOTIONS, f"{source}: [motion] kind", _MOTIONS)
    motion: Motion = "linear" if kind == "linear" else "rotary"
    law, friction, options = _friction(section(table, "friction", source), source)
    drive = read_drive(section(table, "drive", source), motion, f"{source}: [drive]")
    body = _body(section(table, "body", source), motion, source)
    _check_scale(drive, body, friction, source)
    controller = _controller(section(table, "controller", source), source)
    if drive.get("kind") == "servo" and controller:
        raise InputError(
            f"{source}: [controller] goes with an input that a controller commands, and a servo "
            "closes its loop itself; leave it out, and write its gains under [drive]"
        )
    return Parts(
        motion=motion,
        drive=drive,
        body=body,
        law=law,
        friction=friction,
        options=options,
        effects=_effects(table.get("effects", []), motion, drive.get("kind") == "servo", source),
        sensor=_sensor(section(table, "sensor", source), motion, source),
        controller=controller,
    )


def _check_tables(table: Mapping[str, Any], source: str) -> None:
    """Refuse what is no table of a plant file; of a key outside its table say where it belongs."""
    for key in table:
        home = "" if key in _TABLES else _home(key)
        if home:
            raise InputError(
                f"{source}: '{key}' stands outside a table; write it under [{home}] (in Python "
                f'"{home}": {{"{key}": ...}})'
            )
    check_keys(table, _TABLES, source)


def _home(key: str) -> str:
    from ..catalogue import laws

    if key in _BODY:
        return "body"
    if key in INPUT_KEYS:
        return "drive"
    if key in ("counts_per_rev", "count_m"):
        return "sensor"
    of_a_law = any(key == each.name for law in laws() for each in law.parameters)
    return "friction" if key == "law" or of_a_law else ""


def section(table: Mapping[str, Any], name: str, source: str) -> Mapping[str, Any]:
    """The table ``[name]``, empty where it is not there."""
    given = table.get(name, {})
    if not isinstance(given, Mapping):
        raise InputError(f"{source}: {name} = {given!r} is not a table; write it as [{name}]")
    return given


def _body(given: Mapping[str, Any], motion: str, source: str) -> dict[str, Parameter]:
    where = f"{source}: [body]"
    for key in {"mass", "m", "J", "I"} & set(given):
        raise InputError(
            f"{where}: '{key}' is unknown; it is called inertia here, kg·m² of a rotary machine "
            "and kg of a linear one"
        )
    check_keys(given, _BODY, where)
    body = {name: Parameter.read(value, f"{where} {name}") for name, value in given.items()}
    if "inertia" in body and not 0.0 <= body["inertia"].value < math.inf:
        unit = "kg·m²" if motion == "rotary" else "kg"
        raise InputError(
            f"{where} inertia = {body['inertia'].value} is out of bounds: allowed is a finite "
            f"number from 0 in {unit}"
        )
    for name in _PAYLOAD:
        if name in body:
            _check_weighed(given[name], f"{where} {name}")
            body[name] = Parameter(body[name].value, fixed=True)
    check_payload(body, motion, where)
    if "payload_m" in body and motion == "linear":
        raise InputError(f"{where} payload_m is for rotary plants; a linear one carries payload_kg")
    if "weight_n" in body and motion == "rotary":
        raise InputError(
            f"{where} weight_n is for linear plants; use gravity_amplitude for a rotary one"
        )
    for name in ("gravity_amplitude", "gravity_zero_rad"):
        if name in body and motion == "linear":
            raise InputError(f"{where} {name} is for rotary plants; use weight_n for a linear one")
    return body


def _check_weighed(given: Any, where: str) -> None:
    """Refuse what a payload, which no fit changes, would be fitted by."""
    stated = given if isinstance(given, Mapping) else {}
    useless = [name for name in ("min", "max") if name in stated]
    if stated.get("fixed") is False:
        useless.append("fixed = false")
    if useless:
        raise InputError(
            f"{where}: {commas(useless)} goes with what is fitted, and a payload is weighed and "
            "measured, never fitted; leave it out"
        )


def check_payload(body: Mapping[str, Parameter], motion: str, where: str) -> None:
    """Refuse a payload that is none, or of which nobody knows how far from the axis it hangs.

    Raises
    ------
    InputError
    """
    for name in _PAYLOAD:
        if name in body and not 0.0 <= body[name].value < math.inf:
            raise InputError(
                f"{where} {name} = {body[name].value} is out of bounds: give a finite number from 0"
            )
    if motion == "rotary" and "payload_kg" in body and "payload_m" not in body:
        raise InputError(
            f"{where} payload_kg is stated without payload_m; state how far from the axis it "
            "hangs, in m"
        )


def _check_scale(
    drive: Mapping[str, Any],
    body: Mapping[str, Parameter],
    friction: Mapping[str, Parameter],
    source: str,
) -> None:
    """Refuse to fit the gain where everything that it scales is fitted as well."""
    free = [name for name, value in drive.items() if isinstance(value, Parameter)]
    stated = (*body.values(), *friction.values())
    if free and not any(parameter.fixed and parameter.value != 0.0 for parameter in stated):
        raise InputError(
            f"{source}: [drive] {free[0]} is to be fitted, and inertia, gravity and friction scale "
            "with it: state a payload_kg, or one of them as { value = …, fixed = true }"
        )


def _friction(
    given: Mapping[str, Any], source: str
) -> tuple[str, dict[str, Parameter], dict[str, str]]:
    from .._native import called
    from ..catalogue import effects, laws

    where = f"{source}: [friction]"
    if "law" not in given:
        known_laws = commas(record.name for record in laws())
        raise InputError(f"{where} law is missing; allowed are {known_laws}")
    if given["law"] in effects():
        raise InputError(
            f"{where} law = '{given['law']}' is an effect and no law; put it under [[effects]] as "
            f'name = "{given["law"]}", and state one of {commas(laws().names)} here'
        )
    law = choice(given["law"], (record.name for record in laws()), f"{where} law")
    record = next(record for record in laws() if record.name == law)
    options = {option.name: option for option in record.options}
    names = [parameter.name for parameter in record.parameters]
    for key in given:
        meant = None if key in (*names, *options) else called(law, key)
        if meant is not None:
            raise InputError(f"{where}: '{key}' is unknown; it is called '{meant}' here")
    check_keys(given, ["law", *names, *options], where)
    words = {
        name: choice(given[name], (w for w, _ in option.choices), f"{where} {name}")
        for name, option in options.items()
        if name in given
    }
    parameters = {
        name: Parameter.read(given[name], f"{where} {name}") for name in names if name in given
    }
    return law, parameters, words


def _effects(
    given: Any, motion: Motion, servo: bool, source: str
) -> list[tuple[str, dict[str, Parameter]]]:
    from ..catalogue import effects, laws

    if not isinstance(given, list) or not all(isinstance(e, Mapping) for e in given):
        raise InputError(
            f"{source}: effects is not a list of tables; write [[effects]], in Python "
            '"effects": [{"name": "stribeck"}]'
        )
    records = {record.name: record for record in effects()}
    result: list[tuple[str, dict[str, Parameter]]] = []
    for index, entry in enumerate(given, 1):
        where = f"{source}: [[effects]] {index}"
        if "name" not in entry:
            meant = next((f'; write name = "{key}"' for key in entry if key in records), "")
            raise InputError(f"{where}: name is missing{meant}; allowed are {commas(records)}")
        if entry["name"] in laws():
            raise InputError(
                f"{where} name = '{entry['name']}' is a law and no effect; write it under "
                f'[friction] as law = "{entry["name"]}"'
            )
        effect = choice(entry["name"], records, f"{where} name")
        if any(effect == other for other, _ in result):
            raise InputError(f"{where}: '{effect}' is there twice; drop one")
        where = f"{where} ({effect})"
        if reason := records[effect].impossible(motion, servo=servo):
            raise InputError(f"{where}: {reason}; leave it out")
        check_keys(entry, ["name", *(p.name for p in records[effect].parameters)], where)
        values = {
            key: Parameter.read(value, f"{where} {key}")
            for key, value in entry.items()
            if key != "name"
        }
        result.append((effect, values))
    return result


def _sensor(given: Mapping[str, Any], motion: str, source: str) -> dict[str, float]:
    where = f"{source}: [sensor]"
    own = "counts_per_rev" if motion == "rotary" else "count_m"
    check_keys(given, (own,), where)
    sensor = {name: number(value, f"{where} {name}") for name, value in given.items()}
    for name, value in sensor.items():
        if not 0.0 < value < math.inf:
            raise InputError(f"{where} {name} = {value} is not a finite number above 0")
    return sensor


def _controller(given: Mapping[str, Any], source: str) -> dict[str, Any]:
    where = f"{source}: [controller]"
    if not given:
        return {}
    if "kind" not in given:
        raise InputError(f"{where} kind is missing; allowed are {commas(_CONTROLLERS)}")
    kind = choice(given["kind"], _CONTROLLERS, f"{where} kind")
    needed, possible = _CONTROLLERS[kind]
    numbers = (*needed, *possible, "filter_s", "limit")
    check_keys(given, ("kind", "derivative", *numbers), f"{where} of kind '{kind}'")
    for name in needed:
        if name not in given:
            raise InputError(
                f"{where} {name} is missing; a controller of kind '{kind}' needs "
                f"{' and '.join(needed)}: state {name}, or take another kind of "
                f"{commas(_CONTROLLERS)}"
            )
    controller: dict[str, Any] = {"kind": kind}
    if "derivative" in given:
        controller["derivative"] = choice(given["derivative"], _DERIVATIVES, f"{where} derivative")
    for name in numbers:
        if name in given:
            controller[name] = number(given[name], f"{where} {name}")
            if name != "limit" and math.isinf(controller[name]):
                raise InputError(f"{where} {name} = {controller[name]}: give a finite number")
    if controller.get("filter_s", 0.0) < 0.0:
        raise InputError(
            f"{where} filter_s = {controller['filter_s']} is below 0; give the time constant of "
            "the filter on the velocity in s, or 0 for none"
        )
    if controller.get("limit", 1.0) <= 0.0:
        raise InputError(f"{where} limit = {controller['limit']} is not above 0")
    return controller


def render(table: Mapping[str, Any]) -> str:
    """The text of a plant file, from plain tables."""
    lines: list[str] = []
    for name, content in table.items():
        if isinstance(content, list):
            for entry in content:
                lines += [f"[[{name}]]", *_lines(entry), ""]
        else:
            lines += [f"[{name}]", *_lines(content), ""]
    return "\n".join(lines)


def _lines(table: Mapping[str, Any]) -> list[str]:
    return [f"{key} = {_value(value)}" for key, value in table.items()]


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"')
        return f'"{escaped}"'
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{k} = {_value(v)}" for k, v in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_value(v) for v in value) + "]"
    # repr keeps every bit; TOML writes infinity and nan as Python does.
    return repr(float(value)) if isinstance(value, float) else repr(value)
