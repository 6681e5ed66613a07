"""A library of columns and F-tests, one after the other, at a level over the whole library."""

from __future__ import annotations

from scipy.stats import f as fisher

from .library import ALPHA, forward


def names(lib):
    """Adds the effect with the least p while p, times the size of the library, is below 1 %."""
    return forward(lib, _least)


def _least(lib, own):
    tests = len(lib.entries)

    def p(name):
        power, entry, _ = own[name]
        q = entry.columns.shape[1]
        left = lib.rows - lib.base - q
        if left <= 1.0:
            return 1.0
        rest = max(float(lib.residual @ lib.residual) - power, 1e-300)
        # Logarithms would not order less well, and p of 1e-300 is as sure as can be told.
        return float(fisher.sf(power / q / (rest / left), q, left))

    best = min(own, key=lambda name: (p(name), -own[name][0]))
    return best if tests * p(best) < ALPHA else None
