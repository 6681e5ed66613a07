"""The figures of a report, as charts.

Each is made wide for a screen or paper, and again ``narrow`` for a phone, where the wide one would
be too small to read.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from .._support.numbers import NO_BREAK, digits, percent
from .._support.scale import Scale, loop_scale_of, prefix_for, scale_for, scale_of
from ..errors import InputError
from ..plot import ACCENT, FAINT, INK, MEASURED, SIMULATED, SMALL, TEXT
from ..residual.compared import comparison_of
from .axis import Axis, around
from .chart import Area, Bars, Chart, Line, Mark, Panel, Span, Words
from .chart_parts import INCH, extent, time_axis, trace_line, width_of
from .labels import distinct_labels, shorten

if TYPE_CHECKING:
    from ..diagnosis.adequacy.omnibus import View
    from ..diagnosis.findings.pictures import Pictures
    from ..diagnosis.findings.result import Diagnosis
    from ..diagnosis.records import ModelSummary

__all__ = [
    "candidates",
    "cause",
    "closed_loop",
    "coordinates",
    "errors",
    "headline",
    "largest_views",
    "quantity_of",
]

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
TRACE, ROW, BAR = 80.0, 21.6, 19.4
"""Heights of a panel over time, and of a line in a list of errors and of bars."""


def headline(diagnosis: Diagnosis, *, narrow: bool = False) -> Chart:
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
    by = comparison_of(diagnosis.plant)
    unit = pictures.position_unit if by.loop else pictures.effort_unit
    given = scale_for([extent([stretch.measured])], unit)
    time, size = time_axis(stretch.time, narrow), SMALL if narrow else TEXT
    measured = trace_line(stretch.time, given.factor * stretch.measured, MEASURED, 0.9, narrow)
    upright = Axis(0.0, 1.0, given.on_axis(by.quantity), _up(narrow))
    panels = [
        Panel(
            x=replace(time, numbered=False),
            y=around([measured.y], upright),
            marks=[measured],
            height=0.8 * TRACE,
            title=f"measured {by.quantity}",
            size=size,
        )
    ]
    band = FLOOR_TIMES * scale.factor * pictures.floor
    span = 1.08 * max(scale.factor * extent([values for _, values, _ in left]), 1.3 * band)
    for number, (name, values, colour) in enumerate(left, 1):
        last = number == len(left)
        trace = trace_line(stretch.time, scale.factor * values, colour, 0.8, narrow)
        panels.append(
            Panel(
                x=replace(time, label="time in the recording (s)") if last else panels[0].x,
                y=Axis(-span, span, scale.on_axis("residual"), _up(narrow)),
                marks=[Span("y", -band, band, BAND), trace],
                height=TRACE,
                title=f"{name}: {scale.text(_rms(values))} rms not explained",
                size=size,
                remark="band: noise alone" if number == 1 and not narrow else "",
            )
        )
    return Chart(width_of(narrow), panels)


def cause(diagnosis: Diagnosis, index: int, *, narrow: bool = False) -> Chart:
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
    upright, scale = _upright(before, pictures, scale_of(diagnosis))
    x, marks = _curves(before, after, scale, size=3.5)
    drawn = [part for mark in marks for part in _heights(mark)]
    panel = Panel(
        x=replace(x, label=_axis(before, pictures), most=4 if narrow else 8),
        y=around(drawn, Axis(0.0, 1.0, scale.on_axis(upright))),
        marks=marks,
        height=2.4 * INCH,
        legend=True,
    )
    return Chart(width_of(narrow), [panel])


def coordinates(diagnosis: Diagnosis, *, narrow: bool = False) -> Chart:
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
    views = largest_views(pictures)
    columns = 2 if narrow else 3
    both, scale = bool(diagnosis.effects), scale_of(diagnosis)
    shown = (*views, *(before.values() if both else ()))
    parts = [part for view in shown for part in (view.mean, view.low, view.high)]
    span = 1.1 * scale.factor * extent(parts)
    panels = []
    for position, view in enumerate(views):
        first = before.get(view.coordinate.name, view)
        x, marks = _curves(first if both else view, view if both else None, scale, size=2.0)
        axis = _axis(view, pictures)
        panels.append(
            Panel(
                # On a phone the title above has to do for the name.
                x=replace(
                    x,
                    label=axis[max(axis.rfind("("), 0) :] if narrow else axis,
                    most=2 if narrow else 4,
                ),
                y=Axis(-span, span, most=4, numbered=position % columns == 0),
                marks=marks,
                height=0.92 * INCH,
                title=_panel_title(first, view, both=both, narrow=narrow),
                size=SMALL - 1.0 if narrow else SMALL,
            )
        )
    upright = scale.on_axis("mean residual")
    return Chart(width_of(narrow), panels, columns, legend=True, upright=upright)


def largest_views(pictures: Pictures) -> list[View]:
    """What is left over the coordinates in which most shows or showed, most left first."""
    before = {view.coordinate.name: view.share for view in pictures.before.views}

    def shows(view: View) -> tuple[bool, float]:
        return view.is_flagged(), max(view.share, before.get(view.coordinate.name, view.share))

    chosen = sorted(pictures.after.views, key=shows, reverse=True)[:MOST_PANELS]
    names = {view.coordinate.name for view in chosen}
    return [view for view in pictures.after.views if view.coordinate.name in names]


def candidates(diagnosis: Diagnosis, *, narrow: bool = False) -> Chart:
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
    at = np.arange(len(rows), dtype=np.float64)
    scores = np.array([100.0 * max(row.score or 0.0, 0.0) for row in rows])
    noise = np.array([100.0 * (row.threshold or 0.0) for row in rows])
    accepted = {effect.name for effect in diagnosis.effects}
    longest = LONGEST_NARROW_NAME + 11 if narrow else LONGEST_NAME
    marks: list[Mark] = [
        Bars(
            at,
            np.zeros(len(rows)),
            scores,
            [SIMULATED if row.name in accepted else REFUSED for row in rows],
            0.62,
        ),
        Line(noise, at, INK, 0.0, "|", 11.0, "what noise alone reaches"),
        Words(np.maximum(scores, noise), at, [percent(score / 100.0) for score in scores]),
    ]
    panel = Panel(
        x=Axis(
            0.0,
            1.06 * max(float(scores.max()), float(noise.max()), 1.0),
            f"share of the residual {'explained' if narrow else 'that it would explain'}",
            4 if narrow else 6,
            written=lambda value: f"{value:g}{NO_BREAK}%",
        ),
        y=_list([shorten(row.name.replace("_", " "), longest) for row in rows]),
        marks=marks,
        height=BAR * len(rows),
        legend=True,
    )
    return Chart(width_of(narrow), [panel])


def errors(diagnosis: Diagnosis, *, narrow: bool = False) -> Chart:
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
    at = np.arange(len(rows), dtype=np.float64)
    scale = scale_of(diagnosis)
    floor = scale.factor * pictures.floor
    one = scale.factor * np.array([before for _, before, _ in rows])
    two = scale.factor * np.array([after for _, _, after in rows])
    marks: list[Mark] = [Span("x", 0.0, floor, BAND, "noise alone")]
    if diagnosis.effects:
        marks += [
            Bars(at, one, two, [FAINT] * len(rows), 0.06),
            Line(one, at, BEFORE, 0.0, "o", 6.0, "before"),
        ]
    marks.append(Line(two, at, AFTER, 0.0, "s", 6.0, "after" if diagnosis.effects else "residual"))
    panel = Panel(
        x=Axis(
            0.0,
            1.08 * max(extent([one, two]), floor),
            scale.on_axis("residual, rms"),
            4 if narrow else 7,
        ),
        y=_list([name for name, _, _ in rows]),
        marks=marks,
        height=ROW * len(rows),
        legend=True,
    )
    return Chart(width_of(narrow), [panel])


def closed_loop(diagnosis: Diagnosis, *, narrow: bool = False) -> Chart:
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
    simulated = [("before", tracking.before, tracking.error_before, BEFORE)] if both else []
    simulated.append(
        ("after" if both else "simulated", tracking.after, tracking.error_after, AFTER)
    )

    def line(values: np.ndarray, colour: str, width: float, label: str) -> Line:
        trace = trace_line(tracking.time, scale.factor * values, colour, width, narrow)
        return replace(trace, label=label)

    above = [line(tracking.measured, MEASURED, 1.8, "measured")]
    above += [line(position, colour, 0.8, name) for name, position, _, colour in simulated]
    below = [line(left, colour, 0.8, name) for name, _, left, colour in simulated]
    sizes = [digits(scale.factor * _rms(left)) for _, _, left, _ in simulated]
    what = "rms" if narrow else "measured − simulated, rms:"
    time = time_axis(tracking.time, narrow)

    def upright(name: str, lines: Sequence[Line]) -> Axis:
        return around([each.y for each in lines], Axis(0.0, 1.0, name, _up(narrow)))

    panels = [
        Panel(
            x=replace(time, numbered=False),
            y=upright(f"tracking error ({scale.unit})", above),
            marks=above,
            height=1.35 * TRACE,
            legend=True,
        ),
        Panel(
            x=replace(time, label="time in the recording (s)"),
            y=upright(f"difference ({scale.unit})", below),
            marks=below,
            height=1.15 * TRACE,
            title=f"{what} {' → '.join(sizes)} {scale.unit}",
            size=SMALL if narrow else TEXT,
        ),
    ]
    return Chart(width_of(narrow), panels)


def _up(narrow: bool) -> int:
    """Intervals between ticks of a vertical axis."""
    return 4 if narrow else 5


def _list(names: Sequence[str]) -> Axis:
    """A vertical axis of names, the first on top."""
    return Axis(len(names) - 0.4, -0.6, names=tuple(names), grid=False)


def _pictures(diagnosis: Diagnosis) -> Pictures:
    if diagnosis.pictures is None:
        raise InputError(f"there is nothing to draw: {diagnosis.sentence}")
    return diagnosis.pictures


def _curves(
    before: View, after: View | None, scale: Scale, *, size: float
) -> tuple[Axis, list[Mark]]:
    """Mean residuals and the band of the surrogates, and the horizontal axis that they need."""
    across = _across(before)[0]
    at, low, high, mean = _merged(before, across)
    first = Line(at, scale.factor * mean, BEFORE, 1.1, "o", size, "before")
    lines = [first]
    if after is None:
        lines = [replace(first, colour=AFTER, marker="s", label="what is left")]
    else:
        # Each model may lay its stretches elsewhere: an effort is the modelled one where it is
        # noisy.
        at_after, _, _, mean = _merged(after, across)
        lines.append(Line(at_after, scale.factor * mean, AFTER, 1.1, "s", size, "after"))
    x = Axis(0.0, 1.0)
    if _logarithmic(before):
        # A coordinate that begins at 0 is linear up to the first stretch that does not.
        least = float(at[at > 0.0].min())
        x = replace(x, scaling="log" if at.min() > 0.0 else "symlog", linear_to=least)
    x = around([line.x for line in lines], x)
    ends = np.array([x.low, x.high])
    zero = Line(ends, np.zeros(2), FAINT, 0.7)
    band = Area(at, scale.factor * low, scale.factor * high, BAND, "noise alone, 95 %")
    return x, [zero, band, *lines]


def _heights(mark: Mark) -> list[np.ndarray]:
    """What a mark of a curve covers of the vertical axis."""
    if isinstance(mark, Area):
        return [mark.low, mark.high]
    return [mark.y] if isinstance(mark, Line) else []


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
    return name, scale_for([extent([view.mean])], unit)


def _across(view: View) -> tuple[float, str]:
    """What the places of a view are multiplied with, and the prefix of their unit then.

    Small ones keep the unit that the machine moves in, so that figures can be compared.
    """
    return prefix_for(extent([view.at]), at_least=1.0)


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
        names = distinct_labels([stretch.name for stretch in shown], longest)
        for name, stretch in zip(names, shown, strict=True):
            rows.append((name, _rms(stretch.before), _rms(stretch.after)))
    return [row for row in rows if math.isfinite(row[1]) and math.isfinite(row[2])]


def _error(model: ModelSummary, key: str) -> float | None:
    value: float | None = getattr(model, key)
    return value


def _rms(values: np.ndarray) -> float:
    seen = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(seen**2))) if seen.size else math.nan
