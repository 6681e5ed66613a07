"""The test bench: drives a rig and records what it does."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from .._support.arrays import FloatArray
from ..errors import InputError
from .rig import RigLike, build_motor

__all__ = ["STATES", "Bench", "above_0", "fits", "read_encoder", "samples_of", "whole_samples"]

MOST_SAMPLES: Final = 10_000_000
"""Of an experiment: a gigabyte, and some minutes."""

STATES = ("plastic", "hardening", "spring", "spring_force")
"""States of a law that an experiment records, where the law has them."""


class Bench:
    """A rig at rest, driven by torque sample after sample, with everything recorded.

    Parameters
    ----------
    rig : RigLike
        See :data:`stiction.paper.RigLike`.
    integrator : {"reference", "fast"}
    dt : float
        Duration of a sample, s.
    encoder_count : float
        Count of the encoder that is read, rad; 0 reads the position itself.
    """

    def __init__(self, rig: RigLike, integrator: str, dt: float, encoder_count: float) -> None:
        if not (math.isfinite(dt) and dt > 0.0):
            raise InputError(f"dt = {dt} is no duration; give seconds above 0")
        if not (math.isfinite(encoder_count) and encoder_count >= 0.0):
            raise InputError(
                f"encoder_count = {encoder_count} is no count; give radians, or 0 for none"
            )
        self.motor = build_motor(rig, integrator)
        self.dt = dt
        self.encoder_count = encoder_count
        self.samples = 0
        self._torque_constant = float(self.motor.settings()["torque_constant"])
        available = self.motor.output_names
        self._outputs = ["position", "velocity", *(n for n in STATES if n in available)]
        self._efforts: list[FloatArray] = []
        self._columns: dict[str, list[FloatArray]] = {name: [] for name in self._outputs}

    @property
    def time(self) -> float:
        """s since the start."""
        return self.samples * self.dt

    @property
    def reading(self) -> float:
        """Position as the encoder reads it now, rad."""
        recorded = self._columns["position"]
        return float(read_encoder(recorded[-1][-1], self.encoder_count)) if recorded else 0.0

    def apply(self, efforts: FloatArray) -> None:
        """Apply one torque a sample, N·m."""
        run = self.motor.simulate(efforts / self._torque_constant, self.dt, outputs=self._outputs)
        for name, values in run.columns.items():
            self._columns[name].append(values)
        self._efforts.append(efforts)
        self.samples += len(efforts)

    def hold(self, effort: float, duration: float) -> None:
        """Hold a torque (N·m) for a duration (s)."""
        self.apply(np.full(whole_samples(duration, self.dt), effort))

    def record(self) -> dict[str, Any]:
        """All that was recorded, as the arrays of a :class:`MotionResult`."""
        columns = {name: np.concatenate(pieces) for name, pieces in self._columns.items()}
        return as_record(
            np.asarray(self.dt * np.arange(1, self.samples + 1), dtype=np.float64),
            np.concatenate(self._efforts),
            columns.pop("position"),
            columns.pop("velocity"),
            columns,
            self.encoder_count,
        )


def as_record(
    time: FloatArray,
    effort: FloatArray,
    position: FloatArray,
    velocity: FloatArray,
    states: Mapping[str, FloatArray],
    encoder_count: float,
) -> dict[str, Any]:
    """The arrays of a :class:`MotionResult` by name."""
    return {
        "time": time,
        "effort": effort,
        "position": position,
        "velocity": velocity,
        "measured": read_encoder(position, encoder_count),
        "states": dict(states),
    }


def read_encoder(position: FloatArray, count: float) -> FloatArray:
    """Position to the nearest encoder count; as it is where the count is 0."""
    return np.asarray(np.round(position / count) * count if count > 0.0 else position)


def above_0(value: float, where: str, unit: str) -> float:
    """Refuse what is not above 0."""
    if not value > 0.0:
        raise InputError(f"{where} = {value:g} {unit}; give more than 0")
    return value


def fits(samples: float, what: str) -> int:
    """Refuse more samples than an experiment has room for."""
    if not samples <= MOST_SAMPLES:
        raise InputError(
            f"{what} takes {samples:.3g} samples, and {MOST_SAMPLES} is the most; give a longer dt "
            "or a shorter experiment"
        )
    return round(samples)


def samples_of(duration: float, dt: float) -> int:
    """Number of samples in a duration, to the nearest."""
    if not duration >= 0.0:
        raise InputError(f"a duration is {duration:g} s; give 0 or more")
    # Of two floats above 0 the greatest quotient is inf, and no error.
    return fits(float(np.divide(duration, above_0(dt, "dt", "s"))), f"{duration:g} s")


def whole_samples(duration: float, dt: float) -> int:
    """Number of samples in a duration, which must be a whole number of them."""
    samples = samples_of(duration, dt)
    if samples < 1 or abs(samples * dt - duration) > 1e-6 * dt * max(samples, 1):
        raise InputError(
            f"dt = {dt:g} s does not divide {duration:g} s of the experiment; "
            "give one that does, for instance 5e-5"
        )
    return samples
