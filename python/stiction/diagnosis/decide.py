"""The decision: which candidate is accepted, and which others these data cannot tell from it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np

from ..fitting.rows import Mask
from ..trajectory import FloatArray
from .candidates import Candidate
from .confirmed import confirmed as is_confirmed
from .confirmed import in_few_blocks
from .homogeneity import unevenness
from .influence import limited
from .model import LEAST_GIVEN, Model
from .ranges import is_whole, out_of_its_range, partly_lost
from .screen import Score

__all__ = [
    "Choice",
    "Trial",
    "choose",
    "covers",
    "heldout_gain",
    "judge",
    "log_gain",
    "parallel",
    "strangers",
]

LEAST_GAIN: Final = 0.025
"""Held-out gain below which an effect is not worth a name."""
LEAST_Z: Final = 2.0
"""Held-out gain over its standard error over blocks of 1 s."""
FEWEST_RECORDINGS: Final = 4
"""Fewer recordings held out have no best one to do without."""
FEWEST_BLOCKS: Final = 2
"""Held-out blocks in which an effect acts, for their gain to say anything of it."""
TELLING: Final = 0.01
"""Blocks that change by less than this share of the mean change count for neither side."""
TOUCHED: Final = 0.01
"""Blocks with less than this share of an effect's mean power are none of its business."""
PENALTY: Final = 0.004
"""Of log-gain per parameter: flexible wrong effects imitate right ones."""
MOST_TIMES: Final = 4.0
"""What a refit explains over what the screening promised: causes that were hidden came to 2.8, and
what stood in for one that had been left out to 4.1 and more."""
NEAR: Final = 0.15
"""Within this share of the winner's log-gain blocks have to be certain to tell another candidate
apart..."""
TOO_NEAR: Final = 0.04
"""... and within this one nothing does: it may be the same cause in another form."""
DECIDED_Z: Final = 2.0
"""Difference to the winner over its standard error that tells two candidates apart."""
CERTAIN_Z: Final = 3.0
"""The same for those that are near."""
ALIKE: Final = 0.5
"""Cosine of two contributions above which they explain the same."""
THE_SAME: Final = 1e-5
"""Two fits and contributions that differ by less than this share are one: fits end that near."""
LEAST_INERTIA: Final = 0.2
"""A machine that loses more of its inertia beside an effect has been explained away."""
LEAST_STRENGTH: Final = 3.5
"""Gains over their standard errors (the root of Wald's statistic), from residuals correlated within
blocks: one number that no number of rows makes large by itself."""
SURE: Final = 35.0
"""Of the same, for blocks held out to confirm it: mimics in many blocks that these spoke for came
to 9."""
MOST_AGAIN: Final = 8.0
"""A cause gains less than so many times on rows held out what it explains of those it was fitted
to."""
MOST_UNEVEN: Final = 0.3
"""What strengths of their own by kind of recording may add, as a share of a gain: with more
the effect imitates something else."""
OUT_OF_RANGE: Final = 1.0
"""Stands for that where its shape says that it is something else."""
UNEVEN_IN_FAMILY: Final = 0.12
"""The same, from which on a member of a family stands for the family alone."""
LEAST_SIZE: Final = 0.001
"""Contribution, as a share of the friction, below which an effect is of no relevance."""


