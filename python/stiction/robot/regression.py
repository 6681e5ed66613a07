"""All joints of an arm in one regression: base parameters, rotors, and plain friction."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from .._support.wording import commas
from ..errors import NotEnoughData
from .consistency import consistent, exist, feasible
from .dynamics import PER_LINK, Arm
from .motion import JointMotion

__all__ = ["PLAIN", "ArmFit", "Rows", "fit_arm", "rows_of"]

PLAIN: Final = ("viscous", "coulomb", "bias")
"""Friction of a joint beside which its structure is measured, and its links are first fitted."""
STANDS: Final = 0.02
"""Share of a joint's usual speed below which nothing tells which way its friction acts."""
RANK: Final = 1e-4
"""Share of the largest column that a base parameter adds at least to what those before it do."""
ROUNDS: Final = 6
"""Times that joints are weighted by what they leave."""
SETTLED: Final = 1e-3


@dataclass(frozen=True)
class Rows:
    """What one recording says of each joint, thinned.

    Attributes
    ----------
    links : numpy.ndarray, shape (joints, n, links · 10)
    rotor : numpy.ndarray, shape (n, joints)
        Its acceleration.
    friction : numpy.ndarray, shape (joints, n, 3 or 4)
        Velocity, direction and 1; then what the gear transmits, to either side, in that direction.
    effort : numpy.ndarray, shape (n, joints)
    used : numpy.ndarray of bool, shape (n, joints)
        Where the joint moves, and the row may be fitted to.
    payload : float
        That hangs on the last link, kg; 0 for none.
    """

    links: FloatArray
    rotor: FloatArray
    friction: FloatArray
    effort: FloatArray
    used: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]
    payload: float

    def under_load(self, motion: JointMotion, transmitted: FloatArray) -> Rows:
        """The same with friction that may grow with what the gears transmit.

        Parameters
        ----------
        motion : JointMotion
            That the rows were made of.
        transmitted : numpy.ndarray, shape (n, joints)
            On its even stamps.
        """
        grows = motion.filter(np.abs(transmitted) * np.sign(motion.velocity))
        plain = self.friction[:, :, : len(PLAIN)]
        return replace(self, friction=np.concatenate([plain, grows.T[:, :, None]], axis=2))


@dataclass(frozen=True)
class ArmFit:
    """Inertial parameters of an arm, and plain friction of each joint.

    Attributes
    ----------
    links : numpy.ndarray, shape (links · 10,)
        Of links that can exist.
    payloads : mapping of float to numpy.ndarray, shape (10,)
        What hangs on the last link, by the mass that its recordings state.
    rotors : numpy.ndarray, shape (joints,)
        kg·m² or kg on the joint's side.
    friction : numpy.ndarray, shape (joints, 3)
        Viscous, Coulomb and bias.
    by_load : numpy.ndarray, shape (joints,)
        Friction per effort that the gear transmits; 0 where it was not fitted.
    left : numpy.ndarray, shape (joints,)
        rms of what each joint leaves, N·m or N.
    base : int
        Numbers of the links and rotors that the motion tells.
    impossible : tuple of int
        Links, from 0, that free base parameters would need and that cannot exist.
    cost : float
        Share by which links that can exist leave more than free base parameters.
    """

    links: FloatArray
    payloads: Mapping[float, FloatArray]
    rotors: FloatArray
    friction: FloatArray
    by_load: FloatArray
    left: FloatArray
    base: int
    impossible: tuple[int, ...]
    cost: float

    def under(self, payload: float, carries: int) -> FloatArray:
        """Parameters of the links of a recording with a payload."""
        if payload not in self.payloads:
            return self.links
        found = self.links.copy()
        found[PER_LINK * carries : PER_LINK * (carries + 1)] += self.payloads[payload]
        return found


