"""Forward selection: screen, refit the best, decide, go on until nothing passes."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence, Set
from dataclasses import replace
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ...catalogue import EffectRecord
from ...fitting.rows import timing_bound
from ..adequacy.exact_forms import several
from ..data.evidence import Evidence
from ..data.surrogates import centre, common_bias, reading_power
from ..defaults import ALPHA, SMALLEST
from ..records import CandidateRow
from ..screening.candidates import Candidate
from ..screening.model import Known, Model, without_effect
from ..screening.screen import Score
from ..screening.signatures import Signatures
from . import listing
from .beside import doubt_by_forms, doubt_by_rests
from .choose import ALIKE, Choice, choose, covers, parallel
from .decide import LEAST_GAIN, LEAST_STRENGTH, Trial, degeneracy
from .discretisation import doubt_by_discretisation
from .eligible import eligible_candidates
from .fewer import MIMIC, join, rebuild_models, remove_redundant, without
from .restarts import from_before, from_the_first
from .search import Search
from .sharpen import beside_a_second, free_shapes, has_free_shapes
from .together import pass_together, passes_beside
from .trials import (
    LESSER,
    SLIGHT,
    Screening,
    compared_fit,
    escape_local_minimum,
    promises,
    whole_fit,
)

__all__ = ["MOST_EFFECTS", "friction_of", "search"]

MOST_EFFECTS: Final = 4
"""Effects added at most: who lacks more than that needs another law."""
REFITTED: Final = 5
"""Candidates refitted in a round."""
TOO_LITTLE: Final = "explains too little to count, beside what was found"
OUTSTANDING: Final = 3.0
"""A candidate that explains this many times what any other does is refitted whatever it does held
out."""
MOST_RENEWALS: Final = 2
"""Times that the base is replaced by a better fit of itself."""
WORTH_RENEWING: Final = 0.005
"""Share of its residual's power that makes that worth while."""
LEANS: Final = 0.5
"""Share of the greatest offset of timing from which on a base may have taken a delay for one."""
RELATED: Final = 0.2
"""Cosine from which on one member of a family may be a part of another; waves of different orders
have next to none."""

_logger = logging.getLogger(__name__)


