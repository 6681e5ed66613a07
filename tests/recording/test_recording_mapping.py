from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from stiction.errors import InputError
from stiction.recording import Recording

Array = npt.NDArray[np.float64]
RAMP = np.linspace(0.0, 1.0, 240)


@pytest.fixture
def archive(tmp_path: Path) -> Callable[..., Path]:
    """Writes columns, all of them the same ramp unless given, to a file."""

    def write(*names: str, **columns: Array) -> Path:
        arrays: dict[str, Any] = dict.fromkeys(names, RAMP) | columns
        np.savez(tmp_path / "run.npz", **arrays)
        return tmp_path / "run.npz"

    return write


Archive = Callable[..., Path]


def test_canonical_names_need_no_mapping(archive: Archive) -> None:
    recording = Recording.load(
        archive("time_s", "voltage_v", "position_m", "velocity_m_s", "load_n", "temperature_c")
    )
    assert dict(recording.units) == {
        "time": "s",
        "input": "V",
        "position": "m",
        "velocity": "m/s",
        "load": "N",
        "temperature": "degC",
    }
    assert recording.motion == "linear"


def test_named_columns_convert_scale_and_shift_in_that_order(archive: Archive) -> None:
    recording = Recording.load(
        archive("t", "i", "q"),
        {
            "time": {"name": "t", "unit": "ms"},
            "input": {"name": "i", "unit": "mA", "scale": 2, "offset": 0.5},
            "position": {"name": "q", "unit": "deg", "scale": -1},
        },
    )
    assert recording.duration == pytest.approx(1e-3)
    assert recording.input is not None
    assert recording.input[-1] == pytest.approx(0.502)
    assert recording.position is not None
    assert recording.position[-1] == -math.pi / 180.0
    assert recording.motion == "rotary"


def test_kelvin_become_degrees_celsius(archive: Archive) -> None:
    path = archive("time_s", "current_a", oil=np.full(240, 300.15))
    recording = Recording.load(path, {"temperature": {"name": "oil", "unit": "K"}})
    assert recording.channels["temperature"][0] == pytest.approx(27.0)


def test_a_plain_name_is_taken_as_si(archive: Archive) -> None:
    recording = Recording.load(
        archive("t", "i", "q"), {"time": "t", "input": "i", "position": "q"}, motion="rotary"
    )
    assert recording.position is not None
    assert recording.position[-1] == 1.0
    assert recording.units["position"] == "rad"
    assert recording.units["input"] == ""
    assert recording.notes == ()


def test_a_name_that_ends_in_another_unit_is_converted_and_told(archive: Archive) -> None:
    recording = Recording.load(
        archive("t_ms", "current_a", "shaft_deg"), {"time": "t_ms", "position": "shaft_deg"}
    )
    assert recording.duration == pytest.approx(1e-3)
    assert "position: column 'shaft_deg' was read in deg, by its ending" in recording.notes


def test_a_bare_si_ending_never_contradicts_the_motion(archive: Archive) -> None:
    path = archive("time_s", "current_a", "q_m")
    assert Recording.load(path, {"position": "q_m"}, motion="rotary").units["position"] == "rad"
    assert Recording.load(path, {"position": "q_m"}).motion == "linear"


def test_a_unit_in_the_header_is_used_and_an_unknown_one_refused(archive: Archive) -> None:
    path = archive("time_s", "current_a", "q [mm]", "q (microns)", "q[0]")
    recording = Recording.load(path, {"position": "q [mm]"})
    assert recording.position is not None
    assert recording.position[-1] == 1e-3
    with pytest.raises(InputError, match="header gives the unit 'microns', which is not known"):
        Recording.load(path, {"position": "q (microns)"})
    stated = Recording.load(path, {"position": {"name": "q (microns)", "unit": "µm"}})
    assert stated.position is not None
    assert stated.position[-1] == 1e-6
    assert Recording.load(path, {"position": "q[0]"}).units["position"] == ""


