"""What targets keep of a plant: run on recordings of a machine that is known."""

import json
import shutil
import sys

import numpy as np
import pytest

import stiction as st
from stiction.cli import run
from stiction.export import Export

DT = 1e-3
COUNTS = 2**18
DRY = {"law": "coulomb", "coulomb": 0.3, "viscous": 0.02}
COGGING = {"name": "cogging", "cosine": 0.08, "order": 5.0}
BIAS = {"name": "torque_bias", "bias": 0.06}


def plant(friction=DRY, *effects, **tables):
    return st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm", "gain": 1.0},
            "body": {"inertia": 0.01},
            "friction": friction,
            "effects": list(effects),
            "sensor": {"counts_per_rev": COUNTS},
        }
        | tables
    )


def recording(machine, seed, role, seconds=6.0):
    """Sums of sines that turn the machine round, read by its encoder."""
    source, n = np.random.default_rng(seed), round(seconds / DT)
    time = DT * np.arange(n)
    waves = zip(source.uniform(0.5, 6.0, 4), source.uniform(0.0, 6.0, 4), strict=True)
    effort = 0.3 * sum(np.sin(rate * 2.0 * np.pi * time + phase) for rate, phase in waves)
    moved = machine.simulate(effort, DT, outputs=["position"]).position
    count = 2.0 * np.pi / COUNTS
    read = np.round(np.concatenate([[0.0], moved[:-1]]) / count) * count
    return st.Recording(time, effort, read, role=role, kind=f"{seed}")


def session(machine, **keywords):
    roles = ("train", "train", "test")
    return st.Session([recording(machine, k, role, **keywords) for k, role in enumerate(roles)])


@pytest.fixture(scope="module")
def cogged():
    machine = plant(DRY, COGGING)
    return machine, session(machine)


def shares(found):
    return [each.share for each in found.runs]


def test_mujoco_lacks_what_it_says_and_its_callback_has_it():
    pytest.importorskip("mujoco")
    machine = plant(DRY, BIAS)
    made = machine.export("mujoco", speed=10.0)
    assert any(sentence.startswith("torque_bias:") for sentence in made.lost)
    found = made.check(session(machine))
    native, callback = shares(found)
    assert native < 0.5
    assert callback > 0.99
    assert found.without > 2.0 * found.whole
    assert "of the gain; with the callback" in found.message
    assert found.message.startswith("mujoco keeps ")


LUGRE = {"law": "lugre", "coulomb": 0.3, "breakaway": 0.4, "initial_stiffness": 60.0,
         "damping": 0.3, "viscous": 0.02}  # fmt: skip
LATE = {"name": "input_delay", "delay": 0.012}


@pytest.mark.parametrize("effects", [(COGGING,), (COGGING, LATE), (LATE,)])
@pytest.mark.parametrize("friction", [DRY, LUGRE])
def test_mujoco_keeps_what_its_own_elements_hold(friction, effects):
    pytest.importorskip("mujoco")
    machine = plant(friction, *effects)
    native, callback = shares(machine.export("mujoco").check(session(machine)))
    assert native > 0.97
    assert callback > 0.97


@pytest.mark.parametrize("target", ["urdf", "sdf"])
def test_a_joint_keeps_nothing_of_a_cogging(cogged, target):
    machine, recorded = cogged
    (share,) = shares(machine.export(target).check(recorded))
    assert abs(share) < 0.3


def test_curves_keep_a_cogging(cogged):
    machine, recorded = cogged
    (table,) = shares(machine.export("table").check(recorded))
    assert table > 0.98
    if shutil.which("cc") is None:
        pytest.skip("no C compiler is installed")
    code, stepped = shares(machine.export("c").check(recorded))
    # It has more points than the table.
    assert code > max(table, 0.998)
    assert stepped > 0.999


REMEMBERED = {"name": "dwell_strengthening", "strength": 0.3, "time": 0.5}


@pytest.mark.parametrize("friction", [DRY, LUGRE])
@pytest.mark.parametrize("tables", [{}, {"body": {"inertia": 0.01, "gravity_amplitude": 0.1}}])
def test_c_is_run_step_by_step_beside_its_curves(friction, tables):
    if shutil.which("cc") is None:
        pytest.skip("no C compiler is installed")
    machine = plant(friction, COGGING, REMEMBERED, **tables)
    found = machine.export("c").check(session(machine))
    curves, stepped = found.runs
    assert [curves.name, stepped.name] == ["", "step by step"]
    # Its step is the plant's, but for turns inside a sample; curves know no pre-sliding.
    assert stepped.error < 2.0 * found.whole
    assert stepped.error < 0.5 * curves.error
    assert "; step by step " in found.message


