"""What MuJoCo's own elements hold of a plant, run beside the core, as a file and in a model."""

import numpy as np
import pytest

import stiction as st

mujoco = pytest.importorskip("mujoco")
from stiction.mujoco import attach, patch, step  # noqa: E402

BRISTLES = {"coulomb": 0.3, "breakaway": 0.5, "initial_stiffness": 300.0, "viscous": 0.02}
COGGING = {"name": "cogging", "cosine": 0.04, "sine": -0.02, "order": 6.5,
           "cosine_2": 0.01, "order_2": 12.0}  # fmt: skip
UNBALANCE = {"name": "gravity_unbalance", "cosine": 0.03, "sine": 0.05}
DELAY = {"name": "input_delay", "delay": 0.02}
SERVO = {"kind": "servo", "proportional": 3.0, "derivative": 0.05, "supply_v": 12.0,
         "resistance_ohm": 3.7, "torque_constant": 2.0, "current_limit_a": 2.0}  # fmt: skip
OTHER = """
<mujoco><option timestep="1e-4" integrator="implicitfast" gravity="0 0 0"/><worldbody><body>
  <joint name="elbow" type="hinge" axis="0 0 1" damping="3" frictionloss="2" armature="1"/>
  <inertial pos="0 0 0" mass="1e-9" diaginertia="1e-9 1e-9 1e-9"/>
</body></worldbody></mujoco>"""


def plant(friction, *effects, drive=None):
    return st.Plant.from_dict(
        {
            "drive": drive or {"input": "current_a", "gain": 0.5, "limit": 2.2},
            "body": {"inertia": 0.01},
            "friction": friction,
            "effects": list(effects),
        }
    )


def current(dt, seconds=2.0):
    time = dt * np.arange(round(seconds / dt))
    return 2.0 * np.sin(4.0 * time) + 0.6 * np.sin(17.0 * time)


def goals(dt, seconds=2.0):
    return np.where(np.sin(3.0 * dt * np.arange(round(seconds / dt))) > 0.0, 1.0, -0.5)


def model_of(own, dt):
    model = mujoco.MjModel.from_xml_string(own.export("mujoco").files["joint.xml"])
    model.opt.timestep = dt
    return model


def gone(model, inputs, advance=mujoco.mj_step):
    data, velocity = mujoco.MjData(model), []
    for value in inputs:
        data.ctrl[0] = value
        advance(model, data)
        velocity.append(data.qvel[0])
    return np.array(velocity)


def off(own, dt, inputs=current):
    """By how much MuJoCo misses the velocity of the core, as a share of its range."""
    core = own.simulate(inputs(dt), dt, outputs=["velocity"]).velocity
    return np.max(np.abs(gone(model_of(own, dt), inputs(dt)) - core)) / np.ptp(core)


@pytest.mark.parametrize(
    "friction",
    [
        {"law": "lugre", **BRISTLES},
        {"law": "lugre", **BRISTLES, "damping": 0.0, "stribeck_velocity": 0.4},
        {"law": "dahl", "coulomb": 0.3, "initial_stiffness": 300.0, "exponent": 1.0},
    ],
)
def test_bristles_cogging_and_a_late_input_go_as_the_core_does(friction):
    own = plant(friction, COGGING, UNBALANCE, DELAY)
    made = own.export("mujoco")
    assert not any(each.startswith(("cogging", "pre-sliding", "input_delay")) for each in made.lost)
    assert {"cogging", "gravity_unbalance", "input_delay", "the limit of the drive"} <= set(
        made.held
    )
    # MuJoCo's step is of first order: it comes nearer as fast as the step is made shorter.
    coarse, fine = (off(own, dt) for dt in (1e-3, 1e-4))
    assert coarse < 0.06
    assert fine < 0.2 * coarse


