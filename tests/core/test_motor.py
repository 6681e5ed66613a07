"""Motor and Trajectory against their written contract."""

import copy
import pickle
import threading
import time

import numpy as np
import pytest

import stiction as st

from .rigs import (
    CONTACTS,
    INERTIA,
    contact,
    motor,
    pieces,
    same_state,
    wandering_current,
    wandering_velocity,
)

DT = 1e-3
SAMPLES = 400
KINDS = list(CONTACTS)
EFFECTS = {
    "cogging": {"cosine": 0.03, "sine": -0.02, "order": 40.0},
    "stribeck": {"excess": 0.2, "velocity": 0.05},
    "torque_bias": {"bias": 0.04},
    "input_delay": {"delay": 0.0037},
}
BUILDS = {
    "plain": {},
    "reference": {"integrator": "reference"},
    "everything": {
        "torque_constant": 1.3,
        "effects": EFFECTS,
        "gravity_amplitude": 0.1,
        "gravity_zero": 0.2,
        "weight": 0.02,
        "input_limit": 0.6,
        "count": 1e-4,
    },
}
# Time is summed sample by sample; over 1e6 samples that drifts by less than this share.
TIME_ROUND_OFF = 1e-10


@pytest.fixture(params=KINDS)
def kind(request):
    return request.param


@pytest.fixture(params=BUILDS.values(), ids=BUILDS.keys())
def build(request):
    return request.param


def inputs(seed, n=SAMPLES):
    current = wandering_current(seed, n, 1.0)
    load = 0.1 * np.sin(np.arange(n) / 30.0)
    return current, load


def stepped(machine, current, load, dt=DT):
    return np.array(
        [machine.step(u, dt, load=f) for u, f in zip(current.tolist(), load.tolist(), strict=True)]
    ).T


def columns_equal(one, other):
    return list(one) == list(other) and all(np.array_equal(one[k], other[k]) for k in one)


@pytest.mark.parametrize("seed", range(2))
def test_simulate_equals_looped_step_to_the_bit(kind, build, seed):
    current, load = inputs(seed)
    whole, looped = motor(kind, **build), motor(kind, **build)
    run = whole.simulate(current, DT, load=load)
    position, velocity = stepped(looped, current, load)
    assert np.array_equal(run.position, position)
    assert np.array_equal(run.velocity, velocity)
    assert whole == looped
    assert run.velocity[-1] == whole.state["velocity"]
    assert run.friction[-1] == whole.state["friction"]


def test_simulate_in_chunks_equals_one_call_to_the_bit(kind, build):
    current, load = inputs(9)
    whole, chunked = motor(kind, **build), motor(kind, **build)
    run = whole.simulate(current, DT, load=load)
    parts = [chunked.simulate(current[p], DT, load=load[p]) for p in pieces(SAMPLES, 1)]
    for name in run:
        assert np.array_equal(run[name], np.concatenate([part[name] for part in parts])), name
    assert whole == chunked


def test_one_duration_a_sample_equals_the_steps_it_names(kind):
    current, load = inputs(4, 120)
    durations = np.random.default_rng(2).choice([1e-4, 3e-4, 1e-3, 2e-3], 120)
    whole, looped = motor(kind), motor(kind)
    run = whole.simulate(current, durations, load=load)
    rows = [
        looped.step(u, d, load=f)
        for u, d, f in zip(current.tolist(), durations.tolist(), load.tolist(), strict=True)
    ]
    assert np.array_equal(run.position, [x for x, _ in rows])
    assert whole == looped
    assert np.array_equal(run.time, np.cumsum(durations))
    same = motor(kind).simulate(current, np.full(120, DT), load=load)
    assert np.array_equal(same.position, motor(kind).simulate(current, DT, load=load).position)


def by_state(machine):
    law, keywords = machine.friction_settings()
    other = st.Motor(friction=st.FrictionModel(law, **keywords), **machine.settings())
    other.state = machine.state
    return other


DUPLICATES = {
    "copy()": lambda machine: machine.copy(),
    "copy.copy": copy.copy,
    "copy.deepcopy": copy.deepcopy,
    "pickle": lambda machine: pickle.loads(pickle.dumps(machine)),
    "state": by_state,
}