def test_rust_keeps_what_the_c_keeps(cogged):
    if shutil.which("cc") is None or shutil.which("cargo") is None:
        pytest.skip("no C compiler or no cargo is installed")
    machine, recorded = cogged
    try:
        (rust,) = machine.export("rust").check(recorded).runs
    except st.InputError as error:
        pytest.skip(f"{error}")
    code, _ = machine.export("c").check(recorded).runs
    assert rust.error == pytest.approx(code.error, rel=1e-9)


def test_an_fmu_keeps_all_of_a_cogging(cogged):
    if shutil.which("cc") is None:
        pytest.skip("no C compiler is installed")
    machine, recorded = cogged
    (share,) = shares(machine.export("fmu").check(recorded))
    assert share > 0.999


def test_what_is_lost_in_writing_shows(cogged):
    # A file with another number in it is run as it stands.
    machine, recorded = cogged
    made = machine.export("table")
    table = json.loads(made.files["table.json"])
    table["position"]["effort"] = [0.0] * len(table["position"]["effort"])
    spoiled = Export("table", {**made.files, "table.json": json.dumps(table)}, plant=machine)
    (share,) = shares(spoiled.check(recorded))
    assert abs(share) < 0.3


def test_a_plant_without_effects_has_both_errors_and_no_share():
    machine = plant()
    found = machine.export("urdf").check(session(machine))
    assert shares(found) == [None]
    assert found.without is None
    # All that it has is in the joint.
    assert found.runs[0].error == pytest.approx(found.whole, rel=0.2)
    assert "of the gain" not in found.message
    assert "where the plant has" in found.message


def test_effects_that_gain_nothing_are_told(cogged):
    wrong = plant(DRY, {"name": "torque_bias", "bias": 1e-6})
    found = wrong.export("urdf").check(session(plant()))
    assert shares(found) == [None]
    assert "its effects gain nothing on these rows" in found.message


def test_a_contact_that_yields_is_led_to_where_its_windows_begin():
    pytest.importorskip("mujoco")
    soft = {"law": "dahl", "coulomb": 0.3, "initial_stiffness": 60.0, "exponent": 1.0}
    machine = plant(soft, BIAS)
    native, callback = shares(machine.export("mujoco").check(session(machine)))
    assert callback > 0.99
    assert native < 0.9
    (share,) = shares(machine.export("fmu").check(session(machine)))
    assert share > 0.99


def test_gravity_is_given_to_the_bodies_of_a_simulator():
    pytest.importorskip("mujoco")
    body = {"inertia": 0.01, "gravity_amplitude": 0.4, "gravity_zero_rad": 0.3}
    machine = plant(DRY, body=body)
    found = machine.export("mujoco").check(session(machine))
    # Nothing is missing but what its time step of 1 ms and its soft constraint do.
    assert all(0.0 < each.error < 0.02 for each in found.runs)
    assert found.runs[1].error < 0.004


SERVO = {
    "kind": "servo", "proportional": 3.0, "supply_v": 12.0, "resistance_ohm": 3.7,
    "torque_constant": 2.0,
}  # fmt: skip
HANGING = {"inertia": 0.015, "payload_kg": 0.8, "payload_m": 0.1}
LATE = ({"name": "input_delay", "delay": 0.03}, {"name": "goal_rate_limit", "slowness": 0.2})
GEAR = {"name": "load_dependent_friction", "drive": 0.2, "back_drive": 0.4}


