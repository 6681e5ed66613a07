"""Recordings that were made twice tell how much of an error could be explained."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.reference.more_recordings import Wanted, record_more
from tests.reference.session_reference import make_sessions

import stiction as st

SECONDS = 72.0


@pytest.fixture(scope="module")
def found() -> tuple[st.Diagnosis, float, float]:
    """A diagnosis with one repeat; true relative noise, and size of the hidden torque."""
    hidden = (("torque_bias", 0.03),)
    (made,) = make_sessions([{"seed": 21, "seconds": SECONDS, "hidden": hidden}])
    index = next(k for k, r in enumerate(made.recordings) if r.kind == "tracking")
    first = made.recordings[index]
    reference = first.reference_rad - first.reference_rad[0]
    # Moved twice more, from the same place: those two are each other's repeats.
    at = max(r.start_s + r.time_s[-1] for r in made.recordings) + 10.0
    wanted = [
        Wanted("tracking", role, at + 20.0 * k, reference=reference)
        for k, role in enumerate(("train", "test"))
    ]
    more = record_more(made, wanted)
    session = as_session(replace(made, recordings=[*made.recordings, *more]))
    number = len(made.recordings)
    session = st.Session(session.recordings, None, {number + 1: number})
    diagnosis = st.diagnose(as_plant(made), session, surrogates=6)
    effort = float(np.sqrt(np.mean(more[0].torque_nm ** 2)))
    hidden_size = float(np.sqrt(np.mean(more[0].truth["hidden"] ** 2)))
    return diagnosis, hidden_size / effort, effort


def test_what_repeats_could_be_explained_and_what_does_not_could_not(
    found: tuple[st.Diagnosis, float, float],
) -> None:
    diagnosis, hidden, _ = found
    ceiling = diagnosis.ceiling
    assert ceiling is not None
    assert ceiling.pairs == 1
    assert diagnosis.verdict == "missing_effect"
    assert ceiling.noise < ceiling.after < ceiling.before
    # The rest of the bias that the base could not take up, and no more.
    assert 0.1 * hidden < ceiling.explainable < hidden
    taken = ceiling.before - ceiling.after
    assert taken > 0.7 * ceiling.explainable
    assert diagnosis.data["replicates"] == ceiling.to_dict()
    assert "made twice" in str(diagnosis)
    assert "could be explained" in str(diagnosis)


def test_the_noise_of_repeats_is_that_of_the_surrogates(
    found: tuple[st.Diagnosis, float, float],
) -> None:
    diagnosis, _, effort = found
    assert diagnosis.ceiling is not None
    assert diagnosis.extended is not None
    # Of all kinds of recording the one, of all repeats a single pair: the same within a half.
    floor = diagnosis.extended.noise_floor_rms / effort
    assert 0.5 < diagnosis.ceiling.noise / floor < 1.5


def test_without_repeats_nothing_is_said() -> None:
    (made,) = make_sessions([{"seed": 22, "seconds": 48.0}])
    diagnosis = st.diagnose(as_plant(made), as_session(made), surrogates=6)
    assert diagnosis.ceiling is None
    assert diagnosis.data["replicates"] is None
    assert "made twice" not in str(diagnosis)
