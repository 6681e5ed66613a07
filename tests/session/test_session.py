"""Sessions: hashes, replicates and the clock."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import stiction as st
from stiction.fitting.forms import as_session
from stiction.recording import Recording
from stiction.recording.checks import starts
from stiction.recording.session_clock import subset
from stiction.residual.weak_form import WeakForm
from stiction.session import load


def recorded(seed: int = 0, **labels: object) -> Recording:
    time = 5.0 + np.arange(300) / 100.0
    noise = np.random.default_rng(seed).normal(size=(2, len(time)))
    return Recording(time, *noise, **labels)  # type: ignore[arg-type]


def written(folder: Path, *entries: str) -> Path:
    """A session file with one recording file for each entry: a.csv, b.csv, ..."""
    text = ""
    for seed, entry in enumerate(entries):
        name = "abcdef"[seed] + ".csv"
        noise = np.random.default_rng(seed).normal(size=(2, 300))
        table = np.column_stack((np.arange(300) / 100.0, *noise))
        head = "time_s,current_a,position_rad"
        np.savetxt(folder / name, table, delimiter=",", header=head, comments="")
        text += f'[[recordings]]\nfile = "{name}"\n{entry}\n'
    path = folder / "session.toml"
    path.write_text(text)
    return path


def test_a_list_of_recordings_makes_a_session() -> None:
    recordings = [recorded(0), recorded(1)]
    session = st.Session(recordings)
    assert session.recordings == tuple(recordings)
    assert list(session) == recordings


def test_a_hash_tells_recordings_apart_and_holds_for_copies() -> None:
    one, two, three = st.Session((recorded(0), recorded(0), recorded(1))).hashes
    assert one == two != three
    assert len(one) == 64
    noise = recorded(0)
    other = Recording(noise.time, noise.position, noise.input)
    assert other.hash != one
    more = Recording(noise.time, noise.input, noise.position, load=np.zeros(300))
    assert more.hash != one


def test_the_session_clock_starts_each_recording_where_it_says() -> None:
    session = st.Session((recorded(start_s=100.0), recorded(1, start_s=0.0)))
    assert session.starts == (100.0, 0.0)
    assert session.clock(0)[0] == 100.0
    np.testing.assert_allclose(np.diff(session.clock(0)), 0.01)


def test_without_a_stated_start_the_recordings_follow_one_another() -> None:
    session = st.Session((recorded(0), recorded(1)))
    assert session.starts == pytest.approx((0.0, 3.0))
    assert session.clock(1)[0] == pytest.approx(session.clock(0)[-1] + 0.01)


def test_a_recording_from_cold_sets_back_how_long_the_machine_has_been_on() -> None:
    """In the order of the clock, whatever the order in the list."""
    session = st.Session(
        (
            recorded(0, start_s=90.0),
            recorded(1, start_s=4.0),
            recorded(2, start_s=70.0, cold=True),
            recorded(3, start_s=10.0),
        )
    )
    assert session.starts == (90.0, 4.0, 70.0, 10.0)
    assert session.ages == (20.0, 4.0, 0.0, 10.0)
    assert "70, cold" in session._repr_html_()


def test_path_and_clock_of_the_effects_begin_anew_from_cold() -> None:
    labels = ({"start_s": 4.0}, {"start_s": 10.0}, {"start_s": 70.0, "cold": True}, {"start_s": 90})
    time = 0.01 * np.arange(300)
    recordings = [
        Recording(time, np.cos(time), (1.0 + k) * np.sin(time), **each)  # type: ignore[arg-type]
        for k, each in enumerate(labels)
    ]
    friction = {"law": "coulomb", "coulomb": 0.1}
    plant = st.Plant.from_dict({"drive": {"input": "torque_nm"}, "friction": friction})
    forms = [WeakForm(plant, recording) for recording in recordings]
    as_session(forms, recordings)
    first, third = (float(np.sum(np.abs(np.diff(forms[k].position)))) for k in (0, 2))
    assert first != third
    assert [(form.clock, form.path) for form in forms] == [
        (4.0, 0.0),
        (10.0, first),
        (0.0, 0.0),
        (20.0, third),
    ]


def test_a_session_file_says_which_recordings_began_cold(tmp_path: Path) -> None:
    path = written(tmp_path, "start_s = 0.0", "start_s = 3600.0\ncold = true", "start_s = 3700.0")
    session = load(path)
    assert [recording.cold for recording in session] == [False, True, False]
    assert session.ages == (0.0, 0.0, 100.0)


@pytest.mark.parametrize(
    ("first", "ages"),
    [
        pytest.param(2.0, (2.0, 12.0), id="switched on before the session"),
        pytest.param(1.76e9, (0.0, 10.0), id="since 1970"),
        pytest.param(-50.0, (0.0, 10.0), id="below 0"),
    ],
)
def test_a_clock_that_began_long_before_tells_nothing_of_when_it_was_switched_on(
    first: float, ages: tuple[float, ...]
) -> None:
    recordings = [recorded(0, start_s=first), recorded(1, start_s=first + 10.0)]
    assert st.Session(recordings).ages == pytest.approx(ages)
    said = [check.what for _, check in starts(recordings)]
    assert said == (
        []
        if first == 2.0
        else [f"the clock stands at {first:.6g} s when the first recording begins"]
    )


def test_a_second_day_does_not_make_a_wall_clock_one_of_the_machine() -> None:
    morning, more = recorded(0, start_s=32400.0), recorded(1, start_s=32410.0)
    next_day = recorded(2, start_s=118800.0, cold=True)
    assert st.Session([morning, more, next_day]).ages == (0.0, 10.0, 0.0)


def test_what_follows_a_cold_recording_that_is_left_out_begins_cold() -> None:
    recordings = [
        recorded(0, start_s=4.0),
        recorded(1, start_s=7200.0, cold=True),
        recorded(2, start_s=7220.0),
        recorded(3, start_s=7240.0),
    ]
    kept = subset(recordings, [0, 2, 3])
    assert [each.cold for each in kept] == [False, True, False]
    assert [each.start_s for each in kept] == [4.0, 7220.0, 7240.0]
    assert not recordings[2].cold


@pytest.mark.parametrize(
    ("pause", "cold", "verdict", "words"),
    [
        (60.0, True, "note", "begins cold, 60 s after"),
        (7200.0, True, "fine", "begins cold, 7200 s after"),
        (7200.0, False, "note", "and not cold"),
        (60.0, False, None, ""),
    ],
)
def test_what_is_called_cold_too_soon_or_not_at_all_is_noted(
    pause: float, cold: bool, verdict: str | None, words: str
) -> None:
    one = recorded(0, start_s=1.0)
    found = starts([one, recorded(1, start_s=1.0 + one.duration + pause, cold=cold)])
    assert [check.verdict for _, check in found] == ([verdict] if verdict else [])
    assert all(words in check.what for _, check in found)


def test_recordings_that_overlap_on_the_session_clock_are_refused() -> None:
    with pytest.raises(st.InputError, match=r"recording 1 starts at 2 s, before recording 2 ends"):
        st.Session((recorded(start_s=2.0), recorded(1)))
    assert len(st.Session((recorded(start_s=3.0), recorded(1)))) == 2
    with pytest.raises(st.InputError, match="on one clock, also of one that begins cold"):
        st.Session((recorded(start_s=2.0), recorded(1, start_s=4.0, cold=True)))


def test_an_overlap_in_a_session_file_names_the_files(tmp_path: Path) -> None:
    path = written(tmp_path, "start_s = 0.0", "start_s = 1.0")
    with pytest.raises(st.InputError, match=r"b\.csv starts at 1 s, before a\.csv ends at 2\.99 s"):
        st.load(path)


def test_a_replicate_points_at_the_recording_it_repeats(tmp_path: Path) -> None:
    session = st.load(written(tmp_path, "", 'replicate_of = "a.csv"'))
    assert session.replicates == {1: 0}


@pytest.mark.parametrize(
    ("entry", "sentence"),
    [
        ('replicate_of = "c.csv"', r"replicate_of = 'c.csv' is none of the recordings"),
        ('replicate_of = "b.csv"', r"replicate_of = 'b.csv' is the recording itself"),
        ("replicate_of = 1", r"replicate_of = 1 is not a path"),
    ],
)
def test_a_replicate_of_nothing_is_refused(tmp_path: Path, entry: str, sentence: str) -> None:
    with pytest.raises(st.InputError, match=sentence):
        st.load(written(tmp_path, "", entry))


@pytest.mark.parametrize("replicates", [{0: 0}, {0: 2}, {5: 0}])
def test_replicates_given_in_python_are_checked_too(replicates: dict[int, int]) -> None:
    with pytest.raises(st.InputError, match="two different indices from 0 to 1"):
        st.Session((recorded(0), recorded(1)), replicates=replicates)


def test_a_faulty_recording_is_kept_where_asked(tmp_path: Path) -> None:
    path = written(tmp_path, "")
    lines = (tmp_path / "a.csv").read_text().splitlines()
    holes = [line.rpartition(",")[0] + "," for line in lines[1:31]]
    (tmp_path / "a.csv").write_text("\n".join([lines[0], *holes, *lines[31:]]))
    with pytest.raises(st.InputError, match="position has 30 missing"):
        st.load(path)
    assert st.load(path, keep_faulty=True).recordings[0].faults


def test_a_session_shows_itself_as_a_table(tmp_path: Path) -> None:
    entries = ('role = "train"\nkind = "a < b"', 'replicate_of = "a.csv"')
    html = st.load(written(tmp_path, *entries))._repr_html_()
    assert html.count("<tr>") == 3
    assert "a &lt; b" in html
    assert html.partition("</table>")[0].count("a.csv") == 2
