"""Plant and session files from strangers end in a plant, a session or a sentence."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import stiction as st
from stiction.cli import run
from stiction.errors import InputError

PLANT = '[friction]\nlaw = "coulomb"\ncoulomb = {}\n[body]\ninertia = 1.0\n'
SESSION = 'plant = "plant.toml"\n[[recordings]]\nfile = {}\n'


def refusal(path: Path, content: str | bytes) -> str:
    data = content.encode() if isinstance(content, str) else content
    path.write_bytes(data)
    load = st.load if path.stem == "session" else st.Plant.load
    with pytest.raises(InputError) as caught:
        load(path)
    sentence = str(caught.value)
    assert "\n" not in sentence
    assert len(sentence) < 4000
    sentence.encode()
    return sentence


NESTED = {
    "lists": "x = " + "[" * 5000 + "]" * 5000,
    "tables": "x = " + "{a=" * 5000 + "1" + "}" * 5000,
    "a key": ".".join("a" * 5000) + " = 1",
    "a quoted key": " . ".join(['"a"'] * 5000) + " = 1",
    "a header": "[" + ".".join("a" * 5000) + "]",
}


@pytest.mark.parametrize("what", NESTED)
@pytest.mark.parametrize("name", ["plant.toml", "session.toml"])
def test_what_is_nested_thousands_deep_is_refused(tmp_path: Path, name: str, what: str) -> None:
    assert "is nested too deeply" in refusal(tmp_path / name, NESTED[what])


def test_numbers_on_one_line_are_no_nested_key(tmp_path: Path) -> None:
    numbers = ", ".join(["0.5"] * 1000)
    assert "'x' is unknown" in refusal(tmp_path / "plant.toml", f"x = [{numbers}]")


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("9" * 4000, "a whole number beyond 1e308"),
        ("9" * 100_000, "a number in it has thousands of digits"),
        ("0x" + "f" * 100_000, "a number in it has thousands of digits"),
        ("2020-01-01", "is a date; allowed is a number"),
        ("07:32:00", "is a time; allowed is a number"),
        ("[" * 200 + "]" * 200, "is a list; allowed is a number"),
        ('"' + "a" * 100_000 + '"', "is a str; allowed is a number"),
    ],
)
def test_what_stands_in_place_of_a_number_is_refused(
    tmp_path: Path, value: str, message: str
) -> None:
    assert message in refusal(tmp_path / "plant.toml", PLANT.format(value))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ('"a\\u001b[31m" = 1', r"'a\x1b[31m' is unknown"),
        ('"a\\n\\r\\u0000" = 1', r"'a\n\r\x00' is unknown"),
        (b'law = "\xb5"', "is not text in UTF-8"),
        ("law = 1".encode("utf-16"), "is not text in UTF-8"),
        (b"law = 1\0", "is not TOML"),
        ("#" * 3_000_000, "is larger than 2 MiB"),
    ],
)
def test_what_is_no_plain_text_is_refused(
    tmp_path: Path, content: str | bytes, message: str
) -> None:
    assert message in refusal(tmp_path / "plant.toml", content)
    assert message in refusal(tmp_path / "session.toml", content)


@pytest.mark.parametrize(
    ("file", "message"),
    [
        ('"' + "a" * 10_000 + '.csv"', ".csv: the file cannot be read (File name too long)"),
        ('"a\\u001b[31m\\n.csv"', r"a\x1b[31m\n.csv: there is no such file"),
        ("0x" + "f" * 900, "is not a path"),
        ("2020-01-01", "is not a path"),
    ],
)
def test_a_session_that_names_what_is_no_file_is_refused(
    tmp_path: Path, file: str, message: str
) -> None:
    (tmp_path / "plant.toml").write_text(PLANT.format(1.0))
    assert message in refusal(tmp_path / "session.toml", SESSION.format(file))


def test_a_hundred_thousand_recordings_are_refused(tmp_path: Path) -> None:
    many = "".join(f'[[recordings]]\nfile = "{k}.csv"\n' for k in range(100_000))
    assert "is larger than 2 MiB" in refusal(tmp_path / "session.toml", many)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes have no names here")
def test_a_pipe_is_refused_and_not_waited_for(tmp_path: Path) -> None:
    path = tmp_path / "plant.toml"
    os.mkfifo(path)
    for load in (st.Plant.load, st.load):
        with pytest.raises(InputError, match="this is a pipe and no file"):
            load(path)


def test_the_command_line_answers_a_deep_file_in_a_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "session.toml"
    path.write_text(NESTED["lists"])
    assert run(["diagnose", str(path)]) == 2
    answer = capsys.readouterr().err
    assert answer == f"stiction: {path}: is nested too deeply; write plain tables\n"
