"""FMUs, validated and simulated by FMPy, beside the core."""

import io
import json
import re
import shutil
import subprocess
import zipfile
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiction as st
from stiction.cli import run
from stiction.export import fmu_archive
from stiction.export.fragments import names_of

from .compiled import WARNINGS
from .test_machine_c import DRY, machine

DT = 1e-3
HOLD = 0.05
"""Time for which inputs of model exchange are held, s: FMPy follows no input within a step."""
LEVELS = np.random.default_rng(1).uniform(-0.8, 0.8, 20)
LEVELS[8:11] = 0.1
RTOL = 1e-7
STUCK = {"law": "coulomb", "coulomb": 0.3, "breakaway": 0.45}
EXCHANGED = (
    "bouc_wen", "coulomb", "dahl", "dahl_with_memory", "elastic_perfectly_plastic",
    "elasto_plastic", "futami", "load_dependent", "lugre", "maxwell_slip",
    "parallel_elements", "prandtl_ishlinskii", "preisach", "rigid_perfectly_plastic",
)  # fmt: skip
SERVO = {
    "kind": "servo", "proportional": 5.0, "supply_v": 7.4, "resistance_ohm": 3.0,
    "torque_constant": 0.5,
}  # fmt: skip


@pytest.fixture
def fmpy():
    shutil.which("cc") or pytest.skip("no C compiler is installed")
    return pytest.importorskip("fmpy")


def inside(made, name="plant.fmu"):
    return zipfile.ZipFile(io.BytesIO(made.files[name]))


def held(levels, hold=HOLD):
    """An input in steps, as FMPy takes it: two rows where it jumps."""
    rows = [(k + end, level) for k, level in enumerate(levels) for end in (0, 1)]
    kinds = [("time", float), ("input", float)]
    return np.array([(hold * at, level) for at, level in rows], dtype=kinds)


def stepped(plant, levels, hold=HOLD, every=DT):
    """Velocity of the core under it at the rows of a simulation, by fine steps."""
    fine = 10
    samples = np.repeat(levels, round(fine * hold / every))
    motor = plant.motor(integrator="reference")
    return motor.simulate(samples, every / fine).velocity[fine - 1 :: fine]


def laid_out(found, name, rows, every=DT):
    return np.interp(every * np.arange(1, rows + 1), found["time"], found[name])


@pytest.mark.parametrize(
    "plant",
    [
        machine(STUCK, {"name": "cogging", "cosine": 0.1}, sensor={"counts_per_rev": 4096}),
        machine({"law": "lugre"}),
        machine({"law": "gms"}, {"name": "temperature_dependent_friction", "coulomb": 0.005}),
        machine(DRY, drive=SERVO),
        st.Plant.from_dict(
            {
                "motion": {"kind": "linear"},
                "drive": {"input": "voltage_v", "gain": 35.0},
                "body": {"inertia": 95.0},
                "friction": {"law": "elasto_plastic"},
            }
        ),
    ],
)
def test_archives_are_valid(plant, fmpy, tmp_path):
    from fmpy.validation import validate_fmu

    for path in plant.export("fmu").save(tmp_path):
        assert validate_fmu(str(path)) == []


@pytest.mark.parametrize("name", ["plant.fmu", "plant_fmi2.fmu"])
def test_co_simulation_is_the_motor_sample_by_sample(name, fmpy, tmp_path):
    own = machine(DRY, {"name": "cogging", "cosine": 0.05, "order": 7.0})
    own.export("fmu").save(tmp_path)
    samples = 0.6 * np.sin(9e-3 * np.arange(1000)) + 0.25 * np.sin(31e-3 * np.arange(1000))
    time = DT * np.arange(1001)
    signal = np.array(
        list(zip(time, [*samples, 0.0], strict=True)), dtype=[("time", float), ("input", float)]
    )
    found = fmpy.simulate_fmu(
        str(tmp_path / name), fmi_type="CoSimulation", stop_time=1.0, step_size=DT,
        output_interval=DT, input=signal, output=["position", "velocity", "friction"],
    )  # fmt: skip
    motor = own.simulate(samples, DT)
    assert np.max(np.abs(found["position"][1:] - motor.position)) < 1e-12
    assert np.max(np.abs(found["velocity"][1:] - motor.velocity)) < 1e-12 * np.ptp(motor.velocity)
    assert np.array_equal(found["velocity"][1:] == 0.0, motor.velocity == 0.0)


