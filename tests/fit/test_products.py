"""Matrices are multiplied on one thread for as long as somebody fits, and not after."""

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import stiction as st
from stiction._support.products import on_one_thread


def most_threads():
    """Threads of the widest pool of a library that multiplies matrices."""
    pools = [pool for pool in threadpool_info() if pool["user_api"] == "blas"]
    return max(pool["num_threads"] for pool in pools)


@pytest.fixture(autouse=True)
def two_threads():
    with threadpool_limits(limits=2, user_api="blas"):
        if most_threads() < 2:
            pytest.skip("no library here multiplies on two threads")
        yield


def test_a_limit_holds_while_it_is_asked_for():
    seen = on_one_thread(most_threads)()
    assert (seen, most_threads()) == (1, 2)


def test_a_limit_is_lifted_after_an_error():
    @on_one_thread
    def fails():
        raise ValueError("within")

    with pytest.raises(ValueError, match="within"):
        fails()
    assert most_threads() == 2


@pytest.mark.parametrize("work", [st.fit, st.diagnose])
def test_fit_and_diagnose_ask_for_it(work, monkeypatch):
    seen = []

    def looks(*_):
        seen.append(most_threads())
        raise st.InputError("seen")

    for module in ("stiction.fitting.solve", "stiction.diagnosis.pipeline"):
        monkeypatch.setattr(f"{module}.checks_of", looks)
    times = [0.01 * k for k in range(300)]
    recording = st.Recording(times, [0.1] * 300, times)
    plant = st.Plant.from_dict({"motion": {"kind": "rotary"}, "friction": {"law": "coulomb"}})
    with pytest.raises(st.InputError, match="seen"):
        work(plant, recording)
    assert seen == [1]
