"""Friction that differs between two directions only once the machine is fast: a film of oil."""

from __future__ import annotations

import numpy as np
import pytest

import stiction as st

DRY, WET, MORE = 20.0, 200.0, 0.2
"""N, N·s/m, and the share by which the viscous friction of each direction is off their mean."""
OFFSET = 3.0
"""Effort that pulls one way all the time, N."""
NOISE = 1.0
"""Of the effort, N."""
MOVED = {
    "motion": {"kind": "linear"},
    "drive": {"kind": "prescribed_motion"},
    "body": {"inertia": 0.0},
    "friction": {"law": "coulomb"},
}


def moved(comes_about: float, offset: float) -> st.Recording:
    """Some slow waves up to 0.1 m/s; friction straight from its formula, which has no state."""
    source = np.random.default_rng(1)
    time = np.arange(24_000) * 1e-3
    waves = ((0.05, 1.3, 0.2), (0.03, 3.1, 1.1), (0.02, 7.3, 2.0))
    speed = sum(size * np.sin(w * time + phase) for size, w, phase in waves)
    position = np.concatenate([[0.0], np.cumsum(0.5e-3 * (speed[1:] + speed[:-1]))])
    uneven = 1.0 - MORE * np.sign(speed) * np.tanh(np.abs(speed) / comes_about)
    needed = DRY * np.sign(speed) + WET * uneven * speed - offset
    effort = needed + NOISE * source.standard_normal(len(time))
    position = position + 1e-7 * source.standard_normal(len(time))
    return st.Recording(time, None, position, effort=effort)


@pytest.mark.parametrize("comes_about", [1e-4, 0.03])
@pytest.mark.parametrize("offset", [0.0, OFFSET])
def test_they_are_named_however_slowly_they_come_about_and_whatever_is_stated(
    comes_about: float, offset: float
) -> None:
    # A constant effort makes up for half of an asymmetry: what is left begins at higher speeds.
    stated = {"effects": [{"name": "torque_bias", "bias": 1.0}]} if offset else {}
    plant = st.Plant.from_dict(MOVED | stated)
    found = st.diagnose(plant, moved(comes_about, offset), surrogates=6, threads=1)
    assert found.verdict == "missing_effect"
    (cause,) = found.effects
    assert cause.name == "direction_asymmetry"
    assert cause.decided
    low, high = cause.parameters["effects.direction_asymmetry.viscous"].ci95
    assert -0.35 < low < high < -0.1
    assert found.gain is not None
    assert found.gain.ci95[0] > 0.8
