"""What a contact brings along from before a recording."""

import numpy as np
import pytest

import stiction as st

from .rigs import CONTACTS, HOOK, ILLUSTRATIVE, INERTIA, RATED

DT = 1e-3
SAMPLES = 600
# Of two followings, over the step of the difference.
DIFFERENCE = 1e-6
# Of a start of 0.2 N·m after 45 mrad: a long tail of yield points forgets by a power of distance.
FORGOTTEN = 1e-5
ELEMENTS = {"coulomb": 0.35, "initial_stiffness": 3000.0}
KINDS = {
    "maxwell_slip": ("maxwell_slip", ELEMENTS | {"yield_shape": 0.3, "viscous": 0.05}),
    "exponential": ("maxwell_slip", ELEMENTS | {"yield_shape": 0.0}),
    "long tail": ("maxwell_slip", ELEMENTS | {"yield_shape": -0.7}),
    "near 1": ("maxwell_slip", ELEMENTS | {"yield_shape": 0.9}),
    "sticking": CONTACTS["sticking"],
    "hook": CONTACTS["hook"],
    "rated": ("hsieh_pan", ILLUSTRATIVE | HOOK | RATED),
    "same": CONTACTS["same"],
    "spring damper": CONTACTS["spring damper"],
}
TURNS = ["turned", "turned_again"]
QUANTITIES = {law.name: [quantity.name for quantity in law.start] for law in st.laws()}


def machine(kind, **keywords):
    law, parameters = KINDS[kind]
    friction = st.FrictionModel(law, **parameters | keywords)
    return st.Motor(inertia=INERTIA, friction=friction)


def motion(direction=1.0):
    """Small swings, then a long slide."""
    time = np.arange(SAMPLES + 1) * DT
    swings = 3e-5 * np.sin(40.0 * time) + 1e-5 * np.sin(97.0 * time)
    return direction * (swings + 0.3 * np.maximum(0.0, time - 0.3) ** 2)


def needed(motor, start, path):
    _, ambient, friction, _ = motor.copy().follow(
        st.Motion(path, np.zeros(SAMPLES), DT), start=start
    )
    return friction - ambient


def test_laws_say_what_a_contact_may_bring_along():
    assert QUANTITIES["coulomb"] == []
    assert QUANTITIES["dahl"] == ["force"]
    assert QUANTITIES["maxwell_slip"] == ["force", *TURNS]
    assert QUANTITIES["hsieh_pan"] == ["force", "hardening", *TURNS]
    for law in st.laws():
        for quantity in law.start:
            assert quantity.default == quantity.neutral == 0.0


@pytest.mark.parametrize("kind", KINDS)
def test_a_start_of_zeros_changes_no_bit(kind):
    fresh, path = machine(kind), motion()
    want = needed(fresh, None, path)
    zeros = dict.fromkeys(QUANTITIES[KINDS[kind][0]], 0.0)
    for start in ({}, zeros):
        assert np.array_equal(needed(fresh, start, path), want)
    # Not from where the motor is, but from the start that is given.
    moved = machine(kind)
    moved.simulate(np.full(200, 0.3), DT)
    moved.reset(0.0, 0.0)
    moved.friction.simulate(np.full(50, 1e-3), DT)
    assert np.array_equal(needed(moved, {}, path), want)
    primed, plain = machine(kind), machine(kind)
    primed.follow(st.Motion(path, np.zeros(SAMPLES), DT), start=zeros)
    plain.follow(st.Motion(path, np.zeros(SAMPLES), DT))
    assert primed == plain


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("kind", KINDS)
def test_a_start_is_felt_at_first_and_forgotten_after_a_long_motion(kind, direction):
    path = motion(direction)
    want = needed(machine(kind), None, path)
    for start in ({"force": 0.2}, {"force": -0.2}):
        got = needed(machine(kind), start, path)
        assert got[0] - want[0] == pytest.approx(start["force"], rel=0.2)
        if KINDS[kind][1].get("breakaway") or KINDS[kind][0] == "maxwell_slip":
            assert np.abs(got - want)[-50:].max() < FORGOTTEN


