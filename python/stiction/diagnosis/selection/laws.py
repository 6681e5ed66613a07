"""Other friction laws in place of the plant's: causes of their own, beside the effects."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np

from ..._support.best_effort import Failure, attempt
from ..._support.progress import phase, steps
from ..._support.wording import commas, did_you_mean, join_words
from ...catalogue import effects
from ...catalogue import laws as all_laws
from ...errors import InputError
from ...fitting.first_pass import fit_from_data
from ...fitting.forms import followable, horizon_of
from ...fitting.minimise import MOST_EVALUATIONS
from ...fitting.recording_starts import with_turns
from ...fitting.rows import require_motion
from ...plant.parameter import Parameter
from ...plant.stated import Friction
from ...residual.finite import finite
from ..adequacy.lone import Lone
from ..adequacy.within import event_power_ratio
from ..data.gain import Gain, HeldOut, gain_of
from ..phrases import THE_LAW
from ..records import Advice, LawRow
from ..screening.block_gains import heldout_gain
from ..screening.candidates import scales_of
from ..screening.model import LEAST_GIVEN, Model, fit_model, likeliest_of
from .choose import DECIDED_Z
from .left_open import OF_A_LAW
from .rounds import friction_of
from .search import Search

__all__ = [
    "THE_LAW",
    "Rival",
    "better_laws",
    "event_words",
    "law_names",
    "law_rows",
    "rivals_of",
]

YIELDING: Final = "maxwell_slip"
RIGID: Final = "coulomb"
DAMPED: Final = "lugre"
"""Laws that are tried unasked where a plant lacks something, the first two each where the plant's
own law is of the other kind: a contact that yields under a law that does not, and one that sticks
under a law that yields, imitate many effects, a dead band of the drive first of all. The third
where the own law yields and has no damping: what bristles damp goes with speed and with reversals,
as effects of memory and of lag do."""
DAMPING: Final = "damping"
"""What such a term is called in every law."""
WORTH_A_TERM: Final = 0.95
"""Share of the power that an optional term of a law may leave at most to stay in a comparison."""
FALL: Final = ("breakaway", "stribeck_velocity")
"""Options of laws whose friction may fall with speed."""
BREAKS_AWAY: Final = 1.2
"""Times the level of sliding at which such a fall begins, to start with."""
FALLS_AT: Final = (0.2, 0.5, 0.8)
"""Where it is over, on the way from the lowest usual speed to the highest, logarithmically."""
HOPELESS: Final = 100.0
"""Times the power left with all effects: a law that nobody asked for is given up where it leaves
more after the first steps from all of its starts."""
WORTH_MORE: Final = 0.1
"""Share of what is left with all effects that another law alone must remove to be the likelier
cause."""

AS_LITTLE: Final = 1.25
"""Times what the best law leaves that one leaves which these data do not tell from it."""
ALIKE: Final = 1.005
"""Powers are the same up to this ratio: nobody reads a difference in the third digit."""
MOST_TOLD: Final = 100.0
"""Beyond so many times the power a number says nothing: the fit of the law has failed."""

RUNS_AWAY: Final = "what it leaves are no finite numbers"
"""Why a law is not compared that was fitted."""

TOO_COARSE: Final = (
    "cannot be compared here: it yields within a few counts of the position, which are too coarse "
    "to drive it; state it in the plant file and diagnose with that, then it is simulated"
)
"""Why a law that yields is not judged by the efforts that it needs along a coarse motion."""

_logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Rival:
    """Another law, fitted to the same rows with nothing added.

    Attributes
    ----------
    law : str
    asked : bool
        Whether somebody wanted to see it.
    model : Model or None
        None where it could not be fitted.
    why : str
        Why it could not, "" where it leads nowhere.
    beside : float
        Share that it removes, on rows that decide, of what the plant leaves with all its effects;
        with those of them that are no part of any law, where that is more.
    z : float
        That over its standard error.
    counts : bool
        Whether what it removes is as much, beside the friction, as is worth a name.
    kept : tuple of str
        Effects that it needs for that.
    """

    law: str
    asked: bool
    model: Model | None
    beside: float = 0.0
    z: float = 0.0
    counts: bool = False
    kept: tuple[str, ...] = ()
    why: str = ""

    @property
    def better(self) -> bool:
        """Whether it explains clearly more than what was named."""
        return self.counts and self.beside > WORTH_MORE and self.z > DECIDED_Z

    @property
    def as_good(self) -> bool:
        """Whether rows that decide do not tell it from what was named, all effects included."""
        return self.model is not None and self.z > -DECIDED_Z

    @property
    def parameters(self) -> int:
        """How many numbers of its own were fitted."""
        paths = () if self.model is None else self.model.solution.variables.paths
        return sum(path.startswith("friction.") for path in paths)

    def words(self, own: str, added: str, alike: Sequence[str] = ()) -> str:
        """What that means, in a sentence: ``added`` is what the plant's own law has beside it, and
        ``alike`` are laws that leave about as little."""
        summary = next(record.summary for record in all_laws() if record.name == self.law)
        kept = f", with {join_words(self.kept)}," if self.kept else ""
        return (
            f"The friction law itself lacks something: {self.law} ({summary}){kept} leaves "
            f"{_less(self.beside)} less than {own}{added}{_as_little(alike)}."
        )

    @property
    def statement(self) -> Friction:
        """The law as somebody would state it, with what a fit leaves alone where it has that."""
        given = {} if self.model is None else self.model.plant.friction.parameters
        named = [*_left_alone(self.law), *(FALL if FALL[-1] in given else ())]
        return Friction(self.law, {name: given[name] for name in named if name in given})

    @property
    def terms(self) -> tuple[str, ...]:
        """Terms that nobody stated and this fit has: ``"compliance = 4.2e-07"``."""
        return tuple(f"{n} = {each.value:.2g}" for n, each in self.statement.parameters.items())

    def advice(self, *, followed: bool = False) -> Advice:
        """What to do about it; ``followed`` where the diagnosis has gone on with the law."""
        stated = join_words([f'law = "{self.law}"', *self.terms])
        then = ", as the extended plant does" if followed else " and diagnose again"
        return Advice(
            f"state {stated} in the plant file{then}",
            "effects beside a law that lacks something stand for that",
            (),
        )


def law_names(wanted: Sequence[str], own: str) -> list[str]:
    """Laws to compare with the plant's own."""
    known = [record.name for record in all_laws()]
    if list(wanted) == ["all"]:
        return [name for name in known if name != own]
    for name in wanted:
        if name not in known:
            raise InputError(
                f"laws: '{name}' is unknown{did_you_mean(name, known)}; known are all, "
                f"{commas(known)}"
            )
    return [name for name in dict.fromkeys(wanted) if name != own]


