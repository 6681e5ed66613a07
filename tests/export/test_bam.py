"""Parameters of better-actuator-models: both ways, against its equations and against itself."""

import json
import re

import numpy as np
import pytest
from tests.reference.laws.load_dependent import Gear

import stiction as st
from stiction.bam import read_bam
from stiction.bam.format import ACTUATORS, MODELS, search_space
from stiction.cli import run

from .test_steady import plant

MX106_M6 = {
    "kt": 2.209828156174588,
    "R": 2.033661749312417,
    "armature": 0.026016184370993383,
    "friction_base": 1.0232526438525893e-05,
    "friction_stribeck": 0.12195409579603411,
    "load_friction_motor": 0.19800553725822115,
    "load_friction_external": 0.022215529897348624,
    "load_friction_motor_stribeck": 0.19859970173941574,
    "load_friction_external_stribeck": 0.08710328264676681,
    "load_friction_motor_quad": 0.009999930103371748,
    "load_friction_external_quad": 7.326919843140997e-05,
    "dtheta_stribeck": 1.7463251741328727,
    "alpha": 1.142827788004191,
    "friction_viscous": 0.05071566473605552,
    "model": "m6",
    "actuator": "mx106",
}
"""As published with the package (Apache-2.0, Duclusaud and Passault)."""
SERVO = {
    "kind": "servo",
    "proportional": 1.2,
    "supply_v": 7.3,
    "resistance_ohm": 3.5,
    "torque_constant": 0.4,
}
GEAR = {
    "law": "load_dependent",
    "coulomb": 0.011,
    "breakaway": 0.018,
    "drive": 0.21,
    "back_drive": 0.07,
    "drive_stribeck": 0.013,
    "back_drive_stribeck": 0.05,
    "drive_quadratic": 0.003,
    "back_drive_quadratic": 0.008,
    "stribeck_velocity": 0.8,
    "stribeck_exponent": 1.4,
    "viscous": 0.005,
}


def drawn(model, actuator, rng):
    """A file of parameters somewhere in the bounds of the search."""
    numbers = {
        name: float(rng.uniform(each.least, min(each.most, each.least + 5.0)))
        for name, each in search_space(model, actuator).items()
    }
    if "alpha" in numbers:
        numbers["alpha"] = float(rng.uniform(0.5, 5.0))
    return {**numbers, "model": model, "actuator": actuator}


def written(table, folder, name="params.json"):
    path = folder / name
    path.write_text(json.dumps(table), encoding="utf-8")
    return path


def near(found, wanted):
    """Whether tables have the same words, and the same numbers to rounding."""
    words = [{k: v for k, v in each.items() if isinstance(v, str)} for each in (found, wanted)]
    rest = [{k: v for k, v in each.items() if not isinstance(v, str)} for each in (found, wanted)]
    return words[0] == words[1] and rest[0] == pytest.approx(rest[1], rel=1e-12, abs=1e-15)


def gear_of(numbers):
    """The published equations with the numbers of any of the models."""
    own = {name: numbers[name] for name in Gear.__dataclass_fields__ if name in numbers}
    for end in ("", "_stribeck"):
        both = numbers.get("load_friction_stribeck" if end else "load_friction_base")
        if both is not None:
            own |= {f"load_friction_{side}{end}": both for side in ("motor", "external")}
    return Gear(**own)


def torques(rng, n=60):
    """Motor, external, speed: of all signs, and some speeds next to nothing."""
    motor, external = rng.uniform(-3.0, 3.0, (2, n))
    speed = rng.choice([-1.0, 1.0], n) * 10.0 ** rng.uniform(-4.0, 1.0, n)
    return zip(motor.tolist(), external.tolist(), speed.tolist(), strict=True)


def friction_of(own, motor, external, speed):
    """What the law of a plant takes in a slide."""
    law = own.friction.model()
    law.step(speed, 1e-3, load=external, effort=motor + external)
    return law.step(speed, 1e-3, load=external, effort=motor + external)


