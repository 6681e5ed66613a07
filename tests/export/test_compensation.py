"""A feed-forward of friction in a simulated loop: what it is worth, and when it hurts."""

import json

import numpy as np
import pytest

import stiction as st
from stiction import closed_loop
from stiction.cli import run
from stiction.compensation import (
    SHARES,
    Compensated,
    Compensation,
    compensate,
    feed_forward,
    observer,
)

from .test_steady import plant

DT = 1e-3
PD = {"kind": "pd", "kp": 40.0, "kd": 0.8}
DRY = {"law": "coulomb", "coulomb": 0.3, "viscous": 0.02}
COGGING = {"name": "cogging", "cosine": 0.04, "order": 6.0}


def machine(**parts):
    return plant(DRY, COGGING, controller=PD, **parts)


def recording(seconds=2.0, reference=True):
    time = np.arange(0.0, seconds, DT)
    wanted = 0.8 * (1.0 - np.cos(2.0 * np.pi * time / seconds))
    channels = {"reference": wanted} if reference else {}
    return st.Recording(time, np.zeros_like(time), wanted, **channels)


def test_a_feed_forward_is_friction_and_place_along_the_reference():
    own = machine(drive={"input": "current_a", "gain": 0.5})
    reference = np.concatenate([np.zeros(3), 0.2 * DT * np.arange(4), np.full(3, 0.6 * DT)])
    found = feed_forward(own, reference, DT)
    speeds = np.append(np.diff(reference), 0.0) / DT
    by_hand = np.sign(speeds) * 0.3 + 0.02 * speeds - 0.04 * np.cos(6.0 * reference)
    assert found == pytest.approx(by_hand / 0.5, rel=1e-6)


UNBALANCE = {"name": "gravity_unbalance", "cosine": 0.05}
BIAS = {"name": "torque_bias", "bias": 0.03}
HANGING = {"body": {"inertia": 0.01, "gravity_amplitude": 0.2}}


@pytest.mark.parametrize("effects", [(), (COGGING,), (UNBALANCE,), (BIAS,), (COGGING, BIAS)])
def test_a_stepped_contact_bears_what_the_curves_bear_where_it_only_slides(effects):
    own = plant(DRY, *effects, **HANGING, drive={"input": "current_a", "gain": 0.5})
    reference = 0.4 + 0.5 * DT * np.arange(400)
    curves = feed_forward(own, reference, DT)
    stepped = feed_forward(own, reference, DT, stepped=True)
    # A step tells of the end of a sample, the curves of its start; the last sample rests.
    assert stepped[:-2] == pytest.approx(curves[1:-1], abs=1e-12)


def test_states_of_a_law_are_worth_something_where_the_reference_turns():
    yielding = {"law": "lugre", "coulomb": 0.3, "breakaway": 0.45, "viscous": 0.01}
    found = compensate(plant(yielding, controller=PD), recording(4.0))
    assert found.stepped < 0.9 * found.rms[found.shares.index(1.0)]
    assert f"stepped along the reference it is {found.stepped:.3g} rad" in found.message
    dry = compensate(plant(DRY, controller=PD), recording(4.0))
    assert dry.stepped == pytest.approx(dry.rms[dry.shares.index(1.0)], rel=0.05)


# A rigid contact holds what does not move, so that it takes more to keep it going.
@pytest.mark.parametrize(
    ("friction", "margin"),
    [
        ({"law": "lugre", "coulomb": 0.3, "breakaway": 0.3, "viscous": 0.02}, 1.25),
        ({"law": "maxwell_slip", "coulomb": 0.3}, 1.25),
        (DRY, 2.0),
    ],
    ids=["lugre", "maxwell_slip", "rigid"],
)
def test_more_friction_than_there_is_makes_a_limit_cycle(friction, margin):
    found = compensate(plant(friction, controller=PD), recording())
    # What bears no more than the contact has feeds in no more energy than that takes.
    assert found.observer_margin == margin
    assert all(found.cycles[found.shares.index(margin) :])
    assert f"{margin:g} times as much makes a limit cycle" in found.message
    assert found.observer_rms[found.shares.index(1.0)] < 0.3 * found.observer_rms[0]
    assert found.observer_rms[0] == pytest.approx(found.rms[0], rel=1e-12)


