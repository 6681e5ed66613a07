"""Parameters read off recorded curves one after the other, before any simulation.

The order of the paper's section 4 as far as it worked on a prototype: the branch curve G from loops
below the hardened level, f from the ends of holds, α from creep, inertia and damper from a ring.
Each step needs those before it; what a step lacks is left out.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np

from .._support.arrays import FloatArray

__all__ = ["Recorded", "Steps", "branch_curve", "read_off"]

_LEAST_HOLD: Final = 0.3  # s
_RUNG: Final = 0.1  # s after a change of torque, in which the rotor rings
_RING: Final = 0.12  # s of a ring that are looked at
_CUT: Final = 0.02  # N·m; a drop to nothing from above this is a cut
_ENDS: Final = 0.2
"""Share of a hold over which its end is averaged."""
_HYSTERESIS: Final = 0.75
"""What the damper has of the decrement of a ring; the rest is hysteresis."""


@dataclass(frozen=True, eq=False)
class Recorded:
    """A recording from a virgin contact at rest at position 0.

    Attributes
    ----------
    dt : float
        s.
    effort : numpy.ndarray, shape (n,)
        Torque held during each sample, N·m.
    position : numpy.ndarray, shape (n,)
        As read at the end of each sample, rad.
    """

    dt: float
    effort: FloatArray
    position: FloatArray


@dataclass(frozen=True)
class Steps:
    """What each step read off; None where it had nothing to read.

    Attributes
    ----------
    branch : tuple of float or None
        k_0, k_inf (N·m/rad) and d_0 (rad).
    hardening : tuple of float or None
        c and n of f(s) = c·sⁿ.
    levels : int
        Levels of torque whose holds were used for it.
    creep_rate : float or None
        α, 1/s.
    ring : tuple of float or None
        Inertia (kg·m²) and damper (N·m·s/rad).
    """

    branch: tuple[float, float, float] | None
    hardening: tuple[float, float] | None
    levels: int
    creep_rate: float | None
    ring: tuple[float, float] | None


def read_off(records: list[Recorded]) -> Steps:
    """All steps, each over all recordings that have something for it."""
    branch = _branch(records)
    hardening, levels = _hardening(records, branch)
    return Steps(branch, hardening, levels, _creep_rate(records), _ring(records, branch))


def branch_curve(d: FloatArray, k_0: float, k_inf: float, d_0: float) -> FloatArray:
    """G(d) = k_inf·d + (k_0 − k_inf)·d_0·(1 − e^(−d/d_0))."""
    return np.asarray(k_inf * d - (k_0 - k_inf) * d_0 * np.expm1(-d / d_0))


def _holds(record: Recorded) -> Iterator[tuple[int, int]]:
    """First sample and end of each stretch of constant torque that lasts long enough."""
    changes = np.flatnonzero(np.diff(record.effort) != 0.0) + 1
    edges = [0, *changes.tolist(), len(record.effort)]
    for start, end in pairwise(edges):
        if (end - start) * record.dt >= _LEAST_HOLD:
            yield start, end


def _branches(record: Recorded) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Distance and change of torque behind each reverse point below the hardened level."""
    effort, position = record.effort, record.position
    slope = np.sign(np.diff(effort))
    moving = np.flatnonzero(slope)
    if not moving.size:
        return
    turns = moving[1:][slope[moving[1:]] != slope[moving[:-1]]]
    if not turns.size:
        return
    holds = list(_holds(record))
    for turn, following in zip(turns, [*turns[1:], len(effort) - 1], strict=True):
        held = [(s, e) for s, e in holds if e <= turn + 1]
        before = np.array([abs(effort[s]) for s, _ in held])
        if not before.size or abs(effort[turn]) > before.max() + 1e-12:
            continue
        # The reverse point is where a hold ends, so that its position is known well.
        start = next((s for s, e in held if e >= turn), None)
        if start is None:
            continue
        s = slope[turn]
        stretch = slice(turn + 1, int(following) + 1)
        ramp = np.flatnonzero(slope[stretch.start - 1 : stretch.stop - 1] == s) + turn + 1
        ramp = ramp[np.abs(effort[ramp]) <= before.max() + 1e-12]
        # A jump of torque rings; a ramp of a few samples is one.
        if len(ramp) < 20:
            continue
        window = max(1, round(0.5 * (turn + 1 - start)))
        origin = float(np.mean(position[turn + 1 - window : turn + 1]))
        yield s * (position[ramp] - origin), s * (effort[ramp] - effort[turn])


def _branch(records: list[Recorded]) -> tuple[float, float, float] | None:
    from scipy.optimize import least_squares

    pieces = [piece for record in records for piece in _branches(record)]
    if not pieces:
        return None
    d = np.concatenate([piece[0] for piece in pieces])
    force = np.concatenate([piece[1] for piece in pieces])
    far = float(np.quantile(d, 0.98))
    if not far > 0.0:
        return None
    secant = float(np.median(force[d > 0.5 * far] / d[d > 0.5 * far]))

    def residual(x: FloatArray) -> FloatArray:
        k_0 = math.exp(x[0])
        curve = branch_curve(np.maximum(d, 0.0), k_0, k_0 * _share(x[1]), math.exp(x[2]))
        return np.asarray(curve - force)

    start = [math.log(2.0 * secant), 0.0, math.log(0.5 * far)]
    found = least_squares(residual, start, max_nfev=100).x
    k_0 = math.exp(found[0])
    return k_0, k_0 * _share(found[1]), math.exp(found[2])