@pytest.mark.parametrize("model", MODELS)
def test_every_model_slides_as_its_published_equations(model, tmp_path):
    rng = np.random.default_rng(int(model[1]))
    for k in range(5):
        table = drawn(model, "mx64", rng)
        own = st.Plant.from_bam(written(table, tmp_path, f"{k}.json"))
        gear = gear_of(table)
        for motor, external, speed in torques(rng):
            wanted = np.sign(speed) * gear.dry(motor, external, speed)
            wanted += gear.friction_viscous * speed
            assert friction_of(own, motor, external, speed) == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize("model", MODELS)
def test_a_file_comes_back_as_it_was(model, tmp_path):
    table = drawn(model, "xl330", np.random.default_rng(3)) | {"kp": 400.0, "vin": 7.3}
    made = st.Plant.from_bam(written(table, tmp_path)).export("bam")
    again = json.loads(made.files["params.json"])
    assert near(again, table)
    assert not made.lost


@pytest.mark.parametrize(
    ("given", "model"),
    [
        ({"law": "coulomb", "coulomb": 0.01, "viscous": 0.004}, "m1"),
        ({"law": "coulomb", "coulomb": 0.01, "breakaway": 0.03, "stribeck_velocity": 0.4}, "m2"),
        ({"law": "load_dependent", "coulomb": 0.01, "drive": 0.1}, "m3"),
        ({"law": "load_dependent", "coulomb": 0.01, "breakaway": 0.02, "drive": 0.1}, "m4"),
        ({k: v for k, v in GEAR.items() if "quadratic" not in k}, "m5"),
        (GEAR, "m6"),
    ],
)
def test_a_plant_comes_back_with_every_number_that_a_model_holds(given, model, tmp_path):
    limit = {"name": "goal_rate_limit", "slowness": 0.21}
    drive = {**SERVO, "duty_limit": 0.97}
    body = {"inertia": 0.002, "payload_kg": 0.49, "payload_m": 0.1, "gravity_zero_rad": 0.03}
    own = plant(given, limit, drive=drive, body=body)
    made = own.export("bam")
    made.save(tmp_path)
    found = read_bam(tmp_path / "params.json")
    assert (found.model, found.actuator) == (model, "sts3215")
    assert not made.lost
    numbers = found.plant.friction.model().parameters
    law = own.friction.model().parameters
    # What the law has beside its model's numbers stays at its default.
    assert near(numbers, law)
    assert near(found.plant.drive, own.drive)
    bodies = [{n: p.value for n, p in each.body.items()} for each in (found.plant, own)]
    assert near(*bodies)
    assert found.plant.effects[0].parameters["slowness"].value == pytest.approx(0.21, rel=1e-12)


@pytest.mark.parametrize("drive", ["current_a", "torque_nm", "voltage_v"])
def test_a_drive_without_a_loop_comes_back(drive, tmp_path):
    own = plant({"law": "coulomb", "coulomb": 0.1}, drive={"input": drive, "gain": 0.35})
    made = own.export("bam")
    made.save(tmp_path)
    again = st.Plant.from_bam(tmp_path / "params.json")
    assert again.drive["input"] == drive
    assert again.gain == pytest.approx(0.35, rel=1e-12)
    # Nothing of the drive's own voltage came on top.
    assert again.friction.parameters["viscous"].value == pytest.approx(0.0, abs=1e-12)


def test_a_contact_with_bristles_becomes_the_fall_of_its_curve():
    law = {"law": "lugre", "coulomb": 0.3, "breakaway": 0.5, "stribeck_velocity": 0.4}
    made = plant(law | {"viscous": 0.02}).export("bam", speed=3.0)
    numbers = made.numbers
    assert json.loads(made.files["params.json"])["model"] == "m2"
    assert numbers["friction_base"] == pytest.approx(0.3, rel=0.01)
    assert numbers["friction_stribeck"] == pytest.approx(0.2, rel=0.02)
    assert numbers["dtheta_stribeck"] == pytest.approx(0.4, rel=0.02)
    assert numbers["alpha"] == pytest.approx(2.0, rel=0.03)
    assert numbers["friction_viscous"] == pytest.approx(0.02, rel=0.05)
    assert [each for each in made.lost if each.startswith("pre-sliding")]
    assert not [each for each in made.lost if "curve" in each]


