"""Nothing reachable from Python panics, hangs or turns finite input into NaN."""

import math
import pickle
import re
import time

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as hs

import stiction as st

from .rigs import CONTACTS, contact, motor

LAWS = {law.name: law for law in st.laws()}
EFFECTS = {effect.name: effect for effect in st.effects()}
COMMON = {
    "deadline": None,
    "derandomize": True,
    "suppress_health_check": [HealthCheck.too_slow, HealthCheck.data_too_large],
}
# A single call on a few hundred samples takes milliseconds; this long means it hangs.
PATIENCE = 20.0


def answers(call):
    """The result of a call, or None where it was refused; a panic passes through and fails."""
    began = time.perf_counter()
    try:
        return call()
    except (st.InputError, TypeError, OverflowError):
        return None
    finally:
        assert time.perf_counter() - began < PATIENCE


any_float = hs.one_of(
    hs.floats(),
    hs.floats(-10.0, 10.0),
    hs.sampled_from([0.0, -0.0, 5e-324, 1e-300, 1e300, -1e300, 1.7e308, math.inf, math.nan]),
)
any_value = hs.one_of(
    any_float,
    hs.integers(),
    hs.booleans(),
    hs.none(),
    hs.text(max_size=8),
    hs.lists(any_float, max_size=4),
    hs.lists(hs.lists(any_float, min_size=2, max_size=2), max_size=5),
    hs.just(np.zeros((2, 2))),
    hs.just(np.zeros((0, 2))),
    hs.just(np.array(3.0)),
    hs.just(np.array([["a", "b"]])),
    hs.binary(max_size=3),
)


def within(spec):
    """A value inside a parameter's bounds: log-uniform where they span decades."""
    lower, upper = spec.bounds
    choices = [hs.just(spec.typical)]
    if math.isfinite(upper):
        choices += [hs.just(float(lower)), hs.just(float(upper)), hs.floats(lower, upper)]
    else:
        choices += [hs.just(float(lower)), hs.just(math.inf), hs.floats(lower, 1e9)]
    # Five decades around the typical value, clipped.
    near = hs.floats(-5.0, 5.0).map(
        lambda e: float(np.clip(abs(spec.typical) * 10.0**e, lower, upper))
    )
    return hs.one_of(near, near, near, *choices)


@hs.composite
def laws_within_bounds(draw):
    law = LAWS[draw(hs.sampled_from(sorted(LAWS)))]
    keywords = {}
    for spec in law.parameters:
        if draw(hs.integers(0, 2)):
            keywords[spec.name] = draw(within(spec))
    for option in law.options:
        if draw(hs.booleans()):
            keywords[option.name] = draw(hs.sampled_from([word for word, _ in option.choices]))
    return law.name, keywords


def built(definition):
    law, keywords = definition
    return answers(lambda: st.FrictionModel(law, **keywords))


MODERATE = hs.floats(-5.0, 1.0).flatmap(lambda e: hs.sampled_from([-(10.0**e), 10.0**e, 0.0]))


@settings(max_examples=400, **COMMON)
@given(
    definition=laws_within_bounds(),
    velocity=hs.lists(MODERATE, min_size=1, max_size=30),
    dt=hs.sampled_from([1e-6, 1e-4, 1e-2, 1.0]),
)
def test_every_law_within_its_bounds_gives_finite_forces(definition, velocity, dt):
    model = built(definition)
    if model is None:
        return
    force = model.simulate(np.repeat(velocity, 5), dt)
    # Largest force that any bounded parameter can make of these moves.
    if np.max(np.abs(force)) < 1e100:
        assert np.isfinite(force).all()
        value, slope = model.trial(velocity[0], dt)
        assert math.isfinite(value)
        assert math.isfinite(slope)
        assert pickle.loads(pickle.dumps(model)) == model
    else:
        assert not np.isnan(force).any()


def greatest_stiffness(parameters):
    """How fast friction changes with distance: on a spring, or over a slip distance."""
    if "evolution_effect" not in parameters:
        return parameters.get("initial_stiffness", 0.0)
    forgotten = parameters["coulomb"] * parameters["evolution_effect"] / parameters["slip_distance"]
    compliance = parameters["compliance"]
    return forgotten + (1.0 / compliance if compliance > 1e-30 else 0.0)


