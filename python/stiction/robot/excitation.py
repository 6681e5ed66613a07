"""Motion of all joints by which inertial parameters and friction are told apart.

Finite Fourier series (Swevers et al., IEEE Trans. Robotics Autom. 13 (1997), 730-740), each of
which begins and ends at rest at home, with coefficients that give the base-parameter regressor a
small condition number within the limits of all joints (Gautier and Khalil, Int. J. Robotics
Research 11 (1992), 362-375).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from ..errors import InputError
from .dynamics import PER_LINK, Arm
from .limits import ArmLimits
from .regression import base_parameters

__all__ = ["ArmLoad", "Excitation", "excitation"]

HARMONICS: Final = 5
PERIOD_S: Final = (5.0, 20.0)
"""Length of a period: none of its sines is above 1 Hz, and three of it are a minute."""
POINTS: Final = 100
"""Of a period, at which limits and regressor are looked at: the regressor has few harmonics."""
POSES: Final = 300
"""Random states by which base parameters are told."""
DRAWS: Final = 60
"""Random series of which the best is improved."""
TRIALS: Final = 1000
"""Steps of the search, a (1+1) evolution strategy with the 1/5 rule (Rechenberg 1973)."""
SMALLER: Final = 0.75
TRIES: Final = 16
"""Shares by which motion is made smaller until gravity leaves effort for it."""
STANDS: Final = 1e-9


@dataclass(frozen=True)
class ArmLoad:
    """What the drives of an arm bear, as far as it is known before anything is recorded.

    Attributes
    ----------
    arm : Arm
    rotors : numpy.ndarray, shape (joints,)
        kg·m² or kg at the joint.
    friction : numpy.ndarray, shape (joints,)
        Greatest friction, N·m or N: it is set aside.
    """

    arm: Arm
    rotors: FloatArray
    friction: FloatArray

    def efforts(self, q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        """Greatest effort of each joint at each row, shape (n, joints), from 0 up."""
        needed: FloatArray = np.abs(self.arm.efforts(q, v, a) + self.rotors * a) + self.friction
        return needed


@dataclass(frozen=True)
class Excitation:
    """A periodic motion of all joints from home and back.

    Attributes
    ----------
    sines, cosines : numpy.ndarray, shape (joints, harmonics)
        rad or m, about home.
    period : float
        s.
    condition : float
        Condition number of the regressor of base parameters, rotors and plain friction, rows in
        shares of the greatest efforts, columns in shares of what random states give.
    drawn : float
        The median of what random series within the same limits have.
    parameters : int
        Columns of that regressor.
    """

    sines: FloatArray
    cosines: FloatArray
    period: float
    condition: float
    drawn: float
    parameters: int

    def path(self, home: FloatArray, rate: float, periods: int) -> FloatArray:
        """Positions, shape (n, joints), from home to home.

        Parameters
        ----------
        home : numpy.ndarray, shape (joints,)
        rate : float
            Samples a second.
        periods : int
        """
        count = round(periods * self.period * rate)
        phase: FloatArray = np.linspace(0.0, float(periods), count + 1)
        moved: FloatArray = home + _series(self.sines, self.cosines, phase)[0]
        return moved


def excitation(load: ArmLoad, limits: ArmLimits, source: np.random.Generator) -> Excitation:
    """The best motion that a search finds.

    Parameters
    ----------
    load : ArmLoad
    limits : ArmLimits
    source : numpy.random.Generator

    Raises
    ------
    InputError
        A joint whose drive cannot hold the arm at home.
    """
    _holds_home(load, limits)
    search = _Search(load, limits, source)
    joints = len(limits.home)
    drawn = [source.standard_normal((joints, search.free)) for _ in range(DRAWS)]
    costs = [search.cost(one) for one in drawn]
    at = int(np.argmin(costs))
    best, cost, width = drawn[at], costs[at], 0.5
    for _ in range(TRIALS):
        other = best + width * source.standard_normal(best.shape)
        found = search.cost(other)
        if found < cost:
            best, cost, width = other, found, width * 1.5
        else:
            width = max(width * 1.5**-0.25, 1e-3)
    sized = search.scale_to_limits(best)
    if sized is None:
        raise InputError(
            "no motion of all joints together stays within these limits; widen the effort"
        )
    sines, cosines, period = sized
    finite = [one for one in costs if math.isfinite(one)]
    return Excitation(
        sines, cosines, period, math.exp(cost), math.exp(float(np.median(finite))), search.columns
    )


class _Search:
    """What a candidate is worth."""

    def __init__(self, load: ArmLoad, limits: ArmLimits, source: np.random.Generator) -> None:
        self._load, self._limits = load, limits
        self._phase = np.arange(POINTS) / POINTS
        self._within = _at_rest_at_the_ends()
        self.free = self._within.shape[1]
        self._told, self._scale = self._base(source)
        self.columns = len(self._told)

    def cost(self, drawn: FloatArray) -> float:
        """Logarithm of the condition number, infinite where nothing stays within the limits."""
        sized = self.scale_to_limits(drawn)
        if sized is None:
            return math.inf
        sines, cosines, period = sized
        q, v, a = self._motion(sines, cosines, period)
        columns = self._regressor(q, v, a)[:, self._told] / self._scale
        values = np.linalg.eigvalsh(columns.T @ columns)
        # Half of it: these are squares of the singular values.
        return 0.5 * math.log(values[-1] / max(values[0], 1e-15 * values[-1]))

    def scale_to_limits(self, drawn: FloatArray) -> tuple[FloatArray, FloatArray, float] | None:
        """Sines, cosines and period of a candidate as large and fast as the limits allow."""
        limits = self._limits
        both = drawn @ self._within.T
        sines, cosines = both[:, :HARMONICS], both[:, HARMONICS:]
        x, dx, _ = _series(sines, cosines, self._phase)
        far = np.max(np.abs(x), axis=0)
        rate = np.max(np.abs(dx), axis=0)
        share = np.minimum(limits.reach / far, PERIOD_S[1] * limits.speed / rate)
        for _ in range(TRIES):
            own = (share[:, None] * sines, share[:, None] * cosines)
            period = max(PERIOD_S[0], float(np.max(share * rate / limits.speed)))
            slower = self._slower(*own, period)
            if slower is not None:
                return (*own, slower)
            share = SMALLER * share
        return None

    def _slower(self, sines: FloatArray, cosines: FloatArray, period: float) -> float | None:
        """The shortest period from this one on at which the drives bear the motion."""
        load = self._load
        q, v, a = self._motion(sines, cosines, period)
        still = np.zeros_like(q)
        rests = load.arm.efforts(q, still, still)
        # What is not gravity goes with the square of the speed.
        moves = load.arm.efforts(q, v, a) + load.rotors * a - rests
        spare = self._limits.effort - load.friction - np.abs(rests)
        if np.any(spare <= 0.0):
            return None
        slower = period * max(1.0, math.sqrt(float(np.max(np.abs(moves) / spare))))
        return slower if slower <= PERIOD_S[1] * (1.0 + 1e-9) else None

    def _motion(
        self, sines: FloatArray, cosines: FloatArray, period: float
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        x, dx, ddx = _series(sines, cosines, self._phase)
        return self._limits.home + x, dx / period, ddx / period**2

    def _regressor(self, q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        """Columns (links, rotors, friction), rows of all joints in shares of their efforts."""
        joints = q.shape[1]
        links = self._load.arm.regressor(q, v, a)
        parts = []
        for k in range(joints):
            own = np.zeros((len(q), 4 * joints))
            own[:, k] = a[:, k]
            first = joints + 3 * k
            own[:, first : first + 3] = np.stack([v[:, k], np.sign(v[:, k]), np.ones(len(q))], 1)
            parts.append(np.hstack([links[k], own]) / self._limits.effort[k])
        return np.vstack(parts)

    def _base(self, source: np.random.Generator) -> tuple[FloatArray, FloatArray]:
        """Columns that any motion tells, and their size at random states."""
        limits = self._limits
        spread = source.uniform(-1.0, 1.0, (3, POSES, len(limits.home)))
        q = limits.home + limits.reach * spread[0]
        v = limits.speed * spread[1]
        # As fast as sines of a second change.
        columns = self._regressor(q, v, 2.0 * math.pi * limits.speed * spread[2])
        told, _ = base_parameters(columns, np.zeros(len(columns)), np.zeros(columns.shape[1]))
        assert len(told) <= PER_LINK * self._load.arm.links + 4 * len(limits.home)
        return told, np.sqrt(np.mean(columns[:, told] ** 2, axis=0))


def _holds_home(load: ArmLoad, limits: ArmLimits) -> None:
    still = np.zeros((1, len(limits.home)))
    needed = load.efforts(limits.home[None, :], still, still)[0]
    for name, own, most in zip(load.arm.names, needed, limits.effort, strict=True):
        if own >= most:
            raise InputError(
                f"joint '{name}': friction and gravity take {own:.3g} in the middle of the "
                f"positions, and {most:.3g} is planned for; raise its effort, or move the box of "
                "positions with limits.position"
            )


def _series(
    sines: FloatArray, cosines: FloatArray, phase: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Positions about home and their derivatives by the phase, each of shape (n, joints)."""
    turns = 2.0 * math.pi * np.arange(1, sines.shape[1] + 1)
    at = phase[:, None] * turns
    s, c = np.sin(at), np.cos(at)
    return (
        s @ sines.T + c @ cosines.T,
        (c * turns) @ sines.T - (s * turns) @ cosines.T,
        -(s * turns**2) @ sines.T - (c * turns**2) @ cosines.T,
    )


def _at_rest_at_the_ends() -> FloatArray:
    """Sines and cosines that begin at 0 without speed and acceleration, shape (2·h, free)."""
    from scipy.linalg import null_space

    orders = np.arange(1, HARMONICS + 1)
    none, ones = np.zeros(HARMONICS), np.ones(HARMONICS)
    ends = np.array([[*none, *ones], [*orders, *none], [*none, *orders**2]])
    # In shares of the order: each sine is drawn with about the same speed.
    size = np.concatenate([1.0 / orders, 1.0 / orders])
    found: FloatArray = size[:, None] * null_space(ends * size)
    return found
