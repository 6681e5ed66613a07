"""The same regression in every fold: rows are gone through once for all of them.

What folds ask of the rows that they fit are products of columns. Rows that always are in or out
together, a piece, have the same products when they are turned so that all below the first few are
0 (QR): as many rows are left as there are columns, and each fold regresses on these.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import cast

import numpy as np

from ..._support.arrays import FloatArray
from ...fitting.angular import Angular
from ...fitting.slopes import Block
from ..data.evidence import Plan
from .regression import Base, Projected

__all__ = ["over_plans"]


def over_plans(columns: Angular, targets: FloatArray, plans: Sequence[Plan]) -> Iterator[Projected]:
    """Targets with the base projected off, plan by plan.

    Parameters
    ----------
    columns : Angular
        Of the base.
    targets : numpy.ndarray, shape (n, k)
    plans : sequence of Plan

    Yields
    ------
    Projected
        Held rows as they are; of the fitted ones rows that have the same products.
    """
    if len(plans) == 1:
        yield Base(columns, plans[0]).project(targets)
        return
    pieces = _pieces(columns, plans)
    small, turned = _condensed(columns, targets, pieces)
    first = np.repeat([int(rows[0]) for rows in pieces], [len(part) for part in turned])
    short = np.concatenate(turned)
    for plan in plans:
        whole = None if plan.whole is None else plan.whole[first]
        fit = plan.fit[first]
        base = Base(small, Plan(fit, np.zeros_like(fit), whole))
        gains = base.gains(short[fit])
        taken = columns.of_rows(plan.held).times(gains)
        yield Projected(base.off(short[fit]), targets[plan.held] - taken)


def _pieces(columns: Angular, plans: Sequence[Plan]) -> list[np.ndarray]:
    """Fitted rows that every plan uses alike, within one recording each."""
    used = [mask for plan in plans for mask in (plan.fit, plan.whole) if mask is not None]
    label = np.zeros(len(columns.shared), dtype=np.int64)
    for number, each in enumerate(columns.own, start=1):
        label[each.rows] = number
    for mask in used:
        _, label = np.unique(2 * label + mask, return_inverse=True)
    asked = np.flatnonzero(np.any(used, axis=0))
    order = asked[np.argsort(label[asked], kind="stable")]
    ends = np.flatnonzero(np.diff(label[order])) + 1
    return np.split(order, ends)


def _condensed(
    columns: Angular, targets: FloatArray, pieces: Sequence[np.ndarray]
) -> tuple[Angular, list[FloatArray]]:
    """Each piece in as few rows as it has columns: of the base, and of the targets."""
    blocks: list[Block] = []
    turned = []
    for rows in pieces:
        places, own = columns.within(rows)
        found = cast("FloatArray", np.linalg.qr(np.hstack([own, targets[rows]]), mode="r"))
        block = found[:, : own.shape[1]].T
        turned.append(found[:, own.shape[1] :])
        if blocks and blocks[-1][0] == places:
            # Another piece of the recording before.
            block = np.hstack([blocks.pop()[1], block])
        blocks.append((places, block))
    return Angular.of_blocks(blocks, columns.shared.shape[1], columns.size), turned
