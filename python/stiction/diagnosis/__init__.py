"""Diagnosis: what a simulation gets wrong, its cause by name, and what naming it gained."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .._support.lazy import lazy
from .defaults import ALPHA, SMALLEST, SURROGATES

if TYPE_CHECKING:
    from .findings.result import Diagnosis
    from .pipeline import diagnose

__all__ = ["ALPHA", "SMALLEST", "SURROGATES", "Diagnosis", "diagnose"]

__getattr__, __dir__ = lazy(
    __name__,
    {
        "ALPHA": "defaults",
        "Diagnosis": "findings.result",
        "SMALLEST": "defaults",
        "SURROGATES": "defaults",
        "diagnose": "pipeline",
    },
)
