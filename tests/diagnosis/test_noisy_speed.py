"""Rock that a rig shears, read so coarsely that noise is a fifth of its slow speed."""

from __future__ import annotations

import re
from functools import cache

import numpy as np
import pytest
from tests.reference.rate_and_state_reference import RateAndState, along

import stiction as st

DT, NORMAL = 0.01, 2e7
ROCK = RateAndState(mu_0=0.6, a=0.012, b=0.0118, speed=3e-6, distance=1e-5, normal=NORMAL)
NOISE = {"position": 1e-7, "stress": 8e3}
MOVED = {
    "motion": {"kind": "linear"},
    "drive": {"kind": "prescribed_motion"},
    "body": {"inertia": 0.0},
    "friction": {"law": "rate_and_state"},
}
SLOW_AND_FAST = ((3e-6, 10e-6), 6, 2.0)
FOUR_SPEEDS = ((3e-6, 10e-6, 5e-6, 20e-6), 4, 0.5)
"""Speeds, how often, and s from one to the next."""
BEGIN_S = 50.0
"""When something happens once: in a block that is fitted."""


@cache
def sheared(
    speeds: tuple[float, ...], times: int, changing: float, each: float = 6.0
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, position and stress of rock at speeds that change every few s; without noise."""
    steps, samples = np.repeat(np.tile(speeds, times), round(each / DT)), round(changing / DT)
    padded = np.pad(steps, (samples // 2, samples - 1 - samples // 2), "edge")
    speed = np.convolve(padded, np.full(samples, 1.0 / samples), "valid")
    stress = along(ROCK, speed, DT)[0]
    position = np.concatenate([[0.0], np.cumsum(DT * speed)])
    return DT * np.arange(len(position)), position, np.concatenate([stress[:1], stress])


def read(time: np.ndarray, position: np.ndarray, stress: np.ndarray, seed: int = 0) -> st.Recording:
    source = np.random.default_rng(seed)
    position = position + NOISE["position"] * source.standard_normal(len(time))
    stress = stress + NOISE["stress"] * source.standard_normal(len(time))
    return st.Recording(time, None, position, effort=stress)


def diagnosed(recording: st.Recording) -> st.Diagnosis:
    return st.diagnose(st.Plant.from_dict(MOVED), recording, threads=1)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_law_that_hangs_on_the_speed_lacks_nothing_for_the_noise_of_it(seed: int) -> None:
    # What smooths the speed once more helps on all rows: a lag was named, or a Stribeck fall.
    found = diagnosed(read(*sheared(*SLOW_AND_FAST), seed))
    assert found.verdict == "nothing_missing", found.sentence


def test_what_goes_with_position_is_told_beside_that_noise() -> None:
    time, position, stress = sheared(*FOUR_SPEEDS)
    uneven = 1.0 + 0.005 * np.cos(2.0 * np.pi * position / 150e-6)
    (cause,) = diagnosed(read(time, position, uneven * stress)).effects
    names = {cause.name, *cause.look_alikes}
    assert names == {"cogging", "position_dependent_friction"}


def test_slow_sliding_is_smoothed_until_its_logarithm_means_something() -> None:
    recording = read(*sheared(*SLOW_AND_FAST))
    found = st.fit(st.Plant.from_dict(MOVED), recording)
    # Over three times as long where noise counted beside the fast speed alone.
    assert ROCK.distance < found["slip_distance"].value < 2.0 * ROCK.distance


def test_the_law_of_a_single_step_is_told_by_halves_of_it_that_it_did_not_see() -> None:
    found = once(*sheared((3e-6, 10e-6), 1, DT, BEGIN_S))
    told = re.search(r"(\w+) follows it .* and (\S+) times the power in halves", found.sentence)
    assert told is not None, found.sentence
    assert told[1] == "rate_and_state"
    # Fitted to it, it leaves a twentieth.
    assert 0.05 < float(told[2]) < 0.4


def test_no_law_is_told_by_an_event_that_none_follows() -> None:
    time, position, stress = sheared((3e-6, 3e-6), 1, DT, BEGIN_S)
    since = time - BEGIN_S
    push = 1.5e5 * np.sin(2.0 * np.pi * since / 1.6) * ((since > 0.0) & (since < 1.6))
    assert "follows" not in once(time, position, stress + push).sentence


def once(time: np.ndarray, position: np.ndarray, stress: np.ndarray) -> st.Diagnosis:
    """The diagnosis of a dry contact in whose recording something happens once."""
    plant = st.Plant.from_dict(MOVED | {"friction": {"law": "coulomb"}})
    recording = read(time, position, stress)
    found = st.diagnose(plant, recording, laws=("dahl", "rate_and_state"), threads=1)
    assert found.verdict == "not_testable", found.sentence
    return found
