"""Directional derivatives of FMUs, against differences and where motion has a kink."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiction as st

from .test_fmu import EXCHANGED, SERVO, fmpy, often, opened, pointer
from .test_machine_c import DRY, machine

__all__ = ["fmpy"]

FEW = 12
"""Points at which each machine is looked at."""
STEP = {"time": 1e-7, "input": 1e-6, "load": 1e-6, "temperature": 1e-4, "bristle_force": 1e-6}
"""Of central differences; of position and velocity a share of what they are."""
NEAR = 2e-3
"""Of the greatest derivative of a variable by any: what differences lose to rounding."""


class Exchanged:
    """An FMU in model exchange, at any state."""

    def __init__(self, fmpy, plant, folder, version=0):
        made = plant.export("fmu")
        assert made.held[-1] == "co-simulation and model exchange"
        self.path = made.save(folder)[version]
        self.model, self.by_name = opened(fmpy, self.path, "ModelExchange")
        self.model.enterInitializationMode()
        self.model.exitInitializationMode()
        self.states = [n for n in ("position", "velocity", "bristle_force") if n in self.by_name]
        acting = [n for n in ("time", "input", "load", "temperature") if n in self.by_name]
        self.known = [*acting, *self.states]
        self.rates = ["velocity", "acceleration", *(["bristle_rate"] if self.states[2:] else [])]
        indicators = [n for n in ("event_indicator", "fall_indicator") if n in self.by_name]
        self.unknown = [*self.rates, "friction", *indicators]
        self.arrive()

    def arrive(self):
        self.model.enterEventMode()
        self.model.updateDiscreteStates()
        self.model.enterContinuousTimeMode()

    def at(self, values):
        """All that is computed there."""
        model, given = self.model, dict(zip(self.known, values, strict=True))
        model.setTime(given["time"])
        for name in {"input", "load", "temperature"} & given.keys():
            model.setFloat64([self.by_name[name]], [given[name]])
        states = np.array([given[name] for name in self.states])
        model.setContinuousStates(pointer(states), len(states))
        rates = np.zeros(len(states))
        model.getContinuousStateDerivatives(pointer(rates), len(states))
        others = self.unknown[len(states) :]
        return np.array([*rates, *model.getFloat64([self.by_name[name] for name in others])])

    def jacobian(self):
        """Derivatives where it is, a column for each known variable."""
        wanted = [self.by_name[name] for name in self.unknown]
        columns = [
            self.model.getDirectionalDerivative(wanted, [self.by_name[name]], [1.0])
            for name in self.known
        ]
        return np.array(columns).T

    def differences(self, values):
        """The same by central differences."""
        columns = []
        for k, name in enumerate(self.known):
            pace = abs(values[self.known.index("velocity")])
            own = STEP | {"position": max(1e-7 * pace, 1e-10), "velocity": max(1e-6 * pace, 1e-10)}
            ends = []
            for way in (-1, 1):
                moved = np.array(values)
                moved[k] += way * own[name]
                ends.append(self.at(moved))
            columns.append((ends[1] - ends[0]) / (2 * own[name]))
        self.at(values)
        return np.array(columns).T

    def dependencies(self, fmpy):
        """What each variable goes by, as the description says."""
        told = fmpy.read_model_description(str(self.path))
        return {
            each.variable.name: {other.name for other in each.dependencies}
            for each in (*told.outputs, *told.derivatives, *told.eventIndicators)
        }


def look(fmpy, plant, folder):
    """Derivatives at points along a motion that turns, rests and jumps, against differences."""
    own, random = Exchanged(fmpy, plant, folder), np.random.default_rng(3)
    known, time, place = own.known, 0.0, 0.0
    told = own.dependencies(fmpy)
    moving = 0
    for trial in range(FEW):
        speed = random.normal() * random.choice([1e-2, 0.05, 1.0])
        time += random.uniform(1e-3, 1e-2)
        place += speed * random.uniform(1e-3, 1e-2)
        values = {
            "time": time, "input": 0.4 * random.normal(), "load": 0.05 * random.normal(),
            "temperature": random.uniform(10, 40), "position": place, "velocity": speed,
            "bristle_force": random.uniform(-0.3, 0.3),
        }  # fmt: skip
        own.at([values[name] for name in known])
        if trial % 2:
            own.arrive()
        values["time"] += random.uniform(1e-4, 1e-3)
        values["position"] += 1e-3 * speed * random.uniform(0.1, 1.0)
        there = [values[name] for name in known]
        own.at(there)
        exact, near = own.jacobian(), own.differences(there)
        greatest = np.maximum(np.max(np.abs(near), axis=1, keepdims=True), 1e-3)
        assert np.all(np.abs(exact - near) < NEAR * np.abs(near) + 1e-4 * greatest), trial
        for row, name in enumerate(own.unknown):
            moved = {known[k] for k in np.flatnonzero(exact[row])}
            assert moved <= told[name]
        moving += exact[own.unknown.index("velocity"), known.index("velocity")] == 1.0
        place = values["position"]
        own.arrive()
    own.model.freeInstance()
    assert moving > FEW / 3


@pytest.mark.parametrize("law", [often(law) for law in (*EXCHANGED, "hsieh_pan")])
def test_of_each_law_they_are_what_differences_say(law, fmpy, tmp_path):
    more = {"creep_rate": 0.0} if law == "hsieh_pan" else {"viscous": 0.02}
    look(fmpy, machine({"law": law, **more}), tmp_path)


EFFECTS = [
    each
    for each in st.effects()
    if not each.impossible("rotary", servo=False)
    and each.name
    not in (
        "backlash", "creep_hardening", "current_loop_lag", "dwell_strengthening",
        "encoder_eccentricity", "frictional_lag", "goal_rate_limit", "input_delay",
        "rate_dependent_breakaway", "relaxation", "reverse_point_memory", "shaft_compliance",
    )
]  # fmt: skip


@pytest.mark.parametrize(
    "effect", [pytest.param(e, marks=pytest.mark.slow, id=e.name) for e in EFFECTS]
)
@pytest.mark.parametrize("law", ["coulomb", "lugre"])
def test_with_each_effect_they_are_what_differences_say(law, effect, fmpy, tmp_path):
    stated = {"name": effect.name, **{p.name: p.typical for p in effect.parameters}}
    look(fmpy, machine({"law": law, "viscous": 0.02}, stated), tmp_path)


def test_with_all_effects_at_once_they_are_what_differences_say(fmpy, tmp_path):
    stated = [{"name": e.name, **{p.name: p.typical for p in e.parameters}} for e in EFFECTS]
    look(fmpy, machine({"law": "maxwell_slip", "viscous": 0.02}, *stated), tmp_path)


def test_of_a_servo_and_of_an_arm_too(fmpy, tmp_path):
    look(fmpy, machine(DRY, drive=SERVO), tmp_path / "servo")
    arm = {"inertia": 0.01, "gravity_amplitude": 0.3}
    look(fmpy, machine({"law": "dahl"}, body=arm), tmp_path / "arm")


def test_the_version_before_says_the_same(fmpy, tmp_path):
    from fmpy.fmi2 import FMU2Model

    plant = machine({"law": "lugre", "viscous": 0.02}, {"name": "cogging", "cosine": 0.1})
    newer = Exchanged(fmpy, plant, tmp_path)
    values = [0.01, 0.3, 0.0, 0.2, 0.5, 0.1]
    newer.at(values)
    path = tmp_path / "plant_fmi2.fmu"
    description = fmpy.read_model_description(str(path))
    assert description.modelExchange.providesDirectionalDerivative
    assert not description.coSimulation.providesDirectionalDerivative
    model = FMU2Model(
        guid=description.guid, unzipDirectory=fmpy.extract(str(path), str(path) + "-files"),
        modelIdentifier="plant", instanceName="it",
    )  # fmt: skip
    model.instantiate()
    model.enterInitializationMode()
    model.exitInitializationMode()
    model.enterContinuousTimeMode()
    model.setTime(values[0])
    model.setReal([newer.by_name["input"]], [values[1]])
    states = np.array(values[3:])
    model.setContinuousStates(pointer(states), 3)
    wanted = [newer.by_name[name] for name in newer.unknown]
    columns = [
        model.getDirectionalDerivative(wanted, [newer.by_name[name]], [1.0]) for name in newer.known
    ]
    assert np.array_equal(np.array(columns).T, newer.jacobian())
    model.freeInstance()


def slope(own, values, unknown="acceleration", known="position"):
    own.at(values)
    return own.jacobian()[own.unknown.index(unknown), own.known.index(known)]


def test_at_a_kink_it_is_that_of_the_side_where_motion_goes_on(fmpy, tmp_path):
    spring = {"law": "elastic_perfectly_plastic", "coulomb": 0.3, "initial_stiffness": 1000.0}
    own = Exchanged(fmpy, machine(spring), tmp_path)
    # Never moved, and just after a completed step: the spring, not half of it.
    assert slope(own, [0.0, 0.1, 0.0, 0.0, 0.0]) == -1000.0 / 0.01
    own.at([0.1, 0.1, 0.0, 1.0, 0.1])
    own.arrive()
    # At its level, exactly, it goes on sliding, or is unloaded.
    assert slope(own, [0.1, 0.3, 0.0, 1.0, 0.1]) == 0.0
    assert slope(own, [0.1, 0.3, 0.0, 1.0, -0.1]) == -1000.0 / 0.01
    own.model.freeInstance()


def test_a_slide_that_begins_has_the_slope_of_its_fall(fmpy, tmp_path):
    falls = {"law": "coulomb", "coulomb": 0.3, "breakaway": 0.45, "stribeck_velocity": 0.1}
    own = Exchanged(fmpy, machine(falls | {"stribeck_exponent": 1.0}), tmp_path)
    rest = [0.0, 0.5, 0.0, 0.0, 0.0]
    own.at(rest)
    own.arrive()
    assert slope(own, rest, "acceleration", "velocity") == pytest.approx(0.15 / 0.1 / 0.01)
    own.model.freeInstance()


def test_a_contact_that_sticks_moves_by_nothing_and_bears_what_is_added(fmpy, tmp_path):
    own = Exchanged(fmpy, machine({"law": "coulomb", "coulomb": 0.3}), tmp_path)
    rest = [0.0, 0.1, 0.0, 0.0, 0.0]
    own.at(rest)
    own.arrive()
    assert slope(own, rest, "acceleration", "input") == 0.0
    assert slope(own, rest, "velocity", "velocity") == 0.0
    assert slope(own, rest, "friction", "input") == 1.0
    assert slope(own, rest, "event_indicator", "input") == -1.0
    own.model.freeInstance()


def test_an_implicit_solver_takes_them_for_its_jacobian(fmpy, tmp_path):
    stiff = {"law": "lugre", "coulomb": 0.25, "breakaway": 0.4, "initial_stiffness": 3000.0}
    own = Exchanged(fmpy, machine(stiff | {"damping": 1.0}), tmp_path)

    asked = []

    def rhs(time, y):
        asked.append(time)
        return own.at([time, 0.6 * np.sin(20.0 * time), 0.0, *y])[:3]

    def jac(time, y):
        rhs(time, y)
        places = [own.known.index(name) for name in own.states]
        return own.jacobian()[:3][:, places]

    options = {"method": "Radau", "rtol": 1e-7, "atol": 1e-10}
    with_them = solve_ivp(rhs, (0.0, 0.3), np.zeros(3), jac=jac, **options)
    few = len(asked)
    without = solve_ivp(rhs, (0.0, 0.3), np.zeros(3), **options)
    own.model.freeInstance()
    assert few < len(asked) - few
    assert np.ptp(without.y[1]) > 0.1
    assert np.abs(with_them.y[:, -1] - without.y[:, -1]) == pytest.approx(0.0, abs=1e-6)


def test_co_simulation_offers_none(fmpy, tmp_path):
    path = machine(DRY).export("fmu").save(tmp_path)[0]
    model, by_name = opened(fmpy, path, "CoSimulation")
    model.enterInitializationMode()
    model.exitInitializationMode()
    with pytest.raises(fmpy.fmi1.FMICallException):
        model.getDirectionalDerivative([by_name["friction"]], [by_name["input"]], [1.0])
    model.freeInstance()
