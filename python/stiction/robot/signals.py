"""A plan of a robot: signals of all joints, their files and figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from .._support import given
from .._support.arrays import FloatArray
from .._support.atomic_files import atomic_write, write_text
from .._support.wording import plural
from ..plan.files import find_signal, write_plan
from ..plan.result import PAUSE_S
from ..recording.recording import SPLIT_ROLES
from .extended import robot_text
from .robot import Robot

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .excitation import Excitation

__all__ = ["FILLED_IN", "RobotPlan", "RobotSignal"]

FILLED_IN: Final = ("session.toml", "robot.toml")
"""Files that whoever records goes on writing in: an earlier one is never replaced."""


@dataclass(frozen=True)
class RobotSignal:
    """Positions of all joints for one recording, from rest at home and back.

    Attributes
    ----------
    experiment : str
    joint : str
        That moves, "" where all do.
    role : str
        Of the recording that it makes.
    names, units : tuple of str
        Of the joints; rad or m.
    time : numpy.ndarray, shape (n,)
        s.
    positions : numpy.ndarray, shape (n, joints)
    greatest : mapping of str to numpy.ndarray, shape (joints,)
        Greatest position (from 0), speed and effort of each joint.
    """

    experiment: str
    joint: str
    role: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    time: FloatArray
    positions: FloatArray
    greatest: Mapping[str, FloatArray]

    @property
    def name(self) -> str:
        """Of its files."""
        place = f"joint{self.names.index(self.joint) + 1}-" if self.joint else ""
        return f"{place}{self.experiment}-{self.role}"

    @property
    def duration(self) -> float:
        """In seconds."""
        return float(self.time[-1])

    def __repr__(self) -> str:
        return f"RobotSignal({self.name}, {self.duration:.1f} s, {self.joint or 'all joints'})"

    def save(self, where: str | Path) -> Path:
        """Write it as CSV into a folder: time and a column for each joint; returns the path.

        Raises
        ------
        InputError
            No name of a folder, or one that is not there or cannot be written to.
        """
        path = given.path(where, "RobotSignal.save") / f"{self.name}.csv"
        pairs = zip(self.names, self.units, strict=True)
        head = ",".join(["time_s", *(f"{name}_{unit}" for name, unit in pairs)])
        rows = np.column_stack([self.time, self.positions])
        with given.explain_write_errors(path), atomic_write(path) as file:
            file.write(f"{head}\n".encode())
            np.savetxt(file, rows, fmt="%.9g", delimiter=",")
        return path

    def plot(self) -> Figure:
        """Positions of the joints that move, over time."""
        from .. import plot

        figure, axes = plot.figure(1, height=3.0, title=f"{self.experiment}: {self._what}")
        for k, name in enumerate(self.names):
            if self.joint in ("", name):
                axes[0].plot(
                    *plot.thinned(self.time, self.positions[:, k]),
                    color=plot.CYCLE[k % len(plot.CYCLE)],
                    lw=0.9,
                    label=name,
                )
        axes[0].set_ylabel(f"position / {' or '.join(sorted(set(self.units)))}")
        axes[0].set_xlabel("time / s")
        plot.legend(axes[0])
        return figure

    @property
    def _what(self) -> str:
        return f"{self.joint} alone" if self.joint else "all joints"


@dataclass(frozen=True)
class RobotPlan:
    """Signals for a session of one robot.

    Attributes
    ----------
    robot : Robot
    signals : tuple of RobotSignal
        In the order of the session.
    excitations : tuple of Excitation
        How well each motion of all joints tells base parameters and friction.
    notes : tuple of str
        What was assumed or left out, and why.
    """

    robot: Robot
    signals: tuple[RobotSignal, ...]
    excitations: tuple[Excitation, ...] = ()
    notes: tuple[str, ...] = ()

    def __getitem__(self, name: str) -> RobotSignal:
        """A signal by its name, such as ``together-train``.

        Raises
        ------
        UnknownName
            An ``InputError`` and a ``KeyError``: there is no such signal.
        """
        return find_signal(self.signals, name)

    def schedule(self) -> list[dict[str, Any]]:
        """What to record when: file, role, kind and start of every recording, pauses included."""
        entries: list[dict[str, Any]] = []
        at = 0.0
        for role in SPLIT_ROLES:
            for each in self.signals:
                if each.role == role:
                    entries.append(
                        {
                            "file": f"{each.name}.csv",
                            "role": role,
                            "kind": each.experiment,
                            "start_s": round(at, 3),
                        }
                    )
                    at += each.duration + PAUSE_S
        return entries

    def save(self, where: str | Path) -> Path:
        """Write signals, figures, plan.json, robot.toml and a session.toml to be filled in.

        Parameters
        ----------
        where : str or Path
            Folder, made where it is not there.

        Returns
        -------
        Path
            The folder.

        Raises
        ------
        InputError
            A session.toml or robot.toml is there already, which may have been filled in, and
            nothing is written then; the folder cannot be written.
        """
        folder = given.path(where, "RobotPlan.save")
        given.vacant(folder, FILLED_IN)

        def write_robot() -> None:
            write_text(folder / "robot.toml", robot_text(self.robot, self._joints(), folder))

        return write_plan(folder, self.signals, self.to_dict(), write_robot, self._session())

    def to_dict(self) -> dict[str, Any]:
        """As in plan.json."""
        return {
            "joints": list(self.robot.names),
            "signals": [
                {
                    "name": s.name,
                    "experiment": s.experiment,
                    "joint": s.joint or None,
                    "role": s.role,
                    "duration_s": s.duration,
                    "greatest": {key: own.tolist() for key, own in s.greatest.items()},
                }
                for s in self.signals
            ],
            "excitation": [
                {
                    "condition": e.condition,
                    "condition_of_random_motion": e.drawn,
                    "parameters": e.parameters,
                    "period_s": e.period,
                }
                for e in self.excitations
            ],
            "schedule": self.schedule(),
            "notes": list(self.notes),
        }

    def _joints(self) -> dict[str, dict[str, Any]]:
        return {
            joint.name: {
                "rotor_inertia": joint.rotor_inertia,
                "friction": dict(joint.friction),
                "effects": [dict(effect) for effect in joint.effects],
            }
            for joint in self.robot.joints
        }

    def _session(self) -> str:
        lines = [
            "# Recordings to be made with the files of signals/, in this order: bring the arm to",
            "# the first row, let it rest, play the file, and record time, positions and efforts",
            "# (or currents) of all joints. start_s is the clock of the whole session: write down",
            "# when each recording began, pauses included. Where its column of time is not called",
            '# so: [columns] time = "…"',
            'plant = "robot.toml"',
        ]
        for entry in self.schedule():
            lines += ["", "[[recordings]]"]
            lines += [f'{key} = "{entry[key]}"' for key in ("file", "role", "kind")]
            lines.append(f"start_s = {entry['start_s']}")
        return "\n".join(lines) + "\n"

    def __repr__(self) -> str:
        """A table of the signals, and how well the motion of all joints tells what is fitted."""
        total = sum(signal.duration for signal in self.signals)
        head = f"{plural(len(self.signals), 'signal')}, {total:.0f} s in all, all from home to home"
        rows = [("signal", "length / s", "moves"), *map(_row, self.signals)]
        widths = [max(len(row[k]) for row in rows) for k in range(2)]
        lines = [f"{a:<{widths[0]}}  {b:>{widths[1]}}  {c}" for a, b, c in rows]
        told = [_condition(self.excitations)] if self.excitations else []
        return "\n".join(
            [head, "", *lines, *([""] if told or self.notes else []), *told, *self.notes]
        )


def _row(signal: RobotSignal) -> tuple[str, str, str]:
    return signal.name, f"{signal.duration:.1f}", signal.joint or "all joints"


def _condition(found: Sequence[Excitation]) -> str:
    own = ", ".join(f"{one.condition:.3g}" for one in found)
    return (
        f"condition of the {found[0].parameters} base parameters, rotors and friction numbers in "
        f"the motion of all joints: {own}; random motion within the same limits has "
        f"{float(np.median([one.drawn for one in found])):.3g}"
    )
