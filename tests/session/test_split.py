"""Which rows of a session train, select and test."""

from __future__ import annotations

import json
import pickle
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import stiction as st
from stiction.recording import Part, Recording, Split
from stiction.recording.blocks import blocks


def recorded(seconds: float = 6.0, seed: int = 0, **labels: object) -> Recording:
    time = np.arange(round(100 * seconds)) / 100.0
    noise = np.random.default_rng(seed).normal(size=(2, len(time)))
    return Recording(time, *noise, **labels)  # type: ignore[arg-type]


def session(*labels: Any, seconds: float = 6.0) -> st.Session:
    recordings = [recorded(seconds, seed, **given) for seed, given in enumerate(labels)]
    return st.Session(recordings)


def of(parts: tuple[Part, ...]) -> list[int]:
    return [part.recording for part in parts]


def rows(parts: tuple[Part, ...]) -> set[tuple[int, int]]:
    return {(part.recording, row) for part in parts for row in range(part.start, part.stop)}


def assert_apart(split: Split) -> None:
    """Nothing is fitted and judged on, in the roles or in a fold."""
    train, select, test = rows(split.train), rows(split.select), rows(split.test)
    assert train
    assert test
    assert not train & select
    assert not train & test
    assert not select & test
    assert bool(select) != bool(split.folds)
    for fold in split.folds:
        assert rows(fold.fit)
        assert rows(fold.held)
        assert not rows(fold.fit) & rows(fold.held)
        assert rows(fold.fit) | rows(fold.held) <= train


def test_stated_roles_stay_and_recordings_stay_whole() -> None:
    split = session({"role": "test"}, {"role": "train"}, {"role": "select"}).split()
    assert split.train == (Part(1, 0, 600),)
    assert split.select == (Part(2, 0, 600),)
    assert split.test == (Part(0, 0, 600),)
    assert split.folds == ()
    assert split.rules == ()
    assert_apart(split)


def test_without_select_the_recordings_of_train_are_left_out_in_turn() -> None:
    split = session(*[{"role": "train"}] * 3, {"role": "test"}).split()
    assert [of(fold.held) for fold in split.folds] == [[0], [1], [2]]
    assert [of(fold.fit) for fold in split.folds] == [[1, 2], [0, 2], [0, 1]]
    assert_apart(split)


def test_without_select_blocks_are_left_out_of_a_kind_that_occurs_once() -> None:
    sines, ramp = {"role": "train", "kind": "sine"}, {"role": "train", "kind": "ramp"}
    split = session(sines, sines, ramp, {"role": "test"}).split()
    assert [set(of(fold.held)) for fold in split.folds] == [{0}, {1}, {2}, {2}]
    assert [of(fold.held) for fold in split.folds[2:]] == [[2, 2], [2]]
    for fold in split.folds[2:]:
        assert {0, 1, 2} == set(of(fold.fit))
    assert_apart(split)


def test_without_test_the_last_recording_of_the_commonest_kind_is_split_off() -> None:
    sines, ramp = {"role": "train", "kind": "sine"}, {"role": "train", "kind": "ramp"}
    split = session(sines, sines, sines, ramp, {"role": "select"}).split()
    assert of(split.test) == [2]
    assert of(split.train) == [0, 1, 3]
    assert "split off before anything is fitted" in split.describe()
    assert_apart(split)


def test_without_test_every_third_block_is_split_off_where_every_kind_occurs_once() -> None:
    sine, ramp = {"role": "train", "kind": "sine"}, {"role": "train", "kind": "ramp"}
    split = session(sine, ramp, seconds=12.0).split()
    assert of(split.test) == [0, 0, 1, 1]
    assert of(split.train) == [0, 0, 0, 0, 1, 1, 1, 1]
    assert [of(fold.held) for fold in split.folds] == [[0, 0, 1, 1], [0, 0, 1, 1]]
    assert_apart(split)


def test_without_any_role_the_recordings_of_each_kind_are_dealt_in_turn() -> None:
    sine, ramp = {"kind": "sine"}, {"kind": "ramp"}
    split = session(sine, ramp, sine, sine, ramp, ramp, sine).split()
    assert of(split.train) == [0, 1, 6]
    assert of(split.select) == [2, 4]
    assert of(split.test) == [3, 5]
    assert_apart(split)


def test_two_recordings_without_a_role_still_leave_something_to_test() -> None:
    split = session({}, {}).split()
    assert of(split.select) == [1]
    assert set(of(split.test)) == {0}
    assert_apart(split)


def test_a_recording_without_a_role_beside_others_trains() -> None:
    split = session({}, {"role": "select"}, {"role": "test"}).split()
    assert of(split.train) == [0]
    assert "these train: recording 1" in split.describe()


def test_a_single_recording_is_dealt_in_blocks_of_two_seconds() -> None:
    split = session({}, seconds=12.0).split(edge_s=0.05)
    assert split.train == (Part(0, 0, 195), Part(0, 1005, 1200))
    assert split.select == (Part(0, 205, 395), Part(0, 605, 795))
    assert split.test == (Part(0, 405, 595), Part(0, 805, 995))
    assert_apart(split)


