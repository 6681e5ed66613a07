"""A friction model with effects: every law of the catalogue with every effect at the contact."""

from __future__ import annotations

import copy
import json
import logging
import pickle

import numpy as np
import pytest

import stiction as st

from .rigs import pieces, same_state, wandering_velocity

DT = 1e-3
LAWS = [record.name for record in st.laws()]
RECORDS = {record.name: record for record in st.effects()}
AT_CONTACT = [name for name, record in RECORDS.items() if record.at_contact]
ELSEWHERE = [name for name, record in RECORDS.items() if not record.at_contact]
PAIRS = [(law, effect) for law in LAWS for effect in AT_CONTACT]
# Shapes by their units, of the size of the motion below, so that every effect has passed much of
# its way in it.
SIZES = {"rad": 5e-3, "rad/s": 0.05, "s": 0.05, "N·m/s": 20.0}
# The positions of a motor are rounded, so that its velocities are not quite those of the model.
LEVEL = 0.35
ROUNDED = 1e-9 * LEVEL
# Round-off of a central difference, and its error of second order on the steepest of the curves.
SLOPE_TOLERANCE = 2e-5


def drawn(name):
    """Parameters at which an effect acts in the motion below."""
    record = RECORDS[name]
    return {
        p.name: SIZES.get(p.unit, p.typical) if p.name not in record.gains else p.typical
        for p in record.parameters
    }


# A law that never slides has no level that load and creep could be measured by.
STATED = {"hsieh_pan": {"breakaway": 0.5}}


def law_of(law):
    return st.FrictionModel(law, **STATED.get(law, {}))


def model_of(law, *effects):
    effects = {name: drawn(name) for name in effects}
    return st.FrictionModel(law, effects=effects, **STATED.get(law, {}))


def motion(seed, n=120):
    """Velocities, and what else reaches the contact."""
    rng = np.random.default_rng(seed)
    channels = {
        "load": np.repeat(rng.uniform(-0.3, 0.3, n), rng.integers(1, 9, n))[:n],
        "effort": np.repeat(rng.uniform(-0.8, 0.8, n), rng.integers(1, 9, n))[:n],
        "temperature": 25.0 + 20.0 * np.sin(np.arange(n) * 0.1 + seed),
    }
    return wandering_velocity(seed, n), channels


def along(channels, k):
    return {name: float(values[k]) for name, values in channels.items()}


def followed(motor, velocity, channels):
    """Friction less added efforts of a motor that is moved sample by sample at held velocities."""
    position, needed = motor.state["position"], []
    for k, v in enumerate(velocity.tolist()):
        onward = position + v * DT
        _, ambient, friction, _ = motor.follow(
            st.Motion(
                np.array([position, onward]),
                channels["effort"][k : k + 1] - channels["load"][k : k + 1],
                DT,
                load=channels["load"][k : k + 1],
                temperature=channels["temperature"][k : k + 1],
            )
        )
        needed.append(friction[0] - ambient[0])
        position = onward
    return np.array(needed)


@pytest.mark.parametrize(("law", "effect"), PAIRS)
def test_it_is_what_a_motor_needs_along_the_same_motion(law, effect):
    velocity, channels = motion(len(law) + len(effect))
    model = model_of(law, effect)
    motor = st.Motor(1.0, friction=law_of(law), effects={effect: drawn(effect)})
    found = model.simulate(velocity, DT, **channels)
    assert np.abs(found - followed(motor, velocity, channels)).max() < ROUNDED


@pytest.mark.parametrize("effect", AT_CONTACT)
def test_an_effect_acts_on_every_law_that_can_feel_it(effect):
    velocity, channels = motion(6)
    unmoved = []
    for law in LAWS:
        found = model_of(law, effect).simulate(velocity, DT, **channels)
        alone = law_of(law).simulate(velocity, DT, **channels)
        if np.abs(found - alone).max() < 1e-4 * LEVEL:
            unmoved.append(law)
    # What creeps moves nothing of a contact that does not give way.
    rigid = {"coulomb", "load_dependent", "rigid_perfectly_plastic"}
    assert set(unmoved) <= (rigid if "state relaxation" in RECORDS[effect].hooks else set())


