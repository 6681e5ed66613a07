"""Fits: the parameters with which a plant leaves the least effort unexplained."""

from __future__ import annotations

from .result import FitParameter, FitResult
from .solve import fit

__all__ = ["FitParameter", "FitResult", "fit"]
