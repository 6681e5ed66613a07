"""What each recording held out says of the causes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..._support.numbers import digits, percent
from ..._support.scale import scale_of
from .section import Section

if TYPE_CHECKING:
    from ...diagnosis.findings.result import Diagnosis
    from ..drawings import Drawings

__all__ = ["build"]


def build(diagnosis: Diagnosis, drawings: Drawings) -> Section | None:
    """Residual before and after in each of them, and the odds; None where none was held out."""
    bets = diagnosis.evidence
    if not bets.each or not diagnosis.effects:
        return None
    scale = scale_of(diagnosis)
    rows = [
        {
            "recording": bet.recording,
            "before": scale.text(bet.before),
            "after": scale.text(bet.after),
            "gain": percent(bet.gain),
            "added": bet.added,
        }
        for bet in bets.each
    ]
    content = {
        "rows": rows,
        "words": bets.words[:1].upper() + bets.words[1:],
        "odds": digits(bets.value),
    }
    return Section("evidence", "Recording by recording", content)