def rivals_of(selection: Search, wanted: Sequence[str], *, lacking: bool) -> list[Rival]:
    """The laws to compare, fitted.

    Parameters
    ----------
    selection : Search
    wanted : sequence of str
        Names of laws that were asked for.
    lacking : bool
        Whether the plant lacks something, named or not.
    """
    unasked = _representatives(selection.models[0].plant.friction) if lacking else ()
    names = list(dict.fromkeys([*wanted, *unasked]))
    rivals = []
    for law in steps(names, "law"):
        made = attempt(f"the comparison with {law}", partial(_rival, selection, law, law in wanted))
        rival = (
            Rival(law, law in wanted, None, why=str(made)) if isinstance(made, Failure) else made
        )
        if rival.model is not None and rival.model.solution.interrupted:
            # Half a fit is no fair comparison: what is known of the effects stays.
            selection.interrupted = True
            break
        rivals.append(rival)
    return rivals


def _representatives(own: Friction) -> tuple[str, ...]:
    """Laws of the kinds that a law is none of."""
    if not own.springy:
        return (YIELDING,)
    damps = any(each.name == DAMPING for each in own.record.parameters)
    return (RIGID,) if damps else (RIGID, DAMPED)


def _rival(selection: Search, law: str, asked: bool) -> Rival:
    """Another law, fitted, with what it is worth; where it cannot be, with the reason."""
    base, final = selection.models[0], selection.models[-1]
    # Fitted with nothing added, a law is the same beside whatever was found since.
    compared = [(f, r) for b, f, r in selection.rivals if b is base and r.law == law]
    for last, rival in compared:
        if last is final and rival.asked is asked:
            return rival
    rival = _compared(selection, law, asked, compared[-1][1] if compared else None)
    if not selection.interrupted:
        selection.rivals.append((base, final, rival))
    return rival


