"""What a comparison takes where nothing else is stated; the command line shows it in its help."""

from __future__ import annotations

from typing import Final

__all__ = ["DRAWS", "PASSIVE_STEPS"]

DRAWS: Final = 24
"""Sets of parameters for each law."""
PASSIVE_STEPS: Final = 20_000
"""Random steps for each case and each draw of a law, unless another number is asked for."""
