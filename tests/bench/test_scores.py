"""Answers are read or refused in a sentence, and counted as by hand."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import stiction as st
from stiction.bench import SCHEMA, VERDICTS, run, score
from stiction.bench import entry as entry_module
from stiction.bench.format import BENCH_FORMAT
from stiction.bench.layout import seal_of
from stiction.bench.rates import calibration, wilson
from stiction.bench.read import Answer, answer_file

SILENCE = {"verdict": "nothing_missing", "effects": []}


def hidden(name: str, family: str, size: float, *same_as: str) -> dict[str, Any]:
    return {"name": name, "class": family, "size": size, "same_as": list(same_as)}


TRUTHS = {
    1: ("null", None),
    2: ("null", None),
    3: ("hidden", hidden("cogging", "cogging", 0.02)),
    4: ("hidden", hidden("torque_bias", "offset", 0.05, "direction_asymmetry")),
    5: ("hidden", hidden("stribeck", "breakaway", 0.2)),
    6: ("hidden", hidden("backlash", "backlash", 0.2)),
    7: ("law", None),
    8: ("untestable", None),
}


def one(name: str, decided: bool = True, **more: Any) -> dict[str, Any]:
    return {"name": name, "decided": decided, **more}


ANSWERS = {
    1: SILENCE,
    # Nothing is missing: a sure name is wrong.
    2: {"verdict": "missing_effect", "effects": [one("stribeck", probability=0.9)]},
    3: {"verdict": "missing_effect", "effects": [one("cogging", probability=0.9)]},
    # As right as torque_bias, for no recording tells them apart.
    4: {"verdict": "missing_effect", "effects": [one("direction_asymmetry", probability=0.7)]},
    5: {"verdict": "ambiguous", "effects": [one("dwell_strengthening", False, probability=0.3,
                                                look_alikes=["stribeck"])]},
    # Session 6 has no answer.
    7: {"verdict": "unexplained", "effects": [one("drive_deadband")]},
    8: {"verdict": "not_testable", "effects": []},
}  # fmt: skip


@pytest.fixture
def bench(tmp_path: Path) -> Path:
    """A bench whose truth was written by hand; its sessions hold no data."""
    where = tmp_path / "bench"
    (where / "truth").mkdir(parents=True)
    for k, (case, missing) in TRUTHS.items():
        text = json.dumps({"case": case, "hidden": missing})
        (where / "truth" / f"session_{k:04d}.json").write_text(text)
    names = {f"session_{k:04d}": "0" for k in TRUTHS}
    seal = seal_of(where / "truth")
    manifest = {"format": BENCH_FORMAT, "truth_sha256": seal, "sessions_sha256": names}
    (where / "bench.json").write_text(json.dumps(manifest))
    return where


@pytest.fixture
def answers(tmp_path: Path) -> Path:
    return laid(tmp_path / "answers", ANSWERS)


def laid(folder: Path, answers: dict[int, Any]) -> Path:
    folder.mkdir()
    for k, each in answers.items():
        (folder / f"session_{k:04d}.json").write_text(json.dumps(each))
    return folder


def rates(found: dict[str, Any], title: str) -> dict[str, tuple[int, int]]:
    return {each["what"]: (each["count"], each["number"]) for each in found["rates"][title]}


def test_rates_are_those_that_are_counted_by_hand(bench: Path, answers: Path) -> None:
    found = score(bench, answers).to_dict()
    assert rates(found, "All 8 sessions") == {
        "no answer": (1, 8),
        # Session 2; what session 7 names it does not stand by.
        "a sure and wrong name": (1, 8),
    }
    assert rates(found, "Nothing is missing") == {
        "a name": (1, 2),
        "a sure name": (1, 2),
        "unexplained": (0, 2),
        "not testable": (0, 2),
        "silence: nothing is missing": (1, 2),
    }
    assert rates(found, "One effect is missing") == {
        "named": (2, 4),
        # That of session 5 is its class as well, whatever the effect's name.
        "its class": (3, 4),
        "among names and look-alikes": (3, 4),
        "a sure and wrong name": (0, 4),
        "ambiguous": (1, 4),
        "unexplained": (0, 4),
        "silence: nothing is missing": (0, 4),
        "not testable": (0, 4),
    }
    sizes = ("0 to 3 %", "3 to 10 %", "10 % or more")
    named = [rates(found, f"The same, {each} of the dry friction")["named"] for each in sizes]
    assert named == [(1, 1), (1, 1), (0, 2)]
    law = rates(found, "Another law is stated")
    assert law["a name"] == law["unexplained"] == (1, 1)
    assert law["a sure name"] == (0, 1)
    assert rates(found, "The data tell nothing")["not testable"] == (1, 1)
    by_effect = {each["what"]: (each["count"], each["number"]) for each in found["by_effect"]}
    assert by_effect == {"backlash": (0, 1), "cogging": (1, 1), "stribeck": (0, 1),
                         "torque_bias": (1, 1)}  # fmt: skip
    assert found["names_told_mean"] == pytest.approx((1 + 1 + 1 + 2 + 1) / 5)


def test_probabilities_are_scored_as_by_hand(bench: Path, answers: Path) -> None:
    held = score(bench, answers).calibration
    assert held is not None
    # .9 wrong, .9 right, .7 right, .3 wrong.
    assert held.number == 4
    assert held.brier == pytest.approx((0.81 + 0.01 + 0.09 + 0.09) / 4)
    assert held.base_rate_brier == pytest.approx(0.25)
    assert [(low, r.count, r.number) for low, _, _, r in held.bins] == [
        (0.2, 0, 1), (0.6, 1, 1), (0.8, 1, 2)
    ]  # fmt: skip
    assert held.error == pytest.approx((1 * 0.3 + 1 * 0.3 + 2 * 0.4) / 4)
    assert calibration([]) is None
    assert calibration([(1.0, True), (0.0, False)]).brier == 0.0  # type: ignore[union-attr]


def test_intervals_are_those_of_wilson() -> None:
    # Brown, Cai and DasGupta 2001: 0 of 10 has 3.84 / 13.84 as its upper end.
    assert wilson(0, 10) == (0.0, pytest.approx(0.2775, abs=1e-4))
    assert wilson(5, 10) == (pytest.approx(0.2366, abs=1e-4), pytest.approx(0.7634, abs=1e-4))
    assert wilson(0, 0) == (0.0, 1.0)


def test_text_page_and_json_tell_the_same(bench: Path, answers: Path) -> None:
    found = score(bench, answers)
    for text in (str(found), found.to_markdown()):
        assert "2/4 = 50.0 % (15.0 to 85.0)" in text
        assert "Brier score" in text
        # What no session is of has no row.
        assert "nan" not in text.lower()
    data = json.loads(found.to_json())
    assert [each["session"] for each in data["sessions"]] == [f"session_{k:04d}" for k in TRUTHS]
    assert data["sessions"][5]["verdict"] == "no answer"


def test_who_names_everything_is_seen_by_its_length(bench: Path, tmp_path: Path) -> None:
    every = [record.name for record in st.effects()]
    broad = {"verdict": "ambiguous", "effects": [one(every[0], False, look_alikes=every[1:])]}
    found = score(bench, laid(tmp_path / "broad", dict.fromkeys(TRUTHS, broad)))
    told = found.to_dict()
    assert rates(told, "One effect is missing")["among names and look-alikes"] == (4, 4)
    assert rates(told, "One effect is missing")["its class"] == (0, 4)
    assert told["names_told_mean"] == len(every)


def test_findings_of_the_package_are_answers(tmp_path: Path) -> None:
    from tests.report.canned import diagnosis

    path = tmp_path / "session_0001.json"
    for verdict, names in (("missing_effect", 1), ("nothing_missing", 0)):
        path.write_text(diagnosis(verdict, names=names).to_json())
        read = answer_file(path)
        assert read.verdict == verdict
        assert len(read.effects) == names
        assert all(each.decided for each in read.effects)
    fault = {"schema": 1, "verdict": "data_fault", "effects": [], "sentence": "constant"}
    path.write_text(json.dumps(fault))
    assert answer_file(path) == Answer("not_testable")


def test_the_schema_is_what_is_read() -> None:
    verdicts = [each["const"] for each in SCHEMA["properties"]["verdict"]["oneOf"]]
    assert verdicts == list(VERDICTS)
    assert set(SCHEMA["properties"]) == {"verdict", "effects", "seconds"}


# ruff: noqa: E501 (a fault and its sentence, side by side)
GARBAGE = {
    "": "is no JSON",
    "{": "is no JSON",
    "[]": "write an object with verdict and effects",
    "3": "write an object",
    "\ufeff{}": "verdict is missing",
    "[" * 100000: "is nested too deep",
    '{"verdict": NaN, "effects": []}': "NaN is no number of JSON",
    '{"verdict": "ambiguous", "verdict": "ambiguous"}': "'verdict' stands twice",
    '{"verdict": "nothing_missing"}': "effects is missing; write it",
    '{"verdict": "nothing_mising", "effects": []}': "did you mean 'nothing_missing'?",
    '{"verdict": "data_fault", "effects": []}': "verdict = 'data_fault' is unknown",
    '{"verdict": 7, "effects": []}': "verdict = 7 is unknown",
    '{"verdict": ["ambiguous"], "effects": []}': "is unknown; write one of nothing_missing",
    '{"verdict": "nothing_missing", "effects": {}}': "effects = {} is no list",
    '{"verdict": "nothing_missing", "effects": [], "effect": 1}': "(did you mean 'effects'?)",
    '{"verdict": "nothing_missing", "effects": [], "seconds": -1}': "seconds = -1",
    '{"verdict": "missing_effect", "effects": ["cogging"]}': "effects[0] is 'cogging'; write an obj",
    '{"verdict": "missing_effect", "effects": [{"name": "a"}]}': "effects[0]: decided is missing",
    '{"verdict": "missing_effect", "effects": [{"name": "", "decided": true}]}': "no name of an eff",
    '{"verdict": "missing_effect", "effects": [{"name": "a", "decided": 1}]}': "write true or false",
    '{"verdict": "missing_effect", "effects": []}': "does not go with effects nothing; name an eff",
    '{"verdict": "missing_effect", "effects": [{"name": "a", "decided": false}]}': "have all decided",
    '{"verdict": "ambiguous", "effects": [{"name": "a", "decided": true}]}': "decided = false, or",
    '{"verdict": "not_testable", "effects": [{"name": "a", "decided": true}]}': "leave effects empty",
    '{"schema": 2, "verdict": "ambiguous", "effects": []}': "schema = 2 is no findings.json",
    '{"schema": 1, "verdict": "ambigous", "effects": []}': "did you mean 'ambiguous'?",
}
OF_EFFECTS = {
    '"probability": 1.01': "probability = 1.01 is out of bounds",
    '"probability": "high"': "write a number from 0 to 1",
    '"probability": true': "probability = True is out of bounds",
    '"probability": 1e999': "probability = inf is out of bounds",
    '"look_alikes": "b"': "look_alikes = 'b' is no list",
    '"look_alikes": [1]': "look_alikes[0] = 1 is no name",
    '"parameters": [1]': "parameters = [1] is no object",
    '"parameters": {"gain": "big"}': "parameters.gain = 'big' is no number",
    '"probabilty": 0.5': "(did you mean 'probability'?)",
}


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        *GARBAGE.items(),
        *(
            (
                f'{{"verdict": "missing_effect", "effects": [{{"name": "a", "decided": true, {k}}}]}}',
                v,
            )
            for k, v in OF_EFFECTS.items()
        ),
    ],
)
def test_garbage_ends_in_one_sentence(text: str, sentence: str, tmp_path: Path) -> None:
    path = tmp_path / "session_0001.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(st.InputError) as told:
        answer_file(path)
    said = str(told.value)
    assert sentence in said
    assert said.startswith(str(path))
    assert "\n" not in said
    assert len(said) < 500


def test_what_is_no_text_or_too_large_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "session_0001.json"
    path.write_bytes(b"\xff\xfe{}")
    with pytest.raises(st.InputError, match="is no text in UTF-8"):
        answer_file(path)
    with path.open("wb") as file:
        file.truncate(65 << 20)
    with pytest.raises(st.InputError, match="67108864 are allowed"):
        answer_file(path)
    with pytest.raises(st.InputError, match="cannot be read"):
        answer_file(tmp_path)


def test_a_bench_that_is_none_or_was_changed_is_refused(
    bench: Path, answers: Path, tmp_path: Path
) -> None:
    with pytest.raises(st.InputError, match=r"bench.json is not there"):
        score(tmp_path, answers)
    with pytest.raises(st.InputError, match="no folder with answers"):
        score(bench, tmp_path / "none")
    with pytest.raises(st.InputError, match="holds no answer; write session_0001"):
        score(bench, bench)
    (answers / "session_0009.json").write_text(json.dumps(SILENCE))
    with pytest.raises(st.InputError, match="no such session; it has session_0001 to session_0008"):
        score(bench, answers)
    (answers / "session_0009.json").unlink()
    (bench / "truth" / "session_0001.json").write_text('{"case": "hidden"}')
    with pytest.raises(st.InputError, match="is not the truth that the bench was laid out with"):
        score(bench, answers)
    (bench / "truth").rename(tmp_path / "kept")
    with pytest.raises(st.InputError, match="the truth is not there"):
        score(bench, answers)
    (bench / "bench.json").write_text('{"format": "stiction-bench 9"}')
    with pytest.raises(st.InputError, match="format is 'stiction-bench 9' and not"):
        score(bench, answers)


class Found:
    """What a diagnosis returns, as far as an entry looks at it."""

    success, verdict = True, "nothing_missing"

    def to_json(self) -> str:
        return json.dumps({"schema": 1, **SILENCE})


def test_a_run_goes_on_after_a_refusal_and_where_it_was_interrupted(
    bench: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[str] = []

    def diagnosed(_: None, session: str, threads: int | None) -> Found:
        seen.append(session)
        if session == "session_0002":
            raise st.InputError("session_0002: cannot be read")
        if seen.count("session_0004") == 1 and session == "session_0004":
            raise KeyboardInterrupt
        return Found()

    monkeypatch.setattr(entry_module, "diagnose", diagnosed)
    monkeypatch.setattr(entry_module.sessions, "load", lambda path, **_: path.parent.name)
    answers = tmp_path / "answers"
    with pytest.raises(KeyboardInterrupt):
        run(bench, answers)
    assert sorted(path.stem for path in answers.iterdir()) == ["session_0001", "session_0003"]
    said = run(bench, answers)
    assert said["session_0002"] == "session_0002: cannot be read"
    assert list(said) == ["session_0002", *(f"session_{k:04d}" for k in range(4, 9))]
    assert rates(score(bench, answers).to_dict(), "All 8 sessions")["no answer"] == (1, 8)


def test_an_interrupted_diagnosis_is_no_answer(
    bench: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    half = Found()
    half.success = False
    monkeypatch.setattr(entry_module, "diagnose", lambda *_, **__: half)
    monkeypatch.setattr(entry_module.sessions, "load", lambda path, **_: path.parent.name)
    with pytest.raises(KeyboardInterrupt):
        run(bench, tmp_path / "answers")
    assert list((tmp_path / "answers").iterdir()) == []
