"""All figures of a report: as files, and as elements of the page with words for each."""

from __future__ import annotations

import logging
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Protocol

from markupsafe import Markup

from .._support.best_effort import Failure, attempt
from .._support.numbers import isolate, percent, plain
from .._support.progress import phase, steps
from .._support.scale import scale_of
from ..residual.compared import comparison_of
from . import figures, motion_figures
from .chart_svg import write_svg
from .svg import inline

if TYPE_CHECKING:
    from ..diagnosis.adequacy.omnibus import View
    from ..diagnosis.findings.result import Diagnosis
    from .chart import Chart

__all__ = ["Drawing", "Drawings", "Order", "draw", "orders"]


_logger = logging.getLogger(__name__)


class _Drawn(Protocol):
    def __call__(self, diagnosis: Diagnosis, *, narrow: bool) -> Chart: ...


@dataclass(frozen=True)
class Drawing:
    """A figure in a page.

    Attributes
    ----------
    name : str
        Of the file, without its ending.
    caption : str
        What to see in it.
    wide, narrow : Markup
        For screens and paper, and for phones.
    svg : str
        Text of its file; "" where it could not be drawn.
    failure : str
        Why it could not be drawn.
    """

    name: str
    caption: str
    wide: Markup
    narrow: Markup
    svg: str = ""
    failure: str = ""


Drawings = dict[str, Drawing]
"""By name; figures that a diagnosis has no data for are not there."""


@dataclass(frozen=True)
class _Shown:
    """A figure to draw: how, what it is called and what to see in it."""

    draw: _Drawn
    label: str
    caption: str


@dataclass(frozen=True)
class Order:
    """A figure that a diagnosis has data for."""

    name: str
    shown: Callable[[Diagnosis], _Shown]

    def draw(self, diagnosis: Diagnosis) -> Drawing:
        """Draw it, wide and narrow."""
        shown = self.shown(diagnosis)
        wide, narrow = (write_svg(shown.draw(diagnosis, narrow=each)) for each in (False, True))
        return Drawing(
            self.name,
            shown.caption,
            inline(wide, self.name, shown.label),
            inline(narrow, f"{self.name}-narrow", shown.label),
            wide,
        )


def draw(diagnosis: Diagnosis) -> Drawings:
    """Draw every figure that the diagnosis has data for; of one that fails, say why."""
    made: Drawings = {}
    phase(_logger, "drawing the report")
    for order in steps(orders(diagnosis), "figure"):
        drawn = attempt(f"the figure {order.name}", partial(order.draw, diagnosis))
        if isinstance(drawn, Failure):
            drawn = Drawing(order.name, "", Markup(), Markup(), failure=drawn.sentence)
        made[order.name] = drawn
    return made


def cause_name(index: int, name: str) -> str:
    """Name of the figure of a cause, counted from 0."""
    return f"cause-{index + 1}-{re.sub(r'[^a-z0-9_]', '_', name.lower())}"


def orders(diagnosis: Diagnosis) -> list[Order]:
    """The figures that a diagnosis has data for."""
    found = []
    pictures = diagnosis.pictures
    if pictures is not None:
        if pictures.stretches:
            found.append(Order("before-after", _headline))
        if motion_figures.simulated_trace(diagnosis) is not None:
            found.append(Order("motion", _motion))
        if pictures.traces and not comparison_of(diagnosis.plant).loop:
            found.append(Order("curves", _curves))
        for index, (cause, _) in enumerate(zip(diagnosis.effects, pictures.causes, strict=False)):
            found.append(Order(cause_name(index, cause.name), partial(_cause, index=index)))
        if pictures.after.views:
            found.append(Order("coordinates", _coordinates))
        if pictures.tracking is not None:
            found.append(Order("closed-loop", _closed_loop))
    if any(row.score is not None for row in diagnosis.candidates):
        found.append(Order("candidates", _candidates))
    models = (diagnosis.baseline, diagnosis.extended)
    fitted = all(model is not None and math.isfinite(model.train_rms) for model in models)
    if pictures is not None and fitted:
        found.append(Order("errors", _errors))
    return found


def _candidates(diagnosis: Diagnosis) -> _Shown:
    return _Shown(
        figures.candidates,
        "Bars of the share of the residual that each effect would explain, with a mark for "
        "what noise alone reaches.",
        "Blue: accepted. Grey: refused, for the reason in the table.",
    )


def _errors(diagnosis: Diagnosis) -> _Shown:
    pictures = diagnosis.pictures
    assert pictures is not None
    noise = scale_of(diagnosis).text(pictures.floor)
    return _Shown(
        figures.errors,
        "Residual before and after, by what rows are for and by recording, beside the noise.",
        f"The grey zone is what noise alone would leave, about {noise} rms."
        + (" Recordings by name are held out." if len(pictures.stretches) > 1 else ""),
    )


