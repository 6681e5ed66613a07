"""Machines whose friction is known: numbers with their intervals and sources, and your unit beside.

Each file in ``entries`` is one, found by itself. An entry holds numbers and no recording.
"""

from __future__ import annotations

from .comparison import Compared, Comparison, compare
from .entry_file import Entry, Number, entries, entry

__all__ = ["Compared", "Comparison", "Entry", "Number", "compare", "entries", "entry"]
