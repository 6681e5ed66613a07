from __future__ import annotations

import copy
import dataclasses
import pickle
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stiction.errors import InputError
from stiction.recording import Recording

ROWS = 240
TIME = np.arange(ROWS) * 0.01
WAVE = np.sin(TIME)


def test_a_recording_holds_what_it_was_given() -> None:
    recording = Recording(
        TIME, WAVE, 2.0 * WAVE, role="test", kind="slow", start_s=60.0, velocity=3.0 * WAVE
    )
    assert (recording.role, recording.kind, recording.start_s) == ("test", "slow", 60.0)
    assert len(recording) == ROWS
    assert recording.dt == pytest.approx(0.01)
    assert recording.duration == pytest.approx(2.39)
    np.testing.assert_array_equal(recording.input, WAVE)
    np.testing.assert_array_equal(recording.position, 2.0 * WAVE)
    np.testing.assert_array_equal(recording.channels["velocity"], 3.0 * WAVE)
    assert recording.path is None


def test_channels_can_be_handed_on_to_another_recording() -> None:
    first = Recording(TIME, None, WAVE, effort=WAVE, temperature=WAVE)
    channels: dict[str, Any] = dict(first.channels)
    second = Recording(first.time, first.input, first.position, **channels)
    assert set(second.channels) == {"effort", "temperature"}


def test_a_recording_cannot_be_changed() -> None:
    recording = Recording(TIME, WAVE, WAVE, velocity=WAVE)
    with pytest.raises(dataclasses.FrozenInstanceError):
        recording.kind = "fast"  # type: ignore[misc]
    with pytest.raises(ValueError, match="read-only"):
        recording.time[0] = 1.0
    with pytest.raises(TypeError):
        recording.channels["velocity"] = WAVE  # type: ignore[index]


def test_a_recording_does_not_follow_the_array_it_was_made_from() -> None:
    wave = WAVE.copy()
    recording = Recording(TIME, wave, wave)
    wave[:] = 9.0
    np.testing.assert_array_equal(recording.input, WAVE)
    assert wave.flags.writeable


@pytest.mark.parametrize("again", [copy.deepcopy, lambda item: pickle.loads(pickle.dumps(item))])
def test_a_copy_is_as_frozen_as_the_recording(again: Callable[[Recording], Recording]) -> None:
    recording = again(Recording(TIME, WAVE, None, kind="slow", load=WAVE))
    assert recording.kind == "slow"
    assert recording.position is None
    assert not recording.time.flags.writeable
    assert not recording.channels["load"].flags.writeable


def test_lists_and_integers_are_welcome() -> None:
    recording = Recording(list(range(ROWS)), np.ones(ROWS, dtype=np.int8), None)
    assert recording.time.dtype == np.float64


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"input": WAVE[1:]}, "input has 239 rows, and time has 240"),
        ({"position": WAVE[:, np.newaxis]}, r"position has the shape \(240, 1\); give a flat"),
        ({"input": ["a"] * ROWS}, "input cannot be read as real numbers"),
        ({"input": WAVE * 1j}, "input cannot be read as real numbers"),
        ({"time": None}, "time cannot be read"),
        ({"input": None}, "neither input nor effort is given"),
        ({"effort": WAVE}, "both input and effort"),
        ({"input": None, "position": None, "effort": WAVE}, "without the motion it belongs to"),
        ({"temperture": WAVE}, r"no channel 'temperture' \(did you mean 'temperature'\?\)"),
        ({"role": "tran"}, r"role is 'tran' \(did you mean 'train'\?\)"),
        ({"kind": 3}, "kind is 3; give text"),
        ({"start_s": float("nan")}, "start_s is nan; give a finite number of seconds"),
        ({"start_s": "now"}, "start_s is 'now'"),
        ({"cold": "yes"}, "cold is 'yes'; give True or False"),
    ],
)
def test_what_cannot_be_a_recording_is_refused(change: dict[str, Any], message: str) -> None:
    given: dict[str, Any] = {"time": TIME, "input": WAVE, "position": WAVE}
    assert len(Recording(**given)) == ROWS
    with pytest.raises(InputError, match=message) as caught:
        Recording(**(given | change))
    assert "\n" not in str(caught.value)


def test_a_file_becomes_a_recording(written: Callable[..., Path], lines: list[str]) -> None:
    path = written(lines)
    recording = Recording.load(path, role="train", kind="sine", start_s=5)
    assert recording.path == path
    assert (recording.role, recording.kind, recording.start_s) == ("train", "sine", 5.0)
    assert dict(recording.units) == {"time": "s", "input": "A", "position": "rad"}


def test_a_text_cell_names_file_line_column_and_remedy(
    written: Callable[..., Path], lines: list[str]
) -> None:
    lines[7] = "0.006,oops,0.1"
    path = written(lines)
    with pytest.raises(InputError) as caught:
        Recording.load(path)
    assert str(caught.value) == (
        f"{path}: line 8, column 'current_a' holds 'oops', which is not a number; "
        "correct the cell, or empty it to have it filled from its neighbours"
    )
    lines[7] = "0.006,,0.1"
    assert Recording.load(written(lines)).notes == (
        "input: 1 of 240 cells was missing or infinite and was interpolated, the first at line 8",
    )


def test_text_in_a_column_that_is_not_used_does_no_harm(
    written: Callable[..., Path], lines: list[str]
) -> None:
    path = written([lines[0] + ",remark", *(line + ",fine" for line in lines[1:])])
    assert len(Recording.load(path)) == ROWS
    with pytest.raises(InputError, match="line 2, column 'remark' holds 'fine'"):
        Recording.load(path, {"velocity": "remark"})


def test_it_prints_its_channels_units_and_notes(
    written: Callable[..., Path], lines: list[str]
) -> None:
    lines[7] = "0.006,,0.1"
    recording = Recording.load(written(lines), kind="a <b>", role="train")
    text, html = repr(recording), recording._repr_html_()
    assert text.startswith("Recording run.csv: 240 rows over 0.239 s, median step 0.001 s (train,")
    for part in ("input", "A", "position", "rad", "note: input: 1 of 240"):
        assert part in text
    assert "<td>position</td>" in html
    assert "a &lt;b&gt;" in html
    assert "<b>)" not in html


def test_reading_recordings_does_not_import_scipy_or_h5py() -> None:
    code = "import sys, stiction.recording; print({'scipy', 'h5py'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"