def _headline(diagnosis: Diagnosis) -> _Shown:
    pictures = diagnosis.pictures
    assert pictures is not None
    stretch = pictures.stretches[0]
    tested = diagnosis.extended is not None and diagnosis.extended.heldout_rms is not None
    rows = "rows held out: fitted on nothing, decided on nothing" if tested else (
        "rows that were fitted, as none are left to test on"
    )  # fmt: skip
    band = scale_of(diagnosis).text(figures.FLOOR_TIMES * pictures.floor)
    by = comparison_of(diagnosis.plant)
    what = f"Measured {by.quantity}, and what"
    model = "the loop, simulated from its goal alone, misses" if by.loop else "the model leaves"
    if diagnosis.effects:
        label = f"{what} is not explained of it before and after, over time."
        shown = f"{what} {model} of it before and after"
    else:
        label = f"{what} the model does not explain of it, over time."
        shown = f"{what} {model} of it"
    return _Shown(
        figures.headline,
        label,
        f"{shown}, in {isolate(stretch.name)}: {rows}. Gaps are rows used otherwise or left "
        f"out. Grey band: what noise alone would leave, ±{band} (twice its rms).",
    )


def _motion(diagnosis: Diagnosis) -> _Shown:
    trace = motion_figures.simulated_trace(diagnosis)
    assert trace is not None
    both = " before and after" if diagnosis.effects else ""
    how = (
        "machine and controller together, from the first measured position on"
        if trace.loop
        else "from the measured start, by the recorded input alone"
    )
    return _Shown(
        motion_figures.motion,
        f"Position over time, measured and simulated{both}, and their difference.",
        f"Position, measured and simulated{both} ({how}), in {isolate(trace.name)}; beneath, what "
        "the simulation misses of it.",
    )


def _curves(diagnosis: Diagnosis) -> _Shown:
    both = ", before and after" if diagnosis.effects else ""
    return _Shown(
        motion_figures.curves,
        f"Friction over speed by the model{both}, and what it leaves there.",
        f"Lines: friction in steady motion by the model{both}, the mean of both directions; beside "
        "it, where that differs from place to place, the effort to stand there. Points: the last "
        "line with the mean residual there added (partial residual), over all rows that were used.",
    )


def _cause(diagnosis: Diagnosis, index: int) -> _Shown:
    pictures = diagnosis.pictures
    assert pictures is not None
    cause = diagnosis.effects[index]
    before, after = pictures.causes[index]
    decided = diagnosis.extended is not None and diagnosis.extended.select_rms is not None
    rows = "rows that nothing was fitted to" if decided else "the rows that decide"
    over, _ = figures.quantity_of(before.coordinate.axis, pictures)
    if before.coordinate.upright:
        what = before.coordinate.upright.rpartition(", ")[0].capitalize()
    else:
        what = "Mean residual"
    where = f", {before.coordinate.rows}" if before.coordinate.rows else ""
    there = " there" if where else ""
    with_it = "with this cause added" if len(diagnosis.effects) > 1 else "after"
    caption = (
        f"{what}, against {over}, on {rows}{where}. {_followed(before, after, there, with_it)} "
        "Grey band: where noise alone stays, 19 times out of 20."
    )
    if before.coordinate.odd:
        caption += " A residual that opposes the motion counts as positive."
    if index > 0:
        caption += " “Before” has the causes above already, “after” this one too."

    def drawn(diagnosis: Diagnosis, *, narrow: bool) -> Chart:
        return figures.cause(diagnosis, index, narrow=narrow)

    label = f"{plain(cause.name)}: {what.lower()} against {over}, before and after."
    return _Shown(drawn, label, caption)


def _followed(before: View, after: View, there: str, with_it: str) -> str:
    """How much of the residual follows the curve of a cause, before and after."""
    share, left, noise = (
        percent(max(each, 0.0)) for each in (before.share, after.share, before.threshold)
    )
    if before.share <= before.threshold:
        return (
            f"The residual{there} follows this curve no more than noise alone would ({share}; "
            f"noise reaches {noise}): what the cause is worth shows over time, not here."
        )
    return (
        f"Before, {share} of the power of the residual{there} follows this curve; {with_it}, "
        f"{left} of what is left does; noise alone reaches {noise}."
    )


def _coordinates(diagnosis: Diagnosis) -> _Shown:
    both = bool(diagnosis.effects)
    shares = "before → after" if both else "now"
    return _Shown(
        figures.coordinates,
        "Mean residual over the coordinates in which most shows"
        + (", before and after," if both else "")
        + " with the band of noise alone.",
        "Mean residual over the coordinates in which most shows or showed, on the rows that "
        "decide; all vertical axes are alike. Per cent: share of the residual that follows the "
        f"curve ({shares}), and what noise alone reaches. "
        + ("A share may rise while its curve falls, as less is left in all. " if both else "")
        + "Over speed, over what counts from a reversal or a slide, and where it says "
        "“along the motion”, a residual that opposes the motion counts as positive.",
    )


def _closed_loop(diagnosis: Diagnosis) -> _Shown:
    pictures = diagnosis.pictures
    assert pictures is not None
    assert pictures.tracking is not None
    both = ", before and after" if diagnosis.effects else ""
    return _Shown(
        figures.closed_loop,
        f"Tracking error over time, measured and simulated{both}, and their difference.",
        "Position less reference, measured and simulated under the same controller, in "
        f"{isolate(pictures.tracking.name)}; beneath, what is left between measured and simulated "
        f"position{both}. Gaps are rows used otherwise or left out.",
    )
