"""Quantiles of Student's t and of F, without the fifth of a second that importing SciPy takes."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Final

__all__ = ["f_quantile", "t_quantile"]

ROUNDING: Final = 1e-15
TINY: Final = 1e-300
MOST_TERMS: Final = 10_000


@cache
def t_quantile(degrees: float, share: float) -> float:
    """Where Student's t with so many degrees of freedom is below with a probability above ½."""
    # t² = ν(1 − x)/x, and P(|T| > t) = I_x(ν/2, 1/2).
    x = _inverse(lambda x: _share_below(0.5 * degrees, 0.5, x), 2.0 * (1.0 - share))
    return math.sqrt(degrees * (1.0 - x) / x)


@cache
def f_quantile(over: float, under: float, share: float) -> float:
    """Where F with these degrees of freedom is below with a probability."""
    # P(F > f) = I_x(ν₂/2, ν₁/2), x = ν₂/(ν₂ + ν₁·f).
    x = _inverse(lambda x: _share_below(0.5 * under, 0.5 * over, x), 1.0 - share)
    return under * (1.0 - x) / (over * x)


def _inverse(rising: Callable[[float], float], wanted: float) -> float:
    """Where a function that rises from 0 to 1 has a value, between 0 and 1."""
    low, high = 0.0, 1.0
    while True:
        # By powers of ten as long as the lower end is 0, by halves from there on.
        middle = 0.5 * (low + high) if low > 0.01 * high else math.sqrt(max(low, TINY) * high)
        if not low < middle < high or high - low <= ROUNDING * high:
            return high
        if rising(middle) < wanted:
            low = middle
        else:
            high = middle


def _share_below(a: float, b: float, x: float) -> float:
    """The regularised incomplete beta function I_x(a, b)."""
    if not 0.0 < x < 1.0:
        return max(0.0, min(x, 1.0))
    if x > (a + 1.0) / (a + b + 2.0):
        # The fraction converges fast on the other side alone.
        return 1.0 - _share_below(b, a, 1.0 - x)
    front = math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b)
    front += a * math.log(x) + b * math.log1p(-x)
    return math.exp(front) * _fraction(a, b, x) / a


def _fraction(a: float, b: float, x: float) -> float:
    """Its continued fraction, after Lentz (Applied Optics 15 (1976))."""
    above, below = 1.0, 1.0 / _apart(1.0 - (a + b) * x / (a + 1.0))
    value = below
    for m in range(1, MOST_TERMS):
        even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m))
        odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))
        for term in (even, odd):
            below = 1.0 / _apart(1.0 + term * below)
            above = _apart(1.0 + term / above)
            value *= above * below
        if abs(above * below - 1.0) < ROUNDING:
            break
    return value


def _apart(value: float) -> float:
    return value if abs(value) > TINY else TINY
