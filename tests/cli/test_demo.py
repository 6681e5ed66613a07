"""The demo: what ships with the package is diagnosed, and is what the reference plant makes."""

from __future__ import annotations

import json
from contextlib import redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.reference import make_demo_session

from stiction import Diagnosis, Plant, demo_session, diagnose, effects
from stiction.cli import run
from stiction.cli.paper_sections import Section
from stiction.paper import stick_slip

SLOWEST = 20.0  # s, of the diagnosis on two cores
LARGEST = 2_000_000  # bytes, of all files that ship


@dataclass(frozen=True)
class Demo:
    """What one run of the demo left."""

    found: Diagnosis
    folder: Path
    text: str
    findings: dict[str, Any]


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> Demo:
    folder = tmp_path_factory.mktemp("demo") / "out"
    printed, kept = StringIO(), []

    def keeping(*given: Any) -> Diagnosis:
        kept.append(diagnose(*given))
        return kept[-1]

    with pytest.MonkeyPatch.context() as patch, redirect_stdout(printed):
        patch.setattr("stiction.diagnosis.diagnose", keeping)
        assert run(["demo", "--out", str(folder)]) == 0
    findings = json.loads((folder / "findings.json").read_text(encoding="utf-8"))
    return Demo(kept[0], folder, printed.getvalue(), findings)


@pytest.fixture(scope="module")
def laid_out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("copy") / "my-motor"
    with redirect_stdout(StringIO()):
        assert run(["demo", "--copy", str(folder)]) == 0
    return folder


# --- the diagnosis


def test_the_hidden_effect_is_named_and_measured(demo: Demo) -> None:
    assert demo.findings["verdict"] == "missing_effect"
    (effect,) = demo.findings["effects"]
    assert effect["name"] == make_demo_session.HIDDEN
    assert effect["class"] == "breakaway"
    assert effect["decided"]
    low, high = demo.findings["gain"]["ci95"]
    assert 0.2 < low < high < 1.0
    velocity = effect["parameters"]["effects.stribeck.velocity"]["value"]
    assert velocity == pytest.approx(make_demo_session.SHAPE["velocity"], rel=0.15)
    # What was tried and not fitted makes the cause whole.
    whole = {*effect["parameters"], *demo.findings["data"]["chosen"]}
    record = next(each for each in effects() if each.name == effect["name"])
    assert {f"effects.{effect['name']}.{p.name}" for p in record.parameters} == whole


def test_it_is_quick(demo: Demo) -> None:
    assert demo.findings["seconds"] < SLOWEST


def test_it_prints_finding_gain_candidates_and_where_the_report_is(demo: Demo) -> None:
    for words in (
        demo.findings["sentence"],
        "95 %",
        "stribeck: friction falls",
        "accepted",
        f"what was hidden: {demo_session.hidden()}",
        f"report: {demo.folder / 'report.html'}",
        "stiction demo --copy",
    ):
        assert words in demo.text


def test_report_figures_and_a_plant_that_simulates_are_written(demo: Demo) -> None:
    assert (demo.folder / "report.html").stat().st_size > 10_000
    assert len(list((demo.folder / "figures").glob("*.svg"))) > 2
    plant = Plant.load(demo.folder / "plant.toml")
    assert [effect.name for effect in plant.effects] == ["stribeck"]
    assert plant.simulate(np.full(100, 0.4), 1e-3).position[-1] > 0.0


