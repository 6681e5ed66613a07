"""A conclusion held against the other residual: readings beside windows, windows beside these."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence

from .._support.progress import phase
from ..errors import InputError
from ..fitting.readings import readings_mislead
from .adequacy.bursts import recurs
from .data.evidence import Evidence
from .findings.conclude import TOLD_BY, Conclusion, surrogates_of
from .findings.verdict import all_blind
from .screening.base import fit_baseline, fit_baseline_over_windows
from .screening.block_gains import heldout_gain
from .screening.model import Known, Model, fit_model
from .searched import Asked, Searched, replay_base, search_again

__all__ = ["look_otherwise"]

_logger = logging.getLogger(__name__)


def look_otherwise(
    first: Conclusion,
    look: Searched,
    asked: Asked,
    concluded: Callable[[Searched], Conclusion],
) -> Conclusion:
    """What is concluded, or what the other residual concludes where that leaves nothing.

    Readings that lead a rigid contact astray leave what has no name, at single moments most of all:
    where the plant, simulated, follows the motion within its noise, nothing else was missing. What
    is left again and again is none of their making, and may be too fast for a simulation to show
    it: so are readings asked where a simulation from the first knows no cause. And slopes beside a
    base that has bent itself may show nothing of a cause that readings show. A contact that yields
    is asked over windows where readings mislead it: those stay in its accelerations also where it
    is led by a motion of its own, and pull an inertia down that hardly shows.
    """
    if first.interrupted or look.evidence.loop or not _may_be_astray(look):
        return first
    try:
        if not first.unsaid:
            simulated = look.evidence.simulated
            return _seen_along(first, look, asked, concluded) if simulated else first
        plant, recordings = look.found.plant, look.evidence.recordings
        seen: tuple[Evidence, Model] | None = (look.evidence, look.base)
        if look.evidence.simulated:
            earlier: Sequence[Known | Model] = _tried_along(look, asked)
            seen = seen if earlier else None
        else:
            # What was found last stands where all others have led the plant.
            earlier = [*look.selection.models[:0:-1], *look.selection.tried]
            final = first.valid_selection.models[-1]
            seen = fit_baseline_over_windows(plant, recordings, look.base, final)
        if seen is None:
            return first
        phase(_logger, "screening the effects again, with the plant simulated over windows")
        other = search_again(look, seen, asked=asked, earlier=earlier)
        if other is None or all_blind(other.selection):
            return first
        second = concluded(other)
        if second.interrupted or second.unsaid:
            return first
        # Windows average away what is over within a seventh of a second.
        nothing = other.evidence.simulated and not second.valid_selection.choices
        return first if nothing and first.lacks_what_recurs else second
    except KeyboardInterrupt:
        first.interrupted = first.brief = True
        return first


def _may_be_astray(look: Searched) -> bool:
    """Whether readings may make what has no name."""
    seen, base = look.evidence, look.base
    if look.found.plant.friction.sticks or seen.leads:
        return True
    return not seen.simulated and readings_mislead(base.plant, base.nuisances, seen.train)


def _seen_along(
    first: Conclusion,
    look: Searched,
    asked: Asked,
    concluded: Callable[[Searched], Conclusion],
) -> Conclusion:
    """What readings conclude where windows know no cause, or the same one; else the first.

    What is over within a seventh of a second hardly shows over windows. Along the readings it does,
    and where these lead astray they lead their surrogates astray as well: what is left again and
    again beyond those is none of their making. A cause that both show is judged where it explains
    most.
    """
    try:
        evidence, base = _base_along(look)
    except InputError:
        return first
    few, _ = surrogates_of(evidence, base, min(TOLD_BY, asked.surrogates), look.found.seed)
    if not recurs(base.residual, few, evidence.cells.block):
        return first
    phase(_logger, "screening the effects again, along the readings")
    other = search_again(look, (evidence, base), asked=asked)
    if other is None:
        raise KeyboardInterrupt
    second = concluded(other)
    if second.interrupted:
        return first
    known, seen = first.valid_selection, second.valid_selection
    if not known.choices:
        return second
    alike = [c.winner.name for c in known.choices] == [c.winner.name for c in seen.choices]
    gains = [heldout_gain(each.models[0], each.models[-1])[0] for each in (known, seen)]
    return second if alike and gains[1] > gains[0] else first


def _base_along(look: Searched) -> tuple[Evidence, Model]:
    """The base along the readings, whatever these do to a contact.

    Raises
    ------
    InputError, KeyboardInterrupt
    """
    evidence, base = fit_baseline(look.found.plant, look.evidence.recordings, windows=False)
    if base.solution.interrupted:
        raise KeyboardInterrupt
    return evidence, base


def _tried_along(look: Searched, asked: Asked) -> list[Model]:
    """Models with a cause each that was tried along the readings, as a simulation has them."""
    try:
        evidence, base = _base_along(look)
        _, replays = replay_base(look.found, evidence, base, asked.surrogates)
        if replays is None:
            raise KeyboardInterrupt
        found = asked.search(evidence, base, replays[0], stops=lambda _: True)
        own = [fit_model(look.evidence, each.plant, each.nuisances) for each in found.tried]
    except InputError:
        return []
    if found.interrupted or any(each.solution.interrupted for each in own):
        raise KeyboardInterrupt
    return sorted(own, key=lambda model: model.power)
