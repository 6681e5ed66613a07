"""Plain steps in a row where something acts beside drive and friction: the same as one by one."""

import random

import numpy as np
import pytest

import stiction as st

from .rigs import INERTIA, same_state, wandering_current

BESIDE = {
    "cogging": {"effects": {"cogging": {"cosine": 0.04, "sine": 0.02, "order": 6.0}}},
    "bias": {"effects": {"torque_bias": {"bias": 0.02}}},
    "pendulum": {"gravity_amplitude": 0.2, "weight": 0.05},
    "several": {
        "effects": {
            "cogging": {"cosine": 0.04, "order": 6.0, "sine_2": 0.01, "order_2": 11.0},
            "gravity_unbalance": {"cosine": 0.03, "sine": 0.02},
            "torque_bias": {"bias": -0.01},
            "encoder_eccentricity": {"cosine": 0.01},
        },
        "weight": 0.05,
    },
}
LAWS = {
    "coulomb": {},
    "coulomb that falls": {"breakaway": 0.5, "coulomb": 0.35, "stribeck_velocity": 0.05},
    "coulomb that damps": {"viscous": 0.02},
    "dahl": {},
    "dahl_with_memory": {},
    "lugre": {"viscous": 0.01},
    "maxwell_slip": {"viscous": 0.01},
    "hsieh_pan": {},
    "hsieh_pan that slides": {"breakaway": 0.4, "coulomb": 0.3, "viscous": 0.01},
}
DT, SAMPLES = 1e-3, 1500


def motor(law, beside):
    friction = st.FrictionModel(law.split()[0], **LAWS[law])
    made = st.Motor(INERTIA, friction=friction, **BESIDE[beside])
    made.reset(0.3, 0.0)
    return made


@pytest.mark.parametrize("beside", BESIDE)
@pytest.mark.parametrize("law", LAWS)
def test_a_run_is_its_steps(law, beside):
    efforts = wandering_current(5, SAMPLES, 0.8)
    at_once, one_by_one = motor(law, beside), motor(law, beside)
    run = at_once.simulate(efforts, DT, outputs=["position", "velocity"])
    assert np.ptp(run.position) > 1e-3
    steps = []
    for effort in efforts:
        one_by_one.step(effort, DT)
        steps.append(one_by_one.state["position"])
    assert np.array_equal(run.position, steps)
    assert same_state(at_once.state, one_by_one.state)


def drawn(name: str):
    """A motor with effects that nobody chose, maybe a servo, and what acts on it."""
    source = random.Random(name)
    records = source.sample(st.effects(), source.choice([1, 1, 2, 3]))
    effects = {}
    for record in records:
        values = {}
        for each in record.parameters:
            value = each.typical * 10.0 ** source.uniform(-0.5, 0.5)
            turned = each.neutral is not None and source.random() < 0.3
            values[each.name] = float(np.clip(-value if turned else value, *each.bounds))
        effects[record.name] = values
    law = source.choice(st.laws()).name
    servo = source.random() < 0.25
    inertia, dt = source.choice([1e-4, 0.0076, 0.1]), source.choice([1e-4, 1e-3, 4e-3])
    noise = np.random.default_rng(source.randrange(10**9))
    inputs = np.cumsum(noise.normal(size=300)) * (0.003 if servo else 0.02)
    inputs *= source.choice([0.3, 1.0, 3.0])
    inputs[50:120] = inputs[50]
    around = {}
    if source.random() < 0.2:
        around["temperature"] = 20.0 + 0.1 * np.cumsum(noise.normal(size=300))
    if source.random() < 0.2:
        around["load"] = 0.05 * noise.normal(size=300)
    if source.random() < 0.2:
        around["enabled"] = noise.random(300) > 0.1

    def build() -> st.Motor:
        friction = st.FrictionModel(law)
        if not servo:
            return st.Motor(inertia, friction=friction, effects=effects)
        loop = {"proportional": 20.0, "integral": 5.0, "supply": 12.0, "resistance": 2.0}
        return st.Motor(inertia, 0.4, friction=friction, effects=effects, servo=loop)

    return build, inputs, dt, around


@pytest.mark.parametrize("part", range(8))
def test_runs_of_any_motors_are_their_steps(part):
    for number in range(25):
        build, inputs, dt, around = drawn(f"{part} {number}")
        at_once, one_by_one = build(), build()
        run = at_once.simulate(inputs, dt, **around)
        steps = []
        for k, given in enumerate(inputs):
            now = {name: values[k] for name, values in around.items()}
            one_by_one.step(given, dt, **now)
            steps.append(one_by_one.state["position"])
        assert np.array_equal(run.position, steps), (part, number)
        assert same_state(at_once.state, one_by_one.state), (part, number)


@pytest.mark.parametrize("law", ["coulomb", "lugre", "maxwell_slip"])
def test_its_derivatives_are_those_of_differences(law):
    path, change = "effects.cogging.cosine", 1e-6
    plant = {
        "drive": {"input": "torque_nm", "gain": 1.0},
        "body": {"inertia": INERTIA},
        "friction": {"law": law, **LAWS[law]},
        "effects": [{"name": "cogging", "cosine": 0.04, "order": 6.0}],
    }
    efforts = np.full(300, 0.7)

    def positions(cosine):
        plant["effects"][0]["cosine"] = cosine
        return st.Plant.from_dict(plant).motor().simulate(efforts, DT).position

    difference = (positions(0.04 + change) - positions(0.04 - change)) / (2.0 * change)
    plant["effects"][0]["cosine"] = 0.04
    found, _ = st.Plant.from_dict(plant).motor().sensitivity(efforts, DT, [path])
    off = np.abs(found.reshape(difference.shape) - difference)
    assert np.max(off) < 1e-4 * np.max(np.abs(difference))
