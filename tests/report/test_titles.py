"""The title of a report and the names in its figures."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from tests.report.test_report import undrawn

from stiction.diagnosis.gain import Gain
from stiction.diagnosis.result import Verdict
from stiction.report import write
from stiction.report.labels import told_apart


def test_names_that_are_too_long_stay_apart() -> None:
    logs = [f"sysid_lift_and_drop_2025-03-17_{k}0303.json" for k in (16, 17, 18)]
    assert told_apart(logs, 16) == ["…160303…", "…170303…", "…180303…"]
    twins = [f"{'a' * 20}{k}{'b' * 20}{m}{'c' * 20}" for k in "12" for m in "12"]
    assert len(set(told_apart(twins, 16))) == 4
    assert max(len(name) for name in told_apart(twins, 16)) <= 16
    assert told_apart(["run.csv", "walk.csv"], 16) == ["run.csv", "walk.csv"]


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
