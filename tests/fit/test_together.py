"""Whether estimates that exchange for each other differ from 0 together."""

from __future__ import annotations

import numpy as np
import pytest

from stiction.fitting.statistics import differ, interval_width, jackknife


@pytest.mark.parametrize("size", [1.5, 2.5])
def test_one_value_differs_where_its_interval_leaves_0_out(size: float) -> None:
    for blocks in (3, 6, 40):
        covariance = np.array([[4.0]])
        expected = size * 2.0 > interval_width(blocks) * 2.0
        assert differ(np.array([size * 2.0]), covariance, blocks) == expected


def test_two_that_exchange_for_each_other_are_there_though_neither_is_known() -> None:
    # The sum is known to .1, the difference to 20.
    along, across = np.array([1.0, 1.0]) / 2**0.5, np.array([1.0, -1.0]) / 2**0.5
    covariance = 0.01 * np.outer(along, along) + 400.0 * np.outer(across, across)
    values = np.array([1.0, 1.0])
    assert np.all(np.abs(values) < 2.0 * np.sqrt(np.diag(covariance)))
    assert differ(values, covariance, 12)
    assert not differ(0.05 * values, covariance, 12)
    assert not differ(np.array([1.0, -1.0]), covariance, 12)


def test_too_few_blocks_or_an_unknown_value_say_nothing() -> None:
    assert not differ(np.ones(2), 1e-9 * np.eye(2), 2)
    assert not differ(np.ones(2), np.diag([1e-9, np.inf]), 20)
    assert not differ(np.ones(2), np.zeros((2, 2)), 20)


def test_of_nothing_one_in_twenty_differs() -> None:
    source = np.random.default_rng(4)
    number, blocks, draws = 2, 9, 4000
    hits = 0
    for _ in range(draws):
        of_each = source.standard_normal((blocks, number)) @ np.array([[1.0, 0.9], [0.0, 0.3]])
        covariance = np.cov(of_each.T) / blocks
        hits += differ(of_each.mean(axis=0), covariance, blocks)
    assert hits / draws == pytest.approx(0.05, abs=0.012)


def test_the_jackknife_of_means_is_their_covariance() -> None:
    # One row a recording, a constant each: the jackknife is the covariance of the mean.
    source = np.random.default_rng(1)
    values = source.standard_normal((7, 2))
    jacobians = [np.eye(2) for _ in values]
    residuals = [row - values.mean(axis=0) for row in values]
    found = jackknife(jacobians, residuals)
    assert found is not None
    np.testing.assert_allclose(found, np.cov(values.T) / 7, rtol=1e-12)
