"""What is kept of each recording for its page is what was measured, fitted and tested."""

from __future__ import annotations

import numpy as np
import pytest

import stiction as st
from stiction._support.arrays import FloatArray
from stiction.diagnosis.findings.pictures import ROLES, Trace

DT = 2e-3


def recorded(seed: int) -> st.Recording:
    """Sums of sines on a motor with an offset that nobody states."""
    time = np.arange(4000) * DT
    source = np.random.default_rng(seed)
    effort = sum(
        0.25 * np.sin(2.0 * np.pi * source.uniform(0.2, 3.0) * time + source.uniform(0.0, 6.0))
        for _ in range(4)
    )
    friction = st.FrictionModel("coulomb", coulomb=0.1, viscous=0.02)
    motor = st.Motor(0.01, friction=friction, effects={"torque_bias": {"bias": 0.05}})
    position = motor.simulate(effort, DT, outputs=["position"]).position
    read = np.round(np.concatenate([[0.0], position[:-1]]) * 1e4) / 1e4
    return st.Recording(time, effort, read)


@pytest.fixture(scope="module")
def found() -> st.Diagnosis:
    plant = st.Plant.from_dict(
        {
            "motion": {"kind": "rotary"},
            "drive": {"input": "torque_nm"},
            "friction": {"law": "coulomb"},
        }
    )
    return st.diagnose(plant, [recorded(k) for k in range(6)], surrogates=8, threads=1)


def rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def traces(found: st.Diagnosis) -> tuple[Trace, ...]:
    assert found.pictures is not None
    return found.pictures.traces


def test_every_recording_is_there_with_what_its_rows_are_for(found: st.Diagnosis) -> None:
    kept = traces(found)
    assert len(kept) == 6
    split = found.data["split"]
    for name in ("train", "select", "test"):
        own = {kept[part["recording"]].name for part in split[name]}
        assert own == {t.name for t in kept if (t.role == ROLES.index(name)).any()}
    for trace in kept:
        # The warm-up counts for nothing.
        assert trace.role[0] == 0
        assert (trace.role > 0).mean() > 0.9
        assert np.all(np.diff(trace.time) > 0.0)


def test_residuals_of_the_rows_that_test_are_those_that_are_told(found: st.Diagnosis) -> None:
    assert found.baseline is not None
    assert found.extended is not None
    tested = [trace for trace in traces(found) if trace.tests.any()]
    for name, told in (("before", found.baseline), ("after", found.extended)):
        stacked = np.concatenate([getattr(trace, name)[trace.tests] for trace in tested])
        assert rms(stacked) == pytest.approx(told.heldout_rms, rel=1e-9)


def test_what_the_causes_explain_adds_up_to_what_goes(found: st.Diagnosis) -> None:
    causes = [cause.name for cause in found.effects]
    assert causes == ["torque_bias"]
    for trace in traces(found):
        gone = sum(trace.contributions[name] for name in causes)
        np.testing.assert_allclose(gone, trace.before - trace.after, atol=1e-12)


def test_a_plant_without_a_controller_is_simulated_by_its_input_alone(
    found: st.Diagnosis,
) -> None:
    for trace in traces(found):
        assert trace.simulated is not None
        assert not trace.loop
        missed = [rms(trace.position - own) for own in trace.simulated]
        assert missed[1] < 0.2 * missed[0]
        span = np.ptp(trace.position)
        for own in trace.simulated:
            assert np.all(own <= trace.position.max() + 2.0 * span)


def test_positions_are_those_of_the_recording(found: st.Diagnosis) -> None:
    for k, trace in enumerate(traces(found)):
        own = recorded(k)
        assert own.position is not None
        at = np.interp(trace.time, own.time, own.position)
        np.testing.assert_allclose(trace.position, at, atol=1e-9)
        assert trace.step == pytest.approx(1e-4)
