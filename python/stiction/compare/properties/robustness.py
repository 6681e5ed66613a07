"""Ripple and noise: what wears a held force away."""

from __future__ import annotations

from typing import Final

import numpy as np

from ..measured import Measured, Property
from ..subject import Subject

__all__ = ["NOISE", "RATCHET"]

_LOAD, _RIPPLE = 0.5, 0.3
_FREQUENCY: Final = 5.0  # Hz
_A_CYCLE: Final = 40  # samples
_CYCLES, _FIRST = 300, 50
_RATCHETS: Final = 0.1
_NOISE: Final = 0.4  # counts
_COUNTS: Final = 30.0
_SAMPLES: Final = 100
_DT: Final = 1e-3  # s
_LOADING, _STEPS = 0.1, 2000  # s for one pre-sliding distance, and steps
_KEPT: Final = 0.9


def ratchet(subject: Subject) -> Measured:
    """Load of 50 % of F_c and a ripple of 30 % at 5 Hz for 60 s."""
    level = subject.coulomb
    host = subject.host()
    host.ramp(0.0, _LOAD * level, 0.2, 100)
    start = host.position
    phase = 2.0 * np.pi * np.arange(1, _A_CYCLE + 1) / _A_CYCLE
    cycle = (level * (_LOAD + _RIPPLE * np.sin(phase))).tolist()
    ends = [host.push(cycle, 1.0 / _FREQUENCY / _A_CYCLE)[-1] for _ in range(_CYCLES)]
    late = abs(ends[-1] - ends[_FIRST - 1]) / subject.length
    return Measured(
        bool(late < _RATCHETS),
        {"drift in 60 s, spans": abs(ends[-1] - start) / subject.length,
         "drift after the first 10 s, spans": late},
    )  # fmt: skip


def noise(subject: Subject) -> Measured:
    """A contact at 57 % of its level, moved by 100 readings of noise about where it is."""
    length = subject.length
    amplitude = _NOISE * length / _COUNTS
    shaken, still = subject.model(), subject.model()
    force = 0.57 * subject.scale.level
    for law in (shaken, still):
        if subject.rigid:
            law.step(0.0, _DT, effort=force)
            continue
        # Far enough for any law that slides; one that never does goes on as far as it needs.
        for _ in range(20_000):
            if law.step(length / _LOADING, _LOADING / _STEPS) >= force:
                break
    readings = amplitude * np.random.default_rng(0).uniform(-1.0, 1.0, _SAMPLES)
    readings[-1] = 0.0
    last, forces, rested = 0.0, [], []
    for reading in readings:
        forces.append(shaken.step((reading - last) / _DT, _DT, effort=force))
        rested.append(still.step(0.0, _DT, effort=force))
        last = float(reading)
    share = float(np.mean(forces[-20:]) / np.mean(rested[-20:]))
    return Measured(share >= _KEPT, {"share of the force that is left": share})


RATCHET: Final = Property(
    "no_ratcheting",
    "no ratcheting",
    f"Does it stay where it is under a load of {_LOAD:.0%} and a ripple of {_RIPPLE:.0%} of F_c, "
    "its least friction of steady sliding?",
    f"Drifts by less than {_RATCHETS:g} of the pre-sliding distance in the last 50 of 60 s at "
    "5 Hz: creep that stops has stopped by then; a law that ratchets drifts by tens or hundreds.",
    ratchet,
)
NOISE: Final = Property(
    "survives_noise",
    "survives encoder noise",
    "Does it keep its force when it is driven by a measured position that flickers?",
    f"Keeps {_KEPT:.0%} of the force that it keeps at rest, after {_SAMPLES} readings with noise "
    f"of ±{_NOISE:g} counts, {_COUNTS:g} counts to the pre-sliding distance (0.8 arc-seconds at "
    "117 µrad).",
    noise,
)
