"""Plants that leave least, found without asking the others about everything."""

import math
from threading import Lock

import numpy as np
import pytest

from stiction._support.workers import with_workers
from stiction.fitting.likeliest import likeliest


@pytest.mark.parametrize("number", [1, 2, 4])
@pytest.mark.parametrize("threads", [1, 2])
def test_the_best_are_those_that_leave_least_over_all_items(threads, number):
    source = np.random.default_rng(number)
    powers = source.integers(0, 4, (9, 5)).astype(float)
    powers[source.random(powers.shape) < 0.05] = math.nan
    totals = np.where(np.isfinite(powers), powers, np.inf).sum(axis=1)
    with with_workers(threads):
        found = likeliest(range(9), range(5), lambda one, item: powers[one, item], number)
    assert found == np.argsort(totals, kind="stable")[:number].tolist()


@pytest.mark.parametrize("threads", [1, 2])
def test_what_has_left_more_than_others_in_all_is_asked_no_further(threads):
    asked, lock = [], Lock()

    def power(plant, item):
        with lock:
            asked.append((plant, item))
        return 1.0 if plant == 3 else 10.0

    with with_workers(threads):
        assert likeliest(range(6), range(5), power) == [3]
    assert {item for plant, item in asked if plant != 3} == {0}
    assert len(asked) == 6 + 4
