"""Drive gains that the masses of a URDF would have: a guess, where nobody states them."""

from __future__ import annotations

from typing import Final

import numpy as np

from .motion import motion_of
from .regression import Rows, rows_of
from .session import RobotSession

__all__ = ["gains_of"]

SURE: Final = 20.0
"""Standard errors that the effort of the links has to stand above 0: what moves light links tells
of friction first of all, and less sure ones were wrong by a factor of four."""
ALIKE_S: Final = 1.0
"""Rows closer than this say the same."""


def gains_of(session: RobotSession) -> list[float | None]:
    """Effort per unit of input with which the links of the URDF move as measured.

    Parameters
    ----------
    session : RobotSession
        With gains of 1.

    Returns
    -------
    list of float or None
        One for each joint; None where the motion does not tell.

    Raises
    ------
    InputError
        As for ``Arm``.
    """
    arm = session.robot.arm
    rows: list[Rows] = []
    spacing = []
    for run in session.runs:
        motion = motion_of(run.joints)
        spacing.append(motion.dt * motion.every)
        everything = [(0, len(motion.time))]
        rows.append(rows_of(arm, motion, motion.input, everything, run.payload))
    # What hangs on the last link is in no URDF.
    bare = [one for one in rows if one.payload == 0.0] or rows
    alike = max(1.0, ALIKE_S / float(np.median(spacing)))
    return [_gain(bare, arm.prior, joint, alike) for joint in range(len(arm.names))]


def _gain(rows: list[Rows], prior: np.ndarray, joint: int, alike: float) -> float | None:
    lefts, rights = [], []
    for one in rows:
        used = one.used[:, joint]
        links = one.links[joint, used] @ prior
        lefts.append(np.column_stack([links, one.rotor[used, joint], one.friction[joint, used]]))
        rights.append(one.effort[used, joint])
    left, right = np.vstack(lefts), np.concatenate(rights)
    if len(left) <= alike * left.shape[1] or np.linalg.matrix_rank(left) < left.shape[1]:
        return None
    found = np.linalg.lstsq(left, right, rcond=None)[0]
    missed = right - left @ found
    error = np.sqrt(np.mean(missed**2) * alike * np.linalg.inv(left.T @ left)[0, 0])
    return float(1.0 / found[0]) if found[0] > SURE * error else None
