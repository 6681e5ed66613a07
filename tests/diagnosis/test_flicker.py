"""Encoders whose readings scatter by a third of a count before they are rounded."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.reference.session_reference import make_sessions

import stiction as st
from stiction.fitting.forms import as_session as told_of_each_other
from stiction.residual.weak_form import WeakForm


def diagnosed(seed: int, hidden: tuple[Any, ...] = ()) -> Any:
    spec = {"seed": seed, "base": "coulomb", "hidden": hidden, "flicker": 0.3}
    (made,) = make_sessions([spec])
    return st.diagnose(as_plant(made), as_session(made))


@pytest.mark.parametrize("seed", [12640007, 12640010, 12640011])
def test_no_recording_stands_alone_for_it(seed: int) -> None:
    found = diagnosed(seed)
    assert found.verdict == "nothing_missing", found.sentence


@pytest.mark.slow
def test_a_delay_is_told_beside_it() -> None:
    found = diagnosed(12649002, (("input_delay", 0.03, {"sign": 1.0}),))
    (cause,) = found.effects
    names = {cause.name, *cause.look_alikes}
    assert "input_delay" in names
    assert names <= {"input_delay", "current_loop_lag"}
    assert found.gain is not None
    assert found.gain.ci95[0] > 0.2


def test_a_recording_at_rest_is_read_with_the_noise_of_the_others() -> None:
    plant = st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm"},
            "body": {"inertia": 0.01},
            "friction": {"law": "coulomb", "coulomb": 0.3},
            "sensor": {"counts_per_rev": 62832},
        }
    )
    rng, time, count = np.random.default_rng(4), np.arange(3000) * 1e-3, 2.0 * np.pi / 62832

    def form(position: np.ndarray, scatter: float) -> WeakForm:
        read = count * np.round(position / count + scatter * rng.standard_normal(len(time)))
        return WeakForm(plant, st.Recording(time, np.sin(time), read), every=0.005)

    # Two counts apart, now here, now there; within one it rests whatever others tell.
    still = 2.0 * count * (np.arange(len(time)) // 40 % 2)
    moving = [form(np.sin((3.0 + k) * time), 0.3) for k in range(3)]
    resting = form(still, 0.0)
    assert all(each.flickers for each in moving)
    assert not resting.flickers
    assert np.any(np.diff(resting.position) != 0.0)
    forms = [*moving, resting]
    recordings = [st.Recording(time, np.sin(time), np.sin(time)) for _ in forms]
    told_of_each_other(forms, recordings)
    assert resting.noise == pytest.approx(np.median([each.noise for each in moving]))
    assert np.all(np.diff(resting.position) == 0.0)
    # Nobody stated a count, and a reading that rests shows none.
    unstated = form(np.zeros(len(time)), 0.0)
    unstated.count = 0.0
    told_of_each_other([*moving, unstated], recordings)
    assert unstated.flickers
    # Of those that nobody may look at yet nothing is taken.
    other = form(still, 0.0)
    told_of_each_other([*moving, other], recordings, sealed={0, 1, 2})
    assert not other.flickers


def test_exact_readings_have_no_noise_to_share() -> None:
    plant = st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm"},
            "body": {"inertia": 0.01},
            "friction": {"law": "coulomb", "coulomb": 0.3},
        }
    )
    time = np.arange(3000) * 1e-3
    slow = 8e-6 * np.maximum(np.sin(2.0 * time), 0.0)
    recordings = [
        st.Recording(time, np.sin(time), x)
        for x in (*(np.sin((25.0 + 5.0 * k) * time) for k in range(3)), slow)
    ]
    forms = [WeakForm(plant, recording, every=0.005) for recording in recordings]
    before = forms[-1].position.copy()
    told_of_each_other(forms, recordings)
    assert np.array_equal(forms[-1].position, before)
