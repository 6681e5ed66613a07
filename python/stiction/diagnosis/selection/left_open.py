"""Names that are told and left open: what speaks against each of them once all is measured."""

from __future__ import annotations

from collections.abc import Collection, Sequence, Set
from dataclasses import replace
from itertools import pairwise
from typing import Final

from ...catalogue import effects
from ..adequacy.exact_forms import doubt_geometry
from ..adequacy.passing import MOMENTS
from ..data.gain import HeldOut, gain_of
from ..phrases import (
    ALONE,
    MAY_BE_NOTHING,
    OF_ANOTHER_LAW,
    ONE_CURVE,
    OUTWEIGHED,
    PARTLY,
    UNCONFIRMED,
    UNPLACED,
    UNREPEATED,
)
from ..records import Cause, Unexplained
from .chance import lacks_repeats
from .decide import SURE
from .ranges import is_placed, is_whole, surely_a_part
from .search import Search

__all__ = [
    "OF_A_LAW",
    "beside_another_law",
    "leave_open",
    "leave_waves_open",
    "leave_zero_open",
    "of_one_curve",
    "open_limits",
    "outweighed_names",
    "unconfirmed_names",
]

MUCH_LEFT: Final = 0.5
"""What is left without a name counts against one name where it is worth this share of what that one
took: right names came to 0.4 but for one, and what was named of a contact whose law has another
form to 0.6 and more."""
MAY_LOSE: Final = 0.25
"""Share of its gain on the rows that test that what is known well may lose there: a right name that
acts in one block of them may lose nothing, a wrong one known as well .43."""
OF_A_LAW: Final = frozenset({"breakaway", "creep", "memory"})
"""Families of effects that say how friction goes with speed, time and reversals, as laws do."""
OVER_SPEED: Final = frozenset(record.name for record in effects() if record.over_speed)
"""Effects that are parts of one curve, that of friction over speed."""


def leave_open(
    selection: Search,
    causes: Sequence[Cause],
    left: Sequence[Unexplained],
    rests: Sequence[Unexplained],
    replaced: Collection[str],
    unsure: Collection[str],
) -> list[Cause]:
    """Causes, undecided where what is left, or how they came in, leaves doubt of their names.

    Parameters
    ----------
    selection : Search
    causes : sequence of Cause
        In the order of the choices of ``selection``.
    left : sequence of Unexplained
        What has no name.
    rests : sequence of Unexplained
        What is left where names leave nothing, as ``rests_of`` tells.
    replaced : collection of str
        Names that a number of the plant file, were it free, explains as well.
    unsure : collection of str
        Names that ``unconfirmed_names`` tells.
    """
    found = [doubt_geometry(cause, left, rests) for cause in causes]
    found = leave_zero_open(selection, found)
    doubts = dict.fromkeys(unsure, UNCONFIRMED)
    doubts |= dict.fromkeys(outweighed_names(selection, left), OUTWEIGHED)
    doubts |= open_limits(selection)
    doubts |= dict.fromkeys(of_one_curve(selection), ONE_CURVE)
    return [
        replace(
            cause,
            decided=cause.decided and cause.name not in {*replaced, *doubts},
            doubt=doubts.get(cause.name, cause.doubt),
        )
        for cause in leave_waves_open(selection, found)
    ]


def leave_waves_open(selection: Search, causes: Sequence[Cause]) -> list[Cause]:
    """Causes, waves that nobody saw to repeat undecided."""
    final = selection.models[-1]
    return [
        replace(cause, decided=False, doubt=UNREPEATED)
        if lacks_repeats(final, cause.name)
        else cause
        for cause in causes
    ]


def beside_another_law(causes: Sequence[Cause]) -> list[Cause]:
    """Causes beside a law that nobody stated: undecided where that law may be what has them.

    It stands for its kind, sticking or yielding, and how friction goes with speed, time and
    reversals is a law's own business.
    """
    return [
        replace(cause, decided=False, doubt=OF_ANOTHER_LAW) if cause.family in OF_A_LAW else cause
        for cause in causes
    ]


