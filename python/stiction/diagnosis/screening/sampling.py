"""How a log reads its input: held from its row on, or at some moment before the next one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from ...errors import InputError
from ...plant import Plant
from ...recording import Recording
from ..data.evidence import Evidence, Plan
from .base import fit_baseline
from .evenness import MOST_UNEVEN, added_power, by_pace
from .model import Model
from .regression import project

__all__ = ["AsRead", "fit_baseline_as_read", "fit_baseline_read", "reading_words"]

AHEAD: Final = 0.1
"""Samples by which a machine seems to answer its input before that is stamped, from which on the
row does not hold it: no cause comes ahead of its effect. Of 58 sessions with nothing hidden, whose
logs hold it, none came to .05; readings at an instant came to .43 and more in 26 of 32."""
LEFT: Final = 0.02
"""Samples that are left of that once the input is read as it was; with more it is read again."""
FITS: Final = 3
"""Times that an input is read otherwise."""
COUNTS: Final = 0.03
"""What reading ahead takes off, as a share of what is left, from which on it counts. Of six logs
that hold their input and seemed not to none came to .023; of 18 others with nothing hidden one came
to .035, the rest to .07 and more. Beside a cause that is hidden it is less, and asked again."""


class AsRead(NamedTuple):
    """The base of an input that rows do not hold."""

    ahead: float
    """Samples by which each row was read ahead."""
    recordings: list[Recording]
    """With what acts on the mean from each row to the next."""
    evidence: Evidence
    base: Model


def fit_baseline_as_read(
    plant: Plant, recordings: Sequence[Recording], base: Model
) -> AsRead | None:
    """The base of an input as it was read, where its rows do not hold it; None elsewhere.

    The offset of timing of a fit shifts the effort alone. The friction of a contact that sticks is
    that effort, and does not follow: what is left looks like a cause. Here the input itself is
    shifted, until a fit has next to no offset of its own.

    Parameters
    ----------
    plant : Plant
        What is fitted: as it is stated, or with causes that were found.
    recordings : sequence of Recording
    base : Model
        Of an input that each row holds to the next.
    """
    if plant.servo or plant.prescribed_motion or base.solution.interrupted:
        return None
    dt = min(each.dt for each in recordings)
    left, ahead = base.nuisances.timing / dt, 0.0
    if left > -AHEAD:
        return None
    found = None
    for _ in range(FITS):
        ahead = min(ahead - left, 1.0)
        found = fit_baseline_read(plant, recordings, ahead)
        if found is None:
            return None
        left = found.base.nuisances.timing / dt
        if abs(left) <= LEFT:
            break
    if found is None or abs(left) > AHEAD:
        return None
    return found if _is_of_reading(found, dt) else None


def fit_baseline_read(plant: Plant, recordings: Sequence[Recording], ahead: float) -> AsRead | None:
    """The base of an input that was read so many samples ahead; None where none can be fitted."""
    read = [_read(each, ahead) for each in recordings]
    try:
        return AsRead(ahead, read, *fit_baseline(plant, read))
    except InputError:
        return None


def _read(recording: Recording, ahead: float) -> Recording:
    """A recording with what acts on the mean from each row to the next."""
    values = recording.input
    if values is None:
        return recording
    after = np.append(values[1:], values[-1])
    return recording.with_input((1.0 - ahead) * values + ahead * after)


def _is_of_reading(found: AsRead, dt: float) -> bool:
    """Whether what was read ahead is of the log: it counts, and is as much at every pace.

    What swings on a shaft is ahead of the effort as well, and the more the faster. Asked of the
    base that reads ahead: one whose offset is at its bound is bent by it.
    """
    base, evidence = found.base, found.evidence
    fit, there = evidence.fitted, base.residual
    late = replace(base.nuisances, timing=base.nuisances.timing + found.ahead * dt)
    shifted = evidence.residual(base.plant, late) - there
    place = len(base.solution.variables.paths)
    others = project(base.columns.with_column(place, 0.0), Plan(fit, fit))
    own, left = others.off(shifted[fit]), others.off(there[fit])
    gained = float(own @ own)
    if not gained > COUNTS * float(left @ left):
        return False
    beside = project(base.columns.with_column(place, shifted), Plan(fit, fit))
    uneven = added_power(evidence, beside, there, by_pace(evidence, shifted))
    return uneven <= MOST_UNEVEN * gained


def reading_words(ahead: float) -> str:
    """What is said of an input that was read so many samples ahead; "" of one that rows hold."""
    if not ahead:
        return ""
    return (
        f"The input acts {ahead:.2g} samples before its rows say so, as one that is read at an "
        "instant does (half a sample) or one of the time before its row (one): it was taken so "
        "much ahead, in a straight line from row to row."
    )
