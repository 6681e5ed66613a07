"""Surrogates: the residual that noise and rounding alone would leave, by replay of the motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ...fitting.noise import Noise
from ...fitting.replay import NearbyMotion
from ...fitting.rows import Nuisances, Rows
from ...plant import Plant
from ...residual.weak_form import WeakForm
from .evidence import Evidence

__all__ = ["centre", "common_bias", "reading_power", "surrogate_residuals"]

ALIKE: Final = 1e-3
"""Share by which counts of one sensor differ."""


def surrogate_residuals(
    evidence: Evidence, plant: Plant, nuisances: Nuisances, number: int, seed: int
) -> tuple[FloatArray, dict[int, Noise]]:
    """Residuals of recordings in which the plant is right and only noise is added.

    The smoothed motion is followed by the plant, which gives the effort that acted; for shooting
    the plant is simulated, drawn to the measured motion. Noise is put on the effort, the position
    gets noise and is rounded to counts, and both go the way of the measured ones: friction driven
    by the readings, or simulation from them, inertia term, kernel.

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

    def measured(rows: Rows) -> tuple[NearbyMotion, Noise]:
        replay = NearbyMotion.of(rows, plant, nuisances)
        return replay, replay.noise()

    def replayed(found: tuple[NearbyMotion, Noise]) -> FloatArray:
        replay, noise = found
        return replay.rows.weight * replay.columns(noise, number, seed)

    found = evidence.each(measured, evidence.shown)
    if evidence.simulated:
        found = _of_one_sensor(found)
    noises = {replay.rows.index: noise for replay, noise in found}
    return np.concatenate(evidence.each(replayed, found)), noises


def _of_one_sensor(found: Sequence[tuple[NearbyMotion, Noise]]) -> list[tuple[NearbyMotion, Noise]]:
    """The same with one noise of the position for all that one sensor read, the middle one.

    Where a machine rests between two counts readings show no noise, and then it moves.
    """

    def alike(one: WeakForm, other: WeakForm) -> bool:
        return bool(np.isclose(one.count, other.count, rtol=ALIKE) and one.dt == other.dt)

    usual = []
    for replay, noise in found:
        form = replay.rows.form
        own = [each.position for other, each in found if alike(form, other.rows.form)]
        usual.append((replay, replace(noise, position=float(np.median(own)))))
    return usual


def reading_power(evidence: Evidence, plant: Plant, nuisances: Nuisances) -> float:
    """Weighted power that readings alone leave a right plant in the rows that were fitted.

    Nothing that a plant may lack is in it: beside one that lacks something fast, what that makes
    passes for noise of the effort.
    """

    def power(rows: Rows) -> float:
        replay = NearbyMotion.of(rows, plant, nuisances)
        left = [rows.weight * each[rows.mask] for each in replay.alone()]
        return float(np.mean([each @ each for each in left]))

    return sum(evidence.each(power, evidence.train))


def centre(null: FloatArray) -> tuple[FloatArray, FloatArray]:
    """What all surrogates have in common, and each of them less the mean of the others."""
    number = null.shape[1]
    bias: FloatArray = null.mean(axis=1)
    return bias, (null - bias[:, None]) * (number / (number - 1) if number > 1 else 1.0)


def common_bias(bias: FloatArray, residual: FloatArray, recording: np.ndarray) -> FloatArray:
    """What surrogates have in common, in each recording as far as the residual has it too.

    Where a replay loses the machine all of them lose it alike, and the residual knows nothing of
    it.

    Parameters
    ----------
    bias, residual : numpy.ndarray, shape (n,)
    recording : numpy.ndarray of int, shape (n,)
        Of each row.
    """
    number = int(recording.max()) + 1
    power = np.bincount(recording, bias**2, number)
    along = np.bincount(recording, bias * residual, number)
    share = np.clip(along / np.maximum(power, 1e-300), 0.0, 1.0)
    found: FloatArray = share[recording] * bias
    return found
