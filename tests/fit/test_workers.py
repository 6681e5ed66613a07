"""Work side by side: order, errors, and an end that all threads hear of."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest

import stiction as st
from stiction._native import CancelToken
from stiction._support.workers import side_by_side, with_workers


@pytest.fixture
def workers() -> Iterator[None]:
    with with_workers(3):
        yield


def test_results_come_in_the_order_of_their_items(workers: None) -> None:
    def late(item: int) -> int:
        time.sleep(0.01 * (5 - item))
        return item * item

    assert list(side_by_side(late, range(5))) == [0, 1, 4, 9, 16]


def test_what_works_side_by_side_does_not_divide_itself_once_more(workers: None) -> None:
    def names(_: int) -> set[str]:
        own = side_by_side(lambda _: threading.current_thread().name, range(3))
        return set(own)

    assert all(len(each) == 1 for each in side_by_side(names, range(3)))


def test_without_workers_or_with_one_item_everything_stays_on_this_thread() -> None:
    def name(_: int) -> str:
        return threading.current_thread().name

    own = threading.current_thread().name
    assert list(side_by_side(name, range(3))) == [own] * 3
    with with_workers(1):
        assert list(side_by_side(name, range(3))) == [own] * 3
    with with_workers(3):
        assert list(side_by_side(name, range(1))) == [own]


def test_an_error_ends_what_the_others_simulate(workers: None) -> None:
    """An hour at 10 kHz would take seconds."""
    samples = np.zeros(36_000_000)

    def work(item: int) -> None:
        if item == 0:
            time.sleep(0.1)
            raise KeyboardInterrupt
        motor = st.Motor(0.01, 1.0, st.FrictionModel("maxwell_slip"))
        motor.simulate(samples, 1e-4, outputs=[])

    began = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        list(side_by_side(work, range(3)))
    assert time.perf_counter() - began < 2.0


def test_a_token_calls_and_cancels() -> None:
    token = CancelToken()
    assert token.run(lambda item: item + 1, 2) == 3
    token.cancel()
    motor = st.Motor(0.01, 1.0, st.FrictionModel("maxwell_slip"))
    with pytest.raises(KeyboardInterrupt):
        token.run(lambda n: motor.simulate(np.zeros(n), 1e-4), 20_000_000)
    motor.simulate(np.zeros(10), 1e-4)
