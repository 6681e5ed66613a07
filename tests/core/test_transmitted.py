"""Friction over load, where it is known what the gear transmits."""

from __future__ import annotations

import numpy as np
import pytest

import stiction as st

EFFECTS = {"load_dependent_friction": {"drive": 0.3, "back_drive": 0.3}}
DT = 1e-3


def motor() -> st.Motor:
    return st.Motor(0.1, friction=st.FrictionModel("coulomb", coulomb=0.5), effects=EFFECTS)


def test_friction_grows_with_what_the_gear_transmits_and_not_with_the_load() -> None:
    """A constant one: the same as an offset of friction, which a load of that size would give."""
    inputs = np.full(400, 2.0)
    loaded = motor().simulate(inputs + 1.0, DT, load=np.full(400, -1.0))
    told = motor().simulate(inputs, DT, transmitted=np.full(400, -1.0))
    assert told["velocity"] == pytest.approx(loaded["velocity"], rel=1e-12)


def test_without_it_the_load_is_what_the_gear_transmits() -> None:
    inputs, load = 2.0 * np.sin(0.02 * np.arange(600)), 0.5 * np.cos(0.01 * np.arange(600))
    plain = motor().simulate(inputs, DT, load=load)
    told = motor().simulate(inputs, DT, load=load, transmitted=load)
    assert np.array_equal(plain["position"], told["position"])


def test_it_holds_in_slopes_and_along_a_motion() -> None:
    inputs, carried = 2.0 * np.sin(0.02 * np.arange(600)), 0.8 * np.cos(0.01 * np.arange(600))
    path = "effects.load_dependent_friction.drive"
    slope, _ = motor().sensitivity(inputs, DT, [path], transmitted=carried)

    def moved(drive: float) -> np.ndarray:
        effects = {"load_dependent_friction": {"drive": drive, "back_drive": 0.3}}
        law = st.FrictionModel("coulomb", coulomb=0.5)
        own = st.Motor(0.1, friction=law, effects=effects)
        return own.simulate(inputs, DT, transmitted=carried)["position"]

    numeric = (moved(0.3 + 1e-5) - moved(0.3 - 1e-5)) / 2e-5
    assert slope[0] == pytest.approx(numeric, abs=1e-3 * np.max(np.abs(numeric)))


def test_a_step_forgets_it() -> None:
    one, two = motor(), motor()
    one.simulate(np.zeros(3), DT, transmitted=np.full(3, 5.0))
    two.simulate(np.zeros(3), DT)
    assert one.step(2.0, DT) == two.step(2.0, DT)


def test_as_many_numbers_as_samples() -> None:
    with pytest.raises(st.InputError, match="transmitted"):
        motor().simulate(np.zeros(5), DT, transmitted=np.zeros(4))


def test_a_recording_keeps_it_beside_its_load() -> None:
    time = np.arange(1000) * DT
    load, carried = np.full(1000, 0.1), np.linspace(0.0, 0.3, 1000)
    both = st.Recording(time, np.sin(time), time).with_load(load, carried)
    assert np.array_equal(both.channels["transmitted"], carried)
    assert "transmitted" in repr(both)
    assert "transmitted" not in both.with_load(load).channels


def test_a_recording_with_fewer_rows_keeps_what_held_in_between() -> None:
    time = np.arange(1003) * DT
    slow = st.Recording(time, np.arange(1003.0), np.sin(time)).decimate(4)
    assert len(slow) == 250
    assert np.array_equal(slow.time, time[:1000:4])
    assert slow.input == pytest.approx(np.arange(1000.0).reshape(-1, 4).mean(axis=1), rel=1e-12)
    assert slow.position is not None
    assert np.array_equal(slow.position, np.sin(time)[:1000:4])
    with pytest.raises(st.InputError, match="every = 6 leaves less than 200"):
        st.Recording(time, time, time).decimate(6)