@pytest.mark.parametrize(("law", "effect"), PAIRS)
def test_every_way_through_the_same_samples_has_the_same_bits(law, effect):
    velocity, channels = motion(7)
    whole, stepped, tried, chunked = (model_of(law, effect) for _ in range(4))
    found = whole.simulate(velocity, DT, **channels)
    for k, v in enumerate(velocity.tolist()):
        around = along(channels, k)
        assert stepped.step(v, DT, **around) == found[k]
        before = tried.state
        tried.trial(-2.0 * v, DT, **around)  # a host's first guess
        force, slope = tried.trial(v, DT, **around)
        assert same_state(tried.state, before)
        assert force == found[k]
        assert np.isfinite(slope)
        tried.commit()
    parts = [
        chunked.simulate(velocity[p], DT, **{n: c[p] for n, c in channels.items()})
        for p in pieces(len(velocity), 3)
    ]
    assert np.array_equal(np.concatenate(parts), found)
    assert whole == stepped == tried == chunked
    rows = np.stack([velocity, -velocity])
    both = {name: np.stack([values, values]) for name, values in channels.items()}
    kept = whole.copy()
    batch = whole.simulate(rows, DT, **both)
    assert whole == kept
    assert np.array_equal(batch[0], kept.simulate(velocity, DT, **channels))


def by_state(model):
    other = st.FrictionModel(model.law, effects=model.effects, **STATED.get(model.law, {}))
    other.state = model.state
    return other


def by_json(model):
    """As a host keeps it in a file."""
    rows = {n: v.tolist() if isinstance(v, np.ndarray) else v for n, v in model.state.items()}
    effects = json.loads(json.dumps(model.effects))
    other = st.FrictionModel(model.law, effects=effects, **STATED.get(model.law, {}))
    other.state = json.loads(json.dumps(rows))
    return other


DUPLICATES = {
    "copy()": lambda model: model.copy(),
    "deepcopy": copy.deepcopy,
    "pickle": lambda model: pickle.loads(pickle.dumps(model)),
    "state": by_state,
    "JSON": by_json,
    "motor": lambda model: st.Motor(1.0, friction=model).friction_model(),
}


@pytest.mark.parametrize("effect", AT_CONTACT)
@pytest.mark.parametrize("duplicate", DUPLICATES.values(), ids=DUPLICATES.keys())
def test_a_duplicate_continues_to_the_bit(duplicate, effect):
    velocity, channels = motion(3)
    for law in LAWS:
        model = model_of(law, effect, *(["stribeck"] if effect != "stribeck" else []))
        model.simulate(velocity, DT, **channels)
        other = duplicate(model)
        assert other is not model
        assert other == model, law
        assert same_state(other.state, model.state)
        again = model.simulate(velocity[::-1], DT, **channels)
        assert np.array_equal(again, other.simulate(velocity[::-1], DT, **channels)), law
        assert other == model


@pytest.mark.parametrize("law", LAWS)
def test_all_effects_at_once_are_what_a_motor_has_of_them(law):
    velocity, channels = motion(11)
    model = model_of(law, *AT_CONTACT)
    effects = {name: drawn(name) for name in AT_CONTACT}
    motor = st.Motor(1.0, friction=law_of(law), effects=effects)
    found = model.simulate(velocity, DT, **channels)
    assert np.abs(found - followed(motor, velocity, channels)).max() < ROUNDED
    shown = motor.parameters
    assert all(shown[path] == v for path, v in model.parameters.items() if path in shown)
    assert {p for p in shown if p.startswith("effects.")} <= model.parameters.keys()


def chord_and_slope(model, velocity, channels):
    step = 1e-6 * max(abs(velocity), 1e-3)
    force, slope = model.trial(velocity, DT, **channels)
    above = model.trial(velocity + step, DT, **channels)[0]
    below = model.trial(velocity - step, DT, **channels)[0]
    blur = 4e-16 * max(abs(force), LEVEL) / step
    return (above - below) / (2.0 * step), slope, blur, (above - 2.0 * force + below) / step


