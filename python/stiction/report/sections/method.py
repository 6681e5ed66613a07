"""How this was done, in a few sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .section import Section

if TYPE_CHECKING:
    from ...diagnosis.findings.result import Diagnosis
    from ..drawings import Drawings

__all__ = ["build"]


def build(diagnosis: Diagnosis, drawings: Drawings) -> Section:
    """Method, version and seed."""
    content = {
        "fitted": diagnosis.extended is not None,
        "effects": bool(diagnosis.effects),
        "loop": diagnosis.plant.servo,
        "shot": "(shooting)" in (diagnosis.data.get("residual") or ""),
        "version": diagnosis.version,
        "seed": diagnosis.seed,
    }
    return Section("method", "How this was done", content)
