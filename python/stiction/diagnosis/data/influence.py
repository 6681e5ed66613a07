"""How much one block may say."""

from __future__ import annotations

from typing import Final

import numpy as np

from ..._support.arrays import FloatArray

__all__ = ["limit_influence"]

MOST_TIMES: Final = 5.0
"""Power of a block over the median one that counts in full."""


def limit_influence(*powers: FloatArray) -> tuple[FloatArray, ...]:
    """Powers per block, each block scaled down where it holds more than five times the median.

    In a block in which a contact breaks away a moment earlier than the model every model is wrong
    by far, whatever effect it holds: a single one would decide between all candidates.

    Parameters
    ----------
    *powers : numpy.ndarray, shape (blocks,)
        Of several models; a block is scaled by the same factor for all of them.
    """
    largest = np.max(powers, axis=0)
    telling = largest[largest > 0.0]
    if len(telling) == 0:
        return powers
    cap = MOST_TIMES * float(np.median(telling))
    factor = cap / np.maximum(largest, cap)
    return tuple(power * factor for power in powers)