def _compared(selection: Search, law: str, asked: bool, known: Rival | None) -> Rival:
    """The same, as far as it is not ``known`` from beside fewer causes."""
    base, final = selection.models[0], selection.models[-1]
    hopeless = math.inf if asked else HOPELESS * final.power
    if known is not None and known.asked is asked:
        if known.model is None or known.model.power > hopeless:
            return Rival(law, asked, None, why=known.why)
        return _beside(final, known.model, Rival(law, asked, known.model), selection)
    try:
        model = _fitted(base, law, hopeless)
        if model is not None and asked and not model.solution.interrupted:
            model = _falling(model)
    except InputError as error:
        _logger.info("%s: %s", law, error)
        return Rival(law, asked, None, why=str(error))
    if model is None or model.solution.interrupted:
        return Rival(law, asked, model)
    if not math.isfinite(model.power):
        return Rival(law, asked, None, why=RUNS_AWAY)
    return _beside(final, model, Rival(law, asked, model), selection)


def _beside(final: Model, model: Model, rival: Rival, selection: Search) -> Rival:
    """Another law with what it removes of what the last model leaves.

    An offset or a ripple has nothing to do with the law: a rival that lacks it would be outdone by
    effects, whatever its friction is worth.
    """
    least = selection.smallest * friction_of(final.evidence, selection.models[0])

    def of(other: Model) -> Rival:
        beside, z = heldout_gain(final, other)
        removed = max(beside, 0.0) * float(np.mean(finite(final.residual) ** 2))
        return replace(rival, beside=beside, z=z, counts=math.sqrt(removed) >= least)

    alone = of(model)
    named = {
        choice.winner.name
        for choice in selection.choices
        if choice.winner.candidate.record.family not in OF_A_LAW
    }
    kept = tuple(effect for effect in final.plant.effects if effect.name in named)
    if not kept:
        return alone
    both = replace(model.plant, effects=(*model.plant.effects, *kept))
    try:
        found = fit_model(model.evidence, both, model.nuisances)
    except InputError as error:
        _logger.info(
            "%s beside %s: %s", join_words([effect.name for effect in kept]), rival.law, error
        )
        return alone
    if found.solution.interrupted:
        # What is known of the law alone stays.
        selection.interrupted = True
        return alone
    together = of(found)
    # Fitted anew beside another law an effect may run away: a dead band as wide as every input.
    if together.beside <= alone.beside or found.relative_input_power <= LEAST_GIVEN:
        return alone
    return replace(together, kept=tuple(effect.name for effect in kept))


def better_laws(rivals: Sequence[Rival], own: int, test: HeldOut | None, seed: int) -> list[Rival]:
    """The law to state, and those that leave about as little; empty where none clearly helps.

    First stands the one with the fewest parameters: a law that holds another one within it follows
    what that one made as well. Rows that test choose none. They may take one away: a law that is
    surely worse there than what was named is none to be stated.

    Parameters
    ----------
    rivals : sequence of Rival
    own : int
        Place of the last model of the plant's own law among those that were tested; those of other
        laws come next.
    test : HeldOut or None
    seed : int
    """
    places = [k for k, rival in enumerate(rivals) if rival.model is not None]
    refuted = {
        rivals[k].law
        for place, k in enumerate(places, own + 1)
        # What needs effects beside it was tested without them.
        if test is not None
        and rivals[k].better
        and not rivals[k].kept
        and gain_of(test, own, place, seed).ci95[1] < 0.0
    }
    better = [rival for rival in rivals if rival.better and rival.law not in refuted]
    most = AS_LITTLE * min((1.0 - rival.beside for rival in better), default=0.0)
    near = sorted((r for r in better if 1.0 - r.beside <= most), key=lambda r: -r.beside)
    first = min(near, key=lambda rival: (rival.parameters, -rival.beside), default=None)
    return [] if first is None else [first, *(rival for rival in near if rival is not first)]


