"""Cost of a step, beside that of the simplest law in the same run."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from .._native import FrictionModel
from .subject import RIGID_SPAN

__all__ = ["BESIDE", "costs"]

BESIDE: Final = "coulomb"
"""The law that costs are compared with."""
_STEPS: Final = 50_000
_ROUNDS: Final = 7


def costs(laws: Sequence[str]) -> Mapping[str, float]:
    """Nanoseconds of a step of each law at its defaults; the least of several interleaved runs.

    The motion is a slow sine with a faster one on it, which reverses, slides and makes inner
    loops.
    """
    phase = 2.0 * np.pi * np.arange(_STEPS) / _STEPS
    position = RIGID_SPAN * (5.0 * np.sin(20.0 * phase) + np.sin(170.0 * phase))
    velocity = np.diff(position, prepend=0.0) / 1e-3
    best = dict.fromkeys([*laws, BESIDE], np.inf)
    for _ in range(_ROUNDS):
        for law in best:
            model = FrictionModel(law)
            start = time.perf_counter()
            model.simulate(velocity, 1e-3)
            best[law] = min(best[law], 1e9 * (time.perf_counter() - start) / _STEPS)
    return best
