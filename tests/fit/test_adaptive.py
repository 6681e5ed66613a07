"""Smoothing as far as noise makes it necessary and the motion allows it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import minimum_filter1d, uniform_filter1d

from stiction import InputError
from stiction._native import adaptively_smoothed as by_the_core
from stiction.residual.adaptive import smooth_adaptively

DT = 1e-3
COUNT = 2.0 * np.pi / 2**18
NOISE = COUNT / np.sqrt(12.0)


def rounded(position: np.ndarray) -> np.ndarray:
    read: np.ndarray = np.round(position / COUNT) * COUNT
    return read


def off(position: np.ndarray) -> float:
    """Error of what is made of the readings, in counts."""
    made = smooth_adaptively(rounded(position), DT, NOISE)
    return float(np.sqrt(np.mean((made - position) ** 2))) / COUNT


def test_slow_motion_over_the_counts_goes_on_in_one_direction() -> None:
    slow = 0.15 * COUNT * np.arange(2000)
    made = smooth_adaptively(rounded(slow), DT, NOISE)
    assert np.all(np.diff(made)[40:-40] > 0.0)
    assert off(slow) < 0.06
    assert np.mean(np.diff(rounded(slow)) == 0.0) > 0.8


@pytest.mark.parametrize("amplitude", [20.0, 200.0])
def test_loops_keep_their_ends(amplitude: float) -> None:
    time = np.arange(3000) * DT
    loop = amplitude * COUNT * np.sin(2.0 * np.pi * 2.0 * time)
    made = smooth_adaptively(rounded(loop), DT, NOISE)
    assert np.max(made) == pytest.approx(amplitude * COUNT, abs=0.5 * COUNT)
    assert off(loop) < 0.2  # rounding alone: 0.29


def test_a_stop_stays_where_it_is() -> None:
    time = np.arange(2000) * DT
    stop = np.where(time < 1.0, 0.5 * (1.0 - time) ** 2, 0.0)
    made = smooth_adaptively(rounded(stop), DT, NOISE)
    assert np.max(np.abs(made[1020:])) == 0.0
    sudden = np.where(time < 1.0, time - 1.0, 0.0)
    assert np.max(np.abs(smooth_adaptively(rounded(sudden), DT, NOISE) - sudden)) < COUNT


def test_what_has_no_noise_is_left_as_it_is() -> None:
    motion = np.cumsum(np.random.default_rng(0).standard_normal(500))
    assert np.array_equal(smooth_adaptively(motion, DT, 0.0), motion)
    # Nor is there anything to smooth by where samples are too far apart.
    assert np.array_equal(smooth_adaptively(rounded(motion), 0.1, NOISE), rounded(motion))
    assert len(smooth_adaptively(motion[:5], DT, 1.0)) == 5


def by_scipy(readings: np.ndarray, noise: float, halves: list[int]) -> np.ndarray:
    """The same out of filters of SciPy and fits of NumPy."""
    number, edge = len(readings), halves[-1]
    padded = np.pad(readings, edge, "edge")
    low, high = np.full(number, -np.inf), np.full(number, np.inf)
    level, agrees = np.zeros(number), np.ones(number, dtype=bool)
    estimates = []
    for half in halves:
        steps = np.arange(-half, half + 1)
        weights = np.linalg.pinv(np.vander(steps, 3, increasing=True))[0] if half else np.ones(1)
        reached = padded[edge - half : len(padded) - edge + half]
        estimates.append(np.convolve(reached, weights, "valid"))
        error = 2.0 * noise * np.linalg.norm(weights)
        low, high = np.maximum(low, estimates[-1] - error), np.minimum(high, estimates[-1] + error)
        agrees &= low <= high
        level += agrees if half else 0.0
    level = uniform_filter1d(minimum_filter1d(level, 9), 9)
    below = np.minimum(level.astype(int), len(halves) - 2)
    rows = np.arange(number)
    narrow, wide = np.array(estimates)[below, rows], np.array(estimates)[below + 1, rows]
    smoothed: np.ndarray = narrow + (level - below) * (wide - narrow)
    return smoothed


@pytest.mark.parametrize("number", [33, 500, 4000])
@pytest.mark.parametrize("halves", [[0, 1], [0, 1, 2, 4, 8, 16]])
def test_the_core_makes_of_readings_what_filters_of_scipy_do(
    number: int, halves: list[int]
) -> None:
    time = np.arange(number) * DT
    position = 0.3 * np.sin(7.0 * time) ** 3 + 0.01 * np.round(3.0 * time)
    read = rounded(position + NOISE * np.random.default_rng(number).standard_normal(number))
    found = by_the_core(read, NOISE, halves)
    np.testing.assert_allclose(found, by_scipy(read, NOISE, halves), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("halves", [[], [1, 2], [0, 2, 2], [0, 99]])
def test_windows_that_are_none_are_refused(halves: list[int]) -> None:
    with pytest.raises(InputError, match="are no windows"):
        by_the_core(np.arange(20.0), 0.1, halves)
