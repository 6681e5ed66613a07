"""Forward selection: screen, refit the best, decide, go on until nothing passes."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from ..catalogue import EffectRecord, effects
from ..fitting.rows import Nuisances
from ..plant import Plant
from ..shooting import ShootingForm
from ..trajectory import FloatArray
from . import listing
from .candidates import Candidate, candidates, present, scales_of
from .decide import (
    LEAST_GAIN,
    LEAST_STRENGTH,
    Choice,
    Trial,
    choose,
    heldout_gain,
    judge,
    strangers,
)
from .evidence import Evidence
from .model import Model, fitted, power_of, stepped, with_effect, without_effect
from .replay import centre, shared
from .result import CandidateRow
from .screen import Problem, Score, Signatures, screen
from .selection import Search

__all__ = ["MOST_EFFECTS", "friction_of", "search"]

MOST_EFFECTS: Final = 4
"""Effects added at most: who lacks more than that needs another law."""
REFITTED: Final = 5
"""Candidates refitted in a round."""
SLIGHT: Final = 0.1
"""A candidate that explains less than this share of one that passed is not refitted beside it."""
MOST_RENEWALS: Final = 2
"""Times that the base is replaced by a better fit of itself."""
WORTH_RENEWING: Final = 0.005
"""Share of its residual's power that makes that worth while."""
LATE_SHARE: Final = 0.5
"""Of the kernel's support: a follower that keeps noise from friction is late by less."""
SHARES: Final = (0.1, 0.3, 0.6, 1.0, 1.7, 3.0)
"""Shares of the screened gain among which a refit by simulation picks its start."""
KEPT: Final = 0.75
"""Share of what the screening promises that a refit keeps, unless it is caught."""
CAUTIOUS: Final = 0.1
"""Share of the screened gain to start from where the whole of it leads astray."""

MUCH: Final = 0.05
MANY_TIMES: Final = 5.0
"""A score of this size, and so many times its threshold, is refitted whatever it does held out."""

AT_THE_DRIVE: Final = frozenset({"input map", "input delay", "input lag"})
"""Hooks of effects that a machine without a drive cannot have."""
LEAST_OF_NOISE: Final = 0.01
"""What leaves a smaller share of the power that noise alone leaves explains nothing: it makes what
was measured vanish."""
MIMIC: Final = 5.0
"""What keeps less than one part in so many of its gain beside a later effect was its mimic."""

_logger = logging.getLogger(__name__)


def search(
    evidence: Evidence, base: Model, null: FloatArray, *, without: Sequence[str] = ()
) -> Search:
    """Adds effects to a base as long as one passes.

    Parameters
    ----------
    evidence : Evidence
    base : Model
    null : numpy.ndarray, shape (n, surrogates)
        Residuals of the surrogates.
    without : sequence of str
        Effects that are not tried.
    """
    found = Search([base])
    bias, centred = centre(null)
    bias = shared(bias, base.residual, evidence.cells.recording)
    try:
        tried = _candidates(evidence, base, without, found)
        if not tried:
            return found
        signatures = Signatures.of(evidence, base.plant, base.nuisances, tried)
        friction = friction_of(evidence, base)
        evidence.floor = float(np.mean(np.sum(null[evidence.fitted] ** 2, axis=0)))
        dropped: set[str] = set()
        renewed = 0
        while len(found.choices) < MOST_EFFECTS:
            choice = _round(evidence, found, signatures, centred, bias, friction)
            if choice is not None and renewed < MOST_RENEWALS and _renew(evidence, found, choice):
                renewed += 1
                continue
            if choice is None or choice.winner.name in dropped:
                break
            found.choices.append(choice)
            found.models.append(choice.winner.model)
            _logger.info("found %s", choice.winner.name)
            _sharpen(evidence, found, signatures, centred, bias, friction)
            dropped |= _drop(evidence, found)
        for place in range(len(found.choices) - 1):
            _swap(evidence, found, place, signatures, centred, bias, friction)
    except KeyboardInterrupt:
        found.interrupted = True
    return found


