"""The rigid links of a robot from its recordings, and each joint as a machine of one axis."""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from .._support.given import instance, whole
from .._support.progress import phase, steps
from ..errors import NotEnoughData
from ..plant import Plant
from ..recording import Recording
from ..recording.repair import FEWEST_ROWS
from ..recording.split import Split, split
from ..session import Session
from .motion import JointMotion, motion_of
from .regression import ArmFit, fit_arm, rows_of
from .session import RobotSession, Run

__all__ = ["JointSession", "RobotFit", "fit_robot"]

MOVES: Final = 0.02
"""rad or m that a joint has to move in a recording to say something of its friction."""
RESTS: Final = 0.05
"""Share of the largest travel in any recording that it has to travel as well."""

RATE: Final = 200.0
"""Rows a second of a joint's own diagnosis at least: the links are known to 20 Hz at most, and what
held in between is averaged."""
POSES: Final = 200
"""Of a recording, over which the inertia about a joint is averaged."""

_logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class RobotFit:
    """Rigid links, rotors and plain friction of a robot, fitted to what does not test.

    Attributes
    ----------
    session : RobotSession
    arm : ArmFit
    motions : tuple of JointMotion
        Of each recording.
    split : Split
        Of whole recordings where there are several.
    """

    session: RobotSession
    arm: ArmFit
    motions: tuple[JointMotion, ...]
    split: Split

    def efforts(self, run: int) -> FloatArray:
        """Efforts that the links need in a recording, rotors and friction apart.

        Parameters
        ----------
        run : int
            Its place in the session.

        Raises
        ------
        InputError
            There is no such recording; no pinocchio.

        Returns
        -------
        numpy.ndarray, shape (n, joints)
            On the even stamps of its motion, N·m or N.
        """
        run = whole(run, "RobotFit.efforts: run", least=0, most=len(self.motions) - 1)
        motion, model = self.motions[run], self.session.robot.arm
        links = self.arm.under(self.session.runs[run].payload, model.carries)
        return model.efforts(motion.position, motion.velocity, motion.acceleration, links)

    def joint(self, joint: int) -> JointSession:
        """A joint as a session of one axis, whose load is what the links need.

        A recording in which the joint rests is left out: of its friction it says nothing.

        Parameters
        ----------
        joint : int
            Its place in the robot.

        Raises
        ------
        InputError
            There is no such joint; no pinocchio.
        NotEnoughData
            It moves in none.
        """
        joint = self._place(joint)
        recordings = self.session.of_joint(joint)
        travel = np.array([np.ptp(motion.position[:, joint]) for motion in self.motions])
        moves = np.flatnonzero((travel > MOVES) & (travel > RESTS * travel.max()))
        if len(moves) == 0:
            name = self.session.robot.names[joint]
            raise NotEnoughData(f"joint '{name}' moves in no recording")
        roles = _roles(self.split, len(recordings))
        kept = [
            _loaded(
                recordings[k],
                self._loads[k][0][:, joint],
                self._loads[k][1][:, joint],
                roles[k],
                self.motions[k].ends,
            )
            for k in moves
        ]
        payloads = tuple(self.session.runs[k].payload for k in moves)
        return JointSession(Session(kept, self.plant(joint)), payloads)

    def plant(self, joint: int) -> Plant:
        """A joint as a machine of one axis, before anything is fitted to it.

        Parameters
        ----------
        joint : int
            Its place in the robot.

        Raises
        ------
        InputError
            There is no such joint; no pinocchio.
        """
        joint = self._place(joint)
        robot = self.session.robot
        own = robot.joints[joint]
        where = f"{robot.source}: joint '{own.name}'"
        return own.plant(float(self.arm.rotors[joint] + self.carried[joint]), where)

    def _place(self, joint: int) -> int:
        most = len(self.session.robot.joints) - 1
        return whole(joint, "RobotFit: joint", least=0, most=most)

    @cached_property
    def carried(self) -> FloatArray:
        """Inertia of the links about each joint, the mean over its motion, shape (joints,).

        It is the joint's own as a machine of one axis, which without it could not be simulated;
        what it differs by along the motion is in the load.
        """
        model, count = self.session.robot.arm, len(self.session.robot.joints)
        links, found = self.arm.links, []
        for motion in self.motions:
            q = motion.position[:: max(1, len(motion.time) // POSES)]
            still = np.zeros_like(q)
            rests = model.efforts(q, still, still, links)
            pushed = [
                model.efforts(q, still, still + np.eye(count)[k], links)[:, k] - rests[:, k]
                for k in range(count)
            ]
            found.append(np.mean(pushed, axis=1))
        mean: FloatArray = np.mean(found, axis=0)
        return mean

    @cached_property
    def _loads(self) -> list[tuple[FloatArray, FloatArray]]:
        """What acts on each joint, and what its gear transmits, of each recording.

        Both from one row to the next. The inertia that a joint carries is in its body, so it is in
        no load; its gear transmits what that inertia needs as well.
        """
        found = []
        for run, motion in enumerate(self.motions):
            transmitted = -self.efforts(run)
            acts = self.carried * motion.acceleration + transmitted
            found.append((_between(motion, acts), _between(motion, transmitted)))
        return found


def _between(motion: JointMotion, efforts: FloatArray) -> FloatArray:
    """Efforts on even stamps as they hold from one row to the next: the mean of both ends."""
    held = efforts.copy()
    held[:-1] = 0.5 * (held[1:] + held[:-1])
    columns = [np.interp(motion.stamps, motion.time, one) for one in held.T]
    return np.stack(columns, axis=1)


@dataclass(frozen=True)
class JointSession:
    """A joint as a session of one axis, and the payload of each of its recordings, kg."""

    session: Session
    payloads: tuple[float, ...]


def fit_robot(session: RobotSession) -> RobotFit:
    """Fit the rigid links of a robot to all joints together.

    Base parameters are told by a rank-revealing QR; the links are those that can exist and leave
    least. Joints are weighted by what each leaves. Rows that test are not seen. Beside plain
    friction each joint has friction that grows with what its gear transmits, by the links that a
    first fit without it found.

    Parameters
    ----------
    session : RobotSession

    Raises
    ------
    InputError
        No pinocchio, a URDF that it cannot read.
    NotEnoughData
        A joint that never moves.
    """
    instance(session, RobotSession, "fit_robot: session", "what load_session returns")
    arm = session.robot.arm
    phase(_logger, "moving the links along what was measured")
    dealt = split(session.of_joint(0))
    gains = np.array([joint.effort_per_input for joint in session.robot.joints])
    motions, rows = [], []
    for index, run in enumerate(steps(session.runs, "recording")):
        motion = motion_of(run.joints)
        motions.append(motion)
        free = _free(dealt, index, motion, run)
        rows.append(rows_of(arm, motion, motion.input * gains, free, run.payload))
    phase(_logger, "fitting the links")
    fit = RobotFit(session, fit_arm(arm, rows), tuple(motions), dealt)
    # Friction that grows with the load goes with the links themselves: beside plain friction alone
    # masses take a part of it. What a gear transmits hardly hangs on that part, so that once is
    # enough.
    grown = [
        one.under_load(motion, fit.efforts(run))
        for run, (one, motion) in enumerate(zip(rows, motions, strict=True))
    ]
    return replace(fit, arm=fit_arm(arm, grown))


def _free(dealt: Split, index: int, motion: JointMotion, run: Run) -> list[tuple[int, int]]:
    """Samples of a recording that do not test."""
    found = []
    for part in (*dealt.train, *dealt.select):
        if part.recording == index:
            first, last = motion.stamps[part.start], motion.stamps[part.stop - 1]
            found.append(
                (int(np.searchsorted(motion.time, first)), int(np.searchsorted(motion.time, last)))
            )
    return found


def _roles(dealt: Split, number: int) -> list[str | None]:
    """The role of each recording, where it has one as a whole."""
    roles: list[str | None] = [None] * number
    for role in ("train", "select", "test"):
        for part in getattr(dealt, role):
            whole = len(part) == dealt.lengths[part.recording]
            roles[part.recording] = role if whole else None
    return roles


def _loaded(
    recording: Recording, load: FloatArray, transmitted: FloatArray, role: str | None, ends: int
) -> Recording:
    """The recording with the load, but its ends, where no acceleration is known."""
    # As many rows as samples, which stamps that jitter hardly change.
    ends = min(ends, max(0, (len(recording) - FEWEST_ROWS) // 2))
    loaded = recording.with_load(load, transmitted).without_ends(ends)
    # A rate that clocks jitter about is still that rate.
    every = max(1, min(int(1.01 / (RATE * loaded.dt)), len(loaded) // FEWEST_ROWS))
    loaded = loaded.decimate(every)
    return loaded.with_role(role if role is not None else recording.role)
