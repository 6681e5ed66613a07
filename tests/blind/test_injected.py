"""Effects hidden in recordings: what is changed must be what was asked for, and nothing else."""

from __future__ import annotations

import numpy as np
import pytest

import stiction as st

from .injected import EFFECTS, hidden

DRY = 0.4


def recorded() -> tuple[st.Plant, list[st.Recording]]:
    time = np.arange(4000) * 1e-3
    effort = np.sin(3.0 * time) + 0.5 * np.sin(7.0 * time)
    position = 2.0 * np.sin(3.0 * time)
    plant = st.Plant.from_dict(
        {"drive": {"input": "current_a", "gain": 0.5}, "friction": {"law": "coulomb"}}
    )
    return plant, [st.Recording(time, effort / 0.5, position)]


@pytest.mark.parametrize("name", EFFECTS)
@pytest.mark.parametrize("size", [0.03, 0.3])
def test_what_is_hidden_has_its_size_and_leaves_the_motion(name: str, size: float) -> None:
    plant, (before,) = recorded()
    (after,) = hidden([before], plant, DRY, name, size)
    changed = plant.gain * (after.input - before.input)
    assert np.sqrt(np.mean(changed**2)) == pytest.approx(size * DRY, rel=1e-6)
    assert np.array_equal(after.position, before.position)
    assert np.array_equal(after.time, before.time)
    assert name in {effect.name for effect in st.effects()}


def test_an_input_that_acts_late_was_asked_for_before() -> None:
    plant, (before,) = recorded()
    (after,) = hidden([before], plant, DRY, "input_delay", 0.1)
    ahead = np.argmax(after.input[:800]), np.argmax(before.input[:800])
    assert ahead[0] < ahead[1]
