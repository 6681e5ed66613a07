"""Surrogates: the residual that noise and rounding alone would leave, by replay of the motion."""

from __future__ import annotations

from typing import Final

import numpy as np

from ..fitting.rows import Nuisances, Rows
from ..motion import smooth
from ..plant import Plant
from ..trajectory import FloatArray
from ..weak_form import WeakForm
from .evidence import Evidence
from .noise import Noise, measure_noise

__all__ = ["centre", "surrogate_residuals"]

SMOOTHING_SHARE: Final = 1.0 / 3.0
"""Support over which the measured motion is smoothed to stand for the true one, as a share of the
kernel's: rounding is gone, and what the kernel sees is not."""


def surrogate_residuals(
    evidence: Evidence, plant: Plant, nuisances: Nuisances, number: int, seed: int
) -> tuple[FloatArray, dict[int, Noise]]:
    """Residuals of recordings in which the plant is right and only noise is added.

    The smoothed motion is followed by the plant, which gives the effort that acted. Noise is put
    on it, the position gets noise and is rounded to counts, and both go the way of the measured
    ones: friction driven by the readings, inertia term, kernel.

    Parameters
    ----------
    evidence : Evidence
    plant : Plant
    nuisances : Nuisances
    number : int
        How many.
    seed : int
        Same seed, same surrogates, whatever the number of threads.

    Returns
    -------
    numpy.ndarray, shape (n, number)
        Weighted, of the rows that may be looked at.
    dict of int to Noise
        By recording.
    """

    def one(rows: Rows) -> tuple[FloatArray, Noise]:
        noise = measure_noise(rows, plant, nuisances)
        source = np.random.default_rng([seed, rows.index])
        return rows.weight * _replayed(rows, plant, nuisances, noise, number, source), noise

    found = evidence.each(one, evidence.shown)
    noises = {rows.index: noise for rows, (_, noise) in zip(evidence.shown, found, strict=True)}
    return np.concatenate([columns for columns, _ in found]), noises


def _replayed(
    rows: Rows,
    plant: Plant,
    nuisances: Nuisances,
    noise: Noise,
    number: int,
    source: np.random.Generator,
) -> FloatArray:
    form = rows.form
    start = nuisances.start(rows.index)
    motion = true_motion(form)
    _, needed, ahead = form.along(plant, start, position=motion)
    inertial = form.inertial(plant, motion, ahead)
    columns = np.empty((int(rows.mask.sum()), number))
    for k in range(number):
        readings = motion + noise.position * source.standard_normal(len(motion))
        if noise.count > 0.0:
            readings = np.round(readings / noise.count) * noise.count
        _, followed, ahead = form.along(plant, start, position=form.driving(readings))
        added = noise.effort * source.standard_normal(len(motion))
        added = 0.5 * (added[:-1] + added[1:])
        residual = form.mean(needed - followed + added)
        residual += inertial - form.inertial(plant, readings, ahead)
        columns[:, k] = residual[rows.mask]
    return columns


def centre(null: FloatArray) -> tuple[FloatArray, FloatArray]:
    """What all surrogates have in common, and each of them less the mean of the others."""
    number = null.shape[1]
    bias: FloatArray = null.mean(axis=1)
    return bias, (null - bias[:, None]) * (number / (number - 1) if number > 1 else 1.0)


def true_motion(form: WeakForm) -> FloatArray:
    """The measured motion without its rounding: what stands for the true one; shape (rows,)."""
    return smooth(
        form.driving(form.readings),
        form.dt,
        max(form.dt, SMOOTHING_SHARE * form.kernel.support),
    )
