"""Figures of the motion: positions beside the measured one, and curves of the model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np

from .._support.numbers import digits
from .._support.scale import Scale, scale_for
from ..errors import InputError
from ..plot import ACCENT, MEASURED, SIMULATED, SMALL, TEXT
from .axis import Axis, around
from .chart import Chart, Line, Panel
from .chart_parts import extent, time_axis, trace_line, width_of

if TYPE_CHECKING:
    from .._support.arrays import FloatArray
    from ..diagnosis.findings.pictures import Trace
    from ..diagnosis.findings.result import Diagnosis
    from ..plant import Plant

FloatArrays: TypeAlias = "tuple[FloatArray, FloatArray]"

__all__ = ["curves", "motion", "simulated_trace"]

BINS: Final = 60
"""Stretches of a coordinate, each with as many rows."""
FEWEST: Final = 8
"""Rows that a stretch needs."""
SPEEDS, PLACES = 40, 120
"""Points of the curves of a model."""
SLOWEST: Final = 0.1
"""Share of the rows that are slower than a friction curve begins: they stand."""
LEAST_SHARE: Final = 1e-4
"""It begins no lower than at this share of the greatest speed."""
LEAST_PULL: Final = 0.005
"""Share of the friction from which on a pull of the position has a curve."""
UPPER, LOWER, CURVE = 108.0, 86.0, 150.0
"""Heights of the panels."""


def simulated_trace(diagnosis: Diagnosis) -> Trace | None:
    """The recording whose simulated position is drawn: where it can be that of the first figure."""
    pictures = diagnosis.pictures
    if pictures is None:
        return None
    shown = [trace for trace in pictures.traces if trace.simulated is not None]
    first = pictures.stretches[0].name if pictures.stretches else ""
    tested = [trace for trace in shown if trace.tests.any()]
    return next((t for t in shown if t.name == first), next(iter(tested or shown), None))


def motion(diagnosis: Diagnosis, *, narrow: bool = False) -> Chart:
    """Position, measured and simulated by both models, and what each misses of it.

    Parameters
    ----------
    diagnosis : Diagnosis
    narrow : bool
        For a phone.

    Raises
    ------
    InputError
        Nothing can be simulated.
    """
    trace = simulated_trace(diagnosis)
    if trace is None or trace.simulated is None:
        raise InputError("no recording can be simulated, so there is no position to draw")
    assert diagnosis.pictures is not None
    unit, both = diagnosis.pictures.position_unit, bool(diagnosis.effects)
    models = [("after" if both else "simulated", trace.simulated[1], SIMULATED)]
    if both:
        models.insert(0, ("before", trace.simulated[0], ACCENT))
    whole = scale_for([extent([trace.position])], unit)
    missed = [(name, trace.position - own, colour) for name, own, colour in models]
    scale = scale_for([extent([own]) for _, own, _ in missed], unit)

    def line(values: FloatArray, colour: str, width: float, label: str) -> Line:
        return replace(trace_line(trace.time, values, colour, width, narrow), label=label)

    above = [line(whole.factor * trace.position, MEASURED, 1.8, "measured")]
    above += [line(whole.factor * own, colour, 0.9, name) for name, own, colour in models]
    below = [line(scale.factor * own, colour, 0.9, name) for name, own, colour in missed]
    rows = trace.tests if trace.tests.any() else trace.role > 0
    sizes = [digits(scale.factor * float(np.sqrt(np.mean(own[rows] ** 2)))) for _, own, _ in missed]
    time, ticks = time_axis(trace.time, narrow), 4 if narrow else 5
    panels = [
        Panel(
            x=replace(time, numbered=False),
            y=around([each.y for each in above], Axis(0.0, 1.0, whole.on_axis("position"), ticks)),
            marks=above,
            height=UPPER,
            legend=True,
        ),
        Panel(
            x=replace(time, label="time in the recording (s)"),
            y=around(
                [each.y for each in below], Axis(0.0, 1.0, scale.on_axis("difference"), ticks)
            ),
            marks=below,
            height=LOWER,
            title=f"measured − simulated, rms: {' → '.join(sizes)} {scale.unit}",
            size=SMALL if narrow else TEXT,
        ),
    ]
    return Chart(width_of(narrow), panels)


def curves(diagnosis: Diagnosis, *, narrow: bool = False) -> Chart:
    """The friction curve of both models, and the effort that each needs to stand at its places.

    Parameters
    ----------
    diagnosis : Diagnosis
    narrow : bool
        For a phone.

    Raises
    ------
    InputError
        Nothing was fitted, so there is nothing to draw.
    """
    pictures, before, after = diagnosis.pictures, diagnosis.baseline, diagnosis.extended
    if pictures is None or not pictures.traces or before is None or after is None:
        raise InputError(f"there is nothing to draw: {diagnosis.sentence}")
    plants = [before.plant, after.plant] if diagnosis.effects else [after.plant]
    names = [("before", ACCENT), ("after", SIMULATED)][-len(plants) :]
    if not diagnosis.effects:
        names = [("model", SIMULATED)]
    rows = _Rows.of(pictures.traces)
    drawn = [_over_speed(rows, plants, pictures.position_unit)]
    sliding = extent([values for _, values in drawn[0].models])
    standing = _over_position(rows, plants, pictures.position_unit)
    if max(float(np.ptp(values)) for _, values in standing.models) > LEAST_PULL * sliding:
        drawn.append(standing)
    scale = scale_for([sliding], pictures.effort_unit)
    panels = [_curve_panel(curve, names, scale, narrow) for curve in drawn]
    return Chart(width_of(narrow), panels, 1 if narrow else len(panels), legend=True)


@dataclass(frozen=True)
class _Rows:
    """Speed, position and last residual of all rows that were used, one recording after another."""

    speed: FloatArray
    position: FloatArray
    left: FloatArray

    @classmethod
    def of(cls, traces: Sequence[Trace]) -> _Rows:
        used = [np.flatnonzero(trace.role > 0) for trace in traces]
        names = ("velocity", "position", "after")
        return cls(
            *(
                np.concatenate([getattr(t, name)[k] for t, k in zip(traces, used, strict=True)])
                for name in names
            )
        )


@dataclass(frozen=True)
class _Curve:
    """A curve of each model, and the last one with what is left added."""

    title: str
    across: Axis
    unit: str
    models: list[FloatArrays]
    points: FloatArrays


def _over_speed(rows: _Rows, plants: Sequence[Plant], unit: str) -> _Curve:
    fast = np.abs(rows.speed)
    fastest = float(fast.max()) or 1.0
    slowest = max(float(np.quantile(fast, SLOWEST)), LEAST_SHARE * fastest)
    speeds = np.geomspace(slowest, fastest, SPEEDS)
    models = [(speeds, _sliding(plant, speeds)) for plant in plants]
    slides = fast >= slowest
    at, left = _means(fast[slides], (np.sign(rows.speed) * rows.left)[slides])
    points = at, np.interp(np.log(at), np.log(speeds), models[-1][1]) + left
    across = Axis(0.0, 1.0, "speed", scaling="log")
    return _Curve("friction over speed", across, f"{unit}/s", models, points)


def _over_position(rows: _Rows, plants: Sequence[Plant], unit: str) -> _Curve:
    places = np.linspace(float(rows.position.min()), float(rows.position.max()), PLACES)
    models = [(places, plant.position_effort(places)) for plant in plants]
    at, left = _means(rows.position, rows.left)
    points = at, np.interp(at, places, models[-1][1]) + left
    across = Axis(0.0, 1.0, "position")
    return _Curve("effort to stand, over position", across, unit, models, points)


def _curve_panel(
    curve: _Curve, names: Sequence[tuple[str, str]], scale: Scale, narrow: bool
) -> Panel:
    across = scale_for([extent([curve.points[0]])], curve.unit)

    def line(of: FloatArrays, colour: str, label: str, width: float = 1.3) -> Line:
        return Line(across.factor * of[0], scale.factor * of[1], colour, width, label=label)

    points = line(curve.points, MEASURED, "with what is left", 0.0)
    lines = [replace(points, marker="o", size=3.5)]
    lines += [
        line(own, colour, name) for own, (name, colour) in zip(curve.models, names, strict=True)
    ]
    label = across.on_axis(curve.across.label)
    x = replace(curve.across, label=label, most=3 if narrow else 5)
    return Panel(
        x=around([each.x for each in lines], x),
        y=around([each.y for each in lines], Axis(0.0, 1.0, scale.on_axis("effort"), 5)),
        marks=lines,
        height=0.8 * CURVE if narrow else CURVE,
        title=curve.title,
        size=SMALL if narrow else TEXT,
    )


def _sliding(plant: Plant, speeds: FloatArray) -> FloatArray:
    """Friction in steady motion, the mean of both directions."""
    forth, back = plant.friction_curve(speeds), plant.friction_curve(-speeds)
    mean: FloatArray = 0.5 * (forth - back)
    return mean


def _means(over: FloatArray, values: FloatArray) -> FloatArrays:
    """Means of both in stretches of a coordinate, each with as many rows."""
    order = np.argsort(over, kind="stable")
    parts = np.array_split(order, max(min(BINS, order.size // FEWEST), 1))
    return (
        np.array([over[part].mean() for part in parts if part.size]),
        np.array([values[part].mean() for part in parts if part.size]),
    )
