"""The loop with its controller: what the position error of a simulation becomes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..._support.numbers import percent
from ..._support.scale import loop_scale_of
from ...diagnosis.findings.words import MISSED
from .section import Section

if TYPE_CHECKING:
    from ...diagnosis.findings.result import Diagnosis
    from ..drawings import Drawings

__all__ = ["build"]


def build(diagnosis: Diagnosis, drawings: Drawings) -> Section | None:
    """Position errors in closed loop; None where no loop was replayed."""
    before, after = diagnosis.baseline, diagnosis.extended
    if before is None or after is None or before.replay is None or after.replay is None:
        return None
    scale = loop_scale_of(diagnosis)

    def text(rms: float | None) -> str:
        return "ran away" if rms is None else scale.text(rms)

    rows = [
        {"name": name, "role": role, "before": text(one), "after": text(two)}
        for name, role, one, two in (
            ("fitted", "train", before.replay.train_rms, after.replay.train_rms),
            ("held out", "test", before.replay.heldout_rms, after.replay.heldout_rms),
        )
        if one is not None or two is not None
    ]
    missed = after.replay.controller_error
    content = {
        "both": bool(diagnosis.effects),
        "rows": rows,
        "missed": percent(missed, 2),
        "doubtful": missed is not None and missed > MISSED,
        "picture": drawings.get("closed-loop"),
    }
    return Section("loop", "In closed loop", content)
