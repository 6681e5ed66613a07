"""Noise that is on the logged input alone, and noise that acts: neither is anything missing."""

from __future__ import annotations

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.reference.coulomb_reference import simulate_coulomb
from tests.reference.session_reference import make_session

from stiction import Diagnosis, Plant, Recording, Session, diagnose, fit

DT = 1e-3
ROWS = 15_000
COULOMB = 0.3
COUNT = 2 * np.pi / 2**18


def diagnosed(noise: float, *, acts: bool, late: int = 0) -> Diagnosis:
    """Six recordings of a machine with noise of its input, of which the drive answers late."""
    recordings = []
    time = np.arange(ROWS) * DT
    for k in range(6):
        source = np.random.default_rng([7, k])
        phases = source.uniform(0.0, 6.0, 3)
        waves = ((2.3, phases[0]), (7.1, phases[1]), (15.7, phases[2]))
        asked = sum(0.35 * np.sin(w * (1.0 + 0.1 * k) * time + p) for w, p in waves)
        added = noise * COULOMB * source.standard_normal(ROWS)
        acted = np.concatenate([np.full(late, asked[0]), asked[: ROWS - late]])
        run = simulate_coulomb(
            (acted + added if acts else acted)[:-1],
            DT,
            inertia=0.0076,
            coulomb=COULOMB,
            breakaway=COULOMB,
            viscous=0.05,
        )
        position = np.round(np.concatenate([[0.0], run["position"]]) / COUNT) * COUNT
        recordings.append(Recording(time, asked if acts else asked + added, position))
    plant = Plant.from_dict({"drive": {"input": "torque_nm"}, "friction": {"law": "coulomb"}})
    return diagnose(plant, Session(recordings), without=("input_delay", "current_loop_lag"))


@pytest.mark.slow
@pytest.mark.parametrize(("noise", "acts"), [(0.01, False), (0.04, False), (0.04, True)])
def test_noise_of_the_input_is_nothing_missing(noise: float, acts: bool) -> None:
    found = diagnosed(noise, acts=acts)
    assert found.verdict == "nothing_missing"
    assert not found.effects


@pytest.mark.slow
@pytest.mark.parametrize("acts", [False, True])
def test_an_answer_that_comes_late_is_still_told(acts: bool) -> None:
    found = diagnosed(0.02, acts=acts, late=4)
    assert found.verdict == "unexplained"
    assert "response to the effort" in {each.coordinate for each in found.unexplained}


@pytest.mark.parametrize("seed", [1340001, 1340004])
def test_a_machine_that_rests_under_a_noisy_log_lacks_nothing(seed: int) -> None:
    made = make_session(seed=seed, base="maxwell_slip", log_noise=0.02)
    assert diagnose(as_plant(made), as_session(made)).verdict == "nothing_missing"


ROW, FINE = 5e-3, 1e-3
"""s: of the log, whose inputs are held, and of the simulation."""


def logged(noise: float, late: int) -> Session:
    """A machine at 200 rows a second with noise of its log, late by so many fifths of a row."""
    every, time = round(ROW / FINE), np.arange(2_000) * ROW
    recordings = []
    for k in range(3):
        source = np.random.default_rng([11, k])
        phases = source.uniform(0.0, 6.0, 4)
        waves = zip((2.0, 2.0, 3.0, 2.0), (0.9, 2.3, 5.1, 11.0), phases, strict=True)
        asked = sum(size * np.sin(w * (1.0 + 0.1 * k) * time + p) for size, w, p in waves)
        held = np.repeat(asked, every)
        acted = np.concatenate([np.full(late, held[0]), held[: len(held) - late]])
        friction = {"coulomb": 2.0, "breakaway": 2.0, "viscous": 2.0}
        run = simulate_coulomb(acted[:-1], FINE, inertia=0.25, **friction)
        position = np.concatenate([[0.0], run["position"]])[::every]
        white = noise * source.standard_normal(len(time))
        recordings.append(Recording(time, asked + white, np.round(position / COUNT) * COUNT))
    return Session(recordings)


PLANT = Plant.from_dict({"drive": {"input": "torque_nm"}, "friction": {"law": "coulomb"}})


@pytest.mark.parametrize("noise", [0.0, 0.3])
def test_noise_of_the_log_is_no_offset_of_timing(noise: float) -> None:
    # A slope half a row beside the input that it belongs to had -1.6 ms.
    assert fit(PLANT, logged(noise, late=0)).timing_offset == pytest.approx(0.0, abs=4e-4)


def test_what_comes_late_by_less_than_a_row_is_told_from_noise_of_the_log() -> None:
    assert diagnose(PLANT, logged(0.3, late=0)).verdict == "nothing_missing"
    late = diagnose(PLANT, logged(0.12, late=2))
    # Neither is told from the other within a row.
    assert [each.name for each in late.effects] in (["current_loop_lag"], ["input_delay"])
