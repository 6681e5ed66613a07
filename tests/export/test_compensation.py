"""A feed-forward of friction in a simulated loop: what it is worth, and when it hurts."""

import json

import numpy as np
import pytest

import stiction as st
from stiction import closed_loop
from stiction.cli import run
from stiction.compensation import compensate, feed_forward

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


def test_the_command_writes_numbers_and_figures(tmp_path, capsys):
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
    arguments = ["compensate", str(tmp_path / "plant.toml")]
    arguments += ["--session", str(tmp_path / "session.toml"), "-o", str(tmp_path / "out")]
    assert run(arguments) == 0
    assert "falls from" in capsys.readouterr().out
    told = json.loads((tmp_path / "out" / "compensation.json").read_text())
    assert told["best"] == 1.0
    assert (tmp_path / "out" / "run-tracking.svg").read_text().startswith("<?xml")
