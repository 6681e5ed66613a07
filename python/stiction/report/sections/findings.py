"""Every cause: what was found, what it means, what to try."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

from ..._support.numbers import percent, percent_between, plain, quantity
from ..._support.scale import effort_unit_of
from ..._support.wording import join_words
from ...catalogue import EffectRecord, effects
from ...diagnosis.findings.directions import describe_effect
from ...diagnosis.screening.orders import order_words
from ..drawings import cause_name
from ..titles import effect_title
from .parameters import row, rows_of_effect
from .section import Section

if TYPE_CHECKING:
    from ...diagnosis.findings.result import Diagnosis
    from ...diagnosis.records import Cause
    from ...plant import Plant
    from ...plant.stated import Effect
    from ..drawings import Drawings

__all__ = ["build"]

NUMBERS: Final = {2: "two", 3: "three", 4: "four", 5: "five"}
NEAR: Final = 0.9
"""Share of a cause's score from which on a refused effect is worth a word beside it."""


def build(diagnosis: Diagnosis, drawings: Drawings) -> Section | None:
    """The causes, best first; None where nothing was named."""
    if not diagnosis.effects:
        return None
    records = {record.name: record for record in effects()}
    causes = [
        {
            **_cause(cause, records.get(cause.name), diagnosis),
            # Scores are those of the first round, in which later causes stood beside this one.
            "rivals": _rivals(diagnosis, cause) if index == 0 else [],
            "picture": drawings.get(cause_name(index, cause.name)),
        }
        for index, cause in enumerate(diagnosis.effects)
    ]
    number = len(causes)
    title = "The cause" if number == 1 else f"The {NUMBERS.get(number, number)} causes"
    return Section("findings", title, {"causes": causes})


def _rivals(diagnosis: Diagnosis, cause: Cause) -> list[str]:
    """Effects that were refused although they score about as high: the reader should know.

    What lost to another cause was scored beside it, as a share of another residual.
    """
    others = {effect.name for effect in diagnosis.effects} - {cause.name}
    named = {cause.name, *cause.look_alikes, *(effect.name for effect in diagnosis.effects)}
    scores = {
        row.name: row.score
        for row in diagnosis.candidates
        if row.score is not None and others.isdisjoint(row.reason.split())
    }
    own = scores.get(cause.name)
    if own is None:
        return []
    return [
        plain(name) for name, score in scores.items() if name not in named and score >= NEAR * own
    ]


def _cause(cause: Cause, record: EffectRecord | None, diagnosis: Diagnosis) -> dict[str, Any]:
    plant = diagnosis.plant
    summary = cause.what
    if record is not None:
        model = {} if diagnosis.extended is None else diagnosis.extended.parameters
        meaning = describe_effect(record, {**model, **cause.parameters})
        if summary.startswith(f"{meaning}: "):
            # The values stand in the table, with their units and intervals.
            summary = meaning
    effect = next((each for each in plant.effects if each.name == cause.name), None)
    rows = [row(path, p, "", beside=cause.parameters) for path, p in cause.parameters.items()]
    if record is not None and effect is not None:
        rows = rows_of_effect(
            effect, cause.parameters, cause.waves, record, plant, effort_unit_of(diagnosis)
        )
    gain = cause.gain
    return {
        "name": cause.name,
        "title": effect_title(cause.name),
        "decided": cause.decided,
        "doubt": cause.doubt,
        "doubtful": cause.doubtful,
        "counted": cause.track_record,
        "look_alikes": [plain(name) for name in cause.look_alikes],
        "what": f"{summary}{_how_often(effect, plant, cause)}",
        "means": cause.means,
        "try": cause.try_,
        "gain": None if gain is None else percent(gain.value),
        "interval": None if gain is None else percent_between(*gain.ci95),
        "uncertain": gain is not None and gain.ci95[0] <= 0.0,
        "worse": gain is not None and gain.ci95[1] < 0.0,
        "parameters": rows,
    }


def _how_often(effect: Effect | None, plant: Plant, cause: Cause) -> str:
    """How often a wave repeats, "" for what has no order."""
    given = {} if effect is None else effect.parameters
    if any(order_words(path, p) for path, p in cause.parameters.items()):
        return ", in less than one period over the range of motion: how often is not determined"
    orders = [f"{given[name].value:.4g}" for name in ("order", "order_2") if name in given]
    if not orders:
        return ""
    if plant.motion == "linear":
        lengths = [2.0 * math.pi / given[n].value for n in ("order", "order_2") if n in given]
        return f", every {join_words([quantity(each, 'm') for each in lengths])}"
    times = "once" if orders == ["1"] else f"{join_words(orders)} times"
    return f", {times} a turn"
