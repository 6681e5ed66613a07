"""Every cause: what was found, what it means, what to try."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from ...catalogue import EffectRecord, effects
from ..drawings import cause_name
from ..numbers import percent, percent_between, plain
from .parameters import row
from .section import Section

if TYPE_CHECKING:
    from ...diagnosis.result import Cause, Diagnosis
    from ..drawings import Drawings

__all__ = ["build"]

NEAR: Final = 0.9
"""Share of a cause's score from which on a refused effect is worth a word beside it."""


def build(diagnosis: Diagnosis, drawings: Drawings) -> Section | None:
    """The causes, best first; None where nothing was named."""
    if not diagnosis.effects:
        return None
    records = {record.name: record for record in effects()}
    causes = [
        {
            **_cause(cause, records.get(cause.name)),
            "rivals": _rivals(diagnosis, cause),
            "picture": drawings.get(cause_name(index, cause.name)),
        }
        for index, cause in enumerate(diagnosis.effects)
    ]
    title = "The cause" if len(causes) == 1 else f"The {len(causes)} causes"
    return Section("findings", title, {"causes": causes})


def _rivals(diagnosis: Diagnosis, cause: Cause) -> list[str]:
    """Effects that were refused although they score about as high: the reader should know."""
    named = {cause.name, *cause.look_alikes, *(effect.name for effect in diagnosis.effects)}
    scores = {row.name: row.score for row in diagnosis.candidates if row.score is not None}
    own = scores.get(cause.name)
    if own is None:
        return []
    return [
        plain(name) for name, score in scores.items() if name not in named and score >= NEAR * own
    ]


def _cause(cause: Cause, record: EffectRecord | None) -> dict[str, Any]:
    summary = cause.what
    if record is not None and summary.startswith(f"{record.summary}: "):
        # The values stand in the table, with their units and intervals.
        summary = record.summary
    meanings = {} if record is None else {p.name: p.meaning for p in record.parameters}
    gain = cause.gain
    doubtful = bool(cause.parameters) and all(
        p.ci95[0] <= 0.0 <= p.ci95[1] for p in cause.parameters.values()
    )
    return {
        "name": cause.name,
        "title": plain(cause.name),
        "decided": cause.decided,
        "doubtful": doubtful,
        "look_alikes": [plain(name) for name in cause.look_alikes],
        "what": summary,
        "means": cause.means,
        "try": cause.try_,
        "gain": None if gain is None else percent(gain.value),
        "interval": None if gain is None else percent_between(*gain.ci95),
        "uncertain": gain is not None and gain.ci95[0] <= 0.0,
        "parameters": [
            row(path, p, meanings.get(path.rsplit(".", 1)[-1], ""))
            for path, p in cause.parameters.items()
        ],
    }