@pytest.mark.parametrize(("law", "effect"), PAIRS)
def test_the_slope_is_the_central_difference_of_the_force(law, effect):
    velocity, channels = motion(5, 60)
    model = model_of(law, effect)
    rng = np.random.default_rng(len(law) * len(effect))
    told = 0
    for k, v in enumerate(velocity.tolist()):
        around = along(channels, k)
        probed = float(rng.uniform(-0.2, 0.2))
        chord, slope, blur, kink = chord_and_slope(model, probed, around)
        scale = abs(chord) + abs(slope) + 1e-2
        if abs(kink) < 0.1 * SLOPE_TOLERANCE * scale + 8.0 * blur:  # no corner between the three
            told += 1
            assert abs(slope - chord) < SLOPE_TOLERANCE * scale + 8.0 * blur, (k, probed)
        model.step(v, DT, **around)
    assert told > 30


def with_parameter(model, path, value):
    """The same contact in the same state, with another value of a parameter."""
    keywords = {n: v for n, v in model.parameters.items() if not n.startswith("effects.")}
    effects = model.effects
    if path in keywords:
        keywords[path] = value
    else:
        _, effect, name = path.split(".")
        effects[effect][name] = value
    other = st.FrictionModel(model.law, effects=effects, **keywords, **model.options)
    other.state = model.state
    return other


@pytest.mark.parametrize("effect", ["", *AT_CONTACT])
def test_derivatives_by_inputs_and_parameters_are_central_differences(effect):
    velocity, channels = motion(9, 60)
    told = 0
    for law in LAWS:
        model = model_of(law, *([effect] if effect else []))
        model.simulate(velocity, DT, **channels)
        around = along(channels, 3)
        force, inputs, parameters = model.derivatives(0.13, DT, **around)
        kept = model.copy()
        assert (force, inputs["velocity"]) == kept.trial(0.13, DT, **around)
        assert parameters.keys() == model.parameters.keys()
        for name in ("effort", "load"):
            ends = [{**around, name: around[name] + sign * 1e-6} for sign in (1.0, -1.0)]
            above, below = (model.trial(0.13, DT, **end)[0] for end in ends)
            assert inputs[name] == pytest.approx((above - below) / 2e-6, abs=1e-7)
        for path, value in model.parameters.items():
            if not np.isfinite(value):
                assert parameters[path] == 0.0
                continue
            step = 1e-6 * abs(value)
            if step == 0.0:
                continue
            try:
                ends = [with_parameter(model, path, value + sign * step) for sign in (1, -1)]
            except st.InputError:  # at one of its bounds
                continue
            above, below = (end.trial(0.13, DT, **around)[0] for end in ends)
            if abs(above - 2.0 * force + below) > 1e-10:
                continue  # a corner
            chord = (above - below) / (2.0 * step)
            scale = abs(chord) + abs(parameters[path]) + 1e-2 * abs(force / value)
            assert abs(parameters[path] - chord) < 1e-4 * scale, (law, path)
            told += 1
    assert told > 4 * len(LAWS)


@pytest.mark.parametrize("effect", AT_CONTACT)
def test_at_its_neutral_point_an_effect_changes_no_bit(effect):
    velocity, channels = motion(2)
    neutral = {p.name: p.neutral for p in RECORDS[effect].parameters if p.neutral is not None}
    for law in LAWS:
        model = st.FrictionModel(law, effects={effect: neutral})
        plain = st.FrictionModel(law)
        for k, v in enumerate(velocity.tolist()):
            around = along(channels, k)
            assert model.trial(v, DT, **around) == plain.trial(v, DT, **around)
            assert model.step(v, DT, **around) == plain.step(v, DT, **around)


# One law whose equation is one line, and effects written out a second time.


def slid(model, velocity, **channels):
    return model.simulate(velocity, DT, **channels)


def coulomb(**effects):
    return st.FrictionModel("coulomb", coulomb=0.35, viscous=0.1, effects=effects)