def _candidates(
    evidence: Evidence, base: Model, without: Sequence[str], found: Search
) -> list[Candidate]:
    """What to try, and a row for each effect that is not tried."""
    scales = scales_of(evidence, base.plant)
    channels = set.intersection(*(set(r.channels) for r in evidence.recordings))
    if all(form.own(base.plant).hangs for form in evidence.forms):
        channels.add("load")
    tried: list[Candidate] = []
    for record in effects():
        if record.name in without:
            continue
        missing = [name for name in record.channels if name not in channels]
        if present(base.plant, record):
            reason = _where(base.plant, record)
        elif record.rotary_only and base.plant.motion != "rotary":
            reason = "only a machine that turns can have it"
        elif evidence.plant.prescribed_motion and not AT_THE_DRIVE.isdisjoint(record.hooks):
            reason = "there is no drive where the motion is prescribed"
        elif missing:
            reason = f"not testable: no channel {missing[0]} was recorded"
            found.blind.append(record)
        else:
            tried += candidates(record, scales)
            continue
        found.rows[record.name] = CandidateRow(record.name, None, None, None, reason)
    return tried


def _where(plant: Plant, record: EffectRecord) -> str:
    """Where a plant holds an effect already."""
    if any(effect.name == record.name for effect in plant.effects):
        return "part of the plant"
    body = any(term.startswith("body.") for term in record.law_terms)
    return "part of the body" if body else "part of the law"


def _round(
    evidence: Evidence,
    found: Search,
    signatures: Signatures,
    centred: FloatArray,
    bias: FloatArray,
    friction: float,
) -> Choice | None:
    taken = {choice.winner.name for choice in found.choices}
    problem = _problem(evidence, found.models[-1], centred, bias)
    scores = [
        score
        for score in screen(problem, signatures, friction)
        if score.candidate.name not in taken
    ]
    for score in scores:
        # Later rounds tell of what is left; what an effect is told by is its first one.
        if not found.choices:
            found.rows[score.candidate.name] = listing.screened(score)
            if not score.testable:
                found.blind.append(score.candidate.record)
    passing = [score for score in scores if _promises(score)]
    trials: list[Trial] = []
    for score in passing[:REFITTED]:
        if not _hopeless(score, trials):
            trials.append(_trial(evidence, found.models[-1], signatures, score, friction))
    tried = {trial.name for trial in trials}
    for score in passing:
        if score.candidate.name not in tried:
            row = found.rows[score.candidate.name]
            found.rows[row.name] = replace(row, reason="others explain more")
    choice = choose(trials) or _beside(evidence, trials, signatures, centred, bias, friction)
    found.imitated = max((t.gain for t in trials if t.imitates and choice is None), default=0.0)
    for trial in trials:
        if choice is not None or not found.choices:
            found.rows[trial.name] = listing.tried(trial, choice)
    return choice


def _beside(
    evidence: Evidence,
    trials: Sequence[Trial],
    signatures: Signatures,
    centred: FloatArray,
    bias: FloatArray,
    friction: float,
) -> Choice | None:
    """What would pass, had not another trial looked like the cause that it imitates.

    Two causes at once make each other's strength uneven: the one that was refused for that is asked
    again beside the one that passed. If it passes there, both are causes.
    """
    passed = sorted((t for t in trials if not t.reason), key=lambda t: -t.worth)
    other = next((t for w in passed[:1] for t in strangers(trials, w) if t.imitates), None)
    if other is None:
        return None
    choice = choose([trial for trial in trials if trial is not other])
    if choice is None:
        return None
    model = choice.winner.model
    scores = screen(_problem(evidence, model, centred, bias), signatures, friction)
    score = next(each for each in scores if each.candidate.name == other.name)
    if not _promises(score) or _trial(evidence, model, signatures, score, friction).reason:
        return None
    _logger.info("%s passes beside %s", other.name, choice.winner.name)
    return choice


def _fitted(evidence: Evidence, plant: Plant, nuisances: Nuisances, *, only: str = "") -> Model:
    """The plant fitted, whole or not at all.

    A fit keeps its best at Ctrl-C and goes on from there; one of several that make a decision must
    end all of them.
    """
    model = fitted(evidence, plant, nuisances, only=only)
    if model.solution.interrupted:
        raise KeyboardInterrupt
    return model


def _promises(score: Score) -> bool:
    """Whether a candidate is worth a refit: it explains more than noise, and it carries over.

    Gains of a base that has lost a recording carry over badly; what explains much and far more than
    noise is worth a look with everything fitted anew.
    """
    if not score.testable or score.score <= score.threshold:
        return False
    if score.candidate.record.late:
        # By more than a sample the slope at no delay tells that something is late, not by how much.
        return True
    return score.heldout > 0.0 or score.score > max(MUCH, MANY_TIMES * score.threshold)


