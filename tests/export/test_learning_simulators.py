"""Configurations of Isaac Lab and Newton: their numbers by hand, and Newton itself where it is."""

import json
import sys
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

import stiction as st

from .test_steady import plant

FALLING = {"law": "coulomb", "coulomb": 0.3, "breakaway": 0.5, "stribeck_velocity": 0.05,
           "viscous": 0.02}  # fmt: skip
DRY = {"law": "coulomb", "coulomb": 0.3, "viscous": 0.02}
SERVO = {"kind": "servo", "proportional": 3.0, "derivative": 0.05, "supply_v": 12.0,
         "resistance_ohm": 3.7, "torque_constant": 2.0, "current_limit_a": 2.0}  # fmt: skip
DELAY = {"name": "input_delay", "delay": 0.02}
FIELDS = {"joint_names_expr", "stiffness", "damping", "armature", "friction", "dynamic_friction",
          "viscous_friction", "joint_effort_limit", "actuator_effort_limit",
          "actuator_velocity_limit", "saturation_effort"}  # fmt: skip
"""Of the configurations of Isaac Lab 3.0."""


def configured(made, monkeypatch):
    """What a configuration of Isaac Lab is given: its class and its fields."""
    stub = ModuleType("isaaclab.actuators")
    for name in ("ImplicitActuatorCfg", "DCMotorCfg"):
        setattr(stub, name, lambda name=name, **fields: (name, fields))
    monkeypatch.setitem(sys.modules, "isaaclab", ModuleType("isaaclab"))
    monkeypatch.setitem(sys.modules, "isaaclab.actuators", stub)
    space = {}
    exec(made.files["actuator.py"], space)
    kind, fields = space["JOINT"]
    assert set(fields) <= FIELDS
    return kind, fields


def test_a_joint_of_isaac_lab_has_a_level_of_rest(monkeypatch):
    own = plant(FALLING, drive={"input": "current_a", "gain": 0.5, "limit": 3.0})
    made = own.export("isaaclab", speed=5.0)
    kind, fields = configured(made, monkeypatch)
    assert kind == "ImplicitActuatorCfg"
    assert fields["friction"] == pytest.approx(0.5, rel=0.02)
    assert fields["dynamic_friction"] == pytest.approx(0.3, rel=0.05)
    assert fields["viscous_friction"] == pytest.approx(0.02, rel=0.2)
    assert fields["armature"] == 0.01
    assert fields["joint_effort_limit"] == 1.5
    assert fields["stiffness"] == fields["damping"] == 0.0
    assert not any(each.startswith("break-away") for each in made.lost)
    assert all(f"# - {each}\n" in made.files["actuator.py"] for each in made.lost)
    beside = json.loads(made.files["joint.json"])
    assert st.Plant.from_dict(beside["plant"]).to_dict() == own.to_dict()


def applied(servo, goal, position, velocity):
    """Effort of the servo as docs/servo.md has it."""
    duty = servo["proportional"] * (goal - position) - servo["derivative"] * velocity
    volts = servo["supply_v"] * np.clip(duty, -1.0, 1.0)
    current = (volts - servo["torque_constant"] * velocity) / servo["resistance_ohm"]
    most = servo["current_limit_a"]
    return servo["torque_constant"] * np.clip(current, -most, most)


def pd(fields, goal, position, velocity):
    """What simulators make of stiffness, damping and the curve of a motor."""
    stall, no_load = fields["saturation_effort"], fields["velocity_limit"]
    most = fields["max_motor_effort"]
    asked = fields["kp"] * (goal - position) - fields["kd"] * velocity
    high = np.minimum(stall * (1.0 - velocity / no_load), most)
    low = np.maximum(stall * (-1.0 - velocity / no_load), -most)
    return np.clip(asked, low, high)


def test_a_servo_is_stiffness_damping_and_the_curve_of_its_motor(monkeypatch):
    own = plant(DRY, drive=SERVO)
    kind, fields = configured(own.export("isaaclab"), monkeypatch)
    assert kind == "DCMotorCfg"
    names = {"kp": "stiffness", "kd": "damping", "saturation_effort": "saturation_effort",
             "velocity_limit": "actuator_velocity_limit",
             "max_motor_effort": "actuator_effort_limit"}  # fmt: skip
    given = {name: fields[other] for name, other in names.items()}
    source = np.random.default_rng(3)
    goal, position, velocity = source.uniform(-1.0, 1.0, (3, 500)) * [[2.0], [2.0], [5.0]]
    found = pd(given, goal, position, velocity)
    assert found == pytest.approx(applied(SERVO, goal, position, velocity), abs=1e-12)
    assert np.ptp(found) > 7.9
    told = plant(DRY, DELAY, drive=SERVO | {"integral": 1.0}).export("isaaclab").lost
    assert any("integral" in each for each in told)
    assert any(each.startswith("input_delay:") for each in told)


