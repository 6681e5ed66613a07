"""One candidate refitted together with a model, and judged."""

from __future__ import annotations

import logging
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ..._support.progress import phase
from ...fitting.minimise import Solution, from_elsewhere
from ...fitting.rows import Nuisances
from ...plant import Plant
from ...residual.finite import finite
from ...residual.weak_form import Start, WeakForm
from ..data.evidence import Evidence
from ..defaults import ALPHA, SMALLEST
from ..screening.candidates import Candidate
from ..screening.model import (
    REFIT_CONVERGED,
    Known,
    Model,
    fit_model,
    likeliest_of,
    step_beside,
    with_effect,
    with_last_free,
    without_effect,
)
from ..screening.noisy_input import doubt_by_input_noise
from ..screening.screen import Problem, Score, likelier, screen
from ..screening.signatures import Signatures, gain_at
from .decide import LEAST_GAIN, MOST_TIMES, Trial, degeneracy, judge
from .noisy_motion import doubt_by_noise

__all__ = [
    "KEPT",
    "LESSER",
    "SLIGHT",
    "Screening",
    "better_of",
    "compared_fit",
    "escape_local_minimum",
    "promises",
    "whole_fit",
]

COMPARED: Final = 1e-4
"""Of the power, along a measured motion: far less than what tells candidates apart."""
MOST_KEPT: Final = 4
"""Models of which scores are kept."""
SHARES: Final = (0.1, 0.3, 0.6, 1.0, 1.7, 3.0)
"""Shares of the screened gain among which a refit by simulation picks its start."""
FEW_SHARES: Final = (0.3, 1.0)
"""The same along a measured motion."""
KEPT: Final = 0.75
"""Share of what the screening promises that a refit keeps, unless it is caught."""
CAUTIOUS: Final = 0.1
"""Share of the screened gain to start from where the whole of it leads astray."""
LESSER: Final = 0.7
"""What explains less than this share of what another one does is no match for that."""
SLIGHT: Final = 0.1
"""A candidate, or its other form, that explains less than this share of one that was refitted, is
not refitted beside it."""
MUCH: Final = 0.05
MANY_TIMES: Final = 5.0
"""A score of this size, and so many times its threshold, is refitted whatever it does held out."""
ENCOMPASSING: Final = 10.0
"""So many times what noise reaches: where the other form of a cause stood before it, it came to 2,
4 and 4, and once, where blocks had told them apart as well, to 20."""
SHARES_TOLD: Final = (0.05, 0.95)
"""Share of the inertia beyond a shaft at which a fit begins."""
WORTH_MOVING: Final = 1e-3
"""Share of the power that makes another minimum a better one."""
LEAST_OF_NOISE: Final = 0.01
"""What leaves a smaller share of the power that readings alone leave explains nothing: it makes
what was measured vanish."""

_logger = logging.getLogger(__name__)


def promises(score: Score) -> bool:
    """Whether a candidate is worth a refit: it explains more than noise, and it carries over.

    Gains of a base that has lost a recording carry over badly; what explains much and far more than
    noise is worth a look with everything fitted anew.
    """
    if not score.testable or score.score <= score.threshold:
        return False
    record = score.candidate.record
    if record.late or record.swings:
        # By more than a sample the slope at no delay tells that something is late, not by how much;
        # nor does that at no compliance tell of a resonance.
        return True
    return score.heldout > 0.0 or score.score > max(MUCH, MANY_TIMES * score.threshold)


