"""No machine that nothing drives gains energy, whatever effects it has and how strong they are."""

import math

import numpy as np
import pytest

import stiction as st

LAWS = {law.name: law for law in st.laws()}
EFFECTS = {effect.name: effect for effect in st.effects()}
# A ring that nothing damps comes out as large as it was to about (ω·h)²/4, which is 1e-3 at the
# longest steps; of a level up to 4, at which they are not shortened, four times that.
OFF = 5e-3
SAMPLES = 200
RUNS_PER_EFFECT = 8
COARSER = 40.0


def wave(cosine, sine, order):
    """Potential of the effort a·cos(N·x) + b·sin(N·x)."""
    return lambda x: (sine * np.cos(order * x) - cosine * np.sin(order * x)) / order


# Efforts that are the same whatever the motion did: their work is a difference of potentials. What
# adds an effort and is not here may take energy alone.
POTENTIALS = {
    "cogging": lambda p: [
        wave(p["cosine"], p["sine"], p["order"]),
        wave(p["cosine_2"], p["sine_2"], p["order_2"]),
    ],
    "gravity_unbalance": lambda p: [wave(p["cosine"], p["sine"], 1.0)],
    "torque_bias": lambda p: [lambda x: -p["bias"] * x],
}


def drawn(random, spec):
    """A value anywhere in the bounds of a parameter, in half of all draws near the typical one."""
    low, high = spec.bounds
    if random.random() < 0.1:
        return float(random.choice([low, min(high, 1e9)]))
    size = math.log10(max(abs(low), min(abs(high), 1e9)))
    if random.random() < 0.5:
        value = abs(spec.typical or 1.0) * 10.0 ** random.uniform(-1.5, 1.5)
    else:
        value = 10.0 ** random.uniform(min(-3.0, size), size)
    return float(np.clip(value if random.random() < 0.5 or low >= 0 else -value, low, high))


def drawn_law(random, name):
    """A law, every other time with parameters near its typical ones."""
    stated = {}
    if random.random() < 0.5:
        for spec in LAWS[name].parameters:
            value = abs(spec.typical) * 10.0 ** random.uniform(-0.5, 0.5)
            stated[spec.name] = float(np.clip(value, *spec.bounds))
    try:
        return st.FrictionModel(name, **stated)
    except st.InputError:
        return st.FrictionModel(name)


def gain(law, effects, *, inertia, velocity, gravity, dt, temperature, integrator="fast"):
    """Energy that a run without any drive gains, as a share of all that goes to and fro in it."""
    machine = st.Motor(
        inertia,
        friction=law,
        effects=effects,
        gravity_amplitude=gravity,
        integrator=integrator,
    )
    start = 0.3
    # Refused where a sample would be divided into hundreds of steps: the same, and takes its time.
    machine.reset(start, velocity)
    machine.step(0.0, COARSER * dt, temperature=temperature)
    machine.reset(start, velocity)
    known = machine.parameters
    values = {
        name: {spec.name: known[f"effects.{name}.{spec.name}"] for spec in EFFECTS[name].parameters}
        for name in effects
    }
    shares = [v["inertia_share"] for v in values.values() if "inertia_share" in v]
    potentials = [wave(0.0, -gravity, 1.0)]
    for name, own in values.items():
        potentials += POTENTIALS[name](own) if name in POTENTIALS else []
    begin = 0.5 * inertia * velocity**2
    run = machine.simulate(np.zeros(SAMPLES), dt, temperature=temperature)
    # Of a second mass nobody sees the motion, so that of the motor alone counts while there is one:
    # less than all there is, and nothing is found that is not there.
    own = 0.5 * inertia * run.velocity**2 * (1.0 - max(shares, default=0.0))
    stored = sum(p(run.position) - p(start) for p in potentials)
    greatest = max(begin, float(np.max(np.abs(stored))))
    most = float(np.max(own + stored - begin))
    return most / greatest


