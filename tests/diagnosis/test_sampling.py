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


def springs(past: bool) -> list[st.Recording]:
    """An undamped spring of 30 counts, and a log of the input of its row or of the row before."""
    friction = st.FrictionModel(
        "dahl", coulomb=3.9, initial_stiffness=8660.0, exponent=1.0, viscous=1.4
    )
    count, dt = 2.4e-5, 5e-3
    found = []
    for k, role in enumerate(("train", "train", "select", "test")):
        rng = np.random.default_rng([72, k])
        time = np.arange(3000) * dt
        hertz, phase = rng.uniform(0.1, 2.0, 4), rng.uniform(0.0, 2.0 * np.pi, 4)
        effort = 2.5 * np.sin(2.0 * np.pi * time[:, None] * hertz + phase).sum(axis=1)
        moved = st.Motor(0.278, friction=friction).simulate(effort[:-1], dt).position
        position = count * np.round(np.concatenate([[0.0], moved]) / count)
        logged = np.append(effort[:1], effort[:-1]) if past else effort
        found.append(st.Recording(time, logged, position, role=role))
    return found


@pytest.mark.parametrize("past", [False, True])
def test_an_input_of_the_row_before_is_told_of_a_spring_that_is_simulated(past: bool) -> None:
    """Its effort hardly shows when it acts, for the simulated motion answers it."""
    stated = st.Plant.from_dict(
        {
            "motion": {"kind": "rotary"},
            "drive": {"input": "torque_nm"},
            "friction": {"law": "dahl", "exponent": {"value": 1.0, "fixed": True}},
        }
    )
    found = st.diagnose(stated, springs(past), surrogates=8, threads=1)
    assert found.verdict == "nothing_missing", found.sentence
    assert found.data["input_ahead"] == pytest.approx(float(past), abs=0.05)
    assert found.baseline is not None
    assert found.baseline.parameters["initial_stiffness"].value == pytest.approx(8660.0, rel=0.03)