def test_an_observer_bears_what_the_contact_does():
    own = plant(DRY, COGGING, **HANGING, drive={"input": "current_a", "gain": 0.5})
    fed = observer(own, 0.5)
    # At rest the contact bears the cogging itself, and gravity is all that is left.
    assert fed(0.4, DT) == pytest.approx(0.2 * np.sin(0.4))
    moving = fed(0.4 + 2.0 * DT, DT)
    place = own.position_effort([0.4 + 2.0 * DT])[0]
    assert moving == pytest.approx(0.3 + 0.02 * 2.0 + place, rel=1e-9)


def test_a_loop_without_friction_to_bear_makes_no_limit_cycle():
    smooth = plant({"law": "coulomb", "coulomb": 0.0, "viscous": 0.02}, controller=PD)
    found = compensate(smooth, recording())
    assert found.observer_margin is None
    assert "without a limit cycle up to 2 times as much" in found.message


def test_the_loop_follows_best_with_what_is_known():
    found = compensate(machine(), recording())
    rms = found.rms
    assert rms[found.shares.index(1.0)] < 0.2 * rms[0]
    assert found.best == 1.0
    assert rms[found.shares.index(0.5)] == pytest.approx(0.5 * rms[0], rel=0.2)
    assert rms[-1] == pytest.approx(rms[0], rel=0.3)
    assert "falls" in found.message
    json.dumps(found.to_dict(), allow_nan=False)
    assert found.recordings[0].plot().axes


def test_what_is_added_is_within_the_limit_of_the_controller():
    own, record = machine(), recording()
    plain = closed_loop.replay(own, record)
    nothing = closed_loop.replay(own, record, ahead=lambda reference, dt: 0.0 * reference)
    assert np.array_equal(plain.simulated, nothing.simulated)
    limited = plant(DRY, controller={**PD, "limit": 0.5})
    run_of = closed_loop.replay(limited, record, ahead=lambda r, dt: np.full_like(r, 9.0))
    assert np.max(np.abs(run_of.input)) == 0.5


def test_a_friction_that_is_overestimated_is_told():
    # The machine has a third of the friction that the feed-forward believes.
    found = compensate(machine(), recording())
    third = found.shares.index(0.25)
    assert found.rms[third] < found.rms[0]
    hurt = st.Plant.from_dict(
        {**machine().to_dict(), "friction": {"law": "coulomb", "coulomb": 0.02}}
    )
    loop = closed_loop.replay(hurt, recording(), ahead=lambda r, dt: feed_forward(machine(), r, dt))
    without = closed_loop.replay(hurt, recording())
    assert np.std(loop.reference - loop.simulated) > np.std(without.reference - without.simulated)


def test_machines_within_the_intervals_say_how_far_it_may_be_off():
    own = machine()
    found = compensate(own, recording(), intervals={"coulomb": (0.3, 0.3)}, draws=2)
    # An interval of no width holds the plant itself.
    whole = found.shares.index(1.0)
    assert found.machines == pytest.approx(np.tile(found.rms[[0, whole]], (2, 1)), rel=1e-12)
    wide = compensate(own, recording(), intervals={"friction.coulomb": (0.02, 0.6)}, draws=12)
    without, compensated = wide.machines.T
    assert wide.rms[whole] < found.rms[0]
    assert np.max(compensated) > 3.0 * found.rms[whole]
    # What is in truth less than half of what the feed-forward bears is hurt, and counted.
    assert 0 < wide.hurt == np.sum(compensated > without) < 12
    assert f"hurt {wide.hurt} of them" in wide.message
    again = compensate(own, recording(), intervals={"coulomb": (0.02, 0.6)}, draws=12)
    assert np.array_equal(again.machines, wide.machines)
    json.dumps(wide.to_dict(), allow_nan=False)


def test_a_machine_that_runs_away_is_counted_as_that():
    errors, still = np.ones((len(SHARES), 1)), (False,) * len(SHARES)
    unit = Compensated("run", np.zeros(1), errors, "rad", np.ones(1), errors, still)
    rows = np.array([[1.0, 0.5], [1.0, np.nan], [np.nan, np.nan]])
    found = Compensation((unit,), machines=rows)
    assert found.hurt == 1
    assert (
        "1 to 1 rad rms (1 ran away) without, 0.5 to 0.5 rad rms (2 ran away) with" in found.message
    )


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"intervals": {"friction.breakaway": (0.3, 0.4)}}, "is not stated"),
        ({"intervals": {"friction.coulomb": (0.4, 0.3)}}, "ends before it begins"),
        ({"intervals": {"body.inertia": (-2.0, -1.0)}}, "within them make"),
        ({"intervals": "nowhere.json"}, "findings.json or fit.json"),
        ({"draws": 0}, "draws"),
        ({"seed": -1}, "seed"),
    ],
)
def test_intervals_that_are_none_are_refused(given, words):
    with pytest.raises(st.InputError, match=words):
        compensate(machine(), recording(0.2), **given)