def _hopeless(score: Score, trials: Sequence[Trial]) -> bool:
    """Whether one that was refitted and passed explains so much more that this one need not be.

    Members of its family are always asked: what they explain is much the same.
    """
    family = score.candidate.record.family
    passed = [trial for trial in trials if not trial.reason]
    if any(trial.candidate.record.family == family for trial in passed):
        return False
    return any(score.score < SLIGHT * trial.score.score for trial in passed)


def _problem(evidence: Evidence, model: Model, centred: FloatArray, bias: FloatArray) -> Problem:
    """What a model leaves, to be screened."""
    return Problem(
        model.residual - bias,
        model.columns,
        centred,
        evidence.cells.block,
        evidence.fitted,
        evidence.plans,
    )


def _trial(
    evidence: Evidence, base: Model, signatures: Signatures, score: Score, friction: float
) -> Trial:
    """A candidate refitted together with a model, and judged."""
    _logger.info("refitting with %s", score.candidate.name)
    model = _refit(evidence, base, signatures, score)
    contributed = _contributed(signatures, score, model)
    size = float(np.sqrt(np.mean(contributed**2))) / max(friction, 1e-300)
    trial = judge(base, score, model, contributed, size)
    reason = trial.reason or _too_good(evidence, model) or _friction_is_late(evidence, model)
    return replace(trial, reason=reason)


def _sharpen(
    evidence: Evidence,
    found: Search,
    signatures: Signatures,
    centred: FloatArray,
    bias: FloatArray,
    friction: float,
) -> None:
    """Gives the effect that was found last a second wave where that passes like an effect.

    What repeats with position is seldom a sine, and the rest of it would be taken for another
    effect.
    """
    choice = found.choices[-1]
    if not choice.winner.candidate.record.second:
        return
    model = found.models[-1]
    own = signatures.second_of(
        next(each for each in model.plant.effects if each.name == choice.winner.name)
    )
    if not own.candidates:
        return
    (score,) = screen(_problem(evidence, model, centred, bias), own, friction)
    if not _promises(score):
        return
    trial = _trial(evidence, model, own, score, friction)
    if not trial.reason:
        _logger.info("%s has a second wave", choice.winner.name)
        found.models[-1] = trial.model
        winner = replace(choice.winner, model=trial.model)
        found.choices[-1] = replace(choice, winner=winner)


def _renew(evidence: Evidence, found: Search, choice: Choice) -> bool:
    """Whether the base alone does better from where the winner led it; then it is replaced.

    A fit that was caught looks as if an effect had freed it: what the base can do by itself is no
    effect's gain.
    """
    model, base = choice.winner.model, found.models[-1]
    alone = _fitted(evidence, without_effect(model.plant, choice.winner.name), model.nuisances)
    if alone.power > (1.0 - WORTH_RENEWING) * base.power:
        return False
    _logger.info("the base does better from another start")
    found.models[-1] = alone
    return True


def _drop(evidence: Evidence, found: Search) -> set[str]:
    """Takes out earlier effects that are not needed beside the latest one.

    What explains a part of the residual first may be a mimic of what explains the whole of it.
    """
    dropped = set()
    for choice in found.choices[:-1]:
        whole = found.models[-1]
        name = choice.winner.name
        weak = whole.strength(choice.winner.candidate) < LEAST_STRENGTH
        if not weak and choice.winner.gain <= MIMIC * LEAST_GAIN:
            continue
        less = _fitted(evidence, without_effect(whole.plant, name), whole.nuisances)
        left = heldout_gain(less, whole)[0]
        # Of what it was taken for, a mimic keeps next to nothing beside its cause.
        if left > LEAST_GAIN or not (weak or left < choice.winner.gain / MIMIC):
            continue
        latest = found.choices[-1].winner.name
        _logger.info("%s is not needed beside %s", name, latest)
        row = found.rows[name]
        found.rows[name] = replace(row, reason=f"not needed beside {latest}")
        kept = [each for each in found.choices if each is not choice]
        found.models[:] = _chain(evidence, found.models[0], kept, less)
        found.choices[:] = kept
        dropped.add(name)
    return dropped


def _chain(evidence: Evidence, base: Model, choices: Sequence[Choice], last: Model) -> list[Model]:
    """The models behind some choices, made anew: each entry is measured beside those before it."""
    plants = [last.plant]
    for later in reversed(choices[1:]):
        plants.append(without_effect(plants[-1], later.winner.name))
    between = [_fitted(evidence, plant, last.nuisances) for plant in reversed(plants[1:])]
    return [base, *between, last]