def test_a_motion_that_repeats_every_three_blocks_is_seen_whole_by_every_role() -> None:
    # Dealt 0 1 2 0 1 2 each role would see the same third of the cycle every time.
    split = session({}, seconds=18.0).split(edge_s=0.05)
    for parts in (split.train, split.select, split.test):
        assert sorted(part.start // 200 % 3 for part in parts) == [0, 1, 2]


def test_one_kernel_length_is_dropped_on_either_side_of_each_edge() -> None:
    split = session({}, seconds=12.3).split(edge_s=0.2)
    parts = sorted(split.train + split.select + split.test)
    gaps = [after.start - before.stop for before, after in pairwise(parts)]
    assert min(gaps) >= 40
    assert parts[0].start == 0
    assert parts[-1].stop == 1230


def test_blocks_leave_no_rest_and_are_no_shorter_than_asked() -> None:
    split = session({}, seconds=13.9).split(edge_s=0.0)
    parts = sorted(split.train + split.select + split.test)
    assert len(parts) == 6
    assert sum(len(part) for part in parts) == 1390
    assert min(len(part) for part in parts) >= 200


@pytest.mark.parametrize("role", [None, "train"])
def test_a_recording_shorter_than_three_blocks_is_not_cut(role: str | None) -> None:
    with pytest.raises(st.InputError, match=r"recording 1 lasts 5 s and .* at least 3 blocks of 2"):
        session({"role": role}, seconds=5.0).split()
    assert_apart(session({"role": role}, seconds=6.0).split())


def test_a_recording_a_little_short_of_three_blocks_is_cut() -> None:
    assert len(session({}, seconds=5.95).split().test) == 1


def test_only_test_recordings_are_refused() -> None:
    with pytest.raises(st.InputError, match=r"every recording has the role 'test', so there is"):
        session({"role": "test"}, {"role": "test"}).split()


def test_select_and_test_with_nothing_to_train_on_are_refused() -> None:
    with pytest.raises(st.InputError, match="the roles select and test, and none has 'train'"):
        session({"role": "select"}, {"role": "test"}).split()


@pytest.mark.parametrize("roles", [("train", "test"), ("train", "train"), (None, None)])
def test_the_same_recording_twice_is_refused_where_one_would_judge_the_other(
    roles: tuple[str | None, ...],
) -> None:
    twins = [recorded(seed=1, role=role) for role in roles]
    with pytest.raises(st.InputError, match="recording 1 and recording 2 are the same recording"):
        st.Session(twins).split()


def test_the_same_recording_twice_in_one_role_passes_where_no_fold_parts_them() -> None:
    recordings = [recorded(seed=1, role="train"), recorded(seed=1, role="train")]
    judged = [recorded(seed=2, role="select"), recorded(seed=3, role="test")]
    assert_apart(st.Session(recordings + judged).split())


@pytest.mark.parametrize(("block_s", "edge_s"), [(0.0, 0.0), (2.0, 0.6), (2.0, -0.1), (np.nan, 0)])
def test_blocks_that_edges_would_eat_are_refused(block_s: float, edge_s: float) -> None:
    with pytest.raises(st.InputError, match=r"^split: (block_s is|edge_s is|block_s: nan is not)"):
        session({}).split(block_s=block_s, edge_s=edge_s)


def test_a_block_that_falls_into_a_gap_is_refused() -> None:
    time = np.concatenate((np.arange(300), np.arange(900, 1200))) / 100.0
    noise = np.random.default_rng(0).normal(size=(2, 600))
    holey = st.Session([Recording(time, *noise)])
    with pytest.raises(st.InputError, match=r"no rows from .* split the file at the gap"):
        holey.split()


def test_milliseconds_taken_for_seconds_are_no_gap():
    time = 2.0 * np.arange(1000)
    with pytest.raises(st.InputError, match=r"a row every 2 s, too few .* the unit of its time"):
        blocks(0, time, "r", 2.0, 0.1)


def test_a_session_without_recordings_cannot_be_split() -> None:
    with pytest.raises(st.InputError, match="there are no recordings to split"):
        st.Session(()).split()


def test_the_split_reads_in_plain_words() -> None:
    words = session({}, seconds=12.0).split().describe()
    assert "take the roles train, select and test in rotation" in words
    assert "train: 2 blocks of recording 1" in words
    assert "select: 2 folds over train" in session(*[{"role": "train"}] * 3).split().describe()


def test_the_split_goes_into_json_and_is_the_same_every_time() -> None:
    one, two = (session(*[{"role": "train"}] * 3).split() for _ in range(2))
    assert one == two
    assert pickle.loads(pickle.dumps(one)) == one
    written = json.loads(json.dumps(one.to_dict()))
    assert list(written) == ["rules", "train", "select", "test", "folds"]
    assert written["test"] == [
        {"recording": 2, "name": "recording 3", "rows": [0, 600], "seconds": [0.0, 5.99]}
    ]


def test_short_recordings_of_kinds_of_their_own_are_left_out_whole() -> None:
    short = [
        Recording(np.arange(550) * 1e-2 * 0.9, np.sin(np.arange(550.0) + k), np.arange(550.0) + k,
                  role=role, kind=kind)
        for k, (role, kind) in enumerate(
            [("train", "ramps"), ("train", "sines"), ("train", "pulses"), ("test", "ramps")]
        )
    ]  # fmt: skip
    dealt = st.Session(short).split()
    assert len(dealt.folds) == 3
    without = [
        replaced(r, role) for r, role in zip(short[:3], ("train", "train", "select"), strict=True)
    ]
    assert [part.recording for part in st.Session(without).split().test] == [1]


def replaced(recording: Recording, role: str) -> Recording:
    return Recording(
        recording.time, recording.input, recording.position, role=role, kind=recording.kind
    )


def test_of_two_short_recordings_of_each_kind_both_kinds_train() -> None:
    # Split off from train, the only one that shows an inertia would be gone.
    kinds = ("ramp", "ramp", "step", "step")
    split = session(*({"kind": kind} for kind in kinds), seconds=3.0).split()
    assert (of(split.train), of(split.select), of(split.test)) == ([0, 2], [1], [3])
    assert "the last in select, is split off" in split.describe()
    assert_apart(split)