def test_hardening_at_the_start_leaves_less_creep():
    rest = np.zeros(SAMPLES + 1)
    force = {"force": 0.2}
    soft, hard = (
        needed(machine("sticking"), force | {"hardening": h}, rest) for h in (0.0, 1.6e-3 * 0.04)
    )
    assert soft[-1] < 0.99 * soft[0]
    assert np.allclose(hard, 0.2, rtol=1e-12)


@pytest.mark.parametrize("kind", ["maxwell_slip", "hook", "rated"])
def test_a_force_that_no_contact_holds_levels_off(kind):
    # A fit may try any number; what lies beyond break-away would throw the contact into a slide.
    rest = np.zeros(SAMPLES + 1)
    level = {"maxwell_slip": "coulomb"}.get(KINDS[kind][0], "breakaway")
    most = machine(kind).parameters[f"friction.{level}"]
    held = [needed(machine(kind), {"force": f * most}, rest)[0] for f in (0.5, 0.98, 1.0, 3.0, 1e3)]
    assert held[0] == pytest.approx(0.5 * most, rel=0.01)  # creep takes the rest
    assert np.all(np.diff(held) > 0.0)
    assert held[-1] < most


@pytest.mark.parametrize("hardening", [0.0, 2e-5])
@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize(
    ("kind", "force"),
    # Forces that level off below sliding belong to the elements alone.
    [(kind, force) for kind in KINDS for force in (0.15, -0.2)]
    + [(kind, force) for kind in list(KINDS)[:4] for force in (0.344, -3.0)],
)
def test_derivatives_by_the_start_equal_differences(kind, direction, force, hardening):
    law = KINDS[kind][0]
    motor, path = machine(kind), motion(direction)
    start = {"force": force, "hardening": hardening}
    start = {name: start[name] for name in QUANTITIES[law] if name in start}
    paths = [f"start.{name}" for name in start]
    kept = motor.copy()
    exact, driven, _ = motor.follow_sensitivity(
        st.Motion(path, np.zeros(SAMPLES), DT), paths, start=start
    )
    assert motor == kept
    assert not driven.any()
    for k, name in enumerate(start):
        if start[name] == 0.0:
            assert np.isfinite(exact[k]).all()
            continue
        step = 1e-5 * abs(start[name])

        def chord(width, name=name):
            high, low = (
                needed(motor, start | {name: start[name] + s * width}, path) for s in (1.0, -1.0)
            )
            return (high - low) / (2.0 * width)

        near, wide = chord(step), chord(2.0 * step)
        # A few units in the last place of the forces, which a difference divides by its width.
        rounding = 4.0 * np.finfo(float).eps * np.abs(needed(motor, start, path)).max() / step
        allowed = DIFFERENCE * np.abs(exact[k]).max() + rounding
        # Samples in which a branch changes have no difference.
        smooth = np.abs(near - wide) <= allowed
        assert smooth.mean() > 0.97
        difference = (4.0 * near - wide) / 3.0
        assert np.abs(exact[k] - difference)[smooth].max() <= allowed


@pytest.mark.parametrize("force", [0.2, 0.345])
@pytest.mark.parametrize("kind", ["exponential", "maxwell_slip", "hook"])
def test_derivatives_by_the_law_see_the_start_depend_on_it(kind, force):
    motor, path, start = machine(kind), motion(), {"force": force}
    for name in ("initial_stiffness", "coulomb"):
        value = motor.parameters[f"friction.{name}"]
        exact = motor.follow_sensitivity(
            st.Motion(path, np.zeros(SAMPLES), DT), [f"friction.{name}"], start=start
        )[0][0]
        near, wide = (
            (
                needed(machine(kind, **{name: value * (1.0 + h)}), start, path)
                - needed(machine(kind, **{name: value * (1.0 - h)}), start, path)
            )
            / (2.0 * value * h)
            for h in (1e-5, 2e-5)
        )
        scale = np.abs(exact).max()
        smooth = np.abs(near - wide) <= DIFFERENCE * scale
        assert smooth.mean() > 0.9
        assert np.abs(exact - (4.0 * near - wide) / 3.0)[smooth].max() <= 2.0 * DIFFERENCE * scale