@dataclass(frozen=True)
class Screening:
    """What every round screens and refits with.

    Attributes
    ----------
    evidence : Evidence
    signatures : Signatures
    centred : numpy.ndarray, shape (n_fit, surrogates)
        Residuals of the surrogates about their mean, over the fitted rows.
    bias : numpy.ndarray, shape (n,)
        Their mean, as far as the residual shares it.
    friction : float
        Weighted rms of what the base needs beside inertia.
    smallest : float
        Share of it that an effect has to contribute to be worth a name.
    alpha : float
        Level of the screening for the whole session.
    earlier : sequence of Known or Model
        From which to begin as well: fitted to the same rows, likelier ones first.
    kept : list of (Model, list of Score)
        Of the last few models that were screened: they are asked for again and again.
    """

    evidence: Evidence
    signatures: Signatures
    centred: FloatArray
    bias: FloatArray
    friction: float
    smallest: float = SMALLEST
    alpha: float = ALPHA
    earlier: Sequence[Known | Model] = ()
    kept: list[tuple[Model, list[Score]]] = field(default_factory=list)

    def scores(self, model: Model) -> list[Score]:
        """Efficient scores of all effects for what a model leaves, the best first."""
        return likelier(self._forms(model))

    def _forms(self, model: Model) -> list[Score]:
        """The same of every form of each; those of the last few models are kept."""
        for known, scores in self.kept:
            if known is model:
                return scores
        scores = screen(self._left_by(model), self.signatures, self.friction, self.alpha)
        self.kept.append((model, scores))
        del self.kept[:-MOST_KEPT]
        return scores

    def fit(self, plant: Plant, nuisances: Nuisances) -> Model:
        """A plant fitted to its end, from these nuisances."""
        return whole_fit(self.evidence, plant, nuisances)

    def may_count(self, score: Score) -> bool:
        """Whether a candidate may gain what counts, were a refit to come to many times its promise.

        So many times as it may before it is refused for that. What is late or swings comes to more
        than its slope tells, and what is simulated to anything.
        """
        if self.evidence.simulated or self.evidence.loop:
            return True
        record = score.candidate.record
        times = 1.0 / SLIGHT if record.late or record.swings else MOST_TIMES
        return times * max(score.score, score.heldout) >= LEAST_GAIN

    def trial(self, base: Model, score: Score, others: Sequence[Trial] = ()) -> Trial:
        """A candidate refitted together with a model, and judged; in its other form if it fails.

        What fails over blocks alone may still be the cause, and speaks for its own form. ``others``
        were tried before it.
        """
        passed = [other for other in others if not other.reason]
        best = max((1.0 - other.model.power / base.power for other in passed), default=0.0)
        trial = self._tried(base, score, best)
        if not trial.reason or trial.by_blocks or trial.doubtless:
            return trial
        for other in self._forms(base):
            if other.candidate.name == trial.name and other.candidate.form != trial.candidate.form:
                worth_it = promises(other) and other.score >= SLIGHT * trial.score.score
                again = self._tried(base, other, best) if worth_it else trial
                return trial if again.reason else again
        return trial

    def _tried(self, base: Model, score: Score, best: float) -> Trial:
        phase(_logger, "refitting with %s", score.candidate.name)
        model = _refit(self.evidence, base, self.signatures, score, best)
        explained = self.contribution(score, model)
        trial = self.judge(base, score, model, explained)
        if trial.freed and score.candidate.free:
            there = self._where_it_came_to(base, score, model)
            if there.score > score.score:
                return self.judge(base, there, model, explained)
        return trial

    def judge(self, base: Model, score: Score, model: Model, explained: FloatArray) -> Trial:
        """A model with a candidate, judged; ``explained`` is what that does, shape (n,)."""
        size = float(np.sqrt(np.mean(explained**2))) / max(self.friction, 1e-300)
        if self.evidence.simulated:
            # What is over within a seventh of a second hardly shows through the kernel of a window.
            size = max(size, effort_share(self.evidence, model, score.candidate.name))
        trial = judge(base, score, model, explained, size, self.smallest)
        reason = (
            trial.reason
            or _too_good(self.evidence, model)
            or doubt_by_input_noise(base, model, trial.name, trial.gain)
            or doubt_by_noise(base, model, trial.name, trial.gain)
        )
        return replace(trial, reason=reason)

    def from_where(self, base: Model, score: Score, lead: Trial) -> Trial | None:
        """A candidate refitted from where another one has led the rest of the plant, and judged.

        A base that has bent itself towards a cause holds a refit in its valley, and does harm to
        rows held out whatever is added; not every candidate finds the way out of it. None where
        nothing is left there for it to explain.
        """
        evidence, candidate = self.evidence, score.candidate
        less = without_effect(lead.model.plant, lead.name)
        nuisances = lead.model.nuisances
        own = Signatures.of(evidence, less, nuisances, [candidate]).columns_of_fit(0)
        left = finite(evidence.residual(less, nuisances))[evidence.fitted]
        gains = np.linalg.lstsq(own, left, rcond=None)[0]
        if not np.any(gains):
            return None
        start = with_effect(less, candidate, gains.tolist())
        return self._judged_from(base, score, start, nuisances)

    def from_before(self, base: Model, score: Score) -> Trial | None:
        """A candidate refitted from where it was fitted earlier, and judged; None if it was not.

        A contact that is simulated breaks away or does not: where the base has bent itself towards
        a cause, slopes there may show nothing of it.
        """
        for model in self.earlier:
            for effect in model.plant.effects:
                if effect.name == score.candidate.name and score.candidate.has_shape_of(effect):
                    start = replace(model.plant, effects=(*base.plant.effects, effect))
                    return self._judged_from(base, score, start, model.nuisances)
        return None

    def _judged_from(self, base: Model, score: Score, start: Plant, nuisances: Nuisances) -> Trial:
        phase(_logger, "refitting with %s, from another start", score.candidate.name)
        model = compared_fit(self.evidence, start, nuisances)
        return self.judge(base, score, model, self.contribution(score, model))

    def _where_it_came_to(self, base: Model, score: Score, model: Model) -> Score:
        """The score with what the signature explains at the shape that a refit came to.

        A grid ends somewhere, and between its points a refit finds what its signatures only hint
        at: that is the effect's own gain, and no base was freed.
        """
        candidate = score.candidate
        effect = next(each for each in model.plant.effects if each.name == candidate.name)
        if candidate.record.swings:
            plant = replace(base.plant, effects=(*base.plant.effects, effect))
            column = base.residual - finite(self.evidence.residual(plant, base.nuisances))
            there = Signatures.from_columns([candidate], column[:, None], self.evidence.fitted)
        else:
            shape = {name: effect.parameters[candidate.own(name)].value for name in candidate.shape}
            there = Signatures.of(
                self.evidence, base.plant, base.nuisances, [replace(candidate, shape=shape)]
            )
        (found,) = self.with_signatures(there).scores(base)
        return replace(score, score=found.score)

    def encompasses(self, one: Trial, other: Trial) -> bool:
        """Whether one candidate explains all that another does, and much that that does not.

        What the model with the first leaves holds nothing for the second, and what the model with
        the second leaves holds many times as much for the first as noise does, held out as well
        (Mizon, Richard, Econometrica 54 (1986)). Where neither is the cause each has something for
        the other.
        """
        left = self._score(other.model, one)
        if left.score < ENCOMPASSING * left.threshold or left.heldout <= 0.0:
            return False
        more = self._score(one.model, other)
        return more.score <= more.threshold or more.heldout <= 0.0

    def _score(self, model: Model, trial: Trial) -> Score:
        """What the candidate of a trial explains of what another model leaves."""
        form = trial.candidate.form
        return next(each for each in self._forms(model) if each.candidate.form == form)

    def with_signatures(self, signatures: Signatures) -> Screening:
        """The same for other candidates."""
        return replace(self, signatures=signatures, kept=[])

    def contribution(self, score: Score, model: Model) -> FloatArray:
        """What an effect explains of every row after its refit; shape (n,)."""
        record = score.candidate.record
        if record.swings or record.limits:
            less = without_effect(model.plant, score.candidate.name)
            return finite(self.evidence.residual(less, model.nuisances)) - model.residual
        index = self.signatures.candidates.index(score.candidate)
        gains = model.gains(score.candidate)
        return self.signatures.contribution(index, gains)

    def _left_by(self, model: Model) -> Problem:
        evidence = self.evidence
        return Problem(
            model.residual - self.bias,
            model.columns,
            self.centred,
            evidence.cells.block,
            evidence.fitted,
            evidence.plans,
        )


