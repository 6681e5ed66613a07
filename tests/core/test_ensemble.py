"""Many machines at once are the same machines one after the other."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest

import stiction as st

DT = 2e-4
POOL = ThreadPoolExecutor(1)
"""Of which nothing is asked."""
LAWS = [law.name for law in st.laws()]


def motor(law: str = "hsieh_pan", **more: float) -> st.Motor:
    return st.Motor(0.0076, 1.5, st.FrictionModel(law, **more), gravity_amplitude=0.02)


def efforts(members: int, n: int = 1500) -> np.ndarray:
    """Sweeps of several sizes: some stick, some slide."""
    time = np.arange(n) * DT
    sizes = np.linspace(0.05, 0.6, members)
    return sizes[:, None] * np.sin(2.0 * np.pi * (4.0 + 20.0 * time) * time) / 1.5


@pytest.mark.parametrize("law", LAWS)
def test_every_member_does_what_a_motor_alone_does(law: str) -> None:
    base = motor(law)
    currents, loads = efforts(5), 0.02 * np.cos(np.arange(1500) * 0.01)
    name = next(p.name for p in st.laws() if p.name == law for p in p.parameters)
    value = base.friction.parameters[name]
    values = value * np.linspace(0.7, 1.0, 5)
    run = st.simulate_ensemble(
        base,
        currents,
        DT,
        parameters={f"friction.{name}": values},
        load=loads,
        outputs=("position", "velocity", "friction"),
        threads=2,
    )
    keywords = {**base.friction.parameters, **base.friction.options}
    for k in range(5):
        friction = st.FrictionModel(law, **{**keywords, name: values[k]})
        alone = st.Motor(0.0076, 1.5, friction, gravity_amplitude=0.02)
        own = alone.simulate(currents[k], DT, load=loads)
        for column in run:
            assert np.array_equal(run[column][k], own[column]), column


def test_any_number_of_threads_and_any_executor_give_the_same_bits() -> None:
    base, currents = motor(breakaway=0.4, viscous=0.02), efforts(9)
    rates = {"creep_rate": np.linspace(0.5, 4.0, 9), "body.inertia": np.linspace(0.005, 0.01, 9)}
    one = st.simulate_ensemble(base, currents, DT, parameters=rates, threads=1)
    for threads in (2, 5):
        more = st.simulate_ensemble(base, currents, DT, parameters=rates, threads=threads)
        assert np.array_equal(more.position, one.position)
    for executor in (ThreadPoolExecutor(2), ProcessPoolExecutor(2)):
        with executor:
            far = st.simulate_ensemble(
                base, currents, DT, parameters=rates, executor=executor, parts=4
            )
        assert np.array_equal(far.position, one.position)
        assert np.array_equal(far.time, one.time)


def test_a_dask_cluster_gives_the_same_bits() -> None:
    distributed = pytest.importorskip("distributed")
    base, currents = motor(breakaway=0.4), efforts(6)
    here = st.simulate_ensemble(base, currents, DT, reduce="rms", target=1e-5)
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=False, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        there = st.simulate_ensemble(
            base, currents, DT, reduce="rms", target=1e-5, executor=client.get_executor()
        )
    assert np.array_equal(there.position, here.position)


def test_what_is_kept_is_what_the_rows_say() -> None:
    base, currents = motor(breakaway=0.4), efforts(4, 1001)
    outputs = ("position", "hardening")
    rows = st.simulate_ensemble(base, currents, DT, outputs=outputs)
    thin = st.simulate_ensemble(base, currents, DT, outputs=outputs, every=10)
    assert thin.position.shape == (4, 100)
    assert np.array_equal(thin.position, rows.position[:, 9::10])
    assert np.allclose(thin.time, rows.time[9::10], rtol=1e-14)
    last = st.simulate_ensemble(base, currents, DT, outputs=outputs, reduce="last")
    assert np.array_equal(last.hardening, rows.hardening[:, -1])
    most = st.simulate_ensemble(base, currents, DT, outputs=outputs, reduce="extremes")
    assert np.array_equal(most.position[:, 0], rows.position.min(axis=1))
    assert np.array_equal(most.position[:, 1], rows.position.max(axis=1))
    target = 1e-5 * np.sin(np.arange(1001) * 0.01)
    beside = st.simulate_ensemble(base, currents, DT, reduce="rms", target=target)
    expected = np.sqrt(np.mean((rows.position - target) ** 2, axis=1))
    assert np.allclose(beside.position, expected, rtol=1e-12)


def test_one_call_steps_all_machines_and_goes_on_from_there() -> None:
    base, currents = motor(breakaway=0.4, viscous=0.02), efforts(3, 400)
    levels = np.array([0.1, 0.2, 0.3])
    fleet = st.Ensemble(base, parameters={"coulomb": levels})
    seen = [fleet.step_many(currents[:, k], DT, load=0.01) for k in range(200)]
    rest = fleet.simulate(currents[:, 200:], DT, load=0.01)
    whole = st.simulate_ensemble(
        base, currents, DT, parameters={"coulomb": levels}, load=0.01, outputs=("position",)
    )
    assert len(fleet) == 3
    assert np.array_equal(np.array([x for x, _ in seen]).T, whole.position[:, :200])
    assert np.array_equal(rest.position, whole.position[:, 200:])


def test_members_start_where_the_motor_is() -> None:
    base = motor()
    base.simulate(np.full(300, 0.1), DT)
    state = base.state
    run = st.simulate_ensemble(base, np.full(50, 0.12), DT)
    assert np.array_equal(run.position[0], base.copy().simulate(np.full(50, 0.12), DT).position)
    assert base.state["time"] == state["time"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"parameters": {"stiffness": [1.0, 2.0]}}, "unknown"),
        ({"parameters": {"creep_rate": [1.0, -2.0]}}, "out of bounds"),
        ({"parameters": {"creep_rate": [1.0, float("nan")]}}, "not a finite number"),
        ({"parameters": {"creep_rate": [[1.0, 2.0]]}}, "shape"),
        ({"parameters": {"creep_rate": ["a", "b"]}}, "not an array of numbers"),
        ({"parameters": {"creep_rate": [1.0] * 3}}, "shape"),
        ({"load": np.zeros((3, 10))}, "load has shape"),
        ({"reduce": "mean"}, "allowed are last, rms"),
        ({"reduce": "rms", "every": 2}, "give one of them"),
        ({"target": 1.0}, "leave it out"),
        ({"every": 0}, "whole number from 1"),
        ({"outputs": "position"}, "sequence of names"),
        ({"outputs": ("speed",)}, "output 'speed' is unknown"),
        ({"threads": 0.5}, "threads"),
        ({"threads": 257}, "threads = 257 is out of bounds: give a whole number from 1 to 256"),
        ({"parts": 2}, "parts = 2 is for an executor, and there is none; give one, or leave"),
        ({"executor": POOL, "threads": "4"}, "threads = '4' is out of bounds"),
        ({"executor": POOL, "threads": 2}, "threads = 2 is for work in this process.*; leave"),
    ],
)
def test_what_cannot_be_run_is_refused_in_a_sentence(change: dict, words: str) -> None:
    with pytest.raises((st.InputError, TypeError), match=words):
        st.simulate_ensemble(motor(), np.zeros((2, 10)), DT, **change)


def test_a_machine_that_is_too_stiff_is_named_by_its_number() -> None:
    stiff = {"initial_stiffness": [3e3, 3e14], "final_stiffness": 800.0}
    with pytest.raises(st.InputError, match="member 1: dt = "):
        st.simulate_ensemble(motor(), np.zeros((2, 10)), 1e-3, parameters=stiff)


@pytest.mark.parametrize("law", ["hsieh_pan", "maxwell_slip"])
@pytest.mark.parametrize("n", [300, 1500])
def test_a_number_that_is_not_finite_is_named_and_moves_nothing(law: str, n: int) -> None:
    currents, load = efforts(9, n), np.zeros((9, n))
    more = {"breakaway": 0.2} if law == "hsieh_pan" else {}
    base = st.Motor(0.0076, friction=st.FrictionModel(law, **more))
    machines = st.Ensemble(base, 9)
    once = st.Ensemble(base, 9).simulate(currents, DT, load=load)
    for name, rows in (("current", currents), ("load", load)):
        bad = rows.copy()
        bad[4, 17], bad[8, 3] = np.nan, np.inf
        given = {"current": currents, "load": load, name: bad}
        words = rf"{name}\[{4 * n + 17}\] = NaN is not a finite number; repair or drop the sample"
        with pytest.raises(st.InputError, match=words):
            machines.simulate(given["current"], DT, load=given["load"], threads=2)
        with pytest.raises(st.InputError, match=words):
            st.simulate_ensemble(base, given["current"], DT, load=given["load"])
    after = machines.simulate(currents, DT, load=load)
    np.testing.assert_array_equal(after.position, once.position)


@pytest.mark.parametrize("breakaway", [5.0, 40.0])
@pytest.mark.parametrize("dt", [1e-4, 1e-3])
def test_a_fall_behind_break_away_is_divided_alike_whoever_asks(breakaway, dt):
    friction = st.FrictionModel("hsieh_pan", breakaway=breakaway, viscous=breakaway / 50.0)
    motor = st.Motor(0.0076, friction=friction)
    sizes = np.linspace(0.7, 1.3, 11)[:, None]
    currents = 1.2 * breakaway * sizes * np.sin(np.linspace(0.0, 30.0, 1200))
    together = st.simulate_ensemble(motor, currents, dt, outputs=("position",), threads=2)
    for current, position in zip(currents, together.position, strict=True):
        alone, stepped = motor.copy(), motor.copy()
        chunks = [alone.simulate(part, dt).position for part in np.array_split(current, 7)]
        np.testing.assert_array_equal(position, np.concatenate(chunks))
        np.testing.assert_array_equal(position, [stepped.step(i, dt)[0] for i in current])
    assert alone.state["breakaways"] > 1
