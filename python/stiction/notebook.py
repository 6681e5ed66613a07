"""Tables and small figures for notebooks: HTML and inline SVG, escaped, that ask for nothing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING, Final

import numpy as np
import numpy.typing as npt

from ._native import FrictionModel
from .catalogue import LawRecord, laws
from .errors import InputError
from .plant import Plant
from .plot import ACCENT, CYCLE, FAINT, thinned

if TYPE_CHECKING:
    from .catalogue import EffectRecord
    from .motor import Motor

__all__ = ["Line", "drawing", "friction_drawing", "friction_model", "motor", "record", "table"]

WIDTH: Final = 560
"""Pixels, which are units of the drawing."""
HEIGHT: Final = 170
LEFT: Final = 70
BOTTOM: Final = 34
TOP: Final = 22
BUCKETS: Final = 200
"""Stretches of a line: two points of each are drawn."""

Line = tuple[str, npt.ArrayLike, npt.ArrayLike]
"""Name, and two arrays of shape (n,), the first rising."""


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table; cells are escaped."""
    top = "".join(f"<th>{escape(word)}</th>" for word in head)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f"<table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>"


def record(entry: LawRecord | EffectRecord) -> str:
    """A law or effect of the catalogue: what it is, where it is from, and its parameters."""
    about = entry.source if isinstance(entry, LawRecord) else f"{entry.means}; {entry.remedy}"
    head = ("parameter", "symbol", "meaning", "unit", "default", "bounds")
    rows = [
        (
            each.name,
            each.symbol or "",
            each.meaning,
            each.unit,
            "" if each.default is None else f"{each.default:g}",
            "{:g} to {:g}".format(*each.bounds),
        )
        for each in entry.parameters
    ]
    told = f"<p><b>{escape(entry.name)}</b>: {escape(entry.summary)}</p><p>{escape(about)}</p>"
    return f"{told}{table(head, rows)}"


def drawing(lines: Sequence[Line], x: str, y: str) -> str:
    """Lines over one axis as inline SVG, "" where there is nothing finite to draw.

    Parameters
    ----------
    lines : sequence of Line
    x, y : str
        What the axes show, with units.
    """
    thin = [(name, *_finite(*thinned(across, up, BUCKETS))) for name, across, up in lines]
    thin = [line for line in thin if line[1].size > 1]
    if not thin:
        return ""
    x0, x1 = _ends([line[1] for line in thin])
    y0, y1 = _ends([line[2] for line in thin])
    wide, high = WIDTH - LEFT - 10, HEIGHT - BOTTOM - TOP
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" '
        f'role="img" aria-label="{escape(y, quote=True)} over {escape(x, quote=True)}" '
        'font-family="sans-serif" font-size="11" fill="currentColor">',
        f'<path d="M{LEFT} {TOP}V{HEIGHT - BOTTOM}H{WIDTH - 10}" fill="none" stroke="{FAINT}"/>',
    ]
    for k, (name, across, up) in enumerate(thin):
        colour = (*CYCLE, ACCENT)[k % len(CYCLE)]
        places = zip(
            LEFT + wide * (across - x0) / (x1 - x0),
            HEIGHT - BOTTOM - high * (up - y0) / (y1 - y0),
            strict=True,
        )
        points = " ".join(f"{a:.1f},{b:.1f}" for a, b in places)
        parts.append(f'<polyline points="{points}" fill="none" stroke="{colour}"/>')
        parts.append(f'<text x="{LEFT + 140 * k}" y="13" fill="{colour}">{escape(name)}</text>')
    low, up_end = HEIGHT - BOTTOM, HEIGHT - 6
    parts += [
        f'<text x="{LEFT}" y="{low + 14}">{x0:.4g}</text>',
        f'<text x="{WIDTH - 10}" y="{low + 14}" text-anchor="end">{x1:.4g}</text>',
        f'<text x="{(WIDTH + LEFT) // 2}" y="{up_end}" text-anchor="middle">{escape(x)}</text>',
        f'<text x="{LEFT - 4}" y="{low}" text-anchor="end">{y0:.3g}</text>',
        f'<text x="{LEFT - 4}" y="{TOP + 9}" text-anchor="end">{y1:.3g}</text>',
        f'<text transform="translate(12 {HEIGHT // 2}) rotate(-90)" text-anchor="middle">'
        f"{escape(y)}</text></svg>",
    ]
    return "".join(parts)


def friction_model(model: FrictionModel) -> str:
    """Law and effects, parameters with their units and meaning, options."""
    record = laws()[model.law]
    rows = [
        (
            each.name,
            f"{model.parameters[each.name]:.6g}",
            each.unit if each.unit == each.linear_unit else f"{each.unit} or {each.linear_unit}",
            each.meaning,
        )
        for each in record.parameters
    ]
    rows += [
        (path, f"{value:.6g}", "", "") for path, value in model.parameters.items() if "." in path
    ]
    rows += [(name, word, "", "option") for name, word in model.options.items()]
    title = f"<p><b>{escape(model.law)}</b>: {escape(record.summary)}</p>"
    return title + table(("parameter", "value", "unit", "meaning"), rows)


def motor(motor: Motor) -> str:
    """Body, drive and effects of a motor, its friction, and where it is."""
    given = ((name, value) for name, value in motor.settings().items() if value not in ({}, None))
    rows = [
        (name, f"{value:.6g}" if isinstance(value, float) else str(value)) for name, value in given
    ]
    state = motor.state
    rows += [
        (f"{name} now", f"{state[name]:.6g} {unit}")
        for name, unit in (("position", "rad or m"), ("velocity", "rad/s or m/s"), ("time", "s"))
    ]
    return table(("motor", ""), rows) + friction_model(motor.friction)


def friction_drawing(models: Sequence[tuple[str, Plant, str]]) -> str:
    """Friction in steady motion of some plants, "" where there is none that can be computed.

    Parameters
    ----------
    models : sequence of (str, Plant, str)
        Name, plant, and unit of its effort.
    """
    if not models:
        return ""
    plant, unit = models[0][1], models[0][2]
    speeds = plant.curve_speeds()
    try:
        lines: list[Line] = [(name, speeds, own.friction_curve(speeds)) for name, own, _ in models]
    except InputError:
        return ""
    per = "" if unit == "1" else f" ({unit})"
    return drawing(lines, f"speed ({plant.position_unit}/s)", f"friction{per}")


def _finite(
    across: npt.NDArray[np.float64], up: npt.NDArray[np.float64]
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    good = np.isfinite(across) & np.isfinite(up)
    return across[good], up[good]


def _ends(arrays: Sequence[npt.NDArray[np.float64]]) -> tuple[float, float]:
    """The least and the greatest of all, apart."""
    low, high = min(float(a.min()) for a in arrays), max(float(a.max()) for a in arrays)
    return (low, high) if high > low else (low - 0.5, high + 0.5)