def _refit(
    evidence: Evidence, base: Model, signatures: Signatures, score: Score, best: float
) -> Model:
    """The base with an effect, fitted; what leads astray far from a fit is varied from there on."""
    model = _from_screening(evidence, base, signatures, score, best)
    candidate = score.candidate
    if not candidate.last_shapes:
        return model
    plant = with_last_free(model.plant, candidate)
    return min((model, compared_fit(evidence, plant, model.nuisances)), key=lambda each: each.power)


def _from_screening(
    evidence: Evidence, base: Model, signatures: Signatures, score: Score, best: float
) -> Model:
    """The base with an effect, fitted from where the screening says; from near 0 if that fails.

    Where even what the screening promised would be little beside the ``best`` that another one took
    off the power, it is not asked again.
    """
    index = signatures.candidates.index(score.candidate)
    gains = score.gains
    if not np.any(gains):
        typical = {each.name: each.typical for each in score.candidate.record.parameters}
        gains = np.array([typical[name] for name in score.candidate.record.gains])
    explained = signatures.contribution(index, score.gains)

    def begun(share: float, like: Candidate, gains: FloatArray) -> Plant:
        return with_effect(step_beside(base, share * explained), like, (share * gains).tolist())

    # A contact breaks away or does not: slopes tell little of what a whole gain does.
    shares = SHARES if evidence.simulated else FEW_SHARES
    alike = _alike(signatures, index, gains, base.plant.inertia)
    plants = [begun(share, *like) for like in alike for share in shares]
    start = likeliest_of(evidence, plants, base.nuisances)
    model = compared_fit(evidence, start, base.nuisances)
    record = score.candidate.record
    untold = record.swings or record.slope_misleads(loop=evidence.loop)

    def rank(model: Model) -> tuple[bool, float]:
        # What takes away what was to be explained leaves less than any cause does.
        return bool(degeneracy(base, model)), model.power

    if rank(model) < (False, (1.0 - KEPT * score.score) * base.power):
        return model
    if score.score < LESSER * best and not untold:
        return model
    # Short of what the screening promised it is caught: a base that has bent itself towards the
    # effect jumps too far at once, and a contact that all but loses its track has a kink on every
    # side. Then the effect alone moves first, and the base follows.
    tried = [model]
    for share in (1.0, CAUTIOUS):
        start = with_effect(base.plant, score.candidate, (share * gains).tolist())
        name = score.candidate.name
        alone = compared_fit(evidence, start, base.nuisances, only=name)
        tried.append(compared_fit(evidence, alone.plant, alone.nuisances))
        if alone.power < base.power:
            break
    return escape_local_minimum(min(tried, key=rank))


