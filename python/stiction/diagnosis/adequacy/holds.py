"""Long rests under a load: what holds the machine there, by the last model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ...fitting.rows import Rows
from ...recording import Check
from ..screening.model import Model

__all__ = ["holds_of"]

LEAST_S: Final = 5.0
"""A rest that lasts so long is told."""
COUNTS: Final = 2.0
"""Within so many counts a machine is at rest..."""
DEVIATIONS: Final = 10.0
"""... or within so many standard deviations of white noise: five seconds of it reach 8 to 9."""
STILLEST: Final = 0.2
"""Noise is that of the stillest part of a recording: what moves quickly may be read worse."""
LOADED: Final = 0.25
"""Share of the dry friction from which on a weight or another load has a part in a rest."""
HOLDS: Final = 1.5
"""Break-away lies above what the model shows of friction by half of it at most."""
SLOW: Final = 0.05
"""Share of the greatest speed up to which friction is dry."""
SMOOTHED_S: Final = 0.2
"""Efforts of a rest are means over so long: of their noise nothing is held."""


def holds_of(rows: Sequence[Rows], model: Model, names: Sequence[str]) -> list[tuple[str, Check]]:
    """The longest rest of each recording under a load, and what balances there.

    A machine that stands still says what its friction holds at least: the effort of the drive and
    the load, taken together. Where that is more than the friction of the model, the weight, the
    gain or an offset is wrong, however small the residual of the motion is.

    Parameters
    ----------
    rows : sequence of Rows
        Of the recordings that may be looked at.
    model : Model
        The last one.
    names : sequence of str
        Of all recordings.

    Returns
    -------
    list of (str, Check)
        By the name of the recording. Empty for a plant without dry friction, and where neither a
        weight nor another load acts beside the drive.
    """
    dry = model.plant.friction.parameters.get("coulomb")
    if dry is None or dry.value <= 0.0 or model.plant.servo:
        return []
    told = []
    for each in rows:
        form = each.form
        if form.prescribed or form.simulated:
            continue
        still = max(COUNTS * form.count, DEVIATIONS * _noise_at_rest(form.readings))
        first, last = _longest_rest(form.readings, form.dt, still)
        rest = slice(first, last - 1)
        if first == last or (form.enabled is not None and not np.all(form.enabled[rest] > 0.0)):
            # Nothing tells what holds a machine whose drive is off.
            continue
        motor = form.start_motor(model.plant, form.position)
        start = model.nuisances.start(each.index)
        drive, ambient, friction, _ = motor.follow(form.motion, start=start, strict=False)
        driven, loaded = float(np.mean(drive[rest])), float(np.mean(ambient[rest]))
        if abs(loaded) < LOADED * dry.value:
            continue
        width = min(max(1, round(SMOOTHED_S / form.dt)), last - first - 1)
        balance = np.convolve((drive + ambient)[rest], np.full(width, 1.0 / width), "valid")
        held = float(np.max(np.abs(balance)))
        # A start from rest may take more than a slide, by the model itself.
        speed = np.abs(np.diff(form.position)) / form.dt
        slow = speed <= SLOW * float(np.max(speed))
        shown = max(dry.value, float(np.max(np.abs(friction[slow]))))
        unit = model.plant.effort_unit
        at = float(np.mean(form.readings[first:last]))
        where = f"{at:.4g} {model.plant.position_unit}"
        what = (
            f"rests from {first * form.dt:.1f} s to {last * form.dt:.1f} s at {where}: the drive "
            f"gives {driven:.3g} {unit}, the weight and all else {loaded:.3g} {unit}, and "
            f"friction, which slides at {dry.value:.3g} {unit}, has to hold up to {held:.3g} "
            f"{unit} between them"
        )
        told.append(
            (names[each.index], Check("hold", "note", what, *_meaning(held > HOLDS * shown)))
        )
    return told


def _meaning(more: bool) -> tuple[str, str]:
    """What a rest means and what to try; ``more`` than the friction of the model is held there."""
    if not more:
        return "so much its friction can hold: the plant stands still there as the machine does", ""
    return (
        "the friction of this plant holds less: its weight, its gain, an offset or a load that it "
        "leaves out is wrong, or something else holds the machine, as a brake or a stop",
        "weigh the moving part, or record slow motion both ways over the whole range",
    )


def _noise_at_rest(position: FloatArray) -> float:
    """Standard deviation of white noise in the stillest part, from third differences."""
    if len(position) < 4:
        return 0.0
    # Of a standard normal the share STILLEST lies within 0.253; third differences add 20 variances.
    small = float(np.quantile(np.abs(np.diff(position, 3)), STILLEST))
    return small / (0.2533 * float(np.sqrt(20.0)))


def _longest_rest(position: FloatArray, dt: float, still: float) -> tuple[int, int]:
    """First and one past the last sample of the longest stretch that stays within ``still``.

    (0, 0) where none lasts long enough.
    """
    length = round(LEAST_S / dt)
    if length < 1 or len(position) < length:
        return 0, 0
    high, low = (_extremes(position, length, ufunc) for ufunc in (np.maximum, np.minimum))
    rests = high - low <= still
    edges = np.flatnonzero(np.diff(np.concatenate([[0], rests.astype(np.int8), [0]])))
    if len(edges) == 0:
        return 0, 0
    firsts, ends = edges[::2], edges[1::2]
    longest = int(np.argmax(ends - firsts))
    return int(firsts[longest]), int(ends[longest]) - 1 + length


def _extremes(values: FloatArray, length: int, ufunc: np.ufunc) -> FloatArray:
    """The greatest or least of each window of so many values, the first begins at the first.

    Of windows that overlap, each twice as long as before.
    """
    width = 1
    while width < length:
        further = min(width, length - width)
        values = ufunc(values[:-further], values[further:])
        width += further
    return values
