"""Finite input gives finite numbers, or a sentence, and then nothing has changed."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import stiction as st
from stiction import _native

DT = 1e-4
# Finite, and beyond all machines: squares, sums and quotients of these leave the range of floats.
EXTREME = [5e-324, 1e-300, 1e-30, 1e30, 1e154, 1e304, 1.7e308]
WEIGHTS = ([0.25, 0.5, 0.25], [1.0, -1.0, 0.0, -1.0, 1.0])


def light() -> st.Motor:
    """A motor whose torque leaves the range of floats where its current does not."""
    motor = st.Motor(1e-5, torque_constant=100.0, friction=st.FrictionModel("coulomb"))
    motor.simulate([1.0] * 3, DT)
    return motor


def same(one: dict[str, Any], other: dict[str, Any]) -> bool:
    return one.keys() == other.keys() and all(
        np.array_equal(one[name], other[name]) for name in one
    )


def numbers(state: dict[str, Any]) -> bool:
    """Whether a state is made of numbers; a level that is never reached is infinite, and so is the
    work of a contact of which nobody knows what it took."""
    levels = {"breakaway_level", "latched_breakaway", "contact_work"}
    return all(np.isfinite(state[name]).all() for name in state if name not in levels)


def motion(position: list[float] = [0.0, 1.0, 2.0, 3.0, 1e308, 0.0]) -> st.Motion:  # noqa: B006
    return st.Motion(position, [1e308] * (len(position) - 1), DT)


def kernel() -> _native.RowKernel:
    return _native.RowKernel(*WEIGHTS, 1)


REFUSED: dict[str, Callable[[st.Motor], Any]] = {
    "step": lambda motor: motor.step(1e308, DT),
    "step under load": lambda motor: motor.step(0.0, 1e6, load=1.7e308),
    "follow": lambda motor: motor.follow(motion()),
    "follow_rows": lambda motor: motor.follow_rows(motion(), kernel()),
    "follow_sensitivity": lambda motor: motor.follow_sensitivity(motion(), ["drive.gain"]),
    "follow_columns": lambda motor: motor.follow_columns(motion(), ["drive.gain"], kernel()),
    "signatures": lambda motor: motor.signatures(
        motion(), [("torque_constant_ripple", {"order": 1.0})]
    ),
    "signature_columns": lambda motor: motor.signature_columns(
        motion(), [("torque_constant_ripple", {"order": 1.0})], kernel()
    ),
    "sensitivity": lambda motor: motor.sensitivity([1e308, 0.0], DT, ["drive.gain"]),
    "shoot": lambda motor: motor.shoot(motion(), [1.0, -2.0], 1),
    "shoot_sensitivity": lambda motor: motor.shoot_sensitivity(
        motion(), [1.0, -2.0], 1, ["drive.gain"]
    ),
    "accompany": lambda motor: motor.accompany(motion(), 1e300, 1e300),
    "a run whose outputs do not show it": lambda motor: motor.simulate(
        [1e308], DT, outputs=["mode"]
    ),
    "a chunk of a stream": lambda motor: list(st.stream(motor, [[1e308] * 3], DT)),
}


@pytest.mark.parametrize("name", sorted(REFUSED))
def test_what_runs_away_is_refused_and_nothing_has_changed(name: str) -> None:
    motor = light()
    before = motor.state
    with pytest.raises(st.InputError, match=r"left the range of floats|ran away|no number") as told:
        REFUSED[name](motor)
    assert "\n" not in str(told.value)
    assert same(motor.state, before)
    # What it was refused is no hindrance.
    assert motor.step(0.1, DT) == light().step(0.1, DT)


@pytest.mark.parametrize(
    "name", ["follow", "follow_rows", "follow_sensitivity", "follow_columns", "shoot"]
)
def test_a_fit_may_have_what_ran_away_as_it_is(name: str) -> None:
    motor = light()
    before = motor.state
    beside = {"follow_rows": [kernel()], "shoot": [[1.0, -2.0], 1]}.get(name, [])
    if name in ("follow_sensitivity", "follow_columns"):
        beside = [["drive.gain"], *([kernel()] if name == "follow_columns" else [])]
    found = getattr(motor, name)(motion(), *beside, strict=False)
    assert not np.isfinite(found).all()
    assert numbers(motor.state)
    assert same(motor.state, before)


def test_a_run_that_ran_away_says_so_and_the_motor_stays_where_it_was() -> None:
    for go in (
        lambda motor: motor.simulate([1.0, 1e308, 1.0], DT),
        lambda motor: motor.simulate_segments([DT, DT], [1e308, 1.0]),
    ):
        motor = light()
        before = motor.state
        run = go(motor)
        assert not run.success
        assert "ran away" in run.message
        assert same(motor.state, before)


def test_one_machine_that_runs_away_holds_all_of_an_ensemble() -> None:
    fleet = st.Ensemble(light(), 4)
    before = fleet.step_many(0.1, DT)
    twin = st.Ensemble(light(), 4)
    twin.step_many(0.1, DT)
    for current in ([0.1, 0.2, 1e308, 0.1], [1e30, 0.2, 0.1, 1e308]):
        with pytest.raises(st.InputError, match=r"member [23]: the motion ran away"):
            fleet.step_many(current, DT)
    assert np.isfinite(before).all()
    assert np.array_equal(fleet.step_many(0.2, DT), twin.step_many(0.2, DT))
    run = fleet.simulate([[0.1], [1e308], [0.1], [0.1]], DT)
    assert not run.success
    assert np.isfinite(run.position[[0, 2, 3]]).all()


def test_a_step_that_is_too_long_for_one_machine_holds_all_of_them() -> None:
    friction = st.FrictionModel("hsieh_pan")
    fleet = st.Ensemble(
        st.Motor(0.0076, friction=friction), parameters={"initial_stiffness": [3e3, 1e12]}
    )
    with pytest.raises(st.InputError, match=r"member 1: .*too long"):
        fleet.step_many(0.1, 1.0)
    with pytest.raises(st.InputError, match=r"member 1: .*too long"):
        fleet.simulate([0.1] * 3, [1e-6, 1e-6, 1.0])
    assert np.array_equal(fleet.step_many(0.0, 1e-9), np.zeros((2, 2)))


def test_samples_before_one_that_is_too_long_are_taken_back() -> None:
    motor = st.Motor(0.0076, friction=st.FrictionModel("hsieh_pan"))
    before = motor.state
    with pytest.raises(st.InputError, match="too long"):
        motor.simulate([0.1, 0.1], [1e-3, 1e6])
    assert same(motor.state, before)


def test_smoothing_beyond_the_range_of_floats_is_refused() -> None:
    with pytest.raises(st.InputError, match="smoothed readings left the range"):
        _native.adaptively_smoothed([1.7e308, -1.7e308, 1.7e308, 1.7e308], 1.0, [0, 1])


def test_a_place_without_an_effort_is_refused() -> None:
    cogging = {"order": 1e6, "sine": 0.1}
    motor = st.Motor(1.0, friction=st.FrictionModel("coulomb"), effects={"cogging": cogging})
    before = motor.state
    with pytest.raises(st.InputError, match="at position = 1e308"):
        motor.reset(1e308)
    assert same(motor.state, before)


def test_a_motion_that_is_shorter_than_a_kernel_has_no_rows() -> None:
    motor = light()
    short = st.Motion([0.0, 0.1], [0.1], DT)
    assert motor.follow_columns(short, ["drive.gain", "body.inertia"], kernel()).shape == (2, 0)
    assert motor.signature_columns(short, [("torque_bias", {})], kernel()).shape == (1, 0)


@pytest.mark.parametrize("law", [law.name for law in st.laws()])
def test_segments_under_any_load_are_answered(law: str) -> None:
    motor = st.Motor(1.1e-5, friction=st.FrictionModel(law))
    run = motor.simulate_segments([0.0017, 0.0017], [-0.1, -0.7], load=[3.2, -1e304])
    assert run.success or "ran away" in run.message


def drawn(source: random.Random, spec: Any) -> float:
    """A value within the bounds of a parameter, often at their ends."""
    lower, upper = spec.bounds
    near = abs(spec.typical) * 10.0 ** source.uniform(-6.0, 6.0)
    ends = [lower, upper, spec.typical, near, near]
    return float(min(max(source.choice(ends), lower), upper))


def any_contact(source: random.Random, law: Any) -> st.FrictionModel | None:
    chosen = [spec for spec in law.parameters if source.random() < 0.5]
    try:
        return st.FrictionModel(law.name, **{spec.name: drawn(source, spec) for spec in chosen})
    except st.InputError:
        return None


def size(source: random.Random) -> float:
    usual = 10.0 ** source.uniform(-4.0, 1.5)
    return source.choice([-1.0, 1.0]) * source.choice([usual, usual, source.choice(EXTREME)])


# Each break of a bristle is located: what a step costs that goes far is another question.
STEPPED = [law for law in st.laws() if law.name != "bristle"]


@pytest.mark.parametrize("law", STEPPED, ids=lambda law: law.name)
def test_steps_of_any_machine_give_numbers_or_change_nothing(law: Any) -> None:
    source = random.Random(f"{law.name} 1")
    effects = st.effects()
    for _ in range(25):
        model = any_contact(source, law)
        if model is None:
            continue
        beside = source.sample(effects, source.choice([0, 0, 1, 2]))
        motor = st.Motor(
            source.choice([0.0076, 1.0]),
            friction=model,
            effects={
                effect.name: {spec.name: drawn(source, spec) for spec in effect.parameters}
                for effect in beside
            },
            integrator=source.choice(["fast", "fast", "reference"]),
        )
        for _ in range(4):
            before = motor.state
            dt = source.choice([1e-3, 1e-4, 1e-2, *EXTREME[:3]])
            try:
                reached = motor.step(size(source), dt, load=size(source))
            except st.InputError:
                assert same(motor.state, before)
                continue
            assert np.isfinite(reached).all()
            assert numbers(motor.state)


def moved(
    model: st.FrictionModel, way: str, velocity: float, dt: float, around: dict[str, float]
) -> Any:
    if way == "simulate":
        return model.simulate([velocity] * 3, dt, **around)
    if way == "step":
        return model.step(velocity, dt, **around)
    found = model.trial(velocity, dt, **around)
    model.commit()
    return found


@pytest.mark.parametrize("law", st.laws(), ids=lambda law: law.name)
def test_contacts_at_any_speed_give_numbers_or_change_nothing(law: Any) -> None:
    source = random.Random(f"{law.name} 2")
    for _ in range(40):
        model = any_contact(source, law)
        if model is None:
            continue
        for _ in range(4):
            before = model.state
            velocity = max(-1e6, min(1e6, size(source)))
            dt = source.choice([1e-3, 1e-4, 1.0, 1e6, *EXTREME[:3]])
            around = {"effort": size(source), "load": size(source)}
            try:
                found = moved(
                    model, source.choice(["step", "simulate", "trial"]), velocity, dt, around
                )
            except st.InputError:
                assert same(model.state, before)
                continue
            assert np.isfinite(found).all()
            assert numbers(model.state)


def test_a_state_beyond_all_machines_is_stepped_with_care() -> None:
    model = st.FrictionModel("hsieh_pan", breakaway=0.5)
    motor = st.Motor(0.0076, friction=model)
    for name in ("hardening", "plastic", "spring_force", "velocity", "wound"):
        for value in (1e308, -1e308):
            try:
                motor.state = motor.state | {name: value}
            except st.InputError:
                continue
            before = motor.state
            try:
                assert all(math.isfinite(x) for x in motor.step(0.1, DT))
            except st.InputError:
                assert same(motor.state, before)
            assert numbers(motor.state)
