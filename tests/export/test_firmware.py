"""The C of each law and each effect, against the core and against equations by hand."""

import ctypes
import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import stiction as st
from stiction.export import fragments
from stiction.export.fragments import names_of

from .compiled import FLAGS, Compiled
from .test_steady import plant

LAWS = names_of("laws")
NEAR = 1e-12
"""Of the level, in doubles: round-off of the functions of two libraries."""
NEAR_FLOAT = 1e-5
SAMPLES = 3000


def record_of(law):
    return next(each for each in st.laws() if each.name == law)


def level_of(law, friction):
    """What differences are measured by: the level of sliding, or what was reached."""
    levels = [law.parameters.get(name, np.inf) for name in ("breakaway", "coulomb")]
    return min([*(each for each in levels if 0.0 < each < np.inf), np.max(np.abs(friction))])


def motion(rng, law, samples=SAMPLES):
    """Velocities of all sizes that are held for a while, turned round and stopped, and times.

    Far from where it began the core would have fewer digits of a position: long slides lead back.
    """
    reach = 0.5 / law.parameters.get("initial_stiffness", 3000.0)
    dt = 10.0 ** rng.uniform(-4.0, -2.3, samples)
    velocity, place, k = np.zeros(samples), 0.0, 0
    while k < samples:
        run = slice(k, min(k + int(rng.integers(1, 60)), samples))
        number = run.stop - run.start
        scale = 10.0 ** rng.uniform(-2.0, 2.2) * reach / 0.05
        back = -np.sign(place) if abs(place) > 10.0 * reach else rng.choice([-1.0, 1.0])
        waves = np.sin(2.0 * np.pi * np.arange(number) / number)
        shapes = [0.0, back, waves, rng.standard_normal(number)]
        velocity[run] = scale * shapes[rng.integers(4)]
        place += float(velocity[run] @ dt[run])
        k = run.stop
    effort = rng.uniform(-1.0, 1.0, samples)
    load = rng.uniform(-0.5, 0.5, samples)
    return velocity, dt, effort, load


def along(law, velocity, dt, effort, load):
    """Friction of the core."""
    own, made = law.copy(), []
    for v, t, e, q in zip(velocity, dt, effort, load, strict=True):
        made.append(own.step(float(v), float(t), effort=float(e), load=float(q)))
    return np.array(made)


def drawn(name, rng):
    """Parameters about the typical ones, optional ones among them; None where they do not go."""
    record = record_of(name)
    values = {}
    for each in record.parameters:
        if rng.random() < 0.7:
            low, high = each.bounds
            value = each.typical * 10.0 ** rng.uniform(-0.3, 0.3)
            values[each.name] = float(min(max(value, low), high))
    if "seed" in values:
        values["seed"] = float(rng.integers(1, 1000))
    options = {
        option.name: str(rng.choice([word for word, _ in option.choices]))
        for option in record.options
    }
    try:
        st.FrictionModel(name, **values, **options)
    except st.InputError:
        return None
    return {"law": name, **values, **options}


def tables(name):
    """Friction tables of a law: by default, all typical, all options, and drawn ones."""
    record = record_of(name)
    typical = {each.name: each.typical for each in record.parameters}
    made = [{"law": name}, {"law": name, **typical}]
    for option in record.options:
        made += [{"law": name, **typical, option.name: word} for word, _ in option.choices[1:]]
    rng = np.random.default_rng(sum(map(ord, name)))
    while len(made) < 6:
        table = drawn(name, rng)
        if table is not None:
            made.append(table)
    return made


def case(name, k):
    """Of those that are drawn, the first is always tried."""
    often = k <= 2 + sum(len(each.choices) - 1 for each in record_of(name).options)
    return pytest.param(name, k, marks=() if often else pytest.mark.slow)


CASES = [case(name, k) for name in LAWS for k in range(len(tables(name)))]


@pytest.mark.parametrize(("name", "k"), CASES)
def test_each_law_steps_as_the_core_does(name, k, tmp_path):
    table = tables(name)[k]
    own = plant(table)
    law = own.friction.model()
    compiled = Compiled(own, tmp_path)
    rng = np.random.default_rng(100 * k + len(name))
    columns = motion(rng, law)
    core, found = along(law, *columns), compiled.step(*columns)
    off = np.max(np.abs(found - core)) / level_of(law, core)
    assert off < NEAR, off


