"""Angles that begin anew, velocities alone, supplies, rated values, and what a JSON file states."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

from stiction.cli import run
from stiction.recording import Recording, Table
from stiction.recording.guess import guess
from stiction.recording.turns import unwrap

TIME = 0.01 * np.arange(1000)
ANGLE = 2.5 * TIME + np.sin(2.0 * TIME)
EFFORT = np.cos(2.0 * TIME)


@pytest.mark.parametrize("low", [-np.pi, 0.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_angle_that_begins_anew_goes_on(low: float, sign: float) -> None:
    wrapped = (sign * ANGLE - low) % (2.0 * np.pi) + low
    wrapped[500] = np.nan
    whole, number = unwrap(wrapped)
    assert number == int(np.sum(np.abs(np.diff(np.delete(wrapped, 500))) > 4.0))
    expected = sign * ANGLE + (wrapped[0] - sign * ANGLE[0])
    np.testing.assert_allclose(np.delete(whole, 500), np.delete(expected, 500), atol=1e-9)
    assert np.isnan(whole[500])


def test_readings_that_failed_and_motions_within_a_turn_stay_as_they_are() -> None:
    swing = 2.0 + 0.2 * np.sin(TIME)
    failed = swing.copy()
    failed[300] = -np.pi
    for values in (swing, failed, 3.0 * ANGLE, np.full(9, np.nan), np.zeros(2)):
        same, number = unwrap(values)
        assert number == 0
        np.testing.assert_array_equal(same, values)


@pytest.mark.parametrize(("unit", "turn"), [("rad", 2 * np.pi), ("deg", 360.0), ("count", 4096.0)])
def test_a_recording_says_that_its_angle_began_anew(tmp_path: Path, unit: str, turn: float) -> None:
    path = tmp_path / "run.npz"
    np.savez(path, t=TIME, q=(ANGLE / (2.0 * np.pi) * turn) % turn, u=EFFORT)
    columns = {"time": "t", "position": {"name": "q", "unit": unit}, "input": "u"}
    count = 2.0 * np.pi / 4096.0
    found = Recording.load(path, columns, motion="rotary", count_size=count)
    np.testing.assert_allclose(found.position, ANGLE, atol=1e-9)
    assert "begins anew after a turn" in found.notes[0]


def test_a_velocity_alone_is_integrated_and_said(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    rate = 2.5 + 2.0 * np.cos(2.0 * TIME)
    np.savetxt(path, np.column_stack([TIME, rate, EFFORT]), delimiter=",", header="t,omega,i",
               comments="")  # fmt: skip
    assert run(["init", str(path), "-o", str(tmp_path)]) == 0
    columns = tomllib.loads((tmp_path / "session.toml").read_text("utf-8"))["columns"]
    assert set(columns) == {"time", "velocity", "input"}
    found = Recording.load(path, columns)
    np.testing.assert_allclose(found.position, ANGLE, atol=1e-3)
    assert found.units["position"] == "rad"
    assert any("is the integral of column 'omega', from 0" in note for note in found.notes)


@pytest.mark.parametrize(
    "name", ["supply_voltage", "Vin [V]", "input_volts", "vbus_V", "battery_voltage"]
)
def test_a_supply_is_never_an_input(name: str) -> None:
    columns = {"t": TIME, "q": ANGLE, name: 12.0 + 9.0 * EFFORT}
    found = guess([Table(Path("run.npz"), columns)])
    assert found.drive is None
    why = {one.column: one.reason for one in found.columns}[name]
    assert "supply" in why


@pytest.mark.parametrize(
    "name", ["torque [% rated]", "torque [%]", "current_percent", "torque (‰)"]
)
def test_parts_of_a_rated_value_are_offered_and_not_taken(name: str) -> None:
    found = guess([Table(Path("run.npz"), {"t": TIME, "q": ANGLE, name: 100.0 * EFFORT})])
    assert found.drive is None
    one = next(one for one in found.columns if one.column == name)
    assert one.candidate == "input"
    assert "as scale the value over 100" in one.reason


def test_a_temperature_is_told_by_its_usual_value() -> None:
    warm = np.full(len(TIME), 34.0) + 0.1 * EFFORT
    warm[::200] = 150.0
    columns = {"t": TIME, "q": ANGLE, "i": EFFORT, "temp": warm}
    found = guess([Table(Path("run.npz"), columns)])
    assert "around 34" in found.by_role["temperature"].reason


def test_what_a_json_file_states_is_drafted_for_its_recording(tmp_path: Path) -> None:
    for k, mass in enumerate((0.5, 0.75)):
        rows = [{"t": t, "q": q, "tau": u} for t, q, u in zip(TIME, ANGLE + k, EFFORT, strict=True)]
        stated = {"mass": mass, "length": 0.1, "kp": 8, "motor": "xl330", "entries": rows}
        (tmp_path / f"run{k}.json").write_text(json.dumps(stated))
    out = tmp_path / "out"
    assert run(["init", str(tmp_path), "-o", str(out)]) == 0
    text = (out / "session.toml").read_text("utf-8")
    entries = tomllib.loads(text)["recordings"]
    assert [(e["payload_kg"], e["payload_m"]) for e in entries] == [(0.5, 0.1), (0.75, 0.1)]
    assert text.count("# The file says kp 8.0, motor xl330.") == 2