def rows_of(
    arm: Arm,
    motion: JointMotion,
    effort: FloatArray,
    free: Sequence[tuple[int, int]],
    payload: float,
) -> Rows:
    """What a recording says.

    Parameters
    ----------
    arm : Arm
    motion : JointMotion
    effort : numpy.ndarray, shape (n, joints)
        Of the drives.
    free : sequence of (int, int)
        Samples that may be fitted to, from and to.
    payload : float
        kg.
    """
    # The motion has gone through the low pass: what its links need has too, nearly.
    thin = slice(None, None, motion.every)
    q, v, a = (x[thin] for x in (motion.position, motion.velocity, motion.acceleration))
    links = arm.regressor(q, v, a)
    moving = np.abs(motion.velocity) > STANDS * np.sqrt(np.mean(motion.velocity**2, axis=0))
    moving &= np.ptp(motion.position, axis=0) > 1e-3
    direction = np.sign(motion.velocity)
    passed = np.stack([motion.velocity, direction, np.ones_like(direction)], axis=-1)
    passed = _as_kept(motion, passed.transpose(1, 0, 2))
    allowed = np.zeros(len(motion.time), dtype=bool)
    for start, stop in free:
        allowed[start:stop] = True
    allowed[: motion.ends] = allowed[-motion.ends :] = False
    still = motion.filter((~moving).astype(float)) > 0.05
    return Rows(
        links,
        motion.filter(motion.acceleration),
        passed,
        motion.filter(effort),
        ~still & allowed[thin, None],
        payload,
    )


def _as_kept(motion: JointMotion, values: FloatArray) -> FloatArray:
    return np.stack([motion.filter(one) for one in values])


def fit_arm(arm: Arm, rows: Sequence[Rows]) -> ArmFit:
    """Fit links, rotors and plain friction of all joints together.

    Parameters
    ----------
    arm : Arm
    rows : sequence of Rows
        Of each recording.

    Raises
    ------
    NotEnoughData
        A joint that never moves.
    """
    joints, payloads = len(arm.names), sorted({one.payload for one in rows} - {0.0})
    systems = [_system(arm, rows, joint, payloads) for joint in range(joints)]
    never = [name for name, (left, _) in zip(arm.names, systems, strict=True) if len(left) < 50]
    if never:
        raise NotEnoughData(f"{commas(never)} moves in no row that is fitted to")
    kinds = rows[0].friction.shape[-1]
    own = systems[0][0].shape[1] - kinds * joints
    known = np.concatenate([feasible(arm.prior), *(_hanging(mass) for mass in payloads)])
    begin = np.concatenate([known, np.full(joints, _rotor(arm))])
    weights = np.ones(joints)
    counts = np.array([len(right) for _, right in systems])
    packed = [_packed(left, right) for left, right in systems]
    weights = np.array(
        [1.0 / max(_alone(one, n), 1e-12) for one, n in zip(packed, counts, strict=True)]
    )
    for _ in range(ROUNDS):
        stack = np.vstack([w * one for w, one in zip(weights, packed, strict=True)])
        left, right = stack[:, :-1], stack[:, -1]
        reduced, target, back = _without(left, right, own)
        place, free = base_parameters(reduced, target, begin)
        found, _ = consistent(reduced, target, begin, joints)
        whole = np.concatenate([found, back(found)])
        left_over = np.array(
            [
                np.sqrt(np.sum((one[:, :-1] @ whole - one[:, -1]) ** 2) / n)
                for one, n in zip(packed, counts, strict=True)
            ]
        )
        settled = np.all(np.abs(left_over * weights - 1.0) < SETTLED)
        weights = 1.0 / np.maximum(left_over, 1e-12)
        if settled:
            break
    links, friction = len(arm.prior), whole[own:].reshape(joints, kinds)
    least = float(np.sum((left @ np.concatenate([free, back(free)]) - right) ** 2))
    spent = float(np.sum((left @ whole - right) ** 2))
    return ArmFit(
        found[:links],
        {
            mass: found[links + PER_LINK * k : links + PER_LINK * (k + 1)]
            for k, mass in enumerate(payloads)
        },
        found[own - joints :],
        friction[:, : len(PLAIN)],
        friction[:, len(PLAIN)] if kinds > len(PLAIN) else np.zeros(joints),
        left_over,
        len(place),
        tuple(k for k, fine in enumerate(exist(free[: own - joints])) if not fine),
        spent / least - 1.0 if least > 0.0 else 0.0,
    )