@pytest.mark.parametrize("duplicate", DUPLICATES.values(), ids=DUPLICATES.keys())
@pytest.mark.parametrize("cut", [0, 60, 250])
def test_a_duplicate_continues_to_the_bit(kind, build, duplicate, cut):
    current, load = inputs(3)
    machine = motor(kind, **build)
    machine.reset(position=0.1, velocity=0.3)
    stepped(machine, current[:cut], load[:cut])
    other = duplicate(machine)
    assert other is not machine
    assert other == machine
    run = machine.simulate(current[cut:], DT, load=load[cut:])
    assert columns_equal(run, other.simulate(current[cut:], DT, load=load[cut:]))
    assert other == machine
    assert dict(other.statistics) == dict(machine.statistics)


@pytest.mark.parametrize("duplicate", DUPLICATES.values(), ids=DUPLICATES.keys())
@pytest.mark.parametrize("kind", [k for k in KINDS if CONTACTS[k][1].get("breakaway")])
def test_a_duplicate_made_while_slipping_continues_to_the_bit(kind, duplicate):
    machine = motor(kind)
    machine.simulate(np.full(100, 0.7), DT)
    assert machine.state["mode"] == 1.0
    other = duplicate(machine)
    onward = np.concatenate((np.zeros(200), np.full(100, -0.8), np.zeros(200)))
    assert columns_equal(machine.simulate(onward, DT), other.simulate(onward, DT))
    assert machine == other
    assert machine.statistics["breakaways"] > 1


@pytest.mark.parametrize("duplicate", DUPLICATES.values(), ids=DUPLICATES.keys())
def test_a_duplicate_made_after_a_long_ring_down_continues_to_the_bit(duplicate):
    machine = motor("elastic")
    machine.simulate(np.repeat([0.3, -0.3, 0.25, -0.2], 3), 0.01)
    machine.simulate(np.zeros(20_000), 1e-4, outputs=())
    assert len(machine.state["reverse_points"]) > 50
    other = duplicate(machine)
    onward = wandering_current(4, 300, 0.3)
    assert columns_equal(machine.simulate(onward, DT), other.simulate(onward, DT))
    assert machine == other


def test_the_motor_copies_the_law_it_is_given(kind):
    law = contact(kind)
    law.simulate(wandering_velocity(3, 60), DT)
    kept = law.copy()
    machine = st.Motor(inertia=INERTIA, friction=law)
    assert same_state(machine.friction.state, kept.state)
    machine.simulate(wandering_current(1, 100, 1.0), DT)
    assert law == kept
    after = machine.state
    law.reset()
    assert same_state(machine.state, after)
    assert machine.friction != law
    machine.friction.reset()
    assert same_state(machine.state, after)


def test_the_friction_read_back_continues_as_the_motors_own(kind):
    machine = motor(kind)
    machine.simulate(wandering_current(1, 150, 1.0), DT)
    twin = st.Motor(inertia=INERTIA, friction=machine.friction)
    body = {k: machine.state[k] for k in ("position", "velocity", "time", "friction")}
    twin.state = twin.state | body
    current = wandering_current(2, 150, 1.0)
    assert columns_equal(machine.simulate(current, DT), twin.simulate(current, DT))


def test_time_on_access_is_the_end_of_each_sample():
    machine = motor("hook")
    run = machine.simulate(np.zeros(1000), DT, outputs=("position",))
    assert np.array_equal(run.time, DT * np.arange(1, 1001))
    assert "time" not in run.columns
    again = machine.simulate(np.zeros(1000), DT)
    assert np.allclose(again.time, DT * np.arange(1001, 2001), rtol=TIME_ROUND_OFF, atol=0)
    machine.reset()
    assert machine.simulate(np.zeros(3), DT).time[0] == DT


def test_time_does_not_drift_over_many_samples():
    machine = motor("coulomb")
    machine.simulate(np.zeros(1_000_000), 1e-4, outputs=())
    assert machine.state["time"] == pytest.approx(100.0, rel=TIME_ROUND_OFF)


