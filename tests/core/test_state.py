"""What an object carries goes on to the bit elsewhere, whatever law and effects it has."""

from __future__ import annotations

import itertools
import json
import pickle
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stiction as st

LAWS = {law.name: law for law in st.laws()}
EFFECTS = {
    effect.name: {spec.name: spec.typical for spec in effect.parameters} for effect in st.effects()
}
# A disk with a pendulum, a carriage with a weight, a motor driven by a voltage, a servo, and the
# other integrator.
MACHINES: dict[str, dict[str, Any]] = {
    "rotary": {"inertia": 0.0076, "gravity_amplitude": 0.1, "gravity_zero": 0.2, "count": 1e-4},
    "linear": {"inertia": 2.0, "torque_constant": 3.0, "weight": 0.3, "input_limit": 1.5},
    "voltage": {"inertia": 0.0076, "torque_constant": 0.3},
    "servo": {
        "inertia": 0.0076,
        "torque_constant": 0.3,
        "servo": {"proportional": 20.0, "integral": 3.0, "supply": 12.0, "current_limit": 2.0},
    },
    "reference": {"inertia": 0.0076, "integrator": "reference"},
}
BESIDE = {"voltage": {"back_emf": EFFECTS["back_emf"], "voltage_limit": EFFECTS["voltage_limit"]}}
DT = 1e-3
TURNS = np.arange(120)
INPUT = 0.9 * np.sin(0.11 * TURNS) + 0.2 * np.sin(0.71 * TURNS)
LOAD = 0.05 * np.sin(0.31 * TURNS)
HALF = len(TURNS) // 2


def contact(law: str) -> st.FrictionModel:
    """A contact at its typical values, which slides and sticks."""
    typical = {spec.name: spec.typical for spec in LAWS[law].parameters}
    return st.FrictionModel(law, **typical)


def built(law: str, kind: str, effects: dict[str, dict[str, float]]) -> st.Motor:
    beside = BESIDE.get(kind, {}) | effects
    return st.Motor(friction=contact(law), effects=beside, **MACHINES[kind])


def run(motor: st.Motor, part: slice) -> st.Trajectory:
    warmth = 30.0 + 0.1 * TURNS[part]
    return motor.simulate(INPUT[part], DT, load=LOAD[part], temperature=warmth)


def from_json(motor: st.Motor) -> dict[str, Any]:
    text = json.dumps({name: np.asarray(value).tolist() for name, value in motor.state.items()})
    state: dict[str, Any] = json.loads(text)
    return state


def restored(motor: st.Motor, state: dict[str, Any]) -> st.Motor:
    other = motor.copy()
    other.reset()
    other.state = state
    return other


WAYS: dict[str, Callable[[st.Motor], st.Motor]] = {
    "its own state": lambda motor: (setattr(motor, "state", motor.state), motor)[1],
    "another motor": lambda motor: restored(motor, motor.state),
    "a pickle": lambda motor: pickle.loads(pickle.dumps(motor)),
    "JSON": lambda motor: restored(motor, from_json(motor)),
}


def cases() -> list[tuple[str, str, tuple[str, ...]]]:
    """Every law with all effects and with none on every machine, and with some by themselves.

    Every law with every effect by itself is gone through by the tests of the core.
    """
    kinds = itertools.cycle(MACHINES)
    pairs = itertools.product(enumerate(LAWS), enumerate(EFFECTS))
    each = [(law, next(kinds), (effect,)) for (i, law), (k, effect) in pairs if (i + k) % 8 == 0]
    every = [(law, kind, tuple(EFFECTS)) for law in LAWS for kind in MACHINES]
    plain = [(law, kind, ()) for law in LAWS for kind in MACHINES]
    return each + every + plain


@pytest.mark.parametrize("law", sorted(LAWS))
def test_a_state_of_every_machine_goes_on_to_the_bit(law: str) -> None:
    for _, kind, names in (case for case in cases() if case[0] == law):
        motor = built(law, kind, {name: EFFECTS[name] for name in names})
        motor.reset(0.3, 0.1, time=2.0, path=1.0)
        run(motor, slice(0, HALF))
        others = {way: go(motor.copy()) for way, go in WAYS.items()}
        want = run(motor, slice(HALF, None))
        assert want.success, (kind, names)
        for way, other in others.items():
            got = run(other, slice(HALF, None))
            for column in want:
                assert got[column].tobytes() == want[column].tobytes(), (way, kind, names, column)
            assert other == motor, (way, kind, names)


@pytest.mark.parametrize("law", sorted(LAWS))
def test_a_contact_and_a_copy_of_its_state_go_on_to_the_bit(law: str) -> None:
    model = contact(law)
    model.simulate(INPUT[:HALF], DT)
    for other in (contact(law), pickle.loads(pickle.dumps(model)), model.copy()):
        other.state = model.state
        assert other == model
        got = other.simulate(INPUT[HALF:], DT, load=LOAD[HALF:])
        assert got.tobytes() == model.copy().simulate(INPUT[HALF:], DT, load=LOAD[HALF:]).tobytes()
    motor = st.Motor(0.0076, friction=model)
    assert motor.friction == model


@pytest.mark.parametrize("law", sorted(LAWS))
def test_a_checkpoint_of_every_law_is_gone_on_from_to_the_bit(law: str, tmp_path: Path) -> None:
    motor = built(law, "rotary", EFFECTS)
    want = motor.copy().simulate(INPUT, DT).position
    chunks = np.split(INPUT, 3)
    for part in st.stream(motor.copy(), chunks, DT, checkpoint=tmp_path / "run.npz"):
        # The one that is asked for keeps the one before.
        got = part.position
        if part.time[0] > chunks[0].size * DT:
            break
    later = list(st.stream(motor.copy(), chunks, DT, checkpoint=tmp_path / "run.npz"))
    assert len(later) == 2
    rows = [part.position for part in later]
    assert np.array_equal(got, rows[0])
    assert np.array_equal(np.concatenate(rows), want[chunks[0].size :])


def test_an_ensemble_on_processes_is_the_one_in_this_process() -> None:
    motor = built("bristle", "linear", {"input_delay": EFFECTS["input_delay"]})
    run(motor, slice(0, HALF))
    rows = np.outer([0.3, 1.0, 1.7], INPUT)
    here = st.simulate_ensemble(motor, rows, DT)
    with ProcessPoolExecutor(1) as pool:
        there = st.simulate_ensemble(motor, rows, DT, executor=pool, parts=2)
    assert np.array_equal(here.position, there.position)


def test_a_state_that_is_called_like_one_of_the_body_stands_beside_it() -> None:
    motor = st.Motor(0.0076, friction=st.FrictionModel("bristle"))
    motor.reset(5.0, 0.0)
    reached = motor.simulate([0.2] * 200, 1e-3).position[-1]
    assert motor.state["position"] == reached
    assert motor.state["friction.position"] == pytest.approx(reached - 5.0)
    assert motor.friction.state["position"] == motor.state["friction.position"]


@pytest.mark.parametrize("law", sorted(LAWS))
def test_no_column_of_a_law_hides_behind_what_a_trajectory_has(law: str) -> None:
    motor = st.Motor(0.0076, friction=contact(law))
    run = motor.simulate([0.1, 0.2], DT)
    assert len(set(run)) == len(motor.output_names) == 4 + len(LAWS[law].outputs)
    for name in LAWS[law].outputs:
        assert name not in dir(st.Trajectory) or f"friction.{name}" in run
        assert name not in dir(st.EnsembleRun) or f"friction.{name}" in run
