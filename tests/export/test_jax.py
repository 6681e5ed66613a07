"""Derivatives through JAX: those of the core, and of differences."""

import numpy as np
import pytest

import stiction as st

jax = pytest.importorskip("jax")
jax.config.update("jax_enable_x64", True)
from stiction.jax import simulate  # noqa: E402

from .gradient_rigs import DT, RIGS, current, machine, values  # noqa: E402

STEP = 1e-6
NEAR = 1e-5
"""What a difference over such a step is good for."""


def squares(law, own, inputs, load=None, velocity=0.0):
    """A loss that hangs on all samples of the position, and of the velocity where it counts."""
    position, speed = simulate(machine(law), own, inputs, DT, load=load)
    return jax.numpy.sum(position**2) + velocity * jax.numpy.sum(speed**2)


@pytest.mark.parametrize("law", RIGS)
def test_it_is_the_simulation_of_the_motor(law):
    position, velocity = jax.jit(lambda u: simulate(machine(law), {}, u, DT))(current())
    run = machine(law).simulate(current(), DT)
    assert np.asarray(position).tobytes() == run.position.tobytes()
    assert np.asarray(velocity).tobytes() == run.velocity.tobytes()
    assert np.ptp(run.velocity) > 0.1


@pytest.mark.parametrize("law", RIGS)
def test_derivatives_by_parameters_are_those_of_differences(law):
    own = values(law)
    assert len(own) >= 5
    exact = jax.jit(jax.grad(lambda v: squares(law, v, current(), velocity=1e-3)))(own)
    for path, value in own.items():
        step = STEP * max(abs(value), 1e-3)
        high, low = (
            squares(law, {**own, path: value + sign * step}, current(), velocity=1e-3)
            for sign in (1.0, -1.0)
        )
        chord = float(high - low) / (2.0 * step)
        assert float(exact[path]) == pytest.approx(chord, rel=NEAR), path


BEGUN = {"position": 0.4, "velocity": -0.6}
CONTACTS = {law.name: {each.name: 0.3 * each.typical for each in law.start} for law in st.laws()}
"""What the contact of each law brings along."""
OFTEN = ("coulomb", "hsieh_pan", "lugre", "maxwell_slip", "rate_and_state")


def moving(law, inputs, start, own=None, velocity=1e-3, load=None, **tables):
    """A loss that hangs on a motion from a start."""
    friction = {"law": law, **RIGS.get(law, {})}
    plant = st.Plant.from_dict(machine("coulomb").to_dict() | {"friction": friction} | tables)
    position, speed = simulate(plant, own or {}, inputs, DT, load=load, start=start)
    return jax.numpy.sum(position**2) + velocity * jax.numpy.sum(speed**2)


def along(loss, at, which):
    """Derivative of a loss in some direction of one of its arguments, exact and by a difference."""
    way = np.random.default_rng(0).standard_normal(np.shape(at[which]))
    exact = jax.grad(loss, which)(*at) @ way
    moved = [
        loss(*(each + (k == which) * sign * STEP * way for k, each in enumerate(at)))
        for sign in (1.0, -1.0)
    ]
    return float(exact), float(moved[0] - moved[1]) / (2.0 * STEP)


@pytest.mark.parametrize(
    "law", [pytest.param(n, marks=() if n in OFTEN else pytest.mark.slow) for n in CONTACTS]
)
def test_derivatives_by_input_and_load_are_those_of_differences(law):
    at = 0.2 * current(60), np.full(60, 0.02)

    def loss(inputs, load):
        return moving(law, inputs, BEGUN, load=load)

    for which in (0, 1):
        exact, chord = along(loss, at, which)
        assert exact == pytest.approx(chord, rel=1e-4), which


SERVO = {"kind": "servo", "proportional": 3.0, "integral": 2.0, "supply_v": 12.0,
         "resistance_ohm": 3.7, "torque_constant": 0.5, "current_limit_a": 2.5}  # fmt: skip
ON_THE_WAY = (
    "back_emf", "current_loop_lag", "drive_deadband", "drive_saturation", "goal_rate_limit",
    "input_delay", "load_dependent_friction", "shaft_compliance", "torque_constant_ripple",
    "torque_constant_saturation", "voltage_limit",
)  # fmt: skip


