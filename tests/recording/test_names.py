"""Two recordings never have one name, though their files may."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import stiction as st
from stiction.recording.names import names_of, places_in_session

ROWS = "\n".join(f"{k * 0.001},{np.sin(0.01 * k)},{np.sin(0.01 * k)}" for k in range(300))


def written(path: Path) -> st.Recording:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"time_s,torque_nm,position_rad\n{ROWS}\n")
    return st.Recording.load(path)


def test_files_of_one_name_are_told_apart_by_their_folders(tmp_path: Path) -> None:
    days = [written(tmp_path / day / "run.csv") for day in ("monday", "tuesday")]
    other = written(tmp_path / "rest.csv")
    made = st.Recording(other.time, other.input, other.position)
    told = ["monday/run.csv", "tuesday/run.csv", "rest.csv", "recording 4"]
    assert names_of([*days, other, made]) == told
    assert names_of([days[0], days[0]]) != names_of([days[0]]) * 2
    assert len(set(names_of([days[0], days[0]]))) == 2


def test_the_fault_of_one_file_is_not_that_of_its_namesake(tmp_path: Path) -> None:
    from stiction.recording.usable import checks_of

    days = [written(tmp_path / day / "run.csv") for day in ("monday", "tuesday")]
    assert {name for name, _ in checks_of(days)} == {"monday/run.csv", "tuesday/run.csv"}


def test_what_is_left_of_a_session_is_called_as_in_the_session(tmp_path: Path) -> None:
    from stiction.recording.session_clock import subset

    days = [written(tmp_path / day / "run.csv") for day in ("monday", "tuesday")]
    made = [st.Recording(days[0].time, days[0].input, days[0].position) for _ in range(4)]
    left = subset([*made, *days], [0, 2, 3, 5])
    assert names_of(left) == ["recording 1", "recording 3", "recording 4", "tuesday/run.csv"]
    again = subset(left, [1, 3])
    assert names_of(again) == ["recording 3", "tuesday/run.csv"]
    assert places_in_session(again) == [2, 5]
    # Beside one of another session the name may be taken.
    assert len(set(names_of([made[1], *left, made[1], made[1]]))) == 7