def test_effects_by_speed_place_clock_and_path_are_their_equations():
    n = 400
    velocity = 0.3 * np.sin(np.arange(1, n + 1) * 0.02) + 0.05
    x, t = np.cumsum(velocity * DT), np.arange(1, n + 1) * DT
    path, s = np.cumsum(np.abs(velocity * DT)), np.sign(velocity)
    temperature, load = 25.0 + 40.0 * t, 0.2 * np.cos(3.0 * t)
    model = coulomb(
        stribeck={"excess": 0.3, "velocity": 0.1},
        direction_asymmetry={"coulomb": 0.1, "viscous": 0.2, "velocity": 0.02},
        position_dependent_friction={"cosine": 0.1, "sine": -0.2, "order": 40.0},
        warm_up={"coulomb": 0.3, "viscous": 0.4, "time": 0.2},
        run_in={"coulomb": 0.2, "distance": 0.03},
        temperature_dependent_friction={"coulomb": 0.005, "viscous": 0.01, "reference": 25.0},
        load_dependent_friction={"drive": 0.3, "back_drive": 0.1, "velocity": 0.02},
        effort_dependent_friction={"share": 0.2},
        cogging={"cosine": 0.02, "sine": 0.03, "order": 60.0},
        gravity_unbalance={"cosine": 0.01, "sine": 0.05},
        torque_bias={"bias": 0.015},
        viscous_quadratic={"quadratic": 0.4},
    )
    effort = 0.4 * np.sin(5.0 * t)
    found = slid(model, velocity, temperature=temperature, load=load, effort=effort)
    forward = velocity / np.hypot(velocity, 0.02)
    warm, colder = -np.expm1(-t / 0.2), 25.0 - temperature
    level = (
        1.0
        + 0.3 * np.exp(-((velocity / 0.1) ** 2))
        + 0.1 * forward
        + 0.1 * np.cos(40.0 * x)
        - 0.2 * np.sin(40.0 * x)
        - 0.3 * warm
        + 0.2 * np.expm1(-path / 0.03)
        + 0.005 * colder
        + (0.2 * np.abs(load) - 0.1 * load * forward) / 0.35
    )
    added = (
        0.02 * np.cos(60.0 * x)
        + 0.03 * np.sin(60.0 * x)
        + 0.01 * np.cos(x)
        + 0.05 * np.sin(x)
        + 0.015
        - 0.4 * velocity * np.abs(velocity)
    )
    # All effort but friction and the load: what effects add as well.
    level += 0.2 * np.abs(effort + added - load) / 0.35
    viscous = 1.0 + 0.2 * forward - 0.4 * warm + 0.01 * colder
    wanted = 0.35 * level * s + 0.1 * viscous * velocity - added
    assert np.abs(found - wanted).max() < 1e-12
    assert model.state["position"] == pytest.approx(x[-1], rel=1e-12)
    assert model.state["path"] == pytest.approx(path[-1], rel=1e-12)
    assert model.state["time"] == pytest.approx(t[-1], rel=1e-12)


def test_frictional_lag_follows_the_speed_by_its_time_constant():
    velocity = np.concatenate((np.full(100, 0.02), np.full(200, 0.2)))
    model = coulomb(frictional_lag={"excess": 0.4, "velocity": 0.1, "time": 0.05, "fall": 1.0})
    found = slid(model, velocity)
    late = np.empty(300)
    followed_speed = 0.0
    for k, v in enumerate(velocity):
        followed_speed += (v - followed_speed) * -np.expm1(-DT / 0.05)
        late[k] = followed_speed
    wanted = 0.35 * (1.0 + 0.4 * np.exp(-((late / 0.1) ** 2))) + 0.1 * velocity
    assert np.abs(found - wanted).max() < 1e-12


def test_a_rest_strengthens_the_contact_and_a_slide_wipes_that_out():
    model = coulomb(
        dwell_strengthening={"strength": 0.5, "time": 0.4, "distance": 0.01, "window": 1e-4}
    )
    slide = np.full(2000, 0.1)
    slid(model, slide)
    for rest in (0.1, 0.4, 2.0):
        slid(model, slide)
        slid(model, np.zeros(round(rest / DT)))
        first = model.step(1e-3, DT)
        gained = -np.expm1(-rest / 0.4)
        assert first == pytest.approx(0.35 * (1.0 + 0.5 * gained) + 1e-4, rel=1e-4)
        after = slid(model, np.full(100, 0.1))
        # What is still there after a slide of one length.
        assert after[-1] == pytest.approx(
            0.35 * (1.0 + 0.5 * gained * np.exp(-1.0)) + 0.01, rel=2e-3
        )


