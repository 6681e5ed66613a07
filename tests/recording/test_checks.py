"""What the data checks find, and what they leave alone."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from stiction.recording import Check, Recording, check
from stiction.recording.checks import noise_levels, without_spikes

Array = npt.NDArray[np.float64]
ROWS = 8000
COUNT = 2.0 * np.pi / 2**16


def machine(seed: int = 0) -> dict[str, Array]:
    """A shaft at 1 kHz: 2 s at rest, 2 s at constant speed, 4 s of sine, a little noise."""
    time = np.arange(ROWS) / 1000.0
    moving = np.clip(time - 2.0, 0.0, 2.0) + np.where(time > 4.0, np.sin(3.0 * (time - 4.0)), 0.0)
    noise = np.random.default_rng(seed).normal(size=(2, ROWS))
    position = COUNT * np.round((moving + 1e-4 * noise[0]) / COUNT)
    drive = np.where(time > 4.0, np.cos(3.0 * (time - 4.0)), np.where(time > 2.0, 1.0, 0.2))
    return {"time": time, "input": drive + 0.01 * noise[1], "position": position}


def found(channels: dict[str, Any], name: str) -> list[Check]:
    return [one for one in check(Recording(**channels)) if one.name == name]


def verdict(channels: dict[str, Any], name: str) -> str:
    order = ("fine", "note", "fault")
    return max((one.verdict for one in found(channels, name)), key=order.index)


def test_nothing_is_found_in_a_good_recording() -> None:
    assert {one.verdict for one in check(Recording(**machine()))} == {"fine"}


def test_every_check_is_there_once_or_more_and_goes_into_json() -> None:
    checks = check(Recording(**machine()))
    assert [one.name for one in checks] == [
        "missing cells",
        "clock jitter",
        "gaps",
        "sampling rate",
        "sampling speed",
        "constant channel",
        "spikes",
        "repeated readings",
        "stuck channel",
        "clipping",
        "input saturation",
        "input refresh",
        "noise at standstill",
        "noise at constant speed",
    ]
    entries = json.loads(json.dumps([one.to_dict() for one in checks]))
    assert list(entries[0]) == ["name", "verdict", "what", "means", "try"]


def test_a_stress_is_noted_because_others_measure_a_force(tmp_path: Path) -> None:
    data = machine()
    rows = zip(data["time"], data["position"], strict=True)
    lines = [f"{t},{x},{0.6 + 0.01 * (k % 7)},20" for k, (t, x) in enumerate(rows)]
    (tmp_path / "rock.csv").write_text("\n".join(["time_s,x,mu,stress", *lines]))
    columns = {
        "position": {"name": "x", "unit": "m"},
        "friction_coefficient": "mu",
        "normal_force": {"name": "stress", "unit": "MPa"},
    }
    moved = Recording.load(tmp_path / "rock.csv", columns)
    (one,) = [each for each in check(moved) if each.name == "unit of the effort"]
    assert one.verdict == "note"
    assert "in Pa" in one.means
    assert not found(data, "unit of the effort")


def test_what_is_not_fine_says_what_it_means_and_what_to_try() -> None:
    data = machine()
    data["position"][100] = -3.14
    (one,) = found(data, "spikes")
    assert one.means
    assert one.try_
    assert str(one).startswith("spikes (note): position leaves its neighbours")
    assert "It means: " in str(one)
    assert "Try: " in str(one)


def test_an_uneven_clock_is_noted() -> None:
    data = machine()
    data["time"] += 2e-5 * np.random.default_rng(1).normal(size=ROWS)
    assert verdict(data, "clock jitter") == "note"
    assert verdict(data, "gaps") == "fine"


def test_a_single_late_stamp_is_noted() -> None:
    data = machine()
    data["time"][500] += 2e-4
    assert "worst is off by 20 %" in found(data, "clock jitter")[0].what


@pytest.mark.parametrize(("lost", "expected"), [(1, "note"), (300, "note"), (500, "fault")])
def test_lost_samples_are_a_gap_and_a_fault_beyond_five_percent(lost: int, expected: str) -> None:
    data = {name: np.delete(values, slice(5000, 5000 + lost)) for name, values in machine().items()}
    assert verdict(data, "gaps") == expected
    assert verdict(data, "clock jitter") == "fine"


def test_a_gap_behind_the_first_row_is_one_gap_and_no_change_of_rate() -> None:
    data = machine()
    data["time"][1:] += 0.004
    assert "1 gap of together 0.004 s" in found(data, "gaps")[0].what
    assert verdict(data, "sampling rate") == "fine"


def test_a_change_of_the_sampling_rate_is_noted_and_is_no_jitter() -> None:
    data = machine()
    data["time"] = np.cumsum(np.where(np.arange(ROWS) < 3000, 0.001, 0.01))
    assert verdict(data, "sampling rate") == "note"
    assert verdict(data, "clock jitter") == "fine"


def test_sampling_too_slow_for_the_kernel_is_noted() -> None:
    data = {name: values[::10] for name, values in machine().items()}
    assert "last 80 ms" in found(data, "sampling speed")[0].what
    assert verdict(data, "sampling speed") == "note"
    assert found(data, "sampling speed")[0].try_ == "sample every 6.2 ms or faster"


def test_a_clock_that_seems_to_count_milliseconds_is_asked_for_its_unit() -> None:
    data = machine()
    data["time"] = 1000.0 * data["time"]
    assert found(data, "sampling speed")[0].try_.startswith("state the unit of the time")


@pytest.mark.parametrize(
    ("channel", "value", "expected"),
    [("position", 1.0, "fault"), ("input", 0.4, "fault"), ("input", 0.0, "note")],
)
def test_a_constant_channel_is_a_fault_unless_the_machine_coasts(
    channel: str, value: float, expected: str
) -> None:
    data = machine()
    data[channel] = np.full(ROWS, value)
    assert verdict(data, "constant channel") == expected


@pytest.mark.parametrize(("on", "expected"), [(1.0, "fine"), (0.0, "note")])
def test_a_drive_that_is_on_throughout_is_the_ordinary_case(on: float, expected: str) -> None:
    data = machine() | {"enabled": np.full(ROWS, on)}
    assert verdict(data, "constant channel") == expected


def test_an_optional_channel_that_is_constant_is_noted() -> None:
    data = machine() | {"temperature": np.full(ROWS, 20.0)}
    assert verdict(data, "constant channel") == "note"


def test_spikes_are_found_where_they_are_and_can_be_taken_out() -> None:
    data = machine()
    clean = data["position"].copy()
    data["position"][[10, 4444, 6000]] = -3.14
    assert "3 times, first at 0.01 s to -3.14" in found(data, "spikes")[0].what
    np.testing.assert_allclose(without_spikes(data["position"]), clean, atol=5e-3)


def test_many_spikes_are_a_fault() -> None:
    data = machine()
    data["position"][5::18] = 30.0
    assert verdict(data, "spikes") == "fault"


@pytest.mark.parametrize("seed", range(5))
def test_white_noise_has_no_spikes(seed: int) -> None:
    data = machine()
    data["position"] = np.random.default_rng(seed).normal(size=ROWS)
    assert verdict(data, "spikes") == "fine"


def test_readings_that_repeat_in_motion_are_noted() -> None:
    data = machine()
    smooth = np.sin(20.0 * data["time"])
    data["position"] = np.repeat(smooth[::2], 2)
    assert verdict(data, "repeated readings") == "note"
    data["position"] = smooth
    assert verdict(data, "repeated readings") == "fine"


def test_a_sensor_that_freezes_and_jumps_is_stuck() -> None:
    data = machine()
    data["position"][4500:5000] = data["position"][4499]
    assert verdict(data, "stuck channel") == "fault"
    data = machine()
    data["position"][4500:4600] = data["position"][4499]
    assert verdict(data, "stuck channel") == "note"


@pytest.mark.parametrize("flickers", [[700], [700, 1400], [0], [1999]])
def test_a_machine_that_rests_but_for_single_readings_is_looked_at(flickers: list[int]) -> None:
    # Without its spikes such a record has no step at all.
    source = np.random.default_rng(3)
    position = np.zeros(2000)
    position[flickers] = 1e-3
    effort = 0.01 * source.standard_normal(2000)
    resting = Recording(np.arange(2000) * 1e-3, input=effort, position=position)
    assert [c.name for c in check(resting) if c.verdict == "fault"] == []


def test_a_sensor_that_freezes_under_efforts_that_move_the_machine_is_stuck() -> None:
    data = machine()
    swings = np.sin(9.0 * data["time"])
    data["position"] = swings + 1e-6 * np.random.default_rng(0).standard_normal(len(swings))
    data["input"] = -swings
    assert verdict(data, "stuck channel") == "fine"
    # Back where it froze there is no jump by which to tell.
    turn = round(4.0 * np.pi / 9.0 / np.median(np.diff(data["time"])))
    frozen = {**data, "position": data["position"].copy()}
    frozen["position"][1000 : 1000 + turn] = frozen["position"][1000]
    frozen["position"][1000 + turn :] += data["position"][1000] - data["position"][1000 + turn]
    assert verdict(frozen, "stuck channel") == "fault"
    # A goal is no effort, whether its unit or a servo's gain says so.
    assert verdict({**frozen, "settings": {"proportional": 4.0}}, "stuck channel") == "fine"
    # Steady efforts hold a machine, and so do those under which it rests elsewhere, too.
    held = {**frozen, "input": frozen["input"].copy()}
    held["input"][1000 : 1000 + turn] = 0.9
    assert verdict(held, "stuck channel") == "fine"
    sticks = {**frozen, "position": frozen["position"].copy()}
    sticks["position"][3000 : 3000 + turn // 2] = sticks["position"][3000]
    assert verdict(sticks, "stuck channel") == "fine"
    # One that sticks while the effort turns round once leaves then.
    turns = {**data, "position": data["position"].copy()}
    left = 1000 + turn // 6
    turns["position"][left:] += data["position"][1000] - data["position"][left]
    turns["position"][1000:left] = turns["position"][1000]
    assert verdict(turns, "stuck channel") == "fine"


def test_a_sensor_that_freezes_from_full_speed_to_the_end_is_stuck() -> None:
    data = machine()
    data["position"] = np.sin(3.0 * data["time"])
    data["position"][6300:] = data["position"][6299]
    assert verdict(data, "stuck channel") == "fault"


def test_a_machine_that_sticks_and_slips_is_not_stuck() -> None:
    data = machine()
    phase = data["time"] % 0.5
    slips = np.floor(data["time"] / 0.5) + np.clip((phase - 0.4) / 0.1, 0.0, 1.0) ** 2
    data["position"] = COUNT * np.round(slips / COUNT)
    assert verdict(data, "stuck channel") == "fine"
    assert verdict(data, "clipping") == "fine"


@pytest.mark.parametrize(("limit", "expected"), [(0.9, "fault"), (2.0, "fine")])
def test_a_position_cut_off_at_its_extremes_is_clipped(limit: float, expected: str) -> None:
    data = machine()
    data["position"] = np.clip(COUNT * np.round(np.sin(7.0 * data["time"]) / COUNT), -limit, limit)
    assert verdict(data, "clipping") == expected


@pytest.mark.parametrize(("limit", "expected"), [(1.0, "note"), (3.0, "fine")])
def test_an_effort_cut_off_in_few_rows_is_noted(limit: float, expected: str) -> None:
    data = machine()
    size = np.where(data["time"] < 0.5, 2.0, 0.5)
    effort = np.clip(size * np.sin(40.0 * data["time"]), -limit, limit)
    assert verdict(data | {"input": None, "effort": effort}, "clipping") == expected


@pytest.mark.parametrize(("limit", "expected"), [(0.9, "note"), (0.3, "fault"), (2.0, "fine")])
def test_an_input_at_its_limits_is_noted_and_a_fault_beyond_half(
    limit: float, expected: str
) -> None:
    data = machine()
    data["input"] = np.clip(data["input"], -limit, limit)
    assert verdict(data, "input saturation") == expected


def test_an_input_of_steps_is_at_its_limits_by_intent() -> None:
    data = machine()
    data["input"] = np.sign(np.sin(5.0 * data["time"]))
    assert verdict(data, "input saturation") == "fine"
    assert verdict(data, "input refresh") == "note"


def test_an_input_that_goes_one_way_rests_at_0_by_intent() -> None:
    data = machine()
    data["input"] = np.minimum(data["input"], 0.0)
    assert verdict(data, "input saturation") == "fine"
    data["input"] = np.maximum(data["input"], -0.3)
    (told,) = found(data, "input saturation")
    assert told.verdict == "note"
    assert "at its limit -0.3 in 21 %" in told.what


def test_cells_that_were_filled_are_noted() -> None:
    data = machine()
    data["position"][7] = np.nan
    assert verdict(data, "missing cells") == "note"


def test_noise_is_measured_at_standstill_and_at_constant_speed() -> None:
    levels = noise_levels(Recording(**machine()))
    for kind in ("standstill", "constant speed"):
        assert levels[kind].seconds == pytest.approx(2.0)
        assert levels[kind].noise["position"] == pytest.approx(1e-4, rel=0.1)
    assert levels["standstill"].noise["input"] == pytest.approx(0.01, rel=0.2)


def test_noise_says_where_there_is_no_stretch_to_measure_it_on() -> None:
    data = machine()
    data["position"] = np.sin(9.0 * data["time"])
    (one,) = found(data, "noise at standstill")
    assert one.verdict == "note"
    assert "there is no stretch of 0.5 s at standstill" in one.what


def test_a_quick_oscillation_is_no_constant_speed() -> None:
    data = machine()
    data["position"] = np.sin(2.0 * np.pi * data["time"] / 0.37) + 2.0 * data["time"]
    assert "constant speed" not in noise_levels(Recording(**data))


def test_a_recording_of_the_input_alone_can_be_checked() -> None:
    data = machine()
    checks = check(Recording(data["time"], data["input"], None))
    assert {one.verdict for one in checks} == {"fine"}


def test_a_channel_without_any_value_is_a_fault_and_breaks_no_other_check(
    tmp_path: Path,
) -> None:
    path = tmp_path / "run.npz"
    data = machine()
    np.savez(path, time=data["time"], input=data["input"], position=np.full(ROWS, np.nan))
    names = {name: name for name in data}
    checks = check(Recording.load(path, names, keep_faulty=True))
    assert [one.name for one in checks if one.verdict == "fault"] == ["missing cells"]