OFTEN = ("coulomb", "dahl", "hsieh_pan", "load_dependent", "lugre", "maxwell_slip")


def often(law):
    return pytest.param(law, marks=() if law in OFTEN else pytest.mark.slow)


@pytest.mark.parametrize("law", [often(law) for law in (*EXCHANGED, "hsieh_pan")])
def test_model_exchange_goes_as_the_core_does(law, fmpy, tmp_path):
    more = {"creep_rate": 0.0} if law == "hsieh_pan" else {"viscous": 0.02}
    own = machine({"law": law, **more})
    made = own.export("fmu")
    assert made.held[-1] == "co-simulation and model exchange"
    path = made.save(tmp_path)[0]
    found = fmpy.simulate_fmu(
        str(path), fmi_type="ModelExchange", stop_time=HOLD * len(LEVELS), output_interval=DT,
        relative_tolerance=RTOL, input=held(LEVELS), output=["velocity"], record_events=False,
    )  # fmt: skip
    velocity = stepped(own, LEVELS)
    off = laid_out(found, "velocity", len(velocity)) - velocity
    assert np.ptp(velocity) > 0.1
    # Local errors of the solver and of the steps of the core that it is compared with.
    assert np.max(np.abs(off)) < 1e-4 * np.ptp(velocity)
    if law in ("coulomb", "rigid_perfectly_plastic", "load_dependent"):
        assert np.max(np.abs(off)) < 2e-6 * np.ptp(velocity)
        rests = found["velocity"] == 0.0
        assert abs(np.mean(rests) - np.mean(velocity == 0.0)) < 2e-3


@pytest.mark.parametrize("version", [0, 1])
@pytest.mark.parametrize("law", ["coulomb", "rigid_perfectly_plastic"])
def test_an_input_that_rises_slowly_breaks_away(law, version, fmpy, tmp_path):
    # Its effort comes to what the contact holds just where the solver finds the event.
    own = machine({"law": law, "coulomb": 0.5})
    ramp = np.array([(0.0, 0.0), (1.0, 1.0)], dtype=[("time", float), ("input", float)])
    found = fmpy.simulate_fmu(
        str(own.export("fmu").save(tmp_path)[version]), fmi_type="ModelExchange", stop_time=1.0,
        output_interval=1e-3, input=ramp, output=["position"], record_events=False,
    )  # fmt: skip
    moved = own.motor().simulate((np.arange(10_000) + 0.5) * 1e-4, 1e-4).position[-1]
    assert found["position"][-1] == pytest.approx(moved, rel=0.01)


def test_the_version_before_exchanges_as_well(fmpy, tmp_path):
    own = machine(STUCK)
    path = own.export("fmu").save(tmp_path)[1]
    found = fmpy.simulate_fmu(
        str(path), fmi_type="ModelExchange", stop_time=HOLD * len(LEVELS), output_interval=DT,
        relative_tolerance=RTOL, input=held(LEVELS), output=["velocity"], record_events=False,
    )  # fmt: skip
    velocity = stepped(own, LEVELS)
    off = laid_out(found, "velocity", len(velocity)) - velocity
    assert np.max(np.abs(off)) < 1e-5 * np.ptp(velocity)


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_stuck_means_stuck(kind, fmpy, tmp_path):
    path = machine(STUCK).export("fmu").save(tmp_path)[0]
    found = fmpy.simulate_fmu(
        str(path), fmi_type=kind, stop_time=3600.0, output_interval=4.0,
        start_values={"position": 0.123, "input": 0.44}, output=["position", "velocity"],
    )  # fmt: skip
    assert set(found["position"].tolist()) == {0.123}
    assert not np.any(found["velocity"])


