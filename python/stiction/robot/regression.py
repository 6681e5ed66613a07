"""All joints of an arm in one regression: base parameters, rotors, and plain friction."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from ..errors import NotEnoughData
from ..trajectory import FloatArray
from ..wording import listed
from .consistency import consistent, exist, feasible
from .dynamics import PER_LINK, Arm
from .motion import JointMotion

__all__ = ["PLAIN", "ArmFit", "Rows", "fitted", "rows_of"]

PLAIN: Final = ("viscous", "coulomb", "bias")
"""Friction of a joint beside which its structure is measured."""
SHAPES: Final = 3
"""Columns of friction beside the plain ones: with the square of the speed, above it at low speeds,
and with the load. Without them what friction does beyond its plain form is taken for a mass."""
SLOW: Final = 0.3
"""Share of a joint's usual speed in which friction that falls with the speed has fallen."""
LOADS: Final = 2
"""Times that links are fitted: first with the loads that the URDF has, then with those found."""
STANDS: Final = 0.02
"""Share of a joint's usual speed below which nothing tells which way its friction acts."""
RANK: Final = 1e-4
"""Share of the largest column that a base parameter adds at least to what those before it do."""
FRICTION_RANK: Final = 1e-6
"""Likewise of the columns of friction."""
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
    friction : numpy.ndarray, shape (joints, n, 3)
        Velocity, direction and 1.
    bent : numpy.ndarray, shape (joints, n, 2)
        Square of the velocity and what falls with it, each in its direction.
    effort : numpy.ndarray, shape (n, joints)
    used : numpy.ndarray of bool, shape (n, joints)
        Where the joint moves, and the row may be fitted to.
    payload : float
        That hangs on the last link, kg; 0 for none.
    """

    links: FloatArray
    rotor: FloatArray
    friction: FloatArray
    bent: FloatArray
    effort: FloatArray
    used: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]
    payload: float


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
    usual = np.sqrt(np.mean(motion.velocity**2, axis=0))
    moving = np.abs(motion.velocity) > STANDS * usual
    moving &= np.ptp(motion.position, axis=0) > 1e-3
    direction = np.sign(motion.velocity)
    passed = np.stack([motion.velocity, direction, np.ones_like(direction)], axis=-1)
    passed = _as_kept(motion, passed.transpose(1, 0, 2))
    fast = np.abs(motion.velocity)
    falls = direction * np.exp(-fast / np.maximum(SLOW * usual, 1e-300))
    bent = np.stack([motion.velocity * fast, falls], axis=-1)
    bent = _as_kept(motion, bent.transpose(1, 0, 2))
    allowed = np.zeros(len(motion.time), dtype=bool)
    for start, stop in free:
        allowed[start:stop] = True
    allowed[: motion.ends] = allowed[-motion.ends :] = False
    still = motion.passed((~moving).astype(float)) > 0.05
    return Rows(
        links,
        motion.passed(motion.acceleration),
        passed,
        bent,
        motion.passed(effort),
        ~still & allowed[thin, None],
        payload,
    )


def _as_kept(motion: JointMotion, values: FloatArray) -> FloatArray:
    return np.stack([motion.passed(one) for one in values])


def fitted(arm: Arm, rows: Sequence[Rows]) -> ArmFit:
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
    never = [
        name for k, name in enumerate(arm.names) if sum(one.used[:, k].sum() for one in rows) < 50
    ]
    if never:
        raise NotEnoughData(f"{listed(never)} moves in no row that is fitted to")
    known = np.concatenate([feasible(arm.prior), *(_hanging(mass) for mass in payloads)])
    begin = np.concatenate([known, np.full(joints, _rotor(arm))])
    own = len(begin)
    found = begin
    for _ in range(LOADS):
        packed, counts = _systems(arm, rows, payloads, found)
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
    plain = [_plain(one, found, joint) for joint, one in enumerate(packed)]
    links = len(arm.prior)
    least = float(np.sum((left @ np.concatenate([free, back(free)]) - right) ** 2))
    spent = float(np.sum((left @ whole - right) ** 2))
    return ArmFit(
        found[:links],
        {
            mass: found[links + PER_LINK * k : links + PER_LINK * (k + 1)]
            for k, mass in enumerate(payloads)
        },
        found[own - joints :],
        np.array([friction for friction, _ in plain]),
        np.array([rest / np.sqrt(n) for (_, rest), n in zip(plain, counts, strict=True)]),
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


def _systems(
    arm: Arm, rows: Sequence[Rows], payloads: Sequence[float], found: FloatArray
) -> tuple[list[FloatArray], list[int]]:
    """The packed rows of each joint with the loads of some links, and how many they were."""
    systems = [_system(arm, rows, joint, payloads, found) for joint in range(len(arm.names))]
    return [_packed(left, right) for left, right in systems], [len(right) for _, right in systems]


def _system(
    arm: Arm, rows: Sequence[Rows], joint: int, payloads: Sequence[float], found: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Columns (links, payloads, rotors, friction) and efforts of one joint."""
    joints, parts, efforts = len(arm.names), [], []
    last = slice(PER_LINK * arm.carries, PER_LINK * (arm.carries + 1))
    each = len(PLAIN) + SHAPES
    for one in rows:
        used = one.used[:, joint]
        links = one.links[joint, used]
        hangs = np.zeros((len(links), PER_LINK * len(payloads)))
        for k, mass in enumerate(payloads):
            if one.payload == mass:
                hangs[:, PER_LINK * k : PER_LINK * (k + 1)] = links[:, last]
        rotor = np.zeros((len(links), joints))
        rotor[:, joint] = one.rotor[used, joint]
        load = np.abs(np.hstack([links, hangs]) @ found[: len(found) - joints])
        friction = np.zeros((len(links), each * joints))
        direction = one.friction[joint, used, PLAIN.index("coulomb")]
        friction[:, each * joint : each * (joint + 1)] = np.column_stack(
            [one.friction[joint, used], one.bent[joint, used], load * direction]
        )
        parts.append(np.hstack([links, hangs, rotor, friction]))
        efforts.append(one.effort[used, joint])
    return np.vstack(parts), np.concatenate(efforts)


def _plain(packed: FloatArray, found: FloatArray, joint: int) -> tuple[FloatArray, float]:
    """Plain friction of a joint beside links that are found, and the 2-norm of what is left."""
    first = len(found) + (len(PLAIN) + SHAPES) * joint
    columns = packed[:, first : first + len(PLAIN)]
    missed = packed[:, -1] - packed[:, : len(found)] @ found
    friction: FloatArray = np.asarray(np.linalg.lstsq(columns, missed, rcond=None)[0], dtype=float)
    return friction, float(np.linalg.norm(missed - columns @ friction))


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
    base, rest = left[:, :own], left[:, own:]
    size = np.sqrt(np.sum(rest**2, axis=0))
    directions, shares, _ = np.linalg.svd(
        rest / np.where(size > 0.0, size, 1.0), full_matrices=False
    )
    # A column that says what others do takes nothing away of its own.
    q = directions[:, shares > FRICTION_RANK * shares[0]]

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