def test_a_curve_that_no_model_has_is_off_by_what_it_says():
    quadratic = {"name": "viscous_quadratic", "quadratic": 0.4}
    own = plant({"law": "coulomb", "coulomb": 0.3, "viscous": 0.02}, quadratic)
    made = own.export("bam", speed=2.0)
    (told,) = [each for each in made.lost if each.startswith("the curve")]
    off = float(re.search(r"off by ([\d.e-]+)", told)[1])
    speeds = np.linspace(0.01, 2.0, 300)
    gear = gear_of(made.numbers)
    found = [gear.dry(0.0, 0.0, v) + gear.friction_viscous * v for v in speeds]
    assert np.max(np.abs(found - own.friction_curve(speeds))) == pytest.approx(off, rel=0.05)


def test_an_effect_of_the_load_is_held_and_told_where_it_differs():
    effect = {"name": "load_dependent_friction", "drive": 0.3, "back_drive": 0.1}
    made = plant({"law": "coulomb", "coulomb": 0.3}, effect).export("bam")
    assert json.loads(made.files["params.json"])["model"] == "m5"
    assert made.numbers["load_friction_external"] == pytest.approx(0.2)
    assert [each for each in made.lost if "0.3 of the load while the machine drives it" in each]


@pytest.mark.parametrize(
    ("drive", "words"),
    [
        ({"derivative": 0.01}, "derivative = 0.01"),
        ({"integral": 0.2}, "integral = 0.2"),
        ({"current_limit_a": 1.5}, "current_limit_a = 1.5: that of BAM's xl330 is 1.75 A"),
        ({"duty_limit": 0.5}, "duty_limit = 0.5: that of BAM's mx64 is 0.9625"),
    ],
)
def test_what_no_servo_of_bam_has_is_told(drive, words):
    made = plant({"law": "coulomb"}, drive=SERVO | drive).export("bam")
    assert any(each.startswith(words) for each in made.lost)


def test_gravity_that_no_payload_makes_is_told():
    body = {"inertia": 0.01, "gravity_amplitude": 0.5}
    assert any("gravity of 0.5 N·m" in each for each in
               plant({"law": "coulomb"}, body=body).export("bam").lost)  # fmt: skip


def test_a_linear_plant_is_refused():
    own = st.Plant.from_dict(
        {"motion": {"kind": "linear"}, "body": {"inertia": 1.0}, "friction": {"law": "coulomb"}}
    )
    with pytest.raises(st.InputError, match=r"is linear, and actuators .* turn"):
        own.export("bam")


def test_numbers_at_an_end_of_the_search_are_told(tmp_path):
    found = read_bam(written(MX106_M6, tmp_path))
    told = {each.split(" ")[0]: each for each in found.at_bounds}
    assert told.keys() == {"friction_base", "load_friction_motor_quad"}
    assert "stands at 0, the least that the search of BAM" in told["friction_base"]
    assert "stands at 0.01, the most" in told["load_friction_motor_quad"]
    beyond = read_bam(written(MX106_M6 | {"alpha": 0.34}, tmp_path))
    assert any("alpha = 0.34 is beyond 0.5, the least" in each for each in beyond.at_bounds)


def test_what_a_file_leaves_open_is_told(tmp_path):
    table = {k: v for k, v in MX106_M6.items() if k != "R"} | {"colour": 3.0}
    found = read_bam(written(table, tmp_path))
    assert found.plant.drive["resistance_ohm"] == 2.0
    assert found.plant.drive["proportional"] == pytest.approx(32.0 * 0.158)
    text = str(found)
    for words in ("R is not in the file: 2 is taken", "colour: no number of M6", "kp is that of"):
        assert words in text
    other = read_bam(written(table, tmp_path), kp=8.0, vin=12.0)
    assert other.plant.drive["proportional"] == pytest.approx(8.0 * 0.158)
    assert other.plant.drive["supply_v"] == 12.0
    assert "kp is that of" not in str(other)


