"""Recordings of real machines: files read, columns understood, small faults mended and told."""

from __future__ import annotations

from ..errors import InputError
from .columns import CANONICAL, ROLES, Column, Columns
from .formats import read_table
from .recording import Recording
from .repair import Repair
from .table import Cell, Table
from .units import UNITS, Unit

__all__ = [
    "CANONICAL",
    "ROLES",
    "UNITS",
    "Cell",
    "Column",
    "Columns",
    "InputError",
    "Recording",
    "Repair",
    "Table",
    "Unit",
    "read_table",
]
