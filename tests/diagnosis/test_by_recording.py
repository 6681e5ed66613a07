"""What is another one in each recording: told by what it goes with, and a sign of nothing."""

from __future__ import annotations

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.reference.session_reference import make_session

import stiction as st
from stiction.diagnosis.adequacy.by_recording import GAIN, INERTIA, by_recording_view
from stiction.diagnosis.adequacy.omnibus import Rest
from stiction.diagnosis.adequacy.view import View
from stiction.diagnosis.data.evidence import Cells
from stiction.diagnosis.findings import verdict
from stiction.diagnosis.phrases import NO_COORDINATE
from stiction.diagnosis.records import Unexplained
from stiction.session import Session

RECORDINGS, BLOCKS, ROWS = 8, 6, 100
CELLS = Cells(
    np.repeat(np.arange(RECORDINGS * BLOCKS), ROWS),
    np.repeat(np.arange(RECORDINGS), BLOCKS * ROWS),
    np.zeros(RECORDINGS * BLOCKS * ROWS, dtype=np.int64),
    ("sines",),
)


def seen(slopes: np.ndarray, noise: float = 0.3) -> View:
    source = np.random.default_rng(4)
    values = source.standard_normal(len(CELLS.block))
    null = noise * source.standard_normal((len(values), 40))
    left = slopes[CELLS.recording] * values + noise * source.standard_normal(len(values))
    both = np.column_stack([left, null])
    view = by_recording_view(INERTIA, CELLS, values, both, np.ones(len(values)), friction=1.0)
    assert view is not None
    return view


def test_slopes_that_differ_by_recording_show() -> None:
    slopes = np.repeat([-0.4, 0.4], RECORDINGS // 2)
    view = seen(slopes)
    # .16 of slopes beside .09 of noise; one of eight is not counted.
    assert view.share == pytest.approx(7.0 / 8.0 * 0.16 / 0.25, abs=0.05)
    assert view.is_flagged()
    assert view.at.tolist() == list(range(1, RECORDINGS + 1))
    assert view.mean == pytest.approx(slopes, abs=0.05)


def test_noise_and_one_recording_alone_do_not() -> None:
    assert not seen(np.zeros(RECORDINGS)).is_flagged()
    assert not seen(np.where(np.arange(RECORDINGS) == 3, 1.0, 0.0)).is_flagged()


def test_a_slope_that_all_have_in_common_does_not() -> None:
    assert not seen(np.full(RECORDINGS, 0.4)).is_flagged()
    both = seen(0.4 + np.repeat([-0.4, 0.4], RECORDINGS // 2))
    # Beyond that it is a share of all that is left.
    assert both.share == pytest.approx(7.0 / 8.0 * 0.16 / (0.16 + 0.16 + 0.09), abs=0.06)


def test_a_half_at_rest_tells_the_other_half_nothing() -> None:
    source = np.random.default_rng(4)
    moving = CELLS.block % 2 == 0
    values = np.where(moving, 1.0, 1e-9) * source.standard_normal(len(CELLS.block))
    both = source.standard_normal((len(values), 41))
    view = by_recording_view(INERTIA, CELLS, values, both, np.ones(len(values)), friction=1.0)
    assert view is not None
    assert abs(view.share) < 0.02


def test_a_single_recording_has_no_others() -> None:
    cells = CELLS.of(CELLS.recording == 0)
    n = len(cells.block)
    both = np.ones((n, 3))
    assert by_recording_view(GAIN, cells, np.ones(n), both, np.ones(n), friction=1.0) is None


def rest(share: float) -> Rest:
    empty = np.zeros(2)
    return Rest((View(INERTIA, empty, empty, empty, empty, share, 0.02, 0.1),))


@pytest.mark.parametrize(
    ("told", "share", "expected"),
    [
        # Alone it is no sign that anything is left.
        ([], 0.9, []),
        # It stands before what shows less, and in the place of no coordinate where it has most.
        ([("effort", 0.1)], 0.6, [INERTIA.name, "effort"]),
        ([("effort", 0.7)], 0.6, ["effort"]),
        ([(NO_COORDINATE, 0.9)], 0.6, [INERTIA.name]),
        ([(NO_COORDINATE, 0.9)], 0.3, [INERTIA.name, NO_COORDINATE]),
        ([(NO_COORDINATE, 0.9)], 0.1, [NO_COORDINATE]),
    ],
)
def test_it_describes_what_is_left(
    told: list[tuple[str, float]], share: float, expected: list[str]
) -> None:
    given = tuple(Unexplained(*each) for each in told)
    assert rest(share).significant_views() == ()
    described = verdict._described(rest(share), given, named=False)
    assert [each.coordinate for each in described] == expected


def test_beside_names_it_hides_nothing_that_counts_against_them() -> None:
    given = (Unexplained(NO_COORDINATE, 0.9),)
    described = verdict._described(rest(0.6), given, named=True)
    assert [each.coordinate for each in described] == [INERTIA.name, NO_COORDINATE]


def test_a_gain_that_changed_in_mid_session_is_told_as_that() -> None:
    made = make_session(731, base="coulomb")
    recordings = [
        each if k < 9 or each.input is None else each.with_input(1.03 * each.input)
        for k, each in enumerate(as_session(made).recordings)
    ]
    found = st.diagnose(as_plant(made), Session(recordings))
    assert found.verdict == "unexplained"
    assert found.effects == ()
    assert found.unexplained[0].coordinate == GAIN.name
    assert found.unexplained[0].share > 0.4
    assert any("diagnose those before and after apart" in each.experiment for each in found.advice)