@pytest.mark.parametrize("shape", [-2.0, -0.7, 0.0, 1e-9, 0.3, 0.5, 0.9])
def test_a_force_beyond_sliding_levels_off_below_it(shape):
    rest = np.zeros(SAMPLES + 1)
    motor = machine("maxwell_slip", yield_shape=shape)
    forces = np.concatenate((np.linspace(0.0, 0.4, 81), [1.0, 1e3, 1e9]))
    got = np.array([needed(motor, {"force": float(f)}, rest)[0] for f in forces])
    assert np.allclose(got[forces <= 0.98 * 0.35], forces[forces <= 0.98 * 0.35], atol=1e-15)
    assert np.all(np.diff(got[:-2]) > 0.0)
    assert got[-1] < 0.35
    mirrored = [needed(motor, {"force": -float(f)}, rest)[0] for f in forces]
    assert np.array_equal(mirrored, -got)
    motor.follow(st.Motion(motion(), np.zeros(SAMPLES), DT), start={"force": 0.35})
    other = motor.copy()
    other.state = motor.state
    assert other == motor


def test_signatures_begin_with_the_start_too():
    motor, path, start = machine("maxwell_slip"), motion(), {"force": 0.2}
    level = [("position_dependent_friction", {"order": 1.0})]
    needed_rows, _, _ = motor.signatures(st.Motion(path, np.zeros(SAMPLES), DT), level, start=start)
    assert needed_rows[0, 0] == pytest.approx(0.2, rel=0.2)
    assert abs(motor.signatures(st.Motion(path, np.zeros(SAMPLES), DT), level)[0][0, 0]) < 0.05


REMEMBERING = [law for law, quantities in QUANTITIES.items() if "turned" in quantities]


def bent(law):
    """A contact of this law, the force at which its turns are told, and its first slope."""
    parameters = {
        "hsieh_pan": ILLUSTRATIVE | {"breakaway": 0.6, "coulomb": 0.5, "creep_rate": 0.0},
        "leuven": {"coulomb": 0.5, "breakaway": 0.6, "initial_stiffness": 3000.0},
    }.get(law, {"coulomb": 0.6, "initial_stiffness": 3000.0})
    known = st.Motor(inertia=INERTIA, friction=st.FrictionModel(law)).parameters
    own = {name: value for name, value in parameters.items() if f"friction.{name}" in known}
    motor = st.Motor(inertia=INERTIA, friction=st.FrictionModel(law, **own))
    return motor, motor.parameters.get("friction.breakaway", 0.6), 3000.0


def test_laws_with_a_spring_that_remembers_tell_of_turns():
    assert REMEMBERING == [
        "dahl_with_memory",
        "futami",
        "hsieh_pan",
        "leuven",
        "maxwell_slip",
        "preisach",
    ]


@pytest.mark.parametrize("law", REMEMBERING)
@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("turns", [(0.6, 0.0), (0.6, -0.3), (0.7, 0.2)])
def test_a_contact_that_turned_round_is_one_that_was_moved_there(law, way, turns):
    motor, level, stiffness = bent(law)
    reach = 0.2 * level / stiffness
    path = way * reach * np.concatenate([np.linspace(0.0, 3.0, 400), np.linspace(3.0, -6.0, 400)])
    force = way * 0.25 * level
    start = {"force": force, "turned": way * turns[0], "turned_again": way * turns[1]}

    # Moved by hand: there, back, and to the force at which the recording begins.
    def after(target, position, friction, step):
        for _ in range(20000):
            if (friction - target) * np.sign(step) >= 0.0:
                return position, friction
            position += step
            friction = contact.step(step / DT, DT)
        raise AssertionError(f"{law} never comes to {target}")

    contact = motor.friction
    contact.reset()
    fine = way * 1e-3 * level / stiffness
    at, reached = after(way * turns[0] * level, 0.0, 0.0, fine)
    if turns[1]:
        at, reached = after(way * turns[1] * level, at, reached, -fine)
        at, reached = after(force, at, reached, fine)
    else:
        at, reached = after(force, at, reached, -fine)
    moved = np.array([contact.step(step / DT, DT) for step in np.diff(path)])
    got = motor.follow(st.Motion(path, np.zeros(len(path) - 1), DT), start=start)[2]
    # A step too far at each turn.
    wrong = np.abs(got - moved).max()
    assert wrong < 0.005 * level
    plain = motor.follow(st.Motion(path, np.zeros(len(path) - 1), DT), start={"force": force})[2]
    assert np.abs(plain - moved).max() > 4.0 * wrong


