"""``stiction init`` of a robot: drafts of robot.toml and session.toml from a URDF and logs."""

from __future__ import annotations

import logging
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from .._support.atomic_files import create_text
from .._support.given import vacant
from .._support.progress import phase
from .._support.wording import commas, plural
from ..drafting.tables import as_in_file, name_tables, read
from ..drafting.text import column_value, comment, kinds_of, printable, toml_string
from ..errors import InputError
from ..recording import Columns, Table
from ..recording.columns import Column
from ..recording.guess import ColumnGuess, Guess, guess
from ..recording.joints import joints_of
from ..recording.recording import recording_of
from ..robot import Joint, Robot, RobotSession, Run
from ..robot.description import read_urdf
from ..robot.extended import relative
from .answer import answer, folder, protect_writes
from .progress import progress

__all__ = ["FILES", "draft_robot"]

FILES: Final = ("robot.toml", "session.toml")
_WISHED: Final = re.compile(r"(?i)(des|desired|target|goal|ref|reference|cmd|command|set)")
_CARRIES: Final = re.compile(r"(?i)(?<![a-z])(load|loaded|payload|carrying)(?![a-z])")

_logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class _Drafted:
    """What was guessed of one joint."""

    name: str
    label: str
    found: Guess
    gain: float | None = None

    @property
    def joint(self) -> Joint:
        """With a gain of 1."""
        found = self.found
        roles = {role: one for role, one in found.by_role.items() if role in _ROLES}
        columns = {
            role: Column(one.column, one.unit or None, one.scale) for role, one in roles.items()
        }
        return Joint(self.name, found.motion, Columns(columns), found.drive or "")


_ROLES: Final = ("position", "velocity", "input")


def draft_robot(
    urdf: Path,
    data: Sequence[Path],
    header: str,
    joint: str,
    out: Path,
    *,
    as_json: bool,
    quiet: bool = False,
) -> None:
    """Write robot.toml and session.toml for the robot of a URDF and its logs.

    Parameters
    ----------
    urdf : Path
    data : sequence of Path
        Logs, or folders of them.
    header, joint : str
        As ``stiction init`` takes them.
    out : Path
        Folder to write into.
    as_json : bool
        Print JSON.
    quiet : bool
        Show no progress.

    Raises
    ------
    InputError
        Logs that cannot be read, or that are not of these joints; files that are there.
    """
    if joint:
        raise InputError("--joint takes one joint of a log, and a robot has all; leave it out")
    if not data:
        raise InputError(f"{urdf}: no logs are given; name files or a folder behind the URDF")
    vacant(out, FILES, "another folder with --out")
    description = read_urdf(urdf)
    with progress(quiet):
        tables, left_out, files_of = read(data)
        phase(_logger, "guessing what each column is")
        tables, calls = name_tables(tables, header)
        places, locked = _places(urdf, description.kinds, description.free, tables)
        joints = [
            _guessed(name, label, tables, calls, description.kinds[name])
            for name, label in places.items()
        ]
        payloads = [_payload(files_of[table.path][0]) for table in tables]
        joints = _with_gains(urdf, joints, locked, tables, payloads, header)
    where = folder(out)
    paths = [where / name for name in FILES]
    texts = (
        _robot_text(urdf, joints, locked, where),
        _session_text(
            joints, [files_of[table.path] for table in tables], payloads, left_out, where
        ),
    )
    with protect_writes(where):
        for file, text in zip(paths, texts, strict=True):
            create_text(file, text)
    todo = [f"{one.name}: {why}" for one in joints for why in one.found.missing.values()]
    unsure = [one.name for one in joints if one.found.drive == "current_a" and one.gain is None]
    if unsure:
        todo.append(f"state the gain of {commas(unsure)} in robot.toml")
    guessed = [one.name for one in joints if one.found.input_unknown]
    if guessed:
        todo.append(
            f"confirm in robot.toml the unit of the input of {commas(guessed)}: no column says "
            "what it is measured in"
        )
    told = {
        "joints": {one.name: {"label": one.label, **one.found.to_dict()} for one in joints},
        "locked": list(locked),
        "recordings": [str(table.path) for table in tables],
        "left_out": {str(path): why for path, why in left_out},
        "to_do": todo,
        "files": [str(file) for file in paths],
    }
    answer(_text(joints, tables, left_out, todo, paths), told, as_json=as_json)


