"""The C of whole machines, against the core sample by sample."""

import ctypes
import shutil
import subprocess

import numpy as np
import pytest

import stiction as st
from stiction.export.fragments import names_of
from stiction.export.machine_source import MachineSource

from .compiled import WARNINGS

DRY = {"law": "coulomb", "coulomb": 0.3, "viscous": 0.02}
DT = 1e-3
TIME = DT * np.arange(2500)
INPUT = np.where(
    TIME < 1.0,
    0.6 * np.sin(9.0 * TIME) + 0.25 * np.sin(31.0 * TIME),
    np.where(TIME < 1.5, 0.1, 0.45 * np.sin(20.0 * TIME)),
)
NEAR = 1e-6
"""Of the range of position and velocity; of most laws it is round-off. Where friction bends with
the velocity, a slope is a difference here."""
ROUND_OFF = 1e-11
DRIVER = """
static stiction_machine it;
static stiction_way way;
void begin(double x, double v)
{
    it.enabled = 1;
    machine_begin(&it, x, v);
    way_begin(&way);
}
int run(int n, const double *u, const double *load, double dt, double *x, double *v, double *f)
{
    int k;
    for (k = 0; k < n; ++k) {
        const acting by = {way_pass(&way, u[k], dt), load[k], 30.0};
        if (!machine_step(&it, &by, dt)) {
            break;
        }
        x[k] = it.contact.position.value;
        v[k] = it.velocity;
        f[k] = it.contact.friction;
    }
    return k;
}
"""
FLAGS = ("-std=c99", "-O1", *WARNINGS, "-Wno-unused-function", "-Wno-missing-prototypes")


def machine(friction, *effects, **tables):
    return st.Plant.from_dict(
        {
            "body": {"inertia": 0.01},
            "drive": {"input": "torque_nm", "gain": 1.0},
            "friction": friction,
            "effects": list(effects),
        }
        | tables
    )


class Machine:
    """The C of a plant, compiled."""

    def __init__(self, plant, folder):
        compiler = shutil.which("cc") or pytest.skip("no C compiler is installed")
        source, built = folder / "machine.c", folder / "machine.so"
        source.write_text(MachineSource.of(plant, (), {}).source + DRIVER)
        command = [compiler, *FLAGS, "-shared", "-fPIC", str(source), "-o", str(built), "-lm"]
        subprocess.run(command, check=True)
        self.library = ctypes.CDLL(str(built))

    def run(self, inputs, dt=DT, load=0.0, start=(0.0, 0.0)):
        """Position, velocity and friction after each sample."""
        columns = [
            np.ascontiguousarray(np.broadcast_to(each, np.shape(inputs)), dtype=float)
            for each in (inputs, load)
        ]
        found = [np.zeros(len(inputs)) for _ in range(3)]
        self.library.begin(*map(ctypes.c_double, start))
        pointers = [each.ctypes.data_as(ctypes.c_void_p) for each in (*columns, *found)]
        number = ctypes.c_int(len(inputs))
        went = self.library.run(number, *pointers[:2], ctypes.c_double(dt), *pointers[2:])
        assert went == len(inputs)
        return found


def off(plant, folder, *, dt=DT, load=0.0, size=1.0):
    """How far C and the core are apart in position and velocity, and how often both rest."""
    position, velocity, _ = Machine(plant, folder).run(size * INPUT, dt, load)
    own = plant.motor().simulate(size * INPUT, dt, load=load, temperature=30.0)
    assert np.ptp(own.velocity) > 0.05
    rests = np.mean((velocity == 0.0) == (own.velocity == 0.0))
    assert rests > 0.999
    return max(
        float(np.max(np.abs(position - own.position)) / np.ptp(own.position)),
        float(np.max(np.abs(velocity - own.velocity)) / np.ptp(own.velocity)),
    )


@pytest.mark.parametrize("law", [name for name in names_of("laws") if name != "bristle"])
def test_each_law_moves_a_machine_as_the_core_does(law, tmp_path):
    assert off(machine({"law": law, "viscous": 0.02}), tmp_path) < NEAR


def test_bristles_go_as_in_the_core_until_rounding_tells_them_apart(tmp_path):
    own = machine({"law": "bristle"})
    found = Machine(own, tmp_path).run(INPUT)[1][:20]
    assert found == pytest.approx(own.simulate(INPUT[:20], DT).velocity, abs=1e-12)