def _swap(
    evidence: Evidence,
    found: Search,
    place: int,
    signatures: Signatures,
    centred: FloatArray,
    bias: FloatArray,
    friction: float,
) -> None:
    """Asks again whether an early choice or a relative of it stands better beside the later ones.

    What was chosen first was compared while the rest was still missing.
    """
    choice, whole = found.choices[place], found.models[-1]
    record = choice.winner.candidate.record
    effect = next(each for each in whole.plant.effects if each.name == record.name)
    taken = {each.winner.name for each in found.choices} - {record.name}
    tried = {each.name: each.record for each in signatures.candidates if each.name not in taken}
    kin = {name for name, other in tried.items() if other.family == record.family}
    if len(kin) < 2 or any(name in effect.parameters for name in record.second):
        return
    less = _fitted(evidence, without_effect(whole.plant, record.name), whole.nuisances)
    scores = screen(_problem(evidence, less, centred, bias), signatures, friction)
    trials = [
        _trial(evidence, less, signatures, score, friction)
        for score in scores
        if score.candidate.name in kin and score.score > score.threshold
    ]
    again = choose(trials)
    if again is None:
        return
    choices = [*found.choices[:place], again, *found.choices[place + 1 :]]
    if again.winner.name != record.name:
        _logger.info("%s stands better than %s", again.winner.name, record.name)
        found.models[:] = _chain(evidence, found.models[0], choices, again.winner.model)
    found.choices[:] = choices
    for trial in trials:
        found.rows[trial.name] = listing.tried(trial, again)


def _refit(evidence: Evidence, base: Model, signatures: Signatures, score: Score) -> Model:
    """The base with an effect, fitted from where the screening says; from near 0 if that fails."""
    index = signatures.candidates.index(score.candidate)
    explained = signatures.columns[:, signatures.slices[index]] @ score.gains

    def begun(share: float) -> Plant:
        plant = stepped(base, share * explained)
        return with_effect(plant, score.candidate, (share * score.gains).tolist())

    # A simulated motion breaks away or does not: slopes tell little of what a whole gain does.
    start = begun(1.0)
    if any(isinstance(form, ShootingForm) for form in evidence.forms):
        plants = [begun(share) for share in SHARES]
        start = min(plants, key=lambda plant: power_of(evidence, plant, base.nuisances))
    model = _fitted(evidence, start, base.nuisances)
    if model.power < (1.0 - KEPT * score.score) * base.power:
        return model
    # Short of what the screening promised it is caught: a base that has bent itself towards the
    # effect jumps too far at once, and a contact that all but loses its track has a kink on every
    # side. Then the effect alone moves first, and the base follows.
    tried = [model]
    for share in (1.0, CAUTIOUS):
        start = with_effect(base.plant, score.candidate, (share * score.gains).tolist())
        alone = _fitted(evidence, start, base.nuisances, only=score.candidate.name)
        tried.append(_fitted(evidence, alone.plant, alone.nuisances))
        if alone.power < base.power:
            break
    return min(tried, key=lambda each: each.power)


def friction_of(evidence: Evidence, base: Model) -> float:
    """Weighted rms of what the base needs beside inertia: friction, gravity, added efforts."""
    needed = evidence.stack(
        lambda rows: rows.form.mean(
            rows.form.along(base.plant, base.nuisances.start(rows.index))[1]
        )
    )
    return float(np.sqrt(np.mean(needed**2)))


def _too_good(evidence: Evidence, model: Model) -> str:
    """Why a model that leaves less than noise must is no machine, "" where it leaves that."""
    if model.power * model.given >= LEAST_OF_NOISE * evidence.floor:
        return ""
    return "leaves far less than the noise of these data must: it takes away what was measured"


def _friction_is_late(evidence: Evidence, model: Model) -> str:
    """Why a delay may be no delay of the input, "" where it is none or no reason stands against it.

    Where noise is kept from friction by a follower with a backlash, friction turns round late
    itself, and an input that seems late is what is left of that.
    """
    effect = model.plant.effects[-1]
    record = next(each for each in effects() if each.name == effect.name)
    if not record.late or not any(f.followed_late for f in evidence.forms):
        return ""
    (gain,) = record.gains
    if effect.parameters[gain].value > LATE_SHARE * evidence.support:
        return ""
    return "lies within what noise of the position makes friction late by"


def _contributed(signatures: Signatures, score: Score, model: Model) -> FloatArray:
    """What an effect explains of every row after its refit; shape (n,)."""
    index = signatures.candidates.index(score.candidate)
    gains = model.gains(score.candidate)
    contributed: FloatArray = signatures.columns[:, signatures.slices[index]] @ gains
    return contributed
