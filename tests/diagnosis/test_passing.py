"""What comes and goes with time inside a recording is seen there, and chance is not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.reference.session_reference import make_sessions

import stiction as st
from stiction._support.arrays import FloatArray
from stiction.diagnosis.adequacy.passing import drift_view, moments_view
from stiction.diagnosis.data.evidence import Cells

SPACING = 5e-3  # s
LASTS = 20.0  # s
SURROGATES = 12
FRICTION = 5.0


@dataclass
class Session:
    """Noise of rms 0.1 beside a friction of 5, in recordings that go to and fro every 4 s."""

    clock: FloatArray
    elapsed: FloatArray
    velocity: FloatArray
    both: FloatArray
    cells: Cells
    sliding: Any

    def drift(self):
        weights = np.ones(len(self.clock))
        return drift_view(
            self.cells, self.clock, self.velocity, self.sliding, self.both, weights, FRICTION
        )

    def moments(self):
        weights = np.ones(len(self.clock))
        sliding = self.elapsed >= 0.15
        return moments_view(self.cells, self.clock, sliding, self.both, weights, FRICTION)


def session(recordings=6):
    rng = np.random.default_rng(7)
    rows = round(LASTS / SPACING)
    local = np.arange(rows) * SPACING
    recording = np.repeat(np.arange(recordings), rows)
    time = np.tile(local, recordings)
    return Session(
        time + 30.0 * recording,
        np.mod(time, 2.0),
        np.sin(np.pi * time / 2.0) * (1.0 + 0.1 * recording),
        0.1 * rng.standard_normal((len(time), 1 + SURROGATES)),
        Cells(recording, recording, recording, ("",)),
        np.mod(time, 2.0) > 0.1,
    )


def test_noise_neither_drifts_nor_comes_in_bursts():
    made = session()
    assert not made.drift().is_flagged()
    assert not made.moments().is_flagged()


@pytest.mark.parametrize("recordings", [1, 6])
def test_an_offset_that_wanders_within_seconds_is_told_by_the_seconds_beside_it(recordings):
    made = session(recordings)
    wander = 0.08 * np.sin(2.0 * np.pi * 0.07 * made.clock + 1.0)
    made.both[:, 0] += wander
    seen = made.drift()
    assert seen.is_flagged()
    assert not made.moments().is_flagged()
    assert seen.share == pytest.approx(np.mean(wander**2) / np.mean(made.both[:, 0] ** 2), rel=0.3)
    # Drawn as it is: the mean of each second, in units of effort.
    assert np.corrcoef(seen.mean, np.interp(seen.at, made.clock, wander))[0, 1] > 0.9


def test_a_drift_in_one_recording_is_a_machine_that_was_lost_there():
    made = session()
    lost = made.cells.recording == 2
    made.both[lost, 0] += 0.3 * np.sin(2.0 * np.pi * 0.07 * made.clock[lost])
    assert not made.drift().is_flagged()


def test_what_a_resting_contact_holds_is_no_drift():
    made = session()
    made.sliding[:] = np.mod(made.clock, 5.0) > 3.0
    made.both[~made.sliding, 0] += 0.2
    assert not made.drift().is_flagged()
    made.sliding[:] = False
    assert made.drift() is None


def test_what_goes_with_the_velocity_is_no_drift():
    made = session()
    made.both[:, 0] += 0.1 * made.velocity
    assert not made.drift().is_flagged()


def test_bursts_are_seen_away_from_reversals_alone():
    made = session()
    rng = np.random.default_rng(3)
    at = np.flatnonzero(made.elapsed > 0.4)
    bursts = np.zeros(len(made.clock))
    for first in rng.choice(at, 40):
        bursts[first : first + 16] += rng.choice([-0.6, 0.6])
    made.both[:, 0] += bursts
    assert made.moments().is_flagged()
    assert not made.drift().is_flagged()

    near = session()
    near.both[:, 0] += np.where(near.elapsed < 0.08, 0.6, 0.0)
    assert not near.moments().is_flagged()


def test_what_stands_out_everywhere_is_no_matter_of_moments():
    made = session()
    made.both[:, 0] *= 8.0
    assert not made.moments().is_flagged()


def test_three_outliers_are_no_bursts():
    made = session()
    for first in (1000, 9000, 17100):
        made.both[first : first + 10, 0] += 3.0
    assert not made.moments().is_flagged()


def test_a_machine_that_turns_round_all_the_time_has_no_moments():
    made = session()
    made.elapsed[:] = np.mod(made.clock, 0.1)
    assert made.moments() is None


@pytest.mark.parametrize(
    ("foreign", "coordinate"),
    [("wandering_bias", "session time"), ("torque_bursts", "single moments in time")],
)
def test_what_no_library_has_is_told_by_its_time(foreign, coordinate):
    (made,) = make_sessions([{"seed": 5521, "base": "maxwell_slip", "hidden": ((foreign, 0.01),)}])
    found = st.diagnose(as_plant(made), as_session(made))
    assert not [cause for cause in found.effects if cause.decided]
    assert coordinate in [left.coordinate for left in found.unexplained[:2]]
