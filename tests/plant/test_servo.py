"""Servos: a goal position makes the effort; compared with a simulation that shares nothing."""

from __future__ import annotations

import numpy as np
import pytest
from tests.reference.servo_reference import Servo

import stiction as st
from stiction.closed_loop import replay
from stiction.fitting.start import complete, with_light_friction
from stiction.residual.effort import free_run
from stiction.residual.loop_form import LoopForm
from stiction.residual.weak_form import WeakForm

DT = 5e-3
PLANT = {
    "drive": {
        "kind": "servo",
        "proportional": 1.2,
        "supply_v": 7.4,
        "resistance_ohm": 3.5,
        "torque_constant": 0.4,
    },
    "body": {"inertia": 0.002, "payload_kg": 0.3, "payload_m": 0.1},
    "friction": {"law": "coulomb", "coulomb": 0.02, "viscous": 0.004},
}


def plant(**drive):
    return st.Plant.from_dict({**PLANT, "drive": {**PLANT["drive"], **drive}})


def goal(rows=800, seed=0):
    t = DT * np.arange(rows)
    rng = np.random.default_rng(seed)
    a, b = rng.uniform(0.6, 1.2, 2)
    return a * np.sin(2.0 * b * t) + 0.4 * np.sign(np.sin(0.9 * t + b))


def recorded(servo, seed, **more):
    target = goal(seed=seed)
    reached = servo.run(target, DT, substeps=100)
    count = 2.0 * np.pi / 4096
    position = np.round(np.concatenate([[0.0], reached[:-1]]) / count) * count
    return st.Recording(DT * np.arange(len(target)), target, position, kind=f"{seed}", **more)


@pytest.mark.long
@pytest.mark.parametrize(
    "change",
    [{}, {"proportional": 4.0}, {"duty_limit": 0.3}, {"current_limit": 0.35}],
    ids=["usual", "stiff", "short of duty", "short of current"],
)
def test_a_loop_follows_the_independent_one(change):
    keys = {"current_limit": "current_limit_a"}
    machine = plant(**{keys.get(name, name): value for name, value in change.items()})
    target = goal()
    run = machine.simulate(target, DT).position
    other = Servo(**change).run(target, DT)
    assert np.max(np.abs(run - other)) < 2e-3 * np.ptp(other)


def test_off_the_arm_swings_free_and_on_it_is_held():
    enabled = np.arange(600) < 300
    target = np.full(600, 1.2)
    run = plant().simulate(target, DT, enabled=enabled).position
    other = Servo().run(target, DT, enabled=enabled)
    # Beside the held stretch the arm falls and swings: phases drift apart a little.
    assert np.max(np.abs(run - other)[:300]) < 2e-3
    assert np.max(np.abs(run - other)) < 0.02
    assert run[299] > 0.6
    assert np.min(run[300:]) < -0.3


def test_a_direct_drive_that_is_off_gives_nothing():
    rows = np.arange(400)
    machine = st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm", "gain": 2.0},
            "body": {"inertia": 0.01},
            "friction": {"law": "coulomb", "coulomb": 0.02},
        }
    )
    motion = 0.1 * np.sin(0.05 * rows)
    off = st.Recording(DT * rows, np.ones(400), motion, enabled=(rows < 200).astype(float))
    form = WeakForm(machine, off)
    assert np.array_equal(form.measured_effort(machine), form.efforts(machine)[0])
    assert np.allclose(form.measured_effort(machine)[form.time > 1.1], 0.0)


def test_an_integral_takes_away_what_the_arm_hangs_short():
    target = np.full(2000, 0.5)
    short = plant().simulate(target, DT).position[-1]
    whole = plant(integral=3.0).simulate(target, DT).position[-1]
    assert short < 0.45
    assert abs(whole - 0.5) < 0.02


def test_a_step_at_a_time_equals_the_run_to_the_bit():
    target = goal(200)
    machine = plant(integral=1.0, derivative=0.01)
    run = machine.simulate(target, DT)
    motor = machine.motor()
    steps = [motor.step(float(u), DT)[0] for u in target]
    assert np.array_equal(steps, run.position)
    assert motor.copy() == motor


