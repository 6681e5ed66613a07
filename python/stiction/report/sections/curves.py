"""What the model says of friction over speed, and of efforts over position."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .section import Section

if TYPE_CHECKING:
    from ...diagnosis.findings.result import Diagnosis
    from ..drawings import Drawings

__all__ = ["build"]


def build(diagnosis: Diagnosis, drawings: Drawings) -> Section | None:
    """The friction curve and the position curve; None where they cannot be drawn."""
    picture = drawings.get("curves")
    if picture is None:
        return None
    return Section("curves", "Friction over speed and position", {"picture": picture})
