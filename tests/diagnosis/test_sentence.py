"""The verdict in one sentence."""

from __future__ import annotations

from dataclasses import replace

from tests.diagnosis.builders import cause

from stiction._support.wording import join_words
from stiction.diagnosis.data.gain import Gain
from stiction.diagnosis.findings.words import sentence, unseen_words
from stiction.diagnosis.phrases import LEAVES_NOTHING, OUTWEIGHED, UNREPEATED
from stiction.diagnosis.records import Unexplained


def test_words_join_and_say_what_was_not_confirmed() -> None:
    assert join_words(["a"]) == "a"
    assert join_words(["a", "b", "c"], "or") == "a, b or c"
    assert "Nothing is missing" in sentence("nothing_missing", (), None, (), "")
    little = sentence("nothing_missing", (), None, (), "", slight=True)
    assert little.startswith("Nothing that counts is missing: some of what is left is more than")
    assert sentence("not_testable", (), None, (), "too short") == "too short"
    sure = cause("cogging", what="a pull: cosine 1")
    alike = ("stribeck", "torque_bias")
    unsure = cause("warm_up", decided=False, look_alikes=alike[:1], what="a fall")
    fall = "friction falls from a level at rest to a lower one as speed rises"
    assert sentence("ambiguous", (sure, unsure), None, (), "").startswith(
        f"The simulation lacks cogging (a pull) and either warm_up (a fall) or stribeck ({fall}), "
        "which these data cannot tell apart. Adding them removes"
    )
    other = cause("stribeck", decided=False, look_alikes=("warm_up",), what="a bump")
    assert sentence("ambiguous", (unsure, sure, other), None, (), "").startswith(
        "The simulation lacks cogging (a pull) and warm_up (a fall) and stribeck (a bump), which "
        "together may be another cause that resembles them. Adding them removes"
    )
    # Two such groups are two causes, and one that may be a third as well stands by itself.
    pair = [
        cause(name, decided=False, look_alikes=alike, what=name)
        for name, alike in (("run_in", ("backlash",)), ("backlash", ("run_in",)))
    ]
    both = sentence("ambiguous", (unsure, other, *pair), None, (), "")
    assert both.count("which together may be") == 2
    pair[1] = replace(pair[1], look_alikes=("run_in", "cogging"))
    assert "together" not in sentence("ambiguous", pair, None, (), "")
    unsure = replace(unsure, look_alikes=alike)
    assert "lacks one of warm_up (a fall), stribeck (" in sentence(
        "ambiguous", (unsure,), None, (), ""
    )
    alone = cause("run_in", decided=False, what="a change", doubt=OUTWEIGHED)
    taken = sentence("ambiguous", (sure, alone), None, (Unexplained("effort", 0.4),), "")
    assert "perhaps run_in" in taken
    assert "still depends on effort (40 %). What has no name there is worth more than" in taken
    alone = replace(alone, doubt=UNREPEATED)
    taken = sentence("ambiguous", (sure, alone), None, (), "")
    assert taken.endswith(
        "Of run_in less than one period was travelled, and a spring may look the same."
    )
    alone = replace(alone, doubt=LEAVES_NOTHING.format("effort"))
    taken = sentence("ambiguous", (sure, alone), None, (), "")
    assert "run_in may be something else: what is left goes with effort, and of that it" in taken
    worse = sentence("missing_effect", (sure,), Gain(-0.1, (-0.2, 0.1)), (), "")
    assert worse.startswith("By the rows that decide, and by no others, the simulation lacks")
    assert "Adding it makes the held-out rows worse." in worse
    assert Gain(0.5, (0.4, 0.6)).to_dict() == {"value": 0.5, "ci95": [0.4, 0.6]}


def test_what_cannot_be_judged_is_told_by_name() -> None:
    said = unseen_words({"stribeck": 0.25}, beside=False)
    assert said.startswith("These data cannot decide")
    assert "stribeck (" in said
    assert "would explain 25 %" in said
    assert unseen_words({"stribeck": 0.25}, beside=True).startswith(" Of what is left")
    assert unseen_words({}, beside=True) == ""
    assert "neither bear it out nor refute it" in said