def _fitted(base: Model, law: str, hopeless: float) -> Model | None:
    """The plant with another law, fitted with the same weights.

    None where it leaves more than ``hopeless``, a power, after a few steps.

    Terms of the law that a fit leaves alone and no effect would offer, such as the compliance of a
    rig, are tried as well, and stay where they leave less.
    """
    phase(_logger, "fitting law %s", law)
    more = _left_alone(law)
    plain = _launched(base, Friction(law), hopeless)
    if not more or plain is None or plain.solution.interrupted:
        return plain
    try:
        full = _launched(base, Friction(law, {**plain.plant.friction.parameters, **more}), hopeless)
    except InputError as error:
        _logger.info("%s with all of its terms: %s", law, error)
        return plain
    return plain if full is None else _worth_its_terms(full, plain)


def _worth_its_terms(full: Model, plain: Model) -> Model:
    """A law with more terms where these leave less, or half a fit; else the one without."""
    less = _fitted_power(full) < WORTH_A_TERM * _fitted_power(plain)
    return full if less or full.solution.interrupted else plain


def _falling(plain: Model) -> Model:
    """A law with friction that falls with speed, where it has that as an option and it helps.

    Beside the plant's own law such a fall is an effect; a law that has it within is not to be
    outdone by one that only lacks the option to say so.
    """
    friction = plain.plant.friction
    options = {each.name for each in friction.record.parameters}
    if not options.issuperset(FALL) or "stribeck_velocity" in friction.parameters:
        return plain
    low, high = scales_of(plain.evidence, plain.plant).speeds
    level = friction.parameters["coulomb"].value
    if not level > 0.0:
        # A level that is not there cannot fall.
        return plain
    plants = [
        replace(
            plain.plant,
            friction=Friction(
                friction.law,
                {
                    **friction.parameters,
                    "breakaway": Parameter(BREAKS_AWAY * level),
                    "stribeck_velocity": Parameter(low * (high / low) ** share),
                },
            ),
        )
        for share in FALLS_AT
    ]
    try:
        begin = likeliest_of(plain.evidence, plants, plain.nuisances)
        return _worth_its_terms(fit_model(plain.evidence, begin, plain.nuisances), plain)
    except InputError as error:
        _logger.info("%s that falls with speed: %s", friction.law, error)
        return plain


def _left_alone(law: str) -> dict[str, Parameter]:
    """Optional terms of a law that a fit leaves neutral and no effect offers, at typical values."""
    record = next(each for each in all_laws() if each.name == law)
    offered = {term for effect in effects() for term in effect.law_terms}
    return {
        each.name: Parameter(each.typical)
        for each in record.parameters
        if each.optional and each.neutral == 0.0 and each.name not in offered
    }


def _launched(base: Model, friction: Friction, hopeless: float) -> Model | None:
    evidence = base.evidence
    bare = replace(base.plant, friction=friction)
    require_motion(evidence.train, bare)
    _, found = fit_from_data(
        bare,
        evidence.train,
        most=MOST_EVALUATIONS,
        within=lambda start: followable(start, evidence.forms),
        hopeless=hopeless,
    )
    if found.power > hopeless and not found.interrupted:
        return None
    return Model(evidence, with_turns(found, evidence.train, most=MOST_EVALUATIONS))


def _fitted_power(model: Model) -> float:
    """Weighted power that is left in the rows that were fitted."""
    return float(np.sum(model.residual[model.evidence.fitted] ** 2))


