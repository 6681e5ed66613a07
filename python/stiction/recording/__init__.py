"""Recordings of real machines: files read, columns understood, small faults mended and told."""

from __future__ import annotations

from .._support.units import UNITS, Unit
from ..errors import InputError
from .blocks import Part
from .checks import Check, check
from .columns import CANONICAL, ROLES, Column, Columns
from .formats import read_table
from .recording import SETTINGS, Recording
from .repair import Repair
from .split import Fold, Split
from .table import Cell, Table

__all__ = [
    "CANONICAL",
    "ROLES",
    "SETTINGS",
    "UNITS",
    "Cell",
    "Check",
    "Column",
    "Columns",
    "Fold",
    "InputError",
    "Part",
    "Recording",
    "Repair",
    "Split",
    "Table",
    "Unit",
    "check",
    "read_table",
]