def test_an_exponent_that_no_law_here_takes_is_told_with_what_it_changes(tmp_path):
    found = read_bam(written(MX106_M6 | {"alpha": 8.68}, tmp_path))
    assert found.plant.friction.parameters["stribeck_exponent"].value == 5.0
    (told,) = [each for each in found.notes if each.startswith("alpha")]
    share = float(re.search(r"by up to ([\d.]+) %", told)[1]) / 100.0
    x = np.linspace(0.1, 3.0, 20001)
    assert share == pytest.approx(np.max(np.abs(np.exp(-(x**8.68)) - np.exp(-(x**5.0)))), rel=0.02)


def test_a_current_loop_becomes_the_voltage_that_makes_its_current(tmp_path):
    table = {"kt": 4.5, "R": 2.5, "armature": 0.3, "friction_base": 4.0, "friction_viscous": 1.3}
    path = written(table | {"model": "m1", "actuator": "erob80_50"}, tmp_path)
    alone = read_bam(path)
    assert alone.plant.drive["input"] == "current_a"
    assert alone.plant.drive["limit"] == 12.0
    drive = read_bam(path, kp=100.0).plant.drive
    rng = np.random.default_rng(1)
    for distance, speed in rng.uniform(-0.1, 0.1, (20, 2)):
        duty = drive["proportional"] * distance - drive["derivative"] * speed
        current = (drive["supply_v"] * duty - 4.5 * speed) / drive["resistance_ohm"]
        assert current == pytest.approx(100.0 * distance - 1.0 * np.sqrt(100.0) * speed)
    assert "damps less" in str(read_bam(path, kp=1.0))


@pytest.mark.parametrize(
    ("table", "kind", "gain"),
    [
        ({"kt": 0.9, "R": 3.0}, "voltage_v", 0.3),
        ({"kt": 0.9}, "current_a", 0.9),
        ({}, "torque_nm", 1.0),
    ],
)
def test_an_actuator_of_ones_own_is_driven_as_its_numbers_allow(table, kind, gain, tmp_path):
    own = {"friction_base": 0.1, "friction_viscous": 0.01, "armature": 0.02}
    path = written({**own, **table, "model": "m1", "actuator": "my_motor"}, tmp_path)
    found = read_bam(path)
    assert found.plant.drive["input"] == kind
    assert found.plant.gain == pytest.approx(gain)
    viscous = 0.01 + (0.9**2 / 3.0 if kind == "voltage_v" else 0.0)
    assert found.plant.friction.parameters["viscous"].value == pytest.approx(viscous)
    assert "my_motor" in str(found)


@pytest.mark.parametrize("name", ACTUATORS)
def test_every_actuator_is_read(name, tmp_path):
    table = drawn("m4", name, np.random.default_rng(0))
    found = read_bam(written(table, tmp_path))
    assert found.actuator == name
    assert found.plant.motor()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[1, 2]", 'names no "model" and "actuator"'),
        ('{"model": "m1"', "is not JSON"),
        ('{"model": "m7", "actuator": "mx64"}', r"model = 'm7' is unknown.*allowed are m1"),
        ('{"model": "m1", "actuator": 3}', "actuator is 3; give a word"),
        ('{"model": "m1", "actuator": "mx64", "kt": "a"}', "kt.*is a number"),
        ('{"model": "m1", "actuator": "mx64", "kt": NaN}', "kt.*nan is not a number"),
        ('{"model": "m1", "actuator": "mx64", "kt": 1e999}', "kt = inf"),
        ('{"model": "m1", "actuator": "mx64", "R": 0}', "R = 0 is not above 0"),
        ('{"model": "m1", "actuator": "mx64", "friction_base": -1}', "coulomb"),
        ('{"model": "m1", "actuator": "mx64", "kp": 0}', "proportional"),
        ('{"model": "m1", "actuator": "erob80_50", "kp": 90, "vin": 0}', "vin = 0 is not above 0"),
        ('{"model": "m1", "actuator": "sts3215", "max_velocity": 0}', "max_velocity = 0"),
    ],
)
def test_what_is_no_file_of_parameters_is_refused(text, words, tmp_path):
    path = tmp_path / "params.json"
    path.write_text(text)
    with pytest.raises(st.InputError, match=words):
        read_bam(path)


