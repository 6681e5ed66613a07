"""``stiction bench`` on the command line: laid out, diagnosed, scored, refused in a sentence."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from stiction.bench import layout
from stiction.cli import run

MAKE = ["bench", "make", "mine", "--number", "2", "--seconds", "4,5", "--seed", "12"]


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_a_bench_is_laid_out_answered_and_scored(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(MAKE) == 0
    said = capsys.readouterr()
    assert "laid out 2 sessions in mine" in said.out
    assert "hand the rest out without it" in said.out
    assert run(["bench", "run", "mine", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["answers"] == "mine-answers"
    assert list(data["sessions"]) == ["session_0001", "session_0002"]
    found = json.loads(Path("mine-answers/session_0001.json").read_text())
    assert found["verdict"] == data["sessions"]["session_0001"]
    # All are answered: nothing is diagnosed again.
    assert run(["bench", "run", "mine", "-o", "mine-answers", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["sessions"] == {}
    assert run(["bench", "score", "mine", "mine-answers", "-o", "scores"]) == 0
    assert "All 2 sessions" in capsys.readouterr().out
    scores = json.loads(Path("scores/scores.json").read_text())
    assert scores["rates"]["All 2 sessions"][0]["count"] == 0
    assert "| no answer (low is good) | 0/2 = 0.0 %" in Path("scores/scores.md").read_text()
    assert run(["bench", "score", "mine", "mine-answers", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == scores


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (
            ["bench", "mak"],
            "bench: there is no verb 'mak' (did you mean 'make'?); there are make, run",
        ),
        (["bench", "make"], "bench make: WHERE is missing; write stiction bench make WHERE"),
        (["bench", "score", "mine"], "bench score: ANSWERS is missing"),
        (["bench", "make", "m", "--number", "some"], "--number = some is not a whole number"),
        (["bench", "make", "m", "--seconds", "20"], "--seconds = 20 is no pair"),
        (["bench", "make", "m", "--seconds", "a,b"], "--seconds = a,b is no pair"),
        (
            ["bench", "make", "m", "--cases", "nul"],
            "there is no case 'nul'; there are null, hidden",
        ),
        (["bench", "make", "m", "--case", "null"], "no option --case (did you mean '--cases'?)"),
        (["bench", "make", "file"], "file: cannot be made a folder"),
        (["bench", "make", "file/deeper"], "file/deeper: cannot be"),
        (["bench", "make", 300 * "a"], "cannot be"),
        (["bench", "run", "nothing"], "bench.json is not there; name a folder that stiction bench"),
        (["bench", "score", "nothing", "file"], "bench.json is not there"),
        (["bench", "score", "nothing", "file", "-o", "file"], "file: cannot be made a folder"),
    ],
)
def test_what_cannot_be_done_is_one_sentence(
    arguments: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("file").write_text("mine\n")
    assert run(arguments) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert sentence in said.err
    assert Path("file").read_text() == "mine\n"


def test_an_interrupted_layout_says_so_and_goes_on(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(made: object, folder: Path) -> None:
        (folder / "session.toml").write_text("half of it")
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(layout, "write", interrupted)
        assert run(MAKE) == 130
    assert capsys.readouterr().err == "interrupted\n"
    assert [path.name for path in Path("mine").iterdir()] == ["truth"]
    assert run(MAKE) == 0
    assert (Path("mine") / "session_0002" / "session.toml").is_file()
    assert not list(Path("mine").glob(".stiction-*"))
