"""What the command line refuses: in one sentence, whatever the parser's own words are."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

import stiction as st
from stiction._support.given import whole
from stiction.cli import run


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["laws", "coulomb", "dahl"], "laws: dahl is more than it takes; leave it out"),
        (["fit"], "fit: SESSION is missing; write stiction fit SESSION"),
        (["fit", "s.toml", "-o"], "fit: -o is there without a value"),
        (["fit", "s.toml", "--outt", "x"], "no option --outt (did you mean '--out'?)"),
        (["--foo"], "there is no option --foo; there are --help, --version"),
        (["fits"], "there is no verb 'fits' (did you mean 'fit'?); there are init, demo"),
        (["diagnose", "s.toml", "--seed", "1.9"], "--seed = 1.9 is not a whole number"),
        (["diagnose", "s.toml", "--surrogates", "4.4"], "--surrogates = 4.4 is not a whole"),
        (["compare", "--steps", "many"], "--steps = many is not a whole number"),
        (["plan", "p.toml", "--rate", "fast"], "--rate = fast is not a number"),
        (["fit", "s.toml", "--json=maybe"], "--json = maybe is not true or false"),
        (["fit", "s.toml", "-o", "a", "-o", "b"], "-o is there twice; drop one"),
        (["init", ""], "an argument is empty"),
        (["laws", "-o", ""], "an argument is empty"),
        (["laws", "--out="], "--out= is empty"),
    ],
)
def test_requests_are_refused_in_our_words(
    arguments: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(arguments) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert said.err.startswith("stiction: ")
    assert sentence in said.err


def test_another_file_in_place_of_a_session_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "plant.toml").write_text('[friction]\nlaw = "coulomb"\n')
    assert run(["fit", str(tmp_path / "plant.toml")]) == 2
    told = "plant.toml: is a plant file, and a session file is wanted"
    assert told in capsys.readouterr().err


def test_seeds_below_0_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "plant.toml"
    path.write_text('[drive]\ninput = "torque_nm"\n[friction]\nlaw = "coulomb"\n')
    assert run(["plan", str(path), "--seed", "-1", "-o", str(tmp_path / "out")]) == 2
    assert "seed = -1 is out of bounds" in capsys.readouterr().err


def test_whole_numbers_may_be_those_of_numpy() -> None:
    assert whole(np.int64(3), "seed", least=0) == 3
    assert type(whole(np.uint8(3), "seed", least=0)) is int
    for given in (1.9, np.float64(2.0), True, "3", -1, 6):
        with pytest.raises(st.InputError, match="give a whole number from 0 to 5"):
            whole(given, "seed", least=0, most=5)
    motor = st.Motor(inertia=0.01, friction=st.FrictionModel("coulomb"))
    runs = st.simulate_ensemble(motor, np.ones((2, 8)), 1e-3, every=np.int64(2))
    assert runs.position.shape == (2, 4)


@pytest.mark.parametrize("given", [{"laws": "all"}, {"without": "stribeck"}])
def test_a_word_in_place_of_names_is_refused(given: dict[str, str]) -> None:
    time = np.arange(1000) * 1e-3
    recording = st.Recording(time, np.sin(time), np.sin(time))
    plant = st.Plant.from_dict({"drive": {"input": "torque_nm"}, "friction": {"law": "coulomb"}})
    with pytest.raises(st.InputError, match="is a word; give a sequence"):
        st.diagnose(plant, recording, **given)


def test_more_surrogates_than_any_threshold_needs_are_refused() -> None:
    time = np.arange(1000) * 1e-3
    recording = st.Recording(time, np.sin(time), np.sin(time))
    plant = st.Plant.from_dict({"drive": {"input": "torque_nm"}, "friction": {"law": "coulomb"}})
    with pytest.raises(st.InputError, match="from 4 to 1000"):
        st.diagnose(plant, recording, surrogates=10**9)


LONG = 300 * "a"
"""More than any file may be called."""


@pytest.mark.parametrize(
    "arguments",
    [
        ["init", LONG],
        ["init", f"{LONG}.csv"],
        ["fit", LONG],
        ["fit", f"{LONG}.csv"],
        ["fit", "of a plant.toml"],
        ["diagnose", "of a recording.toml"],
        ["fit", "of nothing.toml"],
        ["fit", "of zero.toml"],
        ["fit", "in a circle.toml"],
        ["simulate", "plant.toml", f"{LONG}.csv"],
        ["plan", "plant.toml", "-o", LONG],
    ],
)
def test_a_path_that_no_file_can_have_is_refused_in_a_sentence(
    arguments: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    plant = '[drive]\ninput = "torque_nm"\n[body]\ninertia = 0.01\n[friction]\nlaw = "coulomb"\n'
    Path("plant.toml").write_text(plant)
    with suppress(OSError):  # not everybody may make links everywhere
        Path("circle").symlink_to("circle")
    recording = '[[recordings]]\nfile = "{}"\n'
    Path("of a plant.toml").write_text(f'plant = "{LONG}"\n{recording.format("run.csv")}')
    Path("of a recording.toml").write_text(recording.format(f"{LONG}.csv"))
    Path("of nothing.toml").write_text(recording.format(r"run\u0000.csv"))
    Path("of zero.toml").write_text(r'plant = "p\u0000"' "\n" + recording.format("run.csv"))
    Path("in a circle.toml").write_text(recording.format("circle"))
    assert run(arguments) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert said.err.startswith("stiction: ")
    assert ";" in said.err


def test_a_folder_that_may_not_be_listed_is_refused_in_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def refused(_: Path) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "iterdir", refused)
    assert run(["init", str(tmp_path)]) == 2
    assert "the folder cannot be read (Permission denied); check" in capsys.readouterr().err
    # Nor is what else is in it looked at, for a file that is not there.
    assert run(["init", str(tmp_path / "run.csv")]) == 2
    assert "there is no such file; check the path" in capsys.readouterr().err


def test_a_checkpoint_of_an_overlong_name_is_refused(tmp_path: Path) -> None:
    motor = st.Motor(inertia=0.01, friction=st.FrictionModel("coulomb"))
    with pytest.raises(st.InputError, match="is no place for a checkpoint"):
        st.stream(motor, [np.ones(8)], 1e-3, checkpoint=tmp_path / LONG)
