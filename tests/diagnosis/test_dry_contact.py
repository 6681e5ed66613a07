"""A dry contact stops and turns round between stamps: what that leaves is noise to replays too."""

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.reference.session_reference import make_session

from stiction.diagnosis.data.surrogates import centre, common_bias, surrogate_residuals
from stiction.diagnosis.screening.base import fit_baseline
from stiction.recording.motion import Kernel
from stiction.residual.driving import Driving

NOISE = 0.02
"""Standard deviation of the torque that nobody commanded, as a share of F_c."""
ALIKE = 0.35
"""By this much may replays of a recording leave more or less than the recording does."""


@pytest.fixture(scope="module")
def dry():
    made = make_session(77, base="coulomb", noise=NOISE)
    evidence, base = fit_baseline(as_plant(made), as_session(made).recordings)
    null, noises = surrogate_residuals(evidence, base.plant, base.nuisances, 12, 0)
    return made, evidence, base, null, noises


def rms(values):
    return float(np.sqrt(np.mean(values**2)))


def test_the_base_of_a_dry_machine_leaves_no_more_than_its_noise(dry):
    made, evidence, base, _, _ = dry
    level = made.plant["coulomb"]
    assert base.plant.parameters["friction.coulomb"].value == pytest.approx(level, rel=0.01)
    left = base.residual / evidence.weights
    recording = evidence.cells.recording
    # White noise of the effort behind the kernel of the first form.
    kernel = evidence.forms[0].kernel.weights
    noise = NOISE * level * float(np.linalg.norm(kernel))
    for index in np.unique(recording):
        assert rms(left[recording == index]) < 1.7 * noise, evidence.names[index]


def test_replays_of_a_dry_machine_leave_what_its_recordings_leave(dry):
    made, evidence, base, null, noises = dry
    bias, centred = centre(null)
    recording = evidence.cells.recording
    compared = 0
    for index in np.unique(recording):
        rows = recording == index
        moved = evidence.forms[index].noisy_rows.mean()
        if moved < 0.3:
            continue
        compared += 1
        ratio = rms(null[rows]) / rms(base.residual[rows])
        assert abs(np.log(ratio)) < np.log(1.0 + ALIKE), evidence.names[index]
        # And not all of them alike.
        assert rms(bias[rows]) < 0.8 * rms(centred[rows]), evidence.names[index]
        # A few rows in which the machine moves throughout tell its noise to about a fifth.
        noise = NOISE * made.plant["coulomb"]
        assert noises[index].effort == pytest.approx(noise, rel=0.4), evidence.names[index]
    assert compared >= 5


def test_a_recording_in_which_the_machine_never_moves_says_nothing(dry):
    _, evidence, base, null, _ = dry
    still = [k for k, form in enumerate(evidence.forms) if not np.any(np.diff(form.readings))]
    still = [k for k in still if np.any(evidence.cells.recording == k)]
    assert still
    for index in still:
        rows = evidence.cells.recording == index
        assert rms(base.residual[rows] / evidence.weights[rows]) < 1e-9
        assert rms(null[rows] / evidence.weights[rows, None]) < 1e-9


def test_a_machine_that_yields_by_a_count_below_break_away_rests():
    kernel, count = Kernel(0.03, 1e-3), 1e-4
    load = np.sin(np.arange(4000) * 2e-3)
    rigid = {"noise": 0.0, "count": count, "springy": False, "prescribed": False}
    for yields, rests in ((1.0, True), (2.0, False)):
        readings = count * np.round(yields * (load > 0.5))
        motion = Driving(readings, kernel, **rigid).motion(readings)
        assert (np.ptp(motion) == 0.0) == rests


def test_what_replays_share_counts_as_far_as_the_residual_has_it():
    source = np.random.default_rng(0)
    common, noise = source.standard_normal(400), 0.1 * source.standard_normal(400)
    recording = np.repeat([0, 1, 2, 3], 100)
    factor = np.array([1.0, 0.5, 0.0, -1.0])[recording]
    found = common_bias(common, factor * common + noise, recording)
    expected = np.clip(factor, 0.0, 1.0) * common
    assert rms(found - expected) < 0.03
    assert np.array_equal(found[recording == 3], np.zeros(100))
