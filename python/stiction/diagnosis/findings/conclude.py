"""The end of a diagnosis: what is measured once every decision is taken, and all of it in words."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from typing import Final

from ..._support.arrays import FloatArray
from ..._support.progress import phase
from ..._support.wording import join_words
from ...fitting.noise import Noise
from ...fitting.pulls import pulls_of_readings
from ...fitting.rows import Rows
from ...fitting.sign import sign_error
from ...fitting.solve import fit_remainder
from ...recording import Check
from ...residual.compared import comparison_of
from ...session import Session
from ..adequacy.bursts import Burst, burst_of, recurs
from ..adequacy.coordinates import Look, looks
from ..adequacy.exact_forms import rests_of
from ..adequacy.holds import holds_of
from ..adequacy.lone import lone_event
from ..adequacy.omnibus import Rest, rest
from ..adequacy.outlying import outlying_test_recordings
from ..adequacy.passing import MOMENTS
from ..adequacy.view import View
from ..data.ceiling import Ceiling, ceiling_of
from ..data.evidence import Evidence
from ..data.gain import HeldOut, gain_of, residuals_of
from ..data.surrogates import centre, common_bias, surrogate_residuals
from ..defaults import SMALLEST
from ..phrases import INTERRUPTED, MORE_MAY_BE, NO_COORDINATE
from ..records import LawRow, Unexplained, Verdict
from ..screening.candidates import scales_of
from ..screening.model import Model
from ..screening.regression import refit_residuals
from ..selection.confirm import (
    confirm_on_test,
    lost_share,
    lost_share_of_motion,
    lost_share_on_test,
    reject_without_machine,
)
from ..selection.held_numbers import Held, fixed_parameters, fixed_words
from ..selection.laws import THE_LAW, Rival, better_laws, event_words, law_rows, rivals_of
from ..selection.left_open import (
    beside_another_law,
    leave_open,
    leave_waves_open,
    unconfirmed_names,
)
from ..selection.listing import in_order
from ..selection.moved import borne_out_in_motion
from ..selection.rounds import friction_of
from ..selection.search import Search
from .advice import advise
from .bets import Bets, bets_of
from .loop import borne_out, with_loop_replay
from .noted import with_checks, with_pushes
from .pictures import Pictures
from .reliability import reliability_of
from .result import Diagnosis
from .told import (
    causes_of,
    effect_of,
    evaluate,
    floor_of,
    own_views,
    stretches_of,
    summary_of,
)
from .traces import traces_of
from .verdict import remainder_share, unnamed_remainder, verdict_of
from .words import apart_words, no_machine, sentence, stands_still, unseen_words

__all__ = ["MESSAGE", "Conclusion", "base_alone", "surrogates_of"]

TOLD_BY: Final = 8
"""Replays that tell the power which noise leaves: its mean over them, and no threshold."""
MESSAGE: Final = "interrupted: this is the best so far"
UNFITTED: Final = "The fit of the plant was not finished, and no effect was looked for yet."
UNSEARCHED: Final = "The plant was fitted, and no effect was looked for yet."
NOTHING_YET: Final = (
    "Until then no effect was named, which does not say that nothing is missing: run it again."
)

_logger = logging.getLogger(__name__)


@dataclass
class Conclusion:
    """What is measured once every decision is taken.

    Everything is measured on demand and once: where Ctrl-C stops it, ``diagnosis`` goes on from
    what is there.

    Attributes
    ----------
    found : Diagnosis
        With its data, as far as they are known.
    session : Session
    evidence : Evidence
    base : Model
    selection : Search
        As the search left it.
    null : numpy.ndarray, shape (n, surrogates)
        Residuals of the surrogates of the base.
    noises : mapping of int to Noise
        By recording: what those were made with.
    others : sequence of str
        Laws that were asked for.
    checks : sequence of (str, Check)
    smallest : float
        Share of the friction that an effect has to contribute to be worth a name.
    restated : bool
        The law is not the one that was stated.
    outdone : bool
        Another law leaves so little beside the first cause that no further one was looked for.
    interrupted : bool
        Then no further laws are fitted.
    brief : bool
        Nothing is said of what is left: not everything was looked for.
    """

    found: Diagnosis
    session: Session
    evidence: Evidence
    base: Model
    selection: Search
    null: FloatArray
    noises: Mapping[int, Noise]
    others: Sequence[str]
    checks: Sequence[tuple[str, Check]]
    smallest: float = SMALLEST
    restated: bool = False
    outdone: bool = False
    interrupted: bool = False
    brief: bool = False
    _known_rests: dict[int, Rest] = field(default_factory=dict)
    _known_replays: dict[int, tuple[FloatArray, Mapping[int, Noise]]] = field(default_factory=dict)

    def diagnosis(self) -> Diagnosis:
        """Verdict and words; after a first Ctrl-C in here those that need nothing more."""
        try:
            return self._whole()
        except KeyboardInterrupt:
            if self.interrupted:
                raise
            self.interrupted = self.brief = True
            return self._whole()

    def _whole(self) -> Diagnosis:
        final = self.final_selection.models[-1]
        ceiling = self.ceiling
        noises = self.noises if self.brief else self._replays(final)[1]
        data = {
            **self.found.data,
            "noise": [
                {"recording": self.evidence.names[index], **asdict(noise)}
                for index, noise in noises.items()
            ],
            "replicates": None if ceiling is None else ceiling.to_dict(),
            "through": {
                **asdict(self.evidence.through),
                "timing_s": [m.nuisances.timing for m in (self.base, final)],
            },
        }
        found = self._told(replace(self.found, data=data))
        found = with_pushes(found, self.evidence)
        names, number = self.evidence.names, len(self.final_selection.choices)
        found = with_checks(found, holds_of(self.evidence.shown, final, names))
        held = () if self.brief else self.fixed_parameters
        found = with_checks(found, [each.check for each in held], fixed_words(held))
        apart = outlying_test_recordings(self.evidence, final, self.test, number, self.relevant)
        found = with_checks(found, apart, apart_words(apart))
        return with_loop_replay(replace(found, ceiling=ceiling), self.evidence, self.base, final)

    @cached_property
    def valid_selection(self) -> Search:
        """The selection, as far as the plant describes the machine with it."""
        selection = reject_without_machine(self.selection, self.evidence, self.null)
        return borne_out(borne_out_in_motion(selection, self.evidence), self.evidence)

    @cached_property
    def lacking(self) -> bool:
        """Whether the plant lacks something, named or not, before the rows that test are asked."""
        return bool(self.valid_selection.choices) or self.unsaid

    @cached_property
    def unsaid(self) -> bool:
        """Whether it lacks something that has no name, before the rows that test are asked."""
        final = self.valid_selection.models[-1]
        return bool(
            lost_share(self.evidence, final, self.null) or self._unnamed(self.valid_selection)
        )

    @property
    def lacks_what_recurs(self) -> bool:
        """Whether more than noise is left, and not in single moments alone."""
        final = self.valid_selection.models[-1]
        null, block = self._replays(final)[0], self.evidence.cells.block
        return recurs(final.residual, null, block)

    @cached_property
    def rivals(self) -> Sequence[Rival]:
        """Other laws, fitted."""
        if self.interrupted:
            return []
        rivals = rivals_of(self.valid_selection, self.others, lacking=self.lacking)
        self.interrupted = self.interrupted or self.valid_selection.interrupted
        return rivals

    @cached_property
    def better(self) -> list[Rival]:
        """The law to state and those that leave about as little; empty where none clearly helps."""
        last = len(self.valid_selection.models) - 1
        return better_laws(self.rivals, last, self.test, self.found.seed)

    @property
    def law_words(self) -> str:
        """What a better law means, in a sentence."""
        first, *others = self.better
        own = self.base.plant.friction.law
        named = [choice.winner.name for choice in self.final_selection.choices]
        if self.outdone:
            added = f" with {join_words(named)}" if named else ""
        else:
            added = ", whatever is added to it" if named else ""
        return first.words(own, added, [each.law for each in others])

    @property
    def law_rows(self) -> tuple[LawRow, ...]:
        """What each law that was compared gains over the plant's own."""
        first = len(self.valid_selection.models)
        return law_rows(self.rivals, first, self.test, self.found.seed)

    @cached_property
    def test_rows(self) -> list[Rows]:
        """The rows that test."""
        phase(_logger, "opening the test rows")
        return self.evidence.open_test()

    @cached_property
    def test(self) -> HeldOut | None:
        """What all models leave there; those of other laws come last."""
        models = [
            *self.valid_selection.models,
            *(r.model for r in self.rivals if r.model is not None),
        ]
        return residuals_of(self.evidence, self.test_rows, [(m.plant, m.nuisances) for m in models])

    @cached_property
    def final_selection(self) -> Search:
        """The selection that the rows that test bear out."""
        selection = confirm_on_test(self.valid_selection, self.test, self.found.seed)
        return borne_out(selection, self.evidence)

    @cached_property
    def _centred(self) -> tuple[FloatArray, FloatArray]:
        bias, centred = centre(self.null)
        return common_bias(bias, self.base.residual, self.evidence.cells.recording), centred

    @cached_property
    def _seen(self) -> list[Look]:
        scales = scales_of(self.evidence, self.base.plant)
        starts = self.session.starts
        return looks(self.evidence, self.base.plant, starts, scales.units["presliding"])

    @cached_property
    def rests(self) -> tuple[Rest, Rest]:
        """What base and last model leave, in every coordinate."""
        return self._rest(self.base), self._rest(self.final_selection.models[-1])

    def _replays(self, model: Model) -> tuple[FloatArray, Mapping[int, Noise]]:
        """Residuals of surrogates of a model, and the noise that they were made with.

        What a base lacks may be as fast as noise, and is no noise once it has a name.
        """
        if id(model) not in self._known_replays:
            number = min(self.null.shape[1], TOLD_BY)
            self._known_replays[id(model)] = (
                (self.null, self.noises)
                if model is self.base
                else surrogates_of(self.evidence, model, number, self.found.seed)
            )
        return self._known_replays[id(model)]

    def _rest(self, model: Model) -> Rest:
        """What a model leaves, in every coordinate."""
        if id(model) not in self._known_rests:
            orders = scales_of(self.evidence, self.base.plant).orders
            (bias, centred), friction = self._centred, friction_of(self.evidence, self.base)
            left = model.residual - bias
            self._known_rests[id(model)] = rest(
                self.evidence, self._seen, orders, left, centred, friction
            )
        return self._known_rests[id(model)]

    @cached_property
    def own(self) -> tuple[tuple[View, View], ...]:
        """Each cause in its own coordinate, before it is added and after."""
        selection, final = self.final_selection, self.final_selection.models[-1]
        (bias, centred), friction = self._centred, friction_of(self.evidence, self.base)
        return tuple(
            own_views(
                self.evidence,
                self._seen,
                effect_of(final.plant, choice.winner.name),
                [model.residual - bias for model in selection.models[k : k + 2]],
                centred,
                friction,
            )
            for k, choice in enumerate(selection.choices)
        )

    @cached_property
    def ceiling(self) -> Ceiling | None:
        """How much could be explained."""
        base, final = self.base, self.final_selection.models[-1]
        ends = (base.plant, base.nuisances), (final.plant, final.nuisances)
        return ceiling_of(self.evidence, self.session.replicates, ends)

    @cached_property
    def unnamed_remainders(self) -> tuple[Unexplained, ...]:
        """What is left and has no name."""
        return self._unnamed(self.final_selection, self.burst)

    def _unnamed(self, selection: Search, burst: Burst | None = None) -> tuple[Unexplained, ...]:
        """The same of a selection."""
        final = selection.models[-1]
        return unnamed_remainder(
            self.evidence,
            selection,
            self._rest(self.base),
            self._rest(final),
            self.null,
            lambda: self._replays(final)[0],
            burst,
            relevant=self.relevant,
        )

    @cached_property
    def relevant(self) -> float:
        """Weighted rms of a residual that matters: less of an effect would have no name either."""
        return self.smallest * friction_of(self.evidence, self.base)

    @cached_property
    def burst(self) -> Burst | None:
        """Single moments that hold much of what is left, where no cause is there to tell them."""
        if self.final_selection.choices or self.final_selection.unseen:
            return None
        friction = friction_of(self.evidence, self.base)
        starts = self.session.starts
        return burst_of(self.evidence, self.final_selection.models[-1], self.null, friction, starts)

    @cached_property
    def fixed_parameters(self) -> Sequence[Held]:
        """Numbers of the plant file that the data do not agree with."""
        return fixed_parameters(self.final_selection)

    def _told(self, found: Diagnosis) -> Diagnosis:
        """Verdict and words, from everything that was measured."""
        evidence, selection, test, null = self.evidence, self.final_selection, self.test, self.null
        base, final = selection.models[0], selection.models[-1]
        floor = floor_of(evidence, null if self.brief else self._replays(final)[0])
        scales = scales_of(evidence, base.plant)
        pulls = {} if self.brief else pulls_of_readings(final.solution, evidence.train)
        results = {id(base): evaluate(base, scales), id(final): evaluate(final, scales, pulls)}
        baseline = summary_of(evidence, base, results[id(base)], test, 0, floor)
        number = len(selection.choices)
        extended = summary_of(evidence, final, results[id(final)], test, number, floor)
        better = self.better[0] if self.better else None
        causes = causes_of(selection, results[id(final)], test, found.seed, sole=better is None)
        gain = None
        bets = Bets()
        if causes and test is not None:
            gain = gain_of(test, 0, len(causes), found.seed)
            bets = bets_of(test, len(causes), evidence.names)
        left = lost_share(evidence, final, null)
        event = burst = None
        stands = 0.0
        unseen: Mapping[str, float] = {}
        beside = ""
        verdict: Verdict
        unexplained: tuple[Unexplained, ...] = ()
        if self.brief:
            # What was not looked for any more is not claimed, and neither is that nothing is left.
            causes = leave_waves_open(selection, causes)
            decided = all(cause.decided for cause in causes)
            verdict = ("missing_effect" if decided else "ambiguous") if causes else "not_testable"
            reason = NOTHING_YET
        else:
            unexplained = (
                *(left for each in self.fixed_parameters for left in each.remainders),
                *self.unnamed_remainders,
            )
            shown = {each.coordinate for each in unexplained}
            of_names = rests_of(causes, self.rests[1], remainder_share(selection))
            unexplained += tuple(each for each in of_names if each.coordinate not in shown)
            replaced = {name for each in self.fixed_parameters for name in each.instead}
            unsure = unconfirmed_names(self.selection, causes, test, found.seed)
            causes = leave_open(selection, causes, unexplained, of_names, replaced, unsure)
            if self.restated or any(rival.as_good for rival in self.rivals):
                causes = beside_another_law(causes)
            if better is not None and not causes and not unexplained:
                unexplained = (Unexplained(THE_LAW, better.beside),)
            stands = 0.0 if causes or left else lost_share_of_motion(evidence, final, null)
            if stands and not unexplained:
                unexplained = (Unexplained(NO_COORDINATE, min(stands, 1.0)),)
            if left and not unexplained:
                unexplained = (Unexplained(NO_COORDINATE, left),)
            verdict = verdict_of(selection, unexplained, all(cause.decided for cause in causes))
            reason = (
                "These data cannot be tested: the base imitates every effect, so none could be "
                "seen."
            )
            event = None if causes else lone_event(evidence, final, test, 0, self.relevant)
            burst = self.burst if event is None else None
            unseen = selection.unseen if event is None else {}
            beside = unseen_words(unseen, verdict != "nothing_missing")
            if unseen and verdict == "nothing_missing":
                verdict, reason, beside = "not_testable", beside, ""
        if event is not None and better is None:
            followed = event_words(self.rivals, base, event) if event.fitted else ""
            verdict, reason, unexplained = "not_testable", event.words() + followed, ()
        missed, hint = max(left, lost_share_on_test(test, len(causes), null)), ""
        if missed and verdict == "unexplained":
            hint = sign_error(found.plant, self.evidence.recordings, fit_remainder)
        before, after = self.rests
        if burst is not None and MOMENTS.name in {each.coordinate for each in unexplained}:
            # Nothing is named then: both are what the base leaves.
            before = after = after.with_view(burst.view)
        return replace(
            found,
            verdict=verdict,
            sentence=_opening(self.interrupted, bool(causes))
            + (f"{self.law_words} " if self.better else "")
            + sentence(
                verdict, causes, gain, unexplained, reason, slight=_slight(selection, self.rests[1])
            )
            + beside
            + stands_still(stands, verdict)
            + no_machine(
                missed,
                bool(causes),
                verdict,
                comparison_of(final.plant),
            )
            + (f" {hint}" if hint else ""),
            plant=extended.plant,
            effects=tuple(
                replace(
                    cause,
                    reliability=reliability_of(
                        decided=cause.decided,
                        several=bool(cause.look_alikes),
                        unexplained=verdict == "unexplained",
                    ),
                )
                for cause in causes
            ),
            gain=gain,
            candidates=in_order(selection.rows.values(), causes),
            laws=law_rows(
                self.rivals,
                len(self.valid_selection.models),
                test,
                found.seed,
                beside=(base, event) if event is not None and event.fitted else None,
            ),
            baseline=baseline,
            extended=extended,
            unexplained=unexplained,
            advice=(
                *(each.advice for each in (() if self.brief else self.fixed_parameters)),
                *([] if better is None else [better.advice()]),
                *([] if event is None else [event.advice()]),
                *([] if burst is None else [burst.advice()]),
                *advise(
                    causes,
                    unexplained,
                    selection.blind,
                    self.checks,
                    final.plant,
                    unseen=tuple(unseen),
                ),
            ),
            better_law="" if better is None else better.law,
            evidence=bets,
            success=not self.interrupted,
            message=MESSAGE if self.interrupted else found.message,
            pictures=Pictures(
                stretches=stretches_of(evidence, test, (base, 0), (final, number)),
                before=before,
                after=after,
                effort_unit=extended.unit,
                effort_name="effort by its own law" if final.plant.servo else "measured effort",
                position_unit=final.plant.position_unit,
                floor=floor,
                causes=self.own,
                traces=traces_of(evidence, test, selection),
            ),
        )


