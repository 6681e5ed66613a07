"""What acts for a second or two: asked again where rows that decide are fitted as well."""

from __future__ import annotations

from collections.abc import Sequence

from ..._support.arrays import FloatArray
from ...catalogue import effects
from ..adequacy.bursts import bursts
from ..data.evidence import Evidence
from ..screening.model import Model
from .decide import Trial
from .ranges import SURELY, is_whole
from .rounds import friction_of
from .search import Search

__all__ = ["acts_for_seconds", "holds_more", "tried_names", "with_rows_of"]


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
    if selection.spread or selection.unseen:
        return True
    return bursts(evidence, selection.models[-1], null, friction)


def tried_names(selection: Search) -> Sequence[str]:
    """What need not be looked for again: all that acts all the time, where nothing was found.

    Beside a cause everything is asked, for that has to be found again.
    """
    if selection.choices:
        return ()
    return [record.name for record in effects() if not record.limits]


def holds_more(again: Search, before: Search) -> bool:
    """Whether the second look tells all that the first one did, and limits beside that.

    What a limit holds back has to be known there, or to have come out as everything: a push of a
    fifth of a second takes a share that may as well be nothing.
    """
    found, known = ({each.winner.name for each in one.choices} for one in (again, before))
    more = [each.winner for each in again.choices if each.winner.name not in known]
    if not again.choices:
        return not known and bool(again.unseen) and not before.unseen
    return found > known and all(_is_known(trial, again.models[-1]) for trial in more)


def _is_known(trial: Trial, model: Model) -> bool:
    candidate = trial.candidate
    if not candidate.record.limits:
        return False
    numbers = [
        model.fit_result.parameters[f"effects.{trial.name}.{gain}"] for gain in candidate.gains
    ]
    known = all(abs(each.value) > SURELY * each.stderr for each in numbers)
    return known or is_whole(candidate, model)


def with_rows_of(again: Search, before: Search) -> Search:
    """The second look with what the first one said of all effects that only it has asked."""
    asked = again.rows.keys()
    again.blind += [record for record in before.blind if record.name not in asked]
    again.rows = {**before.rows, **again.rows}
    if not again.choices:
        again.imitated = max(again.imitated, before.imitated)
    return again
