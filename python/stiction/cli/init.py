"""``stiction init``: drafts of plant.toml and session.toml from recordings."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from .. import session as sessions
from ..atomic_files import create_text
from ..errors import InputError
from ..given import vacant
from ..progress import phase
from ..recording import Table
from ..recording.guess import Guess, guess
from ..recording.joints import joints_of
from ..wording import counted, listed
from .answer import answer, folder, written
from .draft import plant_text, session_text
from .logs import as_in_file, named, read_logs
from .progress import progress

__all__ = ["init"]

_logger = logging.getLogger(__name__)

_FILES = ("plant.toml", "session.toml")


def init(
    data: Path,
    *more: Path,
    joint: str = "",
    header: str = "",
    out: Annotated[Path, Parameter(name=["--out", "-o"])] = Path(),
    json: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Guess columns and units of recordings; write a commented plant.toml and session.toml.

    With a URDF before the recordings all joints of a robot are drafted: robot.toml takes the place
    of plant.toml.

    Every guess is written with its reason and its alternatives. What could not be guessed is a
    line that is commented out and says what to do. Files that are there are not overwritten.

    Parameters
    ----------
    data
        Recording in any of the formats that are read, or a folder of them; or a URDF.
    more
        More files with the same columns.
    joint
        Of files of several joints the one that is wanted, as its columns call it.
    header
        Names for the columns of files that have none, separated by commas: "t,q*6,tau*6", where
        q*6 stands for q1 to q6.
    out
        Folder to write into, the present one without it.
    json
        Print JSON.
    """
    if data.suffix.casefold() == ".urdf":
        from .robot_draft import draft_robot

        draft_robot(data, more, header, joint, out, as_json=json)
        return
    vacant(out, _FILES, "another folder with --out")
    with progress():
        tables, left_out, files_of = read_logs([data, *more])
        phase(_logger, "guessing what each column is")
        tables, calls = named(tables, header)
        tables, joints = _one_joint(tables, joint)
        found = as_in_file(guess(tables), calls)
    where = folder(out)
    files = [where / name for name in _FILES]
    paths = [files_of[table.path] for table in tables]
    headers = [table.header for table in tables]
    texts = (plant_text(found), session_text(found, paths, left_out, where, joints, headers))
    with written(where):
        for file, text in zip(files, texts, strict=True):
            create_text(file, text)
    todo = list(found.missing.values())
    if found.counts_needed and not found.counts_per_rev:
        todo.append("state the size of a sensor count under [sensor] of plant.toml")
    # What the guess does not see (too many empty cells, a clock that jumps) is said at once.
    if not todo:
        try:
            sessions.load(files[1])
        except InputError as error:
            todo.append(str(error))
    result = {
        **found.to_dict(),
        "joints": joints,
        "recordings": [str(table.path) for table in tables],
        "left_out": {str(path): why for path, why in left_out},
        "to_do": todo,
        "files": [str(file) for file in files],
    }
    answer(_text(found, tables, left_out, todo, files, joints), result, as_json=json)


def _one_joint(tables: list[Table], wanted: str) -> tuple[list[Table], list[str]]:
    """The columns of one joint, and what the joints are called, that one first.

    Raises
    ------
    InputError
        There is no such joint, or nothing tells several.
    """
    joints = joints_of(tables)
    if joints is None:
        if wanted:
            raise InputError(
                f"{tables[0].path}: --joint is {wanted}, and the columns are not those of several "
                f"joints ({listed(tables[0].columns)}); leave it out"
            )
        return tables, []
    joint = wanted or joints.moving(tables)
    others = [label for label in joints.labels if label != joint]
    return [joints.only(table, joint) for table in tables], [joint, *others]


def _text(
    found: Guess,
    tables: Sequence[Table],
    left_out: Sequence[tuple[Path, str]],
    todo: Sequence[str],
    files: Sequence[Path],
    joints: Sequence[str],
) -> str:
    rows: list[tuple[Any, ...]] = [("column", "role", "unit", "why")]
    for one in found.columns:
        unit = "" if one.role is None else f"{one.scale:g}·{one.unit}".removeprefix("1·")
        rows.append((one.column, one.role or "-", unit, one.reason))
    widths = [max(len(row[k]) for row in rows) for k in range(3)]
    lines = [f"guessed from {counted(len(tables), 'recording')}:", ""]
    lines += ["  ".join([*(f"{row[k]:<{widths[k]}}" for k in range(3)), row[3]]) for row in rows]
    if joints:
        lines += ["", f"joint: {joints[0]} (others: {listed(joints[1:])}; --joint takes them)"]
    lines += ["", f"motion: {found.motion} ({found.motion_reason})"]
    lines += [f"drive: {found.drive or 'not known'} ({found.drive_reason})"]
    lines += [f"left out: {path}: {why.removeprefix(f'{path}: ')}" for path, why in left_out]
    lines += ["", *(f"wrote {file}" for file in files)]
    lines += [f"to do: {sentence}" for sentence in todo]
    if not todo:
        lines.append(f"next: read both files, then stiction fit {files[1]}")
    return "\n".join(lines)