def _slight(selection: Search, left: Rest) -> bool:
    """Whether what was refused, or what is left in a coordinate, is more than noise makes."""
    return bool(left.significant_views(0.0)) or any(
        (row.score or 0.0) > (row.threshold or 0.0) and (row.select_gain or 0.0) > 0.0
        for row in selection.rows.values()
    )


def base_alone(found: Diagnosis, evidence: Evidence, base: Model) -> Diagnosis:
    """What is known where Ctrl-C came before anything was looked for: the plant, as far as fitted.

    Parameters
    ----------
    found : Diagnosis
        With its data, as far as they are known.
    evidence : Evidence
    base : Model
    """
    result = evaluate(base, scales_of(evidence, base.plant))
    # What noise would leave is told by replays, of which there are none.
    known = summary_of(evidence, base, result, None, 0, float("nan"))
    told = UNFITTED if base.solution.interrupted else UNSEARCHED
    found = replace(
        found,
        verdict="not_testable",
        sentence=f"{INTERRUPTED}. {told}",
        plant=known.plant,
        baseline=known,
        extended=known,
        success=False,
        message=MESSAGE,
    )
    return with_pushes(found, evidence)


def surrogates_of(
    evidence: Evidence, model: Model, number: int, seed: int
) -> tuple[FloatArray, dict[int, Noise]]:
    """Residuals of a model that is right, shape (n, number), and the noise of each recording."""
    null, noises = surrogate_residuals(evidence, model.plant, model.nuisances, number, seed)
    # What a fit would have taken up is no sign of anything.
    return refit_residuals(model.columns, null, evidence.fitted), noises


def _opening(interrupted: bool, named: bool) -> str:
    """How the sentence begins: that there may be more, where Ctrl-C ended it."""
    return f"{INTERRUPTED}{MORE_MAY_BE if named else ''}. " if interrupted else ""