def base_parameters(
    left: FloatArray, right: FloatArray, prior: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Columns that the data tell, by rank-revealing QR, and the least squares with these alone.

    Gautier & Khalil, IEEE Trans. Robotics Autom. 6 (1990), 368-373: what the others do is done by
    combinations of these; they stay at the prior.

    Returns
    -------
    numpy.ndarray of int
        The columns.
    numpy.ndarray, shape (p,)
    """
    from scipy.linalg import qr, solve_triangular

    size = np.sqrt(np.sum(left**2, axis=0))
    size[size == 0.0] = 1.0
    q, r, order = qr(left / size, mode="economic", pivoting=True)
    steps = np.abs(np.diag(r))
    rank = int(np.sum(steps > RANK * steps[0])) if len(steps) else 0
    told = order[:rank]
    missed = q[:, :rank].T @ (right - left @ prior)
    found = prior.copy()
    found[told] += solve_triangular(r[:rank, :rank], missed) / size[told]
    return told, found


def _system(
    arm: Arm, rows: Sequence[Rows], joint: int, payloads: Sequence[float]
) -> tuple[FloatArray, FloatArray]:
    """Columns (links, payloads, rotors, friction) and efforts of one joint."""
    joints, parts, efforts = len(arm.names), [], []
    last = slice(PER_LINK * arm.carries, PER_LINK * (arm.carries + 1))
    for one in rows:
        used = one.used[:, joint]
        links = one.links[joint, used]
        hangs = np.zeros((len(links), PER_LINK * len(payloads)))
        for k, mass in enumerate(payloads):
            if one.payload == mass:
                hangs[:, PER_LINK * k : PER_LINK * (k + 1)] = links[:, last]
        rotor = np.zeros((len(links), joints))
        rotor[:, joint] = one.rotor[used, joint]
        kinds = one.friction.shape[-1]
        friction = np.zeros((len(links), kinds * joints))
        friction[:, kinds * joint : kinds * (joint + 1)] = one.friction[joint, used]
        parts.append(np.hstack([links, hangs, rotor, friction]))
        efforts.append(one.effort[used, joint])
    return np.vstack(parts), np.concatenate(efforts)


def _packed(left: FloatArray, right: FloatArray) -> FloatArray:
    """As few rows that say the same: the triangle of a QR."""
    triangle = np.linalg.qr(np.column_stack([left, right]), mode="r")
    return np.asarray(triangle, dtype=float)


def _alone(packed: FloatArray, count: int) -> float:
    """What a joint leaves where it has links of its own."""
    left, right = packed[:, :-1], packed[:, -1]
    best = np.linalg.lstsq(left, right, rcond=RANK)[0]
    return float(np.sqrt(np.sum((left @ best - right) ** 2) / max(count, 1)))


def _without(
    left: FloatArray, right: FloatArray, own: int
) -> tuple[FloatArray, FloatArray, Callable[[FloatArray], FloatArray]]:
    """The system without friction, whose best values go with whatever the links are."""
    q = np.linalg.qr(left[:, own:])[0]
    base, rest = left[:, :own], left[:, own:]

    def back(x: FloatArray) -> FloatArray:
        return np.asarray(np.linalg.lstsq(rest, right - base @ x, rcond=None)[0], dtype=float)

    return base - q @ (q.T @ base), right - q @ (q.T @ right), back


def _rotor(arm: Arm) -> float:
    """Where the fit of a rotor begins: a hundredth of a usual link's inertia."""
    inertias = arm.prior.reshape(-1, PER_LINK)[:, [4, 6, 9]]
    return 0.01 * max(float(np.max(np.abs(inertias))), 1e-6)


def _hanging(mass: float) -> FloatArray:
    """A payload before anything is known of it: a ball of 5 cm at the last frame."""
    own = 0.4 * mass * 0.05**2
    return np.array([mass, 0.0, 0.0, 0.0, own, 0.0, own, 0.0, 0.0, own])