def _places(
    urdf: Path, kinds: Mapping[str, str], free: Sequence[str], tables: Sequence[Table]
) -> tuple[dict[str, str], tuple[str, ...]]:
    """What the logs call each joint of the URDF, and the joints that they do not have."""
    found = joints_of(tables)
    labels = found.labels if found is not None else ()
    if found is None and len(free) == 1:
        return {free[0]: ""}, ()
    own = {_plain(name): name for name in kinds}
    if labels and all(_plain(label) in own for label in labels):
        by_name = {own[_plain(label)]: label for label in labels}
        ordered = {name: by_name[name] for name in kinds if name in by_name}
        return ordered, tuple(name for name in free if name not in ordered)
    if not labels or len(labels) > len(free):
        told = f"are of {plural(len(labels), 'joint')} ({commas(labels)})"
        raise InputError(
            f"{tables[0].path}: its columns {told if labels else 'name no joint'}, "
            f"and {urdf.name} has {plural(len(free), 'joint')} that "
            f"{'moves' if len(free) == 1 else 'move'} ({commas(free)}); call the columns as the "
            'URDF calls its joints, or say what they are with --header "t,q*6,qd*6,i*6"'
        )
    return dict(zip(free, labels, strict=False)), tuple(free[len(labels) :])


def _plain(name: str) -> str:
    return re.sub(r"[^a-z0-9]+", "_", name.casefold()).strip("_")


def _guessed(
    name: str, label: str, tables: Sequence[Table], calls: Mapping[str, str], kind: str
) -> _Drafted:
    """What each column of a joint is: what was measured before what was only wished."""
    found = joints_of(tables)
    own = [found.only(table, label) for table in tables] if found is not None else list(tables)
    first = guess(own)
    drive = first.by_role.get("input")
    others = [one for one in first.columns if one.candidate == "input"]
    if drive is not None and _WISHED.search(drive.column) and others:
        wished = {one.column for one in (drive, *others) if _WISHED.search(one.column)}
        if len(wished) <= len(others):
            own = [_without(table, wished) for table in own]
            first = guess(own)
    motion = "linear" if kind == "prismatic" else "rotary"
    if first.motion != motion:
        raise InputError(
            f"{tables[0].path}: joint '{name}' is {kind}, and its columns are those of a "
            f"{first.motion} one ({first.motion_reason}); check the order of the joints"
        )
    return _Drafted(name, label, as_in_file(first, calls))


def _without(table: Table, columns: set[str]) -> Table:
    kept = {name: values for name, values in table.columns.items() if name not in columns}
    return replace(table, columns=kept, cells=tuple(c for c in table.cells if c.column in kept))


def _with_gains(
    urdf: Path,
    joints: Sequence[_Drafted],
    locked: Sequence[str],
    tables: Sequence[Table],
    payloads: Sequence[float],
    header: str,
) -> list[_Drafted]:
    """The joints with the gains that the masses of the URDF would have."""
    if any(one.found.missing for one in joints):
        return list(joints)
    if all(one.found.drive in ("torque_nm", "force_n") for one in joints):
        return list(joints)
    from ..robot.gains import gains_of

    phase(_logger, "moving the links along what was measured")
    robot = Robot(urdf, tuple(one.joint for one in joints), dict.fromkeys(locked, 0.0))
    # Under the names of the file, which the guess has as well.
    tables, _ = _called(tables, header)
    clock = joints[0].found.by_role["time"]
    time = Column(clock.column, clock.unit or None, clock.scale)
    try:
        runs = [
            Run(tuple(_of_joint(table, joint, time) for joint in robot.joints), payload)
            for table, payload in zip(tables, payloads, strict=True)
        ]
        gains = gains_of(RobotSession(robot, tuple(runs)))
    except InputError as error:
        # The drafts say what is to be stated; what is wrong with the logs a fit will say.
        _logger.info("no gain is guessed: %s", error)
        return list(joints)
    return [
        replace(one, gain=gain if one.found.drive == "current_a" else None)
        for one, gain in zip(joints, gains, strict=True)
    ]


def _called(tables: Sequence[Table], header: str) -> tuple[list[Table], bool]:
    """The tables under the names that the file has."""
    if not header:
        return list(tables), False
    found = []
    for table in tables:
        back = {name: f"column {place}" for place, name in enumerate(table.columns, 1)}
        found.append(table.renamed(back))
    return found, True


def _of_joint(table: Table, joint: Joint, time: Column) -> Any:
    columns = Columns({"time": time, **joint.columns})
    return recording_of(table, columns, drive=joint.input, motion=joint.motion)


def _payload(path: Path) -> float:
    """1 kg where the name of a file says that something is carried, else 0."""
    return 1.0 if _CARRIES.search(path.stem.replace("_", "-")) else 0.0


def _robot_text(urdf: Path, joints: Sequence[_Drafted], locked: Sequence[str], where: Path) -> str:
    lines = [
        *comment(
            "A robot, drafted by stiction init. Every line is a guess: read it, correct it, and "
            "state what you know. The inertias of the URDF are where the fit of the links starts."
        ),
        "",
        "[robot]",
        f"urdf = {toml_string(relative(urdf, where))}",
    ]
    if locked:
        lines += comment("No column is of these joints: they are taken to rest at 0.")
        lines.append(f"locked = {{ {', '.join(f'{name} = 0.0' for name in locked)} }}")
    for one in joints:
        lines += [
            "",
            *comment(_called_as(one)),
            "[[robot.joints]]",
            f"name = {toml_string(one.name)}",
        ]
        lines += _columns(one.found)
        lines += _drive(one, joints)
    return "\n".join(lines) + "\n"