def test_derivatives_of_the_loop_are_those_of_differences():
    target = goal(150)
    motor = plant().motor()
    moved, _ = motor.sensitivity(target, DT, ["drive.torque_constant"])

    def end(constant):
        return plant(torque_constant=constant).simulate(target, DT).position

    chord = (end(0.4 + 1e-6) - end(0.4 - 1e-6)) / 2e-6
    assert np.max(np.abs(moved[0] - chord)) < 1e-4 * np.max(np.abs(chord))


def test_settings_of_a_recording_change_gain_and_payload():
    machine = plant()
    settings = {"proportional": 4.0, "payload_kg": 0.5}
    run = free_run(machine, recorded(Servo(proportional=4.0, mass=0.5), 1, settings=settings))
    assert run.mean_absolute < 2e-3
    assert free_run(machine, recorded(Servo(), 1)).mean_absolute < 2e-3


def test_readings_that_failed_are_no_motion_that_a_loop_misses():
    logged = recorded(Servo(), 1)
    spiky = logged.position.copy()
    spiky[[100, 217, 400]] = -3.14
    failed = st.Recording(logged.time, logged.input, spiky)
    assert free_run(plant(), failed).rms < 1.5 * free_run(plant(), logged).rms
    shown = replay(plant(), failed)
    assert np.max(np.abs(shown.measured)) < 3.0


def test_a_fit_finds_the_torque_constant_from_a_known_payload(tmp_path):
    session = [
        recorded(Servo(proportional=gain), seed, role=role, settings={"proportional": gain})
        for seed, (gain, role) in enumerate([(0.6, "train"), (1.2, "train"), (2.4, "test")])
    ]
    begin = st.Plant.from_dict(
        {
            **PLANT,
            "drive": {**PLANT["drive"], "torque_constant": {"value": 0.8, "fixed": False}},
            "body": {**PLANT["body"], "inertia": 0.004},
            "friction": {"law": "coulomb"},
        }
    )
    result = st.fit(begin, session)
    truth = {"drive.torque_constant": 0.4, "body.inertia": 0.002, "friction.coulomb": 0.02}
    for path, value in truth.items():
        assert result.parameters[path].value == pytest.approx(value, rel=0.05), path
    assert free_run(result.plant, session[2]).mean_absolute < 2e-3
    again = st.Plant.load(result.plant.save(tmp_path / "plant.toml"))
    assert (
        again.parameters["drive.torque_constant"]
        == result.plant.parameters["drive.torque_constant"]
    )


@pytest.mark.long
def test_a_goal_that_arrives_late_is_named():
    late = [
        recorded(Servo(late=6), seed, role=role)
        for seed, role in enumerate(["train", "train", "select", "select", "test", "test"])
    ]
    found = st.diagnose(plant(), late, surrogates=8)
    assert found.effects[0].name in ("input_delay", "current_loop_lag")
    assert found.baseline.replay is not None
    assert found.extended.replay.heldout_rms < 0.5 * found.baseline.replay.heldout_rms


DEALT = ["train", "train", "train", "select", "select", "select", "test", "test"]


def session(servo, dealt=DEALT):
    return [recorded(servo, seed, role=role) for seed, role in enumerate(dealt)]


def test_a_goal_moves_no_faster_than_its_limit():
    held_back = {**PLANT, "effects": [{"name": "goal_rate_limit", "slowness": 0.5}]}
    target = goal()
    run = st.Plant.from_dict(held_back).simulate(target, DT).position
    other = Servo(fastest=2.0).run(target, DT)
    assert np.max(np.abs(run - other)) < 2e-3 * np.ptp(other)
    assert np.max(np.abs(plant().simulate(target, DT).position - other)) > 0.1


def test_a_step_at_a_time_holds_the_goal_back_as_the_run_does():
    held_back = {**PLANT, "effects": [{"name": "goal_rate_limit", "slowness": 0.5}]}
    target, machine = goal(200), st.Plant.from_dict(held_back)
    run, motor = machine.simulate(target, DT), machine.motor()
    steps = [motor.step(float(u), DT)[0] for u in target[:90]]
    other = machine.motor()
    other.state = motor.state
    steps += [other.step(float(u), DT)[0] for u in target[90:]]
    assert np.array_equal(steps, run.position)


@pytest.mark.long
def test_a_goal_that_is_held_back_is_named():
    found = st.diagnose(plant(), session(Servo(fastest=2.0)), surrogates=8)
    assert [cause.name for cause in found.effects] == ["goal_rate_limit"]
    (slowness,) = found.effects[0].parameters.values()
    assert slowness.value == pytest.approx(0.5, rel=0.01)
    assert found.extended.replay.heldout_rms < 0.05 * found.baseline.replay.heldout_rms