@pytest.mark.parametrize(
    "friction",
    [
        {"law": "rigid_perfectly_plastic", "coulomb": 0.3},
        {"law": "rate_and_state"},
        {"law": "rate_and_state", "compliance": 3e-4},
        {"law": "ro_hubbel", "coulomb": 0.3},
        {"law": "reset_integrator", "breakaway": 0.4},
        {"law": "elastic_perfectly_plastic", "coulomb": 0.3},
    ],
)
def test_contacts_without_a_bend_go_to_the_last_digits(friction, tmp_path):
    assert off(machine(friction), tmp_path) < ROUND_OFF


@pytest.mark.parametrize(
    ("friction", "near"),
    [
        ({"law": "coulomb", "coulomb": 0.25, "breakaway": 0.4, "viscous": 0.02}, 1e-9),
        ({"law": "hsieh_pan", "breakaway": 0.5, "coulomb": 0.3, "loading_rate": 5.0}, 1e-9),
        ({"law": "hsieh_pan", "breakaway": 0.5, "coulomb": 0.3, "viscous": 0.02}, 1e-4),
    ],
)
def test_a_fall_of_friction_breaks_away_where_the_core_says(friction, near, tmp_path):
    assert off(machine(friction), tmp_path) < near


SERVO = {
    "kind": "servo", "proportional": 5.0, "integral": 3.0, "derivative": 0.02, "supply_v": 7.4,
    "resistance_ohm": 3.0, "torque_constant": 0.5, "current_limit_a": 1.0,
}  # fmt: skip
HELD = (*names_of("effects"), *names_of("drive"))


@pytest.mark.parametrize("name", HELD)
def test_each_effect_acts_as_in_the_core(name, tmp_path):
    record = next(each for each in st.effects() if each.name == name)
    effect = {"name": name, **{each.name: each.typical for each in record.parameters}}
    load = 0.1 * np.sin(3.0 * TIME)
    drive = {"drive": SERVO} if name == "goal_rate_limit" else {}
    assert off(machine(DRY, effect, **drive), tmp_path, load=load) < ROUND_OFF


@pytest.mark.slow
@pytest.mark.parametrize("name", HELD)
def test_each_effect_acts_beside_bristles(name, tmp_path):
    record = next(each for each in st.effects() if each.name == name)
    effect = {"name": name, **{each.name: each.typical for each in record.parameters}}
    lugre = {"law": "lugre", "coulomb": 0.25, "breakaway": 0.4, "viscous": 0.02}
    drive = {"drive": SERVO} if name == "goal_rate_limit" else {}
    assert off(machine(lugre, effect, **drive), tmp_path) < 1e-4


@pytest.mark.parametrize(
    "tables",
    [
        {"body": {"inertia": 0.01, "gravity_amplitude": 0.2, "gravity_zero_rad": 0.3}},
        {"drive": {"input": "current_a", "gain": 0.8, "limit": 0.5}},
        {"drive": SERVO},
    ],
)  # fmt: skip
def test_gravity_limits_and_servos_are_those_of_the_core(tables, tmp_path):
    assert off(machine(DRY, **tables), tmp_path) < ROUND_OFF


@pytest.mark.parametrize("dt", [1e-4, 5e-3, 0.02])
def test_a_sample_of_any_length_is_divided_as_in_the_core(dt, tmp_path):
    own = machine({"law": "dahl", "coulomb": 0.3, "initial_stiffness": 300.0, "viscous": 0.05})
    assert off(own, tmp_path, dt=dt) < ROUND_OFF


def test_stuck_means_stuck(tmp_path):
    own = machine({"law": "coulomb", "coulomb": 0.3, "breakaway": 0.45})
    position, velocity, friction = Machine(own, tmp_path).run(
        np.full(20_000, 0.44), dt=0.5, start=(0.123, 0.0)
    )
    assert set(position.tolist()) == {0.123}
    assert not np.any(velocity)
    assert set(friction.tolist()) == {0.44}


def test_a_sample_that_is_too_long_is_refused(tmp_path):
    own = Machine(machine({"law": "dahl", "coulomb": 0.3}), tmp_path)
    with pytest.raises(AssertionError):
        own.run(np.zeros(1), dt=1e3)


@pytest.mark.parametrize("dt", [1e-4, 1e-3])
def test_a_step_goes_in_pieces_where_friction_falls_as_in_the_core(dt, tmp_path):
    own = machine({"law": "hsieh_pan", "breakaway": 20.0, "viscous": 0.4})
    assert off(own, tmp_path, size=40.0, dt=dt) < 1e-4
