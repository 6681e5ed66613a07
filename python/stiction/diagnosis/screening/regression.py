"""Linear regression of the residual on what may be missing, the base projected off."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ...fitting.angular import Angular
from ...fitting.rows import Mask
from ..data.evidence import Plan

__all__ = ["Base", "Projected", "bounded_gains", "project", "refit_residuals"]

LEAST_TOLD: Final = 0.05
"""A direction of which a fold tells less than this share of what all fitted rows tell is left where
those put it: what one block alone determines, the others cannot."""

SWEEPS: Final = 30
"""Times that gains within bounds are mended one after the other, beside one that is at a bound."""


@dataclass(frozen=True)
class Projected:
    """Columns with the base projected off over the rows that are fitted.

    The same combination of base columns is taken off the rows held out, so that both belong to one
    fit.

    Attributes
    ----------
    fit, held : numpy.ndarray, shape (n_fit, k), (n_held, k)
    """

    fit: FloatArray
    held: FloatArray


class Base:
    """The columns of the base, orthogonalised over the fitted rows of a plan.

    A fold fits the directions that its rows tell; the others stay where the fit to all rows put
    them.
    """

    def __init__(self, columns: Angular, plan: Plan) -> None:
        self._columns = columns
        size = self._columns.of_rows(plan.fit).sizes
        self._live = np.flatnonzero(size > 0.0)
        self._factor = 1.0 / np.where(size > 0.0, size, 1.0)
        scaled = self._columns.scale(self._live, self._factor)
        whole = plan.fit if plan.whole is None else plan.whole
        self._left, self._inverse = scaled.of_rows(whole).orthogonal_basis()
        self._turn: FloatArray | None = None
        if plan.whole is not None:
            self._left = self._left.of_rows(plan.fit[plan.whole])
            self._turn = self._told()
            self._inverse = self._inverse @ self._turn
        self._plan = plan

    def _told(self) -> FloatArray:
        """The directions that a fold tells, of those that all rows do; shape (p, told)."""
        shares, directions = np.linalg.eigh(self._left.normal())
        told: FloatArray = directions[:, shares > LEAST_TOLD] / np.sqrt(shares[shares > LEAST_TOLD])
        return told

    def _shares(self, fit: FloatArray) -> FloatArray:
        found = self._left.products(fit)
        return found if self._turn is None else self._turn.T @ found

    def _explained(self, shares: FloatArray) -> FloatArray:
        return self._left.times(shares if self._turn is None else self._turn @ shares)

    def off(self, fit: FloatArray) -> FloatArray:
        """Columns of the fitted rows alone, without what the base explains; same shape."""
        found = self._explained(self._shares(fit))
        return np.subtract(fit, found, out=found)

    def gains(self, fit: FloatArray) -> FloatArray:
        """Gains of the columns that explain most of the fitted rows, shape (n_fit, …); (p, …)."""
        own = self._inverse @ self._shares(fit)
        found = np.zeros((self._columns.size, *own.shape[1:]))
        found[self._live] = (own.T * self._factor[self._live]).T
        return found

    @property
    def directions(self) -> Angular:
        """Directions of the base over the fitted rows, each of length 1."""
        if self._turn is None:
            return self._left
        return Angular.of_matrix(self._left.matrix() @ self._turn)

    def project(self, columns: FloatArray) -> Projected:
        """Columns of all rows, shape (n, k) or (n,), without what the base explains."""
        fit, held = columns[self._plan.fit], columns[self._plan.held]
        taken = self._columns.of_rows(self._plan.held).times(self.gains(fit))
        return Projected(self.off(fit), held - taken)


def project(base: Angular, plan: Plan) -> Base:
    """The base of a plan, ready to be projected off."""
    return Base(base, plan)


def refit_residuals(columns: Angular, residuals: FloatArray, fitted: Mask) -> FloatArray:
    """Residuals of all rows once the base was fitted to each over the fitted rows; same shape."""
    everywhere = Plan(fitted, np.ones_like(fitted))
    return Base(columns, everywhere).project(residuals).held


def bounded_gains(
    normal: FloatArray, product: FloatArray, best: FloatArray, low: FloatArray, high: FloatArray
) -> FloatArray:
    """Gains within bounds that take most, of many small regressions.

    Where one of several has to stay at a bound the others are not what they are without it.

    Parameters
    ----------
    normal : numpy.ndarray, shape (m, q, q)
        SᵀS.
    product : numpy.ndarray, shape (m, q)
        Sᵀr.
    best : numpy.ndarray, shape (m, q)
        What takes most without bounds; 0 where nothing can be told.
    low, high : numpy.ndarray, shape (m, q)
    """
    found = np.clip(best, low, high)
    asked = np.flatnonzero(np.any(found != best, axis=1)) if best.shape[1] > 1 else ()
    if len(asked):
        own, given, slope = (
            found[asked],
            product[asked],
            np.diagonal(normal, axis1=1, axis2=2)[asked],
        )
        for _ in range(SWEEPS):
            for k in range(own.shape[1]):
                rest = given[:, k] - np.einsum("ki,ki->k", normal[asked, k], own)
                moved = own[:, k] + rest / np.maximum(slope[:, k], 1e-300)
                own[:, k] = np.clip(moved, low[asked, k], high[asked, k])
        found[asked] = own
    return found
