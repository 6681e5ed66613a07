"""What the verbs do where the plant is a robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..robot.session import load_session
from .answer import answer, folder, told_anyway, written
from .interrupt import ending_soon, finished
from .progress import progress

__all__ = ["diagnose_arm"]


def diagnose_arm(
    session: Path,
    robot: Path,
    add: Sequence[Path],
    out: Path | None,
    asked: Mapping[str, Any],
    *,
    as_json: bool,
) -> None:
    """``stiction diagnose`` of a robot.

    Parameters
    ----------
    session, robot : Path
        Session file and the robot file that it names.
    add : sequence of Path
        New recordings, which only machines of one axis take.
    out : Path or None
        Folder for the results.
    asked : mapping
        What ``diagnose_robot`` takes.
    as_json : bool
        Print JSON.

    Raises
    ------
    InputError
    """
    from ..robot.diagnose import diagnose_robot

    if add:
        raise InputError(
            f"{session}: --add is for machines of one axis, and this one is a robot; list the "
            "recording in the session, and diagnose that"
        )
    where = Path(f"{session.stem}-diagnosis") if out is None else out
    _spared(robot, where)
    with progress():
        recordings = load_session(session)
        folder(where)
        with ending_soon():
            found = diagnose_robot(recordings, **asked)
    with finished(struck=not found.success):
        with told_anyway(str(found), found.to_dict(), as_json=as_json), progress(), written(where):
            report = found.save(where)
        left_out = [f"left out: {fault}" for fault in recordings.left_out]
        said = (str(found), "\n".join(left_out), f"report: {report}")
        answer("\n\n".join(filter(None, said)), found.to_dict(), as_json=as_json)
    if not found.success:
        raise KeyboardInterrupt


def _spared(robot: Path, where: Path) -> None:
    """Refuse to write a robot.toml over the one that was read."""
    file = where / "robot.toml"
    if file.exists() and file.samefile(robot):
        raise InputError(
            f"{file}: is the robot file of this session and is not overwritten; give another "
            "folder with --out"
        )
