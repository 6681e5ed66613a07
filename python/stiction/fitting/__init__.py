"""Fits: the parameters with which a plant leaves the least effort unexplained."""

from __future__ import annotations

from .curve import CurveFit, fit_curve
from .result import FitParameter, FitResult
from .solve import fit

__all__ = ["CurveFit", "FitParameter", "FitResult", "fit", "fit_curve"]
