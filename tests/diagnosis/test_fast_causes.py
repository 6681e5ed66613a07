"""What is over within a seventh of a second shows along readings, and hardly over windows."""

from __future__ import annotations

import numpy as np
import pytest
from tests.blind.plants import PLANTS

import stiction as st
from stiction.cli.sessions import load_session
from stiction.diagnosis.adequacy.bursts import recurs


def told(seed, folder, number=150):
    """The diagnosis of one of so many sessions of the stranger's axis."""
    cases = PLANTS["axis4"](("hidden",), number, seed // 1000, None)
    laid = next(case for case in cases if case.bench.seed == seed).lay(folder / "session")
    recordings, plant = load_session(laid.path)
    return laid.names, st.diagnose(plant, recordings, threads=1)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2911530, 2911643])
def test_windows_do_not_take_back_what_is_left_along_readings(seed, tmp_path):
    # A gap whose ends ring at 70 Hz and more: a third of the friction, and nothing over windows.
    names, found = told(seed, tmp_path)
    assert names == ["backlash"]
    assert found.verdict == "unexplained"


@pytest.mark.slow
def test_a_shaft_that_rings_is_as_large_as_its_effort(tmp_path):
    # It explains 95 % held out, and moves a window by half a thousandth of what friction does.
    names, found = told(2911632, tmp_path)
    assert [cause.name for cause in found.effects] == names == ["shaft_compliance"]


@pytest.mark.slow
def test_windows_that_come_first_do_not_hide_a_shaft_that_rings(tmp_path):
    # One recording, 99 Hz: .36 held out over windows, .80 along the readings.
    names, found = told(71558, tmp_path, 100)
    assert [cause.name for cause in found.effects] == names == ["shaft_compliance"]
    assert found.effects[0].decided


@pytest.mark.slow
def test_a_shaft_is_found_over_windows(tmp_path):
    # What rings there moves the motor by a tenth of a count: at no compliance no slope shows it.
    names, found = told(3011622, tmp_path, 300)
    assert found.data["through"]["horizon"]
    assert [cause.name for cause in found.effects] == names == ["shaft_compliance"]
    assert found.effects[0].decided


def test_single_moments_are_not_again_and_again():
    source = np.random.default_rng(1)
    null = source.standard_normal((2000, 20))
    noise = source.standard_normal(2000)
    block = np.repeat(np.arange(20), 100)
    assert not recurs(noise, null, block)
    noise[700:760] += 40.0
    assert not recurs(noise, null, block)
    # Twice in twenty seconds as well; a ring after every other step is something else.
    noise[1300:1330] += 10.0
    assert not recurs(noise, null, block)
    for start in range(0, 2000, 200):
        noise[start : start + 5] += 12.0
    assert recurs(noise, null, block)
    assert recurs(3.0 * source.standard_normal(2000), null, block)
