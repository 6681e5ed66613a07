"""The figures of the experiments, positions in arc-seconds."""

from __future__ import annotations

from collections.abc import Sequence
from functools import singledispatch
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, NullLocator

from .._support.arrays import FloatArray
from ..errors import InputError
from ..plot import (
    ACCENT,
    CYCLE,
    FAINT,
    INK,
    MEASURED,
    SIMULATED,
    SMALL,
    figure,
    legend,
    thinned,
)
from .dynamic import PulseTrains, RampAndCut, RampAndHold
from .estimate import Estimate
from .graphical import branch_curve
from .local import LocalVariation
from .loops import LoopAreas
from .mechanisms import LoopStudy
from .result import Result
from .rig import ARC_SECOND
from .static import DahlTest, HardeningCycles, NestedLoops, StaticTest
from .stick_slip import StickSlip

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw", "static_comparison"]

_POSITION = "position (arc-seconds)"
_TORQUE = "torque (N·m)"
_TIME = "time (s)"
# Points of a path nearer than this share of the panel get one label together.
_TOGETHER = 0.03
# Samples of a force path that are drawn.
_PATH_POINTS = 3000


@singledispatch
def draw(result: Result) -> Figure:
    """The figure of an experiment."""
    raise InputError(f"there is no figure for {type(result).__name__}")


@draw.register
def _ramp_and_cut(run: RampAndCut) -> Figure:
    drawn, (torque, position, ring) = figure(
        3, height=6.0, title=run.title, height_ratios=(1.0, 1.7, 1.7)
    )
    torque.sharex(position)
    torque.tick_params(labelbottom=False)
    torque.plot(*thinned(run.time, run.effort), color=MEASURED, linewidth=1.0)
    torque.set_ylabel(_TORQUE)
    _line(position, run.time, run.measured)
    _target(position, run.target)
    position.plot(
        run.rest_time, run.rest_position / ARC_SECOND, "o", color=ACCENT, ms=4, label="rest"
    )
    position.set_ylabel(_POSITION)
    position.set_xlabel(_TIME)
    legend(position, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.1)
    if run.cut_time.size and run.ring_time.size:
        start = run.cut_time[0]
        shown = (run.time > start - 0.02) & (run.time <= start + 0.16)
        ring.plot(
            1e3 * (run.time[shown] - start),
            run.position[shown] / ARC_SECOND,
            color=SIMULATED,
            linewidth=1.1,
        )
        peaks = run.ring_time <= start + 0.16
        ring.plot(
            1e3 * (run.ring_time[peaks] - start),
            run.ring_position[peaks] / ARC_SECOND,
            ".",
            color=ACCENT,
            ms=5,
            label="extremes",
        )
        ring.axvline(0.0, color=FAINT, linewidth=0.8)
        legend(ring, loc="upper right")
    ring.set_ylabel(_POSITION)
    ring.set_xlabel("time after the first cut (ms)")
    drawn.align_ylabels()
    return drawn


@draw.register
def _ramp_and_hold(run: RampAndHold) -> Figure:
    drawn, (torque, position) = figure(
        2, height=4.2, title=run.title, sharex=True, height_ratios=(1.0, 2.0)
    )
    torque.plot(*thinned(run.time, run.effort), color=MEASURED, linewidth=1.2)
    torque.set_ylabel(_TORQUE)
    torque.set_ylim(bottom=0.0, top=1.15 * float(run.effort.max()))
    _line(position, run.time, run.measured)
    _target(position, run.target)
    position.plot(
        run.read_time, run.read_position / ARC_SECOND, "o", color=ACCENT, ms=4, label="read"
    )
    for time, read in zip(run.read_time[1:], run.read_position[1:] / ARC_SECOND, strict=True):
        _note(position, f"{read:.2f}", time, read, (0, 6), ha="center")
    position.margins(y=0.13)
    position.set_ylabel(_POSITION)
    position.set_xlabel(_TIME)
    legend(position, loc="lower right")
    drawn.align_ylabels()
    return drawn


