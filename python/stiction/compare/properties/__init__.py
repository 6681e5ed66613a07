"""The columns of the table, in order."""

from __future__ import annotations

from typing import Final

from ..measured import Property
from .creep import CREEP, HARDENING, HOLDS, POSSIBLE_HARDENING
from .memory import BRANCHES, LINEAR, RECOVERED, WIPED
from .passivity import PASSIVE
from .robustness import NOISE, RATCHET
from .sliding import LAG, RATE, STRIBECK

__all__ = ["PROPERTIES"]

PROPERTIES: Final[tuple[Property, ...]] = (
    CREEP,
    HARDENING,
    POSSIBLE_HARDENING,
    BRANCHES,
    RECOVERED,
    WIPED,
    LINEAR,
    HOLDS,
    RATCHET,
    NOISE,
    RATE,
    LAG,
    STRIBECK,
    PASSIVE,
)
