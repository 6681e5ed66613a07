"""Plants as systems of python-control: the same numbers to the bit, from any state."""

import numpy as np
import pytest

import stiction as st

control = pytest.importorskip("control")
from stiction.control import start, system  # noqa: E402

from .test_targets import effect_record  # noqa: E402

DT = 1e-3


def plant(law="coulomb", *effects, **tables):
    return st.Plant.from_dict(
        {
            "drive": {"input": "current_a", "gain": 0.5},
            "body": {"inertia": 0.01},
            "friction": {"law": law},
            "effects": list(effects),
        }
        | tables
    )


def efforts(n=250, seed=1):
    return np.repeat(np.random.default_rng(seed).uniform(-1.6, 1.6, n // 25), 25)


def response(machine, inputs, begin=None, room=64):
    made = system(machine, DT, room=room)
    begin = start(machine, DT, room=room) if begin is None else begin
    time = DT * np.arange(inputs.shape[-1] + 1)
    held = np.concatenate([inputs, inputs[..., -1:]], axis=-1)
    rows = np.stack([held, np.zeros_like(held)]) if inputs.ndim == 1 else held
    return control.input_output_response(made, time, rows, begin)


@pytest.mark.parametrize("law", [each.name for each in st.laws()])
def test_every_law_goes_as_its_motor_to_the_bit(law):
    machine = plant(law)
    found = response(machine, efforts())
    run = machine.simulate(efforts(), DT)
    for name in ("position", "velocity", "friction"):
        row = found.outputs[["position", "velocity", "friction"].index(name)]
        assert row[1:].tobytes() == run[name].tobytes()
    assert np.ptp(run.velocity) > 0.0


@pytest.mark.parametrize("effect", [each.name for each in st.effects()])
def test_every_effect_does_so(effect):
    record = effect_record(effect)
    if record.impossible("rotary", servo=False):
        pytest.skip("there is no such plant")
    typical = {p.name: p.typical for p in record.parameters}
    machine = plant("lugre", {"name": effect, **typical})
    found = response(machine, efforts())
    assert found.outputs[0, 1:].tobytes() == machine.simulate(efforts(), DT).position.tobytes()


def test_it_goes_on_from_any_state_under_a_load():
    machine = plant("hsieh_pan")
    load = 0.1 * np.sin(np.arange(250.0))
    both = np.stack([efforts(), load])
    whole = response(machine, both)
    later = response(machine, both[:, 100:], begin=whole.states[:, 100])
    assert later.outputs.tobytes() == np.ascontiguousarray(whole.outputs[:, 100:]).tobytes()
    run = machine.simulate(efforts(), DT, load=load)
    assert whole.outputs[0, 1:].tobytes() == run.position.tobytes()


def test_it_is_a_discrete_system_with_names():
    made = system(plant("dahl"), DT)
    assert made.dt == DT
    assert made.isdtime(strict=True)
    assert made.input_labels == ["input", "load"]
    assert made.output_labels == ["position", "velocity", "friction"]
    assert "dry_friction" in made.state_labels
    begin = start(plant("dahl"), DT, position=0.2, velocity=-0.1)
    assert begin[:2].tolist() == [0.2, -0.1]


def test_it_closes_a_loop_with_a_controller_of_control():
    machine = plant()
    loop = control.interconnect(
        [
            system(machine, DT),
            control.ss([], [], [], [[8.0, -0.4]], DT, inputs=["error", "velocity"],
                       outputs="input", name="controller"),
            control.summing_junction(inputs=["reference", "-position"], output="error"),
        ],
        inputs=["reference", "load"],
        outputs=["position", "friction"],
    )  # fmt: skip
    time = DT * np.arange(400)
    begin = start(machine, DT)
    inputs = np.stack([np.full(400, 0.5), np.zeros(400)])
    found = control.input_output_response(loop, time, inputs, begin)
    motor, position, velocity = machine.motor(), 0.0, 0.0
    for _ in range(399):
        position, velocity = motor.step(8.0 * (0.5 - position) - 0.4 * velocity, DT)
    assert found.outputs[0, -1] == pytest.approx(position, rel=1e-9)
    # It stops where friction bears what the spring of the controller still asks for.
    assert 0.0 < 0.5 - position < 0.35 / (8.0 * 0.5) * 1.001


def test_a_contact_that_remembers_more_than_there_is_room_for_says_so():
    machine = plant("hsieh_pan")
    ringing = 0.5 * np.cos(np.pi * np.arange(40)) * np.linspace(1.0, 0.1, 40)
    with pytest.raises(st.InputError, match="give the system more with room="):
        response(machine, np.repeat(ringing, 12), room=2)


def test_what_is_no_motor_is_a_sentence():
    with pytest.raises(st.InputError, match="give a Plant"):
        system("plant", DT)
    with pytest.raises(st.InputError, match="no input to simulate"):
        system(plant(drive={"kind": "prescribed_motion"}), DT)
    with pytest.raises(st.InputError, match="dt"):
        system(plant(), 0.0)
