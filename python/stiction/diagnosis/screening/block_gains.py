"""What a model gains over another, on rows it was fitted to and on rows held out."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ...fitting.rows import Mask
from ..data.influence import limit_influence
from .model import Model
from .regression import refit_residuals

__all__ = [
    "TOUCHED",
    "count_active_recordings",
    "heldout_gain",
    "heldout_reduction",
    "lacks_excitation",
    "log_gain",
    "paired_z",
    "training_gain",
    "without_the_best",
    "z_of",
]

FEWEST_RECORDINGS: Final = 4
"""Fewer recordings held out have no best one to do without."""
TELLING: Final = 0.01
"""Blocks that change by less than this share of the mean change count for neither side."""
TOUCHED: Final = 0.01
"""Blocks with less than this share of an effect's mean power are none of its business."""


def training_gain(base: Model, model: Model) -> float:
    """Share of the fitted power that a model removes, no block counting for too much."""
    before, after = limit_influence(base.blocks[0], model.blocks[0])
    total = float(before.sum())
    return 1.0 - float(after.sum()) / total if total > 0.0 else 0.0


def lacks_excitation(base: Model, contributed: FloatArray, least: float) -> bool:
    """Whether blocks held out can gain less than a share by a contribution that fitted ones show.

    What it does in a block, shape (n,), beyond what the base makes up for, is the most that can be
    gained there; a block that holds far more than others counts as in ``heldout_gain``. Where rows
    are held out by turns they are the fitted ones.
    """
    plan = base.evidence.plans[0]
    if plan.whole is not None:
        return False
    own = refit_residuals(base.columns, contributed, plan.fit)
    block = base.evidence.cells.block
    shares = []
    for rows in (plan.held, plan.fit):
        power, done = (
            np.bincount(block[rows], each[rows] ** 2).astype(np.float64)
            for each in (base.residual, own)
        )
        before, after = limit_influence(power, np.maximum(power - done, 0.0))
        shares.append(1.0 - float(after.sum()) / max(float(before.sum()), 1e-300))
    return shares[0] < min(least, 0.5 * shares[1])


def heldout_gain(base: Model, model: Model, touched: Mask | None = None) -> tuple[float, float]:
    """Share of the held-out power that a model removes, and that over its standard error.

    ``touched`` says which blocks the second figure is taken over, all without it.
    """
    before, after = limit_influence(base.blocks[1], model.blocks[1])
    seen = before > 0.0
    total = float(before.sum())
    gained = float((before - after)[seen].sum())
    difference = (before - after)[seen if touched is None else seen & touched]
    if total <= 0.0:
        return 0.0, 0.0
    return gained / total, max(z_of(difference), _sign_z(difference))


def heldout_reduction(base: Model, model: Model) -> float:
    """Held-out power that a model removes, no block counting for too much."""
    before, after = limit_influence(base.blocks[1], model.blocks[1])
    return float((before - after).sum())


def without_the_best(base: Model, model: Model, contributed: FloatArray) -> float:
    """Held-out gain without the recordings that gain most and least; 1 where too few are held out.

    In a recording in which the base has lost the machine anything may find it again. Recordings in
    which the effect does nothing count for neither side: in one of them the base may lose it.
    """
    cells = base.evidence.cells
    of_block = np.zeros(len(base.blocks[1]), dtype=np.int64)
    of_block[cells.block] = cells.recording
    before, after = limit_influence(base.blocks[1], model.blocks[1])
    whole, left = (np.bincount(of_block, power) for power in (before, after))
    explained = np.bincount(cells.recording, contributed**2, len(whole))
    rows = np.bincount(cells.recording, minlength=len(whole))
    touched = explained > TOUCHED * float(np.mean(contributed**2)) * rows
    held = np.flatnonzero(whole > 0.0)
    if len(held) < FEWEST_RECORDINGS:
        return 1.0
    held = held[touched[held]] if np.sum(touched[held]) > 1 else held
    in_order = held[np.argsort((whole - left)[held])]
    # As it may find the machine again in one, it may lose it in another.
    kept = in_order[1:-1] if len(in_order) >= FEWEST_RECORDINGS else in_order[:-1]
    return float(1.0 - left[kept].sum() / whole[kept].sum())


def paired_z(worse: Model, better: Model) -> float:
    """What one model leaves more than another, over its standard error over blocks of 1 s."""
    difference = np.zeros(len(better.blocks[0]))
    for more, less in zip(worse.blocks, better.blocks, strict=True):
        after, before = limit_influence(more, less)
        difference += after - before
    return z_of(difference[difference != 0.0])


def count_active_recordings(base: Model, contributed: FloatArray) -> int:
    """Number of recordings held out in which an effect acts."""
    recording = base.evidence.cells.recording
    held = np.zeros(len(contributed), dtype=bool)
    for plan in base.evidence.plans:
        held |= plan.held
    power = np.bincount(recording[held], contributed[held] ** 2)
    return int(np.sum(power > TOUCHED * max(float(power.max()), 1e-300)))


def _sign_z(values: FloatArray) -> float:
    """How far more values are positive than chance makes them, in standard deviations.

    Where a few blocks hold most of the power, a sum over its standard error says little however
    clearly every block improves.
    """
    if len(values) == 0:
        return 0.0
    telling = values[np.abs(values) > TELLING * float(np.mean(np.abs(values)))]
    if len(telling) == 0:
        return 0.0
    return (2.0 * float(np.sum(telling > 0.0)) - len(telling)) / math.sqrt(len(telling))


def log_gain(base: Model, model: Model) -> float:
    """Logarithm of the power before over that after, on train and held out, added."""
    total = 0.0
    for whole, less in zip(base.blocks, model.blocks, strict=True):
        before, after = limit_influence(whole, less)
        if before.sum() > 0.0 and after.sum() > 0.0:
            total += math.log(float(before.sum()) / float(after.sum()))
    return total


def z_of(values: FloatArray) -> float:
    """Sum over its standard error, values being independent."""
    if len(values) < 2:
        return 0.0
    error = float(np.std(values, ddof=1)) * math.sqrt(len(values))
    return float(values.sum()) / error if error > 0.0 else 0.0