def search(
    evidence: Evidence,
    base: Model,
    null: FloatArray,
    *,
    without: Sequence[str] = (),
    smallest: float = SMALLEST,
    alpha: float = ALPHA,
    earlier: Sequence[Known | Model] = (),
    stops: Callable[[Search], bool] | None = None,
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
    smallest : float
        Share of the friction that an effect has to contribute to be worth a name.
    alpha : float
        Level of the screening for the whole session.
    earlier : sequence of Known or Model
        Fitted to the same rows: whence effects are begun as well, likelier ones first.
    stops : callable, optional
        Whether the first cause tells that the search has to be made otherwise.
    """
    found = Search([base], smallest=smallest)
    tried: list[Candidate] = []
    try:
        bias, centred = centre(null)
        centred = centred[evidence.fitted]
        bias = common_bias(bias, base.residual, evidence.cells.recording)
        tried = eligible_candidates(evidence, base, without, found)
        if not tried:
            return found
        signatures = Signatures.of(evidence, base.plant, base.nuisances, tried)
        friction = friction_of(evidence, base)
        screening = Screening(
            evidence, signatures, centred, bias, friction, smallest, alpha, earlier=earlier
        )
        if not evidence.simulated:
            evidence.floor = reading_power(evidence, base.plant, base.nuisances)
        dropped: set[str] = set()
        rests: set[str] = set()
        renewed = 0
        while len(found.choices) < MOST_EFFECTS:
            told = dict(found.rows), list(found.blind)
            choice, leads, trials = _round(screening, found, rests)
            if renewed < MOST_RENEWALS and _renewed(evidence, found, leads, told):
                renewed += 1
                continue
            if choice is None or choice.winner.name in dropped:
                _doubt_single_waves(screening, found, trials)
                break
            found.choices.append(choice)
            found.models.append(choice.winner.model)
            _logger.info("found %s", choice.winner.name)
            found.choices[-1] = free_shapes(screening, found.choices[-1])
            found.models[-1] = escape_local_minimum(_settled(found.choices[-1].winner.model))
            for trial in trials:
                if trial is not choice.winner:
                    trial.model.forget()
            if empties := degeneracy(base, found.models[-1]):
                # A fit that was stopped short of that is no better for it.
                rests.add(choice.winner.name)
                found.take_back(empties)
                continue
            if stops is not None and len(found.choices) == 1 and stops(found):
                return found
            doubt = doubt_by_discretisation(*found.models[-2:])
            if doubt := doubt or doubt_by_rests(evidence, found):
                rests.add(choice.winner.name)
                found.take_back(doubt)
                continue
            dropped |= remove_redundant(evidence, found)
            rests |= join(screening, found)
            rests |= _take_back(screening, found)
        for place in range(len(found.choices) - 1):
            _swap(screening, found, place)
    except KeyboardInterrupt:
        found.interrupted = True
        for candidate in tried:
            found.rows.setdefault(candidate.name, listing.row_of_candidate(candidate))
    return found


def _round(
    screening: Screening, found: Search, refused: Set[str]
) -> tuple[Choice | None, list[Trial], list[Trial]]:
    """What is accepted of what a model lacks, trials that may have freed the base, and all."""
    taken = refused | {choice.winner.name for choice in found.choices}
    scores = screening.scores(found.models[-1])
    scores = [score for score in scores if score.candidate.name not in taken]
    for score in scores:
        # Later rounds tell of what is left; what an effect is told by is its first one.
        if not found.choices:
            found.rows[score.candidate.name] = listing.row_of_score(score)
            if not score.testable:
                found.blind.append(score.candidate.record)
    outstanding = {score.candidate.name for score in _outstanding(scores)}
    passing = [s for s in scores if promises(s) or s.candidate.name in outstanding]
    trials: list[Trial] = []
    base = found.models[-1]
    asked = [s for s in scores if _is_asked(screening, base, s) and s not in passing[:REFITTED]]
    try:
        return *_refitted(screening, found, scores, passing, asked, trials), trials
    except KeyboardInterrupt:
        if not found.choices:
            # Nothing was decided among these; what the screening says of others holds.
            rows = [listing.row_at_interrupt(score, trials) for score in (*passing, *asked)]
            found.rows |= {row.name: row for row in rows}
        raise


def _refitted(
    screening: Screening,
    found: Search,
    scores: Sequence[Score],
    passing: Sequence[Score],
    asked: Sequence[Score],
    trials: list[Trial],
) -> tuple[Choice | None, list[Trial]]:
    """What is accepted of what passed the screening; ``trials`` is filled on the way."""
    base = found.models[-1]
    # Of a simulation a signature tells too little for one part to be told from another.
    goes_on = len(found.choices) + 1 < MOST_EFFECTS and not screening.evidence.simulated
    # What the first round tries is looked at where readings lead astray, however little it is.
    little = [s for s in passing if not screening.may_count(s)] if found.choices else []
    waiting = []
    for score in [*passing[:REFITTED], *asked]:
        if goes_on and score not in asked and _can_wait(score, base, trials):
            waiting.append(score)
        elif score in little:
            continue
        elif not _hopeless(score, trials):
            trials.append(_trial(screening, found, score, trials))
    if waiting and choose(trials) is None:
        # There will be no next round.
        trials += [_trial(screening, found, score) for score in waiting]
    trials += [_trial(screening, found, score) for score in _imitated(scores, trials)]
    trials[:] = from_before(screening, base, scores, trials)
    if first := choose(trials):
        trials[:] = from_the_first(screening, base, scores, trials, first.winner)
    tried = {trial.name for trial in trials}
    for score in passing:
        if score.candidate.name not in tried:
            row = found.rows[score.candidate.name]
            why = TOO_LITTLE if score in little else "others explain more"
            found.rows[row.name] = replace(row, reason=why)
    choice = (
        choose(trials, screening.encompasses)
        or passes_beside(screening, trials)
        or pass_together(screening, found.models[-1], trials, found.families)
    )
    doubtless = [t for t in trials if t.doubtless and choice is None]
    found.unseen = {
        t.name: 1.0 - t.model.power / base.power for t in sorted(doubtless, key=lambda t: -t.worth)
    }
    found.spread = any(_is_spread(trial) for trial in trials)
    strange = [t for t in trials if t.imitates and not t.of_reading and choice is None]
    strange = [t for t in strange if not any(covers(other, t) for other in doubtless)]
    found.imitated = max((t.gain for t in strange), default=0.0)
    for trial in trials:
        if choice is not None or not found.choices:
            found.rows[trial.name] = listing.row_of_trial(trial, choice)
    if not found.choices:
        found.tried = [t.model for t in trials if t.explained > t.score.threshold and not t.empty]
    freed = sorted((trial for trial in trials if trial.freed), key=lambda t: -t.worth)[:1]
    return choice, freed if choice is None else [*freed, choice.winner]


def _is_spread(trial: Trial) -> bool:
    """Whether a limit was refused although it helps, for where or how unevenly it does so."""
    if not (trial.reason and trial.candidate.record.limits) or trial.imitates or trial.freed:
        return False
    helps = trial.gain > LEAST_GAIN and trial.strength >= LEAST_STRENGTH
    return trial.by_blocks or helps


def _imitated(scores: Sequence[Score], trials: Sequence[Trial]) -> list[Score]:
    """What explains more than one that imitates something, and was not asked: it may be that.

    A limit that acts in a few blocks does harm in others as long as the base stands where it has
    driven it, and what resembles it beyond its own range is asked in its place.
    """
    if choose(trials) is not None:
        return []
    least = min((t.score.score for t in trials if t.imitates), default=np.inf)
    tried = {trial.name for trial in trials}
    more = [s for s in scores if s.candidate.name not in tried and s.score > s.threshold]
    return [score for score in more if score.testable and score.score > least]


def _trial(
    screening: Screening, found: Search, score: Score, others: Sequence[Trial] = ()
) -> Trial:
    """A candidate refitted beside what was found; refused where that may have left it."""
    trial = screening.trial(found.models[-1], score, others)
    trial = beside_a_second(screening, found.models[-1], trial)
    left = doubt_by_forms(screening.evidence, trial, found.families)
    return replace(trial, reason=left) if left else trial


def _outstanding(scores: Sequence[Score]) -> list[Score]:
    """What explains many times what any other family does, if it beats noise, the best first.

    Held out it may do harm as long as the base stands where the cause has driven it: what is so
    much likelier than all others is refitted all the same, and its relatives with it.
    """
    testable = sorted((s for s in scores if s.testable), key=lambda s: -s.score)
    if not testable:
        return []
    family = testable[0].candidate.record.family
    others = [s.score for s in testable if s.candidate.record.family != family]
    least = OUTSTANDING * max(others, default=0.0)
    return [s for s in testable if s.score > max(least, s.threshold)]


def _is_asked(screening: Screening, base: Model, score: Score) -> bool:
    """Whether a candidate is refitted beside those that passed, whatever it does held out.

    A loop bends itself far towards a goal that is late or held back, and from there the slope of
    such a cause tells nothing of it, nor does its score. And what a limit of the grid does on other
    rows says little of the one that the rows have; where moments are left that nothing has
    explained, nor does what it explains. And where rows are simulated, a delay and the offset of
    timing that a plant without one may have are the same slope: a base that leans on its offset
    leaves no score to a delay.
    """
    record, evidence = score.candidate.record, screening.evidence
    if evidence.loop and record.before_drive:
        return True
    if record.late and evidence.simulated:
        most = timing_bound(base.plant, evidence.shown)
        return abs(base.nuisances.timing) > LEANS * most > 0.0
    beyond_noise = score.score > score.threshold or evidence.joined
    return record.limits and score.testable and beyond_noise


def _hopeless(score: Score, trials: Sequence[Trial]) -> bool:
    """Whether one that was refitted and passed explains so much more that this one need not be.

    Members of its family are always asked: what they explain is much the same.
    """
    family = score.candidate.record.family
    passed = [trial for trial in trials if not trial.reason]
    if any(trial.candidate.record.family == family for trial in passed):
        return False
    return any(score.score < SLIGHT * trial.score.score for trial in passed)


def _can_wait(score: Score, base: Model, trials: Sequence[Trial]) -> bool:
    """Whether a candidate explains less than one that passed, and something else.

    It has its turn in the next round: there it is screened beside that.
    """

    def comes_first(trial: Trial) -> bool:
        explained = 1.0 - trial.model.power / base.power
        if trial.candidate.record.family == score.candidate.record.family:
            return False
        unlike = parallel(trial.score.signature, score.signature) <= ALIKE
        return unlike and score.score < LESSER * explained

    return any(comes_first(trial) for trial in trials if not trial.reason)


def _take_back(screening: Screening, found: Search) -> set[str]:
    """Takes out the latest effect where it may be the rest of a relative that is still there.

    No catalogue has the form of a machine's own friction: what the named one leaves of it
    looks like another of its kind, and is small beside it.
    """
    latest = found.choices[-1].winner
    for place, choice in enumerate(found.choices[:-1]):
        if _may_be_the_rest(screening, latest, choice.winner):
            _logger.info("%s may be the rest of %s", latest.name, choice.winner.name)
            found.rows[latest.name] = replace(
                found.rows[latest.name],
                reason=f"small beside {choice.winner.name}, and may be what its form leaves "
                "unexplained",
            )
            found.choices.pop()
            found.rests.append((latest.name, found.models.pop()))
            _doubt_a_single_wave(found, place, latest)
            return {latest.name}
    return set()


def _may_be_the_rest(screening: Screening, latest: Trial, other: Trial) -> bool:
    """Whether one looks like a relative that was found before it, and is small beside that.

    Waves of different orders are different things. Of others what a form leaves need not resemble
    it: the refit took away what does.
    """
    record = latest.candidate.record
    if other.candidate.record.family != record.family or latest.worth >= other.worth / MIMIC:
        return False
    if all(shape.scale != "order" for shape in record.shapes):
        return True
    explained = screening.contribution(latest.score, latest.model)
    before = screening.contribution(other.score, other.model)
    return parallel(explained, before) > RELATED


def _doubt_single_waves(screening: Screening, found: Search, trials: Sequence[Trial]) -> None:
    """Doubts each single wave of which a rest was refused for its spread over blocks alone."""
    for trial in (each for each in trials if each.by_blocks):
        for place, choice in enumerate(found.choices):
            if _may_be_the_rest(screening, trial, choice.winner):
                _doubt_a_single_wave(found, place, trial)


def _doubt_a_single_wave(found: Search, place: int, rest: Trial) -> None:
    """Leaves a single wave undecided beside a relative of several, of which it may be the first.

    What the form of an effect leaves speaks not against its name; what one wave leaves does.
    """
    choice = found.choices[place]
    single = rest.name in several(choice.winner.candidate.record)
    if single and rest.name not in {rival.name for rival in choice.rivals}:
        _logger.info("%s may be the first wave of %s", choice.winner.name, rest.name)
        found.choices[place] = replace(choice, rivals=(*choice.rivals, rest))


def _renewed(
    evidence: Evidence,
    found: Search,
    leads: Sequence[Trial],
    told: tuple[dict[str, CandidateRow], list[EffectRecord]],
) -> bool:
    """Whether a trial led to a better base; what a round decided beside the other is forgotten."""
    if not any(_renew(evidence, found, lead) for lead in leads):
        return False
    found.rows, found.blind = told
    return True


def _renew(evidence: Evidence, found: Search, lead: Trial) -> bool:
    """Whether the base alone does better from where a trial led it; then it is replaced.

    A fit that was caught looks as if an effect had freed it: what the base can do by itself is no
    effect's gain.
    """
    model, base = lead.model, found.models[-1]
    plant = without_effect(model.plant, lead.name)
    alone = compared_fit(evidence, plant, model.nuisances)
    if alone.power > (1.0 - WORTH_RENEWING) * base.power:
        return False
    _logger.info("the base does better from another start")
    found.models[-1] = _settled(alone)
    return True


def _swap(screening: Screening, found: Search, place: int) -> None:
    """Asks again whether an early choice or a relative of it stands better beside the later ones.

    What was chosen first was compared while the rest was still missing.
    """
    choice, whole = found.choices[place], found.models[-1]
    record = choice.winner.candidate.record
    effect = next(each for each in whole.plant.effects if each.name == record.name)
    taken = {each.winner.name for each in found.choices} - {record.name}
    candidates_of = screening.signatures.candidates
    tried = {each.name: each.record for each in candidates_of if each.name not in taken}
    kin = {name for name, other in tried.items() if other.family == record.family}
    if screening.evidence.loop:
        # A loop bends far more to a cause that is still missing than friction along a motion does.
        kin |= {rival.name for rival in choice.rivals} & tried.keys()
    if len(kin) < 2 or has_free_shapes(effect, record):
        return
    evidence = screening.evidence
    less = without(evidence, found, record.name)
    trials = [
        _as_it_is(screening, less, score, whole) or screening.trial(less, score)
        for score in screening.scores(less)
        if score.candidate.name in kin
        and (score.score > score.threshold or _is_asked(screening, less, score))
    ]
    again = choose(trials, screening.encompasses)
    if again is None:
        return
    choices = [*found.choices[:place], again, *found.choices[place + 1 :]]
    if again.winner.model is not whole:
        # Another effect, or the same with another shape of those that are held.
        _logger.info("%s stands better than %s", again.winner.name, record.name)
        found.models[:] = rebuild_models(evidence, found.models[0], choices, again.winner.model)
    found.choices[:] = choices
    for trial in trials:
        found.rows[trial.name] = listing.row_of_trial(trial, again)


def _as_it_is(screening: Screening, less: Model, score: Score, whole: Model) -> Trial | None:
    """The trial whose refit is the whole model; None where that has another candidate."""
    candidate = score.candidate
    effect = next((each for each in whole.plant.effects if each.name == candidate.name), None)
    if effect is None or not candidate.has_shape_of(effect):
        return None
    return screening.judge(less, score, whole, screening.contribution(score, whole))


def _settled(model: Model) -> Model:
    """The model of a trial, fitted to its end."""
    return whole_fit(model.evidence, model.plant, model.nuisances)


def friction_of(evidence: Evidence, base: Model) -> float:
    """Weighted rms of what the base needs beside inertia: friction, gravity, added efforts."""
    needed = evidence.stack(
        lambda rows: rows.form.mean(
            rows.form.along(base.plant, base.nuisances.start(rows.index))[1]
        )
    )
    return float(np.sqrt(np.mean(needed**2)))
