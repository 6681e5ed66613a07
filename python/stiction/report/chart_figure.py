"""A chart as a figure of matplotlib, for those who go on with it in a notebook or a paper."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final, Literal

from ..plot import INK, MEASURED, SMALL, figure, legend
from .chart import Area, Bars, Chart, Line, Mark, Span, Words

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .axis import Axis
    from .chart import Panel

__all__ = ["draw_panels", "make_figure"]

INCH: Final = 72.0
AROUND: Final = 0.45
"""Inches that the text about a panel takes."""


def make_figure(chart: Chart) -> Figure:
    """Draw a chart with matplotlib; the figure belongs to the caller."""
    rows = -(-len(chart.panels) // chart.columns)
    heights = [panel.height / INCH for panel in chart.panels[:: chart.columns]]
    drawn, places = figure(
        rows,
        chart.columns,
        height=sum(heights) + AROUND * (rows + 1),
        width=chart.width / INCH,
        height_ratios=heights,
    )
    for panel, place in zip(chart.panels, places, strict=False):
        _draw(panel, place)
    for place in places[len(chart.panels) :]:
        place.set_axis_off()
    if chart.upright:
        drawn.supylabel(chart.upright)
    if chart.legend:
        legend(places[0], loc="lower left", bbox_to_anchor=(0.0, 1.2), ncols=3)
    drawn.align_ylabels()
    return drawn


def draw_panels(chart: Chart, places: Sequence[Axes]) -> Sequence[Axes]:
    """Draw the panels of a chart into axes that are there, as many as there are."""
    for panel, place in zip(chart.panels, places, strict=False):
        _draw(panel, place)
    return places


def _draw(panel: Panel, place: Axes) -> None:
    for mark in panel.marks:
        _mark(mark, place)
    for axis, name in _axes(panel):
        _set(axis, name, place)
    place.set_title(panel.title, loc="left", fontsize=panel.size, color=INK, pad=3.0)
    place.set_title(panel.remark, loc="right", fontsize=SMALL - 1.0, color=MEASURED, pad=3.0)
    if panel.legend:
        legend(place, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, borderaxespad=0.1)


def _axes(panel: Panel) -> tuple[tuple[Axis, Literal["x", "y"]], ...]:
    return ((panel.x, "x"), (panel.y, "y"))


def _set(axis: Axis, name: Literal["x", "y"], place: Axes) -> None:
    """Range, scale, ticks and label of one of the two axes."""
    linear_to = {"linthresh": axis.linear_to} if axis.scaling == "symlog" else {}
    texts = [text for _, text in axis.ticks()]
    if name == "x":
        place.set_xscale(axis.scaling, **linear_to)
        place.set_xticks(axis.values(), texts)
        place.set_xticks([], minor=True)
        place.set_xlim(axis.low, axis.high)
        place.set_xlabel(axis.label)
    else:
        place.set_yscale(axis.scaling, **linear_to)
        place.set_yticks(axis.values(), texts)
        place.set_yticks([], minor=True)
        place.set_ylim(axis.low, axis.high)
        place.set_ylabel(axis.label)
    place.tick_params(axis=name, **{f"label{'bottom' if name == 'x' else 'left'}": axis.numbered})
    place.grid(axis.grid, axis=name)


def _mark(mark: Mark, place: Axes) -> None:
    if isinstance(mark, Line):
        style: dict[str, Any] = {"linewidth": mark.width, "color": mark.colour}
        if not mark.width:
            style["linestyle"] = ""
        if mark.marker:
            style |= {"marker": mark.marker, "markersize": mark.size}
        place.plot(mark.x, mark.y, label=mark.label or None, **style)
    elif isinstance(mark, Span):
        span = place.axvspan if mark.axis == "x" else place.axhspan
        span(mark.low, mark.high, color=mark.colour, linewidth=0.0, label=mark.label, zorder=0.5)
    elif isinstance(mark, Area):
        place.fill_between(
            mark.x, mark.low, mark.high, color=mark.colour, linewidth=0.0, label=mark.label
        )
    elif isinstance(mark, Bars):
        length = mark.end - mark.start
        place.barh(mark.at, length, mark.thickness, mark.start, color=list(mark.colours))
    else:
        _words(mark, place)


def _words(mark: Words, place: Axes) -> None:
    for x, y, text in zip(mark.x, mark.y, mark.texts, strict=True):
        place.annotate(
            text, (x, y), (6, 0), textcoords="offset points", va="center", fontsize=SMALL
        )