def undriven(random, name):
    """A run with this effect and up to two others."""
    others = random.choice(sorted(EFFECTS), size=random.integers(0, 3), replace=False)
    effects = {}
    for each in dict.fromkeys([name, *map(str, others)]):
        effects[each] = {p.name: drawn(random, p) for p in EFFECTS[each].parameters}
    # Some laws are passive under a condition alone, and say whether it holds.
    law = next(
        law
        for law in (drawn_law(random, str(n)) for n in random.permutation(sorted(LAWS)))
        if law.passive
    )
    return law, effects, {
        "inertia": 10.0 ** random.uniform(-4.0, 1.0),
        "velocity": 10.0 ** random.uniform(-2.0, 2.0),
        "gravity": float(random.choice([0.0, 0.0, 1.0])),
        "dt": 10.0 ** random.uniform(-4.5, -2.5),
        "temperature": float(random.choice([-30.0, 20.0, 80.0, 300.0])),
        "integrator": str(random.choice(["fast", "fast", "fast", "reference"])),
    }  # fmt: skip


@pytest.mark.parametrize("name", sorted(EFFECTS))
def test_no_machine_that_nothing_drives_gains_energy(name):
    # Of the name, so that a new effect leaves the runs of the others as they are.
    random = np.random.default_rng([7, *name.encode()])
    ran = 0
    for _ in range(RUNS_PER_EFFECT):
        law, effects, around = undriven(random, name)
        try:
            gained = gain(law, effects, **around)
        except st.InputError:
            # A sample too long for a machine as stiff as that.
            continue
        ran += 1
        assert gained <= OFF, f"{law!r} with {effects} gains {gained} in {around}"
    assert ran > 0, "every run was refused"


@pytest.mark.parametrize(
    ("law", "effects", "temperature"),
    [
        ("lugre", {"temperature_dependent_friction": {"viscous": 1.0}}, 80.0),
        ("coulomb", {"temperature_dependent_friction": {"viscous": 1.0}}, 80.0),
        ("dahl", {"frictional_lag": {"excess": -3.0}}, None),
        ("dahl", {"frictional_lag": {"excess": 3.0, "fall": 1.0}}, None),
        ("hsieh_pan", {"direction_asymmetry": {"coulomb": -0.9, "viscous": -0.5}}, None),
        ("maxwell_slip", {"direction_asymmetry": {"coulomb": 0.9}}, None),
    ],
)
def test_levels_end_at_0_and_give_nothing_back_that_was_not_taken(law, effects, temperature):
    for velocity in (0.01, 1.0, 50.0):
        model = st.FrictionModel(law, viscous=0.05)
        machine = st.Motor(0.01, friction=model, effects=effects)
        machine.reset(0.0, velocity)
        run = machine.simulate(np.zeros(5000), 1e-3, temperature=temperature)
        assert run.success
        assert np.max(np.abs(run.velocity)) <= velocity * (1.0 + OFF)


def test_a_level_that_would_be_below_0_is_one_at_0():
    # Friction is lost to the last bit at 75 °C, and at a higher temperature there is no less.
    def run(temperature):
        effects = {"temperature_dependent_friction": {"coulomb": 0.02, "viscous": 0.02}}
        machine = st.Motor(0.01, friction=st.FrictionModel("coulomb", viscous=0.1), effects=effects)
        machine.reset(0.0, 3.0)
        return machine.simulate(np.zeros(100), 1e-3, temperature=temperature).velocity

    assert np.array_equal(run(75.0), run(300.0))
    assert np.array_equal(run(300.0), np.full(100, 3.0))


def test_what_a_contact_may_give_back_is_part_of_the_state():
    effects = {"frictional_lag": {"excess": 5.0, "fall": 1.0, "time": 0.003}}

    def machine():
        return st.Motor(0.01, friction=st.FrictionModel("dahl"), effects=effects)

    whole, parts = machine(), machine()
    for each in (whole, parts):
        each.reset(0.0, 0.2)
    want = whole.simulate(np.zeros(2000), 1e-4).velocity
    got = [parts.simulate(np.zeros(700), 1e-4).velocity]
    again = machine()
    again.state = parts.state
    got.append(again.simulate(np.zeros(1300), 1e-4).velocity)
    assert np.array_equal(np.concatenate(got), want)
    assert again.state["contact_work"] == whole.state["contact_work"]
