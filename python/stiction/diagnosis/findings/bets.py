"""How sure recordings are that causes help: bets on each of them, which multiply."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from ..._support.arrays import FloatArray
from ..._support.wording import plural
from ..data.gain import HeldOut

__all__ = ["Bet", "Bets", "bets_of"]

SHARES: Final = (np.arange(64) + 0.5) / 64
"""Of what there is that is put on each recording: all between nothing and everything alike, so that
nobody has to know beforehand how much a cause helps."""
CLEAR: Final = 100.0
"""Odds from which on chance is no answer: a false alarm in a hundred sessions."""
MOST: Final = 1_000
"""Further recordings that are counted up to: beyond it these do not tell anything."""


@dataclass(frozen=True)
class Bet:
    """What a recording that was held out says of causes.

    Attributes
    ----------
    recording : str
    before, after : float
        Residual without the causes and with them, rms, N·m or N.
    added : bool
        Recorded after the diagnosis.
    """

    recording: str
    before: float
    after: float
    added: bool = False

    @property
    def payoff(self) -> float:
        """From -1, where the causes make all the error, to 1, where they take all of it."""
        one, two = self.before**2, self.after**2
        return (one - two) / (one + two) if one + two > 0.0 else 0.0

    @property
    def gain(self) -> float | None:
        """Share of the power of the residual that the causes take; None where there is none."""
        return 1.0 - (self.after / self.before) ** 2 if self.before > 0.0 else None

    def to_dict(self) -> dict[str, Any]:
        """As an entry of ``evidence.recordings``."""
        return {
            "recording": self.recording,
            "before_rms": self.before,
            "after_rms": self.after,
            "payoff": self.payoff,
            "added": self.added,
        }


@dataclass(frozen=True)
class Bets:
    """All recordings that were held out, and what they are worth together.

    Who says that the causes do not help says that on a recording they are as likely to lose as to
    win: the payoff has a mean of 0 or less, whatever was recorded before. Against that one may bet
    a share of what one has on each recording; what 1 has then become is an e-value: by chance it
    reaches 100 in one session of a hundred, however often one looks and however many recordings
    are added. (Waudby-Smith, Ramdas, J. R. Stat. Soc. B 86 (2024) 1-27; the unit is the recording,
    for what a model misses lasts through each of them.)

    Attributes
    ----------
    each : tuple of Bet
        One a recording.
    """

    each: tuple[Bet, ...] = ()

    @property
    def value(self) -> float:
        """The e-value: 1 says nothing, 100 is clear."""
        return _value([bet.payoff for bet in self.each])

    @property
    def more(self) -> int | None:
        """Further recordings like these until that is clear; None where they would not tell."""
        payoffs = [bet.payoff for bet in self.each]
        mean = float(np.mean(payoffs)) if payoffs else 0.0
        if mean <= 0.0:
            return None
        for number in range(MOST + 1):
            if _value([*payoffs, *[mean] * number]) >= CLEAR:
                return number
        return None

    @property
    def words(self) -> str:
        """The same in a sentence, "" where no recording was held out."""
        if not self.each:
            return ""
        won = sum(bet.payoff > 0.0 for bet in self.each)
        of = plural(len(self.each), "recording")
        told = (
            f"it helps in {won} of {of} held out: by their number alone, odds of {self.value:.3g} "
            "to 1 against chance"
        )
        if self.more is None:
            return f"{told}; more recordings like these would not tell"
        if self.more == 0:
            return told
        return f"{told} ({CLEAR:.0f} to 1 takes {self.more} more like these)"

    def to_dict(self) -> dict[str, Any]:
        """As ``evidence`` in findings.json."""
        return {
            "e_value": self.value,
            "more": self.more,
            "recordings": [bet.to_dict() for bet in self.each],
        }


def _value(payoffs: Sequence[float]) -> float:
    """Mean over all shares of the product of 1 + share·payoff."""
    grown: FloatArray = np.zeros(len(SHARES))
    for payoff in payoffs:
        grown += np.log1p(SHARES * payoff)
    return float(np.mean(np.exp(grown)))


def bets_of(test: HeldOut, after: int, names: Sequence[str], *, added: bool = False) -> Bets:
    """What each recording that tests says of the causes of a model.

    Parameters
    ----------
    test : HeldOut
    after : int
        The model; the first is the one without causes.
    names : sequence of str
        Of all recordings.
    added : bool
        They were recorded after the diagnosis.
    """
    left = [test.residuals[k] / test.weights for k in (0, after)]
    found = []
    for index in dict.fromkeys(test.cells.recording.tolist()):
        own = test.cells.recording == index
        before, then = (float(np.sqrt(np.mean(each[own] ** 2))) for each in left)
        found.append(Bet(names[index], before, then, added))
    return Bets(tuple(found))
