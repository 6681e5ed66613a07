"""Each target is run or read again, against the plant that it was made of."""

import ctypes
import json
import re
import shutil
import subprocess
import xml.etree.ElementTree as ET

import numpy as np
import pytest

import stiction as st
from stiction.cli import run
from stiction.export import targets
from stiction.export.points import few_points

from .test_steady import plant

DRY = {"law": "coulomb", "coulomb": 0.3, "viscous": 0.02}
FALLING = {"law": "lugre", "coulomb": 0.3, "breakaway": 0.5, "viscous": 0.02}
COGGING = {"name": "cogging", "cosine": 0.04, "sine": 0.02, "order": 6.0}
UNEVEN = {"name": "direction_asymmetry", "coulomb": 0.1}


@pytest.fixture
def sources_alone(monkeypatch):
    """Sources say what is held: binaries of all of them would take long."""
    monkeypatch.setattr("stiction.export.fmu_archive.compiler", lambda: None)


@pytest.mark.usefixtures("sources_alone")
@pytest.mark.parametrize("name", targets())
@pytest.mark.parametrize("law", [each.name for each in st.laws()])
def test_every_law_goes_to_every_target(law, name, tmp_path):
    made = plant({"law": law}).export(name)
    assert made.held
    assert [path.name for path in made.save(tmp_path)] == list(made.files)
    assert all((tmp_path / each).read_bytes() for each in made.files)
    json.dumps(made.to_dict(), allow_nan=False)


@pytest.mark.usefixtures("sources_alone")
@pytest.mark.parametrize("name", targets())
@pytest.mark.parametrize("effect", [each.name for each in st.effects()])
def test_no_effect_is_dropped_in_silence(effect, name):
    record = effect_record(effect)
    if record.impossible("rotary", servo=False):
        pytest.skip("there is no such plant")
    typical = {p.name: p.typical for p in record.parameters}
    made = plant(DRY, {"name": effect, **typical}).export(name)
    told = [each for each in made.lost if each.startswith(f"{effect}:")]
    base = plant(DRY).export(name)
    changed = {k: v for k, v in made.files.items() if v != base.files[k] and k != "joint.json"}
    assert told or changed


def effect_record(name):
    return next(each for each in st.effects() if each.name == name)


@pytest.mark.parametrize("name", ["urdf", "sdf"])
def test_dynamics_are_read_again(name):
    made = plant(DRY, COGGING).export(name)
    root = ET.fromstring(made.files[f"joint.{name}"])
    dynamics = next(root.iter("dynamics"))
    numbers = dynamics.attrib or {each.tag: each.text for each in dynamics}
    assert float(numbers["friction"]) == pytest.approx(0.3, rel=1e-9)
    assert float(numbers["damping"]) == pytest.approx(0.02, rel=1e-9)
    beside = json.loads(made.files["joint.json"])
    assert st.Plant.from_dict(beside["plant"]).to_dict() == plant(DRY, COGGING).to_dict()
    assert any(each.startswith("cogging:") for each in beside["lost"])


def test_a_joint_tells_by_how_much_its_curve_is_off():
    made = plant(FALLING, UNEVEN).export("urdf", speed=2.0)
    text = " / ".join(made.lost)
    assert "break-away: 0.50" in text
    assert "friction of the two directions differs by 0.0" in text
    assert "pre-sliding" in text


def test_mujoco_goes_as_the_plant_does():
    mujoco = pytest.importorskip("mujoco")
    made = plant(DRY, drive={"input": "current_a", "gain": 0.5, "limit": 3.0}).export("mujoco")
    model = mujoco.MjModel.from_xml_string(made.files["joint.xml"])
    model.opt.timestep = 1e-4
    data = mujoco.MjData(model)
    own = st.Motor(0.01, 0.5, st.FrictionModel("coulomb", coulomb=0.3, viscous=0.02))
    current = 2.0 + np.sin(np.arange(5000) * 2e-3)
    run_of = own.simulate(current, 1e-4, outputs=["position", "velocity"])
    velocity = []
    for value in current:
        data.ctrl[0] = value
        mujoco.mj_step(model, data)
        velocity.append(data.qvel[0])
    assert np.ptp(run_of.velocity) > 1.0
    assert np.max(np.abs(np.array(velocity) - run_of.velocity)) < 0.02 * np.ptp(run_of.velocity)


