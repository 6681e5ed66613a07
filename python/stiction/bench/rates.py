"""Shares of sessions with their intervals, and how well probabilities hold."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

__all__ = ["Calibration", "Rate", "calibration", "rate", "wilson"]

T = TypeVar("T")

_BINS = 5
"""Of probabilities, all of one width."""


def wilson(count: int, number: int) -> tuple[float, float]:
    """95 % interval of a share (Wilson 1927): of few sessions too it holds and stays within 0 to 1.

    Parameters
    ----------
    count, number : int
        Sessions that have it, and sessions that were looked at; of none anything may be.
    """
    if not number:
        return 0.0, 1.0
    z, p = 1.96, count / number
    middle = (p + z * z / (2 * number)) / (1 + z * z / number)
    half = z * math.sqrt(p * (1 - p) / number + z * z / (4 * number**2)) / (1 + z * z / number)
    return max(middle - half, 0.0), min(middle + half, 1.0)


@dataclass(frozen=True)
class Rate:
    """How many of some sessions have something; ``aim`` is "low", "high" or "" for neither."""

    what: str
    count: int
    number: int
    aim: str = ""

    def __str__(self) -> str:
        if not self.number:
            return "none"
        low, high = wilson(self.count, self.number)
        share = 100.0 * self.count / self.number
        return (
            f"{self.count}/{self.number} = {share:.1f} % ({100.0 * low:.1f} to {100.0 * high:.1f})"
        )

    def to_dict(self) -> dict[str, Any]:
        """Count, number, share and its 95 % interval."""
        share = self.count / self.number if self.number else None
        ci95 = list(wilson(self.count, self.number))
        own = {"what": self.what, "count": self.count, "number": self.number}
        return {**own, "share": share, "ci95": ci95, "aim": self.aim or None}


def rate(what: str, each: Iterable[T], test: Callable[[T], object], aim: str = "") -> Rate:
    """How many pass a test."""
    passed = [bool(test(one)) for one in each]
    return Rate(what, sum(passed), len(passed), aim)


@dataclass(frozen=True)
class Calibration:
    """How well probabilities of names hold.

    Attributes
    ----------
    number : int
        Names with a probability.
    brier : float
        Mean square of probability less outcome, which is 1 where the name is right: 0 is best, and
        .25 is what .5 for everything gets.
    base_rate_brier : float
        What the share of right names, told as the probability of each, would get.
    error : float
        Mean distance of probability and share in the bins, weighted by their names.
    bins : tuple of (float, float, float, Rate)
        Least and greatest probability, their mean, and how many names were right.
    """

    number: int
    brier: float
    base_rate_brier: float
    error: float
    bins: tuple[tuple[float, float, float, Rate], ...]

    def to_dict(self) -> dict[str, Any]:
        """The same, as an entry of scores.json."""
        return {
            "number": self.number,
            "brier": self.brier,
            "base_rate_brier": self.base_rate_brier,
            "error": self.error,
            "bins": [
                {"from": low, "to": high, "mean_probability": mean, **right.to_dict()}
                for low, high, mean, right in self.bins
            ],
        }


def calibration(told: Sequence[tuple[float, bool]]) -> Calibration | None:
    """Of probabilities and whether what they were told of is right; None where none were."""
    if not told:
        return None
    number = len(told)
    share = sum(right for _, right in told) / number
    brier = sum((p - right) ** 2 for p, right in told) / number
    bins, error = [], 0.0
    for k in range(_BINS):
        low, high = k / _BINS, (k + 1) / _BINS
        some = [one for one in told if min(int(one[0] * _BINS), _BINS - 1) == k]
        if some:
            mean = sum(p for p, _ in some) / len(some)
            right = rate(f"right at {low:g} to {high:g}", some, lambda one: one[1])
            bins.append((low, high, mean, right))
            error += abs(mean - right.count / right.number) * len(some) / number
    return Calibration(number, brier, share * (1.0 - share), error, tuple(bins))