def test_outputs_are_those_asked_for_and_no_others(kind):
    current, _ = inputs(2)
    full = motor(kind).simulate(current, DT)
    assert list(full) == motor(kind).output_names
    assert {"position", "velocity", "friction"} <= set(full)
    some = motor(kind).simulate(current, DT, outputs=("velocity", "position"))
    assert list(some) == ["velocity", "position"]
    assert np.array_equal(some.position, full.position)
    for name in motor(kind).output_names:
        alone = motor(kind).simulate(current, DT, outputs=[name])
        assert list(alone) == [name]
        assert np.array_equal(alone[name], full[name])
    with pytest.raises(AttributeError, match="friction"):
        _ = some.friction


def test_no_outputs_still_advance_the_motor():
    current, _ = inputs(2)
    quiet, shown = motor("hook"), motor("hook")
    run = quiet.simulate(current, DT, outputs=())
    shown.simulate(current, DT)
    assert len(run) == SAMPLES
    assert len(run.time) == SAMPLES
    assert quiet == shown


def test_out_is_refilled_in_place_and_given_back():
    current, _ = inputs(2)
    out = {"position": np.full(SAMPLES, np.nan), "friction": np.full(SAMPLES, np.nan)}
    held = dict(out)
    want = motor("hook").simulate(current, DT)
    run = motor("hook").simulate(current, DT, out=out)
    assert list(run) == ["position", "friction"]
    for name, array in held.items():
        # No copy: the same memory, which only its owner may write to.
        assert run[name].ctypes.data == array.ctypes.data
        assert out[name] is array
        assert np.array_equal(array, want[name])
    other = motor("hook").simulate(-current, DT, out=out)
    assert other.position.ctypes.data == held["position"].ctypes.data
    assert np.array_equal(held["position"], motor("hook").simulate(-current, DT).position)


def test_out_together_with_outputs_fills_what_both_name():
    current, _ = inputs(2)
    position = np.zeros(SAMPLES)
    run = motor("hook").simulate(
        current, DT, outputs=("position", "velocity"), out={"position": position}
    )
    assert run.position.ctypes.data == position.ctypes.data
    assert list(run) == ["position", "velocity"]
    assert np.array_equal(run.velocity, motor("hook").simulate(current, DT).velocity)


def test_a_refused_out_leaves_motor_and_arrays_as_they_were():
    machine = motor("hook")
    machine.simulate(np.full(50, 0.4), DT)
    kept = machine.copy()
    position = np.full(10, 7.0)
    with pytest.raises(st.InputError, match="velocity"):
        machine.simulate(np.ones(10), DT, out={"position": position, "velocity": np.zeros(9)})
    assert machine == kept
    assert np.all(position == 7.0)


def test_input_of_any_form_is_converted():
    current, load = inputs(6, 60)
    want = motor("hook").simulate(current, DT, load=load)
    forms = (
        lambda a: a.tolist(),
        lambda a: np.repeat(a, 3)[::3],
        lambda a: a.astype(">f8"),
        lambda a: np.stack([a, a])[1],
    )
    for form in forms:
        assert columns_equal(motor("hook").simulate(form(current), DT, load=form(load)), want)
    narrow = current.astype(np.float32)
    assert columns_equal(
        motor("hook").simulate(narrow, DT), motor("hook").simulate(narrow.astype(float), DT)
    )
    steady = motor("hook").simulate(current, DT, load=0.1)
    assert columns_equal(motor("hook").simulate(current, DT, load=np.full(60, 0.1)), steady)


def test_load_is_effort_along_positive_motion(kind):
    current, load = inputs(5)
    by_load = motor(kind).simulate(current, DT, load=load)
    by_current = motor(kind).simulate(current + load, DT)
    assert np.allclose(by_load.position, by_current.position, rtol=1e-9, atol=1e-12)