def test_a_resting_contact_returns_the_effort_clipped_to_its_present_level():
    model = coulomb(
        position_dependent_friction={"cosine": 0.5, "order": 10.0}, torque_bias={"bias": 0.05}
    )
    model.reset(0.2)
    level = 0.35 * (1.0 + 0.5 * np.cos(10.0 * 0.2))
    for effort in (0.0, 0.1, -0.2, 3.0, -3.0):
        held = np.clip(effort + 0.05, -level, level) - 0.05
        assert model.step(0.0, DT, effort=effort) == pytest.approx(held, abs=1e-15)
        assert model.trial(0.0, DT, effort=effort)[0] == pytest.approx(held, abs=1e-15)
    # Nothing moves while it holds: u + load − F = 0.
    assert model.step(0.0, DT, effort=0.1) == pytest.approx(0.1, abs=1e-15)


def test_creep_lets_the_force_of_a_held_spring_fall():
    held = st.FrictionModel("dahl", effects={"relaxation": {"speed": 1e-4, "exponent": 2.0}})
    rigid = st.FrictionModel("dahl")
    for model in (held, rigid):
        slid(model, np.full(20, 1e-3))
    before = rigid.step(0.0, DT)
    assert held.step(0.0, 1.0) < 0.9 * before
    assert rigid.step(0.0, 1.0) == before


def test_an_effort_that_is_added_goes_into_an_equation_of_motion_with_its_sign():
    bias = st.FrictionModel("coulomb", coulomb=0.3, effects={"torque_bias": {"bias": 0.4}})
    held = bias.step(0.0, DT)
    assert -held == pytest.approx(
        0.1
    )  # J·a = 0 + 0 − F: along the bias that the contact cannot hold


# How it is made, shown and refused.


def test_it_prints_and_compares_with_its_effects():
    model = model_of("lugre", "cogging", "torque_bias")
    again = eval(repr(model), {"FrictionModel": st.FrictionModel})
    assert again == model
    assert again.effects == model.effects
    assert model.effects["cogging"] == drawn("cogging")
    assert model != model_of("lugre", "cogging")
    assert model != st.FrictionModel("lugre")
    assert model.parameters["effects.torque_bias.bias"] == 0.02
    assert model.parameters["coulomb"] == st.FrictionModel("lugre").parameters["coulomb"]
    assert not model.passive
    assert st.FrictionModel("lugre", effects={}) == st.FrictionModel("lugre")
    assert st.FrictionModel("lugre").effects == {}


def test_a_reset_takes_it_to_a_place_a_time_and_a_path():
    model = model_of("coulomb", "cogging", "warm_up", "run_in", "dwell_strengthening")
    fresh = model.copy()
    model.simulate(wandering_velocity(1, 100), DT)
    assert model != fresh
    model.reset()
    assert model == fresh
    model.reset(0.3, time=5.0, path=2.0)
    assert [model.state[n] for n in ("position", "time", "path")] == [0.3, 5.0, 2.0]
    with pytest.raises(st.InputError, match="position"):
        model.reset(float("nan"))
    plain = st.FrictionModel("coulomb")
    plain.reset(0.3, time=5.0, path=2.0)
    assert plain == st.FrictionModel("coulomb")


@pytest.mark.parametrize("effect", ELSEWHERE)
def test_an_effect_that_no_contact_has_is_refused_by_its_name(effect):
    with pytest.raises(st.InputError, match=effect):
        st.FrictionModel("coulomb", effects={effect: {}})


@pytest.mark.parametrize(
    ("effects", "said"),
    [
        ({"coging": {}}, "did you mean 'cogging'"),
        ({"cogging": {"cos": 1.0}}, "cos"),
        ({"cogging": 1.0}, "cogging"),
        (["cogging"], "dict"),
        ({"stribeck": {"excess": -1.0}}, "excess"),
    ],
)
def test_effects_that_are_none_are_refused_with_a_sentence(effects, said):
    with pytest.raises(st.InputError, match=said):
        st.FrictionModel("coulomb", effects=effects)


def test_a_state_of_a_law_alone_is_refused_and_nothing_has_changed():
    model = model_of("lugre", "cogging", "dwell_strengthening")
    model.simulate(wandering_velocity(1, 50), DT)
    kept = model.copy()
    for state in (
        st.FrictionModel("lugre").state,
        {**model.state, "effect_memory": np.zeros((1, 2))},
        {**model.state, "colour": 1.0},
        {**model.state, "time": float("nan")},
    ):
        with pytest.raises(st.InputError):
            model.state = state
        assert model == kept