@pytest.fixture(scope="module")
def servo():
    """An arm on a servo, its logs as such servos give them: uneven, other gains, let go of."""
    friction = {"law": "coulomb", "coulomb": 0.1, "viscous": 0.01}
    own = plant(friction, *LATE, GEAR, drive=SERVO, body=HANGING, sensor={"counts_per_rev": 4096})
    logs = []
    for seed, (gain, role) in enumerate(((3.0, "train"), (1.5, "train"), (2.0, "test"))):
        source = np.random.default_rng(seed)
        time = 0.01 * (np.arange(500) + 0.2 * source.uniform(size=500))
        goal = np.where(time < 1.0, 0.0, 0.8 * np.sin((3.0 + seed) * (time - 1.0)))
        enabled = (time < 4.0).astype(float)
        told = st.Plant.from_dict(own.to_dict() | {"drive": {**SERVO, "proportional": gain}})
        moved = told.simulate(goal[:-1], np.diff(time), enabled=enabled[:-1]).position
        count = 2.0 * np.pi / 4096
        read = np.round(np.concatenate([[0.0], moved]) / count) * count
        kept = {"enabled": enabled, "settings": {"proportional": gain}, "role": role}
        logs.append(st.Recording(time, goal, read, kind=f"{seed}", **kept))
    return own, st.Session(logs)


def test_a_servo_moves_by_its_goal_from_the_start_of_a_recording_to_its_end(servo):
    shutil.which("cc") or pytest.skip("no C compiler is installed")
    own, recorded = servo
    found = own.export("fmu").check(recorded)
    assert found.of == "position over whole recordings, by the goal alone"
    assert found.unit == "rad"
    # Nothing is left but the counts of the encoder: the FMU is the plant.
    assert found.whole < 2.0 * np.pi / 4096
    assert found.runs[0].error == pytest.approx(found.whole, rel=1e-4)
    assert found.without > 10.0 * found.whole
    assert shares(found)[0] > 0.9999


def test_friction_that_goes_with_the_load_is_in_the_callback_of_a_servo(servo):
    pytest.importorskip("mujoco")
    own, recorded = servo
    native, with_callback = shares(own.export("mujoco").check(recorded))
    assert with_callback > 0.98
    assert native < with_callback


@pytest.mark.parametrize("target", ["c", "table", "urdf"])
def test_a_curve_says_nothing_of_a_servo(servo, target):
    own, recorded = servo
    with pytest.raises(st.InputError, match=f"{target} is not run for a servo: .* nobody measured"):
        own.export(target).check(recorded)


def test_a_package_or_compiler_that_is_missing_is_a_sentence(cogged, monkeypatch):
    machine, recorded = cogged
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(st.InputError, match="pip install mujoco"):
        machine.export("mujoco").check(recorded)
    monkeypatch.setattr(shutil, "which", lambda _: None)
    with pytest.raises(st.InputError, match="there is no cargo"):
        machine.export("rust").check(recorded)
    with pytest.raises(st.InputError, match="there is no C compiler"):
        machine.export("c").check(recorded)


def test_nothing_held_out_is_refused():
    machine = plant()
    with pytest.raises(st.InputError, match="nothing of it is held out"):
        machine.export("urdf").check(recording(machine, 0, None, seconds=3.0))
    with pytest.raises(st.InputError, match="knows no plant"):
        Export("urdf", {}).check(session(machine))


def test_the_command_checks_and_says_what_it_could_not(cogged, tmp_path, capsys, monkeypatch):
    machine, recorded = cogged
    machine.save(tmp_path / "plant.toml")
    lines = ['plant = "plant.toml"']
    for k, each in enumerate(recorded):
        rows = np.column_stack([each.time, each.input, each.position])
        head = "time_s,torque_nm,position_rad"
        np.savetxt(tmp_path / f"{k}.csv", rows, delimiter=",", header=head, comments="")
        lines += ["[[recordings]]", f'file = "{k}.csv"', f'role = "{each.role}"', f'kind = "{k}"']
    (tmp_path / "session.toml").write_text("\n".join(lines))
    monkeypatch.setitem(sys.modules, "mujoco", None)
    asked = ["export", str(tmp_path / "plant.toml"), "--to", "urdf", "--to", "mujoco", "--check",
             str(tmp_path / "session.toml"), "-o", str(tmp_path / "out")]  # fmt: skip
    assert run(asked) == 0
    said = capsys.readouterr().out
    assert "urdf keeps " in said
    assert "mujoco: not checked: stiction.mujoco: MuJoCo is missing" in said
    assert run([*asked, "--json"]) == 0
    urdf, mujoco = json.loads(capsys.readouterr().out)
    assert abs(urdf["check"]["runs"][0]["share"]) < 0.3
    assert "missing" in mujoco["check"]["error"]
