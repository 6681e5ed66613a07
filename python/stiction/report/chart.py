"""A figure as plain records: panels with marks, which a writer turns into lines and text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from .._support.arrays import FloatArray
from .axis import Axis

__all__ = ["Area", "Bars", "Chart", "Line", "Mark", "Panel", "Span", "Words"]


@dataclass(frozen=True)
class Line:
    """Points in their order; a value that is none leaves a gap.

    Attributes
    ----------
    x, y : numpy.ndarray, shape (n,)
    colour : str
    width : float
        Points; 0 draws no line.
    marker : str
        "o", "s", "|" or "" at each point.
    size : float
        Of a marker, points.
    label : str
        In the legend.
    """

    x: FloatArray
    y: FloatArray
    colour: str
    width: float = 1.0
    marker: str = ""
    size: float = 0.0
    label: str = ""


@dataclass(frozen=True)
class Span:
    """All between two values of an axis, "x" or "y"."""

    axis: str
    low: float
    high: float
    colour: str
    label: str = ""


@dataclass(frozen=True)
class Area:
    """What lies between two curves."""

    x: FloatArray
    low: FloatArray
    high: FloatArray
    colour: str
    label: str = ""


@dataclass(frozen=True)
class Bars:
    """Bars from ``start`` to ``end`` at the heights ``at``, each so thick, in units of the axis."""

    at: FloatArray
    start: FloatArray
    end: FloatArray
    colours: Sequence[str]
    thickness: float


@dataclass(frozen=True)
class Words:
    """Texts on the right of points."""

    x: FloatArray
    y: FloatArray
    texts: Sequence[str]


Mark: TypeAlias = Line | Span | Area | Bars | Words


@dataclass(frozen=True)
class Panel:
    """Axes and what is drawn between them, the first mark lowest.

    Attributes
    ----------
    x, y : Axis
    marks : sequence of Mark
    height : float
        Points, of the space between the axes.
    title : str
        Above it; lines with "\\n" between.
    size : float
        Of the title, points.
    remark : str
        Above its right end.
    legend : bool
        Whether its labels stand above it.
    """

    x: Axis
    y: Axis
    marks: Sequence[Mark]
    height: float
    title: str = ""
    size: float = 9.5
    remark: str = ""
    legend: bool = False

    @property
    def legend_marks(self) -> list[Line | Span | Area]:
        """Marks that a legend has."""
        return [m for m in self.marks if isinstance(m, Line | Span | Area) and m.label]


@dataclass(frozen=True)
class Chart:
    """Panels row by row.

    Attributes
    ----------
    width : float
        Points, of all.
    panels : sequence of Panel
    columns : int
    legend : bool
        Whether the labels of the first panel stand above all.
    upright : str
        Label of all vertical axes.
    """

    width: float
    panels: Sequence[Panel]
    columns: int = 1
    legend: bool = False
    upright: str = ""
