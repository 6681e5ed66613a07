"""Recordings of a robot: all joints of each, over one clock."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from .._support import given
from .._support.given import number
from .._support.keys import check_keys
from .._support.progress import phase, steps
from .._support.wording import plural
from ..errors import InputError
from ..plant.assumed import open_marks
from ..plant.plant_file import read_toml, section
from ..recording import Columns, Recording, Table, read_table
from ..recording.names import names_of
from ..recording.recording import recording_of, recordings_of
from ..recording.signals import read_signals
from ..session_entries import Entry, all_faults, beside, entries_of
from .robot import Joint, Robot

__all__ = ["RobotSession", "Run", "load_session", "robot_of"]

_TABLES: Final = ("plant", "columns", "recordings")
_SHARED: Final = ("time", "temperature")
_PAYLOAD: Final = "payload_kg"
HEAVIEST: Final = 1e6
"""kg; no arm carries that."""

_logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Run:
    """One recording of all joints.

    Attributes
    ----------
    joints : tuple of Recording
        In the order of the robot's joints, over one clock.
    payload : float
        Mass on the last link beside the robot's own, kg.
    """

    joints: tuple[Recording, ...]
    payload: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "joints", recordings_of(self.joints, "Run"))
        if len({len(one) for one in self.joints}) != 1:
            raise InputError(
                "Run: its joints have not as many rows each; give recordings over one clock, one "
                "for each joint"
            )
        payload = number(self.payload, "Run: payload")
        if not 0.0 <= payload < HEAVIEST:
            raise InputError(
                f"Run: payload = {payload:g} is out of bounds: give a mass in kg from 0"
            )


@dataclass(frozen=True)
class RobotSession:
    """Recordings of one robot.

    Attributes
    ----------
    robot : Robot
    runs : tuple of Run
    left_out : tuple of str
        Files that were found and could not be read, a sentence each.
    assumed : tuple of str
        What nobody has stated and was taken for granted, a sentence each.
    """

    robot: Robot
    runs: tuple[Run, ...]
    left_out: tuple[str, ...] = ()
    assumed: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        where = "robot session: robot"
        given.instance(self.robot, Robot, where, "a Robot, as Robot.load returns it")
        runs = given.each_of(self.runs, "robot session: runs", "Runs")
        object.__setattr__(
            self,
            "runs",
            tuple(given.instance(run, Run, "robot session: a run", "a Run") for run in runs),
        )
        if not self.runs:
            raise InputError("robot session: there are no recordings; give at least one")
        for run in self.runs:
            if len(run.joints) != len(self.robot.joints):
                raise InputError(
                    f"robot session: a recording has {plural(len(run.joints), 'joint')}, and the "
                    f"robot has {len(self.robot.joints)}"
                )

    @property
    def names(self) -> list[str]:
        """Of the recordings."""
        return names_of([run.joints[0] for run in self.runs])

    def of_joint(self, joint: int) -> list[Recording]:
        """The recordings of one joint.

        Parameters
        ----------
        joint : int
            Its place in the robot.

        Raises
        ------
        InputError
            There is no such joint.
        """
        most = len(self.robot.joints) - 1
        joint = given.whole(joint, "RobotSession.of_joint: joint", least=0, most=most)
        return [run.joints[joint] for run in self.runs]


def robot_of(path: Path) -> Path | None:
    """The robot file that a session file names, None where its plant is no robot."""
    from .robot import describes_robot

    try:
        named = read_toml(path).get("plant")
        file = beside(path, named, f"{path}: plant") if isinstance(named, str) and named else None
    except InputError:
        # What is wrong with it is told where it is read.
        return None
    return file if file is not None and describes_robot(file) else None


def load_session(path: str | Path) -> RobotSession:
    """Read a session file whose plant is a robot, and its recordings.

    Parameters
    ----------
    path : str or Path
        ``session.toml``: [columns] has what all joints share (``time``).

    Raises
    ------
    InputError
        As for ``stiction.load``, and for ``Robot.load``.
    """
    path = given.path(path, "load_session")
    table = read_toml(path, least='plant = "…" and one [[recordings]]')
    check_keys(table, _TABLES, str(path))
    file = robot_of(path)
    if file is None:
        raise InputError(
            f'{path}: its plant has no table [robot]; name a robot file as plant = "…"'
        )
    robot = Robot.load(file)
    columns = section(table, "columns", str(path))
    check_keys(columns, _SHARED, f"{path}: [columns]")
    entries = table.get("recordings", [])
    if not isinstance(entries, list) or not all(isinstance(e, dict) for e in entries):
        raise InputError(f"{path}: recordings is not a list of tables; write [[recordings]]")
    if not entries:
        raise InputError(f"{path}: there are no [[recordings]]; list at least one file")
    runs: list[Run] = []
    faults: list[str] = []
    left_out: list[str] = []
    phase(_logger, "reading the recordings")
    for entry in steps(entries_of(path, entries), "recording"):
        try:
            runs.append(_run(robot, entry, {**columns, **entry.columns}, str(path)))
        except InputError as error:
            (left_out if entry.found else faults).append(str(error))
    if faults or not runs:
        raise InputError(all_faults(str(path), faults or left_out))
    assumed = filter(None, (open_marks(each) for each in (file, path)))
    return RobotSession(robot, tuple(runs), tuple(left_out), tuple(assumed))


def _run(robot: Robot, entry: Entry, shared: dict[str, Any], where: str) -> Run:
    several = len(entry.files) > 1
    table = read_signals(list(entry.files)) if several else read_table(entry.files[0])
    common = Columns.parse(shared, where=f"{where}: [columns]") if shared else Columns({})
    labels = dict(entry.labels)
    settings = dict(labels.pop("settings", None) or {})
    payload = settings.pop(_PAYLOAD, 0.0)
    if settings:
        raise InputError(
            f"{where}: [[recordings]] {entry.place}: {', '.join(settings)} is no setting of a "
            f"robot; it has {_PAYLOAD}"
        )
    if not 0.0 <= payload < HEAVIEST:
        raise InputError(
            f"{where}: [[recordings]] {entry.place}: {_PAYLOAD} = {payload:g} is out of bounds: "
            "give a mass in kg from 0"
        )
    joints = [_of_joint(table, joint, common, labels) for joint in robot.joints]
    return Run(tuple(joints), payload)


def _of_joint(table: Table, joint: Joint, common: Columns, labels: dict[str, Any]) -> Recording:
    columns = Columns({**common, **joint.columns}, where=joint.columns.where)
    return recording_of(table, columns, drive=joint.input, motion=joint.motion, **labels)