@draw.register
def _pulse_trains(run: PulseTrains) -> Figure:
    drawn, (torque, position, rest) = figure(
        3, height=6.0, title=run.title, sharex=True, height_ratios=(1.0, 1.7, 1.7)
    )
    torque.plot(*thinned(run.time, run.effort, 4000), color=MEASURED, linewidth=0.7)
    torque.set_ylabel(_TORQUE)
    torque.set_ylim(1.4 * min((*run.sizes, 0.0)), 1.3 * max((*run.sizes, 0.0)))
    position.plot(
        *thinned(run.time, run.measured / ARC_SECOND, 4000), color=SIMULATED, linewidth=0.6
    )
    position.set_ylabel(_POSITION)
    rest.plot(
        run.rest_time,
        run.rest_position / ARC_SECOND,
        "o",
        color=ACCENT,
        ms=2.8,
        label="position after each pulse",
    )
    if run.rest_hardening.size:
        rest.step(
            run.rest_time,
            run.rest_hardening / ARC_SECOND,
            where="post",
            color=CYCLE[2],
            linewidth=1.3,
            label="work hardening h",
        )
    rest.set_ylabel("at rest (arc-seconds)")
    rest.set_xlabel(_TIME)
    legend(rest, loc="lower right")
    for panel in (torque, position, rest):
        for end in run.rest_time[run.pulses - 1 :: run.pulses][:-1]:
            panel.axvline(end, color=FAINT, linewidth=0.8, linestyle=(0, (3, 3)))
    for index, size in enumerate(run.sizes):
        at = run.rest_time[index * run.pulses] + 0.5 * (run.pulses - 1) * 0.1
        _note(torque, f"{size:+g} N·m".replace("-", "−"), at, max(size, 0.0), (0, 3), ha="center")
    drawn.align_ylabels()
    return drawn


@draw.register
def _static_test(test: StaticTest) -> Figure:
    drawn, (panel,) = figure(height=4.6, width=6.4, title=test.title)
    if test.driven == "staircase":
        # The torque jumps while the rotor stands; only the ends of the levels lie on the curve.
        _path(panel, test.level, test.settled)
        panel.set_xlabel("position at the end of each level (arc-seconds)")
    else:
        _path(panel, test.effort, test.position)
    _points(panel, test.letters, test.level, test.settled / ARC_SECOND)
    return drawn


def static_comparison(tests: Sequence[StaticTest]) -> Figure:
    """The same static test driven in several ways, one above the other.

    Parameters
    ----------
    tests : sequence of StaticTest
        Of the same levels.

    Returns
    -------
    Figure
    """
    name = f"case {tests[0].case}" if tests[0].case is not None else "levels of your own"
    drawn, (panel,) = figure(height=4.6, width=6.4, title=f"Static test, {name}: ways to drive it")
    labels = {
        "force": "force-driven",
        "ramp": "slow ramps, with inertia",
        "staircase": "steps, with inertia (as in the paper)",
    }
    styles = {"force": "-", "ramp": (0, (4, 2.5)), "staircase": "-"}
    markers = {"force": "o", "ramp": "x", "staircase": "s"}
    for test, colour in zip(tests, CYCLE, strict=False):
        at = np.concatenate([[0.0], test.settled]) / ARC_SECOND
        panel.plot(
            at,
            np.concatenate([[0.0], test.level]),
            linestyle=styles[test.driven],
            marker=markers[test.driven],
            ms=5,
            linewidth=1.0,
            color=colour,
            fillstyle="none",
            label=labels[test.driven],
        )
    panel.set_xlabel("position at the end of each level (arc-seconds)")
    panel.set_ylabel(_TORQUE)
    legend(panel, loc="upper left")
    return drawn


@draw.register
def _hardening_cycles(run: HardeningCycles) -> Figure:
    drawn, (loop, plastic) = figure(1, 2, height=3.7, title=run.title)
    _path(loop, run.effort, run.position)
    permanent = run.states["plastic"] / ARC_SECOND
    plastic.plot(*thinned(run.time, permanent), color=SIMULATED, linewidth=1.4)
    plastic.plot(run.time[run.settled_at], permanent[run.settled_at], "o", color=ACCENT, ms=4)
    for at, added in zip(run.settled_at, run.permanent / ARC_SECOND, strict=True):
        text = f"{added:+.2f}".replace("-", "−") if abs(added) >= 0.005 else "0"
        _note(plastic, text, run.time[at], permanent[at], (0, 7), ha="center")
    plastic.margins(y=0.14)
    plastic.set_xlabel(_TIME)
    plastic.set_ylabel("permanent displacement (arc-seconds)")
    return drawn


