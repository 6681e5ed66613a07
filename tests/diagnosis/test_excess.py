"""Most of what names leave is told, even where a few coordinates show a little of it."""

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.diagnosis.builders import evidence, model, search, view
from tests.reference.session_reference import make_session

import stiction as st
from stiction.diagnosis.adequacy.omnibus import Rest
from stiction.diagnosis.findings import verdict
from stiction.diagnosis.findings.words import sentence
from stiction.diagnosis.phrases import NO_COORDINATE
from stiction.diagnosis.records import Unexplained


@pytest.mark.slow
def test_what_goes_with_no_coordinate_is_told_beside_coordinates_that_show_little():
    # Beside a law that cannot be right: the machine remembers its reversals, LuGre does not.
    made = make_session(311)
    table = as_plant(made).to_dict()
    plant = st.Plant.from_dict({**table, "friction": {"law": "lugre"}})
    found = st.diagnose(plant, as_session(made), threads=1)
    assert found.effects
    first = found.unexplained[0]
    assert first.coordinate == NO_COORDINATE
    assert first.share > 0.75
    assert len(found.unexplained) > 1
    assert f"most goes with {NO_COORDINATE}" in found.sentence


def test_a_sentence_says_how_much_goes_with_nothing():
    left = (Unexplained(NO_COORDINATE, 0.98), Unexplained("speed", 0.03))
    told = sentence("unexplained", (), None, left, "")
    assert (
        "is more than noise (98 %); some of it depends on speed (3 %), and most goes with nothing "
        "that was looked at" in told
    )
    alone = sentence("unexplained", (), None, left[:1], "")
    assert "goes with nothing that was looked at (98 %)" in alone


@pytest.mark.parametrize("share", [0.05, 0.5])
def test_a_coordinate_that_shows_little_hides_not_that_most_goes_with_nothing(share):
    """Where nothing is named: 5 % went with the effort, and 95 % with nothing."""
    session = evidence()
    white = np.random.default_rng(3).standard_normal(len(session.fitted))
    # Noise leaves a fiftieth of the power.
    null = np.sqrt(0.02) * white[:, None] * np.ones(4)
    found = search(models=[model(session, residual=white)])
    left = Rest((view("effort", share),))
    told = verdict.unnamed_remainder(session, found, left, left, null, lambda: null)
    names = [each.coordinate for each in told]
    assert names == ([NO_COORDINATE, "effort"] if share < 0.1 else ["effort"])
