"""Plants for the simulators, controllers and tools that people have."""

from __future__ import annotations

from .made import Export
from .registry import Target, targets

__all__ = ["Export", "Target", "targets"]
