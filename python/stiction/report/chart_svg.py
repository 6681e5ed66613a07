"""A chart as SVG text: a page needs no library for drawing, whose import alone takes half a second.

Lengths are points. Text stays text, in the fonts of whoever reads it, so that widths are estimates:
margins take those of a wide font.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from html import escape
from typing import Final

import numpy as np
import numpy.typing as npt

from .._support.arrays import FloatArray
from ..plot import FAINT, INK, MEASURED, SMALL, TEXT
from .chart import Area, Bars, Chart, Line, Mark, Panel, Span, Words

__all__ = ["text_width", "write_svg"]

FONTS: Final = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif"
RULE: Final = "#e6e8ea"
"""Colour of the lines at ticks."""
EDGE: Final = 5.0
"""Free on every side of a figure."""
ACROSS: Final = 14.0
"""From panel to panel in a row."""
BETWEEN: Final = 9.0
"""From the text of a panel to that of the one below it."""
TICK: Final = 3.0
PAD: Final = 3.5
LINE: Final = 1.3
"""Height of a line of text, of its size."""
RISE: Final = 0.36
"""From the middle of a figure or letter to its foot, of its size."""
ASIDE: Final = 6.0
"""From a point to the words beside it."""
SWATCH: Final = 15.0
_WIDTHS: Final = (
    (0.32, " \u00a0',.:;ijlI|·"),
    (0.4, '!"()[]/\\-frt²³'),
    (0.53, "*_`szcL?⁻°"),
    (0.86, "#+<=>M^~OQw×−→&"),
    (1.0, "@W%m…"),
)
_WIDTH: Final = {character: width for width, all_ in _WIDTHS for character in all_}
_USUAL: Final = 0.65
_WIDE_FROM: Final = 0x1100
"""Scripts whose characters are as wide as high begin here."""


def text_width(text: str, size: float) -> float:
    """Width of a text in a wide font, in the unit of ``size``."""
    return size * sum(_WIDTH.get(c, _USUAL if ord(c) < _WIDE_FROM else 1.0) for c in text)


def write_svg(chart: Chart) -> str:
    """A chart as the text of an SVG file."""
    places, height = _arranged(chart)
    parts = [_legend(chart.panels[0], EDGE, EDGE, chart.width - EDGE)[0]] if chart.legend else []
    for panel, place in zip(chart.panels, places, strict=True):
        parts += _panel(panel, place)
    if chart.upright:
        parts.append(_upright(chart.upright, EDGE + TEXT, 0.5 * height))
    wide, high = f"{chart.width:.1f}", f"{height:.1f}"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide}pt" height="{high}pt" '
        f'viewBox="0 0 {wide} {high}">\n<rect width="{wide}" height="{high}" fill="#fff"/>\n'
        f'<g font-family="{escape(FONTS)}" fill="{INK}">\n' + "\n".join(parts) + "\n</g>\n</svg>\n"
    )


# --- where everything is


@dataclass(frozen=True)
class _Place:
    """The space between the axes of a panel, and where its title and legend stand."""

    left: float
    top: float
    width: float
    height: float
    above: float
    room: float

    def x(self, shares: FloatArray) -> FloatArray:
        return self.left + self.width * shares

    def y(self, shares: FloatArray) -> FloatArray:
        return self.top + self.height * (1.0 - shares)


def _arranged(chart: Chart) -> tuple[list[_Place], float]:
    """Place of every panel, and the height of all."""
    rows = [chart.panels[k : k + chart.columns] for k in range(0, len(chart.panels), chart.columns)]
    firsts = [row[0] for row in rows]
    left = EDGE + max(_beside(panel) for panel in firsts)
    if chart.upright:
        left += LINE * TEXT
    gap = ACROSS if chart.columns > 1 else 0.0
    right = EDGE + TICK
    for _ in range(2):
        width = (chart.width - left - right - gap * (chart.columns - 1)) / chart.columns
        right = EDGE + max(_over(panel, width) for row in rows for panel in row)
    top = EDGE
    if chart.legend:
        top += _legend(chart.panels[0], EDGE, EDGE, chart.width - EDGE)[1] + BETWEEN
    places = []
    for row in rows:
        above = max(_above(panel, width) for panel in row)
        height = max(panel.height for panel in row)
        places += [
            _Place(left + k * (width + gap), top + above, width, panel.height, top, width + gap)
            for k, panel in enumerate(row)
        ]
        top += above + height + max(_below(panel) for panel in row) + BETWEEN
    return places, top - BETWEEN + EDGE


def _beside(panel: Panel) -> float:
    """What the numbers and the label of a vertical axis take on its left."""
    texts = [text for _, text in panel.y.ticks()] if panel.y.numbered else []
    numbers = max((text_width(text, SMALL) for text in texts), default=0.0)
    return numbers + TICK + PAD + (LINE * TEXT if panel.y.label else 0.0)


def _over(panel: Panel, width: float) -> float:
    """What goes beyond the right end of a panel."""
    beyond = [TICK]
    ticks = panel.x.ticks() if panel.x.numbered else []
    beyond += [0.5 * text_width(text, SMALL) - (1.0 - at) * width for at, text in ticks]
    for mark in panel.marks:
        if isinstance(mark, Words):
            ends = zip(panel.x.place(mark.x), mark.texts, strict=True)
            beyond += [ASIDE + text_width(text, SMALL) - (1.0 - at) * width for at, text in ends]
    return max(beyond)


def _above(panel: Panel, width: float) -> float:
    high = PAD if panel.title or panel.remark or panel.legend else 0.0
    if panel.title or panel.remark:
        high += LINE * panel.size * (1 + panel.title.count("\n"))
    if panel.legend:
        high += _legend(panel, 0.0, 0.0, width)[1]
    return high


def _below(panel: Panel) -> float:
    numbers = TICK + PAD + SMALL if panel.x.numbered else TICK
    return numbers + (LINE * TEXT if panel.x.label else 0.0)


# --- parts


def _panel(panel: Panel, place: _Place) -> Iterator[str]:
    right, bottom = place.left + place.width, place.top + place.height
    xs, ys = panel.x.ticks(), panel.y.ticks()
    across = [place.left + place.width * at for at, _ in xs]
    up = [bottom - place.height * at for at, _ in ys]
    rules = [f"M{x:.2f},{place.top:.2f}V{bottom:.2f}" for x in across if panel.x.grid]
    rules += [f"M{place.left:.2f},{y:.2f}H{right:.2f}" for y in up if panel.y.grid]
    if rules:
        yield f'<path d="{"".join(rules)}" fill="none" stroke="{RULE}" stroke-width=".6"/>'
    for mark in panel.marks:
        yield from _mark(mark, panel, place)
    ticks = [f"M{x:.2f},{bottom:.2f}v{TICK}" for x in across]
    ticks += [f"M{place.left:.2f},{y:.2f}h-{TICK}" for y in up]
    frame = f"M{place.left:.2f},{place.top:.2f}V{bottom:.2f}H{right:.2f}"
    yield f'<path d="{frame}{"".join(ticks)}" fill="none" stroke="{FAINT}" stroke-width=".8"/>'
    under = bottom + TICK + PAD + 0.75 * SMALL
    if panel.x.numbered:
        for x, (_, text) in zip(across, xs, strict=True):
            yield _text(text, x, under, SMALL, "middle")
        under += LINE * TEXT
    if panel.x.label:
        size = _fitting(panel.x.label, TEXT, place.room)
        yield _text(panel.x.label, place.left + 0.5 * place.width, under, size, "middle")
    if panel.y.numbered:
        for y, (_, text) in zip(up, ys, strict=True):
            yield _text(text, place.left - TICK - 2.0, y + RISE * SMALL, SMALL, "end")
    if panel.y.label:
        at = place.left - _beside(panel) + 0.85 * TEXT
        yield _upright(panel.y.label, at, place.top + 0.5 * place.height)
    yield from _heading(panel, place)


def _heading(panel: Panel, place: _Place) -> Iterator[str]:
    foot = place.top - PAD
    lines = panel.title.split("\n") if panel.title else []
    for k, line in enumerate(reversed(lines)):
        size = _fitting(line, panel.size, place.room)
        yield _text(line, place.left, foot - k * LINE * panel.size, size)
    if panel.remark:
        right = place.left + place.width
        yield _text(panel.remark, right, foot, SMALL - 1.0, "end", MEASURED)
    if panel.legend:
        yield _legend(panel, place.left, place.above, place.left + place.width)[0]


def _legend(panel: Panel, left: float, top: float, right: float) -> tuple[str, float]:
    """Swatches and labels in rows, and how high they are."""
    parts, x, y = [], left, top + 0.5 * LINE * SMALL
    for mark in panel.legend_marks:
        wide = SWATCH + 5.0 + text_width(mark.label, SMALL)
        if x > left and x + wide > right:
            x, y = left, y + LINE * SMALL
        parts.append(_swatch(mark, x, y))
        parts.append(_text(mark.label, x + SWATCH + 5.0, y + RISE * SMALL, SMALL))
        x += wide + 10.0
    return "\n".join(parts), y + 0.5 * LINE * SMALL - top


def _swatch(mark: Line | Span | Area, x: float, y: float) -> str:
    if not isinstance(mark, Line):
        return (
            f'<rect x="{x:.2f}" y="{y - 3:.2f}" width="{SWATCH}" height="6" fill="{mark.colour}"/>'
        )
    return "\n".join(_line(mark, [f"M{x:.2f},{y:.2f}h{SWATCH}"], [(x + 0.5 * SWATCH, y)]))


def _mark(mark: Mark, panel: Panel, place: _Place) -> Iterator[str]:
    if isinstance(mark, Line):
        x, y = place.x(panel.x.place(mark.x)), place.y(panel.y.place(mark.y))
        seen = np.isfinite(x) & np.isfinite(y)
        yield from _line(mark, _strokes(x, y, seen), zip(x[seen], y[seen], strict=True))
    elif isinstance(mark, Span):
        ends = np.array([mark.low, mark.high])
        if mark.axis == "x":
            low, high = place.x(panel.x.place(ends))
            yield _box(low, place.top, high - low, place.height, mark.colour)
        else:
            low, high = place.y(panel.y.place(ends))
            yield _box(place.left, high, place.width, low - high, mark.colour)
    elif isinstance(mark, Area):
        x = np.concatenate([mark.x, mark.x[::-1]])
        y = np.concatenate([mark.high, mark.low[::-1]])
        x, y = place.x(panel.x.place(x)), place.y(panel.y.place(y))
        seen = np.isfinite(x) & np.isfinite(y)
        points = " ".join(f"{a:.2f},{b:.2f}" for a, b in zip(x[seen], y[seen], strict=True))
        if points:
            yield f'<path d="M{points}Z" fill="{mark.colour}"/>'
    elif isinstance(mark, Bars):
        one, two = place.x(panel.x.place(mark.start)), place.x(panel.x.place(mark.end))
        half = 0.5 * mark.thickness
        top, foot = (place.y(panel.y.place(mark.at + each)) for each in (-half, half))
        for a, b, c, d, colour in zip(one, two, top, foot, mark.colours, strict=True):
            yield _box(min(a, b), min(c, d), abs(b - a), abs(d - c), colour)
    else:
        x, y = place.x(panel.x.place(mark.x)), place.y(panel.y.place(mark.y))
        for a, b, text in zip(x, y, mark.texts, strict=True):
            yield _text(text, a + ASIDE, b + RISE * SMALL, SMALL)


def _strokes(x: FloatArray, y: FloatArray, seen: npt.NDArray[np.bool_]) -> list[str]:
    begins = seen & ~np.concatenate([[False], seen[:-1]])
    return [
        f"{'M' if first else ' '}{a:.2f},{b:.2f}"
        for a, b, first in zip(x[seen], y[seen], begins[seen], strict=True)
    ]


def _line(
    mark: Line, strokes: Sequence[str], points: Iterable[tuple[float, float]]
) -> Iterator[str]:
    """A line, and a marker at each of its points."""
    if mark.width and strokes:
        yield (
            f'<path d="{"".join(strokes)}" fill="none" stroke="{mark.colour}" '
            f'stroke-width="{mark.width:g}" stroke-linejoin="round"/>'
        )
    if not mark.marker:
        return
    if mark.marker == "|":
        d = "".join(f"M{x:.2f},{y - 0.5 * mark.size:.2f}v{mark.size:g}" for x, y in points)
        yield f'<path d="{d}" fill="none" stroke="{mark.colour}" stroke-width="1.6"/>'
        return
    size = mark.size
    if mark.marker == "o":
        # A stroke without length is its cap: a disc.
        d = "".join(f"M{x:.2f},{y:.2f}h0" for x, y in points)
        style = f'fill="none" stroke="{mark.colour}" stroke-width="{size:g}" stroke-linecap="round"'
    else:
        side = f"h{size:g}v{size:g}h-{size:g}z"
        d = "".join(f"M{x - 0.5 * size:.2f},{y - 0.5 * size:.2f}{side}" for x, y in points)
        style = f'fill="{mark.colour}"'
    yield f'<path d="{d}" {style}/>'


def _fitting(text: str, size: float, room: float) -> float:
    """The size in which a text does not reach into its neighbour."""
    wide = text_width(text, size)
    return size if wide <= room else size * room / wide


def _box(x: float, y: float, width: float, height: float, colour: str) -> str:
    return (
        f'<rect x="{x:.2f}" y="{y:.2f}" width="{width:.2f}" height="{height:.2f}" fill="{colour}"/>'
    )


def _text(text: str, x: float, y: float, size: float, anchor: str = "", colour: str = "") -> str:
    more = f' text-anchor="{anchor}"' if anchor else ""
    more += f' fill="{colour}"' if colour else ""
    return f'<text x="{x:.2f}" y="{y:.2f}" font-size="{size:.3g}"{more}>{escape(text)}</text>'


def _upright(text: str, x: float, y: float) -> str:
    """A text that is read from below, its middle at a point."""
    return (
        f'<text transform="translate({x:.2f},{y:.2f}) rotate(-90)" font-size="{TEXT:g}" '
        f'text-anchor="middle">{escape(text)}</text>'
    )
