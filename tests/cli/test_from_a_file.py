"""``stiction diagnose motor.csv``: from a recording to an answer, with what it assumed."""

from __future__ import annotations

import json
import os
import tomllib
from pathlib import Path

import pytest
from tests.cli.test_init import refused, write

import stiction as st
from stiction.cli import run

# Few effects are tried: the way to an answer is looked at, not the answer.
FEW = [
    word
    for effect in st.effects()
    if effect.name != "torque_bias"
    for word in ("--without", effect.name)
]


def three(folder: Path, names: tuple[str, ...] = ("t", "i", "theta")) -> list[Path]:
    """As many as can be fitted, decided on and tested."""
    return [write(folder / f"run{seed}.csv", names, seed=seed) for seed in range(3)]


def diagnosed(*words: object) -> int:
    return run(["diagnose", *map(str, words), "--surrogates", "4", *FEW])


def test_a_recording_alone_is_drafted_and_diagnosed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert diagnosed(*three(tmp_path), "-o", out) == 0
    said = capsys.readouterr().out
    columns, plant, sampling = said.splitlines()[:3]
    for told in ("time = t [s]", "input = i [A]", "position = theta [rad]"):
        assert told in columns
    assert "gain unknown" in plant
    assert "--gain states the N·m/A" in plant
    assert "law coulomb" in plant
    assert "every 1 ms, 9 s in 3 recordings" in sampling
    assert (out / "findings.json").exists()
    drafted = tomllib.loads((out / "draft" / "plant.toml").read_text("utf-8"))
    assert "gain" not in drafted["drive"]
    found = json.loads((out / "findings.json").read_text("utf-8"))
    assert found["baseline"]["unit"] == "A"
    units = [each["unit"] for each in found["baseline"]["parameters"].values()]
    assert not any("N" in unit for unit in units)
    # What was assumed is a session to go on from.
    assert f"stiction diagnose {out / 'draft' / 'session.toml'}" in said
    assert diagnosed(out / "draft" / "session.toml", "-o", tmp_path / "again") == 0
    again = json.loads((tmp_path / "again" / "findings.json").read_text("utf-8"))
    assert {**again, "seconds": 0} == {**found, "seconds": 0}


def test_what_is_stated_stands_before_what_is_guessed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    paths = three(tmp_path, ("t", "blue", "theta"))
    stated = ["--columns", "input=blue [mA]", "--gain", "50", "--law", "dahl"]
    assert diagnosed(*paths, "-o", tmp_path / "out", "--json", *stated) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["baseline"]["law"] == "dahl"
    assert told["baseline"]["unit"] == "N·m"
    assert "gain 50 N·m/A" in told["draft"]["assumed"][1]
    # The truth in N·m is as many mA, times the gain.
    assert told["baseline"]["parameters"]["body.inertia"]["value"] == pytest.approx(
        0.0076 * 50e-3, rel=0.1
    )


def test_a_draft_is_made_again_until_somebody_changes_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, out = write(tmp_path / "run.csv"), tmp_path / "out"
    assert diagnosed(path, "-o", out) == 0
    assert diagnosed(path, "-o", out, "--gain", "2") == 0
    drafted = out / "draft" / "plant.toml"
    assert tomllib.loads(drafted.read_text("utf-8"))["drive"]["gain"] == 2.0
    drafted.write_text(drafted.read_text("utf-8").replace("gain = 2.0", "gain = 3.0"), "utf-8")
    capsys.readouterr()
    error = refused(["diagnose", str(path), "-o", str(out)], capsys)
    assert "was changed since it was drafted" in error
    assert "session.toml" in error
    assert "--out" in error


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["run.csv", "--columns", "input=nosuch [A]"], "it has t, i, theta"),
        (["run.csv", "--columns", "input=i [deg]"], "no unit of it"),
        (["run.csv", "--columns", "position=i"], "nothing tells the unit of 'i'"),
        (["run.csv", "--gain", "0"], "finite number other than 0"),
        (["run.csv", "--law", "coulom"], "did you mean 'coulomb'?"),
        (["run.csv", "--joint", "2"], "not those of several joints"),
        (["run.csv", "plant.toml"], "plant.toml: is no recording"),
        (["plant.toml"], "is a plant file"),
        (["plant.toml", "--gain", "1"], "--gain is for recordings"),
        (["blue.csv"], '--columns "input=NAME [A]"'),
        (["i.csv"], '--columns "time=NAME [s]"'),
        (["book.xlsx"], "save a spreadsheet or a log as CSV"),
        (["run.csv", "--columns", "input=i [Amp]"], "did you mean 'A'?"),
        (["run.csv", "--columns", "position=theta [degrees]"], "did you mean 'deg'?"),
        (["run.csv", "--columns", "position:theta"], "is not role=name"),
        (["run.csv", "--columns", "posn=theta"], "did you mean 'position'?"),
        (["run.csv", "run.csv"], "run.csv: is given twice; drop one"),
        (["run.csv", "--gian", "2"], "did you mean '--gain'?"),
        (["none.csv"], "there is no such file"),
        (["empty"], "no recording in this folder"),
    ],
    ids=lambda each: " ".join(each) if isinstance(each, list) else "",
)
def test_what_cannot_be_drafted_is_one_sentence(
    words: list[str],
    told: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    write(Path("run.csv"))
    write(Path("blue.csv"), ("t", "blue", "theta"))
    Path("plant.toml").write_text('[friction]\nlaw = "coulomb"\n')
    Path("book.xlsx").write_bytes(b"PK")
    Path("i.csv").write_text("i,theta\n" + "0.1,0.2\n0.3,-0.1\n" * 200)
    os.mkdir("empty")
    before = sorted(os.listdir())
    assert told in refused(["diagnose", *words], capsys)
    assert sorted(os.listdir()) == before


@pytest.mark.parametrize(
    "stated",
    [
        "input=Iq [A] [A], position=Angle [rad]",
        "input=Iq, position=Angle",
        "input=Iq [A], position='Angle [rad]'",
        'input="Iq [A]"',
    ],
)
def test_columns_whose_header_has_a_unit_go_by_the_name_with_it_and_without(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], stated: str
) -> None:
    # The command prints "input = Iq [A]", each unit once, and what it prints can be given back.
    paths = three(tmp_path, ("Time [s]", "Iq [A]", "Angle [rad]"))
    out = tmp_path / "out"
    assert run(["fit", *map(str, paths), "--columns", stated, "-o", str(out), "-q"]) == 0
    columns = capsys.readouterr().out.splitlines()[0]
    assert "input = Iq [A]," in columns
    assert "position = Angle [rad] (" in columns


def test_a_pattern_that_the_shell_left_is_what_it_finds(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    three(tmp_path)
    out = tmp_path / "out"
    assert run(["fit", str(tmp_path / "run*.csv"), "-o", str(out), "-q"]) == 0
    assert "in 3 recordings" in capsys.readouterr().out
    assert run(["init", str(tmp_path / "run*.csv"), "-o", str(tmp_path / "drafts")]) == 0
    assert "guessed from 3 recordings" in capsys.readouterr().out


def test_several_targets_may_stand_in_one_word(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plant = tmp_path / "plant.toml"
    st.Plant.from_dict({
        "body": {"inertia": 0.01}, "friction": {"law": "coulomb", "coulomb": 0.2, "viscous": 0.01},
    }).save(plant)  # fmt: skip
    assert run(["export", str(plant), "--to", "c,urdf", "-o", str(tmp_path / "out"), "-q"]) == 0
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"c", "urdf"}
    capsys.readouterr()