def _hardening(
    records: list[Recorded], branch: tuple[float, float, float] | None
) -> tuple[tuple[float, float] | None, int]:
    """c and n from what the ends of rising holds lie beyond the first loading."""
    if branch is None:
        return None, 0
    beyond: dict[float, list[float]] = {}
    for record in records:
        highest = 0.0
        for start, end in _holds(record):
            level = abs(float(record.effort[start]))
            seen = float(np.max(np.abs(record.effort[:start]), initial=0.0))
            if level > highest and level >= seen - 1e-12:
                highest = level
                window = max(1, round(_ENDS * (end - start)))
                at = abs(float(np.mean(record.position[end - window : end])))
                yielded = at - _first_loading(level, branch)
                if yielded > 0.0:
                    beyond.setdefault(round(level, 9), []).append(yielded)
    if len(beyond) < 2:
        return None, len(beyond)
    levels = np.array(sorted(beyond))
    amounts = np.array([np.mean(beyond[level]) for level in levels.tolist()])
    # Large amounts are known better than small ones.
    n, log_c = np.polyfit(np.log(levels), np.log(amounts), 1, w=amounts)
    return (math.exp(float(log_c)), max(float(n), 1.1)), len(beyond)


def _first_loading(force: float, branch: tuple[float, float, float]) -> float:
    """Displacement of the spring on Masing's first loading, G(2x)/2 = force."""
    from scipy.optimize import brentq

    far = 2.0 * force / branch[1]
    return 0.5 * float(
        brentq(lambda d: float(branch_curve(np.asarray(d), *branch)) - 2.0 * force, 0.0, far)
    )


def _creep_rate(records: list[Recorded]) -> float | None:
    """Rate of the exponential that the longest first hold of each recording follows."""
    from scipy.optimize import least_squares

    rates = []
    for record in records:
        size = np.abs(record.effort)
        highest = np.maximum.accumulate(size)
        rising = [(s, e) for s, e in _holds(record) if size[s] > 0.0 and size[s] >= highest[s]]
        if not rising:
            continue
        start, end = max(rising, key=lambda hold: hold[1] - hold[0])
        skipped = round(_RUNG / record.dt)
        x = np.abs(record.position[start + skipped : end])
        t = np.asarray(record.dt * np.arange(len(x)), dtype=np.float64)
        if len(x) < 50:
            continue

        def residual(
            p: FloatArray, t: FloatArray = t, x: FloatArray = x, scale: float = float(np.ptp(x))
        ) -> FloatArray:
            return np.asarray((p[0] - p[1] * np.exp(-math.exp(p[2]) * t)) - x) / scale

        guess = [float(x[-1]), float(np.ptp(x)), math.log(4.0 / t[-1])]
        found = least_squares(residual, guess, max_nfev=100, x_scale=[guess[1], guess[1], 1.0]).x
        rates.append(math.exp(float(np.clip(found[2], -20.0, 20.0))))
    return float(np.median(rates)) if rates else None


def _ring(
    records: list[Recorded], branch: tuple[float, float, float] | None
) -> tuple[float, float] | None:
    """Inertia from the frequency, damper from the decrement, of the first ring after a cut."""
    from scipy.optimize import least_squares

    if branch is None:
        return None
    for record in records:
        drop = np.flatnonzero((np.abs(record.effort[:-1]) > _CUT) & (record.effort[1:] == 0.0))
        if not drop.size:
            continue
        samples = round(_RING / record.dt)
        x = record.position[drop[0] + 1 : drop[0] + 1 + samples]
        if len(x) < samples:
            continue
        t = np.asarray(record.dt * np.arange(1, len(x) + 1), dtype=np.float64)
        rest = x - np.mean(x[len(x) // 2 :])
        spectrum = np.abs(np.fft.rfft(rest, 8 * len(x)))
        omega = 2.0 * math.pi * float(np.argmax(spectrum[4:]) + 4) / (8 * len(x) * record.dt)

        def residual(p: FloatArray, t: FloatArray = t, x: FloatArray = x) -> FloatArray:
            swing = p[1] * np.cos(p[3] * t) + p[2] * np.sin(p[3] * t)
            return np.asarray(p[0] + np.exp(-p[4] * t) * swing - x) * 1e5

        size = float(np.ptp(x)) / 2.0
        guess = [float(np.mean(x)), size, 0.0, omega, 30.0]
        scale = [size, size, size, omega, 30.0]
        found = least_squares(residual, guess, x_scale=scale, max_nfev=200).x
        stiffness = 0.9 * branch[0]
        inertia = stiffness / float(found[3]) ** 2
        damper = 2.0 * inertia * float(found[4]) * _HYSTERESIS
        return inertia, max(damper, 1e-3 * stiffness / omega)
    return None


def _share(x: float) -> float:
    """A number between 0 and 1 from any."""
    return 1.0 / (1.0 + math.exp(-x))
