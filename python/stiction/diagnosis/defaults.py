"""What a diagnosis takes where nothing else is stated; the command line shows it in its help."""

from __future__ import annotations

from typing import Final

__all__ = ["ALPHA", "SMALLEST", "SURROGATES"]

ALPHA: Final = 0.01
"""Level of the screening for a whole session."""
SMALLEST: Final = 0.001
"""Contribution, as a share of the friction, below which an effect is not worth a name."""
SURROGATES: Final = 24
"""Replays of the base with noise; more make thresholds smoother and cost in proportion."""
