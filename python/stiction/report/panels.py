"""What the panels of all figures have in common: ticks, titles, remarks, names."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import takewhile
from typing import TYPE_CHECKING, Final

from matplotlib.ticker import (
    FuncFormatter,
    LogLocator,
    MaxNLocator,
    NullLocator,
    SymmetricalLogLocator,
)

from ..plot import INK, MEASURED, SMALL, TEXT, legend
from .numbers import tick, tick_of_ten

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = [
    "STEPS",
    "beside",
    "grid",
    "grid_height",
    "legend_above",
    "named",
    "note",
    "shortened",
    "ticks",
    "told_apart",
]

STEPS: Final = (1, 2, 5, 10)
_GRID_LEFT, _GRID_RIGHT, _GRID_TOP = 0.6, 0.1, 0.3
_GRID_PANEL, _GRID_GAP, _GRID_TITLE = 0.92, 0.88, 0.42
"""Inches: margins, height of a panel, from panel to panel, and of that what its title takes."""


def shortened(name: str, longest: int) -> str:
    """A name as it can be drawn: not too long, and only characters that the font has.

    A dollar sign would begin a formula; a character without a glyph would draw a box and warn.
    """
    shown = "".join(c if _has_glyph(c) else "?" for c in name)
    if len(shown) > longest:
        half = (longest - 1) // 2
        shown = f"{shown[: longest - 1 - half]}…{shown[-half:]}"
    return shown.replace("$", r"\$")


def told_apart(names: Sequence[str], longest: int) -> list[str]:
    """Names as they can be drawn, each still another one.

    Where one is too long, what all begin or end with is left out of all; whatever still looks alike
    is counted.
    """
    if len(names) < 2 or all(len(name) <= longest for name in names):
        return [shortened(name, longest) for name in names]
    start = _shared(names)
    end = _shared([name[start:][::-1] for name in names])
    shown = []
    for name in names:
        own = name[start : len(name) - end]
        shown.append(shortened(f"{'…' if start else ''}{own}{'…' if end else ''}", longest))
    alike = Counter(shown)
    return [
        name if alike[name] < 2 else f"{k + 1}: {shortened(full, longest - 4)}"
        for k, (name, full) in enumerate(zip(shown, names, strict=True))
    ]


def _shared(names: Sequence[str]) -> int:
    """With how many characters all begin, whole words alone."""
    same = takewhile(lambda each: len(set(each)) == 1, zip(*names, strict=False))
    start = sum(1 for _ in same)
    while start and names[0][start - 1].isalnum():
        start -= 1
    return start


def _has_glyph(character: str) -> bool:
    # Latin, Greek and Cyrillic: what the font of the figures covers without gaps.
    code = ord(character)
    return character.isprintable() and (code < 0x250 or 0x386 <= code < 0x460 or code == 0x2026)


def ticks(panel: Axes, across: int, up: int) -> None:
    """So many ticks at most, written without powers at the end of an axis."""
    kind = panel.get_xscale()
    if kind == "linear":
        panel.xaxis.set_major_locator(MaxNLocator(across, steps=STEPS))
        panel.xaxis.set_major_formatter(FuncFormatter(lambda value, _: tick(value)))
    else:
        if kind == "log":
            panel.xaxis.set_major_locator(LogLocator(numticks=across))
        else:
            locator = SymmetricalLogLocator(panel.xaxis.get_transform())
            locator.set_params(numticks=across)
            panel.xaxis.set_major_locator(locator)
        panel.xaxis.set_minor_locator(NullLocator())
        panel.xaxis.set_major_formatter(FuncFormatter(lambda value, _: tick_of_ten(value)))
    panel.yaxis.set_major_locator(MaxNLocator(up, steps=STEPS))
    panel.yaxis.set_major_formatter(FuncFormatter(lambda value, _: tick(value)))


def grid_height(rows: int) -> float:
    """Height of a figure with so many panels one above the other, inches."""
    return _GRID_TOP + rows * (_GRID_PANEL + _GRID_GAP)


def grid(drawn: Figure, rows: int) -> None:
    """Places the panels of a grid by hand: arranging that many takes longer than drawing them."""
    width, height = drawn.get_size_inches()
    drawn.set_layout_engine(None)
    drawn.subplots_adjust(
        left=_GRID_LEFT / width,
        right=1.0 - _GRID_RIGHT / width,
        top=1.0 - (_GRID_TOP + _GRID_TITLE) / height,
        bottom=(_GRID_GAP - _GRID_TITLE) / height,
        hspace=_GRID_GAP / _GRID_PANEL if rows > 1 else 0.0,
        wspace=0.14,
    )


def named(panel: Axes, text: str, narrow: bool) -> None:
    panel.set_title(text, loc="left", fontsize=SMALL if narrow else TEXT, color=INK, pad=3.0)


def note(panel: Axes, text: str) -> None:
    """A remark above the right end of a panel."""
    panel.set_title(text, loc="right", fontsize=SMALL - 1.0, color=MEASURED, pad=3.0)


def beside(panel: Axes, text: str, x: float, y: float) -> None:
    panel.annotate(
        text,
        (x, y),
        xytext=(6, 0),
        textcoords="offset points",
        va="center",
        fontsize=SMALL,
        color=INK,
    )


def legend_above(panel: Axes, columns: int) -> None:
    legend(
        panel,
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=columns,
        borderaxespad=0.1,
        columnspacing=1.2,
    )
