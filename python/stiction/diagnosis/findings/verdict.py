"""The verdict, and what is left that has no name."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ...catalogue import effects
from ..adequacy.bursts import Burst, at_moments
from ..adequacy.omnibus import Rest
from ..adequacy.outlying import outlying_recordings
from ..adequacy.passing import MOMENTS
from ..adequacy.periodic import FREQUENCY
from ..adequacy.view import LEAST_SIZE
from ..data.evidence import Evidence
from ..phrases import ALONE, NO_COORDINATE
from ..records import Unexplained, Verdict
from ..screening.block_gains import heldout_gain
from ..screening.model import Model
from ..selection.decide import LEAST_GAIN
from ..selection.search import Search

__all__ = ["all_blind", "relatives", "remainder_share", "unnamed_remainder", "verdict_of"]

WORTH_SHARE: Final = 0.25
"""What is left counts against the names where it is worth this share of what they gained."""
MOST_EXCESS: Final = 0.75
"""Share of what is left that noise may fail to explain before it counts as unexplained, where it
shows in no coordinate: a law is no exact image of a machine."""
MOST_EXCESS_RIGID: Final = 0.4
"""The same of a rigid contact beside a held input, which replays repeat: where nothing was hidden,
noise failed to explain a third of it at most."""
LEAST_EXCESS: Final = -3.0
"""Where noise alone would leave four times the power that is left, nothing of it is unexplained:
the replays have lost the machine, as where a dry contact sticks and slips at random."""
HALF: Final = 0.5
"""Of what goes with no coordinate, from which on a description stands for it."""
(BIAS,) = (record.name for record in effects() if record.constant)
(TWO_LEVELS,) = (record.name for record in effects() if record.two_levels)
"""With true stick a level for each direction is one level and a constant effort, to the last digit,
as long as that does not outweigh it: what a constant effort explains so may be either. The reverse
is told as all else is: viscous friction that differs as well is no constant."""
UNTOUCHED: Final = 0.9
"""Of what a coordinate shows, from which on names left it as it was."""
BESIDE_A_NAME: Final = 0.0015
"""Share of the friction from which on what is left counts beside a name: what imitates a cause
leaves little, spread over many coordinates."""


def unnamed_remainder(
    evidence: Evidence,
    selection: Search,
    before: Rest,
    left: Rest,
    null: FloatArray,
    null_of_last: Callable[[], FloatArray],
    burst: Burst | None = None,
    *,
    relevant: float = 0.0,
) -> tuple[Unexplained, ...]:
    """What the last model leaves that noise does not explain: coordinates, then single recordings.

    Parameters
    ----------
    evidence : Evidence
    selection : Search
    before, left : Rest
        What its first model leaves and what its last one leaves, in every coordinate.
    null : numpy.ndarray, shape (n, surrogates)
        Residuals of the surrogates.
    null_of_last : callable
        The same of the last model: a shaft that gives turns noise of the position into effort.
    burst : Burst, optional
        Single moments that hold much of what is left; told where nothing is named.
    relevant : float
        Weighted rms of a residual that matters.
    """
    excess = _excess(evidence, selection.models[-1], null, relevant)
    told = _told(left, LEAST_SIZE)
    if excess < LEAST_EXCESS:
        # A line over time is what the replays took for noise, and none of their making.
        return tuple(each for each in told if each.coordinate == FREQUENCY.name)
    if not told and selection.choices:
        least = 0.0 if _falls_short(selection, before) else BESIDE_A_NAME
        touched = _touched(selection, before, left)
        beside = tuple(each for each in _told(left, least) if each.coordinate in touched)
        told = beside if _outweighs(selection, beside) else ()
    if not told and selection.imitated > LEAST_GAIN:
        # What was refused as an imitation, or for its motion, shows that there is something.
        shown = left.significant_views(0.0)
        where = shown[0].coordinate.name if shown else NO_COORDINATE
        told = (Unexplained(where, selection.imitated),)
    # A few coordinates that show little must not hide that most goes with none of them.
    if selection.choices:
        open_ = not told or not _outweighs(selection, told)
    else:
        open_ = max((each.share for each in told), default=0.0) < WORTH_SHARE * excess
    if open_ and excess > _most_excess(evidence) and selection.choices:
        null = null_of_last()
        excess = _excess(evidence, selection.models[-1], null, relevant)
    if open_ and excess > _most_excess(evidence):
        bursts = at_moments(evidence, selection.models[-1], null)
        more = Unexplained(MOMENTS.name if bursts else NO_COORDINATE, excess)
        told = (more, *(each for each in told if each.coordinate != more.coordinate))
    told = _behind(burst if not selection.choices else None, told)
    alone = outlying_recordings(evidence, selection.models[-1], null, relevant)
    # One recording stands first where it leaves most; beside a coordinate, in which the others
    # show the same, several of them only make a list longer.
    most = 1 if alone and (not told or alone[0].share > told[0].share) else 0
    told = (*alone[:most], *told, *alone[most:])
    return _described(left, told, named=bool(selection.choices))


def _behind(burst: Burst | None, told: tuple[Unexplained, ...]) -> tuple[Unexplained, ...]:
    """What is told, behind moments that hold more: what comes once bends whatever it passes."""
    if burst is None or burst.share <= max((each.share for each in told), default=0.0):
        return told
    places = tuple(each for each in told if each.coordinate not in (MOMENTS.name, NO_COORDINATE))
    return (Unexplained(MOMENTS.name, burst.share), *places)


def _described(
    left: Rest, told: tuple[Unexplained, ...], *, named: bool
) -> tuple[Unexplained, ...]:
    """What is told, behind what describes it better than any coordinate that it shows in.

    Where nothing is named it takes the place of no coordinate; beside names what noise does not
    explain counts against them whole.
    """
    excess = max((each.share for each in told if each.coordinate == NO_COORDINATE), default=0.0)
    places = [each.share for each in told if each.coordinate != NO_COORDINATE]
    view = next(iter(left.leading_views), None)
    if not told or view is None or view.share <= max([WORTH_SHARE * excess, *places]):
        return told
    if view.share > HALF * excess and not named:
        told = tuple(each for each in told if each.coordinate != NO_COORDINATE)
    return (Unexplained(view.coordinate.name, view.share), *told)


def verdict_of(selection: Search, left: Sequence[Unexplained], decided: bool) -> Verdict:
    """The verdict by precedence; ``decided`` says whether every cause is.

    A recording that stands apart says nothing against names that explain all others.
    """
    if not selection.choices and all_blind(selection):
        return "not_testable"
    of_all = [each for each in left if not each.coordinate.endswith(ALONE)]
    if _outweighs(selection, of_all if selection.choices else left):
        return "unexplained"
    if not decided:
        return "ambiguous"
    return "missing_effect" if selection.choices else "nothing_missing"


def all_blind(selection: Search) -> bool:
    """Whether the base hides every effect that was looked for; others were never asked."""
    blind = {record.name for record in selection.blind}
    asked = {name for name, row in selection.rows.items() if row.score is not None} | blind
    return bool(blind) and asked == blind


def relatives(selection: Search, place: int) -> list[str]:
    """Other effects of the same family as one that was accepted, or the same thing by another name.

    Two that look alike, named beside each other, together imitate a third more often than they are
    both there; and so does a name beside one that may be a relative of it: a constant and cogging
    may be the one weight off the axis.
    """
    records = [choice.winner.candidate.record for choice in selection.choices]
    own = records[place]
    taken = [each.name for each in records]
    instead = [
        rival.candidate.record
        for k, choice in enumerate(selection.choices)
        for rival in choice.rivals
        if k != place and rival.name not in taken
    ]
    alike = [each for each in (*records, *instead) if each.family == own.family]
    names = [each.name for each in alike if each is not own]
    if own.name == BIAS and TWO_LEVELS in selection.rows and _is_level_at_stick(selection):
        names.append(TWO_LEVELS)
    return list(dict.fromkeys(names))


def _is_level_at_stick(selection: Search) -> bool:
    """Whether a constant effort may be a level of its own in either direction."""
    plant = selection.models[-1].plant
    level = plant.friction.parameters.get("coulomb")
    bias = next((each for each in plant.effects if each.name == BIAS), None)
    if not plant.friction.sticks or level is None or bias is None:
        return False
    return all(abs(each.value) < level.value for each in bias.parameters.values())


def _told(left: Rest, least: float) -> tuple[Unexplained, ...]:
    views = left.significant_views(least)
    return tuple(Unexplained(view.coordinate.name, view.share) for view in views)


def _touched(selection: Search, before: Rest, left: Rest) -> set[str]:
    """Coordinates of which the names took a part.

    What imitates a cause takes a part of what that shows. What the names leave as it was, and what
    was too little to be told without them, is no sign against them.
    """
    whole, less = (float(m.blocks[1].sum()) for m in (selection.models[0], selection.models[-1]))
    shown = {view.coordinate.name: view.share * whole for view in before.views}
    return {
        view.coordinate.name
        for view in left.views
        if view.share * less < UNTOUCHED * shown.get(view.coordinate.name, np.inf)
    }


def _falls_short(selection: Search, before: Rest) -> bool:
    """Whether the names explain less than a mean over stretches of one coordinate does.

    A cause explains at least what shows over any single coordinate; what follows a part of that
    imitates it, and then whatever is left of it counts.
    """
    gain = heldout_gain(selection.models[0], selection.models[-1])[0]
    return any(view.share > gain for view in before.significant_views())


def _outweighs(selection: Search, left: Sequence[Unexplained]) -> bool:
    """Whether what is left is worth more than a quarter of what was named."""
    if not left:
        return False
    return max(each.share for each in left) * remainder_share(selection) > WORTH_SHARE


def remainder_share(selection: Search) -> float:
    """Power that is left on rows that decide over that of what the names took; inf without any."""
    before, after = (float(m.blocks[1].sum()) for m in (selection.models[0], selection.models[-1]))
    return after / (before - after) if before > after else float("inf")


def _most_excess(evidence: Evidence) -> float:
    """Share of what is left from which on noise fails to explain it."""
    forms = [rows.form for rows in evidence.shown]
    rigid = not any(form.springy or form.prescribed for form in forms)
    return MOST_EXCESS_RIGID if rigid and not evidence.plant.servo else MOST_EXCESS


def _excess(evidence: Evidence, model: Model, null: FloatArray, relevant: float) -> float:
    """Share of the power left that noise and rounding do not explain, over rows that decide.

    What is too small to matter counts as explained.
    """
    held = np.zeros(len(evidence.fitted), dtype=bool)
    for plan in evidence.plans:
        held |= plan.held
    recording = evidence.cells.recording
    ratios = []
    for index in np.unique(recording[held]):
        rows = held & (recording == index)
        power = float(np.sum(model.residual[rows] ** 2))
        noise = float(np.mean(np.sum(null[rows] ** 2, axis=0)))
        noise = max(noise, np.count_nonzero(rows) * relevant**2)
        ratios.append(noise / power if power > 0.0 else 1.0)
    # The middle one: a single recording in which the model lost its track says nothing of the rest.
    return 1.0 - float(np.median(ratios))
