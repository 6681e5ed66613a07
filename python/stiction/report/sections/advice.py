"""What to record next."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from .section import Section

if TYPE_CHECKING:
    from ...diagnosis.findings.result import Diagnosis
    from ..drawings import Drawings

__all__ = ["build"]

SOLVED: Final = ("missing_effect", "nothing_missing")
"""Where a name stands one experiment is enough to begin with."""


def build(diagnosis: Diagnosis, drawings: Drawings) -> Section | None:
    """Experiments, the most useful first; None where there is nothing to advise."""
    rows = [
        {"experiment": each.experiment, "reason": each.reason}
        for each in diagnosis.advice
        # What to do about a fault stands beside the fault, on the first screen.
        if diagnosis.verdict != "data_fault" or each.experiment not in _remedies(diagnosis)
    ]
    if not rows:
        return None
    solved = diagnosis.verdict in SOLVED and all(cause.decided for cause in diagnosis.effects)
    first = rows[:1] if solved else rows
    content = {"first": first, "further": rows[len(first) :]}
    return Section("advice", "What to record next", content)


def _remedies(diagnosis: Diagnosis) -> set[str]:
    checks = diagnosis.data.get("checks") or ()
    return {check["try"] for check in checks if check["verdict"] == "fault"}