def test_a_servo_of_newton_has_the_same_numbers_and_its_delay():
    names = ("DrivePD", "ClampingDCMotor")
    stub = SimpleNamespace(
        Axis=SimpleNamespace(Z="z"),
        ModelBuilder=SimpleNamespace(JointDofConfig=lambda **fields: fields),
        actuators=SimpleNamespace(**{name: name for name in names}),
    )
    made = plant(DRY, DELAY, drive=SERVO).export("newton")
    space = {"newton": stub}
    exec(made.files["joint.py"].replace("import newton\n", ""), space)
    assert space["axis"]("x") == {
        "axis": "x",
        "armature": 0.01,
        "friction": pytest.approx(0.3),
        "damping": pytest.approx(0.02),
    }
    asked = {}
    builder = SimpleNamespace(add_actuator=lambda drive, **fields: asked.update(fields))
    space["add_servo"](builder, 4, 1e-3)
    assert asked["index"] == 4
    assert asked["delay_steps"] == 20
    ((_, limits),) = asked["clamping"]
    given = limits | {"kp": asked["kp"], "kd": asked["kd"]}
    for goal, position, velocity in ((1.0, 0.2, 0.5), (0.1, 0.0, -3.0), (-2.0, 0.0, 2.0)):
        assert pd(given, goal, position, velocity) == pytest.approx(
            applied(SERVO, goal, position, velocity)
        )
    assert not any(each.startswith("input_delay") for each in made.lost)
    direct = plant(DRY, DELAY).export("newton")
    assert any(each.startswith("input_delay:") for each in direct.lost)
    assert "add_servo" not in direct.files["joint.py"]


@pytest.mark.parametrize("name", ["urdf", "sdf", "mujoco", "isaaclab", "newton"])
def test_mass_that_a_body_has_to_have_is_told(name):
    body = {"inertia": 0.01, "payload_kg": 0.5, "payload_m": 0.2}
    told = plant(DRY, body=body).export(name).lost
    assert any(each.startswith("a pendulum of 0.98") for each in told)
    twice = [each for each in told if each.startswith("armature beside")]
    assert twice == (
        [] if name in ("urdf", "sdf")
        else ["armature beside a body that has its mass: take off 0.02 kg·m² of the payload"]
    )  # fmt: skip


def joint_of_newton(space, warp, newton, dt, servo=False):
    """A model of one joint without gravity, its solver and states."""
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    inertia = warp.mat33(np.eye(3, dtype=np.float32) * 1e-6)
    link = builder.add_link(mass=1e-3, inertia=inertia)
    joint = builder.add_joint_revolute(-1, link, axis=space["axis"](newton.Axis.Z))
    builder.add_articulation([joint])
    if servo:
        space["add_servo"](builder, 0, dt)
    model = builder.finalize(device="cpu")
    return model, newton.solvers.SolverMuJoCo(model)


@pytest.mark.slow
@pytest.mark.parametrize("drive", [None, SERVO])
def test_newton_goes_as_the_core_does(drive):
    newton, warp = pytest.importorskip("newton"), pytest.importorskip("warp")
    pytest.importorskip("mujoco_warp")
    dt, seconds = 5e-4, 1.0
    own = plant(DRY, *([DELAY] if drive else []), **({"drive": drive} if drive else {}))
    space = {}
    exec(own.export("newton").files["joint.py"], space)
    model, solver = joint_of_newton(space, warp, newton, dt, servo=bool(drive))
    time = dt * np.arange(round(seconds / dt))
    # Before the buffer of a delay is full Newton takes the goal as it is: it begins with none.
    goal = np.where(time < 0.05, 0.0, np.where(np.sin(6.0 * time) > 0.0, 1.0, -0.5))
    inputs = goal if drive else 0.8 * np.sin(9.0 * time)
    state, other, control = model.state(), model.state(), model.control()
    before, after = ([each.state() for each in model.actuators] for _ in range(2))
    velocity = []
    for value in inputs:
        control.joint_f.zero_()
        if drive:
            control.joint_target_q.fill_(float(value))
            for k, actuator in enumerate(model.actuators):
                actuator.step(state, control, before[k], after[k], dt)
            before, after = after, before
        else:
            control.joint_f.fill_(float(value))
        solver.step(state, other, control, None, dt)
        state, other = other, state
        velocity.append(float(state.joint_qd.numpy()[0]))
    core = own.simulate(inputs, dt, outputs=["velocity"]).velocity
    assert np.ptp(core) > 2.0
    assert np.max(np.abs(np.array(velocity) - core)) < 0.03 * np.ptp(core)
