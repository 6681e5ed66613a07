"""What is of the wrong kind, or cannot be stored or held, is refused in one sentence."""

from __future__ import annotations

import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest

import stiction as st
from stiction import demo_session, paper
from stiction.compare import compare
from stiction.plan import plan
from stiction.plant.parameter import Parameter
from stiction.plant.stated import Effect, Friction
from stiction.recording import check, read_table

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
    "fit to a file": (lambda: st.fit(plant(), "s.toml"), "give what stiction.load('s.toml')"),
    "fit the wrong way round": (lambda: st.fit(recording(), plant()), "plant is a Recording"),
    "evaluations": (lambda: st.fit(plant(), recording(), max_evaluations="a"), "max_evaluations ="),
    "diagnosis of a word": (lambda: st.diagnose("x", recording()), "plant is 'x'; give a Plant"),
    "diagnosis of nothing": (lambda: st.diagnose(None, None), "there are no recordings"),
    "session of a word": (lambda: st.Session("abc"), "give what stiction.load('abc') returns"),
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
    "members beyond numbers": (
        lambda: st.Ensemble(motor(), 10**30),
        "members = 1000000000000000000000000000000 is out of bounds",
    ),
    "members beyond digits": (
        lambda: st.Ensemble(motor(), 10**5000),
        "members = a int is out of bounds",
    ),
    "every beyond counters": (lambda: ensemble(every=10**30), "is out of bounds: give a whole"),
    "a reduction in numbers": (lambda: ensemble(reduce=np.zeros((2, 2))), "reduce = array([["),
    "complex currents": (
        lambda: motor().simulate(ROWS * 1j, DT),
        "current is not an array of numbers: the type is complex128",
    ),
    "a complex number among dates": (
        lambda: motor().simulate([0.0, np.complex128(1j), np.datetime64("2020")], DT),
        "current is not an array of numbers: must be real number, not complex128",
    ),
    "a word among targets": (
        lambda: st.simulate_ensemble(motor(), np.array([1.0, "2"], dtype=object), DT),
        "currents is not an array of numbers: '2' is among them",
    ),
    "half a surrogate for what acts": (
        lambda: motor().gradient(ROWS, DT, ROWS, ROWS, by="\ud800"),
        "give 'input' or 'load'",
    ),
    "dates for currents": (
        lambda: motor().simulate(ROWS.astype("datetime64[s]"), DT),
        "current is not an array of numbers: the type is datetime64[s]",
    ),
    "times for currents": (
        lambda: motor().run(ROWS.astype("timedelta64[s]"), DT),
        "current is not an array of numbers: the type is timedelta64[s]",
    ),
    "words for currents": (
        lambda: motor().simulate(["1", "2"], DT),
        "current is not an array of numbers: the type is <U1",
    ),
    "records for currents": (
        lambda: ensemble(load=np.zeros(5, dtype=[("a", float)])),
        "load is not an array of numbers: the type is [('a', '<f8')]",
    ),
    "a complex load": (
        lambda: motor().simulate(ROWS, DT, load=np.complex128(1j)),
        "load is not an array of numbers: the type is complex128",
    ),
    "a complex chunk": (lambda: streamed([ROWS * 1j]), "a chunk is not an array of numbers"),
    "a chunk of no dimensions": (lambda: streamed(np.array(3.0)), "is no sequence; give chunks"),
    "outputs of no dimensions": (
        lambda: motor().simulate(ROWS, DT, outputs=np.array(3.0)),
        "outputs = array(3.) is no sequence; give",
    ),
    "a complex state": (
        lambda: setattr(motor(), "state", motor().state | {"position": np.complex128(1j)}),
        "state entry 'position'",
    ),
    "a complex parameter": (
        lambda: st.FrictionModel("coulomb", coulomb=np.complex128(1j)),
        "coulomb of coulomb is a complex128; allowed is a number",
    ),
    "a session of no dimensions": (lambda: st.Session(np.array(3.0)), "a recording is array(3.)"),
    "a parameter in a range": (lambda: Parameter(range(3)), "range(0, 3) is a range; allowed"),
    "a parameter in seconds": (
        lambda: Parameter(np.timedelta64(3, "s")),
        "is a timedelta64; allowed is a number",
    ),
    "a recording in seconds": (
        lambda: st.Session(recording()).clock(np.timedelta64(0, "s")),
        "Session.clock: index = ",
    ),
    "a bound in a word": (lambda: Parameter(1.0, "a"), "min: 'a' is a str; allowed is a number"),
    "no effects": (
        lambda: st.Plant(Friction("coulomb"), effects=None),
        "effects = None is no sequence; give Effects",
    ),
    "a motion in numbers": (
        lambda: st.Plant(Friction("coulomb"), motion=np.zeros((2, 2))),
        "motion = array([[0., 0.], [0., 0.]]) is unknown",
    ),
    "a plant that is none": (
        lambda: st.load("session.toml", plant=True),
        "plant is True; give a Plant",
    ),
    "a role in numbers": (lambda: recording(role=np.zeros((2, 2))), "the role is array([["),
    "a start beyond floats": (lambda: recording(start_s=10**400), "give a finite number of sec"),
    "blocks of nothing": (
        lambda: st.Session(recording()).split(block_s=None),
        "split: block_s: None is a NoneType; allowed is a number",
    ),
    "an edge in an array": (
        lambda: st.Session(recording()).split(edge_s=np.zeros((0, 2))),
        "split: edge_s",
    ),
    "a check of nothing": (lambda: check(None), "recording is None; give a Recording"),
    "a table of nothing": (lambda: read_table(None), "None is not a path"),
    "a demo nowhere": (lambda: demo_session.copy("\ud800"), "no name that a file can have"),
    "an experiment in words": (
        lambda: paper.stick_slip("fast"),
        "stick_slip: speed: 'fast' is a str; allowed is a number",
    ),
    "an experiment without end": (
        lambda: paper.stick_slip(duration=1e300),
        "samples, and 10000000 is the most",
    ),
    "an experiment backwards": (
        lambda: paper.experiment_2(hold=-1.0),
        "a duration is -1 s; give 0 or more",
    ),
    "ramps that do not rise": (
        lambda: paper.static_test(ramp_rate=0.0),
        "ramp_rate = 0 N·m/s; give more than 0",
    ),
    "a single size": (lambda: paper.experiment_3(sizes=3.0), "give a sequence of numbers"),
    "half a pulse": (lambda: paper.experiment_3(pulses=2.5), "give a whole number"),
    "no distances": (lambda: paper.loop_areas(distances=[]), "there are no distances"),
    "no places": (lambda: paper.local_variation(places=0), "places = 0; give 1 to 1000"),
    "no levels": (lambda: paper.static_test(levels=[]), "there are no levels"),
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
    assert Parameter(np.float32(0.5)).value == 0.5
    plain = motor().simulate([1, True, np.float32(3.0), Fraction(1, 2)], np.array(DT))
    assert len(plain) == 4
    assert paper.loop_areas(distances=np.array([1e-4])).area.shape == (1,)
    assert paper.stick_slip(np.array(0.5), duration=np.float32(0.125)).speed == 0.5
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