def test_the_page_leads_to_a_simulation(fmpy, tmp_path, monkeypatch):
    page = (Path(__file__).parents[2] / "docs" / "export.md").read_text("utf-8")
    code = next(each for each in page.split("```") if "import fmpy" in each).removeprefix("text")
    own = machine({"law": "lugre"})
    assert own.save(tmp_path / "plant.toml").is_file()
    monkeypatch.chdir(tmp_path)
    assert run(["export", "plant.toml", "--to", "fmu", "-o", "out"]) == 0
    told = {}
    exec(compile(code, "export.md", "exec"), told)
    motor = own.simulate(told["drive"]["input"][:-1], DT)
    off = np.max(np.abs(told["found"]["position"][1:] - motor.position))
    assert off < 1e-6 * np.ptp(motor.position)


def opened(fmpy, path, kind):
    from fmpy.fmi3 import FMU3Model, FMU3Slave

    description = fmpy.read_model_description(str(path))
    which = {"CoSimulation": FMU3Slave, "ModelExchange": FMU3Model}[kind]
    model = which(
        guid=description.guid, unzipDirectory=fmpy.extract(str(path), str(path) + "-files"),
        modelIdentifier="plant", instanceName="it",
    )  # fmt: skip
    model.instantiate()
    return model, {each.name: each.valueReference for each in description.modelVariables}


def test_a_solver_that_follows_the_input_gets_what_the_equations_say(fmpy, tmp_path):
    own = machine({"law": "lugre", "coulomb": 0.25, "breakaway": 0.4, "viscous": 0.02})
    model, by_name = opened(fmpy, own.export("fmu").save(tmp_path)[0], "ModelExchange")
    model.enterInitializationMode()
    model.exitInitializationMode()
    model.updateDiscreteStates()
    model.enterContinuousTimeMode()
    states, rates = (np.zeros(3), np.zeros(3))

    def rhs(time, y):
        model.setTime(time)
        model.setFloat64([by_name["input"]], [0.6 * np.sin(40.0 * time)])
        states[:] = y
        model.setContinuousStates(pointer(states), 3)
        model.getContinuousStateDerivatives(pointer(rates), 3)
        return rates.copy()

    times = 1e-2 * np.arange(1, 31)
    found = solve_ivp(rhs, (0.0, 0.3), np.zeros(3), "LSODA", times, rtol=1e-9, atol=1e-12)
    model.freeInstance()
    fine = 1e-5
    middles = fine * (np.arange(30_000) + 0.5)
    run = own.motor(integrator="reference").simulate(0.6 * np.sin(40.0 * middles), fine)
    off = found.y[1] - run.velocity[999::1000]
    assert np.max(np.abs(off)) < 1e-6 * np.ptp(run.velocity)


def pointer(values):
    from ctypes import POINTER, c_double

    return values.ctypes.data_as(POINTER(c_double))


def test_a_state_leads_back_to_the_bit(fmpy, tmp_path):
    model, by_name = opened(
        fmpy, machine({"law": "gms"}).export("fmu").save(tmp_path)[0], "CoSimulation"
    )
    model.enterInitializationMode()
    model.exitInitializationMode()

    def along(first):
        places = []
        for k in range(first, first + 50):
            model.setFloat64([by_name["input"]], [0.6 * np.sin(0.2 * k)])
            model.doStep(DT * k, DT)
            places.append(model.getFloat64([by_name["position"]])[0])
        return places

    along(0)
    state = model.getFMUState()
    kept = model.serializeFMUState(state)
    first = along(50)
    model.setFMUState(state)
    assert along(50) == first
    model.freeFMUState(state)
    again = model.deserializeFMUState(kept)
    model.setFMUState(again)
    assert along(50) == first
    model.freeFMUState(again)
    model.freeInstance()


def test_a_drive_that_is_off_moves_nothing(fmpy, tmp_path):
    path = machine({"law": "dahl"}).export("fmu").save(tmp_path)[0]
    simulate = partial(fmpy.simulate_fmu, str(path), stop_time=0.1, output=["position"])
    on, off = (simulate(start_values={"input": 0.5, "enabled": each}) for each in (True, False))
    assert np.ptp(on["position"]) > 1e-4
    assert not np.any(off["position"])


def test_a_step_that_is_no_step_is_a_sentence(fmpy, tmp_path, capfd):
    model, _ = opened(
        fmpy, machine({"law": "dahl"}).export("fmu").save(tmp_path)[0], "CoSimulation"
    )
    model.enterInitializationMode()
    model.exitInitializationMode()
    with pytest.raises(fmpy.fmi1.FMICallException):
        model.doStep(0.0, 1e4)
    with pytest.raises(fmpy.fmi1.FMICallException):
        model.doStep(0.0, 0.0)
    model.freeInstance()


