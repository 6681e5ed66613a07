"""What the readings of a motion do to the residual along it."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from ..errors import InputError
from ..plant import Plant
from ..recording.motion import GAUSSIAN, smooth
from ..residual.accompanied import nearby_motion
from ..residual.finite import finite
from ..residual.weak_form import Start, WeakForm
from .rows import Nuisances, Rows

__all__ = [
    "Residual",
    "counts_in_reach",
    "own_motion",
    "position_noise",
    "read_sensor",
    "readings_mislead",
    "residual_of_readings",
    "step_of",
    "true_motion",
]

_logger = logging.getLogger(__name__)

SMOOTHING_SHARE: Final = 1.0 / 3.0
"""Support over which the measured motion is smoothed to stand for the true one, as a share of the
kernel's: rounding is gone, and what the kernel sees is not."""

STEADIER: Final = (4.0, 3.0, 2.0)
"""Supports of a motion that was steadied over which it is smoothed instead, the widest of them that
noise allows: what is left of the noise of its speed would be in motion and readings alike, and no
noise to a replay."""
BESIDE_NOISE: Final = 1.15
"""Readings are as far from it then as noise takes them, but for so much."""
MAKES: Final = 0.5
"""Share of what is left along the readings that these must make of a contact that yields to mislead
it: where they make less, something else is most of what is left."""
MATTERS: Final = 1e-3
"""Share of the measured effort that they must make: less, and it does not matter."""
ROUNDED: Final = float(np.sqrt(12.0))
"""Size of a count over the standard deviation of what rounding to it makes."""

Residual = Callable[[FloatArray, FloatArray], FloatArray]
"""From readings, and noise that is added to the effort, to the residual; shapes (rows,)."""


def position_noise(form: WeakForm) -> float:
    """White noise of the position beside the rounding to counts, rad or m."""
    return float(np.sqrt(max(form.noise**2 - form.count**2 / 12.0, 0.0)))


def read_sensor(
    form: WeakForm, motion: FloatArray, white: float, source: np.random.Generator
) -> FloatArray:
    """A motion as the sensor reads it, with this noise beside its rounding; shape (rows,)."""
    readings = motion + white * source.standard_normal(len(motion))
    if form.count > 0.0:
        # Where a rigid contact stops between two counts changes what is read of the stop.
        begin = 0.0 if form.springy else source.uniform(-0.5, 0.5)
        readings = np.round(readings / form.count + begin) * form.count
    return readings


def true_motion(form: WeakForm) -> FloatArray:
    """The measured motion without its rounding: what stands for the true one; shape (rows,)."""
    if form.adapts:
        return form.position
    for times in STEADIER if form.smoothing_support > 0.0 else ():
        found = smooth(form.readings, form.dt, times * form.smoothing_support, drifts=True)
        off = GAUSSIAN * float(np.median(np.abs(form.readings - found)))
        if off <= BESIDE_NOISE * form.noise:
            return found
    return smooth(form.position, form.dt, max(form.dt, SMOOTHING_SHARE * form.kernel.support))


def own_motion(
    form: WeakForm, plant: Plant, start: Start
) -> tuple[FloatArray, Residual, FloatArray] | None:
    """A motion near the measured one that a plant makes by itself, residual and load.

    None where there is no such motion: nothing drives a machine that is moved, and one with hardly
    any inertia cannot be simulated in samples.

    A rigid contact stops from one sample to the next, which a smoothed motion never does, and one
    that yields answers each wave that smoothing leaves of the counts: what readings make of either
    would be no part of the noise.
    """
    if form.prescribed or plant.servo:
        return None
    try:
        motion, load = nearby_motion(form, plant, start, position=true_motion(form))
    except InputError as error:
        _logger.info("followed instead of simulated: %s", error)
        return None

    # A rigid contact at rest answers whatever acts on it, noise as well.
    takes = np.ones(len(motion) - 1) if form.springy else np.diff(motion) != 0.0
    inertia = form.own(plant).inertia

    def residual(readings: FloatArray, added: FloatArray) -> FloatArray:
        driving = form.driving_motion(readings, load + added[1:])
        short = form.short(plant, start, position=driving, load=load)
        acted = form.applied_effort(np.zeros_like(load), load + added[1:] * takes)
        return short + acted - inertia * form.accelerations(readings, driving)

    return motion, residual, load


def residual_of_readings(form: WeakForm, plant: Plant, start: Start = None) -> FloatArray | None:
    """What the readings alone leave of the residual of a plant that is right; shape (rows,).

    A motion near the measured one that the plant makes by itself, read once by the sensor. None
    where there is no such motion.

    Parameters
    ----------
    form : WeakForm
    plant : Plant
    start : dict, optional
        Friction state at the first row.
    """
    slid = own_motion(form, plant, start)
    if slid is None:
        return None
    motion, residual, _ = slid
    readings = read_sensor(form, motion, position_noise(form), np.random.default_rng(0))
    return residual(readings, np.zeros(len(motion)))


def readings_mislead(plant: Plant, nuisances: Nuisances, rows: Sequence[Rows]) -> bool:
    """Whether readings make most of what a contact that yields leaves along them.

    Within its pre-sliding friction goes with the position, and counts are steps of it. One that is
    over within a count is as rigid as these readings tell.

    Parameters
    ----------
    plant : Plant
        Fitted to ``rows``.
    nuisances : Nuisances
    rows : sequence of Rows
        Of the weak form.
    """
    if not plant.friction.springy or counts_in_reach(plant, [each.form for each in rows]) < 1.0:
        return False
    left, made, measured = 0.0, 0.0, 0.0
    for each in rows:
        read = residual_of_readings(each.form, plant, nuisances.start(each.index))
        if read is None:
            return False
        own = each.residual(plant, nuisances)[each.mask]
        effort = each.form.measured_effort(plant)[each.mask]
        left, measured = left + float(own @ own), measured + float(effort @ effort)
        made += float(np.sum(finite(read)[each.mask] ** 2))
    return made > max(MAKES**2 * left, MATTERS**2 * measured)


def counts_in_reach(plant: Plant, forms: Sequence[WeakForm]) -> float:
    """Steps of the readings, or of as much noise, in the reach of pre-sliding; inf without one."""
    friction = plant.friction.parameters
    if not {"coulomb", "initial_stiffness"} <= friction.keys():
        return np.inf
    reach = friction["coulomb"].value / friction["initial_stiffness"].value
    step = float(np.median([step_of(form) for form in forms]))
    return reach / step if step > 0.0 else np.inf


def step_of(form: WeakForm) -> float:
    """Count of the readings, or the one that would make as much noise as they have."""
    return max(form.count, ROUNDED * form.noise)
