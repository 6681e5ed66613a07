"""Derivatives of fitted rows by all that is fitted: parameters, timing, starts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .._support.arrays import FloatArray
from ..plant import Plant
from ..residual.finite import finite
from .rows import Nuisances, Rows

__all__ = ["Block", "places_of", "slope_block", "slopes", "whole_matrix"]

Block = tuple[list[int], FloatArray]
"""Derivatives of the rows of one recording, shape (columns, n), and by which of all that is fitted
they are taken; those by all else are 0."""


def places_of(nuisances: Nuisances) -> list[tuple[int, str]]:
    """Recording and quantity of every start that is fitted, in the order of their columns."""
    return [(index, name) for index, own in nuisances.starts.items() for name in own]


def slope_block(
    rows: Rows,
    plant: Plant,
    paths: Sequence[str],
    nuisances: Nuisances,
    places: Sequence[tuple[int, str]] | None = None,
) -> Block:
    """Weighted derivatives of the rows of one recording that count, by what they depend on.

    Parameters
    ----------
    rows : Rows
    plant : Plant
    paths : sequence of str
    nuisances : Nuisances
    places : sequence of (int, str), optional
        Starts that have columns; those of ``nuisances`` without it.

    Returns
    -------
    Block
        By parameters, by the timing offset, by the starts of the recording; 0 for those of a
        simulation that ran away.
    """
    places = places_of(nuisances) if places is None else places
    own = [(j, name) for j, (index, name) in enumerate(places) if index == rows.index]
    found = rows.jacobian(plant, [*paths, *(f"start.{name}" for _, name in own)], nuisances).T
    timing = len(paths)
    block = np.empty((len(found) + 1, int(np.count_nonzero(rows.mask))))
    np.compress(rows.mask, found[:timing], axis=1, out=block[:timing])
    np.compress(rows.mask, rows.scale(plant) * rows.late, out=block[timing])
    np.compress(rows.mask, found[timing:], axis=1, out=block[timing + 1 :])
    block *= rows.weight
    return [*range(timing + 1), *(timing + 1 + j for j, _ in own)], finite(block)


def whole_matrix(blocks: Sequence[Block], size: int) -> FloatArray:
    """Blocks of several recordings, one under the other, by all that is fitted; shape (n, size)."""
    found = np.zeros((sum(block.shape[1] for _, block in blocks), size))
    row = 0
    for columns, block in blocks:
        found[row : row + block.shape[1], columns] = block.T
        row += block.shape[1]
    return found


def slopes(
    rows: Rows,
    plant: Plant,
    paths: Sequence[str],
    nuisances: Nuisances,
    places: Sequence[tuple[int, str]] | None = None,
) -> FloatArray:
    """The same with a column for all that is fitted; those of other recordings are 0.

    Returns
    -------
    numpy.ndarray, shape (n, paths + 1 + starts)
        By parameters, by the timing offset, by the starts of all recordings.
    """
    places = places_of(nuisances) if places is None else places
    block = slope_block(rows, plant, paths, nuisances, places)
    return whole_matrix([block], len(paths) + 1 + len(places))