@pytest.mark.parametrize(
    ("own", "records", "words"),
    [
        (plant(DRY), [recording()], "controller"),
        (machine(), [], "no recordings"),
        (machine(), [recording(reference=False)], "reference"),
        ("plant.toml", [recording()], "a Plant"),
    ],
)
def test_what_cannot_be_compensated_is_refused(own, records, words):
    with pytest.raises(st.InputError, match=words):
        compensate(own, records)


@pytest.fixture
def arguments(tmp_path):
    """Of the command, in a folder with plant and session."""
    machine().save(tmp_path / "plant.toml")
    record = recording()
    np.savez(
        tmp_path / "run.npz",
        time_s=record.time,
        torque_nm=record.input,
        position_rad=record.position,
        reference_rad=record.channels["reference"],
    )
    (tmp_path / "session.toml").write_text(
        'plant = "plant.toml"\n[columns]\nreference = { name = "reference_rad", unit = "rad" }\n'
        '[[recordings]]\nfile = "run.npz"\n'
    )
    given = ["compensate", str(tmp_path / "plant.toml")]
    return [*given, "--session", str(tmp_path / "session.toml"), "-o", str(tmp_path / "out")]


SERVO = {"kind": "servo", "proportional": 3.0, "supply_v": 12.0, "resistance_ohm": 3.7,
         "torque_constant": 2.0}  # fmt: skip


def test_a_servo_that_takes_goals_alone_is_refused_as_that(tmp_path, capsys, arguments):
    plant(DRY, drive=SERVO).save(tmp_path / "plant.toml")
    assert run(arguments) == 2
    assert "takes a goal and nothing beside it" in capsys.readouterr().err


def test_what_a_controller_lags_is_not_taken_for_friction():
    # It lags by the speed over kp, beside which friction over kp·kv is small.
    lagging = {"kind": "position_velocity", "kp": 8.0, "kv": 4.0}
    found = compensate(plant(DRY, controller=lagging), recording())
    assert found.best == SHARES[-1]
    assert "What is left is no friction" in found.message
    assert "What is left is no friction" not in compensate(machine(), recording()).message


def test_the_command_writes_numbers_and_figures(tmp_path, capsys, arguments):
    assert run(arguments) == 0
    said = capsys.readouterr().out
    assert "falls from" in said
    assert "no interval: there is no findings.json or fit.json" in said
    told = json.loads((tmp_path / "out" / "compensation.json").read_text())
    assert told["best"] == 1.0
    assert told["machines"]["drawn"] == 0
    assert (tmp_path / "out" / "run-tracking.svg").read_text().startswith("<?xml")


def fitted(low, high):
    return json.dumps({"parameters": {"friction.coulomb": {"ci95": [low, high]}}})


def test_the_command_takes_the_intervals_beside_the_plant(tmp_path, capsys, arguments):
    (tmp_path / "fit.json").write_text(fitted(0.25, 0.35))
    assert run(arguments) == 0
    said = capsys.readouterr().out
    assert "Over 20 machines within the 95 % intervals" in said
    assert "no interval" not in said
    told = json.loads((tmp_path / "out" / "compensation.json").read_text())
    assert told["machines"]["drawn"] == 20
    assert told["machines"]["hurt"] == 0
    assert len(told["machines"]["whole"]) == 20


@pytest.mark.parametrize(
    ("content", "words"),
    [(fitted(0.4, 0.5), "another plant in friction.coulomb"), ("{}", "no intervals can be read")],
)
def test_a_file_of_another_plant_beside_it_is_left(tmp_path, capsys, arguments, content, words):
    (tmp_path / "findings.json").write_text(content)
    assert run(arguments) == 0
    said = capsys.readouterr().out
    assert words in said
    assert "machines within" not in said


def test_intervals_that_were_named_must_be_some(tmp_path, capsys, arguments):
    (tmp_path / "other.json").write_text("{}")
    assert run([*arguments, "--intervals", str(tmp_path / "other.json")]) != 0
    assert "no intervals can be read" in capsys.readouterr().err
