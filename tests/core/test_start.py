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
    assert QUANTITIES["maxwell_slip"] == ["force"]
    assert QUANTITIES["hsieh_pan"] == ["force", "hardening"]
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
    start = {name: start[name] for name in QUANTITIES[law]}
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
