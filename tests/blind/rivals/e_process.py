"""Bets on the next second, one block after the other: evidence that may be looked at at any time.

For each entry the gains are those of the blocks before, and the wager on a block is the likelihood
ratio that they give there, with the noise of the blocks before (Wald's plug-in martingale; Robbins
and Siegmund 1974). An effect's wealth is the mean over its shapes, and it is named once it has
exceeded the number of effects over the level (Ville's inequality, Bonferroni).
"""

from __future__ import annotations

import math

import numpy as np
from scipy.special import logsumexp

from .library import ALPHA, forward

FIRST = 0.25
"""Share of the blocks that only teach."""


def names(lib):
    """Adds the effect with most wealth while that is beyond the level."""
    effects = len({entry.name for entry in lib.entries})
    bar = math.log(max(effects, 1) / ALPHA)

    def richest(now, own):
        wealth = wealths(now)
        best = max(own, key=lambda name: wealth[name])
        return best if wealth[best] > bar else None

    return forward(lib, richest)


def wealths(lib):
    """Logarithm of the most that each effect ever had."""
    blocks = int(lib.block.max()) + 1
    power = np.bincount(lib.block, lib.residual**2, blocks)
    rows = np.bincount(lib.block, minlength=blocks)
    before = np.cumsum(power) - power
    seen = np.maximum(np.cumsum(rows) - rows, 1)
    variance = np.maximum(before / seen, 1e-300)
    paths = {}
    for entry in lib.entries:
        bets = _bets(entry, lib, blocks) * lib.share / (2.0 * variance)
        bets[: max(2, math.ceil(FIRST * blocks))] = 0.0
        paths.setdefault(entry.name, []).append(np.cumsum(bets))
    return {
        name: float(np.max(logsumexp(some, axis=0) - math.log(len(some))))
        for name, some in paths.items()
    }


def _bets(entry, lib, blocks):
    """By how much each block's power falls with the gains that the blocks before tell."""
    q = entry.columns.shape[1]
    by_block = [np.flatnonzero(lib.block == k) for k in range(blocks)]
    parts = [(entry.columns[rows], lib.residual[rows]) for rows in by_block]
    normal, product = 1e-6 * np.sum(entry.columns**2) * np.eye(q), np.zeros(q)
    gained = np.zeros(blocks)
    for k, (own, left) in enumerate(parts):
        gains = np.clip(np.linalg.solve(normal, product), entry.low, entry.high)
        told = own @ gains
        gained[k] = 2.0 * told @ left - told @ told
        normal, product = normal + own.T @ own, product + own.T @ left
    return gained
