"""The decision on one candidate: whether a refit shows it to be a cause."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ...catalogue import EffectRecord
from ..defaults import SMALLEST
from ..screening.block_gains import (
    TOUCHED,
    count_active_recordings,
    heldout_gain,
    lacks_excitation,
    log_gain,
    training_gain,
    without_the_best,
)
from ..screening.candidates import Candidate
from ..screening.evenness import MOST_UNEVEN
from ..screening.model import LEAST_GIVEN, Model
from ..screening.screen import Score
from .homogeneity import unevenness
from .ranges import OF_READING, is_whole, out_of_its_range, partial_loss
from .replication import confirms as is_confirmed
from .replication import in_few_blocks

__all__ = [
    "LEAST_GAIN",
    "LEAST_STRENGTH",
    "LEAST_Z",
    "MOST_TIMES",
    "OUT_OF_RANGE",
    "PENALTY",
    "Trial",
    "degeneracy",
    "judge",
]

LEAST_GAIN: Final = 0.025
"""Held-out gain below which an effect is not worth a name."""
LEAST_Z: Final = 2.0
"""Held-out gain over its standard error over blocks of 1 s."""
FEWEST_BLOCKS: Final = 2
"""Held-out blocks in which an effect acts, for their gain to say anything of it."""
PENALTY: Final = 0.004
"""Of log-gain per parameter: flexible wrong effects imitate right ones."""
MOST_TIMES: Final = 4.0
"""What a refit explains over what the screening promised: causes that were hidden came to 2.8, and
what stood in for one that had been left out to 4.1 and more."""
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
SWINGS: Final = "second mass"
"""Hook of effects whose mass swings behind the effort."""
OUT_OF_RANGE: Final = float("inf")
"""Stands for that where its shape says that it is something else; no strengths add as much."""


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
        What strengths of their own by kind of recording would add, as a share of its gain;
        ``OUT_OF_RANGE`` where its shape says that it is something else.
    of_reading : bool
        What it imitates is the reading of the motion, of which nothing is missing.
    partly : bool
        Its gain would have to be whole and is not: the curve that is found is another cause's.
    empty : bool
        It leaves no effort or no inertia to be explained, which no cause does.
    doubtless : bool
        Refused because blocks held out hardly excite it, in one recording alone, or gain too
        unevenly, while what was fitted leaves no doubt of it.
    explained : float
        Share of the power that it takes off the fitted rows.
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
    of_reading: bool = False
    empty: bool = False
    doubtless: bool = False
    explained: float = 0.0

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


def comes_late(record: EffectRecord) -> bool:
    """Whether an effect is a lag of any kind, or a mass that swings behind the effort."""
    return record.late or record.friction_lags or SWINGS in record.hooks


def degeneracy(base: Model, model: Model) -> str:
    """What a model takes away in place of explaining it, "" where it leaves that.

    Along a measured motion a machine without inertia needs no effort for it. One that is simulated
    misses the motion by as much, and may well have less than a base that lacks the cause.
    """
    if model.relative_input_power <= LEAST_GIVEN:
        return "takes away the effort itself, so that nothing is left to explain"
    lost = model.plant.inertia < LEAST_INERTIA * base.plant.inertia
    if lost and not base.evidence.simulated:
        return "takes away the inertia, so that hardly any motion is left to explain"
    return ""


def judge(
    base: Model,
    score: Score,
    model: Model,
    contributed: FloatArray,
    size: float,
    smallest: float = SMALLEST,
) -> Trial:
    """Compares a refitted candidate with the base it was added to.

    ``contributed`` is what the effect explains of each row, shape (n,): blocks in which it can do
    nothing say nothing of it. ``size`` is its rms as a share of the friction's, and ``smallest``
    what is worth a name of that.
    """
    block = base.evidence.cells.block
    power = np.bincount(block, contributed**2, int(block.max()) + 1)
    touched = power > TOUCHED * float(np.mean(power))
    gain, z = heldout_gain(base, model, touched)
    unseen = int(np.sum(touched & (base.blocks[1] > 0.0))) < FEWEST_BLOCKS
    explained = 1.0 - model.power / base.power if base.power > 0.0 else 0.0
    # Slopes of a simulation tell little of a contact that breaks away or does not.
    untold = base.evidence.simulated or score.candidate.record.slope_misleads(
        loop=base.evidence.loop
    )
    freed = not untold and explained > MOST_TIMES * max(score.score, score.threshold)
    by_blocks = lone = False
    strength = model.strength(score.candidate)
    # What is known so well where it was fitted, rows held out may confirm, however they vary.
    gain_known = is_whole(score.candidate, model)
    confirmed = cache(
        lambda: strength >= SURE and is_confirmed(base, model, contributed, whole=gain_known)
    )
    reason = ""
    empties = degeneracy(base, model)
    if empties:
        reason = empties
    elif explained <= 0.0:
        reason = "fits no better than without it"
    elif explained <= score.threshold:
        reason = (
            f"explains {100 * explained:.2f} % of the residual, below the limit of "
            f"{100 * score.threshold:.2f} % that noise and misfit set"
        )
    elif freed:
        reason = (
            f"explains {100 * explained:.1f} % of the residual where its signature can explain "
            f"{100 * score.score:.1f} %: the base was freed, which is no effect's gain"
        )
    elif unseen and not confirmed():
        reason = "the rows held out hardly excite it"
        by_blocks = strength >= LEAST_STRENGTH and size >= smallest
    elif gain <= 0.0:
        reason = "does not help on rows held out"
    elif gain <= LEAST_GAIN:
        reason = f"gains {100 * gain:.2f} % on rows held out, below {100 * LEAST_GAIN:.2f} %"
        if strength >= SURE and lacks_excitation(base, contributed, LEAST_GAIN):
            reason = f"{reason}, which hardly excite it"
            unseen, by_blocks = True, size >= smallest
    elif gain > MOST_AGAIN * (again := max(explained, training_gain(base, model))):
        reason = (
            f"gains {gain / again:.0f} times on rows held out what it explains where it "
            "was fitted: there the base had lost the machine, and anything finds it again"
        )
    elif z <= LEAST_Z and not confirmed():
        reason = f"its held-out gain is {z:.2f} standard errors, below {LEAST_Z:.2f}"
        by_blocks = strength >= LEAST_STRENGTH and size >= smallest
    elif without_the_best(base, model, contributed) <= 0.5 * LEAST_GAIN and not confirmed():
        reason = "gains on rows held out in one recording alone"
        lone = size >= smallest and count_active_recordings(base, contributed) <= 1
    elif strength < LEAST_STRENGTH:
        reason = f"its strength is {strength:.2f} standard errors, below {LEAST_STRENGTH:.2f}"
    elif size < smallest:
        reason = (
            f"contributes {100 * size:.2g} % of the friction, below the {100 * smallest:.2g} % "
            "that matter"
        )
    open_ = not reason or by_blocks
    paced = comes_late(score.candidate.record)
    uneven = unevenness(base, model, contributed, paced=paced) if open_ else 0.0
    partly = partial_loss(score.candidate, model, strength)
    beyond = partly or out_of_its_range(score.candidate, model)
    # What many fitted blocks leave no doubt of, and what decides cannot judge.
    doubtless = (
        (by_blocks or lone)
        and strength >= SURE
        and gain >= 0.0
        and not beyond
        and (gain_known or not in_few_blocks(base, contributed))
        and unevenness(base, model, contributed, paced=paced) <= MOST_UNEVEN
    )
    beyond = beyond if open_ else ""
    if beyond:
        by_blocks, uneven = False, OUT_OF_RANGE
        reason = f"imitates something else: its {beyond}"
    elif uneven > MOST_UNEVEN:
        by_blocks = False
        reason = (
            "imitates something else: strengths of their own by kind of recording or pace would "
            f"add {100 * uneven:.0f} % to its gain"
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
        of_reading=beyond.endswith(OF_READING),
        empty=bool(empties),
        doubtless=doubtless,
        explained=explained,
    )