@pytest.mark.parametrize("name", LAWS)
def test_each_law_steps_in_floats(name, tmp_path):
    own = plant({"law": name})
    law = own.friction.model()
    compiled = Compiled(own, tmp_path, "float")
    velocity, dt, effort, load = (
        np.float32(each).astype(float) for each in motion(np.random.default_rng(7), law, 2000)
    )
    core = along(law, velocity, dt, effort, load)
    off = np.max(np.abs(compiled.step(velocity, dt, effort, load) - core))
    assert off / level_of(law, core) < NEAR_FLOAT, off / level_of(law, core)


@pytest.mark.parametrize("name", LAWS)
def test_a_step_ends_whatever_it_is_given(name, tmp_path):
    compiled = Compiled(plant({"law": name}), tmp_path)
    for velocity in (np.nan, 1e6, -1e-300):
        compiled.step([1e-3, velocity, -1e-3, 0.0], 1e-3)
    found = compiled.step([1e-3, 1e6, -1e6, 1e-300, 0.0], 1e-3)
    assert np.all(np.isfinite(found))


def test_fragments_are_plain_text():
    folder = Path(fragments.__file__).parent / "c"
    for file in sorted(folder.rglob("*.c")):
        lines = file.read_text("ascii").splitlines()
        assert max(map(len, lines)) <= 100, file


def test_a_stuck_contact_bears_what_it_can(tmp_path):
    sticking = plant({"law": "coulomb", "coulomb": 0.3, "breakaway": 0.5})
    compiled = Compiled(sticking, tmp_path)
    effort = np.array([0.0, 0.2, -0.49, 0.6, -7.0])
    assert compiled.step(np.zeros(5), 1e-3, effort).tolist() == [0.0, 0.2, -0.49, 0.5, -0.5]


def stepping(made):
    """The part of a source that steps."""
    text = made.files["stiction_feedforward.c"]
    return text[text.index("/* A velocity that is held") : text.index("stiction_friction(")]


def test_what_is_neutral_leaves_no_code():
    bare = stepping(plant({"law": "coulomb", "coulomb": 0.3}).export("c"))
    assert not re.search("r_exp|VISCOUS \\*|position|level;|added", bare)
    falling = {"law": "coulomb", "coulomb": 0.3, "breakaway": 0.5, "viscous": 0.1}
    text = stepping(plant(falling, {"name": "cogging", "cosine": 0.1}).export("c"))
    assert "EXCESS * r_exp(-share * share)" in text
    assert "VISCOUS * VISCOUS_LEVEL * velocity" in text
    assert "cogging_ORDER_2" not in text
    assert "stiction_set_position" in text


def test_the_paper_model_without_a_hook_has_no_events():
    paper = plant({"law": "hsieh_pan"}).export("c").files["stiction_feedforward.c"]
    assert "locate" not in paper
    hooked = plant({"law": "hsieh_pan", "breakaway": 0.5}).export("c")
    assert "locate" in hooked.files["stiction_feedforward.c"]


@pytest.mark.parametrize("law", ["maxwell_slip", "futami", "preisach", "leuven"])
def test_too_many_reverse_points_are_hardly_missed(law, tmp_path):
    own = plant({"law": law})
    model = own.friction.model()
    # Loops within loops, ever smaller, three times as many as there is room for; and out of them.
    sizes = 3e-4 * np.linspace(1.0, 0.05, 100) * (-1.0) ** np.arange(100)
    turns = np.concatenate([[0.0], sizes, [5e-4]])
    places = np.concatenate([np.linspace(a, b, 21)[1:] for a, b in pairwise(turns)])
    velocity = np.diff(np.concatenate([[0.0], places])) / 1e-3
    zero = np.zeros(len(velocity))
    core = along(model, velocity, zero + 1e-3, zero, zero)
    off = []
    for room in (32, 128):
        flags = (*FLAGS, f"-DSTICTION_REVERSALS={room}")
        found = Compiled(own, tmp_path / str(room), flags=flags).step(velocity, 1e-3)
        off.append(np.max(np.abs(found - core)) / level_of(model, core))
    assert NEAR < off[0] < 0.003, off
    assert off[1] < NEAR, off


def test_a_law_without_c_keeps_its_feed_forward(monkeypatch):
    from stiction.export import firmware

    monkeypatch.setattr(firmware, "names_of", lambda kind: ())
    made = plant({"law": "lugre"}, {"name": "run_in", "coulomb": 0.1}).export("c")
    assert "stiction_step" not in "".join(made.files.values())
    assert made.lost[0] == "friction step by step: lugre has no C, its feed-forward alone"
    assert any(each.startswith("run_in:") for each in made.lost)
    assert any(each.startswith("pre-sliding:") for each in made.lost)


