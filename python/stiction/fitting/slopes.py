"""Derivatives of fitted rows by all that is fitted: parameters, timing, starts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .._support.arrays import FloatArray
from ..plant import Plant
from ..residual.finite import finite
from .rows import Nuisances, Rows

__all__ = ["places_of", "slopes"]


def places_of(nuisances: Nuisances) -> list[tuple[int, str]]:
    """Recording and quantity of every start that is fitted, in the order of their columns."""
    return [(index, name) for index, own in nuisances.starts.items() for name in own]


def slopes(
    rows: Rows,
    plant: Plant,
    paths: Sequence[str],
    nuisances: Nuisances,
    places: Sequence[tuple[int, str]] | None = None,
) -> FloatArray:
    """Weighted derivatives of the rows of one recording that count.

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
    numpy.ndarray, shape (n, paths + 1 + starts)
        By parameters, by the timing offset, by the starts of all recordings; those of other
        recordings are 0, and so are those of a simulation that ran away.
    """
    places = places_of(nuisances) if places is None else places
    own = [(j, name) for j, (index, name) in enumerate(places) if index == rows.index]
    found = rows.jacobian(plant, [*paths, *(f"start.{name}" for _, name in own)], nuisances)
    found = found[rows.mask]
    block = np.zeros((len(found), len(paths) + 1 + len(places)))
    block[:, : len(paths)] = found[:, : len(paths)]
    block[:, len(paths)] = rows.late[rows.mask]
    for column, (j, _) in enumerate(own):
        block[:, len(paths) + 1 + j] = found[:, len(paths) + column]
    return finite(rows.weight * block)