@pytest.mark.parametrize("servo", [False, True])
@pytest.mark.parametrize("name", ON_THE_WAY)
def test_effects_on_the_way_of_the_input_are_in_its_derivative(name, servo):
    record = next(each for each in st.effects() if each.name == name)
    if record.impossible("rotary", servo=servo):
        pytest.skip("there is no such plant")
    effect = {"name": name, **{each.name: each.typical for each in record.parameters}}
    effect |= {"share": 0.6} if "share" in effect else {}
    tables = {"effects": [effect, {"name": "cogging", "cosine": 0.02}]}
    tables |= {"drive": SERVO} if servo else {}
    # A part of it is beyond the limits, and a part is not; a servo makes volts of it.
    inputs = 0.2 * current(60) + 0.15 if servo else current(60) + 0.3

    def loss(given):
        return moving("coulomb", given, {"position": 0.1, "velocity": 0.0}, **tables)

    exact, chord = along(loss, (inputs,), 0)
    assert exact == pytest.approx(chord, rel=1e-4, abs=1e-12)
    assert exact != 0.0


def test_what_is_on_its_way_counts_in_uneven_samples_too():
    late = {"name": "input_delay", "delay": 0.0037}
    plant = st.Plant.from_dict(machine("coulomb").to_dict() | {"effects": [late]})
    source = np.random.default_rng(1)
    inputs, spans = 3.0 * source.standard_normal(40), source.uniform(5e-4, 3e-3, 40)
    weights = source.standard_normal((2, 40))
    exact = plant.motor().gradient(inputs, spans, *weights)

    def loss(given):
        run = plant.simulate(given, spans)
        return run.position @ weights[0] + run.velocity @ weights[1]

    steps = STEP * np.eye(40)
    chords = [(loss(inputs + step) - loss(inputs - step)) / (2.0 * STEP) for step in steps]
    assert exact == pytest.approx(chords, rel=1e-4, abs=1e-7)
    assert not np.any(exact[-1:])  # it has not arrived when the last sample ends


@pytest.mark.parametrize(
    "law", [pytest.param(n, marks=() if n in OFTEN else pytest.mark.slow) for n in CONTACTS]
)
def test_derivatives_by_the_start_are_those_of_differences(law):
    start, inputs = BEGUN | CONTACTS[law], 0.2 * current(60)
    exact = jax.jit(jax.grad(lambda begun: moving(law, inputs, begun)))(start)
    assert all(float(exact[name]) != 0.0 for name in BEGUN)
    for name, value in start.items():
        step = STEP * max(abs(value), 1e-3)
        high, low = (
            moving(law, inputs, {**start, name: value + sign * step}) for sign in (1.0, -1.0)
        )
        chord = float(high - low) / (2.0 * step)
        assert float(exact[name]) == pytest.approx(chord, rel=1e-4, abs=1e-7), name


@pytest.mark.parametrize("name", ["shaft_compliance", "backlash", "cogging"])
def test_a_second_mass_starts_with_the_first(name):
    record = next(each for each in st.effects() if each.name == name)
    effect = {"name": name, **{each.name: each.typical for each in record.parameters}}

    def loss(begun):
        return moving("coulomb", 0.2 * current(60), begun, effects=[effect])

    exact = jax.grad(loss)(BEGUN)
    for own, value in BEGUN.items():
        high, low = (loss({**BEGUN, own: value + sign * STEP}) for sign in (1.0, -1.0))
        assert float(exact[own]) == pytest.approx(float(high - low) / (2.0 * STEP), rel=NEAR)


def test_a_start_is_where_a_motor_is_put():
    motor = machine("coulomb").motor()
    motor.reset(**BEGUN)
    run = motor.simulate(current(), DT)
    position, velocity = simulate(machine("coulomb"), {}, current(), DT, start=BEGUN)
    assert np.asarray(position).tobytes() == run.position.tobytes()
    assert np.asarray(velocity).tobytes() == run.velocity.tobytes()
    # A motor keeps what its contact remembers where only its body is put elsewhere.
    motor = machine("lugre").motor()
    motor.simulate(current(), DT)
    begun = {name: motor.state[name] for name in BEGUN}
    position, _ = simulate(motor, {}, current(), DT, start=begun)
    assert np.asarray(position).tolist() == motor.simulate(current(), DT).position.tolist()


def test_start_input_and_parameters_go_together_and_in_batches():
    inputs, start = 0.2 * current(40), BEGUN | {"force": 0.1}

    def loss(begun, own, u):
        return moving("lugre", u, begun, own, velocity=0.0)

    by_start, by_own, by_input = jax.grad(loss, (0, 1, 2))(start, {"coulomb": 0.3}, inputs)
    way = np.random.default_rng(0).standard_normal(len(inputs))
    high, low = (loss(start, {"coulomb": 0.3}, inputs + s * STEP * way) for s in (1.0, -1.0))
    assert float(by_input @ way) == pytest.approx(float(high - low) / (2.0 * STEP), rel=1e-4)
    high, low = (loss(start, {"coulomb": 0.3 + s * STEP}, inputs) for s in (1.0, -1.0))
    assert float(by_own["coulomb"]) == pytest.approx(float(high - low) / (2.0 * STEP), rel=1e-4)
    places = np.array([0.1, 0.4])
    rows = jax.vmap(jax.grad(lambda x: loss({**start, "position": x}, {"coulomb": 0.3}, inputs)))
    assert float(rows(places)[1]) == pytest.approx(float(by_start["position"]), rel=1e-12)


