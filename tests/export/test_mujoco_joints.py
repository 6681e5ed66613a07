"""Joints of MuJoCo with the friction of a plant: its forces, its rest, its state."""

import json
import pickle

import numpy as np
import pytest

import stiction as st

mujoco = pytest.importorskip("mujoco")
from stiction.mujoco import attach, patch, step  # noqa: E402

DT = 1e-3
ONE = """
<mujoco><option timestep="{dt}" integrator="{integrator}" gravity="0 0 0"/>
<worldbody><body><joint name="j" type="{kind}" axis="0 0 1" armature="0.01" {more}/>
<inertial pos="0 0 0" mass="1e-12" diaginertia="1e-12 1e-12 1e-12"/></body></worldbody>
<actuator><motor joint="j"/></actuator></mujoco>
"""
ARM = """
<mujoco><option timestep="1e-3" integrator="implicitfast"/>
<worldbody><body><joint name="a" type="hinge" axis="0 1 0"/>
<geom type="capsule" fromto="0 0 0 .4 0 0" size=".03" mass="2"/>
<body pos=".4 0 0"><joint name="b" type="hinge" axis="0 1 0"/>
<geom type="capsule" fromto="0 0 0 .3 0 0" size=".02" mass="1"/></body></body></worldbody>
<actuator><motor joint="a"/><motor joint="b"/></actuator></mujoco>
"""


def plant(law="coulomb", effects=(), **numbers):
    table = {
        "drive": {"input": "torque_nm", "gain": 1.0},
        "body": {"inertia": 0.01},
        "friction": {"law": law, **numbers},
        "effects": list(effects),
    }
    return st.Plant.from_dict(table)


def one(integrator="Euler", kind="hinge", more="", dt=DT):
    return mujoco.MjModel.from_xml_string(
        ONE.format(integrator=integrator, kind=kind, more=more, dt=dt)
    )


def efforts(seed=1):
    return np.repeat(np.random.default_rng(seed).uniform(-0.8, 0.8, 24), 25)


def driven(model, joint, given, data=None):
    data = mujoco.MjData(model) if data is None else data
    velocities = []
    for effort in given:
        data.ctrl[0] = effort
        step(model, data, [joint])
        velocities.append(float(data.qvel[0]))
    return np.array(velocities)


@pytest.mark.parametrize("law", [each.name for each in st.laws()])
def test_every_law_goes_as_its_motor(law):
    model = one("implicitfast")
    joint = attach(model, "j", plant(law))
    own = plant(law).motor().simulate(efforts(), DT)
    found = driven(model, joint, efforts())
    assert np.ptp(own.velocity) > 0.0
    # Bristles break one by one: once one breaks a sample later, nothing is the same any more.
    same = slice(0, 100 if law == "bristle" else None)
    off = np.abs(found - own.velocity)[same]
    assert np.max(off) < 1e-8 * np.max(np.abs(own.velocity))
    assert joint.friction == pytest.approx(own.friction[-1], rel=0.2, abs=0.1)


@pytest.mark.parametrize(
    "effect",
    [
        {"name": "cogging", "cosine": 0.04, "order": 6.0},
        {"name": "direction_asymmetry", "coulomb": 0.2},
        {"name": "dwell_strengthening", "strength": 0.3, "time": 0.02},
        {"name": "viscous_quadratic", "quadratic": 0.05},
    ],
)
def test_effects_at_the_contact_act(effect):
    model, own = one(), plant("coulomb", [effect], viscous=0.01)
    joint = attach(model, "j", own)
    run = own.motor().simulate(efforts(), DT)
    assert joint.lost == ()
    off = np.abs(driven(model, joint, efforts()) - run.velocity)
    # MuJoCo puts the body elsewhere by its own step: what goes with the position differs.
    assert np.max(off) < 0.02 * np.max(np.abs(run.velocity))


@pytest.mark.parametrize(
    "own",
    [
        plant("load_dependent", coulomb=0.1, drive=0.2, back_drive=0.4),
        plant("dahl", [{"name": "load_dependent_friction", "drive": 0.3, "back_drive": 0.6}]),
    ],
)
def test_what_no_motor_gives_loads_the_contact(own):
    model = one("implicitfast")
    joint = attach(model, "j", own)
    loads = 0.3 * np.sin(0.02 * np.arange(len(efforts())))
    data, velocities = mujoco.MjData(model), []
    for effort, load in zip(efforts(), loads, strict=True):
        data.ctrl[0], data.qfrc_applied[0] = effort, load
        step(model, data, [joint])
        velocities.append(float(data.qvel[0]))
    run = own.motor().simulate(efforts(), DT, load=loads)
    unloaded = own.motor().simulate(efforts() + loads, DT)
    greatest = np.max(np.abs(run.velocity))
    assert np.max(np.abs(unloaded.velocity - run.velocity)) > 0.05 * greatest
    assert np.max(np.abs(velocities - run.velocity)) < 1e-8 * greatest


def test_a_joint_at_half_its_level_rests_to_the_last_bit_where_frictionloss_creeps():
    own, native = one(), one(more='frictionloss="0.35"')
    joint = attach(own, "j", plant("coulomb", coulomb=0.35))
    data = mujoco.MjData(own)
    data.qpos[0] = 0.123
    assert not np.any(driven(own, joint, np.full(2000, 0.175), data))
    assert data.qpos[0] == 0.123
    assert joint.friction == pytest.approx(0.175, abs=1e-12)
    creeping = mujoco.MjData(native)
    creeping.ctrl[0] = 0.175
    for _ in range(2000):
        mujoco.mj_step(native, creeping)
    assert abs(creeping.qpos[0]) > 1e-6