def test_counts_need_the_sensor(archive: Archive) -> None:
    path = archive("time_s", "current_a", encoder=np.arange(240.0))
    columns = {"position": {"name": "encoder", "unit": "count"}}
    with pytest.raises(InputError, match="size of a count is not given"):
        Recording.load(path, columns)
    recording = Recording.load(path, columns, count_size=1e-3, motion="linear")
    assert recording.position is not None
    assert recording.position[-1] == pytest.approx(0.239)
    assert recording.units["position"] == "m"


def test_the_drive_chooses_among_canonical_inputs(archive: Archive) -> None:
    path = archive("time_s", "current_a", "torque_nm", "position_rad")
    with pytest.raises(InputError, match=r"current_a, torque_nm could each be the input"):
        Recording.load(path)
    assert Recording.load(path, drive="torque_nm").units["input"] == "N·m"
    assert Recording.load(path, {"input": "current_a"}).units["input"] == "A"
    with pytest.raises(InputError, match=r"no column is known to be the input.*voltage_v"):
        Recording.load(path, drive="voltage_v")


def test_a_voltage_is_not_taken_for_a_current(archive: Archive) -> None:
    path = archive("time_s", "u", "position_rad")
    columns = {"input": {"name": "u", "unit": "V"}}
    with pytest.raises(InputError, match="unit V, which is no unit of input where current_a"):
        Recording.load(path, columns, drive="current_a")
    assert Recording.load(path, columns, drive="voltage_v").units["input"] == "V"


def test_prescribed_motion_has_an_effort_in_place_of_an_input(archive: Archive) -> None:
    path = archive("time_s", "force_n", "position_m")
    moved = Recording.load(path, drive="prescribed_motion")
    assert moved.input is None
    assert moved.effort is not None
    assert Recording.load(path, {"effort": "force_n"}).input is None
    assert Recording.load(path).effort is None
    with pytest.raises(InputError, match="prescribed motion has none; name the measured effort"):
        Recording.load(path, {"input": "force_n"}, drive="prescribed_motion")


def test_friction_coefficient_and_normal_force_make_an_effort(archive: Archive) -> None:
    path = archive(
        "time_s", "position_m", normal_force=np.full(240, 50.0), friction_coefficient=RAMP
    )
    recording = Recording.load(path)
    np.testing.assert_array_equal(recording.effort, 50.0 * RAMP)
    assert recording.units["effort"] == "N"
    assert any("friction coefficient" in note for note in recording.notes)


def test_a_unit_that_a_role_cannot_have_lists_those_it_can(archive: Archive) -> None:
    path = archive("time_s", "current_a", "position_rad")
    with pytest.raises(InputError, match=r"unit A, which is no unit of position.*rad, deg, rev"):
        Recording.load(path, {"position": "current_a", "input": "position_rad"})


def test_rotary_and_linear_do_not_mix(archive: Archive) -> None:
    path = archive("time_s", "current_a", "q", "position_m")
    columns = {"position": {"name": "q", "unit": "deg"}}
    with pytest.raises(InputError, match=r"in deg, and the motion is linear as stated.*in m, mm"):
        Recording.load(path, columns, motion="linear")
    with pytest.raises(InputError, match="the motion is rotary as stated"):
        Recording.load(path, motion="rotary")
    columns["velocity"] = {"name": "q", "unit": "mm/s"}
    with pytest.raises(InputError, match="is in mm/s, and the motion is rotary by its position"):
        Recording.load(path, columns)
    assert Recording.load(path).motion == "linear"


def test_canonical_columns_of_the_other_motion_are_left_out_and_told(archive: Archive) -> None:
    path = archive("time_s", "current_a", "position_rad", "position_m", "load_n")
    with pytest.raises(InputError, match="could each be the position"):
        Recording.load(path)
    recording = Recording.load(path, motion="rotary")
    assert set(recording.units) == {"time", "input", "position"}
    assert {"position_m", "load_n"} == {note.split("'")[1] for note in recording.notes}


