"""Closed-loop replay: the stated controller to the letter, and what a diagnosis says with it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.diagnosis import builders
from tests.plant.test_servo import plant as servo_plant
from tests.reference.session_reference import make_session

import stiction as st
from stiction.cli import run
from stiction.closed_loop import replay
from stiction.diagnosis.data.evidence import Evidence, SealedError
from stiction.diagnosis.findings import loop
from stiction.diagnosis.findings.loop import with_loop_replay
from stiction.diagnosis.findings.words import loop_words, worse_loop_words
from stiction.diagnosis.records import CandidateRow
from stiction.plant.parameter import Parameter
from stiction.plant.stated import Effect

# A power of two: stamps carry no round-off, and a loop made by hand agrees to the last bit.
DT = 2.0**-10
COUNTS = 2**14

KINDS = {
    "pd": {"kind": "pd", "kp": 9.0, "kd": 0.35},
    "p": {"kind": "pd", "kp": 3.0},
    "pid": {"kind": "pid", "kp": 9.0, "ki": 30.0, "kd": 0.35},
    "position_velocity": {"kind": "position_velocity", "kp": 25.0, "kv": 0.35},
    "filtered": {"kind": "pd", "kp": 9.0, "kd": 0.35, "filter_s": 0.004},
    "limited": {"kind": "pid", "kp": 9.0, "ki": 30.0, "kd": 0.35, "limit": 0.3},
}
RULES = ("backward", "backward_of_two_sample_mean", "measured")


def plant(controller: dict[str, object] | None = None, **tables: object) -> st.Plant:
    table: dict[str, object] = {
        "drive": {"input": "current_a", "gain": 0.8},
        "body": {"inertia": 0.006},
        "friction": {"law": "maxwell_slip", "coulomb": 0.2, "viscous": 0.02},
        "sensor": {"counts_per_rev": COUNTS},
    }
    if controller is not None:
        table["controller"] = controller
    return st.Plant.from_dict({**table, **tables})


def by_hand(
    machine: st.Plant, goals: np.ndarray, *, total: float = 0.0, load: float = 0.0
) -> st.Recording:
    """A recording of the loop, each formula of the documentation written out."""
    c, count = machine.controller, machine.count
    motor, readings, inputs, speeds, filtered = machine.motor(), [], [], [], 0.0
    x = v = 0.0
    for k, goal in enumerate(goals):
        y = np.round(x / count) * count
        readings.append(y)
        speeds.append(v)

        def back(values: list[float], j: int, k: int = k) -> float:
            return values[k - j] if k >= j else values[0]

        def asked(j: int, k: int = k) -> float:
            # Before the first sample the reference lies on the line through the first two.
            return goals[k - j] if k >= j else goals[0] + (k - j) * (goals[1] - goals[0])

        rule = c.get("derivative", "backward")
        if rule == "backward_of_two_sample_mean":
            now, before = (y + back(readings, 1)) / 2, (back(readings, 1) + back(readings, 2)) / 2
            speed = (now - before) / DT
            slope = ((asked(0) + asked(1)) / 2 - (asked(1) + asked(2)) / 2) / DT
        else:
            speed = v if rule == "measured" else (y - back(readings, 1)) / DT
            slope = (asked(0) - asked(1)) / DT
        share = DT / (c.get("filter_s", 0.0) + DT)
        filtered = (1 - share) * filtered + share * speed
        total += (goal - y) * DT
        if c["kind"] == "position_velocity":
            u = c["kv"] * (c["kp"] * (goal - y) - filtered)
        else:
            u = c["kp"] * (goal - y) + c.get("kd", 0.0) * (slope - filtered)
            u += c.get("ki", 0.0) * total
        inputs.append(np.clip(u, -c.get("limit", np.inf), c.get("limit", np.inf)))
        x, v = motor.step(float(inputs[-1]), DT, load=load)
    channels = {"reference": goals, "velocity": speeds}
    if load:
        channels["load"] = np.full(len(goals), load)
    return st.Recording(np.arange(len(goals)) * DT, inputs, readings, **channels)


def goals(seconds: float = 2.0) -> np.ndarray:
    time = np.arange(round(seconds / DT)) * DT
    return 0.8 * (1.0 - np.cos(4.0 * time)) + 0.05 * (1.0 - np.cos(23.0 * time))


def cut(recording: st.Recording, first: int) -> st.Recording:
    channels = {name: values[first:] for name, values in recording.channels.items()}
    assert recording.input is not None
    assert recording.position is not None
    return st.Recording(
        recording.time[first:], recording.input[first:], recording.position[first:], **channels
    )


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("kind", KINDS)
def test_the_loop_is_the_one_that_the_documentation_writes_out(kind: str, rule: str) -> None:
    machine = plant({**KINDS[kind], "derivative": rule})
    recording = by_hand(machine, goals())
    loop = replay(machine, recording)
    # The product reads counts, and what it is compared with here are readings too.
    count = 2.0 * np.pi / COUNTS
    assert np.max(np.abs(np.round(loop.simulated / count) * count - loop.measured)) < 1e-9
    assert loop.input == pytest.approx(recording.input, abs=1e-6)
    assert loop.controller_error == pytest.approx(0.0, abs=1e-6)
    assert loop.greatest <= 0.5001 * count
    assert loop.unit == "rad"
    assert len(loop.time) == len(recording)


def test_other_friction_load_and_an_unknown_velocity_show() -> None:
    machine = plant({**KINDS["pd"], "derivative": "measured"})
    recording = by_hand(machine, goals(), load=0.1)
    assert replay(machine, recording).rms < 1e-3
    other = machine.with_values({"coulomb": 0.21})
    assert replay(other, recording).rms > 2.0 * replay(machine, recording).rms
    channels = {name: c for name, c in recording.channels.items() if name == "reference"}
    bare = st.Recording(recording.time, recording.input, recording.position, **channels)
    loop = replay(machine, bare)
    assert loop.controller_error is None
    assert loop.rms > 2.0 * replay(machine, recording).rms
    assert set(loop.to_dict()) == {"rms", "greatest", "unit", "controller_error"}
    assert len(loop.plot().axes) == 2


def test_what_the_integral_held_is_told_by_the_input() -> None:
    machine = plant(KINDS["pid"])
    held = by_hand(machine, goals(), total=0.01)
    assert replay(machine, held).greatest < 2.0 * np.pi / COUNTS
    # A wrong gain shows in the controller's own input, wherever the machine is.
    wrong = plant({**KINDS["pid"], "kp": 5.0})
    assert (replay(wrong, held).controller_error or 0.0) > 0.1


def test_a_recording_may_begin_in_motion_and_with_a_strained_contact() -> None:
    # A soft contact: what it holds at the start matters for 10 mrad.
    soft = {"law": "maxwell_slip", "coulomb": 0.2, "viscous": 0.02, "initial_stiffness": 40.0}
    machine = plant(KINDS["position_velocity"], friction=soft, sensor={"counts_per_rev": 2.0**22})
    moving = cut(by_hand(machine, goals()), 300)
    known = replay(machine, moving, {"force": 0.19})
    assert known.rms < 1e-4
    assert replay(machine, moving).rms > 5.0 * known.rms
    assert replay(machine, moving, {"force": -0.19}).rms > replay(machine, moving).rms


def test_what_was_set_for_a_recording_counts_once() -> None:
    settings = {"payload_kg": 1.0, "payload_m": 0.06}
    machine = plant(KINDS["pd"])
    heavy = machine.under(settings)
    made = by_hand(heavy, goals())
    recording = st.Recording(
        made.time, made.input, made.position, settings=settings, **made.channels
    )
    loop = replay(machine, recording)
    assert loop.greatest <= 0.5001 * machine.count
    assert replay(machine, made).rms > 1e-3
    # Of a plant that was set already nothing comes on top.
    assert replay(heavy, recording).simulated == pytest.approx(loop.simulated, abs=0.0)


def test_inputs_that_no_machine_got_are_none_that_the_controller_missed() -> None:
    machine = plant(KINDS["pd"])
    made = by_hand(machine, goals())
    assert made.input is not None
    logged = made.input.copy()
    logged[300:1800:150] += 8.0
    recording = st.Recording(made.time, logged, made.position, **made.channels)
    # A line between neighbours is not quite what the controller asked for there.
    assert (replay(machine, recording).controller_error or 0.0) < 0.02


def test_what_cannot_be_replayed_is_refused_in_one_sentence() -> None:
    machine = plant(KINDS["pd"])
    recording = by_hand(machine, goals(0.5))
    bare = st.Recording(recording.time, recording.input, recording.position)
    alone = st.Recording(
        recording.time, recording.input, None, reference=recording.channels["reference"]
    )
    moved = {"drive": {"kind": "prescribed_motion"}}
    for given, data, told in (
        (plant(), recording, r"plant: \[controller\] is missing; state its kind"),
        (plant(KINDS["pd"], **moved), recording, "prescribed_motion.*drop"),
        (machine, bare, "no reference that the controller could follow; name its column"),
        (machine, alone, "no measured position"),
        (plant({"kind": "pd", "kp": -9.0}), recording, "runs away .* s after its start; check"),
        (plant({"kind": "pd", "kp": 1e300, "kd": 1e300}), recording, "cannot be simulated|away"),
    ):
        with pytest.raises(st.InputError, match=told) as caught:
            replay(given, data)
        assert "\n" not in str(caught.value)


REFUSED = {
    "no ki": ({"kind": "pid", "kp": 1.0}, "ki is missing; a controller of kind 'pid' needs kp and"),
    "no kp": ({"kind": "pd", "kd": 1.0}, "kp is missing; .* state kp, or take another kind of pd"),
    "no kv": ({"kind": "position_velocity", "kp": 1.0}, "kv is missing"),
    "kv of another kind": (
        {"kind": "pd", "kp": 1.0, "kv": 1.0},
        r"\[controller\] of kind 'pd': 'kv' is unknown.*allowed are kind, derivative, kp, kd, filt",
    ),
    "infinite gain": ({"kind": "pd", "kp": float("inf")}, "kp = inf: give a finite number"),
    "negative filter": ({"kind": "pd", "kp": 1.0, "filter_s": -0.1}, "filter_s = -0.1 is below 0"),
    "no output": ({"kind": "pd", "kp": 1.0, "limit": 0.0}, "limit = 0.0 is not above 0"),
    "another rule": ({"kind": "pd", "kp": 1.0, "derivative": "forward"}, "'forward' is unknown"),
}


@pytest.mark.parametrize("fault", REFUSED)
def test_a_faulty_controller_is_refused_in_one_sentence(fault: str) -> None:
    controller, told = REFUSED[fault]
    with pytest.raises(st.InputError, match=told) as caught:
        plant(controller)
    assert str(caught.value).startswith("plant: [controller]")
    assert "\n" not in str(caught.value)


def test_a_controller_survives_a_round_trip(tmp_path: Path) -> None:
    machine = plant({**KINDS["filtered"], "limit": 2.0, "derivative": "measured"})
    assert st.Plant.load(machine.save(tmp_path / "plant.toml")) == machine


@pytest.fixture(scope="module")
def diagnosed() -> st.Diagnosis:
    """A session of the reference plant under its PID controller, with a hidden Stribeck fall."""
    kinds = ("tracking", "ramps", "sines")
    made = make_session(3, hidden=[("stribeck", 0.012)], kinds=kinds, seconds=50.0, rate=5e3)
    stated = made.controller
    controller = {
        "kind": "pid",
        "kp": stated["proportional"],
        "ki": stated["integral"],
        "kd": stated["derivative"],
        "filter_s": stated["filter_time"],
    }
    machine = st.Plant.from_dict({**as_plant(made).to_dict(), "controller": controller})
    return st.diagnose(machine, as_session(made), surrogates=8, threads=1)


def test_naming_the_cause_makes_the_simulated_loop_better(diagnosed: st.Diagnosis) -> None:
    assert [cause.name for cause in diagnosed.effects] == ["stribeck"]
    found = diagnosed.to_dict()
    before, after = found["baseline"]["replay"], found["extended"]["replay"]
    assert set(before) == {"unit", "train_rms", "heldout_rms"}
    assert before["unit"] == "rad"
    assert after["train_rms"] < 0.7 * before["train_rms"]
    assert after["heldout_rms"] < 0.7 * before["heldout_rms"]
    assert diagnosed.baseline is not None
    assert diagnosed.baseline.replay is not None
    assert (diagnosed.baseline.replay.controller_error or 1.0) < 1e-3
    (line,) = [row for row in str(diagnosed).splitlines() if row.startswith("closed loop")]
    assert "mrad rms before" in line
    assert "[controller]" not in line


def test_a_loop_that_a_cause_makes_worse_is_said_on_the_first_screen(
    diagnosed: st.Diagnosis,
) -> None:
    assert worse_loop_words(diagnosed) == ""
    assert diagnosed.baseline is not None
    assert diagnosed.extended is not None
    turned = replace(
        diagnosed,
        baseline=replace(diagnosed.baseline, replay=diagnosed.extended.replay),
        extended=replace(diagnosed.extended, replay=diagnosed.baseline.replay),
    )
    assert "the simulated loop does worse with it" in worse_loop_words(turned)
    assert worse_loop_words(replace(turned, effects=())) == ""


@pytest.mark.parametrize(
    ("errors", "kept"),
    [
        ((1.0, 0.5), 1),
        ((1.0, 1.05), 1),
        ((1.0, 1.2), 0),
        ((1.0, None), 0),
        ((None, 1.2), 1),
        ((1.0, 0.5, 0.6), 1),
        # The last one helps, and less than the first one does harm.
        ((1.0, 3.0, 2.0), 0),
        ((1.0, 3.0, 0.9), 2),
    ],
)
def test_what_leads_the_simulated_loop_astray_is_no_cause(
    errors: tuple[float | None, ...], kept: int
) -> None:
    names = ("first", "second")[: len(errors) - 1]
    rows = {name: CandidateRow(name, 0.5, 0.1, 0.2, "accepted") for name in names}
    selection = builders.search(*names, rows=rows)
    found = loop.drop_harmful(selection, errors)
    assert [choice.winner.name for choice in found.choices] == list(names[:kept])
    assert found.models == selection.models[: kept + 1]
    dropped = [found.rows[name].reason for name in names[kept:]]
    assert dropped == [loop.LOOP_AGAINST] * len(dropped)


def as_recorded(whole: st.Recording, **labels: Any) -> st.Recording:
    return st.Recording(whole.time, whole.input, whole.position, **whole.channels, **labels)


@pytest.mark.parametrize("controlled", [True, False])
@pytest.mark.parametrize("opened", [False, True])
def test_a_cause_that_the_machine_lacks_is_taken_back_where_a_loop_tells(
    controlled: bool, opened: bool
) -> None:
    machine = plant(KINDS["p"])
    recordings = [
        as_recorded(by_hand(machine, share * goals(4.0)), role=role)
        for share, role in ((1.0, "train"), (0.9, "select"), (1.1, "test"))
    ]
    stated = machine if controlled else plant()
    bent = replace(stated, effects=(Effect("torque_bias", {"bias": Parameter(0.15)}),))
    evidence = Evidence(stated, recordings)
    if opened:
        evidence.open_test()
    models = [builders.model(evidence, each) for each in (stated, bent)]
    found = loop.borne_out(builders.search("torque_bias", models=models), evidence)
    assert len(found.choices) == (0 if controlled else 1)
    # What does no harm stays.
    same = builders.search("torque_bias", models=models[:1] * 2)
    assert loop.borne_out(same, evidence).choices


def test_a_servo_has_a_loop_without_a_reference() -> None:
    servo = servo_plant()
    whole = by_hand(plant(KINDS["p"]), goals())
    recording = st.Recording(whole.time, whole.input, whole.position)
    assert loop._is_controlled(servo)
    assert loop._has_loop(servo, recording)
    assert not loop._has_loop(plant(KINDS["p"]), recording)


def test_the_report_shows_the_loop_where_there_is_one(
    diagnosed: st.Diagnosis, tmp_path: Path
) -> None:
    page = diagnosed.save(tmp_path).read_text("utf-8")
    assert '<section id="loop"' in page
    assert "In closed loop" in page
    assert (tmp_path / "figures" / "closed-loop.svg").exists()
    findings = json.loads((tmp_path / "findings.json").read_text("utf-8"))
    assert findings["extended"]["replay"]["heldout_rms"] > 0.0
    assert diagnosed.baseline is not None
    assert diagnosed.extended is not None
    bare = replace(
        diagnosed,
        baseline=replace(diagnosed.baseline, replay=None),
        extended=replace(diagnosed.extended, replay=None),
        pictures=None,
    )
    assert '<section id="loop"' not in bare.save(tmp_path).read_text("utf-8")
    assert not (tmp_path / "figures" / "closed-loop.svg").exists()
    assert bare.to_dict()["baseline"]["replay"] is None


@pytest.mark.slow
def test_blocks_of_a_single_recording_are_told_apart_and_a_loop_may_run_away() -> None:
    machine = plant(KINDS["pd"])
    recording = by_hand(machine, goals(20.0))
    found = st.diagnose(machine, recording, surrogates=4, threads=1, without=["input_delay"])
    assert found.baseline is not None
    assert found.baseline.replay is not None
    evidence = Evidence(machine, [recording])
    base = builders.model(evidence, machine)
    with pytest.raises(SealedError):
        with_loop_replay(found, evidence, base, base)
    evidence.weigh()
    evidence.open_test()
    again = with_loop_replay(found, evidence, base, base)
    assert again.baseline is not None
    assert again.baseline.replay is not None
    error = replay(machine, recording).error
    for role, rms in (
        ("train", again.baseline.replay.train_rms),
        ("test", again.baseline.replay.heldout_rms),
    ):
        rows = [part["rows"] for part in evidence.split.to_dict()[role]]
        own = np.concatenate([error[first:last] for first, last in rows])
        assert rms == pytest.approx(np.sqrt(np.mean(own**2)), rel=1e-9)
    assert again.pictures is not None
    assert again.pictures.tracking is not None
    assert np.isnan(again.pictures.tracking.measured).any()
    away = builders.model(evidence, plant({"kind": "pd", "kp": -9.0}))
    lost = with_loop_replay(found, evidence, away, away)
    assert lost.to_dict()["baseline"]["replay"] == {
        "unit": "rad",
        "train_rms": None,
        "heldout_rms": None,
    }
    assert "not replayed in closed loop: the simulated loop runs away" in lost.baseline.remarks[-1]  # type: ignore[union-attr]
    assert "runs away" in loop_words(lost)
    open_loop = builders.model(evidence, plant())
    assert with_loop_replay(found, evidence, open_loop, open_loop) is found


def test_the_command_line_prints_the_loop(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    machine = plant(KINDS["pd"])
    recording = by_hand(machine, goals())
    np.savez(
        tmp_path / "run.npz",
        time_s=recording.time,
        current_a=recording.input,
        position_rad=recording.position,
        reference_rad=recording.channels["reference"],
    )
    machine.save(tmp_path / "plant.toml")
    plant({"kind": "pd", "kp": -9.0}).save(tmp_path / "away.toml")
    out = ["-o", str(tmp_path / "out")]
    assert run(["simulate", str(tmp_path / "plant.toml"), str(tmp_path / "run.npz"), *out]) == 0
    told = capsys.readouterr().out
    assert "closed loop: position error" in told
    assert "controller along the measured motion: error 0.000 %" in told
    assert (tmp_path / "out" / "run-closed-loop.svg").exists()
    assert run(["simulate", str(tmp_path / "away.toml"), str(tmp_path / "run.npz"), *out]) == 0
    assert "the simulated loop runs away" in capsys.readouterr().out


def test_emps_under_its_own_controller(shared_data: Path) -> None:
    table = {
        "motion": {"kind": "linear"},
        "drive": {"input": "voltage_v", "gain": 35.15065},
        "body": {"inertia": 95.109},
        "friction": {"law": "coulomb", "coulomb": 20.39, "viscous": 203.50},
        "effects": [{"name": "torque_bias", "bias": 3.165}],
        "controller": {
            "kind": "position_velocity",
            "kp": 160.18,
            "kv": 243.45,
            "derivative": "backward_of_two_sample_mean",
        },
    }
    columns = {
        "time": "t",
        "input": {"name": "vir", "unit": "V"},
        "position": {"name": "qm", "unit": "m"},
        "reference": {"name": "qg", "unit": "m"},
    }
    recording = st.Recording.load(
        shared_data / "emps" / "DATA_EMPS.mat", columns, motion="linear", drive="voltage_v"
    )
    loop = replay(st.Plant.from_dict(table), recording)
    assert loop.controller_error == pytest.approx(0.0024, abs=0.0002)
    assert loop.rms < 2e-6
    # Published for the closed-loop simulation: 5.85 % of the force.
    missed = np.linalg.norm(loop.input - recording.input) / np.linalg.norm(recording.input)
    assert missed < 0.0585
    assert replay(st.Plant.from_dict({**table, "effects": []}), recording).rms > 1.5 * loop.rms
