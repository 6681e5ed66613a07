"""Most of what names leave is told, even where a few coordinates show a little of it."""

from tests.blind.score import as_plant, as_session
from tests.reference.session_reference import make_session

import stiction as st
from stiction.diagnosis.result import Unexplained
from stiction.diagnosis.words import NO_COORDINATE, sentence


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
