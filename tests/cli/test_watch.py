"""``stiction watch``: goes on when recordings come in."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from tests.cli.test_from_a_file import three
from tests.cli.test_init import refused, write

from stiction.cli import run


@pytest.fixture
def logs(tmp_path: Path) -> Path:
    folder = tmp_path / "logs"
    folder.mkdir()
    three(folder)
    return folder


def once(logs: Path, *words: str) -> int:
    out = str(logs.parent / "out")
    return run(["watch", str(logs), "--once", "--surrogates", "4", "-o", out, *words])


def findings(logs: Path) -> dict[str, object]:
    content: dict[str, object] = json.loads((logs.parent / "out" / "findings.json").read_text())
    return content


def test_what_is_added_is_held_against_the_diagnosis_and_a_change_makes_a_new_one(
    logs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert once(logs) == 0
    assert capsys.readouterr().out.startswith("columns: ")
    first = findings(logs)
    # Nothing new, nothing done.
    assert once(logs) == 0
    assert capsys.readouterr().out == ""
    write(logs / "run7.csv", seed=7)
    assert once(logs) == 0
    assert "run7.csv" in capsys.readouterr().out
    more = findings(logs)
    assert [Path(each["recording"]).name for each in more["added"]] == ["run7.csv"]
    assert more["baseline"] == first["baseline"]
    assert once(logs) == 0
    assert capsys.readouterr().out == ""
    write(logs / "run1.csv", seed=11)
    assert once(logs) == 0
    assert capsys.readouterr().out.startswith("columns: ")
    whole = findings(logs)
    assert "added" not in whole
    assert len(whole["data"]["hashes"]) == 4


def test_it_waits_until_a_file_stays_as_it_is_and_ends_at_ctrl_c(
    logs: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    looked: list[int] = []
    waits = iter(range(9))

    def wait(_: float) -> None:
        step = next(waits)
        if step == 0:
            write(logs / "run8.csv", seed=8)
        if step == 5:
            raise KeyboardInterrupt

    monkeypatch.setattr("stiction.cli.watch._look", lambda directory, *_, **__: looked.append(
        len(list(directory.iterdir()))))  # fmt: skip
    monkeypatch.setattr("stiction.cli.watch.time.sleep", wait)
    assert run(["watch", str(logs), "-o", str(logs.parent / "out")]) == 0
    assert looked == [4]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["run0.csv"], "is no folder"),
        ([".", "--every", "0"], "--every"),
        ([".", "-o", "."], "is the folder that is watched"),
        (["nothing", "--once"], "no recording in this folder"),
    ],
)
def test_what_cannot_be_watched_is_one_sentence(
    words: list[str],
    told: str,
    logs: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(logs)
    Path("nothing").mkdir()
    assert told in refused(["watch", *words], capsys)
