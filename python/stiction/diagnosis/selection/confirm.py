"""What is no cause although it passed: beside a plant that describes no machine, or against rows.

The rows that test may speak against a name, or say as little of it as the fit does.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ...fitting.rows import Mask, Rows
from ...residual.shooting import ShootingForm
from ..data.evidence import Evidence
from ..data.gain import HeldOut, gain_of
from ..screening.block_gains import heldout_gain
from ..screening.model import Model
from .search import Search

__all__ = [
    "confirm_on_test",
    "inertial_of",
    "lost_share",
    "lost_share_of_motion",
    "lost_share_on_test",
    "reject_without_machine",
]

MOST_LOST: Final = 0.5
"""Share of the power of the effort that a plant may leave, beyond noise, on rows that it was not
fitted to, and still describe the machine."""
NO_MACHINE: Final = (
    "passes, but the plant leaves most of the effort unexplained, with what was added as well"
)
NO_BETTER: Final = "passes, but with what was added the plant does worse on the rows that decide"
AGAINST: Final = "the rows that test speak against it"
NOT_KNOWN: Final = (
    "neither its strength nor its gain on the rows that test can be told from nothing"
)


def reject_without_machine(selection: Search, evidence: Evidence, null: FloatArray) -> Search:
    """The selection without any cause where the plant describes no machine, causes and all.

    Beside a model that leaves most of the effort, anything that bends a little helps a little, and
    what helped at first may have led the whole plant astray. A block in which a contact breaks away
    a moment too early says no more of that than it does of each cause.

    Parameters
    ----------
    selection : Search
    evidence : Evidence
    null : numpy.ndarray, shape (n, surrogates)
        Residuals of the surrogates.
    """
    if not selection.choices:
        return selection
    gain, _ = heldout_gain(*_ends(selection))
    if lost_share(evidence, selection.models[-1], null):
        reason = NO_MACHINE
    elif gain < 0.0:
        reason = NO_BETTER
    else:
        return selection
    while selection.choices:
        selection = selection.without_last(reason)
    return selection


def lost_share(evidence: Evidence, model: Model, null: FloatArray) -> float:
    """Share of the power of the effort that a model leaves beyond noise, on the rows that decide.

    0 where it is no more than ``MOST_LOST``: then the plant describes the machine.

    Parameters
    ----------
    evidence : Evidence
    model : Model
    null : numpy.ndarray, shape (n, surrogates)
        Residuals of the surrogates.
    """
    held = _deciding(evidence)
    effort = evidence.stack(lambda rows: rows.form.whole(model.plant))[held]
    return _beyond(model.residual[held], effort, null[held])


def lost_share_of_motion(evidence: Evidence, model: Model, null: FloatArray) -> float:
    """The same of the motion of a plant that is simulated over windows; 0 where it is not.

    A contact that sticks below its break-away answers every effort, and stands still where the
    machine moved.
    """
    if not evidence.simulated or evidence.plant.servo:
        return 0.0
    held = _deciding(evidence)
    bent = evidence.stack(inertial_of)[held]
    return _beyond(model.residual[held], bent, null[held])


def inertial_of(rows: Rows) -> FloatArray:
    """What a machine leaves of its motion that goes on as it set out; 0 where none is simulated."""
    form = rows.form
    return form.inertial if isinstance(form, ShootingForm) else np.zeros(len(form))


def lost_share_on_test(test: HeldOut | None, index: int, null: FloatArray) -> float:
    """The same of one of the models on the rows that test, the noise that of the others."""
    return 0.0 if test is None else _beyond(test.residuals[index], test.effort, null)


def _ends(selection: Search) -> tuple[Model, Model]:
    return selection.models[0], selection.models[-1]


def _deciding(evidence: Evidence) -> Mask:
    held: Mask = np.any([plan.held for plan in evidence.plans], axis=0)
    return held


def _beyond(residual: FloatArray, effort: FloatArray, null: FloatArray) -> float:
    power = float(np.mean(effort**2))
    left = float(np.mean(residual**2)) - float(np.mean(null**2))
    return left / power if left > MOST_LOST * power > 0.0 else 0.0


def confirm_on_test(selection: Search, test: HeldOut | None, seed: int) -> Search:
    """The selection without the last causes that the rows that test do not bear out.

    Rows that test choose nothing. They may take a name away, though: a plant that does worse with
    an effect than without it where nothing was fitted must not come with it, and where the interval
    of the gain includes 0, the strength at least must be known.

    Parameters
    ----------
    selection : Search
    test : HeldOut or None
        Residuals of its models; without them nothing is taken away.
    seed : int
    """
    while test is not None and selection.choices:
        last = len(selection.choices) - 1
        gain = gain_of(test, last, last + 1, seed)
        if gain.value < 0.0:
            selection = selection.without_last(AGAINST)
        elif gain.ci95[0] <= 0.0 and not _is_known(selection):
            selection = selection.without_last(NOT_KNOWN)
        else:
            break
    return selection


def _is_known(selection: Search) -> bool:
    """Whether the strength of the last cause differs from 0.

    A gain and the path or time over which it comes exchange for each other where most of it is yet
    to come, and still there may be no doubt that something comes.
    """
    candidate = selection.choices[-1].winner.candidate
    return selection.models[-1].knows(candidate, whatever_shape=False)
