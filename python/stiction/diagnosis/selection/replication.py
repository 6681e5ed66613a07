"""Whether rows held out confirm a cause that is known well from those that were fitted.

How much a gain varies over blocks says little of a cause that acts in a few of them: it varies with
what the machine did there. But what was learnt from the rows that were fitted says how much those
must gain, and by noise alone they do not come near it. A mimic may, where the machine does the
same again: this is asked only of what many fitted blocks leave no doubt of, or of what leaves next
to nothing where it was not fitted.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ..._support.arrays import FloatArray
from ..screening.model import Model
from ..screening.regression import refit_residuals

__all__ = ["confirms", "in_few_blocks", "vanishes_where_active"]

CLEAR: Final = 4.0
"""Size of what is expected on rows held out over its standard error there: far from noise."""
AS_EXPECTED: Final = (0.75, 1.33)
"""Strength on rows held out as a share of that on fitted ones."""
FEWEST_BLOCKS: Final = 5.0
"""Fitted blocks, counted by their share of the power, in which a cause acts. What acts in one or
two is fitted to them: its standard error, taken over blocks, is no measure of doubt."""
LEFT: Final = 0.1
"""Share of the power of the rows held out that is left, where it acts, by a cause that takes all or
nothing: its gain was known beforehand, so that its blocks may be few. By chance it takes no such
share of what was never fitted."""
LEFT_OF_ANY: Final = 0.05
"""The same of any other cause, of which few blocks tell a strength: all but noise has to go from
blocks that it was not fitted to."""

ACTS: Final = 0.05
"""Share of the most that it does in any block, from which on a block tells what is left."""


def confirms(base: Model, model: Model, contributed: FloatArray, *, whole: bool = False) -> bool:
    """Whether a contribution has about the same strength on rows held out as on those fitted.

    Where rows are held out by turns, in folds, there are none that were never fitted, and nothing
    is confirmed.

    Parameters
    ----------
    base : Model
        Without the effect.
    model : Model
        With it.
    contributed : numpy.ndarray, shape (n,)
        What the effect explains of each row after its refit.
    whole : bool
        Its gain came out as what was known of it beforehand, as of a limit beyond which everything
        is lost: from few blocks it may leave more then.
    """
    evidence = base.evidence
    plan = evidence.plans[0]
    if plan.whole is not None:
        return False
    fitted, held, block = plan.fit, plan.held, evidence.cells.block
    # What the base cannot make up for; its slopes are learnt where it was fitted.
    own = refit_residuals(base.columns, contributed, fitted)
    count = int(block.max()) + 1
    learnt_from = np.bincount(block[fitted], own[fitted] ** 2, count)
    before, after = (each.residual[held] for each in (base, model))
    if _are_few(learnt_from):
        most = LEFT if whole else LEFT_OF_ANY
        return vanishes_where_active(
            block[held], own[held], before, after, evidence.overlap, most=most
        )
    if not _is_clear(block[held], own[held], after, evidence.overlap):
        return False
    seen, learnt = (_strength(base.residual[rows], own[rows]) for rows in (held, fitted))
    return learnt > 0.0 and AS_EXPECTED[0] < seen / learnt < AS_EXPECTED[1]


def vanishes_where_active(
    block: NDArray[Any],
    explained: FloatArray,
    before: FloatArray,
    after: FloatArray,
    overlap: float,
    *,
    most: float = LEFT,
) -> bool:
    """Whether next to nothing is left in the blocks in which something acts, far beyond noise.

    Parameters
    ----------
    block : numpy.ndarray of int, shape (n,)
        Of each row, none of them fitted.
    explained, before, after : numpy.ndarray, shape (n,)
        What it explains, and what is left without it and with it.
    overlap : float
        Rows under one kernel.
    most : float
        Share of the power that may be left.
    """
    if not _is_clear(block, explained, after, overlap):
        return False
    power = np.bincount(block, explained**2)
    acting = np.where(power > ACTS * float(np.max(power)), power, 0.0)
    left = float(acting @ np.bincount(block, after**2))
    return left < most * float(acting @ np.bincount(block, before**2))


def _is_clear(
    block: NDArray[Any], explained: FloatArray, after: FloatArray, overlap: float
) -> bool:
    """Whether what something explains stands far beyond the noise of these rows."""
    noise = np.bincount(block, after**2) / np.maximum(np.bincount(block), 1)
    power = np.bincount(block, explained**2)
    # Rows under one kernel are one reading: so many times worse than if they were independent.
    return float(power.sum()) > CLEAR * float(np.sqrt(overlap * (power @ noise)))


def in_few_blocks(base: Model, contributed: FloatArray) -> bool:
    """Whether a contribution, shape (n,), was fitted to blocks so few that they tell no strength.

    Rows held out by turns were all fitted.
    """
    plan, block = base.evidence.plans[0], base.evidence.cells.block
    return _are_few(np.bincount(block[plan.fit], contributed[plan.fit] ** 2, int(block.max()) + 1))


def _are_few(power: NDArray[Any]) -> bool:
    return float(power.sum()) ** 2 < FEWEST_BLOCKS * float(np.sum(power**2))


def _strength(residual: FloatArray, own: FloatArray) -> float:
    power = float(own @ own)
    return float(residual @ own) / power if power > 0.0 else 0.0
