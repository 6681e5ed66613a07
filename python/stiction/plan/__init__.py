"""Signals to record with: what a session needs so that causes can be told apart."""

from __future__ import annotations

from .experiments import EXPERIMENTS, Experiment
from .limits import Limits
from .result import Plan, Signal
from .run import plan

__all__ = ["EXPERIMENTS", "Experiment", "Limits", "Plan", "Signal", "plan"]