@settings(max_examples=150, **COMMON)
@given(
    definition=laws_within_bounds(),
    levels=hs.lists(MODERATE, min_size=1, max_size=12),
    inertia=hs.floats(-6.0, 3.0).map(lambda e: 10.0**e),
    dt=hs.sampled_from([1e-5, 1e-4, 1e-3]),
    integrator=hs.sampled_from(["fast", "reference"]),
)
def test_motors_on_every_law_stay_finite(definition, levels, inertia, dt, integrator):
    model = built(definition)
    # A sample is divided for the machine's stiffness, into 1e5 parts at most.
    if model is None or greatest_stiffness(model.parameters) * dt**2 / inertia > 1e2:
        return
    parameters = model.parameters
    if max(parameters.get("damping", 0.0), parameters.get("viscous", 0.0)) * dt / inertia > 10.0:
        return
    machine = st.Motor(inertia=inertia, friction=model, integrator=integrator)
    run = machine.simulate(np.repeat(levels, 10), dt, outputs=("position", "velocity", "friction"))
    assert run.success, run.message
    if not model.passive:
        return
    # Friction never pushes: the body has no more energy than the input brought.
    work = np.sum(np.repeat(levels, 10) * np.diff(run.position, prepend=0.0))
    kinetic = 0.5 * inertia * run.velocity[-1] ** 2
    reach = np.sum(np.abs(np.repeat(levels, 10) * np.diff(run.position, prepend=0.0)))
    assert kinetic <= work + 0.02 * reach + 1e-12


@settings(max_examples=300, **COMMON)
@given(
    law=hs.sampled_from(sorted(LAWS)),
    data=hs.data(),
)
def test_parameters_of_any_kind_are_taken_or_refused(law, data):
    names = [spec.name for spec in LAWS[law].parameters]
    names += [option.name for option in LAWS[law].options] + ["nonsense", "law"]
    keywords = data.draw(hs.dictionaries(hs.sampled_from(names), any_value, max_size=5))
    model = answers(lambda: st.FrictionModel(law, **keywords))
    if model is not None:
        assert repr(model)
        answers(lambda: model.step(0.1, 1e-3))


@settings(max_examples=300, **COMMON)
@given(kind=hs.sampled_from(sorted(CONTACTS)), data=hs.data())
def test_states_of_any_kind_are_taken_or_refused(kind, data):
    model = contact(kind)
    model.simulate(np.repeat([3e-3, -2e-3, 0.2, -0.01], 12), 1e-3)
    kept = model.state
    state = dict(kept)
    for name in data.draw(hs.lists(hs.sampled_from(sorted(state)), max_size=3, unique=True)):
        state[name] = data.draw(any_value)
    for name in data.draw(hs.lists(hs.sampled_from(sorted(state)), max_size=1)):
        if data.draw(hs.booleans()):
            del state[name]
    if data.draw(hs.integers(0, 9)) == 0:
        state[data.draw(hs.text(max_size=4))] = data.draw(any_value)

    def assign():
        model.state = state
        return True

    if answers(assign) is None:
        assert model.state.keys() == kept.keys()
        assert all(np.array_equal(model.state[name], kept[name]) for name in kept)
        return
    answers(lambda: model.simulate(np.repeat([1e-3, -1e-3, 0.1, 0.0, -0.1], 3), 1e-3))
    answers(lambda: model.trial(0.1, 1e-3))


SMALL = hs.floats(-1e-3, 1e-3)


@settings(max_examples=300, **COMMON)
@given(
    kind=hs.sampled_from(["sticking", "elastic", "hook", "same", "spring damper"]),
    points=hs.lists(hs.tuples(SMALL, hs.floats(-0.6, 0.6)), max_size=6),
    spring=SMALL,
    direction=hs.sampled_from([-1.0, 0.0, 1.0]),
    force=hs.floats(-0.6, 0.6),
    moves=hs.lists(hs.floats(-2.0, 2.0), min_size=1, max_size=10),
)
def test_reverse_points_that_are_taken_never_make_the_force_explode(
    kind, points, spring, direction, force, moves
):
    model = contact(kind)
    changes = {
        "reverse_points": np.array(points, dtype=float).reshape(-1, 2),
        "spring": spring,
        "direction": direction,
        "spring_force": force,
        "series_force": force,
    }

    def assign():
        model.state = model.state | changes
        return True

    if answers(assign) is None:
        return
    forces = model.simulate(np.array(moves) * 1e-3, 1.0)
    # No move here can load the spring further than its whole way at the greatest stiffness.
    way = np.sum(np.abs(moves)) * 1e-3 + 4e-3
    assert np.max(np.abs(forces)) < 2.0 + 3000.0 * way + 0.45 * 2e-3


CALLS = hs.sampled_from(
    [
        "step",
        "trial",
        "commit",
        "simulate",
        "batch",
        "reset",
        "copy",
        "pickle",
        "state",
        "repr",
        "equal",
        "rewind",
    ]
)


def call_model(model, name, a, b, kept):
    if name == "step":
        return model.step(a, b, load=b, effort=a)
    if name == "trial":
        return model.trial(a, b)
    if name == "commit":
        return model.commit()
    if name == "simulate":
        return model.simulate([a, 0.0, b], 1e-3)
    if name == "batch":
        return model.simulate([[a, b], [b, a]], abs(b))
    if name == "reset":
        return model.reset()
    if name == "copy":
        return model.copy().step(a, 1e-3)
    if name == "pickle":
        return pickle.loads(pickle.dumps(model))
    if name == "state":
        model.state = model.state
        return None
    if name == "repr":
        return repr(model)
    if name == "equal":
        return model == model.copy()
    model.state = kept
    return None


