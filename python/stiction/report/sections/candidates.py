"""Every effect that was tried, and why it was accepted or refused."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..._support.numbers import percent
from ..titles import effect_title
from .section import Section

if TYPE_CHECKING:
    from ...diagnosis.findings.result import Diagnosis
    from ..drawings import Drawings

__all__ = ["build"]


def build(diagnosis: Diagnosis, drawings: Drawings) -> Section | None:
    """All candidates in their order; None where none were tried."""
    if not diagnosis.candidates:
        return None
    accepted = {effect.name for effect in diagnosis.effects}
    rows = [
        {
            "name": row.name,
            "title": effect_title(row.name),
            "score": percent(row.score),
            "threshold": percent(row.threshold),
            "gain": percent(row.select_gain),
            "reason": row.reason,
            "accepted": row.name in accepted,
        }
        for row in diagnosis.candidates
    ]
    content = {
        "accepted": [row for row in rows if row["accepted"]],
        "refused": [row for row in rows if not row["accepted"]],
        "picture": drawings.get("candidates"),
    }
    return Section("candidates", "All effects that were tried", content)