def test_a_servo_has_derivatives_by_its_start():
    servo = st.Plant.from_dict(machine("coulomb").to_dict() | {"drive": SERVO})

    def loss(x):
        return jax.numpy.sum(
            simulate(servo, {}, np.full(50, 0.5), 1e-3, start={"position": x})[0] ** 2
        )

    chord = float(loss(0.1 + STEP) - loss(0.1 - STEP)) / (2.0 * STEP)
    assert float(jax.grad(loss)(0.1)) == pytest.approx(chord, rel=NEAR)


def test_batches_go_over_parameters_and_inputs():
    levels, inputs = np.array([0.1, 0.2, 0.3]), np.stack([current(), 0.7 * current()])

    def loss(level, u):
        return squares("coulomb", {"friction.coulomb": level}, u)

    gradient = jax.grad(loss, (0, 1))
    table = jax.jit(jax.vmap(jax.vmap(gradient, (0, None)), (None, 0)))(levels, inputs)
    for k, row in enumerate(inputs):
        for j, level in enumerate(levels):
            by_level, by_input = gradient(level, row)
            assert float(table[0][k, j]) == pytest.approx(float(by_level), rel=1e-12)
            assert np.asarray(table[1][k, j]) == pytest.approx(np.asarray(by_input), rel=1e-12)


def test_a_motor_goes_on_from_where_it_is():
    motor = machine("lugre").motor()
    motor.simulate(current(), DT)
    begun = motor.state
    position, _ = simulate(motor, {}, current(), DT)
    assert motor.state["position"] == begun["position"]
    assert np.asarray(position).tolist() == motor.simulate(current(), DT).position.tolist()


def plain(**friction):
    return st.Plant.from_dict(
        {"drive": {"gain": 1.0}, "body": {"inertia": 0.01},
         "friction": {"law": "coulomb", **friction}}
    )  # fmt: skip


def test_what_follows_a_parameter_by_default_moves_with_that_of_a_plant():
    # A fit of dry friction states no break-away: another level is that of rest as well.
    effort = 0.3 * np.sin(40.0 * 1e-3 * np.arange(400))
    for stated in (plain(), plain(coulomb=0.2)):
        for level in (0.1, 0.25):
            position, _ = simulate(stated, {"coulomb": level}, effort, 1e-3)
            own = plain(coulomb=level).simulate(effort, 1e-3).position
            assert np.asarray(position).tobytes() == own.tobytes()
            assert np.any(own)

    def loss(level):
        return jax.numpy.sum(simulate(plain(coulomb=0.2), {"coulomb": level}, effort, 1e-3)[0] ** 2)

    chord = float(loss(0.1 + STEP) - loss(0.1 - STEP)) / (2.0 * STEP)
    assert float(jax.grad(loss)(0.1)) == pytest.approx(chord, rel=NEAR)


def test_what_a_plant_states_and_what_a_motor_has_stays():
    for machine_of in (plain(coulomb=0.2, breakaway=0.35), plain().motor()):
        # Break-away is 0.35 N·m: 0.3 N·m move nothing.
        position, _ = simulate(machine_of, {"coulomb": 0.1}, np.full(20, 0.3), 1e-3)
        assert not np.any(np.asarray(position))


def test_refusals_are_sentences():
    with pytest.raises(st.InputError, match="nonsense"):
        simulate(machine("coulomb"), {"nonsense": 1.0}, current(), DT)
    with pytest.raises(st.InputError, match="start"):
        simulate(machine("coulomb"), {}, current(), DT, start={"force": 0.1})
    with pytest.raises(st.InputError, match=r"give \(n,\) each"):
        simulate(machine("coulomb"), {}, np.zeros((2, 3)), DT)
    for number in (-0.1, np.nan):
        with pytest.raises(st.InputError, match=r"^coulomb = .* is out of bounds|not a .*number"):
            simulate(machine("coulomb"), {"friction.coulomb": number}, current(), DT)
    with pytest.raises(st.InputError, match=r"^coulomb = -0.1 is out of bounds"):
        jax.grad(lambda v: squares("coulomb", v, current()))({"friction.coulomb": -0.1})
    jax.config.update("jax_enable_x64", False)
    try:
        with pytest.raises(st.InputError, match="single precision"):
            simulate(machine("lugre"), {}, current(), DT)
    finally:
        jax.config.update("jax_enable_x64", True)