@pytest.mark.parametrize(
    ("real", "kind", "near"), [("double", ctypes.c_double, 1e-12), ("float", ctypes.c_float, 1e-5)]
)
def test_c_compiles_without_a_warning_and_is_the_plant(real, kind, near, tmp_path):
    compiler = shutil.which("cc") or pytest.skip("no C compiler is installed")
    own = plant(DRY, COGGING, UNEVEN, body={"inertia": 0.01, "gravity_amplitude": 0.2})
    made = own.export("c")
    made.save(tmp_path)
    built = tmp_path / "feedforward.so"
    flags = [
        "-std=c99",
        "-O2",
        "-Wall",
        "-Wextra",
        "-Wpedantic",
        "-Werror",
        f"-DSTICTION_REAL={real}",
    ]
    source = str(tmp_path / "stiction_feedforward.c")
    subprocess.run([compiler, *flags, "-shared", "-fPIC", source, "-o", str(built)], check=True)
    library = ctypes.CDLL(str(built))
    for name, given in (("friction", 1), ("place", 1), ("feedforward", 3), ("input", 1)):
        function = getattr(library, f"stiction_{name}")
        function.restype, function.argtypes = kind, [kind] * given
    speeds = [-10.0, -3.3, -0.5, 0.5, 3.3, 10.0]
    found = [library.stiction_friction(speed) for speed in speeds]
    assert found == pytest.approx(
        own.friction_curve(speeds).tolist(), abs=near + made.numbers["speed_off"]
    )
    places = np.linspace(-9.0, 15.0, 41)
    found = [library.stiction_place(place) for place in places.tolist()]
    off = 10 * near + made.numbers["position_off"]
    assert found == pytest.approx(own.position_effort(places).tolist(), abs=off)
    assert made.numbers["position_off"] < 0.02
    whole = library.stiction_feedforward(1.0, 5.0, 0.3)
    parts = library.stiction_friction(1.0) + 0.05 + library.stiction_place(0.3)
    assert whole == pytest.approx(parts, abs=near)


def test_a_table_is_off_by_what_it_says():
    own = plant(FALLING, COGGING)
    made = own.export("table", speed=5.0)
    rows = np.loadtxt(made.files["speed.csv"].splitlines(), delimiter=",", skiprows=1)
    assert 4 <= len(rows) <= 20
    speeds = np.concatenate([-np.geomspace(0.005, 5.0, 300)[::-1], np.geomspace(0.005, 5.0, 300)])
    off = np.max(np.abs(np.interp(speeds, *rows.T) - own.friction_curve(speeds)))
    assert off == pytest.approx(made.numbers["speed_off"], rel=0.1)
    assert off < 0.01
    gains = json.loads(made.files["table.json"])["gains"]
    assert gains["kA"] == 0.01


def test_gains_are_those_of_an_arm_and_of_an_elevator():
    body = {"inertia": 0.01, "gravity_amplitude": 0.4, "gravity_zero_rad": 0.3}
    arm = plant(DRY, body=body, drive={"input": "voltage_v", "gain": 0.5})
    gains = arm.export("table", speed=5.0).numbers
    position, velocity, acceleration = 1.1, 2.0, 3.0
    volts = gains["kS"] + gains["kV"] * velocity + gains["kA"] * acceleration
    volts += gains["kG"] * np.cos(position - gains["level_rad"])
    effort = arm.friction_curve([velocity])[0] + 0.01 * acceleration
    effort += arm.position_effort([position])[0]
    assert 0.5 * volts == pytest.approx(effort, rel=1e-9)
    slide = st.Plant.from_dict(
        {
            "motion": {"kind": "linear"},
            "drive": {"input": "voltage_v", "gain": 30.0},
            "body": {"inertia": 2.0, "weight_n": 9.0},
            "friction": {"law": "coulomb", "coulomb": 20.0, "viscous": 60.0},
        }
    )
    level = slide.export("table").numbers
    assert level["kG"] == pytest.approx(0.3)
    assert "kG" not in plant(DRY).export("table").numbers
    wpimath = pytest.importorskip("wpimath.controller")
    own = [gains[name] for name in ("kS", "kG", "kV")]
    arm_forward = wpimath.ArmFeedforward(*own, gains["kA"])
    still = volts - gains["kA"] * acceleration
    assert arm_forward.calculate(position - gains["level_rad"], velocity) == pytest.approx(still)
    own = [level[name] for name in ("kS", "kG", "kV", "kA")]
    assert wpimath.ElevatorFeedforward(*own).calculate(0.1) == pytest.approx(
        (20.0 + 6.0 + 9.0) / 30.0, rel=1e-6
    )