def test_json_is_all_that_json_prints(
    demo: Demo,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("stiction.diagnosis.diagnose", lambda *given: demo.found)
    assert run(["demo", "--json", "-o", str(tmp_path)]) == 0
    assert json.loads(capsys.readouterr().out) == demo.findings


# --- the copy


def alike(findings: dict[str, Any]) -> str:
    """Findings without what two equal runs do not share; recordings are CSV in the copy."""
    kept = {key: value for key, value in findings.items() if key != "seconds"}
    return json.dumps(kept).replace(".npz", ".csv")


def test_the_copy_gives_the_same_findings(
    demo: Demo, laid_out: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    session = str(laid_out / "session.toml")
    assert run(["diagnose", session, "--json", "-o", str(tmp_path)]) == 0
    assert alike(json.loads(capsys.readouterr().out)) == alike(demo.findings)


def test_the_copy_can_be_read_and_says_what_comes_next(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "new" / "my-motor"
    assert run(["demo", "--copy", str(folder)]) == 0
    told = capsys.readouterr().out.splitlines()[-1]
    assert told.startswith("next: stiction diagnose ")
    assert str(folder / "session.toml") in told
    texts = {path.name for path in folder.iterdir() if path.is_file()}
    assert texts == {"session.toml", "plant.toml", "README.txt", "what-is-hidden.txt"}
    first = min((folder / "recordings").iterdir())
    head, row, *_ = first.read_text(encoding="utf-8").splitlines()
    assert head == "time_s,torque_nm,position_counts"
    assert row.rpartition(",")[2].lstrip("-").isdigit()


def test_the_copy_overwrites_nothing(laid_out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    # The last of the files alone is enough to refuse, and then none of the others is written.
    mine = laid_out / "recordings" / "18_sines_select.csv"
    files = [path for path in laid_out.rglob("*") if path.is_file()]
    kept = {path: path.read_bytes() for path in files}
    for path in files:
        if path != mine:
            path.unlink()
    mine.write_text("mine")
    assert run(["demo", "--copy", str(laid_out)]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "is there already and is not overwritten" in captured.err
    assert captured.err.count("\n") == 1
    assert [path for path in laid_out.rglob("*") if path.is_file()] == [mine]
    assert mine.read_text() == "mine"
    for path, content in kept.items():
        path.write_bytes(content)


def test_a_folder_that_cannot_be_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "taken").write_text("")
    assert run(["demo", "--copy", str(tmp_path / "taken")]) == 2
    captured = capsys.readouterr()
    assert "taken" in captured.err
    assert captured.err.count("\n") == 1


def test_the_copy_answers_in_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["demo", "--copy", str(tmp_path / "m"), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert len(answer["files"]) == 22
    assert all(Path(file).exists() for file in answer["files"])


# --- the files that ship


@pytest.fixture(scope="module")
def made() -> Any:
    return make_demo_session.make()


def test_what_ships_is_small() -> None:
    files = [path for path in make_demo_session.FOLDER.rglob("*") if path.is_file()]
    assert sum(path.stat().st_size for path in files if path.suffix != ".pyc") < LARGEST


def test_recordings_are_those_that_the_reference_plant_makes(made: Any) -> None:
    tables = make_demo_session.tables(made)
    shipped = (make_demo_session.FOLDER / "recordings").glob("*.npz")
    assert sorted(tables) == sorted(f"recordings/{path.name}" for path in shipped)
    for file, columns in tables.items():
        with np.load(make_demo_session.FOLDER / file) as stored:
            assert list(stored) == list(columns)
            off = {name: np.abs(stored[name] - values) for name, values in columns.items()}
        assert off["time_s"].max() < 1e-9, file
        counts, torque = off["position_counts"], off["torque_nm"]
        assert counts.max() <= 1, file
        # Another processor may round a count the other way, which the controller answers for as
        # long as its integral remembers: up to that row nothing differs, and after it little.
        alike = int(np.argmax(counts > 0)) if counts.any() else len(counts)
        assert torque[:alike].max(initial=0.0) < 1.01 * 10.0**-make_demo_session.TORQUE_DIGITS, file
        whole = np.ptp(columns["torque_nm"])
        assert torque.max() < 0.01 * whole, file
        assert np.sqrt(np.mean(torque**2)) < 0.001 * whole, file


def test_texts_are_those_that_the_script_writes(made: Any) -> None:
    for name, text in make_demo_session.texts(made).items():
        assert (make_demo_session.FOLDER / name).read_text(encoding="utf-8") == text, name


# --- what the demo ran before


def test_the_paper_shows_how_stick_slip_ends(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    slow = Section("stick-slip", stick_slip(0.1, duration=1.0), ())
    monkeypatch.setattr("stiction.cli.paper_sections.paper_command", lambda out: [slow])
    assert run(["paper", "-o", str(tmp_path)]) == 0
    assert "slides smoothly after 1 break-away" in capsys.readouterr().out
    assert (tmp_path / "smooth-sliding.svg").exists()
    numbers = json.loads((tmp_path / "numbers.json").read_text(encoding="utf-8"))
    assert [e["name"] for e in numbers["experiments"]] == ["stick-slip", "smooth-sliding"]