def _of_its_share(
    candidate: Candidate, gain: float, inertia: float
) -> tuple[Candidate, FloatArray]:
    """A mass that swings, with the share of the inertia that the gain of its signature tells.

    Along a measured motion x a mass behind a shaft asks for s·J·(G − 1)·x'' more, where G hangs on
    its own resonance 1/√(c·s·J) alone: how much of the signature there is tells s, not c.
    """
    at = gain_at(candidate, inertia)
    share = candidate.shape["inertia_share"]
    told = float(np.clip(share * gain / at, *SHARES_TOLD))
    shape = {**candidate.shape, "inertia_share": told}
    return replace(candidate, shape=shape), np.array([at * share / told])


def _alike(
    signatures: Signatures, index: int, gains: FloatArray, inertia: float
) -> list[tuple[Candidate, FloatArray]]:
    """A candidate with its gains; where it swings also those of which slopes do not tell it.

    Their signatures are multiples of each other, and from one frequency no fit finds another.
    What was looked at where it swings starts there.
    """
    candidate = signatures.candidates[index]
    found = [(candidate, gains)]
    if candidate.resonance > 0.0:
        return [*found, _of_its_share(candidate, float(gains[0]), inertia)]
    if not candidate.record.swings:
        return found
    own = signatures.columns_of_fit(index)
    for place, other in enumerate(signatures.candidates):
        alike = other.name == candidate.name and other.resonance == 0.0
        if alike and other is not candidate:
            column = signatures.columns_of_fit(place)
            times = float(np.sum(own * column)) / max(float(np.sum(column**2)), 1e-300)
            found.append((other, times * gains))
    return found


