"""Runs the experiments."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from functools import partial

from .. import catalogue
from .._support.given import brief, names, whole
from .._support.progress import phase
from .._support.progress import steps as each_step
from .._support.wording import commas, did_you_mean
from ..catalogue import LawRecord
from ..errors import InputError
from .cost import BESIDE, costs
from .defaults import DRAWS, PASSIVE_STEPS
from .draws import draws as draw
from .properties import PROPERTIES
from .properties.passivity import passive
from .result import CONDITIONAL, Cell, Comparison, Row, verdict_of
from .subject import Subject, variants

__all__ = ["compare"]

_logger = logging.getLogger(__name__)


def compare(
    laws: Sequence[str] = (),
    *,
    steps: int = PASSIVE_STEPS,
    draws: int = DRAWS,
    progress: Callable[[str], None] | None = None,
) -> Comparison:
    """Compare friction laws by experiment: fifteen properties of each, computed.

    Every law is tried at its defaults, at typical values of all its terms and with each of its
    options; for passivity its parameters are drawn as well. A property that all cases have is a
    yes, one that some have is conditional.

    Parameters
    ----------
    laws : sequence of str
        All of the catalogue without any.
    steps : int
        Random steps of each case in the test of passivity.
    draws : int
        Sets of parameters drawn about the defaults in that test.
    progress : callable, optional
        Called with the name of each law before its turn.

    Returns
    -------
    Comparison

    Raises
    ------
    InputError
        No sequence of names, an unknown law, fewer than 1000 steps, draws below 0, a progress
        that cannot be called.

    Examples
    --------
    >>> table = compare(["coulomb", "maxwell_slip"], steps=2000, draws=2)
    >>> table["maxwell_slip"].cells["reverse_points_recovered"].verdict
    'yes'
    """
    steps = whole(steps, "compare: steps", least=1000)
    draws = whole(draws, "compare: draws", least=0)
    if progress is not None and not callable(progress):
        raise InputError(
            f"compare: progress: {brief(progress)} cannot be called; give a function of the name "
            "of a law, or None"
        )
    records = [_record(name) for name in dict.fromkeys(names(laws, "compare: laws"))] or list(
        catalogue.laws()
    )
    rows = []
    spent = costs([record.name for record in records])
    for record in each_step(records, "law"):
        phase(_logger, "comparing %s", record.name)
        if progress is not None:
            progress(record.name)
        rows.append(_row(record, steps, draws, spent))
    return Comparison(PROPERTIES, tuple(rows), steps, draws)


def _row(record: LawRecord, steps: int, number: int, spent: Mapping[str, float]) -> Row:
    subjects = list(variants(record))
    drawn = list(draw(record, number))
    cells = {}
    for each in PROPERTIES:
        measure = partial(passive, steps=steps) if each.drawn_over else each.measure
        tried = [*subjects, *(drawn if each.drawn_over else ())]
        cases = {subject.label: measure(subject) for subject in tried}
        verdict, note = verdict_of(cases)
        if verdict == CONDITIONAL and each.drawn_over:
            note += _shared([s for s in drawn if not cases[s.label].holds], drawn)
        cells[each.name] = Cell(verdict, note, cases)
    scale = subjects[0].scale
    cost = spent[record.name]
    return Row(
        record.name, scale.level, scale.span, scale.slides, cells, cost, cost / spent[BESIDE]
    )


def _shared(failed: Sequence[Subject], drawn: Sequence[Subject]) -> str:
    """What all draws that failed have chosen, and not all draws have."""
    words = [
        f"{name} = {word}"
        for name, word in (failed[0].keywords.items() if len(failed) > 1 else ())
        if isinstance(word, str)
        and all(subject.keywords[name] == word for subject in failed)
        and any(subject.keywords[name] != word for subject in drawn)
    ]
    return f", the others all with {' and '.join(words)}" if words else ""


def _record(name: str) -> LawRecord:
    records = {record.name: record for record in catalogue.laws()}
    if name not in records:
        raise InputError(
            f"law '{name}' is unknown{did_you_mean(name, list(records))}; known are "
            f"{commas(list(records))}"
        )
    return records[name]
