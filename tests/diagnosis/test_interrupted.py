"""Ctrl-C in a diagnosis: what is known so far comes back, and nothing is claimed beyond it."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stiction as st
from stiction.diagnosis.findings import conclude
from stiction.fitting.minimise import Solution

DT = 2e-3


def recorded(seed: int, role: str) -> st.Recording:
    """A rigid motor with an effort that nobody logged: something to be found."""
    source = np.random.default_rng(seed)
    time = np.arange(3000) * DT
    effort = np.sum([0.3 * np.sin(w * time + source.uniform(0, 6)) for w in (2.0, 5.3)], axis=0)
    friction = st.FrictionModel(
        "maxwell_slip", coulomb=0.25, viscous=0.02, initial_stiffness=3000.0
    )
    position = st.Motor(0.006, friction=friction).simulate(effort[:-1], DT).position
    measured = effort - 0.03 + 0.004 * source.standard_normal(len(time))
    return st.Recording(time, measured, np.append(0.0, position).round(5), role=role)


PLANT = st.Plant.from_dict(
    {
        "drive": {"input": "torque_nm"},
        "body": {"inertia": 0.006},
        "friction": {
            "law": "maxwell_slip",
            "coulomb": 0.25,
            "initial_stiffness": 3000.0,
            "viscous": 0.02,
        },
    }
)


@pytest.fixture(scope="module")
def recordings() -> list[st.Recording]:
    return [recorded(k, role) for k, role in enumerate(("train", "select", "test"))]


@pytest.fixture(scope="module")
def whole(recordings: list[st.Recording]) -> st.Diagnosis:
    return st.diagnose(PLANT, recordings, surrogates=4)


def struck(work: Callable[..., Any], times: int = 1) -> Callable[..., Any]:
    """The same function, in which Ctrl-C is pressed the first so many times."""
    left = [times]

    def once(*given: Any, **named: Any) -> Any:
        if left[0]:
            left[0] -= 1
            raise KeyboardInterrupt
        return work(*given, **named)

    return once


def begins_with_it(found: st.Diagnosis) -> bool:
    told = found.to_dict()["sentence"].startswith("Interrupted: this is the best so far")
    return told and not found.success and found.message.startswith("interrupted")


def test_an_interrupted_base_ends_the_diagnosis(
    recordings: list[st.Recording], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def stopped(first: Solution, *_: object, **__: object) -> Solution:
        return replace(first, success=False, interrupted=True)

    def never(*_: object, **__: object) -> None:
        raise AssertionError("goes on after Ctrl-C")

    monkeypatch.setattr("stiction.diagnosis.screening.base.second_pass", stopped)
    monkeypatch.setattr("stiction.diagnosis.findings.conclude.surrogate_residuals", never)
    found = st.diagnose(PLANT, recordings, surrogates=4)
    assert begins_with_it(found)
    assert "not finished" in found.sentence
    assert found.verdict == "not_testable"
    assert found.baseline is not None
    assert "body.inertia" in found.baseline.parameters
    assert found.candidates == ()
    assert "no rows were left" not in str(found)
    report = found.save(tmp_path)
    assert "Interrupted before anything was named" in report.read_text("utf-8")
    findings = json.loads((tmp_path / "findings.json").read_text("utf-8"))
    assert findings["baseline"]["noise_floor_rms"] is None


def test_interrupted_replays_keep_the_base(
    recordings: list[st.Recording], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(conclude, "surrogate_residuals", struck(conclude.surrogate_residuals))
    found = st.diagnose(PLANT, recordings, surrogates=4)
    assert begins_with_it(found)
    assert "The plant was fitted" in found.sentence
    assert found.baseline is not None


def test_what_was_not_looked_at_any_more_is_said(
    recordings: list[st.Recording], whole: st.Diagnosis, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("stiction.diagnosis.selection.rounds.Screening.trial", stopped)
    found = st.diagnose(PLANT, recordings, surrogates=4)
    assert begins_with_it(found)
    assert found.verdict == "not_testable"
    assert found.unexplained == ()
    assert "no effect of the catalogue explains" not in found.sentence
    reasons = {row.name: row.reason for row in found.candidates}
    assert reasons.keys() == {row.name for row in whole.candidates}
    assert reasons[whole.effects[0].name] == "not refitted: the diagnosis was interrupted"
    monkeypatch.setattr("stiction.diagnosis.selection.trials.screen", stopped)
    found = st.diagnose(PLANT, recordings, surrogates=4)
    reasons = {row.name: row.reason for row in found.candidates}
    assert reasons[whole.effects[0].name] == "not screened: the diagnosis was interrupted"


@pytest.mark.parametrize(
    "place",
    [
        "reject_without_machine",
        "residuals_of",
        "rest",
        "ceiling_of",
        "unnamed_remainder",
        "gain_of",
        "with_loop_replay",
    ],
)
def test_decisions_that_were_taken_are_concluded(
    place: str,
    recordings: list[st.Recording],
    whole: st.Diagnosis,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(conclude, place, struck(getattr(conclude, place)))
    found = st.diagnose(PLANT, recordings, surrogates=4)
    assert begins_with_it(found)
    assert "more may be missing" in found.sentence
    assert found.verdict in ("missing_effect", "ambiguous")
    assert [cause.name for cause in found.effects] == [cause.name for cause in whole.effects]
    assert found.gain == whole.gain
    # What noise would leave beside the names is not replayed any more.
    assert found.extended is not None
    assert whole.extended is not None
    floor = whole.extended.noise_floor_rms
    assert replace(found.extended, noise_floor_rms=floor) == whole.extended


def test_a_second_interruption_ends_at_once(
    recordings: list[st.Recording], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(conclude, "rest", struck(conclude.rest, times=2))
    with pytest.raises(KeyboardInterrupt):
        st.diagnose(PLANT, recordings, surrogates=4)


def test_rows_that_test_may_be_opened_after_an_opening_that_was_interrupted(
    recordings: list[st.Recording], whole: st.Diagnosis, monkeypatch: pytest.MonkeyPatch
) -> None:
    from stiction.diagnosis.data.evidence import Evidence

    rows = Evidence._rows

    def stopped(self: Evidence, *given: Any) -> Any:
        if stops and hasattr(self, "_weights"):
            stops.pop()
            raise KeyboardInterrupt
        return rows(self, *given)

    stops = [True]
    monkeypatch.setattr(Evidence, "_rows", stopped)
    found = st.diagnose(PLANT, recordings, surrogates=4)
    assert begins_with_it(found)
    assert found.gain == whole.gain
