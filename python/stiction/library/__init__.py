"""Machines whose friction is known: numbers with their intervals and sources, and your unit beside.

Each file in ``entries`` is one, found by itself. An entry holds numbers and no recording.
"""

from __future__ import annotations

from .comparison import UnitComparison, UnitNumber, compare
from .entry_file import Entry, EntryNumber, entries, entry
from .own_fit import entry_of_fit

__all__ = [
    "Entry",
    "EntryNumber",
    "UnitComparison",
    "UnitNumber",
    "compare",
    "entries",
    "entry",
    "entry_of_fit",
]