def test_reset_puts_the_body_anywhere_with_friction_never_moved(kind):
    machine = motor(kind)
    machine.simulate(wandering_current(1, 100, 1.0), DT)
    machine.reset(position=0.3, velocity=-0.2)
    assert machine.state["position"] == 0.3
    assert machine.state["velocity"] == -0.2
    assert machine.state["time"] == 0.0
    assert same_state(machine.friction.state, contact(kind).state)
    machine.reset()
    assert machine == motor(kind)


def test_friction_column_obeys_newton(kind):
    # Over a sample the momentum changes by the impulse of all efforts.
    current, load = inputs(8)
    run = motor(kind).simulate(current, 1e-5, load=load)
    change = INERTIA * np.diff(run.velocity, prepend=0.0) / 1e-5
    total = current + load - run.friction
    steady = np.abs(np.diff(run.mode, prepend=0.0)) == 0.0
    lag = np.abs(np.diff(run.friction, prepend=0.0)) + 1e-6
    assert np.all(np.abs(change - total)[steady] <= 2.0 * lag[steady] + 1e-3)


@pytest.mark.parametrize("integrator", ["fast", "reference"])
def test_a_motor_at_rest_without_input_stays_there_to_the_bit(kind, integrator):
    run = motor(kind, integrator=integrator).simulate(np.zeros(1000), DT)
    assert np.all(run.position == 0.0)
    assert np.all(run.velocity == 0.0)
    assert np.all(run.friction == 0.0)


def test_drive_limits_the_input_and_the_gain_scales_it(kind):
    current, _ = inputs(7)
    limited = motor(kind, input_limit=0.4).simulate(current, DT)
    clipped = motor(kind).simulate(np.clip(current, -0.4, 0.4), DT)
    assert columns_equal(limited, clipped)
    geared = motor(kind, torque_constant=2.0).simulate(current / 2.0, DT)
    assert columns_equal(geared, motor(kind).simulate(current, DT))
    turned = motor(kind, torque_constant=-1.0).simulate(-current, DT)
    assert columns_equal(turned, motor(kind).simulate(current, DT))


def test_everything_is_odd_in_the_input(kind):
    current, _ = inputs(7)
    forward, backward = motor(kind).simulate(current, DT), motor(kind).simulate(-current, DT)
    assert np.array_equal(forward.position, -backward.position)
    assert np.array_equal(forward.friction, -backward.friction)


def test_measured_is_the_position_in_counts():
    count = 2e-3
    run = motor("hook", count=count).simulate(np.full(500, 0.6), DT)
    counts = run.measured / count
    assert np.allclose(counts, np.round(counts), rtol=0, atol=1e-9)
    assert np.abs(run.measured - run.position).max() <= count / 2.0 * (1.0 + 1e-9)
    exact = motor("hook").simulate(np.full(500, 0.6), DT)
    assert np.array_equal(exact.measured, exact.position)


def test_repr_evaluates_to_an_equal_motor(kind, build):
    machine = motor(kind, **build)
    names = {"Motor": st.Motor, "FrictionModel": st.FrictionModel}
    assert eval(repr(machine), names) == machine


def test_equality_looks_at_settings_friction_and_state(kind):
    assert motor(kind) == motor(kind)
    assert motor(kind) != motor(kind, weight=0.1)
    assert motor(kind) != motor(kind, integrator="reference")
    assert motor(kind) != motor(kind, effects={"torque_bias": {"bias": 0.1}})
    assert motor(kind) != contact(kind)
    assert all(motor(kind) != motor(other) for other in KINDS if other != kind)
    moved = motor(kind)
    moved.step(0.9, DT)
    assert moved != motor(kind)


def test_a_sane_run_is_a_success_and_says_what_happened(kind, build):
    current, _ = inputs(3)
    run = motor(kind, **build).simulate(current, DT)
    assert run.success
    assert "400 samples" in run.message


def test_a_subclass_survives_copy_and_pickle():
    machine = Crane(inertia=INERTIA, friction=contact("hook"))
    machine.step(0.9, DT)
    assert type(machine.copy()) is Crane
    assert machine.copy() == machine
    assert pickle.loads(pickle.dumps(machine)) == machine


class Crane(st.Motor):
    """A user's own subclass."""


