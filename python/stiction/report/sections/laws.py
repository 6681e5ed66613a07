"""Other friction laws in place of the plant's."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from ..._support.numbers import percent, percent_between
from ...catalogue import laws as catalogue
from .section import Section

if TYPE_CHECKING:
    from ...diagnosis.findings.result import Diagnosis
    from ...diagnosis.records import LawRow
    from ..drawings import Drawings

__all__ = ["build"]

FAILED: Final = -10.0
"""Gain below which its digits say nothing."""


def build(diagnosis: Diagnosis, drawings: Drawings) -> Section | None:
    """Laws with their gain; None where none were compared."""
    if not diagnosis.laws:
        return None
    summaries = {record.name: record.summary for record in catalogue()}
    rows = [
        {
            "law": row.law,
            "summary": summaries.get(row.law, ""),
            **_numbers(row),
            "reason": row.reason,
        }
        for row in diagnosis.laws
    ]
    content = {"rows": rows, "own": diagnosis.plant.friction.law}
    return Section("laws", "Other friction laws", content)


def _numbers(row: LawRow) -> dict[str, str]:
    """Gain and its interval; of a law whose fit has failed only that it is far below 0."""
    if row.gain is None:
        return {"gain": "", "interval": ""}
    if row.gain.value < FAILED:
        return {"gain": f"below {percent(FAILED, 0)}", "interval": ""}
    return {"gain": percent(row.gain.value), "interval": percent_between(*row.gain.ci95)}
