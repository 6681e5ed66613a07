from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stiction.errors import InputError
from stiction.recording import Recording
from stiction.recording.repair import BAD_SHARE, FEWEST_ROWS, ISOLATED_ROWS

Array = npt.NDArray[np.float64]

ROWS = 400
TIME: Array = np.arange(ROWS, dtype=np.float64) * 0.01
# Interpolating between stamps that are themselves rounded.
STAMPS = 1e-12


def recorded(time: Array = TIME, input: Array = TIME) -> Recording:
    return Recording(time, input, TIME)


def test_a_clean_recording_needs_no_repair() -> None:
    recording = recorded()
    assert recording.quality == ()
    assert recording.notes == ()
    np.testing.assert_array_equal(recording.time, TIME)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_few_bad_cells_are_interpolated_and_told(bad: float) -> None:
    current = TIME.copy()
    current[[7, 8, 50]] = bad
    recording = recorded(input=current)
    assert recording.input is not None
    np.testing.assert_allclose(recording.input, TIME, atol=STAMPS)
    (repair,) = recording.quality
    assert (repair.channel, repair.what) == ("input", "interpolated")
    assert (repair.count, repair.first_row) == (3, 7)
    assert str(repair) in recording.notes


def test_bad_cells_at_the_ends_take_the_value_beside_them() -> None:
    current = TIME.copy()
    current[[0, -1]] = np.nan
    recorded_input = recorded(input=current).input
    assert recorded_input is not None
    assert (recorded_input[0], recorded_input[-1]) == (TIME[1], TIME[-2])


def test_repairs_stay_under_five_per_cent() -> None:
    limit = int(BAD_SHARE * ROWS)
    for number, fits in ((limit - 1, True), (limit, False)):
        current = TIME.copy()
        current[5 : 5 + 2 * number : 2] = np.nan
        if fits:
            assert recorded(input=current).quality[0].count == number
        else:
            with pytest.raises(InputError, match="input has 20 missing or infinite cells in 400"):
                recorded(input=current)


@pytest.mark.parametrize(
    ("row", "stamp"),
    [(9, TIME[8]), (9, TIME[3]), (9, -5.0), (9, np.nan), (9, 1e6), (0, TIME[1]), (399, 0.0)],
)
def test_one_bad_stamp_is_spaced_anew_and_told(row: int, stamp: float) -> None:
    time = TIME.copy()
    time[row] = stamp
    recording = recorded(time=time)
    np.testing.assert_allclose(recording.time, TIME, atol=0.01 + STAMPS if row == 0 else STAMPS)
    (repair,) = recording.quality
    assert (repair.channel, repair.what, repair.count) == ("time", "respaced", 1)
    assert repair.first_row in (row, row + 1)


def test_cells_are_interpolated_over_the_mended_clock() -> None:
    time, current = TIME.copy(), TIME.copy()
    time[100], current[100] = time[99], np.nan
    mended = recorded(time, current).input
    assert mended is not None
    np.testing.assert_allclose(mended, TIME, atol=STAMPS)


def test_a_gap_in_time_is_no_fault() -> None:
    time = np.where(np.arange(ROWS) < 200, TIME, TIME + 30.0)
    assert recorded(time=time).quality == ()


@pytest.mark.parametrize(
    ("time", "message"),
    [
        (TIME[::-1], r"time decreases over the file \(from 3\.99 s to 0 s\)"),
        (np.concatenate((TIME[:200], TIME[:200])), "time decreases at index 200 .*split the file"),
        (np.concatenate((TIME[:390], TIME[:10])), "time decreases at index 390"),
        (np.floor(TIME * 20.0) / 20.0, "stamps repeat the one before, the first at index 1"),
        (np.zeros(ROWS), "399 of 400 time stamps repeat"),
        (np.where(np.arange(ROWS) % 10, TIME, np.nan), "40 time stamps are missing"),
        (np.full(ROWS, np.nan), "400 time stamps are missing"),
    ],
)
def test_a_clock_that_cannot_be_mended_is_refused(time: Array, message: str) -> None:
    with pytest.raises(InputError, match=message):
        recorded(time=time)


def test_a_run_of_bad_stamps_is_no_slip() -> None:
    for length, fits in ((ISOLATED_ROWS, True), (ISOLATED_ROWS + 1, False)):
        time = TIME.copy()
        time[50 : 50 + length] = time[49]
        if fits:
            assert recorded(time=time).quality[0].count == length
        else:
            with pytest.raises(InputError, match="stamps repeat"):
                recorded(time=time)


def test_stamps_too_close_to_be_spaced_are_refused() -> None:
    time: Array = 1e17 + 16.0 * np.arange(ROWS, dtype=np.float64)
    time[7] = time[6]
    time[8:] -= 16.0
    with pytest.raises(InputError, match="too close together"):
        recorded(time=time)


def test_two_hundred_rows_are_enough_and_fewer_are_not() -> None:
    few = TIME[: FEWEST_ROWS - 1]
    with pytest.raises(InputError, match="has 199 rows, and at least 200 are needed"):
        Recording(few, few, few)
    assert len(Recording(TIME[:FEWEST_ROWS], TIME[:FEWEST_ROWS], None)) == FEWEST_ROWS


def test_a_faulty_recording_can_be_kept_with_its_fault(
    written: Callable[..., Path], lines: list[str]
) -> None:
    for line in range(10, 60):
        time, current, _ = lines[line].split(",")
        lines[line] = f"{time},{current},"
    path = written(lines)
    with pytest.raises(InputError, match="position has 50 missing or infinite cells in 240"):
        Recording.load(path)
    kept = Recording.load(path, keep_faulty=True)
    assert "first at line 11" in kept.faults[0]
    assert kept.position is not None
    assert np.isfinite(kept.position).all()


@given(st.sets(st.integers(0, ROWS // 8 - 1), max_size=19), st.floats(-1e3, 1e3))
def test_isolated_bad_stamps_never_leave_a_clock_that_steps_back(
    slots: set[int], stamp: float
) -> None:
    time = TIME.copy()
    time[[8 * slot + 3 for slot in slots]] = stamp
    mended = recorded(time=time).time
    assert np.all(np.diff(mended) > 0.0)
    untouched = np.ones(ROWS, dtype=bool)
    untouched[[8 * slot + 3 for slot in slots]] = False
    np.testing.assert_array_equal(mended[untouched], TIME[untouched])