def test_trajectory_prints_saves_and_pickles(tmp_path):
    run = motor("hook").simulate(np.full(200, 0.6), DT)
    assert "200 samples" in repr(run)
    assert "position" in run._repr_html_()
    assert "break-away" in run.message
    again = pickle.loads(pickle.dumps(run))
    assert columns_equal(run, again)
    assert np.array_equal(again.time, run.time)
    with np.load(run.save(tmp_path / "run.npz")) as table:
        assert np.array_equal(table["position"], run.position)
        assert np.array_equal(table["time_s"], run.time)
    rows = np.loadtxt(run.save(tmp_path / "run.csv"), delimiter=",", skiprows=1)
    assert np.array_equal(rows[:, 1], run.position)
    with pytest.raises(st.InputError, match="xlsx"):
        run.save(tmp_path / "run.xlsx")
    with pytest.raises(st.InputError, match="speed"):
        run["speed"]


def test_another_thread_goes_on_during_a_long_simulation():
    machine = motor("hook")
    current = np.zeros(3_000_000)
    ticks, stop = [], threading.Event()

    def tick():
        while not stop.is_set():
            ticks.append(time.perf_counter())
            time.sleep(1e-3)

    other = threading.Thread(target=tick)
    other.start()
    began = time.perf_counter()
    machine.simulate(current, 1e-4, outputs=("position",))
    ended = time.perf_counter()
    stop.set()
    other.join()
    during = [t for t in ticks if began < t < ended]
    # A thread that waited for the simulation would tick twice at most.
    assert len(during) > 10
    assert max(np.diff([began, *during, ended])) < 0.8 * (ended - began)


def test_another_thread_goes_on_during_a_long_friction_simulation():
    model = contact("hook")
    velocity = np.tile(wandering_velocity(1, 1000), 3000)
    done, count = threading.Event(), 0
    worker = threading.Thread(target=lambda: (model.simulate(velocity, DT), done.set()))
    worker.start()
    while not done.is_set():
        count += 1
        time.sleep(1e-3)
    worker.join()
    assert count > 10


def run_together(jobs):
    failures = []

    def guarded(job):
        try:
            job()
        except BaseException as error:
            failures.append(error)

    threads = [threading.Thread(target=guarded, args=(job,)) for job in jobs]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(timeout=60.0)
    assert not any(thread.is_alive() for thread in threads), "threads wait for each other"
    assert failures == []


def test_several_threads_with_a_model_each_get_what_one_thread_gets(kind):
    current, load = inputs(1)
    want = motor(kind).simulate(current, DT, load=load)
    got = [None] * 6

    def work(k):
        machine = motor(kind)
        for _ in range(5):
            machine.reset()
            got[k] = machine.simulate(current, DT, load=load)

    run_together([lambda k=k: work(k) for k in range(6)])
    assert all(columns_equal(run, want) for run in got)


def test_several_threads_may_share_one_model(kind):
    model, machine = contact(kind), motor(kind)
    rows = np.stack([wandering_velocity(seed, 100) for seed in range(8)])
    current, _ = inputs(1)

    def batches():
        for _ in range(40):
            model.simulate(rows, DT)

    def singles():
        for v in rows[0].tolist():
            assert np.isfinite(model.step(v, DT))
            model.trial(v, DT)

    def looks():
        for _ in range(100):
            assert model.copy().law == model.law
            assert repr(model)
            _ = model == model.copy()
            pickle.loads(pickle.dumps(machine))
            assert set(machine.state) >= {"position", "velocity"}

    def moves():
        for _ in range(20):
            assert np.isfinite(machine.simulate(current, DT).position).all()
            machine.step(0.1, DT)

    run_together([batches, singles, singles, looks, moves, moves])
    assert np.isfinite(model.step(0.1, DT))


def test_one_shared_motor_takes_every_sample_of_every_thread():
    machine = motor("coulomb")

    def push():
        for _ in range(200):
            machine.simulate(np.zeros(10), 1.0, outputs=())

    run_together([push] * 4)
    assert machine.state["time"] == 4 * 200 * 10
