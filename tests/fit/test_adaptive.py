"""Smoothing as far as noise makes it necessary and the motion allows it."""

from __future__ import annotations

import numpy as np
import pytest

from stiction.adaptive import adaptively_smoothed

DT = 1e-3
COUNT = 2.0 * np.pi / 2**18
NOISE = COUNT / np.sqrt(12.0)


def rounded(position: np.ndarray) -> np.ndarray:
    read: np.ndarray = np.round(position / COUNT) * COUNT
    return read


def off(position: np.ndarray) -> float:
    """Error of what is made of the readings, in counts."""
    made = adaptively_smoothed(rounded(position), DT, NOISE)
    return float(np.sqrt(np.mean((made - position) ** 2))) / COUNT


def test_slow_motion_over_the_counts_goes_on_in_one_direction() -> None:
    slow = 0.15 * COUNT * np.arange(2000)
    made = adaptively_smoothed(rounded(slow), DT, NOISE)
    assert np.all(np.diff(made)[40:-40] > 0.0)
    assert off(slow) < 0.06
    assert np.mean(np.diff(rounded(slow)) == 0.0) > 0.8


@pytest.mark.parametrize("amplitude", [20.0, 200.0])
def test_loops_keep_their_ends(amplitude: float) -> None:
    time = np.arange(3000) * DT
    loop = amplitude * COUNT * np.sin(2.0 * np.pi * 2.0 * time)
    made = adaptively_smoothed(rounded(loop), DT, NOISE)
    assert np.max(made) == pytest.approx(amplitude * COUNT, abs=0.5 * COUNT)
    assert off(loop) < 0.2  # rounding alone: 0.29


def test_a_stop_stays_where_it_is() -> None:
    time = np.arange(2000) * DT
    stop = np.where(time < 1.0, 0.5 * (1.0 - time) ** 2, 0.0)
    made = adaptively_smoothed(rounded(stop), DT, NOISE)
    assert np.max(np.abs(made[1020:])) == 0.0
    sudden = np.where(time < 1.0, time - 1.0, 0.0)
    assert np.max(np.abs(adaptively_smoothed(rounded(sudden), DT, NOISE) - sudden)) < COUNT


def test_what_has_no_noise_is_left_as_it_is() -> None:
    motion = np.cumsum(np.random.default_rng(0).standard_normal(500))
    assert np.array_equal(adaptively_smoothed(motion, DT, 0.0), motion)
    # Nor is there anything to smooth by where samples are too far apart.
    assert np.array_equal(adaptively_smoothed(rounded(motion), 0.1, NOISE), rounded(motion))
    assert len(adaptively_smoothed(motion[:5], DT, 1.0)) == 5
