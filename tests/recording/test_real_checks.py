"""The data checks on other people's recordings: their known traps are found, and no fault is."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from stiction.recording import Check, Recording, check

_SERVO: dict[str, Any] = {
    "time": "timestamp",
    "input": {"name": "input_volts", "unit": "V"},
    "position": "position",
    "velocity": "speed",
}
_MACHINES: dict[str, tuple[str, dict[str, Any], dict[str, Any]]] = {
    "emps": (
        "*.mat",
        {"time": "t", "input": {"name": "vir", "unit": "V"}, "position": "qm"},
        {"motion": "linear"},
    ),
    "dfki_simple_pendulum": (
        "*.csv",
        {"time": "time", "position": "position", "velocity": "velocity"}
        | {"input": {"name": "torque", "unit": "Nm"}},
        {"motion": "rotary"},
    ),
    "mr_damper": (
        "*.mat",
        {"time": "Tout", "position": {"name": "dist", "unit": "mm"}}
        | {"effort": {"name": "forc", "unit": "N"}},
        {"drive": "prescribed_motion"},
    ),
    "rock_rsf": (
        "*.txt",
        {"time": "Time(s)", "position": {"name": "Displ(microns)", "unit": "µm"}}
        | {"friction_coefficient": "Friction", "normal_force": "Normal_stress(MPa)"},
        {},
    ),
    "pick_and_place": (
        "*.mat",
        {"time": "t", "input": {"name": "u", "unit": "V"}, "position": "y"},
        {"motion": "linear"},
    ),
    "xl330": ("*.json", _SERVO, {"motion": "rotary"}),
    "sts3215": ("*.json", _SERVO, {"motion": "rotary"}),
}


def recordings(folder: Path) -> Iterator[Recording]:
    pattern, columns, options = _MACHINES[folder.name]
    paths = sorted(folder.glob(pattern))
    assert paths
    for path in paths:
        yield Recording.load(path, columns, **options)


def noted(recording: Recording) -> dict[str, Check]:
    return {one.name: one for one in check(recording) if one.verdict != "fine"}


@pytest.mark.parametrize("name", _MACHINES)
def test_no_real_recording_is_called_faulty(shared_data: Path, name: str) -> None:
    for recording in recordings(shared_data / name):
        assert [one for one in check(recording) if one.verdict == "fault"] == []


def test_the_ball_screw_is_fine_but_never_stands_still(shared_data: Path) -> None:
    (recording,) = recordings(shared_data / "emps")
    assert list(noted(recording)) == ["noise at standstill"]


def test_every_spike_of_the_servo_is_found_and_no_other(shared_data: Path) -> None:
    spikes = 0
    for recording in recordings(shared_data / "sts3215"):
        assert recording.position is not None
        number = int((recording.position < -3.0).sum())
        said = noted(recording).get("spikes")
        assert (said is not None) == (number > 0)
        spikes += number
    assert spikes == 10


def test_the_servo_that_reads_its_supply_once_a_second_is_noted(shared_data: Path) -> None:
    for recording in recordings(shared_data / "sts3215"):
        assert "input refresh" in noted(recording)


def test_the_uneven_clock_of_the_pendulum_is_noted(shared_data: Path) -> None:
    names = {
        recording.path.stem: {"clock jitter", "gaps"} & set(noted(recording))
        for recording in recordings(shared_data / "dfki_simple_pendulum")
        if recording.path is not None
    }
    assert names["sac"] == {"clock jitter", "gaps"}
    assert names["pd_system_identification"] == {"clock jitter"}
    assert names["torque_limited_swingup"] == {"gaps"}
    assert names["energy_shaping"] == set()


def test_the_stress_of_the_rock_is_no_force(shared_data: Path) -> None:
    (recording,) = recordings(shared_data / "rock_rsf")
    assert "in Pa" in noted(recording)["unit of the effort"].what


def test_the_two_rates_of_the_rock_are_noted_and_are_no_gaps(shared_data: Path) -> None:
    (recording,) = recordings(shared_data / "rock_rsf")
    said = noted(recording)
    assert "between 0.01 s and 0.1 s" in said["sampling rate"].what
    assert "gaps" not in said


def test_a_head_that_sticks_is_no_stuck_channel(shared_data: Path) -> None:
    (recording,) = recordings(shared_data / "pick_and_place")
    assert not {"stuck channel", "clipping", "repeated readings"} & set(noted(recording))