LEVEL = {
    "stribeck": (
        {"excess": 0.4, "velocity": 0.05, "exponent": 1.3},
        lambda v, x, q, t, p, u: 0.4 * np.exp(-(np.abs(v / 0.05) ** 1.3)),
    ),
    "direction_asymmetry": (
        {"coulomb": 0.1, "velocity": 0.02},
        lambda v, x, q, t, p, u: 0.1 * v / np.hypot(v, 0.02),
    ),
    "position_dependent_friction": (
        {"cosine": 0.1, "sine": -0.2, "order": 3.0, "cosine_2": 0.05, "order_2": 7.5},
        lambda v, x, q, t, p, u: (
            0.1 * np.cos(3.0 * x) - 0.2 * np.sin(3.0 * x) + 0.05 * np.cos(7.5 * x)
        ),
    ),
    "effort_dependent_friction": (
        {"share": 0.2},
        lambda v, x, q, t, p, u: 0.2 * np.abs(u - q) / 0.3,
    ),
    "load_dependent_friction": (
        {"drive": 0.3, "back_drive": 0.1, "velocity": 0.02},
        lambda v, x, q, t, p, u: (0.2 * np.abs(q) - 0.1 * q * v / np.hypot(v, 0.02)) / 0.3,
    ),
    "temperature_dependent_friction": (
        {"coulomb": 0.005, "reference": 20.0},
        lambda v, x, q, t, p, u: 0.005 * (20.0 - 30.0),
    ),
    "run_in": (
        {"coulomb": 0.5, "distance": 0.2},
        lambda v, x, q, t, p, u: -0.5 * (1.0 - np.exp(-p / 0.2)),
    ),
    "warm_up": (
        {"coulomb": 0.5, "time": 0.5},
        lambda v, x, q, t, p, u: -0.5 * (1.0 - np.exp(-t / 0.5)),
    ),
}
ADDED = {
    "cogging": (
        {"cosine": 0.04, "sine": 0.02, "order": 6.0, "sine_2": 0.01, "order_2": 11.0},
        lambda v, x: 0.04 * np.cos(6 * x) + 0.02 * np.sin(6 * x) + 0.01 * np.sin(11 * x),
    ),
    "gravity_unbalance": (
        {"cosine": 0.04, "sine": 0.02},
        lambda v, x: 0.04 * np.cos(x) + 0.02 * np.sin(x),
    ),
    "torque_bias": ({"bias": 0.03}, lambda v, x: 0.03 + 0.0 * x),
    "viscous_quadratic": ({"quadratic": 0.2}, lambda v, x: -0.2 * v * np.abs(v)),
}


def wandering(samples=3000):
    rng = np.random.default_rng(3)
    velocity = 0.3 * np.sin(np.arange(samples) * 0.01) * rng.uniform(0.5, 1.0, samples)
    velocity[rng.random(samples) < 0.1] = 0.0
    return velocity, rng.uniform(1e-4, 3e-3, samples), rng.uniform(-0.4, 0.4, (2, samples))


@pytest.mark.parametrize("name", LEVEL)
def test_levels_are_those_of_their_equations(name, tmp_path):
    values, share = LEVEL[name]
    compiled = Compiled(plant(DRY, {"name": name, **values}), tmp_path)
    velocity, dt, (effort, load) = wandering()
    place, time, path = (np.cumsum(each) for each in (velocity * dt, dt, np.abs(velocity) * dt))
    level = np.maximum(1.0 + share(velocity, place, load, time, path, effort), 0.0) * 0.3
    slides = np.sign(velocity) * level + 0.1 * velocity
    by_hand = np.where(velocity == 0.0, np.clip(effort, -level, level), slides)
    found = compiled.step(velocity, dt, effort, load, 30.0)
    assert np.max(np.abs(found - by_hand)) < NEAR
    assert np.ptp(level) > 0.01 or name.startswith("temperature")


DRY = {"law": "coulomb", "coulomb": 0.3, "viscous": 0.1}


@pytest.mark.parametrize("name", ADDED)
def test_efforts_that_effects_add_are_taken_off(name, tmp_path):
    values, added = ADDED[name]
    compiled = Compiled(plant(DRY, {"name": name, **values}), tmp_path)
    velocity, dt, (effort, load) = wandering()
    push = added(velocity, np.cumsum(velocity * dt))
    held = np.clip(effort + push, -0.3, 0.3)
    by_hand = np.where(velocity == 0.0, held, 0.3 * np.sign(velocity) + 0.1 * velocity) - push
    assert np.max(np.abs(compiled.step(velocity, dt, effort, load) - by_hand)) < NEAR
    assert np.ptp(by_hand) > 0.0


