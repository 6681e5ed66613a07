"""What the columns of a file are: a guess from their names, their units and their numbers."""

from __future__ import annotations

from .overrule import overrule
from .result import ColumnGuess, Guess
from .roles import guess

__all__ = ["ColumnGuess", "Guess", "guess", "overrule"]