@dataclass(frozen=True)
class Trial:
    """A candidate, refitted together with the base.

    Attributes
    ----------
    score : Score
    model : Model
        The base with the effect.
    gain : float
        Held-out gain over the base.
    z : float
        Of the held-out gain over blocks.
    worth : float
        Log-gain on train plus log-gain held out, less 0.004 per parameter.
    strength : float
        Gains over their standard errors.
    size : float
        rms of the effort that the effect contributes, as a share of the friction's.
    reason : str
        Why it was refused, "" where it was not.
    by_blocks : bool
        Refused because its held-out gain varies too much over blocks, or because it can do nothing
        in them, and for nothing else.
    unseen : bool
        The rows held out are none of its business: they can speak neither for nor against it.
    freed : bool
        It explains far more than its signature can: the refit freed a base that was caught.
    uneven : float
        What strengths of their own by kind of recording would add, as a share of its gain; 1
        where its shape says that it is something else.
    partly : bool
        Its gain would have to be whole and is not: the curve that is found is another cause's.
    doubtless : bool
        Refused because it acts in none of the blocks held out, or in one recording of them, while
        what was fitted leaves no doubt of it.
    """

    score: Score
    model: Model
    gain: float
    z: float
    worth: float
    strength: float
    size: float
    reason: str
    by_blocks: bool = False
    uneven: float = 0.0
    unseen: bool = False
    freed: bool = False
    partly: bool = False
    doubtless: bool = False

    @property
    def imitates(self) -> bool:
        """Whether its shape or its strength in different kinds of recording shows it no cause."""
        return self.uneven > MOST_UNEVEN

    @property
    def is_uneven(self) -> bool:
        """Whether its strength in different kinds of recording alone shows that."""
        return MOST_UNEVEN < self.uneven < OUT_OF_RANGE

    @property
    def candidate(self) -> Candidate:
        """The effect."""
        return self.score.candidate

    @property
    def name(self) -> str:
        """Name of the effect."""
        return self.candidate.name


Encompasses = Callable[[Trial, Trial], bool]


@dataclass(frozen=True)
class Choice:
    """The accepted candidate of one round.

    Attributes
    ----------
    winner : Trial
    rivals : tuple of Trial
        Others that explain the same about as well, likeliest first.
    """

    winner: Trial
    rivals: tuple[Trial, ...]

    @property
    def decided(self) -> bool:
        """Whether the data tell the winner from all others."""
        return not self.rivals


