"""Which candidate is accepted, and which others these data cannot tell from it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from ..screening.block_gains import paired_z
from ..screening.candidates import FALL, scales_of
from .chance import TOO_NEAR, by_chance, lacks_repeats
from .decide import OUT_OF_RANGE, Trial

__all__ = ["ALIKE", "DECIDED_Z", "Choice", "choose", "covers", "parallel", "strangers"]

NEAR: Final = 0.15
"""Within this share of the winner's log-gain blocks have to be certain to tell another candidate
apart, and within ``TOO_NEAR`` nothing does."""
DECIDED_Z: Final = 2.0
"""Difference to the winner over its standard error that tells two candidates apart."""
CERTAIN_Z: Final = 3.0
"""The same for those that are near."""
ALIKE: Final = 0.5
"""Cosine of two contributions above which they explain the same."""
THE_SAME: Final = 1e-5
"""Two fits and contributions that differ by less than this share are one: fits end that near."""
UNEVEN_IN_FAMILY: Final = 0.12
"""What strengths of their own by kind of recording may add to the gain of a member of a family:
with more it stands for the family alone."""

_Contribution = np.ndarray[Any, np.dtype[np.floating]]
Encompasses = Callable[[Trial, Trial], bool]


@dataclass(frozen=True)
class Choice:
    """The accepted candidate of one round.

    Attributes
    ----------
    winner : Trial
    rivals : tuple of Trial
        Others that explain the same about as well, likeliest first.
    aside : tuple of Trial
        Those among them that would do so by chance alone.
    """

    winner: Trial
    rivals: tuple[Trial, ...]
    aside: tuple[Trial, ...] = ()

    @property
    def decided(self) -> bool:
        """Whether the data tell the winner from all others."""
        return not self.rivals


def choose(trials: Sequence[Trial], encompasses: Encompasses | None = None) -> Choice | None:
    """The accepted candidate worth most, and those that are not told from it.

    Parameters
    ----------
    trials : sequence of Trial
    encompasses : callable, optional
        Whether a candidate explains all that another one does and much that that does not: tells
        candidates apart that blocks do not.
    """
    ranked = sorted(trials, key=lambda t: -t.worth)
    accepted = [trial for trial in ranked if not trial.reason]
    if not accepted:
        return None
    winner = _as_was_seen(accepted)
    if strangers(trials, winner):
        return None
    # Who falls short by a little on its own may still be what the winner imitates.
    rivals = [
        other
        for other in ranked
        if other is not winner
        and not (other.partly or other.empty)
        and (other.gain > 0.0 or other.by_blocks)
        and (not other.imitates or _outdoes(other, winner))
        and (
            (_alike(winner, other) and not _told(winner, other, encompasses)) or _kin(winner, other)
        )
    ]
    head = _head(winner, rivals)
    others = [trial for trial in (winner, *rivals) if trial is not head]
    aside = [trial for trial in others if _by_chance(head, trial, winner)]
    others = [trial for trial in others if not any(trial is each for each in aside)]
    if winner.uneven <= UNEVEN_IN_FAMILY:
        # Who stands for a family stands for its twin as well.
        others = [trial for trial in others if not _twins(head, trial)]
    return Choice(head, tuple(others), tuple(aside))


def _as_was_seen(accepted: Sequence[Trial]) -> Trial:
    """The best of those that passed; for a wave that nobody saw to repeat what is simpler and near.

    A part of a wave follows whatever goes with position a little better than a constant does.
    """
    best = accepted[0]
    if not lacks_repeats(best.model, best.name):
        return best
    near = (t for t in accepted[1:] if t.worth >= (1.0 - NEAR) * best.worth and _alike(best, t))
    parameters = best.candidate.parameters
    return next((t for t in near if t.candidate.parameters < parameters), best)


def _by_chance(head: Trial, other: Trial, winner: Trial) -> bool:
    """Whether another candidate is left aside; never for a name that was itself refused.

    Nor where a winner stands for its family: what chance would do is asked of its strength.
    """
    return not head.reason and not _kin(winner, other) and by_chance(head, other)


def strangers(trials: Sequence[Trial], winner: Trial) -> list[Trial]:
    """Who may be the cause that a winner imitates, the best first.

    The cause itself would explain more than what imitates it, and what is refused for its spread
    over blocks alone may be that cause. A relative of the winner may imitate the winner, and others
    that relative: in another form the winner explains more than in its own.
    """
    family = winner.candidate.record.family
    own = [t for t in trials if t.candidate.record.family == family]
    own = [t for t in own if not t.reason or t.by_blocks or t.uneven == OUT_OF_RANGE]
    found = [
        t
        for t in trials
        if (
            t.imitates
            and t.candidate.record.family != family
            and not any(covers(r, t) for r in own)
        )
        or (t.by_blocks and not _alike(winner, t))
    ]
    found = [t for t in found if _outdoes(t, winner)]
    return sorted(found, key=lambda t: -t.worth)


def covers(one: Trial, other: Trial) -> bool:
    """Whether a trial is worth about another, or more, that explains the same of the residual."""
    return not _outdoes(other, one) and _alike(one, other)


def _outdoes(other: Trial, winner: Trial) -> bool:
    """Whether what was refused is worth so much more than a winner that it is not told from it."""
    return (1.0 - NEAR) * other.worth > winner.worth


def _may_be(winner: Trial, other: Trial) -> bool:
    """Whether a winner has the form that comes near to all of its family: a fall that is late.

    Over within the pre-sliding it is a break-away that fades, whatever that grows and fades with.
    """
    same = winner.candidate.record.family == other.candidate.record.family
    if not same or winner.candidate.shape.get(FALL, 0.0) == 0.0:
        return False
    model = winner.model
    effect = next(each for each in model.plant.effects if each.name == winner.name)
    way = effect.parameters["velocity"].value * effect.parameters["time"].value
    return way < scales_of(model.evidence, model.plant).units["presliding"]


def _head(winner: Trial, rivals: Sequence[Trial]) -> Trial:
    """Under whose name a cause stands that is not told from others: the simplest of the best.

    What explains the same with fewer parameters is likelier; and what was refused for the spread
    of its gain over blocks alone may still be better than what passed.
    """
    group = [winner, *(trial for trial in rivals if not trial.reason or trial.by_blocks)]
    best = max(trial.worth for trial in group)
    near = [trial for trial in group if trial.worth >= (1.0 - NEAR) * best]

    def simplicity(trial: Trial) -> tuple[int, float, float]:
        shapes = len(trial.candidate.record.shapes) if _twins(trial, winner) else math.inf
        return trial.candidate.parameters, shapes, -trial.worth

    return min(near, key=simplicity)


def _twins(one: Trial, other: Trial) -> bool:
    """Whether two members of a family are one thing: cogging once a turn is an unbalance.

    The narrower of the two names says all that the other does.
    """
    if one.candidate.record.family != other.candidate.record.family:
        return False
    near = abs(one.worth - other.worth) <= THE_SAME * abs(one.worth)
    return near and _cosine(one, other) >= 1.0 - THE_SAME


def _kin(winner: Trial, other: Trial) -> bool:
    """Whether a winner whose strength is not quite even may be another member of its family."""
    same = winner.candidate.record.family == other.candidate.record.family
    return same and winner.uneven > UNEVEN_IN_FAMILY


def _alike(one: Trial, other: Trial) -> bool:
    """Whether two candidates explain the same part of the residual."""
    return _cosine(one, other) > ALIKE


def _cosine(one: Trial, other: Trial) -> float:
    """Magnitude of the cosine of what two candidates add to the base."""
    return parallel(one.score.signature, other.score.signature)


def parallel(one: _Contribution, other: _Contribution) -> float:
    """Magnitude of the cosine of two contributions, shape (n,) each; 0 where one is 0."""
    a, b = (each.astype(np.float64, copy=False) for each in (one, other))
    norm = float(np.linalg.norm(a) * np.linalg.norm(b))
    return abs(float(a @ b)) / norm if norm > 0.0 else 0.0


def _told(winner: Trial, other: Trial, encompasses: Encompasses | None) -> bool:
    """Whether the data tell the winner from another candidate."""
    if other.worth >= (1.0 - TOO_NEAR) * winner.worth:
        return False
    late = _may_be(winner, other)
    near = late or other.worth >= (1.0 - NEAR) * winner.worth
    if paired_z(other.model, winner.model) >= (CERTAIN_Z if near else DECIDED_Z):
        return True
    return not late and encompasses is not None and encompasses(winner, other)
