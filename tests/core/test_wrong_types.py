"""What is of the wrong kind, or cannot be stored or held, is refused in one sentence."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

import stiction as st
from stiction.compare import compare
from stiction.parameter import Parameter
from stiction.plan import plan
from stiction.stated import Effect, Friction

ROWS = np.arange(300.0)
DT = 1e-3


def motor() -> st.Motor:
    return st.Motor(0.0076, friction=st.FrictionModel("coulomb", coulomb=0.1))


def plant() -> st.Plant:
    table = {"body": {"inertia": 0.01}, "friction": {"law": "coulomb"}}
    return st.Plant.from_dict(table)


def recording(**more) -> st.Recording:
    return st.Recording(ROWS * DT, np.sin(ROWS), np.cos(ROWS), **more)


def ensemble(**keywords):
    return st.simulate_ensemble(motor(), np.ones(5), DT, **keywords)


def streamed(chunks, **keywords):
    return list(st.stream(motor(), chunks, DT, **keywords))


REFUSED = {
    "fit of a file": (lambda: st.fit("p.toml", recording()), "plant is 'p.toml'; give a Plant"),
    "fit to a file": (lambda: st.fit(plant(), "s.toml"), "a recording is 's.toml'; give a Session"),
    "fit the wrong way round": (lambda: st.fit(recording(), plant()), "plant is a Recording"),
    "evaluations": (lambda: st.fit(plant(), recording(), max_evaluations="a"), "max_evaluations ="),
    "diagnosis of a word": (lambda: st.diagnose("x", recording()), "plant is 'x'; give a Plant"),
    "diagnosis of nothing": (lambda: st.diagnose(None, None), "a recording is None"),
    "session of a word": (lambda: st.Session("abc"), "a recording is 'abc'"),
    "session of a number": (lambda: st.Session([1]), "a recording is 1"),
    "session's plant": (lambda: st.Session([recording()], plant="x"), "plant is 'x'; give a Plant"),
    "load of nothing": (lambda: st.load(None), "None is not a path"),
    "plant of nothing": (lambda: st.Plant.load(None), "None is not a path"),
    "plant of a number": (lambda: st.Plant.from_dict(3), "plant is 3; give the tables"),
    "recording of nothing": (lambda: st.Recording.load(None), "None is not a path"),
    "settings": (lambda: recording(settings=3), "settings is 3; give names"),
    "value that is none": (lambda: plant().with_values({"inertia": np.nan}), "inertia: nan is not"),
    "values by no name": (lambda: plant().with_values(3), "values is 3; give numbers by path"),
    "payload below nothing": (
        lambda: plant().under({"payload_kg": -0.3, "payload_m": 0.1}),
        "payload_kg = -0.3 is out of bounds",
    ),
    "payload in words": (lambda: plant().under({"payload_kg": "much"}), "payload_kg: 'much'"),
    "outputs that are none": (
        lambda: motor().simulate(ROWS, DT, outputs=3),
        "outputs = 3 is no sequence; give",
    ),
    "outputs in numbers": (lambda: ensemble(outputs=[1]), r"outputs[0] = 1 is no word; give"),
    "outputs in a word": (lambda: ensemble(outputs="position"), "'position' is a word; give"),
    "outputs of a stream": (lambda: streamed([ROWS], outputs="position"), "is a word; give"),
    "outputs of the core": (
        lambda: motor().run(ROWS, DT, outputs="position"),
        "'position' is a single word; give a sequence of names",
    ),
    "parameters of a sensitivity": (
        lambda: motor().sensitivity(ROWS, DT, "inertia"),
        "'inertia' is a single word; give a sequence of names",
    ),
    "parameters that are none": (
        lambda: motor().sensitivity(ROWS, DT, 3),
        "3 is no sequence; give",
    ),
    "parameters in numbers": (lambda: motor().sensitivity(ROWS, DT, [3]), "3 is no word; give"),
    "a friction in a word": (lambda: st.Motor(1.0, friction="coulomb"), "friction is coulomb, no"),
    "effects in a list": (
        lambda: st.Motor(1.0, friction=st.FrictionModel("coulomb", coulomb=0.1), effects=[]),
        "effects is []; give a dict",
    ),
    "an output twice": (
        lambda: motor().simulate_segments(
            [0.1], [1.0], tolerance=1e-6, outputs=("position", "position")
        ),
        "output 'position' is asked for twice",
    ),
    "count": (lambda: st.Recording.load("x.csv", count_size=np.nan), "count_size: nan is not"),
    "count of nothing": (lambda: st.Recording.load("x.csv", count_size=0.0), "count_size = 0.0"),
    "ensemble's parameters": (lambda: ensemble(parameters=[1]), "parameters is [1]; give values"),
    "executor": (lambda: ensemble(executor=3), "executor is 3; give one of"),
    "threads": (lambda: ensemble(threads=0), "threads = 0 is out of bounds"),
    "ensemble of no motor": (lambda: st.Ensemble(None, 3), "motor is None; give a Motor"),
    "members below 0": (lambda: st.Ensemble(motor(), -1), "members = -1 is out of bounds"),
    "half a member": (lambda: st.Ensemble(motor(), 2.5), "members = 2.5 is out of bounds"),
    "two names": (
        lambda: ensemble(parameters={"coulomb": [0.1], "friction.coulomb": [0.2]}),
        "'friction.coulomb' is named twice",
    ),
    "chunk of a word": (lambda: streamed(["abc"]), "a chunk is not an array of numbers"),
    "no chunks": (lambda: streamed(None), "currents = None is no sequence"),
    "stream of no motor": (lambda: list(st.stream(3, [], DT)), "motor is 3; give a Motor"),
    "masked input": (
        lambda: motor().simulate(np.ma.array([1.0, 2.0], mask=[0, 1]), DT),
        "current is masked in places",
    ),
    "masked recording": (
        lambda: st.Recording(ROWS, np.ma.array(ROWS, mask=ROWS < 100), ROWS),
        "100 missing or infinite cells",
    ),
    "plant in no folder": (lambda: plant().save("/nonexistent/p.toml"), "cannot be written (No"),
    "run in no folder": (
        lambda: motor().simulate(np.ones(3), DT).save("/proc/x.npz"),
        "cannot be written",
    ),
    "checkpoint in no folder": (
        lambda: streamed([np.ones(3)], checkpoint="/nonexistent/c"),
        "/nonexistent/c: is no place for a checkpoint",
    ),
    "plan of nothing": (lambda: plan(None), "plan: plant is None; give a Plant"),
    "plan of a file": (lambda: plan("p.toml"), "plan: plant is 'p.toml'; give a Plant"),
    "plan's limit in words": (lambda: plan(plant(), position="1"), "plan: position: '1' is a str"),
    "plan's rate in words": (lambda: plan(plant(), rate="1"), "plan: rate: '1' is a str"),
    "plan's rate": (lambda: plan(plant(), rate=np.nan), "plan: rate: nan is not a number"),
    "plan of a word": (lambda: plan(plant(), only="ramps"), "plan: only = 'ramps' is a word; give"),
    "comparison of a word": (lambda: compare("coulomb"), "compare: laws = 'coulomb' is a word"),
    "half a step": (lambda: compare(steps=2000.5), "compare: steps = 2000.5 is out of bounds"),
    "too few steps": (lambda: compare(steps=999), "give a whole number from 1000"),
    "draws below 0": (
        lambda: compare(draws=-1),
        "draws = -1 is out of bounds: give a whole number",
    ),
    "body of numbers": (
        lambda: st.Plant(Friction("coulomb"), body={"inertia": 0.1}),
        "plant: [body] inertia is 0.1; give a Parameter",
    ),
    "friction of numbers": (
        lambda: Friction("coulomb", {"coulomb": 0.1}),
        "friction: coulomb is 0.1; give a Parameter",
    ),
    "plant of a law's name": (
        lambda: st.Plant("coulomb"),
        "friction is 'coulomb'; give a Friction",
    ),
    "effect by its name": (
        lambda: st.Plant(Friction("coulomb"), effects=("cogging",)),
        "an effect is 'cogging'; give an Effect",
    ),
    "effect of numbers": (
        lambda: Effect("cogging", {"cosine": 0.1}),
        "effect cogging: cosine is 0.1; give a Parameter",
    ),
    "sensor in a word": (
        lambda: st.Plant(Friction("coulomb"), sensor="encoder"),
        "Plant: sensor is 'encoder'; give a mapping",
    ),
    "rows of unlike lengths": (
        lambda: st.Ensemble(motor(), 2).simulate([1.0, [2.0]], DT),
        "current is not an array of numbers",
    ),
    "a whole number beyond floats": (
        lambda: ensemble(target=10**400, reduce="rms"),
        "not an array of numbers",
    ),
    "currents beyond floats": (
        lambda: st.simulate_ensemble(motor(), [10**400], DT),
        "currents is not an array of numbers",
    ),
    "members beyond memory": (
        lambda: st.Ensemble(motor(), 10**12),
        "GiB) for 1000000000000 machines; give fewer",
    ),
    "members beyond numbers": (lambda: st.Ensemble(motor(), 10**30), "machines; give fewer"),
}


@pytest.mark.parametrize(("asked", "told"), REFUSED.values(), ids=REFUSED)
def test_what_cannot_be_used_is_refused_in_one_sentence(asked, told: str) -> None:
    with pytest.raises(st.InputError) as caught:
        asked()
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_their_good_twins_are_taken() -> None:
    by_hand = st.Plant(Friction("coulomb"), body={"inertia": Parameter(0.01)})
    assert by_hand.motor() is not None
    limits = {"position": np.float32(2.0), "speed": np.int64(5)}
    made = plan(by_hand, **limits, only=np.array(["turns"]))
    assert len(made.signals) == 3
    assert len(st.Session(recording())) == 1
    assert len(st.Ensemble(motor(), np.int64(2))) == 2
    assert ensemble(every=np.int64(2)).position.shape == (1, 2)
    assert plant().with_values({"inertia": np.float32(0.5)}).inertia == 0.5
    unmasked = np.ma.array([1.0, 2.0], mask=[0, 0])
    assert len(motor().simulate(unmasked, DT)) == 2
    few = np.ma.array(ROWS, mask=ROWS == 7.0)
    assert st.Recording(ROWS, few, ROWS).quality[0].count == 1


def test_rows_beyond_memory_are_refused_before_anything_is_simulated() -> None:
    program = """
import resource, numpy as np, stiction as st
motor = st.Motor(0.0076, friction=st.FrictionModel("coulomb"))
fleet = st.Ensemble(motor, 20000)
motor.simulate(np.ones(10), 1e-3)
used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + 2**28, used + 2**28))
inputs = np.broadcast_to(1.0, (10**8,))
for run in (lambda: motor.simulate(inputs, 1e-3), lambda: fleet.simulate(inputs[:10000], 1e-3)):
    try:
        run()
    except st.InputError as error:
        print(error)
"""
    if not sys.platform.startswith("linux"):
        pytest.skip("the limit and the file are Linux's")
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    told = done.stdout.splitlines()
    assert [line.split(" for ")[1] for line in told] == [
        "100000000 rows of 5 outputs; give fewer",
        "the rows of 20000 machines; keep fewer by every, reduce or outputs",
    ]
