"""The gain on rows that nobody looked at: computed once, after the last decision."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ...fitting.rows import Nuisances, Rows
from ...plant import Plant
from .evidence import Cells, Evidence

__all__ = ["Gain", "HeldOut", "gain_of", "residuals_of"]

RESAMPLES: Final = 2000
MOST_LEFT: Final = 1e100
"""Beyond any residual, weighted."""
WORST: Final = -1e12
"""A gain below this says no more, and is a number all the same."""


@dataclass(frozen=True)
class Gain:
    """Share of the residual's power that a model removes beside another, over test rows.

    Attributes
    ----------
    value : float
    ci95 : tuple of float
        Percentiles of a bootstrap over blocks of 1 s.
    """

    value: float
    ci95: tuple[float, float]

    def to_dict(self) -> dict[str, object]:
        """As in findings.json."""
        return {"value": self.value, "ci95": list(self.ci95)}


@dataclass(frozen=True)
class HeldOut:
    """Residuals of several plants over the rows that test.

    Attributes
    ----------
    residuals : tuple of numpy.ndarray, shape (n,)
        Weighted, one of each plant.
    weights : numpy.ndarray, shape (n,)
    effort : numpy.ndarray, shape (n,)
        Measured, weighted; of a servo its motion, counted as the residual is.
    cells : Cells
    rows : tuple of Rows
    nuisances : tuple of Nuisances
        Of each plant, with the starts of the recordings that test.
    """

    residuals: tuple[FloatArray, ...]
    weights: FloatArray
    effort: FloatArray
    cells: Cells
    rows: tuple[Rows, ...]
    nuisances: tuple[Nuisances, ...] = ()

    def relative(self, index: int) -> float:
        """2-norm of the residual of one plant over that of what it is a part of."""
        scale = float(np.linalg.norm(self.effort / self.weights))
        left = float(np.linalg.norm(self.residuals[index] / self.weights))
        return left / scale if scale > 0.0 else float("inf")

    def rms(self, index: int) -> float:
        """Root mean square of the residual of one plant, in effort."""
        return float(np.sqrt(np.mean((self.residuals[index] / self.weights) ** 2)))


def residuals_of(
    evidence: Evidence, rows: Sequence[Rows], models: Sequence[tuple[Plant, Nuisances]]
) -> HeldOut | None:
    """What several plants leave in the rows that test; None where there are none."""
    if not rows:
        return None

    def left(plant: Plant, nuisances: Nuisances) -> FloatArray:
        own = evidence.each(lambda e: e.weight * e.residual(plant, nuisances)[e.mask], rows)
        # What runs away leaves much, and a number: its square is one as well.
        return np.clip(np.nan_to_num(np.concatenate(own), nan=1e6), -MOST_LEFT, MOST_LEFT)

    # What a contact brought along into these recordings is no part of a plant. Of each law the
    # first model tells where it is looked for, and the others go on from there.
    known: dict[str, Nuisances] = {}
    begun = []
    for plant, nuisances in models:
        new = [
            e for e in rows if e.index not in evidence.training_recordings | nuisances.starts.keys()
        ]
        law = plant.friction.law
        near = known.get(law, Nuisances()).of({e.index for e in new})
        begun.append(evidence.with_starts(plant, nuisances.merge(near), new))
        known.setdefault(law, begun[-1])
    plants = [plant for plant, _ in models]
    residuals = tuple(left(*each) for each in zip(plants, begun, strict=True))
    weights = np.concatenate([np.full(int(e.mask.sum()), e.weight) for e in rows])
    base = models[0][0]
    effort = np.concatenate([e.weight * e.form.whole(base)[e.mask] for e in rows])
    return HeldOut(residuals, weights, effort, evidence.cells_of(rows), tuple(rows), tuple(begun))


def gain_of(test: HeldOut, before: int, after: int, seed: int) -> Gain:
    """1 − Σw·r²(after)/Σw·r²(before), with an interval.

    Parameters
    ----------
    test : HeldOut
    before, after : int
        Which plants.
    seed : int
        Of the bootstrap.
    """
    block = test.cells.block
    number = int(block.max()) + 1
    one = np.bincount(block, test.residuals[before] ** 2, number)
    two = np.bincount(block, test.residuals[after] ** 2, number)
    if one.sum() <= 0.0:
        return Gain(0.0, (0.0, 0.0))
    value = max(1.0 - float(two.sum() / one.sum()), WORST)
    source = np.random.default_rng([seed, before, after])
    drawn = source.integers(0, number, (RESAMPLES, number))
    sums = one[drawn].sum(axis=1)
    # Draws may hold next to nothing of what was left before.
    with np.errstate(over="ignore"):
        ratios = np.maximum(1.0 - two[drawn].sum(axis=1) / np.maximum(sums, 1e-300), WORST)
    low, high = np.quantile(ratios, [0.025, 0.975])
    return Gain(value, (float(low), float(high)))
