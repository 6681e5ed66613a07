"""Files of other people's machines, read where the folder of them is present."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from stiction.errors import InputError
from stiction.recording import Recording, read_table


def test_emps_drive_voltage_and_ball_screw(shared_data: Path) -> None:
    recording = Recording.load(
        shared_data / "emps" / "DATA_EMPS.mat",
        {
            "time": "t",
            "input": {"name": "vir", "unit": "V"},
            "position": {"name": "qm", "unit": "m"},
            "reference": {"name": "qg", "unit": "m"},
        },
        drive="voltage_v",
    )
    assert len(recording) == 24_841
    assert recording.dt == pytest.approx(1e-3, rel=1e-4)
    assert recording.motion == "linear"
    assert recording.notes == ()
    assert recording.position is not None
    error = recording.channels["reference"] - recording.position
    assert np.abs(error).max() < 2e-3


def test_simple_pendulum_runs(shared_data: Path) -> None:
    paths = sorted((shared_data / "dfki_simple_pendulum").glob("*.csv"))
    assert len(paths) == 6
    names = ("time", "position", "velocity")
    for path in paths:
        recording = Recording.load(
            path,
            {name: name for name in names} | {"input": {"name": "torque", "unit": "Nm"}},
            motion="rotary",
        )
        assert recording.units["velocity"] == "rad/s"
        assert 0.003 <= recording.dt <= 0.0051
        assert recording.notes == ()


def test_magneto_rheological_damper_is_moved_and_its_force_measured(shared_data: Path) -> None:
    path = shared_data / "mr_damper" / "ensaio.A.1.mat"
    columns = {
        "time": "Tout",
        "position": {"name": "dist", "unit": "mm"},
        "effort": {"name": "forc", "unit": "N"},
    }
    recording = Recording.load(path, columns, drive="prescribed_motion")
    assert len(recording) == 1501
    assert recording.input is None
    assert recording.effort is not None
    assert np.abs(recording.effort).max() > 1000.0
    assert recording.position is not None
    assert np.abs(recording.position).max() < 0.05
    with pytest.raises(InputError, match=r"x_F.* 1501 x 3 matrix"):
        Recording.load(path, columns | {"position": "x_F"})


def test_rock_friction_with_units_in_the_header(shared_data: Path) -> None:
    path = shared_data / "rock_rsf" / "velstep4_BRAVA_expb819_basalt.txt"
    assert list(read_table(path).columns) == [
        "Time(s)",
        "Displ(microns)",
        "Friction",
        "Normal_stress(MPa)",
    ]
    recording = Recording.load(
        path,
        {
            "time": "Time(s)",
            "position": {"name": "Displ(microns)", "unit": "µm"},
            "friction_coefficient": "Friction",
            "normal_force": "Normal_stress(MPa)",
        },
    )
    assert len(recording) == 5849
    assert recording.duration == pytest.approx(118.33)
    assert recording.units["effort"] == "Pa"
    assert recording.effort is not None
    assert recording.effort[0] == pytest.approx(12.122e6, rel=1e-3)


def test_pick_and_place_row_vectors(shared_data: Path) -> None:
    recording = Recording.load(
        shared_data / "pick_and_place" / "headdata_first_10s.mat",
        {"time": "t", "input": {"name": "u", "unit": "V"}, "position": "y"},
        motion="linear",
    )
    assert len(recording) == 40_001
    assert recording.dt == pytest.approx(1.0 / 4000.0)
    assert recording.units["position"] == "m"


@pytest.mark.parametrize(("folder", "number"), [("xl330", 16), ("sts3215", 64)])
def test_servo_logs_in_json(shared_data: Path, folder: str, number: int) -> None:
    paths = sorted((shared_data / folder).glob("*.json"))
    assert len(paths) == number
    for path in paths[:: number // 4]:
        recording = Recording.load(
            path,
            {
                "time": "timestamp",
                "input": {"name": "input_volts", "unit": "V"},
                "position": "position",
                "reference": "goal_position",
                "temperature": "temp",
            },
            motion="rotary",
        )
        assert 5.0 < recording.duration < 7.0
        assert recording.notes == ()
