"""``stiction init``: drafts of plant.toml and session.toml from recordings."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from .._support.atomic_files import create_text
from .._support.wording import commas, plural
from ..errors import InputError
from .answer import answer, folder, protect_writes
from .given import Quiet
from .progress import progress

if TYPE_CHECKING:
    from ..drafting import Draft

__all__ = ["init"]


def init(
    data: Path,
    *more: Path,
    joint: str = "",
    header: str = "",
    out: Annotated[Path, Parameter(name=["--out", "-o"])] = Path(),
    json: Annotated[bool, Parameter(negative="")] = False,
    quiet: Quiet = False,
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
    from .. import session as sessions
    from .._support.given import vacant
    from ..drafting import FILES, draft
    from .robot_draft import draft_robot

    if data.suffix.casefold() == ".urdf":
        draft_robot(data, more, header, joint, out, as_json=json, quiet=quiet)
        return
    vacant(out, FILES, "another folder with --out")
    with progress(quiet):
        made = draft([data, *more], joint=joint, header=header)
    where = folder(out)
    files = [where / name for name in FILES]
    with protect_writes(where):
        for file, text in zip(files, made.texts(where), strict=True):
            create_text(file, text)
    todo = made.to_do
    # What the guess does not see (too many empty cells, a clock that jumps) is said at once.
    if not todo:
        try:
            sessions.load(files[1])
        except InputError as error:
            todo.append(str(error))
    result = {
        **made.found.to_dict(),
        "joints": list(made.joints),
        "recordings": [str(table.path) for table in made.tables],
        "left_out": {str(path): why for path, why in made.left_out},
        "to_do": todo,
        "files": [str(file) for file in files],
    }
    answer(_text(made, todo, files), result, as_json=json)


def _text(made: Draft, todo: Sequence[str], files: Sequence[Path]) -> str:
    found, joints = made.found, made.joints
    rows: list[tuple[Any, ...]] = [("column", "role", "unit", "why")]
    for one in found.columns:
        unit = "" if one.role is None else f"{one.scale:g}·{one.unit}".removeprefix("1·")
        rows.append((one.column, one.role or "-", unit, one.reason))
    widths = [max(len(row[k]) for row in rows) for k in range(3)]
    lines = [f"guessed from {plural(len(made.tables), 'recording')}:", ""]
    lines += ["  ".join([*(f"{row[k]:<{widths[k]}}" for k in range(3)), row[3]]) for row in rows]
    if joints:
        lines += ["", f"joint: {joints[0]} (others: {commas(joints[1:])}; --joint takes them)"]
    lines += ["", f"motion: {found.motion} ({found.motion_reason})"]
    lines += [f"drive: {found.drive or 'not known'} ({found.drive_reason})"]
    lines += [f"left out: {path}: {why.removeprefix(f'{path}: ')}" for path, why in made.left_out]
    lines += ["", *(f"wrote {file}" for file in files)]
    if found.input_unknown:
        name = found.by_role["input"].column
        lines.append(
            f"to do: state what '{name}' is measured in: its unit in session.toml is a guess, and "
            "so is that of every effort"
        )
    lines += [f"to do: {sentence}" for sentence in todo]
    if not todo:
        lines.append(f"next: read both files, then stiction fit {files[1]}")
    return "\n".join(lines)
