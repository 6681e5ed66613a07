"""A motion near a measured one that a plant makes by itself."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from .._support.arrays import FloatArray
from ..errors import InputError

if TYPE_CHECKING:
    from ..plant import Plant
    from .weak_form import Start, WeakForm

__all__ = ["nearby_motion"]

PULL_RATE: Final = 10.0
"""Rate at which a run is drawn back to the measured motion, over the support of the kernel: fast
enough to stay within counts of it, slow enough that the counts do not shake it."""
MOVED: Final = 4.0
"""Counts, or as much noise, that a motion goes in the time constant of that rate where it does not
begin at rest."""
STEADY: Final = 0.3
"""Most that this rate may be over one sample; a sampled spring gets unstable at 2."""


def nearby_motion(
    form: WeakForm,
    plant: Plant,
    start: Start = None,
    *,
    position: FloatArray | None = None,
    load: FloatArray | None = None,
    rate: float | None = None,
) -> tuple[FloatArray, FloatArray]:
    """A motion near the measured one that the plant makes by itself, and what that took.

    One simulation over the whole recording, drawn to the measured motion by a critically damped
    spring.

    Parameters
    ----------
    form : WeakForm
    plant : Plant
    start : dict, optional
        Friction state at the first row.
    position : numpy.ndarray, shape (rows,), optional
        Takes the place of the motion that drives friction.
    load : numpy.ndarray, shape (rows - 1,), optional
        Takes the place of what was recorded to act beside the input.
    rate : float, optional
        At which it is drawn back, 1/s; without it ten times over the support of the kernel.

    Returns
    -------
    numpy.ndarray, shape (rows,)
        What the sensor would read, without its rounding.
    numpy.ndarray, shape (rows - 1,)
        Load together with the effort of the pull: under it the plant makes this motion.

    Raises
    ------
    InputError
        It runs away from the measured motion.
    """
    target = form.position if position is None else position
    rate = min(rate or PULL_RATE / form.kernel.support, STEADY / form.dt)
    inertia = form.own(plant).inertia
    # The pull acts on what the motor turns at once, and sampled it must not shake that either.
    inertia *= min(1.0, STEADY * (1.0 - _behind_a_shaft(plant)) / (rate * form.dt))
    motor = form.start_motor(plant, target, velocity=_velocity_of(form, target, rate))
    load = form.load[:-1] if load is None else load
    motion = form.motion if position is None else form.with_motion(position, load=load)
    readings, pull = motor.accompany(
        motion, inertia * rate**2, 2.0 * inertia * rate, start=start, strict=False
    )
    if not np.all(np.isfinite(readings)):
        raise InputError(
            f"{plant.source}: a simulation cannot be kept near the measured motion; it runs away"
        )
    return np.concatenate([target[:1], readings]), load + pull


def _velocity_of(form: WeakForm, target: FloatArray, rate: float) -> float:
    """Velocity with which a motion begins: 0 where it may as well begin at rest.

    A run that begins at rest beside a machine that moves is behind it until the pull has brought it
    up, and so are the windows that begin there.
    """
    samples = min(max(2, round(1.0 / (rate * form.dt))), len(target) - 1)
    way = float(target[samples] - target[0])
    if abs(way) <= MOVED * max(form.count, float(np.sqrt(12.0)) * form.noise):
        return 0.0
    slope, _ = np.polyfit(form.dt * np.arange(samples + 1), target[: samples + 1], 1)
    return float(slope)


def _behind_a_shaft(plant: Plant) -> float:
    """Share of the inertia that hangs on a shaft or lies behind a gap, the greatest of these."""
    shares = (each.parameters.get("inertia_share") for each in plant.effects)
    return max((share.value for share in shares if share is not None), default=0.0)
