"""Each way in which an answer can be lost is noticed; a whole answer is not called lost."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import pytest

from .gate import entries, kept
from .ordinary_table import report as ordinary_report
from .real import MACHINES, data_folder, machines
from .score import told
from .table import report
from .way import Answer, Loss, finite, judged, walked

FAMILIES = (
    *("planned null", "planned single", "planned pair", "planned foreign", "planned, left out"),
    *("ordinary null", "ordinary hidden", "servo", "moved", "data fault", "not testable"),
)
FAKE = """
import json, sys, time
from pathlib import Path

plan = json.loads((Path(__file__).parent / "plan.json").read_text())
verb, out = sys.argv[1], Path(sys.argv[sys.argv.index("--out") + 1])
out.mkdir(parents=True, exist_ok=True)
for name, text in plan[verb]["files"].items():
    (out / name).write_text(text)
print(plan[verb]["errors"], file=sys.stderr)
time.sleep(plan[verb]["seconds"])
sys.exit(plan[verb]["status"])
"""
MODEL = {
    "parameters": {"friction.coulomb": {"value": 0.2, "ci95": [0.1, None], "unit": "N·m"}},
    "train_rms": 0.01,
    "noise_floor_rms": 0.01,
}
FINDINGS: dict[str, Any] = {
    "schema": 1,
    "verdict": "nothing_missing",
    "sentence": "Nothing that counts is missing.",
    "effects": [],
    "gain": None,
    "candidates": [],
    "laws": [],
    "baseline": MODEL,
    "extended": MODEL,
    "unexplained": [],
    "advice": [],
    "data": {"split": {"test": [{"recording": 1, "name": "b.csv"}]}},
    "version": "0",
    "seed": 0,
    "seconds": 1.0,
}
PAGE = "<!doctype html><html><body><svg><path d='M0'/></svg><p>0.2<br>N·m</p></body></html>\n"
PLANT = '[friction]\nlaw = "coulomb"\ncoulomb = 0.2\nbreakaway = inf\n'
TRAJECTORY = "time_s,position_rad\n0.0,1.0\n0.001,1.5\n"
TRACEBACK = """warming up
Traceback (most recent call last):
  File "/x/stiction/cli/diagnose.py", line 12, in diagnose
  File "/x/stiction/report/figures.py", line 396, in _merged
    columns = np.array([part[seen] for part in parts])
  File "/x/stiction/report/figures.py", line 396, in <listcomp>
