"""Other friction laws in place of the plant's."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...catalogue import laws as catalogue
from ..numbers import percent, percent_between
from .section import Section

if TYPE_CHECKING:
    from ...diagnosis.result import Diagnosis
    from ..drawings import Drawings

__all__ = ["build"]


def build(diagnosis: Diagnosis, drawings: Drawings) -> Section | None:
    """Laws with their gain; None where none were compared."""
    if not diagnosis.laws:
        return None
    summaries = {record.name: record.summary for record in catalogue()}
    rows = [
        {
            "law": row.law,
            "summary": summaries.get(row.law, ""),
            "gain": "" if row.gain is None else percent(row.gain.value),
            "interval": "" if row.gain is None else percent_between(*row.gain.ci95),
            "reason": row.reason,
        }
        for row in diagnosis.laws
    ]
    content = {"rows": rows, "own": diagnosis.plant.friction.law}
    return Section("laws", "Other friction laws", content)
