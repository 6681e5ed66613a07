"""Planned signals: within the limits when the machine is moved, and what they are for."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.reference.coulomb_reference import simulate_coulomb

import stiction as st
from stiction.cli import run
from stiction.plan import EXPERIMENTS, Plan, plan

SEEDS = range(10)


def drawn(seed: int) -> tuple[st.Plant, dict[str, float]]:
    """A plant and its limits."""
    source = np.random.default_rng(seed)

    def between(low: float, high: float) -> float:
        return float(np.exp(source.uniform(np.log(low), np.log(high))))

    linear = bool(source.integers(2))
    friction = between(0.05, 5.0) * (40.0 if linear else 1.0)
    inertia = between(0.001, 0.1) * (100.0 if linear else 1.0)
    law = ("coulomb", "maxwell_slip", "hsieh_pan")[int(source.integers(3))]
    terms: dict[str, object] = {"coulomb": friction, "viscous": 0.02 * friction}
    if law == "maxwell_slip":
        terms["initial_stiffness"] = friction / between(1e-4, 1e-3)
    if law == "hsieh_pan":
        stiffness = friction / between(1e-4, 1e-3)
        terms |= {
            "breakaway": 1.1 * friction,
            "initial_stiffness": stiffness,
            "final_stiffness": 0.2 * stiffness,
            "decay_distance": friction / stiffness,
            "hardening_coefficient": 0.3 / (stiffness * friction),
            "damping": 0.1 * math.sqrt(inertia * stiffness),
        }
    plant = st.Plant.from_dict(
        {
            "motion": {"kind": "linear" if linear else "rotary"},
            "drive": {
                "input": "force_n" if linear else "current_a",
                "gain": 1.0 if linear else 0.5,
            },
            "body": {"inertia": inertia},
            "friction": {"law": law, **terms},
        }
    )
    limits = {
        "position": between(0.05, 0.5) if linear else between(1.0, 20.0),
        "speed": between(0.1, 2.0) if linear else between(2.0, 60.0),
        "effort": friction * between(2.0, 6.0),
    }
    return plant, limits


def inertia_of(plant: st.Plant) -> float:
    return plant.parameters["body.inertia"].value


def followed(plant: st.Plant, reference: np.ndarray, limit: float, dt: float) -> np.ndarray:
    """Position, speed and effort under a controller that was tuned for inertia and friction.

    A position loop of 20 Hz, and four fifths of the dry friction fed forward.
    """
    motor = plant.motor()
    inertia, gain = inertia_of(plant), float(plant.drive["gain"])
    speed = 2.0 * math.pi * 20.0
    wanted = np.gradient(reference, dt)
    friction = plant.parameters["friction.coulomb"].value
    ahead = 0.8 * friction * np.tanh(wanted / (0.01 * np.max(np.abs(wanted))))
    x = v = total = 0.0
    rows = np.empty((len(reference), 3))
    for k, (r, w, known) in enumerate(zip(reference, wanted, ahead, strict=True)):
        total += (r - x) * dt
        push = inertia * (speed**2 * (r - x) + 1.6 * speed * (w - v) + 4.0 * speed**2 * total)
        push += known
        push = min(max(push, -limit), limit)
        x, v = motor.step(push / gain, dt)
        rows[k] = x, v, push
    return rows


@pytest.mark.long
@pytest.mark.parametrize("seed", SEEDS)
def test_ten_random_plants_stay_within_their_limits(seed: int) -> None:
    plant, limits = drawn(seed)
    made = plan(plant, **limits, rate=1000.0, seed=seed)
    for signal in made.signals:
        if signal.role != "train":
            continue
        if signal.kind == "reference":
            rows = followed(plant, signal.values, limits["effort"], 1e-3)
            reached = np.max(np.abs(rows), axis=0)
            # The drive is limited itself; what counts is that the loop hardly ever asks for it.
            assert np.mean(np.abs(rows[:, 2]) >= limits["effort"]) < 0.01, signal.name
        else:
            gain = float(plant.drive["gain"])
            moved = plant.simulate(signal.values, 1e-3, outputs=["position", "velocity"])
            asked = np.max(np.abs(signal.values)) * gain
            reached = [np.max(np.abs(moved.position)), np.max(np.abs(moved.velocity)), asked]
        for name, most, limit in zip(limits, reached, limits.values(), strict=True):
            assert most <= limit * (1.0 + 1e-9), (signal.name, name, most, limit)


@pytest.mark.long
def test_inputs_stay_within_limits_on_an_independent_machine() -> None:
    plant = st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm", "gain": 1.0},
            "body": {"inertia": 0.0076},
            "friction": {"law": "coulomb", "coulomb": 0.3, "viscous": 0.02},
        }
    )
    made = plan(plant, position=3.0, speed=8.0, effort=1.2, only=("pulses", "chirp"))
    for signal in made.signals:
        moved = simulate_coulomb(
            signal.values, 1e-3, inertia=0.0076, coulomb=0.3, breakaway=0.3, viscous=0.02
        )
        assert np.max(np.abs(moved["position"])) < 3.0
        assert np.max(np.abs(moved["velocity"])) < 8.0
        assert np.max(np.abs(signal.values)) < 1.2


@pytest.fixture(scope="module")
def made() -> Plan:
    friction = {"law": "maxwell_slip", "coulomb": 0.3, "initial_stiffness": 300.0}
    return plan(
        st.Plant.from_dict(
            {
                "drive": {"input": "current_a", "gain": 0.5, "limit": 4.0},
                "body": {"inertia": 0.0076},
                "friction": friction,
            }
        )
    )


def test_each_experiment_has_three_realisations_and_one_is_made_twice(made: Plan) -> None:
    assert {s.experiment for s in made.signals} == {e.name for e in EXPERIMENTS}
    for experiment in EXPERIMENTS:
        own = [s for s in made.signals if s.experiment == experiment.name]
        assert [s.role for s in own] == ["train", "select", "test"]
        same = [
            len(a.values) == len(b.values) and np.array_equal(a.values, b.values)
            for a, b in ((own[0], own[1]), (own[1], own[2]), (own[0], own[2]))
        ]
        # A cycle is compared with itself: it must not differ.
        assert all(same) if experiment.name == "cycle" else not all(same)
    schedule = made.schedule()
    assert [e["kind"] for e in schedule if "replicate_of" in e] == ["tracking", "cycle"]
    starts = [entry["start_s"] for entry in schedule]
    assert starts == sorted(starts)
    # A long rest between the first two cycles: time goes on and the machine does not move.
    assert starts[1] - starts[0] > 120.0 > max(np.diff(starts[1:]))
    cycles = [k for k, entry in enumerate(schedule) if entry["kind"] == "cycle"]
    assert cycles[:2] == [0, 1]
    assert cycles[2] == pytest.approx(len(schedule) / 2, abs=2)
    assert cycles[3] == len(schedule) - 1


def test_speeds_span_three_decades_and_loops_stay_below_break_away(made: Plan) -> None:
    speeds = np.abs(np.diff(made["ramps-train"].values)) * 1e3
    constant = speeds[1:][np.abs(np.diff(speeds)) < 1e-9 * np.max(speeds)]
    moving = constant[constant > 0.0]
    assert np.max(moving) / np.min(moving) > 900.0
    loops = made["loops-train"]
    assert np.max(np.abs(loops.values)) * 0.5 < 0.3
    assert np.max(np.abs(loops.expected)) < 0.01
    rests = made["rests-train"].values
    assert np.all(rests[:4900] == 0.0)


def test_a_gain_that_is_fitted_is_taken_at_its_value() -> None:
    table = {
        "drive": {"input": "current_a", "gain": 0.5},
        "body": {"inertia": {"value": 0.0076, "fixed": True}},
        "friction": {"law": "coulomb", "coulomb": 0.3},
    }
    exact = plan(st.Plant.from_dict(table), only=("turns", "pulses"))
    table["drive"] = {"input": "current_a", "gain": {"value": 0.5}}
    fitted = plan(st.Plant.from_dict(table), only=("turns", "pulses"))
    assert [s.name for s in fitted.signals] == [s.name for s in exact.signals]
    for one, other in zip(exact.signals, fitted.signals, strict=True):
        assert np.array_equal(one.values, other.values)


def test_the_weight_of_a_payload_counts() -> None:
    table = {
        "motion": {"kind": "linear"},
        "drive": {"input": "force_n"},
        "body": {"inertia": 20.0, "weight_n": 10.0, "payload_kg": 5.0},
        "friction": {"law": "coulomb", "coulomb": 12.0},
    }
    plant = st.Plant.from_dict(table)
    carried = 10.0 + 5.0 * 9.80665
    assert plant.weight == pytest.approx(carried)
    # At rest without friction the drive holds it exactly where it pushes with the weight.
    loose = st.Plant.from_dict({**table, "friction": {"law": "coulomb", "coulomb": 0.0}})
    held = loose.simulate(np.full(200, carried), 1e-3, outputs=["position"])
    assert np.max(np.abs(held.position)) < 1e-12
    with pytest.raises(st.InputError, match=r"moves nothing.*gravity 59"):
        plan(plant, position=0.1, effort=60.0)
    # An axis that states no weight moves level, whatever it carries.
    level = st.Plant.from_dict({**table, "body": {"inertia": 20.0, "payload_kg": 5.0}})
    assert level.weight == 0.0


def test_same_seed_same_signals(made: Plan) -> None:
    again, other = plan(made.plant), plan(made.plant, seed=1)
    assert all(
        np.array_equal(a.values, b.values) for a, b in zip(made.signals, again.signals, strict=True)
    )
    assert not np.array_equal(made["ramps-train"].values, other["ramps-train"].values)


def test_a_plan_prints_as_a_table_in_words(made: Plan) -> None:
    lines = repr(made).splitlines()
    assert lines[0].startswith("33 signals, ")
    assert lines[2].split() == [
        *("signal", "kind", "length", "position", "speed", "effort"),
        *("what", "it", "is", "for"),
    ]
    assert lines[3].split() == ["s", "rad", "rad/s", "N·m"]
    for signal, line in zip(made.signals, lines[4:], strict=True):
        assert line.endswith(signal.purpose)
        name, kind, *numbers = line.removesuffix(signal.purpose).split()
        assert (name, kind) == (signal.name, signal.kind)
        asked = [signal.duration, *signal.greatest.values()]
        assert [float(each) for each in numbers] == pytest.approx(asked, rel=1e-2)


@pytest.mark.long
def test_files_can_be_read_back(made: Plan, tmp_path: Path) -> None:
    where = made.save(tmp_path / "plan")
    read = np.loadtxt(where / "signals" / "chirp-test.csv", delimiter=",", skiprows=1)
    assert np.allclose(read[:, 1], made["chirp-test"].values, rtol=1e-8)
    head = (where / "signals" / "chirp-test.csv").read_text(encoding="utf-8").splitlines()[0]
    assert head == "time_s,current_a"
    assert (where / "signals" / "ramps-train.svg").stat().st_size > 1000
    assert len(json.loads((where / "plan.json").read_text(encoding="utf-8"))["signals"]) == 33
    for entry in made.schedule():
        (where / entry["file"]).write_text(
            "time_s,current_a,position_rad\n"
            + "\n".join(f"{k / 1e3},0.1,{k / 1e3}" for k in range(300)),
            encoding="utf-8",
        )
    session = st.load(where / "session.toml")
    assert len(session) == 35
    assert len(session.replicates) == 2


def test_every_effect_names_one_of_the_experiments() -> None:
    known = {experiment.name for experiment in EXPERIMENTS}
    assert {record.plan for record in st.effects()} <= known


BAD: dict[str, tuple[Callable[[st.Plant], Plan], list[str]]] = {
    "an effort that moves nothing": (
        lambda p: plan(p, effort=0.2),
        ["0.2", "moves nothing", "give"],
    ),
    "an effort that moves little": (
        lambda p: plan(p, effort=0.35),
        ["0.35", "hardly moves", "most of it"],
    ),
    "a limit below 0": (lambda p: plan(p, speed=-1.0), ["speed = -1", "above 0"]),
    "an unknown experiment": (lambda p: plan(p, only=("ramp",)), ["ramp", "did you mean 'ramps'"]),
    "a rate of 0": (lambda p: plan(p, rate=0.0), ["rate = 0", "allowed"]),
}


@pytest.mark.parametrize("name", BAD)
def test_what_cannot_be_planned_is_one_sentence(name: str, made: Plan) -> None:
    call, words = BAD[name]
    with pytest.raises(st.InputError) as told:
        call(made.plant)
    assert "\n" not in str(told.value)
    assert all(word in str(told.value) for word in words)


@pytest.mark.parametrize(
    "limits",
    [
        {"position": 1e-12},
        {"position": 1e9},
        {"speed": 1e-9},
        {"speed": 1e9},
        {"effort": 1e12},
        {"position": 1e-9, "rate": 50.0},
    ],
)
def test_absurd_limits_give_signals_or_one_sentence(limits: dict[str, float], made: Plan) -> None:
    absurd, told = None, ""
    try:
        absurd = plan(made.plant, **limits)  # type: ignore[arg-type]
    except st.InputError as error:
        told = str(error)
    assert (absurd is None) == bool(told)
    assert "\n" not in told
    for signal in () if absurd is None else absurd.signals:
        assert signal.duration < 200.0
        assert np.isfinite(signal.values).all()


def test_a_linear_machine_must_say_how_far_it_may_go(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = '[motion]\nkind = "linear"\n[drive]\ninput = "force_n"\n[body]\ninertia = 20.0\n'
    file = tmp_path / "plant.toml"
    file.write_text(text + '[friction]\nlaw = "coulomb"\ncoulomb = 12.0\n', encoding="utf-8")
    assert run(["plan", str(file), "-o", str(tmp_path / "out")]) == 2
    assert "--position" in capsys.readouterr().err
    arguments = ["--position", "0.1", "--only", "turns", "--only", "loops", "--json"]
    assert run(["plan", str(file), "-o", str(tmp_path / "out"), *arguments]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [s["name"] for s in told["signals"]] == ["turns-train", "turns-select", "turns-test"]
    assert any("loops are left out" in note for note in told["notes"])


def test_a_plant_without_inertia_gets_references_and_is_told_what_was_assumed() -> None:
    table = {"drive": {"input": "current_a"}, "friction": {"law": "coulomb"}}
    made = plan(st.Plant.from_dict(table), position=3.0, speed=5.0)
    assert {signal.kind for signal in made.signals} == {"reference"}
    told = " ".join(made.notes)
    assert "states no inertia: signals are sized as if it were" in told
    assert "pulses, loops, chirp are left out" in told
    assert "inertia" not in made.plant.body
    assert all(signal.greatest["speed"] <= 1.02 * 5.0 for signal in made.signals)
    # Stated, nothing is assumed, and the drive alone is planned for as well.
    stated = plan(st.Plant.from_dict({**table, "body": {"inertia": 0.004}}), only=("pulses",))
    assert "inertia" not in " ".join(stated.notes)


def test_what_would_take_days_is_left_out():
    # Next to no friction sizes an effort that hardly moves the machine.
    friction = {"law": "prandtl_ishlinskii", "coulomb": 1e-12, "initial_stiffness": 1e-9}
    made = plan(st.Plant.from_dict({"friction": friction, "body": {"inertia": 0.02}}))
    names = {signal.name for signal in made.signals}
    assert "ramps" not in names
    assert names
    assert "ramps is left out: it would take more than 1800 s, or 1e+07 samples" in made.notes