@pytest.mark.long
def test_two_causes_before_the_drive_are_told_apart():
    found = st.diagnose(plant(), session(Servo(fastest=2.0, late=6)), surrogates=8)
    assert {cause.name for cause in found.effects} == {"goal_rate_limit", "input_delay"}
    assert found.verdict == "missing_effect"


@pytest.mark.long
@pytest.mark.parametrize("seed", range(3))
def test_a_servo_that_lacks_nothing_gets_no_name(seed):
    machine = Servo(proportional=1.2, coulomb=0.01 * (1 + seed), inertia=0.001 * (1 + seed))
    free = st.Plant.from_dict(
        {
            **PLANT,
            "drive": {**PLANT["drive"], "torque_constant": {"value": 0.6, "fixed": False}},
            "body": {**PLANT["body"], "inertia": 0.003},
            "friction": {"law": "coulomb"},
        }
    )
    found = st.diagnose(free, session(machine), surrogates=8)
    assert found.verdict == "nothing_missing", found.sentence


@pytest.mark.long
def test_gear_losses_are_named():
    found = st.diagnose(plant(), session(Servo(gear_loss=0.3)), surrogates=8)
    assert [cause.name for cause in found.effects] == ["load_dependent_friction"]


@pytest.mark.slow
def test_fit_and_diagnosis_of_a_servo_end_in_the_same_machine():
    free = plant(torque_constant={"value": 0.6, "fixed": False})
    dealt = ["train", "train", "train", "test"]
    found = st.diagnose(free, session(Servo(gear_loss=0.3), dealt), surrogates=4, without=[])
    fitted = st.fit(free, session(Servo(gear_loss=0.3), dealt))
    for path, own in fitted.parameters.items():
        assert found.baseline.parameters[path].value == own.value, path


def test_signatures_of_a_loop_are_those_of_differences():
    recording = recorded(Servo(), 3)
    machine = plant()
    form = LoopForm(machine, recording)
    shapes = [
        ("cogging", {"order": 3.0}),
        ("cogging", {"order": 5.0}),
        ("torque_constant_saturation", {"input": 7.4}),
        ("input_delay", {}),
    ]
    found = form.signatures(machine, shapes)
    gains = ["cosine", "sine", "cosine", "sine", "loss", "delay"]
    owners = [0, 0, 1, 1, 2, 3]
    for k, (gain, owner) in enumerate(zip(gains, owners, strict=True)):
        name, shape = shapes[owner]
        size = 1e-5
        there = st.Plant.from_dict({**PLANT, "effects": [{"name": name, gain: size, **shape}]})
        chord = (form.residual(there) - form.residual(machine)) / size
        assert np.max(np.abs(found[:, k] - chord)) < 0.02 * np.max(np.abs(chord)), gain


def test_only_a_servo_has_a_goal():
    machine = st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm", "gain": 1.0},
            "body": {"inertia": 0.01},
            "friction": {"law": "coulomb", "coulomb": 0.02},
        }
    )
    rng = np.random.default_rng(5)
    recordings = []
    for role in ("train", "select", "test"):
        push = np.repeat(rng.normal(0.0, 0.05, 60), 20)
        run = machine.simulate(push, DT).position
        reached = np.concatenate([[0.0], run[:-1]])
        recordings.append(st.Recording(DT * np.arange(1200), push, reached, role=role))
    found = st.diagnose(machine, recordings, surrogates=4)
    (row,) = [row for row in found.candidates if row.name == "goal_rate_limit"]
    assert row.reason == "only a servo has a goal"