@settings(max_examples=200, **COMMON)
@given(
    kind=hs.sampled_from(sorted(CONTACTS)),
    calls=hs.lists(hs.tuples(CALLS, any_float, any_float), max_size=25),
)
def test_any_sequence_of_calls_on_a_model_is_answered(kind, calls):
    model = contact(kind)
    kept = model.state
    for name, a, b in calls:
        answers(lambda name=name, a=a, b=b: call_model(model, name, a, b, kept))
    # Whatever went before, a state that is put back is the one that was kept.
    model.state = kept
    assert model.step(0.01, 1e-3) == contact(kind).step(0.01, 1e-3)


def call_motor(machine, name, a, b, kept):
    if name == "step":
        return machine.step(a, b, load=b)
    if name == "trial":
        return machine.sensitivity([a, b], 1e-4, ["body.inertia"])
    if name == "commit":
        return machine.friction.step(a, b)
    if name == "simulate":
        return machine.simulate([a, 0.0, b], 1e-4).message
    if name == "batch":
        return machine.simulate([a, b], [abs(a), abs(b)], outputs=["velocity"])
    if name == "reset":
        return machine.reset(a, b)
    if name == "copy":
        return machine.copy().step(a, 1e-3)
    if name == "pickle":
        return pickle.loads(pickle.dumps(machine))
    if name == "state":
        machine.state = machine.state
        return None
    if name == "repr":
        return repr(machine)
    if name == "equal":
        return machine == machine.copy()
    machine.state = kept
    return None


@settings(max_examples=120, **COMMON)
@given(
    kind=hs.sampled_from(sorted(CONTACTS)),
    integrator=hs.sampled_from(["fast", "reference"]),
    calls=hs.lists(hs.tuples(CALLS, any_float, any_float), max_size=10),
)
def test_any_sequence_of_calls_on_a_motor_is_answered(kind, integrator, calls):
    machine = motor(kind, integrator=integrator)
    kept = machine.state
    for name, a, b in calls:
        answers(lambda name=name, a=a, b=b: call_motor(machine, name, a, b, kept))
    machine.state = kept
    assert machine.step(0.3, 1e-4) == motor(kind, integrator=integrator).step(0.3, 1e-4)


@settings(max_examples=120, **COMMON)
@given(
    settings_=hs.dictionaries(
        hs.sampled_from(
            [
                "inertia",
                "torque_constant",
                "gravity_amplitude",
                "gravity_zero",
                "weight",
                "input_limit",
                "count",
                "integrator",
                "effects",
                "nonsense",
            ]
        ),
        any_value,
        max_size=4,
    )
)
def test_motors_of_any_settings_are_built_or_refused(settings_):
    machine = answers(lambda: motor("hook", **settings_))
    if machine is not None:
        assert repr(machine)
        answers(lambda: machine.step(0.3, 1e-5))


@settings(max_examples=100, **COMMON)
@given(
    name=hs.sampled_from(sorted(EFFECTS)),
    data=hs.data(),
    integrator=hs.sampled_from(["fast", "reference"]),
)
def test_every_effect_within_its_bounds_gives_finite_motion(name, data, integrator):
    values = {
        spec.name: data.draw(within(spec)) * (1e-6 if abs(spec.bounds[1]) >= 1e9 else 1.0)
        for spec in EFFECTS[name].parameters
    }
    machine = answers(lambda: motor("hook", effects={name: values}, integrator=integrator))
    if machine is not None:
        try:
            run = machine.simulate(np.repeat([0.3, -0.7, 0.0], 20), 1e-4)
        except st.InputError as error:
            # A drive that saturates at a millionth of its input gives 10^9 times as much at 1, and
            # internal variables of a contact at 10^9 rad/s are dear; a gap of 10^-103 rad is stiff.
            assert re.search("more work than|too long for this machine", str(error))  # noqa: PT017
            return
        # Friction that falls with the square of speed drives the machine, which then runs away
        # by itself and says so.
        driven = values.get("quadratic", 0.0) < 0.0
        assert run.success or (driven and "ran away" in run.message)


@pytest.mark.parametrize("law", sorted(LAWS))
def test_every_parameter_works_at_its_neutral_and_at_its_typical_value(law):
    for spec in LAWS[law].parameters:
        for value in {spec.neutral, spec.typical} - {None}:
            # The hook needs a break-away to slide at all.
            hooked = any(other.name == "breakaway" for other in LAWS[law].parameters)
            keywords = ({"breakaway": 0.5} if hooked else {}) | {spec.name: value}
            model = st.FrictionModel(law, **keywords)
            forces = model.simulate(np.repeat([1e-3, 0.2, -1e-3, -0.3, 0.0], 30), 1e-3)
            assert np.isfinite(forces).all(), spec.name
            assert np.isfinite(model.trial(1e-3, 1e-3)).all(), spec.name
            machine = st.Motor(inertia=0.0076, friction=st.FrictionModel(law, **keywords))
            run = machine.simulate(np.repeat([0.2, 0.7, -0.3], 50), 1e-3, outputs=["position"])
            assert run.success, spec.name