@pytest.mark.parametrize("law", REMEMBERING)
@pytest.mark.parametrize("start", [(0.1, 0.6, 0.0), (-0.1, 0.6, -0.3), (0.1, -0.7, 0.25)])
def test_derivatives_by_the_turns_equal_differences(law, start):
    motor, level, stiffness = bent(law)
    path = motion() * 0.1 * level / (3000.0 * 3e-5) * 3000.0 / stiffness
    values = dict(zip(("force", *TURNS), (start[0] * level, *start[1:]), strict=True))
    seen = st.Motion(path, np.zeros(SAMPLES), DT)
    names = ["force", "turned", *(["turned_again"] if start[2] else [])]
    exact = motor.follow_sensitivity(seen, [f"start.{name}" for name in names], start=values)[0]

    for row, name in zip(exact, names, strict=True):

        def chord(width, name=name):
            ends = (values | {name: values[name] + s * width} for s in (1.0, -1.0))
            high, low = (motor.follow(seen, start=end)[2] for end in ends)
            return (high - low) / (2.0 * width)

        near, wide = chord(1e-5), chord(2e-5)
        scale = np.abs(row).max()
        assert scale > 0.0
        smooth = np.abs(near - wide) <= 1e-5 * scale
        assert smooth.mean() > 0.95
        assert np.abs(row - (4.0 * near - wide) / 3.0)[smooth].max() <= 1e-5 * scale


@pytest.mark.parametrize("law", REMEMBERING)
def test_turns_that_no_contact_can_have_are_forgotten_or_level_off(law):
    motor, level, _ = bent(law)
    seen = st.Motion(motion(), np.zeros(SAMPLES), DT)

    def needs(**start):
        return motor.follow(seen, start=start)[2]

    force = 0.3 * level
    # The force went past the turn; the second turn went past the first.
    assert np.array_equal(needs(force=force, turned=0.2), needs(force=force))
    assert np.array_equal(
        needs(force=force, turned=0.5, turned_again=-0.8), needs(force=force, turned=-0.8)
    )
    assert np.array_equal(needs(force=force, turned_again=-0.8), needs(force=force, turned=-0.8))
    for turned in (0.999, -0.999):
        assert np.isfinite(needs(force=force, turned=turned, turned_again=-0.99 * turned)).all()
    with pytest.raises(st.InputError, match="turned"):
        needs(force=force, turned=1.5)


@pytest.mark.parametrize("law", REMEMBERING)
def test_a_turn_at_the_force_itself_leaves_a_state_that_can_be_set(law):
    motor, level, _ = bent(law)
    seen = st.Motion(motion(), np.zeros(SAMPLES), DT)
    for again in np.linspace(-0.55, 0.55, 45):
        for force in (np.nextafter(again * level, 1.0), again * level):
            start = {"force": float(force), "turned": 0.6, "turned_again": float(again)}
            motor.follow(seen, start=start)
            copy = motor.copy()
            # It is refused where its reverse points do not nest.
            copy.state = motor.state
            assert copy == motor


def test_a_branch_that_never_closes_forgets_nothing_on_the_other_side():
    motor = machine("same")
    seen = st.Motion(motion(), np.zeros(SAMPLES), DT)
    level = 0.3 * motor.parameters["friction.breakaway"]
    if not np.isfinite(level):
        level = 0.1
    near = [
        motor.follow(seen, start={"force": -s * level, "turned": 0.3})[2] for s in (0.999, 1.001)
    ]
    assert np.abs(near[1] - near[0]).max() < 0.01 * level


def test_a_contact_that_never_breaks_away_may_have_turned_round():
    motor = machine("sticking")
    assert not np.isfinite(motor.parameters["friction.breakaway"])
    seen = st.Motion(motion(), np.zeros(SAMPLES), DT)
    found = [motor.follow(seen, start={"force": 0.05, "turned": t})[2] for t in (0.0, 0.8, 0.999)]
    assert np.isfinite(found).all()
    assert np.abs(found[1] - found[0]).max() > 1e-3
