"""Diagnosis: what a simulation gets wrong, its cause by name, and what naming it gained."""

from __future__ import annotations

from .pipeline import ALPHA, SMALLEST, SURROGATES, diagnose
from .result import Diagnosis

__all__ = ["ALPHA", "SMALLEST", "SURROGATES", "Diagnosis", "diagnose"]
