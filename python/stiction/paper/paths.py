"""Ways through levels of force: by a law alone, or by a rotor that it holds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from .._native import FrictionModel
from ..errors import InputError
from .bench import STATES, Bench, above_0, as_record, fits, samples_of, whole_samples
from .rig import RigLike

__all__ = ["FORCE_STEP", "RAMP_RATE", "ForcePath", "motor_path"]

RAMP_RATE = 0.045  # N·m/s, ours
# Sample of a force-driven path, s. Halving it moves no position by more than 1e-5 arc-seconds.
FORCE_STEP = 2e-3
# The friction of a force-driven path is met to this, N·m.
_FORCE_TOLERANCE = 1e-15


class ForcePath:
    """A path on which the friction passes through levels of force, without a body.

    Parameters
    ----------
    law : FrictionModel
        Driven from its present state, which changes.
    levels : sequence of float
        N·m.
    ramp_rate : float
        N·m/s, from level to level.
    hold : float
        Time at a level, counted from the end of its ramp, s.
    step : float
        Duration of a sample, s; the last one of a ramp or hold is made to fit.
    start : float
        Force that the law is at, N·m.
    """

    def __init__(
        self,
        law: FrictionModel,
        levels: Sequence[float],
        *,
        ramp_rate: float = RAMP_RATE,
        hold: float = 0.0,
        step: float = FORCE_STEP,
        start: float = 0.0,
    ) -> None:
        self._law = law
        self._names = [name for name in STATES if name in law.state]
        self._rows: list[tuple[float, ...]] = []
        self._time = self._position = self._velocity = 0.0
        self.reverse_points: list[int] = []
        reached = []
        force = start
        above_0(ramp_rate, "ramp_rate", "N·m/s")
        ways = np.abs(np.diff([start, *levels]))
        fits(
            (np.sum(ways) / ramp_rate + max(hold, 0.0) * len(ways)) / above_0(step, "dt", "s"), "it"
        )
        for level in levels:
            self._through(force, float(level), abs(level - force) / ramp_rate, step)
            if hold > 0.0:
                self._through(float(level), float(level), hold, step)
            reached.append(len(self._rows) - 1)
            force = float(level)
        self.reached = np.array(reached, dtype=np.int64)

    def record(self, encoder_count: float) -> dict[str, Any]:
        """The path as the arrays of a :class:`MotionResult`."""
        time, effort, position, velocity, *states = np.array(self._rows).T
        return as_record(
            time,
            effort,
            position,
            velocity,
            dict(zip(self._names, states, strict=True)),
            encoder_count,
        )

    def _through(self, start: float, end: float, duration: float, step: float) -> None:
        steps = max(1, math.ceil(duration / step - 1e-9))
        dt = duration / steps
        if dt == 0.0:
            return
        for index in range(1, steps + 1):
            effort = start + (end - start) * index / steps
            self._velocity = self._velocity_for(effort, dt)
            self._law.commit()
            self._position += self._velocity * dt
            self._time += dt
            state = self._law.state
            self.reverse_points.append(len(state.get("reverse_points", ())))
            own = (float(state[name]) for name in self._names)
            self._rows.append((self._time, effort, self._position, self._velocity, *own))

    def _velocity_for(self, effort: float, dt: float) -> float:
        """Newton's method on the velocity; the last trial is the one to commit."""
        velocity, best = self._velocity, math.inf
        for _ in range(50):
            force, slope = self._law.trial(velocity, dt)
            excess = force - effort
            # At round-off the iterations only wander; then the next-to-last is as good.
            if abs(excess) <= _FORCE_TOLERANCE or best <= abs(excess) <= 1e-12:
                return velocity
            if not slope > 0.0:
                break
            best = abs(excess)
            velocity -= excess / slope
        raise InputError(
            f"the friction does not reach {effort:g} N·m at rest: law '{self._law.law}' slips at "
            "this level or has no slope there; give lower levels, a higher breakaway or another law"
        )


def motor_path(
    rig: RigLike,
    integrator: str,
    dt: float,
    encoder_count: float,
    levels: Sequence[float],
    ramp_rate: float,
    hold: float,
) -> tuple[dict[str, Any], np.ndarray[Any, np.dtype[np.int64]]]:
    """The motor through ramps (steps at an infinite rate) and holds; record and ends of holds."""
    bench = Bench(rig, integrator, dt, encoder_count)
    held = whole_samples(hold, dt)
    above_0(ramp_rate, "ramp_rate", "N·m/s")
    reached = []
    force = 0.0
    for level in levels:
        ramped = samples_of(abs(level - force) / ramp_rate, dt)
        ramp = force + (level - force) * np.arange(1, ramped + 1) / max(ramped, 1)
        bench.apply(np.concatenate([ramp, np.full(held, float(level))]))
        reached.append(bench.samples - 1)
        force = float(level)
    return bench.record(), np.array(reached, dtype=np.int64)
