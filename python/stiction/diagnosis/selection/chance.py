"""What would resemble a simpler cause by chance alone: in one of very many phases or orders.

Where a machine does not turn round, a wave over the angle near its top is about a constant, and
cogging or a weight off the axis explain what a constant effort does; and cogging whose order comes
out as 1 explains what a weight does. A wave may have any phase, and cogging any order: one that has
to stand within some degrees of the top, or at that order, and gains nothing by it, is so much less
likely than what is simpler. What blocks say, where they are not certain, comes on top if what it
explains is not nearly the same.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ...catalogue import effects
from ...fitting.angular import FLAT
from ..screening.block_gains import paired_z
from ..screening.candidates import LOWEST, scales_of
from ..screening.model import Model
from .decide import Trial

__all__ = ["TOO_NEAR", "by_chance", "lacks_repeats", "odds", "share_of_phases", "share_of_waves"]

WAVE: Final = ("cosine", "sine")
ORDER: Final = "order"
ENOUGH: Final = 3.0
"""Logarithm of the odds, 20 to 1, from which the wave is left aside."""
DEVIATIONS: Final = 2.0
"""Standard errors of a phase or an order that are added on both sides."""
TOO_NEAR: Final = 0.04
"""Share of a worth within which another one is about the same: it may be the same cause in another
form, and what is simpler costs less."""
SMALLEST: Final = 1e-9
SEEN: Final = 0.75
"""Periods of a wave of which less may as well be a spring, straight or bent."""
PARTS: Final = 32
"""Parts of a period that were seen or not."""


def by_chance(simple: Trial, other: Trial) -> bool:
    """Whether a wave resembles a cause with fewer parameters in few of its phases or orders.

    Parameters
    ----------
    simple : Trial
        The cause that the wave is not told from.
    other : Trial
        Refitted beside the same base. False where it is no wave, where it is worth more, or where
        nothing is known of its phase and order.
    """
    if (
        other.candidate.record.gains != WAVE
        or other.worth > simple.worth
        or other.candidate.parameters <= simple.candidate.parameters
    ):
        return False
    if simple.candidate.record.gains == WAVE:
        share = _share_of_orders(simple, other)
    elif len(simple.candidate.gains) == 1:
        share = _share_of_phases(simple, other)
    else:
        return False
    if share >= 1.0:
        return False
    near = other.worth >= (1.0 - TOO_NEAR) * simple.worth
    return odds(share, paired_z(other.model, simple.model), near=near) >= ENOUGH


def lacks_repeats(model: Model, name: str) -> bool:
    """Whether this is an effort over position of which nobody saw enough to call it a wave.

    A spring, as a cable is, and all else that goes with position look like a part of one, and so do
    a constant and a gain that is another one.
    """
    if name not in {r.name for r in effects() if any(s.parameter == ORDER for s in r.shapes)}:
        return False
    effect = next(each for each in model.plant.effects if each.name == name)
    seen = [rows.form.mean(rows.form.position[1:])[rows.mask] for rows in model.evidence.shown]
    turns = np.concatenate(seen) * effect.parameters[ORDER].value / (2.0 * np.pi)
    # Where it stood in between two recordings nobody saw.
    return len(np.unique(np.floor(turns * PARTS))) < SEEN * PARTS


def odds(share: float, apart: float, *, near: bool) -> float:
    """Logarithm of the odds that a wave is not the cause.

    Parameters
    ----------
    share : float
        Of waves that resemble the simpler cause as much.
    apart : float
        What blocks leave more with the wave, in standard errors; negative where they leave less.
    near : bool
        Whether both explain nearly the same: then blocks speak against the simpler cause alone.
    """
    spoken = min(apart, 0.0) if near else apart
    return 0.5 * spoken * abs(spoken) - math.log(max(share, SMALLEST))


def _share_of_orders(simple: Trial, other: Trial) -> float:
    """Share of all orders, logarithmic, that are as near to one wave a turn; at most 1."""
    if simple.candidate.record.shapes or other.candidate.free != (ORDER,):
        return 1.0
    order = other.model.fit_result.parameters[f"effects.{other.name}.{other.candidate.own(ORDER)}"]
    if not math.isfinite(order.stderr):
        return 1.0
    least, most = _orders(other)
    away = abs(math.log(order.value)) + DEVIATIONS * order.stderr / order.value
    return min(2.0 * away / math.log(most / least), 1.0)


def _orders(other: Trial) -> tuple[float, float]:
    """Least and greatest order that a fit may come to."""
    asked = scales_of(other.model.evidence, other.model.plant).orders
    return LOWEST * asked[0], asked[-1]


def _share_of_phases(simple: Trial, other: Trial) -> float:
    """Share of all waves that are as near to a cause with one gain; at most 1."""
    spread = other.model.gain_covariance(other.candidate)
    if spread is None:
        return 1.0
    share = share_of_phases(other.model.gains(other.candidate), spread, _most_alike(simple, other))
    if other.candidate.free != (ORDER,):
        return share
    effect = next(each for each in other.model.plant.effects if each.name == other.name)
    least, most = _orders(other)
    # The least one stands for all below it, an octave of them.
    below = 0.5 * least
    order = effect.parameters[other.candidate.own(ORDER)].value
    return share_of_waves(share, order / below, most / below)


def share_of_waves(phases: float, order: float, most: float) -> float:
    """Share of all waves of any order and phase that are as flat over the range.

    A wave of a lower order is as flat in the more of its phases, as many as it is lower.

    Parameters
    ----------
    phases : float
        Share of phases at the order.
    order, most : float
        The order and the greatest one, in units of the lowest.
    """
    all_flat = min(max(phases * order, 1.0), order)
    lower = math.log(all_flat) + phases * (order / all_flat - 1.0)
    return min(lower / math.log(most), 1.0)


def share_of_phases(wave: FloatArray, spread: FloatArray, most: FloatArray) -> float:
    """Share of all phases in which a wave is as near to another one, of either sign.

    Parameters
    ----------
    wave, most : numpy.ndarray, shape (2,)
        Cosine and sine, of what was found and of what it is compared with.
    spread : numpy.ndarray, shape (2, 2)
        Covariance of the former.

    Returns
    -------
    float
        At most 1.
    """
    size = float(np.hypot(*wave))
    if size == 0.0:
        return 1.0
    away = math.remainder(math.atan2(wave[1], wave[0]) - math.atan2(most[1], most[0]), math.pi)
    across = np.array([-wave[1], wave[0]]) / size
    uncertain = math.sqrt(max(float(across @ spread @ across), 0.0)) / size
    return min(2.0 / math.pi * (abs(away) + DEVIATIONS * uncertain), 1.0)


def _most_alike(simple: Trial, other: Trial) -> FloatArray:
    """Cosine and sine of the wave that resembles a cause with one gain most, beside the base."""
    own, base = _columns(other)
    alone, _ = _columns(simple)
    regressors = np.hstack([own, base])
    scale = np.sqrt(np.sum(regressors**2, axis=0))
    live = scale > 0.0
    found = np.zeros(len(scale))
    scaled = regressors[:, live] / scale[live]
    found[live] = np.linalg.lstsq(scaled, alone[:, 0], rcond=FLAT)[0] / scale[live]
    return found[: own.shape[1]]


def _columns(trial: Trial) -> tuple[FloatArray, FloatArray]:
    """Slopes of the fitted rows by the gains of a cause, and by all but its own parameters."""
    columns = trial.model.fitted_columns.matrix()
    paths = list(trial.model.solution.variables.paths)
    gains = [paths.index(f"effects.{trial.name}.{name}") for name in trial.candidate.gains]
    own = [k for k, path in enumerate(paths) if path.startswith(f"effects.{trial.name}.")]
    return columns[:, gains], np.delete(columns, own, axis=1)