@pytest.mark.parametrize("name", ["table", "c"])
def test_what_a_curve_cannot_hold_is_told_whatever_its_name(name):
    # The name of an effect may begin as a sentence about the curve does.
    lagging = {"name": "frictional_lag", "excess": 0.2, "velocity": 0.1, "time": 0.01}
    own = plant(DRY, lagging, drive={"input": "torque_nm", "gain": 1.0, "limit": 3.0})
    told = own.export(name).lost
    assert any(each.startswith("the limit of the drive") for each in told)
    assert any(each.startswith("frictional_lag:") for each in told)


def test_places_of_a_slide_hold_what_is_the_same_everywhere():
    bias = {"name": "torque_bias", "bias": 0.1}
    table = {
        "motion": {"kind": "linear"},
        "drive": {"input": "force_n", "gain": 1.0},
        "body": {"inertia": 1.0},
        "friction": {"law": "coulomb"},
        "effects": [bias, COGGING],
    }
    told = st.Plant.from_dict(table).export("c").lost
    assert any(each.startswith("cogging:") for each in told)
    assert not any(each.startswith("torque_bias:") for each in told)


def test_a_wave_of_no_whole_order_is_off_beyond_its_turn():
    made = plant(DRY, {"name": "cogging", "cosine": 0.04, "order": 6.5}).export("c")
    assert made.numbers["position_off"] > 0.05


def test_lines_through_few_points_are_as_near_as_they_can_be():
    x = np.linspace(0.0, 1.0, 41)
    places, off = few_points(x, np.abs(x - 0.5), 20)
    assert x[places].tolist() == [0.0, 0.5, 1.0]
    assert off < 1e-12
    # A parabola wants evenly spaced points: h²/8 times its second derivative.
    places, off = few_points(x, x**2, 5)
    assert x[places] == pytest.approx([0.0, 0.25, 0.5, 0.75, 1.0])
    assert off == pytest.approx(0.25**2 / 4.0, rel=0.05)


def test_the_command_writes_and_tells(tmp_path, capsys):
    file, out = str(plant(FALLING, COGGING).save(tmp_path / "plant.toml")), str(tmp_path / "out")
    assert run(["export", file, "--to", "urdf", "--to", "c", "-o", out]) == 0
    assert "cannot hold: cogging" in capsys.readouterr().out
    assert (tmp_path / "out" / "urdf" / "joint.urdf").is_file()
    assert (tmp_path / "out" / "c" / "stiction_feedforward.c").is_file()
    assert run(["export", file, "--to", "urdf", "-o", out]) == 0
    assert "(in place of what was there: joint.urdf" in capsys.readouterr().out
    assert run(["export", file, "--to", "table", "-o", out, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)[0]["target"] == "table"
    assert run(["export", "--list"]) == 0
    listed = capsys.readouterr().out
    assert all(name in listed for name in targets())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere.toml", "--to", "urdf"], "nowhere.toml"),
        ([], "no plant file"),
        (["PLANT"], "no target"),
        (["PLANT", "--to", "simulink"], "simulink.*allowed are"),
        (
            ["PLANT", "--to", "urdf", "--speed", "0"],
            "speed.*(is none; give the greatest|is not a number)",
        ),
        (
            ["PLANT", "--to", "urdf", "--speed", "nan"],
            "speed.*(is none; give the greatest|is not a number)",
        ),
    ],
)
def test_the_command_refuses_in_a_sentence(arguments, words, tmp_path, capsys):
    file = str(plant(DRY).save(tmp_path / "plant.toml"))
    given = [file if each == "PLANT" else each for each in arguments]
    assert run(["export", *given, "-o", str(tmp_path / "out")]) == 2
    told = capsys.readouterr().err
    assert len(told.strip().splitlines()) == 1
    assert re.search(words, told)


