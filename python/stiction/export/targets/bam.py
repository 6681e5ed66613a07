"""Parameters of `better-actuator-models` (BAM): the least of M1 to M6 that holds the plant."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..._support.json_text import json_of
from ...bam.writer import numbers_of
from ...plant.joint import sidecar
from ..made import Export

if TYPE_CHECKING:
    from ...plant import Plant

SUMMARY = "parameters of better-actuator-models (M1 to M6), read again by stiction import"


def write(plant: Plant, speed: float) -> Export:
    """A file that ``bam.model.load_model`` reads; beside it the whole plant."""
    made = numbers_of(plant, speed)
    files = {
        "params.json": json_of(made.table) + "\n",
        "joint.json": sidecar(plant, made.numbers, made.lost),
    }
    return Export("bam", files, made.held, made.lost, made.numbers)