def _called_as(one: _Drafted) -> str:
    if not one.label or one.label == one.name:
        return f"Joint {one.name}."
    return f"Joint {one.name}: joint {one.label} of the logs, by its name or its place."


def _columns(found: Guess) -> list[str]:
    lines = ["[robot.joints.columns]"]
    for role in _ROLES:
        own = found.by_role.get(role)
        if own is not None:
            lines += comment(f"{printable(own.reason)}.")
            lines.append(f"{role} = {column_value(own)}")
        elif role in found.missing:
            lines += comment(f"TO DO: {printable(found.missing[role])}.")
            for other in _candidates(found, role):
                lines += comment(f"{printable(other.reason)}:")
                lines.append(f"# {role} = {column_value(other)}")
    return lines


def _candidates(found: Guess, role: str) -> list[ColumnGuess]:
    return [one for one in found.columns if one.candidate == role]


def _drive(one: _Drafted, joints: Sequence[_Drafted]) -> list[str]:
    lines = ["[robot.joints.drive]"]
    drive = one.found.drive
    if drive in ("torque_nm", "force_n"):
        if one.found.input_unknown:
            lines += comment(f"TO DO: confirm the unit. {printable(one.found.drive_reason)}.")
        return [*lines, f'input = "{drive}"', "gain = 1.0"]
    known = [other.gain for other in joints if other.gain is not None]
    if one.gain is not None:
        lines += comment(
            "TO DO: state the gain (motor constant · gear ratio) if you know it. This is the one "
            "with which the masses of the URDF move as measured."
        )
        gain = one.gain
    else:
        gain = float(np.median(known)) if known else 1.0
        lines += comment(
            "TO DO: state the gain (motor constant · gear ratio): these logs do not tell it"
            + (", and what stands here is the median of the other joints." if known else ".")
        )
    return [*lines, f'input = "{drive or "current_a"}"', f"gain = {gain:.4g}"]


def _session_text(
    joints: Sequence[_Drafted],
    paths: Sequence[Sequence[Path]],
    payloads: Sequence[float],
    left_out: Sequence[tuple[Path, str]],
    where: Path,
) -> str:
    clock = joints[0].found.by_role.get("time")
    lines = [
        *comment(
            "A session of a robot, drafted by stiction init. The columns of the joints stand in "
            "robot.toml; what all of them share stands here."
        ),
        f'plant = "{FILES[0]}"',
        "",
        "[columns]",
        *(comment("TO DO: name the column of time.") if clock is None else []),
        '# time = "…"' if clock is None else f"time = {column_value(clock)}",
        "",
        *comment(
            'A recording may have role = "train", "select" or "test"; without roles they are '
            "assigned in turn. payload_kg says that something hangs on the last link: recordings "
            "with the same number share it, and its mass is fitted."
        ),
    ]
    kinds = kinds_of([files[0] for files in paths])
    for files, kind, payload in zip(paths, kinds, payloads, strict=True):
        names = [toml_string(relative(path, where)) for path in files]
        lines += ["", "[[recordings]]"]
        lines.append(f"file = {names[0] if len(names) == 1 else '[' + ', '.join(names) + ']'}")
        lines += [f"kind = {toml_string(kind)}"] if kind else []
        if payload:
            lines += comment("By the word in its name. TO DO: state its mass, or take this away.")
            lines.append(f"payload_kg = {payload}")
    for path, why in left_out:
        lines += ["", *comment(f"Left out: {printable(why.removeprefix(f'{path}: '))}")]
        lines += ["# [[recordings]]", f"# file = {toml_string(relative(path, where))}"]
    return "\n".join(lines) + "\n"


def _text(
    joints: Sequence[_Drafted],
    tables: Sequence[Table],
    left_out: Sequence[tuple[Path, str]],
    todo: Sequence[str],
    files: Sequence[Path],
) -> str:
    lines = [f"guessed from {plural(len(tables), 'recording')}:", ""]
    width = max(len(one.name) for one in joints)
    for one in joints:
        roles = one.found.by_role
        told = [
            f"{role} {roles[role].column} [{roles[role].unit}]" for role in _ROLES if role in roles
        ]
        gain = f", gain {one.gain:.3g} by the masses of the URDF" if one.gain is not None else ""
        lines.append(f"{one.name:<{width}}  {', '.join(told)}{gain}")
    lines += [f"left out: {path}: {why.removeprefix(f'{path}: ')}" for path, why in left_out]
    lines += ["", *(f"wrote {file}" for file in files)]
    lines += [f"to do: {sentence}" for sentence in todo]
    lines.append(f"next: read both files, then stiction diagnose {files[1]}")
    return "\n".join(lines)