# Between models, motors and plants.


@pytest.mark.parametrize("effect", AT_CONTACT)
def test_a_motor_takes_effects_over_and_goes_on_from_where_the_contact_is(effect):
    model = model_of("hsieh_pan", effect)
    given = {"inertia": 0.0076, "effects": {"backlash": {"gap": 1e-3}}}
    fresh = st.Motor(friction=model, **given)
    both = {effect: drawn(effect), "backlash": {"gap": 1e-3}}
    assert fresh == st.Motor(0.0076, friction=law_of("hsieh_pan"), effects=both)
    model.simulate(wandering_velocity(4, 80), DT)
    motor = st.Motor(friction=model, **given)
    for name, value in model.state.items():
        assert np.array_equal(motor.state[name], value), name
    assert motor.state["velocity"] == 0.0
    assert motor.friction.effects == {}
    assert np.isfinite(motor.simulate(np.full(50, 0.5), DT).position).all()
    assert pickle.loads(pickle.dumps(motor)) == motor


def test_an_effect_of_the_model_and_of_the_motor_is_refused():
    model = model_of("coulomb", "cogging")
    with pytest.raises(st.InputError, match="cogging is stated twice"):
        st.Motor(1.0, friction=model, effects={"cogging": {"cosine": 0.1}})


def test_the_friction_of_a_motor_in_motion_is_that_which_it_meets():
    model = model_of("lugre", "cogging", "warm_up", "dwell_strengthening")
    motor = st.Motor(0.01, friction=model)
    motor.simulate(0.6 * np.sin(np.arange(300) * 0.02), DT)
    contact, state = motor.friction_model(), motor.state
    assert contact.effects == model.effects
    for name, value in contact.state.items():
        assert np.array_equal(state[name], value), name


def found_by_a_diagnosis():
    """A plant whose law is not all of its friction."""
    return st.Plant.from_dict(
        {
            "body": {"inertia": 0.0076},
            "drive": {"input": "current_a", "gain": 1.0},
            "friction": {"law": "coulomb", "coulomb": 0.08},
            "effects": [
                {"name": "stribeck", "excess": 0.55, "velocity": 0.1},
                {"name": "viscous_quadratic", "quadratic": 0.02},
                {"name": "backlash", "gap": 1e-3},
                {"name": "input_delay", "delay": 1e-3},
            ],
        }
    )


def test_a_plant_hands_back_what_was_found(caplog):
    plant = found_by_a_diagnosis()
    with caplog.at_level(logging.WARNING, "stiction.motor"):
        model = plant.friction_model()
    assert "backlash, input_delay" in caplog.text
    assert list(model.effects) == ["stribeck", "viscous_quadratic"]
    assert slid(model, np.full(50, 0.02))[-1] == pytest.approx(
        plant.friction_curve([0.02])[0], rel=1e-9
    )
    # The law alone is a third less, and stays what it was.
    assert plant.motor().friction.step(0.02, DT) == pytest.approx(0.08)
    assert model.step(0.02, DT) > 0.12
    with pytest.raises(st.InputError, match="backlash, input_delay"):
        plant.friction_model(strict=True)


def test_nothing_is_said_where_nothing_is_left_out(caplog):
    table = found_by_a_diagnosis().to_dict()
    table["effects"] = table["effects"][:2]
    with caplog.at_level(logging.WARNING, "stiction.motor"):
        model = st.Plant.from_dict(table).friction_model(strict=True)
    assert caplog.text == ""
    assert len(model.effects) == 2


def test_friction_that_is_no_number_leaves_the_contact_as_it_is():
    model = st.FrictionModel("coulomb", effects={"viscous_quadratic": {"quadratic": 1e9}})
    model.reset(time=1e300)
    kept = model.copy()
    calls = [
        lambda: model.step(1e6, 1e6, effort=1e308, load=1e308),
        lambda: model.simulate([1e6, 1e6], 1e6, effort=1e308, load=1e308),
        lambda: model.trial(1e6, 1e6, effort=1e308, load=1e308),
    ]
    for call in calls:
        try:
            call()
        except st.InputError:
            assert model == kept
        model.state = kept.state