def test_an_arm_that_its_friction_bears_rests_and_one_that_falls_loses_energy():
    model, data = mujoco.MjModel.from_xml_string(ARM), None
    for level, rests in ((30.0, True), (4.0, False)):
        data = mujoco.MjData(model)
        joints = [
            attach(model, name, plant(coulomb=share * level), armature=False)
            for name, share in (("a", 1.0), ("b", 0.3))
        ]
        mujoco.mj_energyPos(model, data)
        energies = []
        for _ in range(3000):
            step(model, data, joints)
            mujoco.mj_energyPos(model, data)
            mujoco.mj_energyVel(model, data)
            energies.append(float(np.sum(data.energy)))
        if rests:
            assert not np.any(data.qpos)
            assert not np.any(data.qvel)
        else:
            assert np.max(np.diff(energies)) < 1e-3 * np.ptp(energies)
            assert np.max(np.abs(data.qvel)) < 1e-6
            assert np.pi / 4 < data.qpos[0] < np.pi


def test_a_state_goes_on_to_the_bit():
    model, given = one(), efforts(3)
    joint = attach(model, "j", plant("hsieh_pan", breakaway=0.4, coulomb=0.3))
    data = mujoco.MjData(model)
    driven(model, joint, given[:300], data)
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_INTEGRATION)
    kept = np.empty(size)
    mujoco.mj_getState(model, data, kept, mujoco.mjtState.mjSTATE_INTEGRATION)
    state = pickle.loads(pickle.dumps(joint.state))
    other = joint.copy()
    straight = driven(model, joint, given[300:], data)
    for again in (other, attach(model, "j", plant("hsieh_pan", breakaway=0.4, coulomb=0.3))):
        mujoco.mj_setState(model, data, kept, mujoco.mjtState.mjSTATE_INTEGRATION)
        again.state = state
        assert np.array_equal(driven(model, again, given[300:], data), straight)
    joint.reset()
    assert joint.state["path"] == 0.0


def test_what_does_not_act_is_told():
    model = one()
    hanging = st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm", "gain": 1.0},
            "body": {"inertia": 0.01, "gravity_amplitude": 0.3},
            "friction": {"law": "coulomb"},
            "effects": [{"name": "input_delay", "delay": 0.01}],
        }
    )
    joint = attach(model, "j", hanging)
    assert any(each.startswith("input_delay:") for each in joint.lost)
    assert any("gravity" in each for each in joint.lost)
    assert model.dof_armature[0] == 0.01
    json.dumps(joint.lost)


def test_a_slide_has_a_linear_plant():
    model = one(kind="slide")
    linear = st.Plant.from_dict(
        {
            "motion": {"kind": "linear"},
            "drive": {"input": "force_n", "gain": 1.0},
            "body": {"inertia": 0.01},
            "friction": {"law": "coulomb", "coulomb": 0.35},
        }
    )
    joint = attach(model, "j", linear)
    own = linear.motor().simulate(efforts(), DT)
    assert driven(model, joint, efforts()) == pytest.approx(own.velocity, abs=1e-8)


def test_joints_that_cannot_be_are_refused():
    for model, name, words in (
        (one(), "k", "there are j"),
        (one("RK4"), "j", "RK4"),
        (mujoco.MjModel.from_xml_string(ARM.replace('"hinge" axis="0 1 0"/>', '"ball"/>', 1)
            .replace('<motor joint="a"/>', "")), "a", "no hinge"),
    ):  # fmt: skip
        with pytest.raises(st.InputError, match=words):
            attach(model, name, plant())
    with pytest.raises(st.InputError, match="plant"):
        attach(one(), "j", "plant.toml")
    stiff = attach(one(dt=10.0), "j", plant("lugre"))
    with pytest.raises(st.InputError, match="too long"):
        driven(one(dt=10.0), stiff, [0.1])


def test_data_that_is_reset_begins_with_a_contact_that_never_moved():
    model = one()
    joint, data = attach(model, "j", plant("dahl")), mujoco.MjData(model)
    first = driven(model, joint, efforts(), data)
    mujoco.mj_resetData(model, data)
    assert np.array_equal(driven(model, joint, efforts(), data), first)


def test_a_state_that_is_put_back_with_its_data_goes_on():
    model = one()
    joint, data = attach(model, "j", plant("dahl")), mujoco.MjData(model)
    driven(model, joint, efforts()[:200], data)
    kept, state = mujoco.MjData(model), joint.state
    mujoco.mj_copyData(kept, model, data)
    whole = driven(model, joint, efforts()[200:], data)
    mujoco.mj_copyData(data, model, kept)
    joint.state = state
    assert np.array_equal(driven(model, joint, efforts()[200:], data), whole)


def test_a_joint_of_other_data_is_refused():
    model = one()
    joint, own, other = attach(model, "j", plant()), mujoco.MjData(model), mujoco.MjData(model)
    driven(model, joint, [0.5], own)
    with pytest.raises(st.InputError, match=r"another MjData.*joint\.copy\(\)"):
        driven(model, joint, [0.5], other)
    step(model, other, joint.copy())


@pytest.mark.parametrize("kind", ["slide", "ball"])
def test_a_plant_that_turns_is_refused_by_what_does_not(kind):
    xml = ONE.format(integrator="Euler", kind=kind, more="", dt=DT)
    if kind == "ball":
        xml = xml.replace('<actuator><motor joint="j"/></actuator>', "")
    spec = mujoco.MjSpec.from_string(xml)
    for call in (lambda: attach(spec.compile(), "j", plant()), lambda: patch(spec, "j", plant())):
        with pytest.raises(st.InputError, match=r"is a slide, and .* is rotary|no hinge and no"):
            call()