def test_sources_compile_without_a_warning(tmp_path):
    compiler = shutil.which("cc") or pytest.skip("no C compiler is installed")
    for law in names_of("laws"):
        inside(machine({"law": law}).export("fmu")).extractall(tmp_path)
        source = str(tmp_path / "sources" / "plant.c")
        # Checked syntax alone tells of no function that nobody calls.
        flags = ("-std=c99", "-c", "-o", str(tmp_path / "plant.o"), *WARNINGS)
        done = subprocess.run(
            [compiler, *flags, source], capture_output=True, text=True, check=False
        )
        assert (done.returncode, done.stderr) == (0, ""), law


def test_one_plant_is_one_archive():
    one, other = (machine(STUCK).export("fmu").files for _ in range(2))
    assert one == other
    names = inside(machine(STUCK).export("fmu")).namelist()
    assert {"modelDescription.xml", "sources/plant.c", "sources/buildDescription.xml"} < set(names)
    plant = json.loads(inside(machine(STUCK).export("fmu")).read("resources/plant.json"))
    assert st.Plant.from_dict(plant).to_dict() == machine(STUCK).to_dict()


def test_without_a_compiler_there_are_sources_and_a_sentence(monkeypatch):
    monkeypatch.setattr(fmu_archive, "compiler", lambda: None)
    made = machine(STUCK).export("fmu")
    assert made.lost[-1] == (
        "a binary: there is no C compiler here (cc, gcc or clang); fmpy compile makes one"
    )
    assert not any("binaries" in name for name in inside(made).namelist())


@pytest.mark.parametrize(
    ("plant", "words"),
    [
        (machine({"law": "gms"}), "model exchange: gms is stepped, and no equation over time"),
        (
            machine(DRY, {"name": "dwell_strengthening", "strength": 0.2}),
            "model exchange: dwell_strengthening remembers from sample to sample",
        ),
        (
            machine(DRY, drive={**SERVO, "integral": 1.0}),
            "model exchange: the servo sums up from sample to sample",
        ),
        (machine(DRY, {"name": "backlash", "inertia_share": 0.3, "gap": 0.01}), "backlash: "),
    ],
)
def test_what_is_lost_is_told(plant, words, monkeypatch):
    monkeypatch.setattr(fmu_archive, "compiler", lambda: None)
    assert any(each.startswith(words) for each in plant.export("fmu").lost)


@pytest.mark.parametrize("effect", [each.name for each in st.effects()])
def test_an_effect_is_in_the_sources_or_told(effect, monkeypatch):
    monkeypatch.setattr(fmu_archive, "compiler", lambda: None)
    record = next(each for each in st.effects() if each.name == effect)
    if record.impossible("rotary", servo=False):
        pytest.skip("there is no such plant")
    made, base = (
        machine(DRY, *effects).export("fmu")
        for effects in ([{"name": effect, **{p.name: p.typical for p in record.parameters}}], [])
    )
    source, without = (inside(each).read("sources/plant.c") for each in (made, base))
    # Another machine has another token.
    lines = [re.sub(rb"#define TOKEN .*", b"", each) for each in (source, without)]
    told = any(each.startswith(f"{effect}:") for each in made.lost)
    assert told != (lines[0] != lines[1])


def test_a_machine_that_is_moved_has_no_equation_of_motion():
    moved = st.Plant.from_dict(
        {"drive": {"kind": "prescribed_motion"}, "friction": {"law": "coulomb", "coulomb": 0.3}}
    )
    with pytest.raises(st.InputError, match="fmu: a machine whose motion is prescribed"):
        moved.export("fmu")


def test_laws_with_model_exchange_are_those_of_the_list(monkeypatch):
    monkeypatch.setattr(fmu_archive, "compiler", lambda: None)
    found = {law for law in names_of("laws") if exchanges(law)}
    assert found == set(EXCHANGED)


def exchanges(law):
    description = inside(machine({"law": law}).export("fmu")).read("modelDescription.xml").decode()
    return bool(re.search("<ModelExchange ", description))