def law_rows(
    rivals: Sequence[Rival],
    first: int,
    test: HeldOut | None,
    seed: int,
    *,
    beside: tuple[Model, Lone] | None = None,
) -> tuple[LawRow, ...]:
    """Laws with what they gain over the plant's own, the best first.

    With ``beside`` that one is first which leaves least in the event that was fitted.

    Parameters
    ----------
    rivals : sequence of Rival
    first : int
        Place of the first of them among the models that were tested.
    test : HeldOut or None
    seed : int
    beside : (Model, Lone), optional
        The plant's own law and an event that lies in rows that were fitted: then it is told what
        each law leaves there.
    """
    rows: list[tuple[float, LawRow]] = []
    index = first
    for rival in rivals:
        if rival.model is None:
            if rival.asked:
                why = f": {rival.why}" if rival.why else ""
                row = LawRow(rival.law, None, f"could not be fitted to these data{why}")
                rows.append((-math.inf, row))
            continue
        gain: Gain | None = None if test is None else gain_of(test, 0, index, seed)
        index += 1
        if not (rival.asked or rival.better):
            continue
        if not rival.better and _too_coarse(rival.model):
            rows.append((-math.inf, LawRow(rival.law, None, TOO_COARSE)))
            continue
        if gain is None:
            reason = "fitted, and no rows were left to test on"
        elif gain.ci95[0] > 0.0:
            reason = f"explains {100 * gain.value:.1f} % of what the plant's law leaves"
        elif gain.ci95[1] < 0.0 and 1.0 - gain.value > ALIKE:
            reason = f"leaves {_times(1.0 - gain.value)} that the plant's law leaves"
        else:
            reason = "explains about as much as the plant's law"
        if rival.terms:
            few = len(rival.terms) < 3
            reason += f", with {join_words(rival.terms) if few else 'all of its optional terms'}"
        if rival.kept:
            # A constant hides in one law more than in another: alone they are not alike.
            reason += (
                f"; with {join_words(rival.kept)} it leaves {_times(1.0 - rival.beside)} that all "
                "that was named leaves"
            )
        place = -1e300 if gain is None else gain.value
        if beside is not None:
            left = _in_event(rival.model, *beside)
            reason += f"; in the event, to which it was fitted, it leaves {_times(left)}"
            place = -left
        rows.append((place, LawRow(rival.law, gain, reason)))
    return tuple(row for _, row in sorted(rows, key=lambda each: -each[0]))


def event_words(
    rivals: Sequence[Rival],
    own: Model,
    event: Lone,
    within: Callable[[Model, Model, Lone], float | None] = event_power_ratio,
) -> str:
    """Which law follows an event in rows that were fitted, in a sentence; "" where none does.

    ``within`` tells what a law leaves in pieces of the event that it was not fitted to.
    """
    left = {r.law: _in_event(r.model, own, event) for r in rivals if r.model is not None}
    best = min(left, key=lambda law: left[law], default=None)
    if best is None or left[best] > 1.0 - WORTH_MORE:
        return ""
    model = next(r.model for r in rivals if r.law == best)
    held = None if model is None else within(model, own, event)
    halves = "" if held is None else f", and {_times(held)} in halves of it that were held out"
    return (
        f" Of the laws that were compared {best} follows it most closely: fitted to it, it leaves "
        f"{_times(left[best])} that {own.plant.friction.law} leaves there{halves}. No other event "
        "confirms that."
    )


def _too_coarse(model: Model) -> bool:
    """Whether a plant with that law would be simulated, for readings are too coarse to drive it."""
    evidence = model.evidence
    if evidence.simulated or not model.plant.friction.springy:
        return False
    return horizon_of(model.plant, model.nuisances, evidence.train, evidence.forms) is not None


def _in_event(model: Model, own: Model, event: Lone) -> float:
    """Power that a model leaves in an event that was fitted, over what the plant's own leaves."""
    evidence = own.evidence
    inside = event.rows(evidence.shown, evidence.names) & evidence.fitted
    one, two = (float(np.sum(each.residual[inside] ** 2)) for each in (model, own))
    return one / max(two, 1e-300)


def _as_little(alike: Sequence[str]) -> str:
    if not alike:
        return ""
    return f"; {join_words(alike)} {'leaves' if len(alike) == 1 else 'leave'} about as little"


def _less(share: float) -> str:
    """What is removed, and never all of it."""
    return "over 99 %" if share > 0.99 else f"{100 * share:.0f} %"


def _times(left: float) -> str:
    """So many times a power, as far as the number tells something."""
    if abs(left - 1.0) < ALIKE - 1.0:
        return "the same power"
    return "over 100 times the power" if left > MOST_TOLD else f"{left:.3g} times the power"
