"""A mass pulled through a spring: stick-slip, and how it ends at higher speed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .._support.arrays import FloatArray
from ..errors import InputError
from .arguments import check_arguments
from .bench import above_0, read_encoder, samples_of
from .result import MotionResult, Number
from .rig import RigLike, build_motor

__all__ = ["SLIDING", "StickSlip", "stick_slip"]

SLIDING = {"breakaway": 0.5, "coulomb": 0.35, "stribeck_velocity": 0.05, "viscous": 0.05}
"""What the hook adds to the illustrative rig; ours, since the paper ends where slip begins."""

FEWEST = 4
"""Samples: numbers are of the second half."""
# Slower than this the rotor counts as standing still, as a share of the pulling speed.
_STANDING = 0.1


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class StickSlip(MotionResult):
    """A mass pulled through a spring; ``effort`` is the torque of that spring.

    Attributes
    ----------
    speed : float
        At which the far end of the spring moves, rad/s.
    pull : numpy.ndarray, shape (n,)
        Position of the far end, rad.
    breakaways : int
        How many times the hook broke away.
    """

    speed: float
    pull: FloatArray
    breakaways: int


@check_arguments
def stick_slip(
    speed: float = 0.1,
    *,
    stiffness: float = 20.0,
    duration: float = 4.0,
    rig: RigLike = None,
    integrator: str = "reference",
    dt: float = 5e-5,
    encoder_count: float = 0.0,
) -> StickSlip:
    """Pull the rotor through a spring whose far end moves at a constant speed.

    Slow pulling sticks and slips; above a speed that depends on the viscous friction the rotor
    slides smoothly. The paper ends where slip begins; the law of sliding is a reconstruction, and
    all values are ours. Numbers are of the second half of the run.

    Parameters
    ----------
    speed : float
        Of the far end, rad/s.
    stiffness : float
        Of the pulling spring, N·m/rad.
    duration : float
        s.
    rig : mapping, FrictionModel or Motor, optional
        Nothing or a mapping: the illustrative rig with :data:`SLIDING`, then the overrides.
    integrator, dt, encoder_count
        As in :func:`stiction.paper.experiment_1`.

    Returns
    -------
    StickSlip

    Raises
    ------
    InputError
        A rig that cannot be built, or a speed that is not above 0.

    Examples
    --------
    >>> stick_slip(1.0).numbers["share of time standing still"].value
    0.0
    """
    above_0(speed, "stick_slip: speed", "rad/s")
    if rig is None or isinstance(rig, Mapping):
        rig = {**SLIDING, **(rig or {})}
    motor = build_motor(rig, integrator)
    steps = samples_of(duration, dt)
    if steps < FEWEST:
        raise InputError(f"stick_slip: {steps} samples in {duration:g} s; give {FEWEST} or more")
    position, velocity = np.empty(steps), np.empty(steps)
    x = v = 0.0
    early = 0
    step = motor.step
    for index in range(steps):
        # The spring's force at the middle of the sample, to second order.
        load = stiffness * (speed * (index + 0.5) * dt - (x + 0.5 * v * dt))
        x, v = step(0.0, dt, load=load)
        position[index], velocity[index] = x, v
        if index + 1 == steps // 2:
            early = motor.statistics.get("breakaways", 0)
    time = np.asarray(dt * np.arange(1, steps + 1), dtype=np.float64)
    pull = np.asarray(speed * time)
    effort = stiffness * (pull - position)
    late = slice(steps // 2, None)
    standing = np.abs(velocity[late]) < _STANDING * speed
    breakaways = motor.statistics.get("breakaways", 0)
    numbers = {
        "greatest torque of the spring": Number(float(effort[late].max()), "N·m"),
        "least torque of the spring": Number(float(effort[late].min()), "N·m"),
        "share of time standing still": Number(float(standing.mean()), "1"),
        "break-aways": Number(float(breakaways - early), "1"),
    }
    return StickSlip(
        title=f"Rotor pulled through a spring at {speed:g} rad/s",
        source="beyond the paper: its hook, our law of sliding",
        shows="Where friction falls as speed rises, slow pulling sticks and slips; fast "
        "pulling slides.",
        numbers=numbers,
        speed=speed,
        pull=pull,
        breakaways=breakaways,
        time=time,
        effort=effort,
        position=position,
        velocity=velocity,
        measured=read_encoder(position, encoder_count),
        states={},
    )