def judge(base: Model, score: Score, model: Model, contributed: FloatArray, size: float) -> Trial:
    """Compares a refitted candidate with the base it was added to.

    ``contributed`` is what the effect explains of each row, shape (n,): blocks in which it can do
    nothing say nothing of it.
    """
    block = base.evidence.cells.block
    power = np.bincount(block, contributed**2, int(block.max()) + 1)
    touched = power > TOUCHED * float(np.mean(power))
    gain, z = heldout_gain(base, model, touched)
    unseen = int(np.sum(touched & (base.blocks[1] > 0.0))) < FEWEST_BLOCKS
    explained = 1.0 - model.power / base.power if base.power > 0.0 else 0.0
    # Of what is late the slope at no delay does not tell how much it explains, nor that of what
    # stands before the drive of a simulated loop.
    record = score.candidate.record
    untold = record.late or (base.evidence.loop and record.before_drive)
    freed = not untold and explained > MOST_TIMES * max(score.score, score.threshold)
    reason = ""
    by_blocks = lone = False
    strength = model.strength(score.candidate)
    # What is known so well where it was fitted, rows held out may confirm, however they vary.
    gain_known = is_whole(score.candidate, model)
    confirmed = cache(
        lambda: strength >= SURE and is_confirmed(base, model, contributed, whole=gain_known)
    )
    if model.given <= LEAST_GIVEN:
        reason = "takes away the effort itself, so that nothing is left to explain"
    elif model.plant.inertia < LEAST_INERTIA * base.plant.inertia:
        reason = "takes away the inertia, so that hardly any motion is left to explain"
    elif explained <= 0.0:
        reason = "fits no better than without it"
    elif explained <= score.threshold:
        reason = (
            f"explains {100 * explained:.2f} % of the residual, and noise alone reaches "
            f"{100 * score.threshold:.2f} %"
        )
    elif freed:
        reason = (
            f"explains {100 * explained:.1f} % of the residual where its signature can explain "
            f"{100 * score.score:.1f} %: the base was freed, which is no effect's gain"
        )
    elif unseen and not confirmed():
        reason = "the rows held out hardly excite it"
        by_blocks = strength >= LEAST_STRENGTH and size >= LEAST_SIZE
    elif gain <= 0.0:
        reason = "does not help on rows held out"
    elif gain <= LEAST_GAIN:
        reason = f"gains {100 * gain:.2f} % on rows held out, below {100 * LEAST_GAIN:.2f} %"
    elif gain > MOST_AGAIN * (again := max(explained, _again(base, model))):
        reason = (
            f"gains {gain / again:.0f} times on rows held out what it explains where it "
            "was fitted: there the base had lost the machine, and anything finds it again"
        )
    elif z <= LEAST_Z and not confirmed():
        reason = f"its held-out gain is {z:.2f} standard errors, below {LEAST_Z:.2f}"
        by_blocks = strength >= LEAST_STRENGTH and size >= LEAST_SIZE
    elif _without_the_best(base, model, contributed) <= 0.5 * LEAST_GAIN and not confirmed():
        reason = "gains on rows held out in one recording alone"
        lone = size >= LEAST_SIZE and _acting(base, contributed) <= 1
    elif strength < LEAST_STRENGTH:
        reason = f"its strength is {strength:.2f} standard errors, below {LEAST_STRENGTH:.2f}"
    elif size < LEAST_SIZE:
        reason = (
            f"contributes {100 * size:.2g} % of the friction, below the {100 * LEAST_SIZE:.2g} % "
            "that matter"
        )
    open_ = not reason or by_blocks
    uneven = unevenness(base, model, contributed) if open_ else 0.0
    partly = partly_lost(score.candidate, model, strength)
    beyond = partly or out_of_its_range(score.candidate, model)
    # What many fitted blocks leave no doubt of, and what decides can say nothing about.
    untold = (unseen and by_blocks) or lone
    doubtless = (
        untold
        and strength >= SURE
        and gain >= 0.0
        and not beyond
        and (gain_known or not in_few_blocks(base, contributed))
        and unevenness(base, model, contributed) <= MOST_UNEVEN
    )
    beyond = beyond if open_ else ""
    if beyond:
        by_blocks, uneven = False, OUT_OF_RANGE
        reason = f"imitates something else: its {beyond}"
    elif uneven > MOST_UNEVEN:
        by_blocks = False
        reason = (
            "imitates something else: strengths of their own by kind of recording would add "
            f"{100 * uneven:.0f} % to its gain"
        )
    worth = log_gain(base, model) - PENALTY * score.candidate.parameters
    return Trial(
        score=score,
        model=model,
        gain=gain,
        z=z,
        worth=worth,
        strength=strength,
        size=size,
        reason=reason,
        by_blocks=by_blocks,
        uneven=uneven,
        unseen=unseen,
        freed=freed,
        partly=bool(partly),
        doubtless=doubtless,
    )


def _again(base: Model, model: Model) -> float:
    """Share of the fitted power that a model removes, no block counting for too much."""
    before, after = limited(base.blocks[0], model.blocks[0])
    total = float(before.sum())
    return 1.0 - float(after.sum()) / total if total > 0.0 else 0.0


def heldout_gain(base: Model, model: Model, touched: Mask | None = None) -> tuple[float, float]:
    """Share of the held-out power that a model removes, and that over its standard error.

    ``touched`` says which blocks the second figure is taken over, all without it.
    """
    before, after = limited(base.blocks[1], model.blocks[1])
    seen = before > 0.0
    total = float(before.sum())
    gained = float((before - after)[seen].sum())
    difference = (before - after)[seen if touched is None else seen & touched]
    if total <= 0.0:
        return 0.0, 0.0
    return gained / total, max(_z(difference), _sign_z(difference))