@pytest.mark.parametrize(
    ("table", "told"),
    [
        ({"drive": {"kind": "servo"}}, "proportional is missing"),
        ({"drive": {**PLANT["drive"], "gain": 2.0}}, "'gain' is unknown"),
        ({"drive": {**PLANT["drive"], "resistance_ohm": -1.0}}, "resistance"),
        (
            {
                "drive": {**PLANT["drive"], "torque_constant": {"value": 0.4}},
                "body": {"inertia": 0.01},
            },
            "scale with it",
        ),
        ({"body": {"inertia": 0.01, "payload_kg": -1.0}}, "payload_kg"),
        (
            {"controller": {"kind": "pd", "kp": 2.0}},
            r"\[controller\] goes with an input .* a servo closes its loop itself; leave it out",
        ),
        *(
            ({"body": {"payload_kg": {"value": 2.0, **more}, "payload_m": 0.1}}, f"kg: {told} goes")
            for more, told in (
                ({"min": 1.0, "max": 3.0, "fixed": False}, "min, max, fixed = false"),
                ({"fixed": False}, "fixed = false"),
                ({"max": 3.0, "fixed": True}, "max"),
            )
        ),
        ({"body": {"inertia": 0.01, "payload_kg": 1.0}}, "payload_kg is stated without payload_m"),
        *(
            ({"drive": {**PLANT["drive"], name: 0.0}}, f"{name} = 0 ")
            for name in (
                "proportional",
                "supply_v",
                "resistance_ohm",
                "current_limit_a",
                "duty_limit",
            )
        ),
        # A derivative acts on the velocity alone: without the others the goal does nothing.
        ({"drive": {**PLANT["drive"], "proportional": 0.0, "derivative": 1.0}}, "moves nothing"),
        ({"drive": {**PLANT["drive"], "resistance_ohm": 1e300}}, r"resistance_ohm = 1e\+300 is"),
        *(
            ({"drive": {**PLANT["drive"], name: -0.5}}, f"{name} = -0.5 drives away from the goal")
            for name in ("proportional", "integral", "derivative")
        ),
    ],
)
def test_a_servo_that_cannot_be_is_refused(table, told):
    with pytest.raises(st.InputError, match=told):
        st.Plant.from_dict({**PLANT, **table})


def test_a_payload_may_be_written_as_a_table():
    body = {"inertia": 0.01, "payload_kg": {"value": 2.0}, "payload_m": {"value": 0.1}}
    made = st.Plant.from_dict({**PLANT, "body": body})
    assert made.payload == st.Plant.from_dict(made.to_dict()).payload
    assert made.payload[0] == pytest.approx(0.02)
    assert made.body["payload_kg"].fixed


def test_an_integral_alone_moves_a_servo():
    assert plant(proportional=0.0, integral=1.0).simulate(np.ones(200), DT).position[-1] > 0.0


def test_settings_of_a_recording_under_which_nothing_moves_are_refused():
    for name in ("proportional", "supply_v"):
        with pytest.raises(st.InputError, match=f"set for a recording: {name} = 0 "):
            plant().under({name: 0.0})
    bare = st.Plant.from_dict({**PLANT, "body": {"inertia": 0.002}})
    with pytest.raises(st.InputError, match="payload_kg is stated without payload_m"):
        bare.under({"payload_kg": 0.3})
    assert bare.under({"payload_kg": 0.3, "payload_m": 0.1}).payload == plant().payload


def test_settings_that_are_none_are_refused():
    rows = np.arange(300.0)
    with pytest.raises(st.InputError, match="no setting 'kp'"):
        st.Recording(rows, rows, rows, settings={"kp": 3.0})
    with pytest.raises(st.InputError, match="only a servo has it"):
        st.Plant.from_dict({"friction": {"law": "coulomb"}}).under({"proportional": 1.0})


def test_a_second_start_holds_a_servo_by_a_tenth_of_its_effort_but_for_what_is_stated():
    """A regression of a guessed effort may give no friction at all, and a fit starts from there."""
    silent = st.Plant.from_dict({**PLANT, "friction": {"law": "coulomb"}})
    forms = [WeakForm(silent, recorded(Servo(), seed)) for seed in range(2)]
    whole = complete(silent, forms)[0]
    level = np.sqrt(np.mean(np.concatenate([form.measured_effort(whole) for form in forms]) ** 2))
    speed = np.sqrt(np.mean(np.concatenate([form.velocity for form in forms]) ** 2))
    begun = with_light_friction(silent, whole, forms).parameters
    assert begun["friction.coulomb"].value == pytest.approx(0.1 * level)
    assert begun["friction.viscous"].value == pytest.approx(0.1 * level / speed)
    half = st.Plant.from_dict({**PLANT, "friction": {"law": "coulomb", "viscous": 0.004}})
    begun = with_light_friction(half, complete(half, forms)[0], forms).parameters
    assert begun["friction.coulomb"].value == pytest.approx(0.1 * level)
    assert begun["friction.viscous"].value == 0.004
