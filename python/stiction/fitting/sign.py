"""Whether a machine is there once its input is turned round: the commonest fault of a column."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from typing import Final

from .._support.progress import phase
from ..errors import InputError
from ..plant import Plant
from ..recording import Recording

__all__ = ["LEFT_WHERE_WRONG", "sign_error"]

_logger = logging.getLogger(__name__)

LEFT_WHERE_WRONG: Final = 0.7
"""Share of the effort (2-norm) that a plant leaves from which on its input may be turned round:
half of the power."""
LEFT_WHERE_RIGHT: Final = 0.35
"""Share that it may leave once it is: an eighth of the power."""


def sign_error(
    plant: Plant,
    recordings: Sequence[Recording],
    left_by: Callable[[Plant, list[Recording]], float],
) -> str:
    """A sentence where the plant describes the machine once its input is turned round, else "".

    Parameters
    ----------
    plant : Plant
        That leaves most of the effort. One that follows a goal, or is moved, has no such input.
    recordings : sequence of Recording
    left_by : callable
        Fits a plant to recordings; returns the share of the effort that is left (2-norm).
    """
    if plant.servo or plant.prescribed_motion:
        return ""
    phase(_logger, "asking whether the input is turned round")
    turned = [each.with_input(-each.input) for each in recordings if each.input is not None]
    if len(turned) < len(recordings):
        return ""
    try:
        left = left_by(plant, turned)
    except InputError:
        return ""
    if not left < LEFT_WHERE_RIGHT:
        return ""
    return (
        f"With its input turned round the plant leaves {100 * left:.2g} % of the effort: check the "
        "sign of the input first (scale = -1 for its column in session.toml turns it round)."
    )