@draw.register
def _nested_loops(run: NestedLoops) -> Figure:
    drawn, (loop, memory) = figure(1, 2, height=4.2, title=run.title, width_ratios=(1.5, 1.0))
    _path(loop, run.effort, run.position)
    loop.set_xlabel("displacement of the spring (arc-seconds)")
    _points(loop, run.letters, run.level, run.settled / ARC_SECOND)
    points = ("a", *run.letters)
    starts = np.concatenate([[0], run.settled_at[:-1]])
    kept = run.reverse_points[(starts + run.settled_at) // 2]
    legs = [f"{one} to {other}" for one, other in pairwise(points)]
    memory.barh(legs, kept, color=SIMULATED, height=0.55)
    memory.invert_yaxis()
    memory.grid(False, axis="y")
    memory.xaxis.set_major_locator(MaxNLocator(integer=True))
    memory.set_xlabel("reverse points kept")
    return drawn


@draw.register
def _dahl_test(test: DahlTest) -> Figure:
    drawn, (panel,) = figure(height=4.6, width=6.4, title=test.title)
    _path(panel, test.effort, test.position)
    _points(panel, test.letters, test.level, test.settled / ARC_SECOND)
    return drawn


@draw.register
def _loop_study(study: LoopStudy) -> Figure:
    number = len(study.curves)
    drawn, panels = figure(1, number, height=4.2, width=6.4 + 0.8 * (number > 1), title=study.title)
    for panel, curve in zip(panels, study.curves, strict=True):
        _path(panel, curve.effort, curve.position, study.unit)
        _points(panel, study.letters, study.level, curve.settled / study.unit)
        panel.set_xlabel(study.labels[0])
        panel.set_ylabel(study.labels[1] if panel is panels[0] else "")
        if number > 1:
            panel.set_title(curve.label, fontsize=SMALL, loc="left")
    return drawn


@draw.register
def _local_variation(run: LocalVariation) -> Figure:
    drawn, (ramps, places) = figure(1, 2, height=3.7, title=run.title)
    half = len(run.torque) // 2
    for index in range(max(half, 1)):
        colour = CYCLE[index % len(CYCLE)]
        path = run.path[index] / ARC_SECOND
        ramps.plot(path, run.torque[index], color=colour, linewidth=1.1)
        ramps.plot(path[-1:], run.torque[index][-1:], "x", color=colour, ms=5)
    ramps.set_xlabel("displacement (arc-seconds)")
    ramps.set_ylabel(_TORQUE)
    for column in run.breakaway.T:
        places.plot(np.degrees(run.place), column, "o", color=ACCENT, ms=4, fillstyle="none")
    places.set_ylim(bottom=0.0)
    places.set_xlabel("place (degrees)")
    places.set_ylabel(f"break-away, {run.breakaway.shape[1]} ramps at each (N·m)")
    return drawn


@draw.register
def _estimate(found: Estimate) -> Figure:
    drawn, (curve, known) = figure(1, 2, height=3.7, title=found.title)
    distance = found.distance / ARC_SECOND
    curve.fill_between(
        distance, found.branch_low, found.branch_high, color=SIMULATED, alpha=0.25, linewidth=0.0
    )
    curve.plot(distance, found.branch, color=SIMULATED, linewidth=1.3, label="joint fit")
    if found.steps.branch is not None:
        read = branch_curve(found.distance, *found.steps.branch)
        curve.plot(distance, read, color=ACCENT, linewidth=1.0, linestyle="--", label="read off")
    curve.set_xlabel("distance from the reverse point (arc-seconds)")
    curve.set_ylabel("change of torque G (N·m)")
    legend(curve, loc="upper left")
    fine = {name: each for name, each in found.parameters.items() if each.determined}
    for index, each in enumerate(fine.values()):
        low, high = (100.0 * (end / each.value - 1.0) for end in each.ci95)
        known.plot([low, high], [index, index], color=SIMULATED, linewidth=3.0)
        known.plot(0.0, index, "o", color=INK, ms=4)
    known.set_yticks(range(len(fine)), [name.replace("_", " ") for name in fine])
    known.invert_yaxis()
    known.set_xlabel("interval of 95 % (% of the value)")
    return drawn


@draw.register
def _loop_areas(run: LoopAreas) -> Figure:
    drawn, (loops, areas) = figure(1, 2, height=3.7, title=run.title)
    for (x, force), distance, colour in zip(run.loops, run.distance, CYCLE * 9, strict=False):
        middle = 0.5 * (force.max() + force.min())
        loops.plot(
            x / ARC_SECOND - 0.5 * distance / ARC_SECOND,
            force - middle,
            color=colour,
            linewidth=1.1,
        )
    loops.set_xlabel("displacement from the middle (arc-seconds)")
    loops.set_ylabel("torque from the middle (N·m)")
    areas.plot(
        run.distance / ARC_SECOND,
        1e6 * run.formula,
        "-",
        color=MEASURED,
        linewidth=1.2,
        label="2∫G − D·G(D)",
    )
    for distance, area, colour in zip(run.distance, run.area, CYCLE * 9, strict=False):
        areas.plot(distance / ARC_SECOND, 1e6 * area, "o", color=colour, ms=5)
    areas.set_xscale("log")
    areas.set_yscale("log")
    areas.set_xticks(run.distance / ARC_SECOND, [f"{d:g}" for d in run.distance / ARC_SECOND])
    areas.xaxis.set_minor_locator(NullLocator())
    areas.set_xlabel("distance D (arc-seconds)")
    areas.set_ylabel("work lost in a loop (µJ)")
    legend(areas, loc="upper left")
    return drawn


@draw.register
def _stick_slip(run: StickSlip) -> Figure:
    drawn, (position, torque) = figure(2, height=4.4, title=run.title, sharex=True)
    position.plot(
        *thinned(run.time, run.pull), color=MEASURED, linewidth=1.0, label="far end of the spring"
    )
    position.plot(*thinned(run.time, run.measured), color=SIMULATED, linewidth=1.3, label="rotor")
    position.set_ylabel("position (rad)")
    legend(position, loc="upper left")
    torque.plot(*thinned(run.time, run.effort), color=ACCENT, linewidth=1.0)
    torque.set_ylabel("torque of\nthe spring (N·m)")
    torque.set_xlabel(_TIME)
    drawn.align_ylabels()
    return drawn


def _line(panel: Axes, time: FloatArray, position: FloatArray) -> None:
    panel.plot(*thinned(time, position / ARC_SECOND), color=SIMULATED, linewidth=1.0)


def _target(panel: Axes, target: float) -> None:
    panel.axhline(
        target / ARC_SECOND, color=FAINT, linewidth=0.9, linestyle=(0, (3, 3)), label="target"
    )


def _path(panel: Axes, effort: FloatArray, position: FloatArray, unit: float = ARC_SECOND) -> None:
    """Torque over position, with every turning point kept."""
    turns = np.flatnonzero(np.diff(np.sign(np.diff(effort))) != 0) + 1
    even = np.linspace(0, len(effort) - 1, min(_PATH_POINTS, len(effort))).astype(np.int64)
    kept = np.unique(np.concatenate([even, turns]))
    panel.plot(
        np.concatenate([[0.0], position[kept]]) / unit,
        np.concatenate([[0.0], effort[kept]]),
        color=SIMULATED,
        linewidth=1.2,
    )
    panel.set_xlabel(_POSITION)
    panel.set_ylabel(_TORQUE)


def _points(panel: Axes, letters: Sequence[str], level: FloatArray, position: FloatArray) -> None:
    """Mark the points of a path; points that coincide get one label."""
    panel.plot(position, level, "o", color=ACCENT, ms=4, zorder=3)
    panel.plot(0.0, 0.0, "o", color=ACCENT, ms=4, zorder=3)
    _note(panel, "a", 0.0, 0.0, (6, -9))
    before = np.concatenate([[0.0], level[:-1]])
    width, height = float(np.ptp(position)), float(np.ptp(level))
    groups: list[list[int]] = []
    for index in range(len(letters)):
        for group in groups:
            near = abs(position[group[0]] - position[index]) < _TOGETHER * width
            if near and abs(level[group[0]] - level[index]) < _TOGETHER * height:
                group.append(index)
                break
        else:
            groups.append([index])
    for group in groups:
        first = group[0]
        above = level[first] > before[first]
        text = ", ".join(letters[index] for index in group)
        offset, side = ((-5, 4), "right") if above else ((6, -10), "left")
        _note(panel, text, position[first], level[first], offset, ha=side)
    panel.margins(0.07)


def _note(
    panel: Axes,
    text: str,
    x: float,
    y: float,
    offset: tuple[float, float],
    ha: str = "left",
) -> None:
    panel.annotate(
        text, (x, y), offset, textcoords="offset points", ha=ha, fontsize=SMALL, color=INK
    )