def screw(**friction):
    return st.Plant.from_dict(
        {
            "motion": {"kind": "linear"},
            "drive": {"input": "force_n", "gain": 1.0},
            "body": {"inertia": 1.0},
            "friction": {"law": "coulomb", "coulomb": 20.0, "breakaway": 30.0, **friction},
        }
    )


def test_without_a_speed_a_machine_that_goes_straight_goes_slowly():
    def ends(plant, **keywords):
        table = json.loads(plant.export("table", **keywords).files["table.json"])
        return table["speed"]["velocity"][-1]

    assert ends(plant(DRY)) == 10.0
    assert ends(screw()) == 0.2
    assert ends(screw(stribeck_velocity=0.5)) == 1.5
    assert ends(screw(), speed=3.0) == 3.0


def test_the_command_goes_as_fast_as_the_session(tmp_path, capsys):
    time = 1e-3 * np.arange(12_000)
    force = 60.0 * np.sign(np.sin(8.0 * time))
    run_of = screw().simulate(force, 1e-3)
    rows = np.column_stack([time[1:], force[1:], run_of.position[:-1]])
    np.savetxt(
        tmp_path / "run.csv", rows, delimiter=",", comments="", header="time_s,force_n,position_m"
    )
    (tmp_path / "session.toml").write_text('[[recordings]]\nfile = "run.csv"\nrole = "test"\n')
    file, session = str(screw().save(tmp_path / "plant.toml")), str(tmp_path / "session.toml")
    out = str(tmp_path / "out")
    assert run(["export", file, "--to", "table", "--check", session, "-o", out]) == 0
    capsys.readouterr()
    ends = json.loads((tmp_path / "out" / "table" / "table.json").read_text())["speed"]["velocity"]
    assert ends[-1] == pytest.approx(np.percentile(np.abs(run_of.velocity), 99), rel=0.05)


def test_a_target_that_cannot_take_the_plant_stops_no_other(tmp_path, capsys):
    file, out = str(screw().save(tmp_path / "plant.toml")), str(tmp_path / "out")
    assert run(["export", file, "--to", "bam", "--to", "c", "-o", out]) == 0
    told = capsys.readouterr().out
    assert re.search("^bam: not written: .*is linear", told, re.M)
    assert (tmp_path / "out" / "c" / "stiction_feedforward.c").is_file()
    assert run(["export", file, "--to", "bam", "--to", "c", "-o", out, "--json"]) == 0
    assert "is linear" in json.loads(capsys.readouterr().out)[1]["error"]
    assert run(["export", file, "--to", "bam", "-o", out]) == 2


def test_a_plant_that_is_moved_has_friction_but_no_joint():
    moved = st.Plant.from_dict(
        {"drive": {"kind": "prescribed_motion"}, "friction": {"law": "coulomb", "coulomb": 0.3}}
    )
    assert moved.export("table").numbers["kS"] == pytest.approx(0.3)
    assert moved.export("mujoco").numbers["armature"] == 0.0


def test_a_machine_without_inertia_is_no_fmu_and_one_is_told_what_to_state():
    still = st.Plant.from_dict(
        {"drive": {"input": "torque_nm"}, "body": {"inertia": 0.0}, "friction": DRY}
    )
    with pytest.raises(st.InputError, match=r"fmu: the machine has no inertia.*state \[body\]"):
        still.export("fmu")
    assert "inertia" not in still.export("c").held


def test_lines_through_zero_and_for_both_directions_say_what_they_lose():
    lost = " / ".join(plant(DRY, UNEVEN).export("table", speed=5.0).lost)
    assert "friction below 0.005 rad/s: a line through 0 there, off by up to 0.3" in lost
    assert "kS: friction of the two directions differs by 0.06" in lost
    assert "below 0.005 rad/s" in " / ".join(plant(DRY).export("c", speed=5.0).lost)


def test_an_effect_that_does_nothing_is_no_loss():
    idle = {"name": "torque_bias", "bias": 0.0}
    for name in ("urdf", "table", "c"):
        assert not any("torque_bias" in each for each in plant(DRY, idle).export(name).lost)


def test_limits_that_urdf_asks_of_a_slide_are_not_those_of_the_plant():
    assert any(each.startswith("limits of the slide") for each in screw().export("urdf").lost)
