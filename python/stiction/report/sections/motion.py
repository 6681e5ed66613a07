"""Measured beside simulated: what the machine's owner came with."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..._support.numbers import digits
from ..._support.scale import scale_for
from .section import Section

if TYPE_CHECKING:
    from ...diagnosis.findings.pictures import Trace
    from ...diagnosis.findings.result import Diagnosis
    from ..drawings import Drawings

__all__ = ["build"]


def build(diagnosis: Diagnosis, drawings: Drawings) -> Section | None:
    """Positions of both models beside the measured one, and all recordings; None without them."""
    pictures = diagnosis.pictures
    if pictures is None or not pictures.traces:
        return None
    simulated = [trace for trace in pictures.traces if trace.simulated is not None]
    tested = [trace for trace in simulated if trace.tests.any()]
    content = {
        "both": bool(diagnosis.effects),
        "moved": diagnosis.plant.prescribed_motion,
        "loop": any(trace.loop for trace in simulated),
        "tested": bool(tested),
        "errors": _errors(tested or simulated, pictures.position_unit),
        "recordings": len(pictures.traces),
        "picture": drawings.get("motion"),
    }
    return Section("motion", "Measured and simulated", content)


def _errors(traces: list[Trace], unit: str) -> list[str]:
    """Position error before and after over the rows that test, or over all that were used."""
    if not traces:
        return []
    squares: list[list[np.ndarray]] = [[], []]
    for trace in traces:
        rows = trace.tests if trace.tests.any() else trace.role > 0
        for place, simulated in enumerate(trace.simulated or ()):
            squares[place].append((trace.position - simulated)[rows] ** 2)
    sizes = [float(np.sqrt(np.mean(np.concatenate(each)))) for each in squares]
    scale = scale_for(sizes, unit)
    return [digits(scale.factor * sizes[0]), scale.text(sizes[1])]