def effort_share(evidence: Evidence, model: Model, name: str) -> float:
    """Rms of an effect of a model over that of its friction, of efforts as they act.

    Along the motions from which windows begin, sample by sample and through no kernel.

    Parameters
    ----------
    evidence : Evidence
    model : Model
    name : str
        Of the effect.
    """
    less = without_effect(model.plant, name)
    own, whole = 0.0, 0.0
    for rows in evidence.train:
        start = model.nuisances.start(rows.index)
        form = rows.form_for(model.plant, model.nuisances)
        acting, needed = _acting(form, model.plant, start)
        own += float(np.sum((acting - _acting(form, less, start)[0]) ** 2))
        whole += float(np.sum(needed**2))
    return math.sqrt(own / whole) if 0.0 < whole < math.inf else 0.0


def _acting(form: WeakForm, plant: Plant, start: Start) -> tuple[FloatArray, FloatArray]:
    """What a plant needs beside inertia, less what its drive gives; and what it needs alone."""
    drive, needed, ahead = form.along(plant, start)
    bent = np.diff(ahead, 2, prepend=ahead[:1], append=ahead[-1:]) / form.dt**2
    return finite(needed + form.own(plant).inertia * bent - drive), needed


def escape_local_minimum(model: Model) -> Model:
    """A model, or a better one from starts that it may not have seen (see ``from_elsewhere``).

    What is fitted on from a base that made up for the effect may end in the valley of that base.
    A plant of which nothing is left, drive and inertia and all, explains everything and is no
    better one.
    """
    return better_of(model, from_elsewhere(model.solution, model.evidence.train))


def better_of(model: Model, solution: Solution) -> Model:
    """A model, or what another fit of its plant came to, where that is better and leaves a machine.

    Raises
    ------
    KeyboardInterrupt
        The other fit was interrupted.
    """
    if solution.interrupted:
        raise KeyboardInterrupt
    if solution.power >= (1.0 - WORTH_MOVING) * model.solution.power:
        return model
    better = Model(model.evidence, solution, model.nuisances)
    return model if _too_good(model.evidence, better) else better


def whole_fit(
    evidence: Evidence,
    plant: Plant,
    nuisances: Nuisances,
    *,
    only: str = "",
    converged: float = REFIT_CONVERGED,
) -> Model:
    """The plant fitted, whole or not at all.

    A fit keeps its best at Ctrl-C and goes on from there; one of several that make a decision must
    end all of them.
    """
    model = fit_model(evidence, plant, nuisances, only=only, converged=converged)
    if model.solution.interrupted:
        raise KeyboardInterrupt
    return model


def compared_fit(
    evidence: Evidence, plant: Plant, nuisances: Nuisances, *, only: str = ""
) -> Model:
    """The same as far as a comparison needs it; to the end where a simulation may go astray."""
    converged = REFIT_CONVERGED if evidence.simulated else COMPARED
    return whole_fit(evidence, plant, nuisances, only=only, converged=converged)


def _too_good(evidence: Evidence, model: Model) -> str:
    """Why a model that leaves less than noise must is no machine, "" where it leaves that.

    A motion of its own has to be the measured one: nothing can take that away, and what noise does
    to it is told beside a base that may rest where the machine does not.
    """
    if evidence.simulated:
        return ""
    if model.power * model.relative_input_power >= LEAST_OF_NOISE * evidence.floor:
        return ""
    return "leaves far less than the noise of these data must: it takes away what was measured"