@pytest.mark.parametrize(
    ("names", "columns", "message"),
    [
        (("k", "current_a"), {}, "no column is known to be the time; the columns here are k, "),
        (("time_s", "x"), {}, "no column is known to be the input"),
        (("time_s", "current_a"), {"position": "tme_s"}, r"no column 'tme_s'.*mean 'time_s'"),
        (("time_s", "f"), {"effort": "f"}, "no column is known to be the position"),
    ],
)
def test_missing_columns_are_named_with_what_is_there(
    archive: Archive, names: tuple[str, ...], columns: dict[str, Any], message: str
) -> None:
    path = archive(*names)
    with pytest.raises(InputError, match=message):
        Recording.load(path, columns)


@pytest.mark.parametrize("option", ["motion", "drive"])
def test_unknown_choices_are_refused(archive: Archive, option: str) -> None:
    path = archive("time_s", "current_a")
    with pytest.raises(InputError, match=f"{option} is 'sideways'; give one of"):
        Recording.load(path, **{option: "sideways"})  # type: ignore[arg-type]


def with_units(folder: Path, names: str, units: str) -> Path:
    rows = [f"{0.01 * k!r},{k!r},{k!r}" for k in range(240)]
    path = folder / "run.csv"
    path.write_text("\n".join([names, units, *rows, ""]), encoding="utf-8")
    return path


def test_a_line_of_units_is_taken_where_nothing_else_states_one(tmp_path: Path) -> None:
    path = with_units(tmp_path, "t,i,pos", "s,mA,deg")
    named = {"time": "t", "input": "i", "position": "pos"}
    recording = Recording.load(path, named)
    assert dict(recording.units) == {"time": "s", "input": "A", "position": "rad"}
    assert recording.position is not None
    assert recording.position[-1] == pytest.approx(math.radians(239.0))
    assert "position: column 'pos' is in deg, by the line of units" in recording.notes
    stated = Recording.load(path, {**named, "position": {"name": "pos", "unit": "rad"}})
    assert stated.position is not None
    assert stated.position[-1] == 239.0
    assert not any("position" in note for note in stated.notes)


@pytest.mark.parametrize(
    ("names", "units", "told"),
    [
        (
            "time_s,current_a,position_rad",
            "s,A,deg",
            "says rad, and the line of units below it deg",
        ),
        ("time_s,current_a,q [rad]", "s,A,deg", "says rad, and the line of units below it deg"),
        (
            "time_s,current_a,q",
            "s,A,[grad]",
            "the header gives the unit 'grad', which is not known",
        ),
    ],
)
def test_a_line_of_units_that_says_something_else_is_refused(
    names: str, units: str, told: str, tmp_path: Path
) -> None:
    path = with_units(tmp_path, names, units)
    columns = {} if "position_rad" in names else {"position": names.rsplit(",", 1)[1]}
    with pytest.raises(InputError, match=told):
        Recording.load(path, columns)


def test_a_line_of_units_may_say_the_same_in_other_letters(tmp_path: Path) -> None:
    path = with_units(tmp_path, "time_s,torque_nm,position_rad", "s,N·m,[rad]")
    assert Recording.load(path).notes == ()


def test_a_clock_is_known_by_its_name_and_by_how_it_goes(archive: Archive) -> None:
    clock = 1e-3 * np.arange(len(RAMP))
    for name, factor in (("time", 1.0), ("t", 1.0), ("time [ms]", 1e3)):
        recording = Recording.load(archive("current_a", "position_rad", **{name: factor * clock}))
        np.testing.assert_allclose(recording.time, clock, atol=1e-12)
        assert any(f"'{name}' was taken by its name" in note for note in recording.notes)
    columns = {"input": {"name": "u", "unit": "A"}, "position": {"name": "q", "unit": "rad"}}
    path = archive("u", "q", time=clock)
    assert len(Recording.load(path, columns).time) == len(clock)
    # What does not rise is no clock, and of two nobody knows which.
    for columns in ({"time": clock[::-1].copy()}, {"time": clock, "t": clock}):
        with pytest.raises(InputError, match="no column is known to be the time"):
            Recording.load(archive("current_a", "position_rad", **columns))