def test_the_command_writes_a_plant_and_does_not_overwrite_one(tmp_path, capsys):
    path, out = str(written(MX106_M6, tmp_path)), tmp_path / "out"
    assert run(["import", path, "--kp", "8", "-o", str(out)]) == 0
    said = capsys.readouterr().out
    assert "M6 of mx106: law load_dependent" in said
    assert "stands at 0.01" in said
    made = st.Plant.load(out / "plant.toml")
    assert made.to_dict() == st.Plant.from_bam(path, kp=8.0).to_dict()
    assert run(["import", path, "-o", str(out)]) == 2
    assert "is there already and is not overwritten" in capsys.readouterr().err
    assert run(["import", path, "-o", str(tmp_path / "two"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["model"] == "m6"


# --- against the package itself, where it is installed


@pytest.mark.parametrize("model", MODELS)
def test_the_package_has_the_same_friction(model, tmp_path):
    load_model = pytest.importorskip("bam.model").load_model
    rng = np.random.default_rng(int(model[1]))
    own = st.Plant.from_bam(written(drawn(model, "xl320", rng), tmp_path))
    own.export("bam").save(tmp_path)
    theirs = load_model(str(tmp_path / "params.json"))
    for motor, external, speed in torques(rng):
        loss, damping = theirs.compute_frictions(motor, external, speed)
        wanted = np.sign(speed) * loss + damping * speed
        assert friction_of(own, motor, external, speed) == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize("name", ACTUATORS)
def test_the_package_searches_within_the_same_bounds(name):
    package = pytest.importorskip("bam.model")
    for model in MODELS:
        theirs = package.load_model_from_dict({"model": model, "actuator": name}).get_parameters()
        own = search_space(model, name)
        assert own.keys() == theirs.keys()
        for key, each in theirs.items():
            assert (own[key].start, own[key].least, own[key].most) == pytest.approx(
                (each.value, each.min, each.max), rel=1e-12
            )


@pytest.mark.parametrize(("model", "limit"), [("m1", 1.75), ("m4", None), ("m6", None)])
def test_the_package_swings_a_pendulum_as_the_plant_does(model, limit, tmp_path):
    simulator = pytest.importorskip("bam.simulate").Simulator
    load_model = pytest.importorskip("bam.model").load_model
    drive = {**SERVO, "proportional": 4.0}
    if limit is not None:
        drive["current_limit_a"] = limit
    body = {"inertia": 0.002, "payload_kg": 0.3, "payload_m": 0.1, "gravity_zero_rad": 0.02}
    laws = {
        "m1": {"law": "coulomb", "coulomb": 0.03, "viscous": 0.005},
        "m4": {"law": "load_dependent", "coulomb": 0.01, "breakaway": 0.02, "drive": 0.1},
        "m6": GEAR,
    }
    own = plant(laws[model], drive=drive, body=body)
    own.export("bam").save(tmp_path)
    theirs = load_model(str(tmp_path / "params.json"))
    assert theirs.name == model
    dt, n = 1e-4, 20000
    # From step to step it needs more current than it gets.
    goal = 0.8 * np.sign(np.sin(6.0 * dt * np.arange(n)))
    settings = json.loads((tmp_path / "params.json").read_text())
    log = {
        "dt": dt,
        "entries": [
            {"position": 0.0, "speed": 0.0, "goal_position": g, "torque_enable": True}
            for g in goal.tolist()
        ],
        "kp": settings["kp"],
        "vin": settings["vin"],
        "mass": settings["mass"],
        "length": settings["length"],
        "arm_mass": 0.0,
    }
    found = np.array(simulator(theirs).rollout_log(log, simulate_control=True)[0])
    run_of = own.simulate(goal[:-1], dt, outputs=["position"])
    assert np.ptp(found) > 0.5
    # Its steps are of first order.
    assert np.max(np.abs(found[1:] - run_of.position)) < 2e-3 * np.ptp(found)