@pytest.mark.parametrize("law", ["coulomb", "lugre"])
@pytest.mark.parametrize("name", names_of("effects"))
def test_each_effect_is_that_of_a_motor_that_is_moved(name, law, tmp_path):
    record = next(each for each in st.effects() if each.name == name)
    effect = {"name": name, **{each.name: each.typical for each in record.parameters}}
    friction = {"law": law, "viscous": 0.05}
    with_it = compare_moved(plant(friction, effect), tmp_path)
    without = [moved(plant(friction).follower(), speed) for speed in SPEEDS]
    creeps = "state relaxation" in record.hooks
    # What slides does not creep, and a rigid contact slides wherever it moves; nobody drives it.
    unchanged = (creeps and law == "coulomb") or record.by_motor
    assert np.allclose(with_it, without, rtol=0.0, atol=1e-6) == unchanged


@pytest.mark.parametrize("law", LAWS)
def test_all_effects_go_with_every_law(law, tmp_path):
    effects = [
        {"name": each.name, **{p.name: p.typical for p in each.parameters}}
        for each in st.effects()
        if each.name in names_of("effects")
    ]
    compare_moved(plant({"law": law, "viscous": 0.05}, *effects), tmp_path)


def moved(motor, speed):
    """Friction of a motor that is moved at a speed, less what effects push."""
    places = AT + speed * 1e-3 * np.arange(1501)
    motor.reset(AT, speed)
    load, warmth = np.full(1500, 0.1), np.full(1500, 30.0)
    along = st.Motion(places, np.zeros(1500), 1e-3, load=load, temperature=warmth)
    _, ambient, friction, _ = motor.follow(along)
    return friction - ambient


def compare_moved(own, folder):
    """Lets the C and a motor of a plant be moved at speeds that are held; friction of each."""
    compiled, motor = Compiled(own, folder), own.follower()
    core = np.array([moved(motor, speed) for speed in SPEEDS])
    for speed, friction in zip(SPEEDS, core, strict=True):
        compiled.begin(AT)
        found = compiled.step(np.full(1500, speed), 1e-3, 0.1, 0.1, 30.0, begin=False)
        off = np.max(np.abs(found - friction))
        assert off < 1e-9, (speed, off)
    return core


SPEEDS = (0.0, 1e-4, -0.01, 0.3)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.skipif(
    not hasattr(st.FrictionModel, "effects"), reason="friction models have no effects in this build"
)
def test_a_contact_with_all_effects_steps_as_the_core_does(law, tmp_path):
    effects = {
        each.name: {p.name: p.typical for p in each.parameters}
        for each in st.effects()
        if each.name in names_of("effects")
    }
    own = plant({"law": law}, *({"name": name, **values} for name, values in effects.items()))
    model = st.FrictionModel(law, effects=effects)
    columns = motion(np.random.default_rng(11), model, 1500)
    core, found = along(model, *columns), Compiled(own, tmp_path).step(*columns)
    assert np.max(np.abs(found - core)) / level_of(model, core) < NEAR


AT = 0.2


def test_an_observer_finds_what_pushes_beside_the_model(tmp_path):
    own = plant({"law": "coulomb", "coulomb": 0.3}, drive={"input": "current_a", "gain": 0.5})
    compiled = Compiled(own, tmp_path)
    library, bandwidth, dt = compiled.library, 50.0, 1e-3

    class Observer(ctypes.Structure):
        _fields_ = [(name, ctypes.c_double) for name in ("bandwidth", "velocity", "disturbance")]

    observer, real = Observer(), ctypes.c_double
    library.stiction_observer_init.argtypes = [ctypes.c_void_p, real, real]
    library.stiction_observe.argtypes = [ctypes.c_void_p, real, real, real, real]
    library.stiction_observe.restype = real
    library.stiction_observer_init(ctypes.byref(observer), bandwidth, 0.0)
    motor = own.motor()
    current, push = 1.0 + np.zeros(200), 0.04 * (np.arange(200) >= 50)
    run = motor.simulate(current, dt, load=push)
    found = [
        library.stiction_observe(ctypes.byref(observer), *map(float, row), dt)
        for row in zip(current, run.velocity, run.friction, strict=True)
    ]
    late = np.maximum(np.arange(200) - 49, 0) * dt
    assert np.max(np.abs(found - 0.04 * (1.0 - np.exp(-bandwidth * late)))) < 1e-12
