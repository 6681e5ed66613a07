"""Columns of which most belong to one recording each: block-angular least squares.

Every recording has columns of its own, of where it starts, that are 0 in all others, beside the few
that all share. Orthogonalised recording by recording (Golub, Plemmons and Sameh, in
"High-Speed Computing", 1988; Björck, "Numerical Methods for Least Squares Problems", 6.3) rows cost
what their own columns cost, not what those of all recordings would.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from .rows import Mask
from .slopes import Block

__all__ = ["FLAT", "Angular"]

FLAT: Final = 1e-8
"""Directions below this share of the strongest one are dropped."""


@dataclass(frozen=True)
class _Own:
    """Columns that are 0 but in neighbouring rows.

    Attributes
    ----------
    rows : slice
    places : numpy.ndarray of int, shape (k,)
        Of them among all columns.
    values : numpy.ndarray, shape (rows, k)
    """

    rows: slice
    places: np.ndarray
    values: FloatArray


@dataclass(frozen=True)
class Angular:
    """A matrix of shared columns and of columns of recordings.

    Attributes
    ----------
    shared : numpy.ndarray, shape (n, s)
    places : numpy.ndarray of int, shape (s,)
        Of the shared ones among all columns.
    own : tuple
        Of those of recordings, with the rows that these have.
    size : int
        Columns.
    """

    shared: FloatArray
    places: np.ndarray
    own: tuple[_Own, ...]
    size: int

    @classmethod
    def of_matrix(cls, columns: FloatArray) -> Angular:
        """All columns shared; shape (n, size)."""
        size = columns.shape[1]
        return cls(columns, np.arange(size), (), size)

    @classmethod
    def of_blocks(cls, blocks: Sequence[Block], shared: int, size: int) -> Angular:
        """Slopes of recordings, one under the other, of which the first columns are shared."""
        own, row = [], 0
        for places, block in blocks:
            rows = slice(row, row + block.shape[1])
            if len(places) > shared:
                own.append(_Own(rows, np.array(places[shared:]), block[shared:].T.copy()))
            row = rows.stop
        common = np.concatenate([block[:shared] for _, block in blocks], axis=1).T
        return cls(common, np.arange(shared), tuple(own), size)

    def with_common(self, shared: FloatArray) -> Angular:
        """With other values of the shared columns, shape (n, s)."""
        return replace(self, shared=shared)

    def with_column(self, place: int, values: FloatArray | float) -> Angular:
        """With other values of one of the shared columns, shape (n,)."""
        shared = self.shared.copy()
        shared[:, np.flatnonzero(self.places == place)[0]] = values
        return self.with_common(shared)

    def scale(self, chosen: np.ndarray, factor: FloatArray) -> Angular:
        """Some columns, places of shape (k,), each times its factor, shape (size,)."""
        place = np.full(self.size, -1)
        place[chosen] = np.arange(len(chosen))

        def some(values: FloatArray, places: np.ndarray) -> tuple[FloatArray, np.ndarray]:
            kept = place[places] >= 0
            return values[:, kept] * factor[places[kept]], place[places[kept]]

        shared, places = some(self.shared, self.places)
        own = []
        for each in self.own:
            values, at = some(each.values, each.places)
            if len(at):
                own.append(_Own(each.rows, at, values))
        return Angular(shared, places, tuple(own), len(chosen))

    @property
    def sizes(self) -> FloatArray:
        """Length of each column; shape (size,)."""
        found = np.zeros(self.size)
        found[self.places] = np.einsum("ij,ij->j", self.shared, self.shared)
        for each in self.own:
            found[each.places] = np.einsum("ij,ij->j", each.values, each.values)
        return np.sqrt(found)

    def of_rows(self, mask: Mask) -> Angular:
        """The same of some rows; shape of the mask (n,)."""
        place = np.concatenate([[0], np.cumsum(mask)])
        own = tuple(
            _Own(
                slice(int(place[each.rows.start]), int(place[each.rows.stop])),
                each.places,
                each.values[mask[each.rows]],
            )
            for each in self.own
        )
        return Angular(self.shared[mask], self.places, own, self.size)

    def within(self, rows: np.ndarray) -> tuple[list[int], FloatArray]:
        """Some rows of one recording, shape (m,): the columns that it has, shape (m, k), and which.

        Shared ones come first.
        """
        places, found = [*self.places.tolist()], [self.shared[rows]]
        for each in self.own:
            if each.rows.start <= rows[0] < each.rows.stop:
                places += each.places.tolist()
                found.append(each.values[rows - each.rows.start])
        return places, np.hstack(found)

    def orthogonal_basis(self) -> tuple[Angular, FloatArray]:
        """Directions that span the columns, each of length 1, and the columns that make them.

        Returns
        -------
        (Angular, numpy.ndarray)
            Q and T of A·T = Q, T of shape (size, directions).
        """
        parts = [np.linalg.svd(each.values, full_matrices=False) for each in self.own]
        rest = self.shared.copy()
        for _ in range(2 if parts else 0):
            # Twice: what a recording nearly explains is rounded otherwise.
            for each, (left, _, _) in zip(self.own, parts, strict=True):
                rest[each.rows] -= left @ (left.T @ rest[each.rows])
        left, sizes, right = np.linalg.svd(rest, full_matrices=False)
        most = max((float(s[0]) for s in (sizes, *(p[1] for p in parts)) if len(s)), default=0.0)
        own, turns, first = [], [], 0
        for each, (u, s, v) in zip(self.own, parts, strict=True):
            kept = s > FLAT * most
            own.append(_Own(each.rows, first + np.arange(int(kept.sum())), u[:, kept]))
            turns.append((each.places, v[kept].T / s[kept]))
            first += int(kept.sum())
        kept = sizes > FLAT * most
        count = first + int(kept.sum())
        turn = np.zeros((self.size, count))
        last = np.arange(first, count)
        of_shared = right[kept].T / sizes[kept]
        turn[np.ix_(self.places, last)] = of_shared
        for each, part, (places, values) in zip(self.own, own, turns, strict=True):
            turn[np.ix_(places, part.places)] = values
            taken = part.values.T @ (self.shared[each.rows] @ of_shared)
            turn[np.ix_(places, last)] = -values @ taken
        found = Angular(left[:, kept], last, tuple(own), count)
        return found, turn

    def gains(self, target: FloatArray) -> FloatArray:
        """Least squares, shape (n,): gains of each column, 0 for one that is 0; shape (size,)."""
        sizes = self.sizes
        live = np.flatnonzero(sizes > 0.0)
        factor = 1.0 / np.where(sizes > 0.0, sizes, 1.0)
        directions, turn = self.scale(live, factor).orthogonal_basis()
        found = np.zeros(self.size)
        found[live] = factor[live] * (turn @ directions.products(target))
        return found

    def products(self, columns: FloatArray) -> FloatArray:
        """Aᵀ times columns, shape (n,) or (n, k); shape (size, …)."""
        found = np.zeros((self.size, *columns.shape[1:]))
        found[self.places] = self.shared.T @ columns
        for each in self.own:
            found[each.places] = each.values.T @ columns[each.rows]
        return found

    def times(self, gains: FloatArray) -> FloatArray:
        """A times gains, shape (size,) or (size, k); shape (n, …)."""
        found: FloatArray = self.shared @ gains[self.places]
        for each in self.own:
            found[each.rows] += each.values @ gains[each.places]
        return found

    def normal(self) -> FloatArray:
        """AᵀA; shape (size, size)."""
        found = np.zeros((self.size, self.size))
        found[np.ix_(self.places, self.places)] = self.shared.T @ self.shared
        for each in self.own:
            found[np.ix_(each.places, each.places)] = each.values.T @ each.values
            both = each.values.T @ self.shared[each.rows]
            found[np.ix_(each.places, self.places)] = both
            found[np.ix_(self.places, each.places)] = both.T
        return found

    def matrix(self) -> FloatArray:
        """Written out, with its zeros; shape (n, size)."""
        found = np.zeros((len(self.shared), self.size))
        found[:, self.places] = self.shared
        for each in self.own:
            found[each.rows, each.places] = each.values
        return found

    def sums_by(self, pieces: np.ndarray, factor: FloatArray) -> FloatArray:
        """Sums of rows times a factor of each, shapes (n,), in each piece; shape (pieces, size)."""
        number = int(pieces.max()) + 1
        found = np.zeros((number, self.size))
        for column, place in zip(self.shared.T, self.places.tolist(), strict=True):
            found[:, place] = np.bincount(pieces, column * factor, number)
        for each in self.own:
            within, weight = pieces[each.rows], factor[each.rows]
            for column, place in zip(each.values.T, each.places.tolist(), strict=True):
                found[:, place] = np.bincount(within, column * weight, number)
        return found
