"""The title of a report and the names in its figures."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from tests.report.canned import diagnosis
from tests.report.test_report import undrawn

import stiction as st
from stiction.diagnosis import Diagnosis
from stiction.diagnosis.data.gain import Gain
from stiction.diagnosis.findings.reliability import Reliability
from stiction.diagnosis.records import Advice, Verdict
from stiction.report import write
from stiction.report.labels import distinct_labels
from stiction.report.titles import effect_title


def test_names_that_are_too_long_stay_apart() -> None:
    logs = [f"sysid_lift_and_drop_2025-03-17_{k}0303.json" for k in (16, 17, 18)]
    assert distinct_labels(logs, 16) == ["…160303…", "…170303…", "…180303…"]
    twins = [f"{'a' * 20}{k}{'b' * 20}{m}{'c' * 20}" for k in "12" for m in "12"]
    assert len(set(distinct_labels(twins, 16))) == 4
    assert max(len(name) for name in distinct_labels(twins, 16)) <= 16
    assert distinct_labels(["run.csv", "walk.csv"], 16) == ["run.csv", "walk.csv"]


def test_the_title_names_the_law_where_the_sentence_begins_with_it(tmp_path: Path) -> None:
    def title(verdict: Verdict, law: str) -> str:
        found = replace(undrawn(verdict), better_law=law)
        (said,) = re.findall(r"<h1[^>]*>(.*?)</h1>", write(found, tmp_path).read_text("utf-8"))
        return str(said)

    assert "friction law" not in title("ambiguous", "")
    assert "friction law" in title("ambiguous", "maxwell_slip")
    assert "effects" in title("ambiguous", "maxwell_slip")
    alone = replace(undrawn("unexplained"), effects=(), gain=None, better_law="maxwell_slip")
    text = write(alone, tmp_path).read_text("utf-8")
    assert "no known effect" not in text


def test_the_title_does_not_claim_what_rows_held_out_do_not_bear_out(tmp_path: Path) -> None:
    found = replace(undrawn("missing_effect"), gain=Gain(-0.02, (-0.6, 0.2)))
    text = write(found, tmp_path).read_text("utf-8")
    (said,) = re.findall(r"<h1[^>]*>(.*?)</h1>", text)
    assert "does not help on held-out rows" in said


def heading(found: Diagnosis, folder: Path) -> str:
    (said,) = re.findall(r"<h1[^>]*>(.*?)</h1>", write(found, folder).read_text("utf-8"))
    return str(said)


def test_the_title_says_what_is_missing_and_what_becomes_of_the_error(tmp_path: Path) -> None:
    found = undrawn("missing_effect")
    assert found.baseline is not None
    before = replace(found.baseline, heldout_relative=0.0098)
    one = replace(found, baseline=before)
    said = "Missing: constant offset of the effort. Held‑out error 0.98 → 3.00\u00a0% of the effort"
    assert heading(one, tmp_path) == said
    fall = replace(found.effects[0], name="stribeck")
    both = replace(found, effects=(*found.effects, fall))
    assert heading(both, tmp_path).startswith(
        "Missing: constant offset of the effort and Stribeck friction. Held‑out error 3.00 → "
    )
    counted = replace(found.effects[0], reliability=Reliability(76, 74, 74))
    assert heading(replace(one, effects=(counted,)), tmp_path).startswith(
        "Missing: constant offset of the effort, 97\u00a0% sure. Held‑out error 0.98 → "
    )
    pair = (counted, replace(fall, reliability=Reliability(400, 400, 400)))
    assert "Stribeck friction, 97\u00a0% sure of each. Held‑out" in heading(
        replace(one, effects=pair), tmp_path
    )
    never_wrong = replace(fall, reliability=Reliability(400, 400, 400))
    assert "friction, 99\u00a0% sure." in heading(replace(one, effects=(never_wrong,)), tmp_path)
    untested = replace(before, heldout_relative=None, train_relative=0.123)
    assert "Error on the rows fitted 12.3 → " in heading(replace(one, baseline=untested), tmp_path)


def test_the_title_names_all_that_cannot_be_told_apart(tmp_path: Path) -> None:
    said = heading(undrawn("ambiguous"), tmp_path)
    assert said.startswith(
        "Missing: constant offset of the effort or friction that differs by direction, which these"
    )


def test_every_effect_has_a_name_that_reads_well() -> None:
    names = {record.name for record in st.effects()}
    assert not [name for name in names if "_" in effect_title(name)]


def test_refused_effects_and_further_experiments_wait_behind_a_line(tmp_path: Path) -> None:
    solved = undrawn("missing_effect")
    two = (*solved.advice, Advice("a second experiment", "it may help", ()))
    text = write(replace(solved, advice=two), tmp_path).read_text("utf-8")
    advice = text[text.index('id="advice"') : text.index('id="data"')]
    assert advice.index("Slow full turns") < advice.index("<details") < advice.index("A second")
    tried = text[text.index('id="candidates"') : text.index('id="models"')]
    assert tried.index("torque_bias") < tried.index("<details") < tried.index("cogging")
    open_case = replace(undrawn("ambiguous"), advice=two)
    text = write(open_case, tmp_path).read_text("utf-8")
    advice = text[text.index('id="advice"') : text.index('id="data"')]
    assert "<details" not in advice
    assert "A second experiment" in advice


def test_noise_is_told_before_and_after_where_the_search_changed_it(tmp_path: Path) -> None:
    found = undrawn("missing_effect")
    assert found.baseline is not None
    assert "0.0160" not in write(found, tmp_path).read_text("utf-8")
    louder = replace(found, baseline=replace(found.baseline, noise_floor_rms=0.016))
    text = write(louder, tmp_path).read_text("utf-8")
    assert re.search(r'16\.0 <span class="to">→</span> 8\.00.mN·m', text)


def test_odds_stand_beside_each_recording_held_out(tmp_path: Path) -> None:
    text = write(diagnosis("missing_effect"), tmp_path).read_text("utf-8")
    evidence = text[text.index('id="evidence"') : text.index('id="rest"')]
    assert "odds of" in evidence
    assert evidence.count("75.0\u00a0%") == 2
