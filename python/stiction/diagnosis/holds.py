"""Long rests under a load: what holds the machine there, by the last model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from ..fitting.rows import Rows
from ..recording import Check
from ..trajectory import FloatArray
from .model import Model

__all__ = ["holds_of"]

LEAST_S: Final = 5.0
"""A rest that lasts so long is told."""
COUNTS: Final = 2.0
"""Within so many counts, or so many times the noise, a machine is at rest."""
LOADED: Final = 0.25
"""Share of the dry friction from which on a weight or another load has a part in a rest."""
HOLDS: Final = 1.5
"""Break-away lies above sliding friction, by half of it at most in what people measure."""


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
        still = COUNTS * max(form.count, form.noise)
        first, last = _longest_rest(form.readings, form.dt, still)
        if first == last:
            continue
        motor = form.begun(model.plant, form.position)
        start = model.nuisances.start(each.index)
        drive, ambient, _, _ = motor.follow(form.motion, start=start)
        rest = slice(first, max(first + 1, last - 1))
        driven, loaded = float(np.mean(drive[rest])), float(np.mean(ambient[rest]))
        if abs(loaded) < LOADED * dry.value:
            continue
        unit = model.plant.effort_unit
        held = abs(driven + loaded)
        at = float(np.mean(form.readings[first:last]))
        began, ended = first * form.dt, last * form.dt
        where = f"{at:.4g} {model.plant.position_unit}"
        what = (
            f"rests from {began:.1f} s to {ended:.1f} s at {where}: the drive gives {driven:.3g} "
            f"{unit}, the weight and all else {loaded:.3g} {unit}, and friction, which slides at "
            f"{dry.value:.3g} {unit}, holds the {held:.3g} {unit} between them"
        )
        if held > HOLDS * dry.value:
            means = (
                "the friction of this plant holds less: its weight, its gain, an offset or a load "
                "that it leaves out is wrong"
            )
            try_ = "weigh the moving part, or record slow motion both ways over the whole range"
            told.append((names[each.index], Check("hold", "note", what, means, try_)))
        else:
            means = (
                "so much its friction can hold: the plant stands still there as the machine does"
            )
            told.append((names[each.index], Check("hold", "note", what, means)))
    return told


def _longest_rest(position: FloatArray, dt: float, still: float) -> tuple[int, int]:
    """First and one past the last sample of the longest stretch that stays within ``still``.

    (0, 0) where none lasts long enough.
    """
    length = round(LEAST_S / dt)
    if length < 1 or len(position) < length:
        return 0, 0
    # Of window k: samples k to k + length − 1.
    origin = -(length // 2)
    high = maximum_filter1d(position, length, origin=origin)
    low = minimum_filter1d(position, length, origin=origin)
    rests = (high - low <= still)[: len(position) - length + 1]
    edges = np.flatnonzero(np.diff(np.concatenate([[0], rests.astype(np.int8), [0]])))
    if len(edges) == 0:
        return 0, 0
    firsts, ends = edges[::2], edges[1::2]
    longest = int(np.argmax(ends - firsts))
    return int(firsts[longest]), int(ends[longest]) - 1 + length
