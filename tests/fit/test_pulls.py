"""Readings pull a fit one way, and intervals reach to where the number would be without them."""

from __future__ import annotations

import math

import numpy as np
import pytest

import stiction as st
from stiction.diagnosis.data.evidence import Evidence
from stiction.diagnosis.screening.model import Model, fit_model
from stiction.fitting.pulls import pulls_of_readings, widen
from stiction.fitting.result import FitParameter

DT, SAMPLES = 1e-3, 12_000
INERTIA = "body.inertia"


def plant(counts: int, inertia: float) -> st.Plant:
    """A dry contact whose numbers are those of the machine."""
    return st.Plant.from_dict(
        {
            "motion": {"kind": "rotary"},
            "drive": {"input": "torque_nm", "gain": 1.0},
            "body": {"inertia": inertia},
            "friction": {"law": "coulomb", "coulomb": 0.25, "viscous": 0.05},
            "sensor": {"counts_per_rev": counts},
        }
    )


def recorded(
    counts: int, inertia: float, noise: float, machine: st.Plant | None = None
) -> list[st.Recording]:
    """Six recordings of that machine or another one, read with noise of so many counts."""
    machine = machine or plant(counts, inertia)
    source, found = np.random.default_rng(1), []
    time, count = np.arange(SAMPLES) * DT, 2.0 * np.pi / counts
    for k in range(6):
        slow, fast = (0.21 + 0.03 * k) * time, (0.6 + 0.05 * k) * time
        effort = 0.5 * np.sin(2.0 * np.pi * slow) + 0.25 * np.sin(2.0 * np.pi * fast + k)
        moved = machine.motor().simulate(effort[:-1], DT).position
        read = np.concatenate([[0.0], moved]) + noise * count * source.standard_normal(SAMPLES)
        found.append(st.Recording(time, effort, np.round(read / count) * count))
    return found


def fitted(counts: int, inertia: float, noise: float) -> Model:
    """Along the readings, from the right numbers."""
    given = plant(counts, inertia)
    return fit_model(Evidence(given, recorded(counts, inertia, noise)), given)


def pulls_of(model: Model) -> dict[str, float]:
    """How far its readings pull it."""
    return pulls_of_readings(model.solution, model.evidence.train)


@pytest.mark.parametrize("inertia", [0.02, 0.06])
@pytest.mark.parametrize(("counts", "noise"), [(2**14, 0.5), (2**16, 0.5), (2**18, 0.5)])
def test_intervals_reach_what_readings_pull_away_from(
    counts: int, inertia: float, noise: float
) -> None:
    model = fitted(counts, inertia, noise)
    plain, pulls = model.fit_result.parameters, pulls_of(model)
    error = plain[INERTIA].value - inertia
    assert 0.5 < pulls[INERTIA] / error < 2.0
    assert plain[INERTIA].ci95[1] < inertia
    low, high = widen(plain, pulls)[INERTIA].ci95
    assert low <= inertia <= high


def test_fine_readings_hardly_pull() -> None:
    pull = pulls_of(fitted(2**24, 0.02, 0.0)).get(INERTIA, 0.0)
    assert abs(pull) < 1e-4 * 0.02


def test_a_fit_tells_it_too() -> None:
    """Of a machine with a fall of friction that the law lacks windows explain no more."""
    machine = plant(2**16, 0.02).to_dict()
    machine["friction"] |= {"breakaway": 0.3, "stribeck_velocity": 0.5}
    moved = recorded(2**16, 0.02, 0.5, st.Plant.from_dict(machine))
    found = st.fit(plant(2**16, 0.02), moved).parameters[INERTIA]
    low, high = (abs(end - found.value) for end in found.ci95)
    assert max(low, high) > 1.1 * min(low, high)


def test_nothing_is_told_where_no_recording_can_be_made() -> None:
    """Of a spring along the readings no motion near them is known to be the plant's own."""
    given = plant(2**16, 0.02)
    law = {"law": "lugre", "coulomb": 0.25, "initial_stiffness": 50.0, "viscous": 0.05}
    sprung = st.Plant.from_dict({**given.to_dict(), "friction": law})
    model = fit_model(Evidence(sprung, recorded(2**16, 0.02, 0.5)), sprung)
    assert pulls_of(model) == {}


def test_an_interval_grows_to_one_side_and_an_open_one_stays_open() -> None:
    known = FitParameter(1.0, 0.1, (0.8, 1.2), "1", "", 1.0)
    open_ = FitParameter(1.0, math.inf, (-math.inf, math.inf), "1", "", 1.0)
    found = widen({"a": known, "b": open_, "c": known}, {"a": -0.5, "b": 0.5, "d": 1.0})
    assert found["a"].ci95 == (0.8, 1.7)
    assert found["b"].ci95 == (-math.inf, math.inf)
    assert found["c"] is known
