"""What the verbs do where the plant is a robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from .._support.given import vacant
from ..errors import InputError
from ..robot.robot import Robot
from ..robot.session import load_session
from .answer import answer, folder, print_on_failure, protect_writes
from .interrupt import answer_on_interrupt, defer_interrupt
from .progress import progress

__all__ = ["diagnose_arm", "export_arm", "plan_arm"]


def diagnose_arm(
    session: Path,
    robot: Path,
    add: Sequence[Path],
    out: Path | None,
    asked: Mapping[str, Any],
    *,
    as_json: bool,
    quiet: bool = False,
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
    quiet : bool
        Show no progress.

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
    with progress(quiet):
        recordings = load_session(session)
        folder(where)
        with answer_on_interrupt():
            found = diagnose_robot(recordings, **asked)
    with defer_interrupt(struck=not found.success):
        with (
            print_on_failure(str(found), found.to_dict(), as_json=as_json),
            progress(quiet),
            protect_writes(where),
        ):
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


def plan_arm(
    robot: Path, where: Path, asked: Mapping[str, Any], *, as_json: bool, quiet: bool = False
) -> None:
    """``stiction plan`` of a robot.

    Parameters
    ----------
    robot : Path
        Robot file.
    where : Path
        Folder for the signals.
    asked : mapping
        What ``plan_robot`` takes.
    as_json : bool
        Print JSON.
    quiet : bool
        Show no progress.

    Raises
    ------
    InputError
    """
    from ..robot.plan import plan_robot
    from ..robot.signals import FILLED_IN

    # Better said before the work than after it.
    vacant(where, FILLED_IN, "another folder with --out")
    with progress(quiet):
        made = plan_robot(Robot.load(robot), **asked)
        where = folder(where)
        text = f"{made!r}\n\nsignals: {where / 'signals'}\nfill in: {where / 'session.toml'}"
        with print_on_failure(text, made.to_dict(), as_json=as_json), protect_writes(where):
            made.save(where)
    answer(text, made.to_dict(), as_json=as_json)


def export_arm(
    robot: Path,
    to: Sequence[str],
    speed: float | None,
    check: Path | None,
    where: Path,
    *,
    as_json: bool,
) -> None:
    """``stiction export`` of a robot.

    Parameters
    ----------
    robot : Path
        Robot file.
    to : sequence of str
        Targets.
    speed : float or None
        Greatest speed at which friction matters.
    check : Path or None
        Session to run the targets on, which only machines of one axis are.
    where : Path
        Folder for the files.
    as_json : bool
        Print JSON.

    Raises
    ------
    InputError
    """
    from ..robot.export import export_robot

    if check is not None:
        raise InputError(
            f"{robot}: --check runs a machine of one axis, and this one is a robot; export and "
            "check the plant.toml in the folder of a joint"
        )
    read = Robot.load(robot)
    made = [(name, export_robot(read, name, speed=speed)) for name in to]
    folder(where)
    told, data = [], []
    with protect_writes(where):
        for name, parts in made:
            for part, own in parts.items():
                own.save(where / name / part)
                told.append(f"{part or name}: {own}\n  folder: {where / name / part}")
                data.append({"joint": part or None, **own.to_dict()})
    answer("\n".join(told), data, as_json=as_json)