def unconfirmed_names(
    selection: Search, causes: Sequence[Cause], test: HeldOut | None, seed: int
) -> Set[str]:
    """Which names the rows that test do not bear out: their gain there may be nothing.

    By themselves and with those after them: what comes after a cause may be what hid its gain. What
    acts in few blocks is in few draws of them: what fitted blocks leave no doubt of may lose a part
    of its gain, and a limit that came out as one all of it. Of 166 right names one gained .37 and
    less on such rows, of seven wrong ones five.
    """
    if test is None:
        return set()
    final, last = selection.models[-1], len(causes)

    def may_lose(place: int) -> float:
        candidate = selection.choices[place].winner.candidate
        if is_whole(candidate, final):
            return 1.0
        return MAY_LOSE if final.strength(candidate) >= SURE else 0.0

    def may_be_nothing(place: int, to: int) -> bool:
        gain = gain_of(test, place, to, seed)
        return gain.ci95[0] <= -may_lose(place) * max(gain.value, 0.0)

    return {
        cause.name
        for place, cause in enumerate(causes)
        if all(may_be_nothing(place, to) for to in (place + 1, last))
    }


def of_one_curve(selection: Search) -> Set[str]:
    """Which further names go with speed alone, as an earlier one does, and are not beyond doubt.

    Friction over speed is one curve. What is added to the first name of a part of it may be a part
    of its own, or what the form of the first one, which is its author's and not the machine's,
    leaves of it.
    """
    final = selection.models[-1]
    named = [
        choice.winner.candidate for choice in selection.choices if choice.winner.name in OVER_SPEED
    ]
    return {each.name for each in named[1:] if final.strength(each) < SURE}


def outweighed_names(selection: Search, left: Sequence[Unexplained]) -> Set[str]:
    """Which names took little beside what is left and has none.

    All names together may outweigh that by far: the first one takes most, and later ones follow
    what the law or the first one leaves. Recordings and moments that stand out tell nothing of
    what acts in all others.
    """
    places = {each.coordinate: each.share for each in left if each.coordinate != MOMENTS.name}
    everywhere = [share for name, share in places.items() if not name.endswith(ALONE)]
    powers = [float(model.blocks[1].sum()) for model in selection.models]
    unnamed = max(everywhere, default=0.0) * powers[-1]
    names = (choice.winner.name for choice in selection.choices)
    return {
        name
        for name, (before, after) in zip(names, pairwise(powers), strict=True)
        if unnamed > MUCH_LEFT * max(before - after, 0.0)
    }


def open_limits(selection: Search) -> dict[str, str]:
    """Limits that surely let a part through of what is beyond them, or lie anywhere; and why.

    No drive lets a part through: a torque constant that falls does in its own curve, and so may
    what pushed for a second. Of 100 sessions with pushes and drags three were told as a limit that
    takes a part, and of 17 with a gain that falls to a floor, which the catalogue has not, three.
    """
    final = selection.models[-1]
    found = {}
    for candidate in (choice.winner.candidate for choice in selection.choices):
        if surely_a_part(candidate, final):
            found[candidate.name] = PARTLY
        elif not is_placed(candidate, final):
            found[candidate.name] = UNPLACED
    return found


def leave_zero_open(selection: Search, causes: Sequence[Cause]) -> list[Cause]:
    """Causes, undecided where every one of their numbers may be 0.

    All of its numbers together may help beyond doubt, and they may help to mend what the form of
    the law or of a first cause leaves: of eight wrong second and third names every number of seven
    reached 0, at strengths of 9 at most where these were asked, and of three first ones two were
    wrong. What blocks leave no doubt of needs no number, where the fit tells it from all others: of
    a gain that these make up for blocks know nothing.
    """
    final = selection.models[-1]
    found = list(causes)
    for place, (choice, cause) in enumerate(zip(selection.choices, causes, strict=True)):
        if cause.doubtful and not (
            cause.determined and final.strength(choice.winner.candidate) >= SURE
        ):
            found[place] = replace(cause, decided=False, doubt=MAY_BE_NOTHING)
    return found