@pytest.mark.parametrize(
    "friction",
    [
        {"law": "lugre", **BRISTLES, "stribeck_exponent": 1.0},
        {"law": "lugre", **BRISTLES, "damping_velocity": 0.5},
        {"law": "dahl", "exponent": 2.0},
    ],
)
def test_a_shape_that_mujoco_has_not_becomes_a_joint_and_is_told(friction):
    made = plant(friction).export("mujoco")
    assert "lugre=" not in made.files["joint.xml"]
    assert any(each.startswith("pre-sliding") for each in made.lost)


def test_the_step_that_a_strong_damper_needs_is_told():
    told = plant({"law": "lugre", **BRISTLES, "damping": 300.0}).export("mujoco").lost
    assert any("well below 3.33e-05 s" in each for each in told)


def test_a_servo_goes_as_the_core_does():
    slow = {"name": "goal_rate_limit", "slowness": 0.2}
    own = plant({"law": "coulomb", "coulomb": 0.1, "viscous": 0.03}, DELAY, slow, drive=SERVO)
    made = own.export("mujoco")
    assert len(made.lost) == 1
    assert made.lost[0].startswith("true stick")
    assert off(own, 1e-4, goals) < 0.005
    assert off(own, 1e-3, goals) < 0.03


@pytest.mark.parametrize(
    ("name", "value"),
    [("current_limit_a", 0.4), ("derivative", 0.2), ("duty_limit", 0.3), ("proportional", 1.0)],
)
def test_each_number_of_a_servo_acts(name, value):
    friction = {"law": "coulomb", "coulomb": 0.1, "viscous": 0.03}
    before, own = (plant(friction, drive=drive) for drive in (SERVO, SERVO | {name: value}))
    assert off(own, 1e-4, goals) < 0.005
    core, other = (each.simulate(goals(1e-4), 1e-4, outputs=["velocity"]).velocity
                   for each in (before, own))  # fmt: skip
    assert np.max(np.abs(core - other)) > 0.05 * np.ptp(core)


def test_a_slide_has_its_friction_and_a_stiff_one():
    slide = st.Plant.from_dict(
        {
            "motion": {"kind": "linear"},
            "drive": {"input": "voltage_v", "gain": 35.0},
            "body": {"inertia": 95.0},
            "friction": {"law": "coulomb", "coulomb": 20.0, "viscous": 200.0},
        }
    )
    assert off(slide, 1e-3) < 0.002
    assert off(plant({"law": "coulomb", "coulomb": 0.3, "viscous": 0.02}), 1e-3) < 0.002


def test_how_an_integral_winds_up_is_told():
    own = plant({"law": "coulomb"}, drive=SERVO | {"integral": 2.0})
    assert any("integral" in each for each in own.export("mujoco").lost)


@pytest.mark.parametrize("drive", [None, SERVO])
def test_a_model_that_is_patched_goes_as_the_file_does(drive):
    own = plant({"law": "lugre", **BRISTLES}, COGGING, DELAY, drive=drive)
    spec = mujoco.MjSpec.from_string(OTHER)
    assert patch(spec, "elbow", own) == own.export("mujoco").lost
    inputs = (goals if drive else current)(1e-4, 0.5)
    found = gone(spec.compile(), inputs)
    assert np.ptp(found) > 0.1
    assert found == pytest.approx(gone(model_of(own, 1e-4), inputs), abs=1e-9)
    bare = mujoco.MjSpec.from_string(OTHER)
    patch(bare, "elbow", own, drive=False)
    assert not any(bare.compile().actuator_ctrlnum)
    with pytest.raises(st.InputError, match="'knee' is not in the model; there are elbow"):
        patch(spec, "knee", own)


def test_friction_that_is_attached_takes_the_place_of_what_the_file_has():
    own = plant({"law": "lugre", **BRISTLES}, COGGING)
    model = model_of(own, 1e-3)
    joint = attach(model, "joint", own)
    found = gone(model, current(1e-3), lambda m, d: step(m, d, [joint]))
    core = own.simulate(current(1e-3), 1e-3, outputs=["velocity"]).velocity
    assert np.max(np.abs(found - core)) < 1e-3 * np.ptp(core)
