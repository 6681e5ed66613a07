"""What is wrong with a recording before any model is asked: found, what it means, what to try."""

from __future__ import annotations

from ..._support.given import instance
from ..recording import Recording
from . import clock, readings
from .finding import Check, Verdict
from .impulses import impulse_checks, without_failures
from .noise import Stretches, noise, noise_levels
from .signal import spike_rows, without_spikes
from .starts import DOUBTED, starts

__all__ = [
    "DOUBTED",
    "Check",
    "Stretches",
    "Verdict",
    "check",
    "impulse_checks",
    "noise_levels",
    "spike_rows",
    "starts",
    "without_failures",
    "without_spikes",
]


def check(recording: Recording) -> tuple[Check, ...]:
    """Look a recording over.

    Each check is a function of this package with its thresholds as keywords, each with its reason.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    tuple of Check
        At least one of each name, ``"fine"`` ones included, always in the same order; where the
        effort is a stress a note that says so.

    Raises
    ------
    InputError
        No recording.
    """
    instance(recording, Recording, "check: recording", "a Recording")
    return (
        *readings.missing_cells(recording),
        *readings.stress(recording),
        clock.jitter(recording),
        clock.gaps(recording),
        clock.rate(recording),
        clock.sampling(recording),
        *readings.constant(recording),
        *readings.spikes(recording),
        readings.repeats(recording),
        *readings.stuck_channels(recording),
        *readings.clipping(recording),
        readings.saturation(recording),
        readings.refresh(recording),
        *noise(recording),
    )