def _without_the_best(base: Model, model: Model, contributed: FloatArray) -> float:
    """Held-out gain without the recordings that gain most and least; the whole gain of a few.

    In a recording in which the base has lost the machine anything may find it again. Recordings in
    which the effect does nothing count for neither side: in one of them the base may lose it.
    """
    cells = base.evidence.cells
    of_block = np.zeros(len(base.blocks[1]), dtype=np.int64)
    of_block[cells.block] = cells.recording
    before, after = limited(base.blocks[1], model.blocks[1])
    whole, left = (np.bincount(of_block, power) for power in (before, after))
    explained = np.bincount(cells.recording, contributed**2, len(whole))
    rows = np.bincount(cells.recording, minlength=len(whole))
    touched = explained > TOUCHED * float(np.mean(contributed**2)) * rows
    held = np.flatnonzero(whole > 0.0)
    if len(held) < FEWEST_RECORDINGS:
        return 1.0
    held = held[touched[held]] if np.sum(touched[held]) > 1 else held
    in_order = held[np.argsort((whole - left)[held])]
    # As it may find the machine again in one, it may lose it in another.
    kept = in_order[1:-1] if len(in_order) >= FEWEST_RECORDINGS else in_order[:-1]
    return float(1.0 - left[kept].sum() / whole[kept].sum())


def _acting(base: Model, contributed: FloatArray) -> int:
    """Number of recordings held out in which an effect acts."""
    recording = base.evidence.cells.recording
    held = np.zeros(len(contributed), dtype=bool)
    for plan in base.evidence.plans:
        held |= plan.held
    power = np.bincount(recording[held], contributed[held] ** 2)
    return int(np.sum(power > TOUCHED * max(float(power.max()), 1e-300)))


def _sign_z(values: FloatArray) -> float:
    """How far more values are positive than chance makes them, in standard deviations.

    Where a few blocks hold most of the power, a sum over its standard error says little however
    clearly every block improves.
    """
    if len(values) == 0:
        return 0.0
    telling = values[np.abs(values) > TELLING * float(np.mean(np.abs(values)))]
    if len(telling) == 0:
        return 0.0
    return (2.0 * float(np.sum(telling > 0.0)) - len(telling)) / math.sqrt(len(telling))


def log_gain(base: Model, model: Model) -> float:
    """Logarithm of the power before over that after, on train and held out, added."""
    total = 0.0
    for whole, less in zip(base.blocks, model.blocks, strict=True):
        before, after = limited(whole, less)
        if before.sum() > 0.0 and after.sum() > 0.0:
            total += math.log(float(before.sum()) / float(after.sum()))
    return total


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
    winner = accepted[0]
    if strangers(trials, winner):
        return None
    # Who falls short by a little on its own may still be what the winner imitates.
    rivals = [
        other
        for other in ranked
        if other is not winner
        and not other.partly
        and (other.gain > 0.0 or other.by_blocks)
        and (not other.imitates or _outdoes(other, winner))
        and (
            (_alike(winner, other) and not _told(winner, other, encompasses)) or _kin(winner, other)
        )
    ]
    head = _head(winner, rivals)
    others = [trial for trial in (winner, *rivals) if trial is not head]
    if winner.uneven > UNEVEN_IN_FAMILY:
        # Who stands for a family stands for its twin as well.
        return Choice(head, tuple(others))
    return Choice(head, tuple(trial for trial in others if not _twins(head, trial)))


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


def parallel(a: FloatArray, b: FloatArray) -> float:
    """Magnitude of the cosine of two contributions, shape (n,) each; 0 where one is 0."""
    norm = float(np.linalg.norm(a) * np.linalg.norm(b))
    return abs(float(a @ b)) / norm if norm > 0.0 else 0.0


def _told(winner: Trial, other: Trial, encompasses: Encompasses | None) -> bool:
    """Whether the data tell the winner from another candidate."""
    if other.worth >= (1.0 - TOO_NEAR) * winner.worth:
        return False
    difference = np.zeros(len(winner.model.blocks[0]))
    for worse, better in zip(other.model.blocks, winner.model.blocks, strict=True):
        after, before = limited(worse, better)
        difference += after - before
    least = CERTAIN_Z if other.worth >= (1.0 - NEAR) * winner.worth else DECIDED_Z
    if _z(difference[difference != 0.0]) >= least:
        return True
    return encompasses is not None and encompasses(winner, other)


def _z(values: FloatArray) -> float:
    """Sum over its standard error, values being independent."""
    if len(values) < 2:
        return 0.0
    error = float(np.std(values, ddof=1)) * math.sqrt(len(values))
    return float(values.sum()) / error if error > 0.0 else 0.0
