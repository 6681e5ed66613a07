"""How noisy the channels of a recording are, as far as the recording itself tells."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from ..plant import Plant
from ..recording.motion import GAUSSIAN
from ..residual.weak_form import WeakForm
from .readings import position_noise
from .rows import Mask, Nuisances, Rows

__all__ = ["Noise", "effort_noise", "input_noise", "measure_noise"]

LAG_SHARE: Final = 1.0 / 3.0
"""Lag of the second difference that tells noise from misfit, as a share of the kernel's support:
motion and friction hardly change over it, white noise through the kernel does."""
THIRD: Final = math.sqrt(20.0)
"""Standard deviation of a third difference of white noise of size 1."""
FEWEST_ROWS: Final = 50
"""Second differences that have a median worth the name."""


@dataclass(frozen=True)
class Noise:
    """White noise of a recording, per sample.

    Attributes
    ----------
    position : float
        Beside the rounding to counts, rad or m.
    count : float
        Step of the readings, 0 where there is none.
    effort : float
        Of the effort that acted, or of its reading, N·m or N.
    """

    position: float
    count: float
    effort: float


def measure_noise(
    rows: Rows, plant: Plant, nuisances: Nuisances, alone: Sequence[FloatArray] = ()
) -> Noise:
    """Noise of one recording, from what changes too fast for a machine.

    Position: third differences, less what rounding makes. Effort: second differences of the
    residual over a third of the kernel, less what readings alone make of them. What rounding makes
    of a machine that goes at a constant speed, or rests, is no white noise: it is tried out.
    The median over all rows keeps reversals and other misfit out.

    Parameters
    ----------
    rows : Rows
    plant : Plant
    nuisances : Nuisances
    alone : sequence of numpy.ndarray, shape (rows,)
        Residuals of a motion that the plant makes, read by this sensor without noise of the effort.
        Without them readings count as exact.
    """
    form = rows.form
    seen = effort_noise(rows, [rows.residual(plant, nuisances)], alone)
    return Noise(position_noise(form), form.count, seen)


def effort_noise(rows: Rows, residuals: Sequence[FloatArray], alone: Sequence[FloatArray]) -> float:
    """Noise of the effort that residuals of a recording hold beside what readings alone make.

    Shapes (rows,) each; 0 where no row tells of it.
    """
    form = rows.form
    lag, counted = _lag(form), _counted(rows, _lag(form))
    if not counted.any():
        return 0.0

    def scatter(each: Sequence[FloatArray]) -> float:
        return float(np.mean([_scatter(one, lag, counted) for one in each])) if each else 0.0

    own = max(scatter(residuals) - scatter(alone), 0.0)
    return math.sqrt(own / _bent(_weights(form), lag * form.stride))


def input_noise(rows: Rows, plant: Plant, nuisances: Nuisances) -> float:
    """White noise of the log of the input that the machine did not get, as an effort (N·m or N).

    The input scatters by it from one sample to the next, and it is in the residual as it is in the
    input, so that their second differences have its power in common: what scatters in the input and
    acts, as where a controller answers noise of its readings, has its answer in the motion, and
    noise of the readings is in the residual alone. The medians keep steps out (Gnanadesikan,
    Kettenring, Biometrics 28 (1972)).
    """
    form = rows.form
    lag, counted = _lag(form), _counted(rows, _lag(form))
    if not counted.any():
        return 0.0
    left, given = rows.residual(plant, nuisances), form.measured_effort(plant)
    shared = 0.25 * (_scatter(left + given, lag, counted) - _scatter(left - given, lag, counted))
    third = GAUSSIAN * float(np.median(np.abs(np.diff(form.input, 3)))) / THIRD
    alike = math.sqrt(max(shared, 0.0) / _bent(_weights(form), lag * form.stride))
    return min(abs(plant.gain) * third, alike)


def _lag(form: WeakForm) -> int:
    """Lag of the second differences, in rows."""
    return max(1, round(LAG_SHARE * form.kernel.support / (form.dt * form.stride)))


def _weights(form: WeakForm) -> FloatArray:
    """How a row weighs samples of a held effort."""
    return np.convolve(form.kernel.weights, [0.5, 0.5])


def _counted(rows: Rows, lag: int) -> Mask:
    """Rows whose second differences tell of noise, as the differences themselves are counted.

    Where a rigid contact comes to rest, what is missing goes from the residual all at once: beside
    that nothing is noise, unless the machine hardly moves for longer.
    """
    reached = rows.form.noisy_rows
    counted: Mask = (rows.mask & reached)[lag:-lag]
    within: Mask = counted & reached[: -2 * lag] & reached[2 * lag :]
    return within if np.count_nonzero(within) >= FEWEST_ROWS else counted


def _scatter(residual: FloatArray, lag: int, counted: Mask) -> float:
    """Variance of the second differences of a residual, as its median over some rows tells it."""
    bend = residual[: -2 * lag] - 2.0 * residual[lag:-lag] + residual[2 * lag :]
    return (GAUSSIAN * float(np.median(np.abs(bend[counted])))) ** 2


def _bent(weights: FloatArray, lag: int) -> float:
    """Variance that white noise of size 1 has in a second difference of its weighted mean."""
    taps = np.zeros(len(weights) + 2 * lag)
    for shift, factor in ((0, 1.0), (lag, -2.0), (2 * lag, 1.0)):
        taps[shift : shift + len(weights)] += factor * weights
    return float(np.sum(taps**2))
