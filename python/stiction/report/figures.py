"""The figures of a report.

Each is drawn wide for a screen or paper, and again ``narrow`` for a phone, where the wide one would
be too small to read.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import (
    FuncFormatter,
    MaxNLocator,
)

from ..compared import compared_by
from ..errors import InputError
from ..plot import (
    ACCENT,
    FAINT,
    INK,
    MEASURED,
    SIMULATED,
    SMALL,
    TEXT,
    WIDTH,
    figure,
    thinned,
)
from .numbers import NO_BREAK, digits, percent, tick
from .panels import (
    STEPS,
    beside,
    grid,
    grid_height,
    legend_above,
    named,
    note,
    shortened,
    ticks,
    told_apart,
)
from .scale import Scale, loop_scale_of, prefixed, scale_of, suited

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..diagnosis.omnibus import View
    from ..diagnosis.pictures import Pictures
    from ..diagnosis.result import Diagnosis, ModelSummary

__all__ = [
    "candidates",
    "cause",
    "closed_loop",
    "coordinates",
    "errors",
    "headline",
    "most_shown",
    "quantity_of",
]

NARROW: Final = 3.9
"""Width of a figure for a phone, inches: text keeps its size on 360 pixels."""
BEFORE, AFTER, BAND, REFUSED = ACCENT, SIMULATED, "#dde1e5", "#b9c0c7"
"""Orange and blue are told apart by people who do not see red and green alike."""
FLOOR_TIMES: Final = 2.0
"""The band of noise over time is this many times its rms: 95 % of it."""
LEAST_TOLD: Final = 1e-3
"""Where no share is larger nothing shows: 0 % → 0 % reads as if nothing had been looked at."""
MOST_RECORDINGS: Final = 24
"""Recordings that a figure shows one by one."""
LONGEST_NAME, LONGEST_NARROW_NAME = 30, 16
WIDE_RANGE: Final = 50.0
"""Coordinates that may be are drawn over their logarithm where they span more than this."""
MOST_PANELS: Final = 12
"""Coordinates that are drawn; the others are flat, and stand in the table."""
TOGETHER: Final = 0.012
"""Stretches nearer than this share of the axis are drawn as one."""


def headline(diagnosis: Diagnosis, *, narrow: bool = False) -> Figure:
    """Measured effort (of a servo its position), and what both models leave of it, over time.

    The held-out recording with the largest improvement; the band is what noise alone leaves.

    Parameters
    ----------
    diagnosis : Diagnosis
    narrow : bool
        For a phone.

    Raises
    ------
    InputError
        Nothing could be fitted, so there is nothing to draw.
    """
    pictures = _pictures(diagnosis)
    if not pictures.stretches:
        raise InputError(f"there is nothing to draw: {diagnosis.sentence}")
    stretch, scale = pictures.stretches[0], scale_of(diagnosis)
    left = [("before", stretch.before, BEFORE), ("after", stretch.after, AFTER)]
    if not diagnosis.effects:
        left = [("left", stretch.after, AFTER)]
    drawn, (upper, *lower) = figure(
        1 + len(left),
        height=1.25 + (1.2 if narrow else 1.1) * (1 + len(left)),
        width=NARROW if narrow else WIDTH,
        sharex=True,
        height_ratios=(0.8, *(1.0 for _ in left)),
    )
    buckets = 350 if narrow else 700
    by = compared_by(diagnosis.plant)
    unit = pictures.position_unit if by.loop else pictures.effort_unit
    given = suited([_extent([stretch.measured])], unit)
    shown = thinned(stretch.time, given.factor * stretch.measured, buckets)
    upper.plot(*shown, color=MEASURED, linewidth=0.9)
    named(upper, f"measured {by.quantity}", narrow)
    upper.set_ylabel(given.on_axis(by.quantity))
    band = FLOOR_TIMES * scale.factor * pictures.floor
    span = max(scale.factor * _extent([values for _, values, _ in left]), 1.3 * band)
    for panel, (name, values, colour) in zip(lower, left, strict=True):
        panel.axhspan(-band, band, color=BAND, linewidth=0.0, zorder=0.5)
        shown = thinned(stretch.time, scale.factor * values, buckets)
        panel.plot(*shown, color=colour, linewidth=0.8)
        panel.set_ylim(-1.08 * span, 1.08 * span)
        panel.set_ylabel(scale.on_axis("residual"))
        named(panel, f"{name}: {scale.text(_rms(values))} rms not explained", narrow)
    lower[-1].set_xlabel("time in the recording (s)")
    upper.set_xlim(min(0.0, float(stretch.time[0])), float(stretch.time[-1]))
    for panel in (upper, *lower):
        ticks(panel, 5 if narrow else 9, 4 if narrow else 5)
    if not narrow:
        note(lower[0], "band: noise alone")
    drawn.align_ylabels()
    return drawn


def cause(diagnosis: Diagnosis, index: int, *, narrow: bool = False) -> Figure:
    """The residual over the coordinate in which a cause shows, before and after.

    Parameters
    ----------
    diagnosis : Diagnosis
    index : int
        Which of ``diagnosis.effects``.
    narrow : bool
        For a phone.
    """
    pictures = _pictures(diagnosis)
    before, after = pictures.causes[index]
    drawn, (panel,) = figure(height=3.3 if narrow else 3.1, width=NARROW if narrow else WIDTH)
    upright, scale = _upright(before, pictures, scale_of(diagnosis))
    _curves(panel, before, after, scale, size=3.5)
    panel.set_xlabel(_axis(before, pictures))
    panel.set_ylabel(scale.on_axis(upright))
    ticks(panel, 4 if narrow else 8, 6)
    legend_above(panel, 3)
    return drawn


def coordinates(diagnosis: Diagnosis, *, narrow: bool = False) -> Figure:
    """The residual over the coordinates in which most shows, with what noise alone reaches.

    Parameters
    ----------
    diagnosis : Diagnosis
    narrow : bool
        For a phone.
    """
    pictures = _pictures(diagnosis)
    # Sorted by what is left: what still needs a name stands first.
    before = {view.coordinate.name: view for view in pictures.before.views}
    views = most_shown(pictures)
    columns = 2 if narrow else 3
    rows = -(-len(views) // columns)
    drawn, panels = figure(
        rows,
        columns,
        height=grid_height(rows),
        width=NARROW if narrow else WIDTH,
    )
    grid(drawn, rows)
    both, scale = bool(diagnosis.effects), scale_of(diagnosis)
    shown = (*views, *(before.values() if both else ()))
    parts = [part for view in shown for part in (view.mean, view.low, view.high)]
    span = scale.factor * _extent(parts)
    for position, (panel, view) in enumerate(zip(panels, views, strict=False)):
        first = before.get(view.coordinate.name, view)
        _curves(panel, first if both else view, view if both else None, scale, size=2.0)
        panel.set_ylim(-1.1 * span, 1.1 * span)
        ticks(panel, 2 if narrow else 4, 4)
        panel.tick_params(labelsize=SMALL - 1.0)
        if position % columns:
            panel.tick_params(labelleft=False)
        axis = _axis(view, pictures)
        # On a phone the title above has to do for the name.
        panel.set_xlabel(axis[max(axis.rfind("("), 0) :] if narrow else axis, fontsize=SMALL)
        title = _panel_title(first, view, both=both, narrow=narrow)
        size = SMALL - 1.0 if narrow else SMALL
        panel.set_title(title, fontsize=size, loc="left", color=INK, pad=4.0)
    for panel in panels[len(views) :]:
        panel.set_axis_off()
    drawn.supylabel(scale.on_axis("mean residual"), x=0.0, fontsize=TEXT)
    handles, labels = panels[0].get_legend_handles_labels()
    keywords = {"frameon": False, "fontsize": SMALL, "handlelength": 1.6, "columnspacing": 1.2}
    drawn.legend(handles, labels, loc="upper left", ncols=3, borderaxespad=0.1, **keywords)
    return drawn


def most_shown(pictures: Pictures) -> list[View]:
    """What is left over the coordinates in which most shows or showed, most left first."""
    before = {view.coordinate.name: view.share for view in pictures.before.views}

    def shows(view: View) -> tuple[bool, float]:
        return view.flagged(), max(view.share, before.get(view.coordinate.name, view.share))

    chosen = sorted(pictures.after.views, key=shows, reverse=True)[:MOST_PANELS]
    names = {view.coordinate.name for view in chosen}
    return [view for view in pictures.after.views if view.coordinate.name in names]


def candidates(diagnosis: Diagnosis, *, narrow: bool = False) -> Figure:
    """What every effect would explain, beside what noise alone reaches.

    Parameters
    ----------
    diagnosis : Diagnosis
    narrow : bool
        For a phone.
    """
    rows = [row for row in diagnosis.candidates if row.score is not None]
    if not rows:
        raise InputError("no candidate has a score, so there is nothing to draw")
    rows.sort(key=lambda row: -(row.score or 0.0))
    drawn, (panel,) = figure(height=0.95 + 0.27 * len(rows), width=NARROW if narrow else WIDTH)
    at = np.arange(len(rows))
    scores = np.array([100.0 * max(row.score or 0.0, 0.0) for row in rows])
    accepted = {effect.name for effect in diagnosis.effects}
    colours = [SIMULATED if row.name in accepted else REFUSED for row in rows]
    panel.barh(at, scores, color=colours, height=0.62)
    marks = np.array([100.0 * (row.threshold or 0.0) for row in rows])
    panel.plot(
        marks,
        at,
        linestyle="",
        marker="|",
        ms=11,
        mew=1.6,
        color=INK,
        label="what noise alone reaches",
    )
    for place, score, mark in zip(at, scores, marks, strict=True):
        beside(panel, percent(score / 100.0), max(score, mark), float(place))
    longest = LONGEST_NARROW_NAME + 11 if narrow else LONGEST_NAME
    panel.set_yticks(at, [shortened(row.name.replace("_", " "), longest) for row in rows])
    panel.invert_yaxis()
    panel.grid(False, axis="y")
    panel.set_xlim(0.0, 1.18 * max(float(scores.max()), float(marks.max()), 1.0))
    panel.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g} %"))
    panel.set_xlabel("share of the residual explained" if narrow else
                     "share of the residual that it would explain")  # fmt: skip
    panel.xaxis.set_major_locator(MaxNLocator(4 if narrow else 6, steps=STEPS))
    legend_above(panel, 1)
    return drawn


def errors(diagnosis: Diagnosis, *, narrow: bool = False) -> Figure:
    """Residual rms before and after, by what rows are for and by held-out recording.

    Parameters
    ----------
    diagnosis : Diagnosis
    narrow : bool
        For a phone.
    """
    pictures = _pictures(diagnosis)
    rows = _error_rows(diagnosis, LONGEST_NARROW_NAME if narrow else LONGEST_NAME)
    if not rows:
        raise InputError(f"there is nothing to draw: {diagnosis.sentence}")
    drawn, (panel,) = figure(height=1.0 + 0.3 * len(rows), width=NARROW if narrow else WIDTH)
    at = np.arange(len(rows))
    scale = scale_of(diagnosis)
    floor = scale.factor * pictures.floor
    one = scale.factor * np.array([before for _, before, _ in rows])
    two = scale.factor * np.array([after for _, _, after in rows])
    panel.axvspan(0.0, floor, color=BAND, linewidth=0.0, zorder=0.5, label="noise alone")
    if diagnosis.effects:
        panel.hlines(at, one, two, color=FAINT, linewidth=1.4, zorder=1.5)
        panel.plot(one, at, "o", color=BEFORE, ms=6, label="before")
    panel.plot(two, at, "s", color=AFTER, ms=6, label="after" if diagnosis.effects else "residual")
    panel.set_yticks(at, [name for name, _, _ in rows])
    panel.set_ylim(len(rows) - 0.4, -0.6)
    panel.grid(False, axis="y")
    panel.set_xlim(0.0, 1.08 * max(_extent([one, two]), floor))
    panel.set_xlabel(scale.on_axis("residual, rms"))
    panel.xaxis.set_major_locator(MaxNLocator(4 if narrow else 7, steps=STEPS))
    panel.xaxis.set_major_formatter(FuncFormatter(lambda value, _: tick(value)))
    legend_above(panel, 3)
    return drawn


def closed_loop(diagnosis: Diagnosis, *, narrow: bool = False) -> Figure:
    """The tracking error, measured and simulated, and what both models miss of the position.

    Parameters
    ----------
    diagnosis : Diagnosis
    narrow : bool
        For a phone.

    Raises
    ------
    InputError
        No loop was replayed, so there is nothing to draw.
    """
    pictures = _pictures(diagnosis)
    tracking = pictures.tracking
    if tracking is None:
        raise InputError("no loop was replayed, so there is nothing to draw")
    both, scale = bool(diagnosis.effects), loop_scale_of(diagnosis)
    drawn, (upper, lower) = figure(
        2,
        height=4.4 if narrow else 4.2,
        width=NARROW if narrow else WIDTH,
        sharex=True,
        height_ratios=(1.2, 1.0),
    )
    buckets = 350 if narrow else 700
    simulated = [("before", tracking.before, tracking.left_before, BEFORE)] if both else []
    simulated.append(("after" if both else "simulated", tracking.after, tracking.left, AFTER))

    def line(panel: Axes, values: np.ndarray, colour: str, width: float, label: str) -> None:
        shown = thinned(tracking.time, scale.factor * values, buckets)
        panel.plot(*shown, color=colour, linewidth=width, label=label)

    line(upper, tracking.measured, MEASURED, 1.8, "measured")
    for name, position, left, colour in simulated:
        line(upper, position, colour, 0.8, name)
        line(lower, left, colour, 0.8, name)
    upper.set_ylabel(f"tracking error ({scale.unit})")
    lower.set_ylabel(f"difference ({scale.unit})")
    sizes = [digits(scale.factor * _rms(left)) for _, _, left, _ in simulated]
    what = "rms" if narrow else "measured − simulated, rms:"
    named(lower, f"{what} {' → '.join(sizes)} {scale.unit}", narrow)
    lower.set_xlabel("time in the recording (s)")
    lower.set_xlim(min(0.0, float(tracking.time[0])), float(tracking.time[-1]))
    legend_above(upper, 3)
    for panel in (upper, lower):
        ticks(panel, 5 if narrow else 9, 4 if narrow else 5)
    drawn.align_ylabels()
    return drawn


def _pictures(diagnosis: Diagnosis) -> Pictures:
    if diagnosis.pictures is None:
        raise InputError(f"there is nothing to draw: {diagnosis.sentence}")
    return diagnosis.pictures


def _curves(panel: Axes, before: View, after: View | None, scale: Scale, *, size: float) -> None:
    """Mean residuals and the band of the surrogates, over one coordinate."""
    across = _across(before)[0]
    at, low, high, mean = _merged(before, across)
    if _logarithmic(before):
        # A coordinate that begins at 0 is linear up to the first stretch that does not.
        least = float(at[at > 0.0].min())
        panel.set_xscale(
            "log" if at.min() > 0.0 else "symlog",
            **({} if at.min() > 0.0 else {"linthresh": least, "linscale": 0.3}),
        )
    panel.axhline(0.0, color=FAINT, linewidth=0.7)
    band = scale.factor * low, scale.factor * high
    panel.fill_between(at, *band, color=BAND, linewidth=0.0, label="noise alone, 95 %")
    keywords: dict[str, Any] = {"ms": size, "linewidth": 1.1}
    if after is None:
        panel.plot(at, scale.factor * mean, "-s", color=AFTER, label="what is left", **keywords)
        return
    panel.plot(at, scale.factor * mean, "-o", color=BEFORE, label="before", **keywords)
    # Each model may lay its stretches elsewhere: an effort is the modelled one where it is noisy.
    at, _, _, mean = _merged(after, across)
    panel.plot(at, scale.factor * mean, "-s", color=AFTER, label="after", **keywords)


def _merged(view: View, across: float) -> tuple[np.ndarray, ...]:
    """Centres times ``across``, band and means, with stretches that lie on one another as one.

    Stretches hold equally many rows each, so that where a machine runs at one speed many of them
    have the same place: they are drawn as their mean.
    """
    seen = np.isfinite(view.at)
    parts = (across * view.at, view.low, view.high, view.mean)
    columns = np.array([part[seen] for part in parts])
    along = columns[0]
    if _logarithmic(view):
        along = np.log(np.maximum(along, float(along[along > 0.0].min())))
    reach = TOGETHER * float(np.ptp(along)) if along.size else 0.0
    group = np.zeros(along.size, dtype=np.int64)
    first = 0
    for k in range(1, along.size):
        if along[k] - along[first] > reach:
            first = k
        group[k] = group[k - 1] + (first == k)
    counts = np.maximum(np.bincount(group), 1)
    return tuple(np.bincount(group, weights=column) / counts for column in columns)


def _logarithmic(view: View) -> bool:
    at = view.at[np.isfinite(view.at)]
    if not view.coordinate.logarithmic or not at.size:
        return False
    rising = at[at > 0.0]
    return bool(at.min() >= 0.0 and rising.size and at.max() > WIDE_RANGE * rising.min())


def _panel_title(before: View, after: View, *, both: bool, narrow: bool) -> str:
    shares = f"{_share(before)} → {_share(after)}" if both else _share(after)
    if max(before.share if both else 0.0, after.share) < LEAST_TOLD:
        shares = "nothing shows"
    noise = f"noise: {_share_of(max(after.threshold, 0.0))}"
    name = after.coordinate.name.replace("order over position, times", "order ×")
    if narrow:
        name = name.replace("along the motion", "(along)")
        return f"{name}\n{shares.replace(f'{NO_BREAK}% →', ' →')} ({noise})"
    return f"{name}\n{shares} ({noise})"


def _share(view: View) -> str:
    return _share_of(max(view.share, 0.0))


def _share_of(share: float) -> str:
    return percent(share, 0 if share >= 0.0995 else 1)


def _axis(view: View, pictures: Pictures) -> str:
    name, unit = quantity_of(view.coordinate.axis, pictures)
    return Scale(1.0, f"{_across(view)[1]}{unit}").on_axis(name)


def _upright(view: View, pictures: Pictures, scale: Scale) -> tuple[str, Scale]:
    """What the vertical axis of a cause says, and its unit; ``scale`` is that of residuals."""
    if not view.coordinate.upright:
        return "mean residual", scale
    name, unit = quantity_of(view.coordinate.upright, pictures)
    if unit == "%":
        return name, Scale(100.0, unit)
    return name, suited([_extent([view.mean])], unit)


def _across(view: View) -> tuple[float, str]:
    """What the places of a view are multiplied with, and the prefix of their unit then.

    Small ones keep the unit that the machine moves in, so that figures can be compared.
    """
    return prefixed(_extent([view.at]), at_least=1.0)


def quantity_of(axis: str, pictures: Pictures) -> tuple[str, str]:
    """Name and unit of what an axis shows."""
    told = axis.format(x=pictures.position_unit, f=pictures.effort_unit, e=pictures.effort_name)
    name, _, unit = told.rpartition(", ")
    return name, unit.removeprefix("1·")


def _error_rows(diagnosis: Diagnosis, longest: int) -> list[tuple[str, float, float]]:
    """Name, rms before and rms after, of each kind of rows and of each held-out recording."""
    before, after = diagnosis.baseline, diagnosis.extended
    rows = []
    if before is not None and after is not None:
        for name, key in (
            ("rows fitted", "train_rms"),
            ("rows that decided", "select_rms"),
            ("rows held out", "heldout_rms"),
        ):
            one, two = _error(before, key), _error(after, key)
            if one is not None and two is not None:
                rows.append((name, one, two))
    stretches = _pictures(diagnosis).stretches
    if len(stretches) > 1:
        shown = stretches[:MOST_RECORDINGS]
        names = told_apart([stretch.name for stretch in shown], longest)
        for name, stretch in zip(names, shown, strict=True):
            rows.append((name, _rms(stretch.before), _rms(stretch.after)))
    return [row for row in rows if math.isfinite(row[1]) and math.isfinite(row[2])]


def _error(model: ModelSummary, key: str) -> float | None:
    value: float | None = getattr(model, key)
    return value


def _rms(values: np.ndarray) -> float:
    seen = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(seen**2))) if seen.size else math.nan


def _extent(parts: Sequence[np.ndarray]) -> float:
    """Greatest magnitude of all that is finite, 1 where there is nothing."""
    greatest = [float(np.max(np.abs(p[np.isfinite(p)]))) for p in parts if np.isfinite(p).any()]
    return max(greatest, default=0.0) or 1.0
