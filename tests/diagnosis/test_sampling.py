"""Inputs that rows do not hold: read at an instant, or of the time before the row."""

from __future__ import annotations

import numpy as np
import pytest

import stiction as st

FAST, ROWS = 10, 1500
DT = 2e-3


def plant() -> st.Plant:
    return st.Plant.from_dict(
        {
            "motion": {"kind": "rotary"},
            "drive": {"input": "torque_nm"},
            "friction": {"law": "coulomb"},
        }
    )


def recordings(how: str) -> list[st.Recording]:
    """A machine whose effort changes ten times from row to row, and what a log reads of it."""
    friction = st.FrictionModel("coulomb", coulomb=0.13, viscous=7.5e-3)
    found = []
    for k, role in enumerate(("train", "train", "select", "test")):
        rng = np.random.default_rng([71, k])
        time = np.arange(ROWS * FAST) * DT / FAST
        hertz, phase = rng.uniform(0.3, 3.0, 4), rng.uniform(0.0, 2.0 * np.pi, 4)
        effort = 0.15 * np.sin(2.0 * np.pi * time[:, None] * hertz + phase).sum(axis=1)
        moved = st.Motor(2.4e-3, friction=friction).simulate(effort, DT / FAST).position
        position = np.concatenate([[0.0], moved])[:-1:FAST]
        means = effort.reshape(ROWS, FAST).mean(axis=1)
        logged = {
            "held": means,
            "instant": effort[::FAST],
            "past": np.append(means[0], means[:-1]),
        }[how]
        logged = logged + 2e-4 * rng.standard_normal(ROWS)
        position = position + 1e-6 * rng.standard_normal(ROWS)
        found.append(st.Recording(time[::FAST], logged, position, role=role))
    return found


@pytest.mark.parametrize(("how", "ahead"), [("held", 0.0), ("instant", 0.45), ("past", 1.0)])
def test_an_input_is_taken_as_it_was_read(how: str, ahead: float) -> None:
    """Held from its row on, what was read otherwise would act before it is stamped."""
    found = st.diagnose(plant(), recordings(how), surrogates=8, threads=1)
    assert found.verdict == "nothing_missing", found.sentence
    assert found.baseline is not None
    numbers = found.baseline.parameters
    assert numbers["coulomb"].value == pytest.approx(0.13, rel=5e-3)
    assert numbers["inertia"].value == pytest.approx(2.4e-3, rel=5e-3)
    assert found.data["input_ahead"] == pytest.approx(ahead, abs=0.03)
    assert ("The input acts" in found.sentence) == bool(ahead)
