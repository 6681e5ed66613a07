"""How much of an error could be explained at all: what exact repeats have in common."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from ..._support.arrays import FloatArray
from ...fitting.rows import Nuisances, Rows, warm
from ...plant import Plant
from .evidence import Evidence

__all__ = ["Ceiling", "ceiling_of"]

ALIKE: Final = 0.02
"""Share of the range of motion by which repeats may differ and still count as repeats."""


@dataclass(frozen=True)
class Ceiling:
    """Errors over recordings that were made twice, as shares of the measured effort (rms).

    Attributes
    ----------
    pairs : int
        Recordings with a repeat.
    before, after : float
        Errors of the baseline and of the extended model.
    noise : float
        What differs from one time to the next: no model explains that.
    """

    pairs: int
    before: float
    after: float
    noise: float

    @property
    def explainable(self) -> float:
        """Part of the baseline's error that a perfect model would take."""
        return max(self.before - self.noise, 0.0)

    def to_dict(self) -> dict[str, Any]:
        """As ``data.replicates`` of findings.json."""
        return {
            "pairs": self.pairs,
            "before": self.before,
            "after": self.after,
            "noise": self.noise,
            "explainable": self.explainable,
        }

    def words(self, extended: bool) -> str:
        """The same in a sentence."""
        twice = "the recording that was" if self.pairs == 1 else "recordings that were"
        told = (
            f"in {twice} made twice, of the {100 * self.before:.2f} % error "
            f"{100 * self.explainable:.2f} % could be explained"
        )
        if extended:
            told += f"; what was added took {100 * (self.before - self.after):.2f} %"
        return told


def ceiling_of(
    evidence: Evidence,
    replicates: Mapping[int, int],
    models: tuple[tuple[Plant, Nuisances], tuple[Plant, Nuisances]],
) -> Ceiling | None:
    """The ceiling from recordings and their exact repeats; None where there are none.

    Repeats are compared row by row: motion and cause come again, noise does not, and half the power
    of the difference is the noise of one (ISO 5725-2). No assumption is made about either. To be
    asked for once the rows that test are open.

    Parameters
    ----------
    evidence : Evidence
    replicates : mapping of int to int
        Index of a recording and of the one that it repeats.
    models : pair of (Plant, Nuisances)
        Baseline and extended.
    """
    powers = np.zeros(4)
    pairs = 0
    for index, of in replicates.items():
        both = [_rows(evidence, k) for k in (of, index)]
        number = min(int(each.mask.sum()) for each in both)
        if number == 0 or not _alike(both):
            continue
        pairs += 1
        new = [r for r in both if r.index not in evidence.training_recordings]
        before, after = (
            _residuals(both, plant, evidence.with_starts(plant, nuisances, new), number)
            for plant, nuisances in models
        )
        effort = [each.form.whole(models[0][0])[each.mask][:number] for each in both]
        powers += [
            _power(*before),
            _power(*after),
            # Of the model that leaves less: what it leaves differs least by the motion.
            float(np.sum((after[0] - after[1]) ** 2)),
            _power(*effort),
        ]
    if pairs == 0 or powers[3] <= 0.0:
        return None
    before_power, after_power, noise_power, effort_power = powers
    shares = np.sqrt(np.array([before_power, after_power, noise_power]) / effort_power)
    return Ceiling(pairs, float(shares[0]), float(shares[1]), float(shares[2]))


def _rows(evidence: Evidence, index: int) -> Rows:
    form = evidence.forms[index]
    return Rows(evidence.plant, form, index, warm(form, evidence.recordings[index]))


def _alike(both: list[Rows]) -> bool:
    """Whether the second recording moves as the first one did, on the same grid."""
    one, two = (each.form for each in both)
    if (one.dt, one.stride, len(one.kernel.weights)) != (
        two.dt,
        two.stride,
        len(two.kernel.weights),
    ):
        return False
    number = min(len(one.position), len(two.position))
    moved = [form.position[:number] - form.position[0] for form in (one, two)]
    range_ = max(float(np.ptp(each)) for each in moved)
    return float(np.sqrt(np.mean((moved[0] - moved[1]) ** 2))) <= ALIKE * range_


def _residuals(
    both: list[Rows], plant: Plant, nuisances: Nuisances, number: int
) -> tuple[FloatArray, FloatArray]:
    one, two = (np.nan_to_num(r.residual(plant, nuisances)[r.mask][:number]) for r in both)
    return one, two


def _power(one: FloatArray, two: FloatArray) -> float:
    """Mean power of two recordings, times two: as that of a difference."""
    return float(one @ one + two @ two)