IndexError: boolean index did not match
"""


@pytest.fixture
def fake(tmp_path: Path):
    """Walks a session with a program that leaves what it is told to."""

    def walk(verb: str = "", files: dict[str, str | None] | None = None, **plan: Any) -> Answer:
        usual = {"status": 0, "errors": "", "seconds": 0.0}
        plans = {
            "diagnose": usual
            | {
                "files": {
                    "findings.json": json.dumps(FINDINGS),
                    "report.html": PAGE,
                    "plant.toml": PLANT,
                }
            },
            "simulate": usual | {"files": {"b-trajectory.csv": TRAJECTORY}},
        }
        if verb:
            changed = plans[verb]["files"] | (files or {})
            plans[verb]["files"] = {name: t for name, t in changed.items() if t is not None}
            plans[verb].update(plan)
        (tmp_path / "plan.json").write_text(json.dumps(plans), encoding="utf-8")
        (tmp_path / "fake.py").write_text(FAKE, encoding="utf-8")
        session = tmp_path / "session.toml"
        session.write_text(
            '[[recordings]]\nfile = "a.csv"\n[[recordings]]\nfile = "b.csv"\nstart_s = 2.0\n',
            encoding="utf-8",
        )
        command = (sys.executable, "-S", str(tmp_path / "fake.py"))
        return walked(session, tmp_path / "out", patience=5.0, command=command)

    return walk


def kinds(answer: Answer) -> list[str]:
    return [loss.kind for loss in answer.losses]


def without(*path: str) -> str:
    """The findings with null in one place."""
    found: Any = json.loads(json.dumps(FINDINGS))
    part = found
    for key in path[:-1]:
        part = part[key]
    part[path[-1]] = None
    return json.dumps(found)


def test_a_whole_answer_is_not_lost(fake, tmp_path: Path) -> None:
    answer = fake()
    assert answer.losses == ()
    assert answer.findings == FINDINGS
    assert 'file = "b.csv"' in (tmp_path / "tested.toml").read_text(encoding="utf-8")
    assert "a.csv" not in (tmp_path / "tested.toml").read_text(encoding="utf-8")


def test_a_traceback_is_lost_and_counted_by_where_it_is(fake) -> None:
    nothing = dict.fromkeys(("findings.json", "report.html", "plant.toml"))
    answer = fake("diagnose", nothing, errors=TRACEBACK, status=1)
    assert kinds(answer) == ["traceback IndexError report/figures.py _merged"]
    assert answer.findings is None


@pytest.mark.parametrize(
    ("status", "errors", "kind"),
    [
        (2, "plant.toml: nan is not a number", "refused"),
        (1, "", "exit 1"),
        (-11, "", "exit -11"),
        (0, "thread 'main' panicked at src/lib.rs:3:5", "traceback panic outside"),
        (0, "The figure errors could not be made (KeyError: 'x'); all else is here.", "page"),
        (0, "looking through 3 recordings", None),
    ],
)
def test_what_the_command_says_of_itself_is_heard(status, errors, kind) -> None:
    assert [loss.kind for loss in judged(status, errors)] == ([kind] if kind else [])


def test_a_command_that_does_not_end_is_lost(tmp_path: Path) -> None:
    sleeper = tmp_path / "sleeper.py"
    sleeper.write_text("import time; time.sleep(30)", encoding="utf-8")
    command = (sys.executable, "-S", str(sleeper))
    answer = walked(tmp_path / "session.toml", tmp_path / "out", patience=0.2, command=command)
    assert kinds(answer) == ["time"]


@pytest.mark.parametrize(
    ("name", "text", "kind", "what"),
    [
        ("findings.json", None, "findings.json", "missing"),
        ("findings.json", "{", "findings.json", "strict"),
        ("findings.json", json.dumps(FINDINGS | {"seconds": float("nan")}), "findings.json", "NaN"),
        (
            "findings.json",
            json.dumps(FINDINGS).replace('"seconds": 1.0', '"seconds": 1e999'),
            "findings.json",
            ".seconds is not finite",
        ),
        ("findings.json", json.dumps(FINDINGS | {"schema": 2}), "findings.json", "schema 2"),
        ("findings.json", json.dumps({"schema": 1}), "findings.json", "verdict is not there"),
        ("findings.json", without("baseline"), "findings.json", "baseline is not there"),
        ("findings.json", without("extended", "train_rms"), "findings.json", "train_rms"),
        (
            "findings.json",
            without("baseline", "parameters", "friction.coulomb", "value"),
            "findings.json",
            "friction.coulomb has no value",
        ),
        ("report.html", None, "page", "missing"),
        ("report.html", PAGE[:60], "page", "ends within"),
        ("report.html", PAGE.replace("</p>", ""), "page", "closes <p>"),
        ("report.html", PAGE.replace("0.2", "nan"), "page", "nan"),
        (
            "report.html",
            PAGE.replace("<p>", '<p role="note">The figure errors could not be made.</p><p>'),
            "page",
            "hole: The figure errors",
        ),
        ("plant.toml", None, "plant.toml", "missing"),
        ("plant.toml", "[friction", "plant.toml", "read"),
        ("plant.toml", PLANT.replace("0.2", "nan"), "plant.toml", "friction.coulomb"),
    ],
)
def test_a_file_that_is_missing_or_broken_is_lost(fake, name, text, kind, what) -> None:
    answer = fake("diagnose", {name: text})
    assert set(kinds(answer)) == {kind}
    assert any(what in loss.what for loss in answer.losses)


@pytest.mark.parametrize(
    ("change", "kind"),
    [
        ({"status": 2, "errors": "it cannot"}, "again: refused"),
        (
            {"errors": TRACEBACK, "status": 1},
            "again: traceback IndexError report/figures.py _merged",
        ),
        ({"files": {"b-trajectory.csv": None}}, "again: files"),
        ({"files": {"b-trajectory.csv": TRAJECTORY.replace("1.5", "nan")}}, "again: not finite"),
    ],
)
def test_an_extended_plant_that_does_not_simulate_is_lost(fake, change, kind) -> None:
    assert kinds(fake("simulate", **change)) == [kind]


@pytest.mark.parametrize(
    ("text", "whole"),
    [
        (TRAJECTORY, True),
        ("time_s,position_rad\n", False),
        (TRAJECTORY.replace("1.0", "inf"), False),
        (TRAJECTORY.replace("1.0", ""), False),
    ],
)
def test_a_trajectory_is_finite_in_every_cell(tmp_path: Path, text: str, whole: bool) -> None:
    path = tmp_path / "trajectory.csv"
    path.write_text(text, encoding="utf-8")
    assert finite(path) is whole


def test_tables_begin_with_what_was_lost() -> None:
    lost = told(Answer(Path(), None, (Loss("traceback IndexError", "…"), Loss("page", "…"))))
    good = told(Answer(Path(), FINDINGS))
    about = {"names": [], "classes": [], "hidden": [], "kind": "null", "base": "coulomb", "seed": 1}
    rows = [about | lost, about | good | {"clair": 0.0, "intervals": []}]
    lines = report(rows).splitlines()
    assert lines[2].startswith("| **lost**: no whole answer | 1/2 = 50.0 %")
    assert lines[3] == "| lost: traceback IndexError | 1 |"
    assert "| null: a confident name | 0/1 = 0.0 % (0.0–79.3) |" in lines
    spec = {"law": "coulomb", "contact": "dry", "recordings": 1, "dt": 1e-3, "counts": 1024}
    spec |= {"log_noise": 0.0, "loop": "open", "drive": "torque", "kind": "driven"}
    for row in rows:
        row |= {"spec": spec, "reached": 0.0}
    lines = ordinary_report(rows).splitlines()
    assert lines[2].startswith("| **lost**: no whole answer | 1/2 = 50.0 %")
    assert "| right: nothing is missing | 1/1 = 100.0 % (20.7–100.0) |" in lines


def test_of_what_was_recorded_twice_the_gate_takes_one_and_all_of_it_in_turn(tmp_path) -> None:
    for machine in MACHINES:
        (tmp_path / machine.folder).mkdir(exist_ok=True)
    first, second = (set(machines(tmp_path, turn)) for turn in (0, 1))
    assert first | second == set(machines(tmp_path)) == set(MACHINES)
    assert {machine.turn for machine in first & second} == {None}
    assert len(first) == len(second)
    (tmp_path / "emps").rmdir()
    assert "emps" not in {machine.name for machine in machines(tmp_path)}


def test_the_gate_has_every_family_and_is_the_same_again() -> None:
    names = [entry.name for entry in entries(7)]
    assert names == [entry.name for entry in entries(7)]
    assert names != [entry.name for entry in entries(8)]
    assert len(set(names)) == len(names)
    real = {machine.name for machine in machines(data_folder())} | {e.name for e in kept()}
    fresh = [name for name in names if name not in real]
    assert len(fresh) >= 24
    for family in FAMILIES:
        assert any(name.startswith(family) for name in fresh), family
