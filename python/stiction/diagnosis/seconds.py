"""What acts for a second or two: asked again where rows that decide are fitted as well."""

from __future__ import annotations

from collections.abc import Sequence

from ..catalogue import effects
from ..trajectory import FloatArray
from .bursts import burst_of
from .evidence import Evidence
from .rounds import friction_of
from .selection import Search

__all__ = ["acts_for_seconds", "asked_before", "holds_more", "with_rows_of"]


def acts_for_seconds(evidence: Evidence, selection: Search, null: FloatArray) -> bool:
    """Whether something that has no name may have acted too seldom to be seen in every role.

    A limit that a drive reaches in two or three places of a session lies in rows that are fitted,
    or in those that decide, as the roles were dealt. Fitted on both, and left out in turn, the
    places can tell of each other; the rows that test stay sealed all the same.

    Parameters
    ----------
    evidence : Evidence
    selection : Search
    null : numpy.ndarray, shape (n, surrogates)
        Residuals of the surrogates.
    """
    if selection.interrupted or not evidence.split.select:
        return False
    friction = friction_of(evidence, selection.models[0])
    burst = burst_of(evidence, selection.models[-1], null, friction)
    return selection.spread or bool(selection.unseen) or burst is not None


def asked_before(selection: Search) -> Sequence[str]:
    """What need not be looked for again: all that acts all the time, where nothing was found.

    Beside a cause everything is asked, for that has to be found again.
    """
    if selection.choices:
        return ()
    return [record.name for record in effects() if not record.limits]


def holds_more(again: Search, before: Search) -> bool:
    """Whether the second look tells all that the first one did, and more."""
    found, known = ({each.winner.name for each in one.choices} for one in (again, before))
    return found > known or (not known and bool(again.unseen) and not before.unseen)


def with_rows_of(again: Search, before: Search) -> Search:
    """The second look with what the first one said of all effects that only it has asked."""
    asked = again.rows.keys()
    again.blind += [record for record in before.blind if record.name not in asked]
    again.rows = {**before.rows, **again.rows}
    return again
