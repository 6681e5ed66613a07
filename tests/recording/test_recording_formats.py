from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stiction.errors import InputError
from stiction.recording import formats, read_table
from stiction.recording.formats import FORMATS, Format

Written = Callable[..., Path]


def test_every_format_file_stands_in_the_list() -> None:
    folder = Path(formats.__file__).parent
    files = {file.stem for file in folder.glob("*.py")} - {"__init__", "format"}
    assert files == {known.read.__module__.rpartition(".")[2] for known in FORMATS}


def test_no_ending_belongs_to_two_formats() -> None:
    suffixes = [suffix for known in FORMATS for suffix in known.suffixes]
    assert len(suffixes) == len(set(suffixes))


def test_the_ending_may_be_in_capitals(written: Written, lines: list[str]) -> None:
    assert len(read_table(written(lines, "RUN.CSV")).columns) == 3


def test_an_unknown_ending_lists_the_kinds(written: Written, lines: list[str]) -> None:
    with pytest.raises(InputError, match=r"'\.xlsx' is not known.*CSV \(\.csv .*MAT \(\.mat\)"):
        read_table(written(lines, "run.xlsx"))
    with pytest.raises(InputError, match="has no ending"):
        read_table(written(lines, "run"))


def test_a_missing_file_names_its_neighbour(written: Written, lines: list[str]) -> None:
    path = written(lines, "monday.csv")
    with pytest.raises(InputError, match=r"no such file \(did you mean 'monday.csv'\?\)"):
        read_table(path.with_name("mondy.csv"))
    with pytest.raises(InputError, match="and no folder"):
        read_table(path.parent / "nowhere" / "monday.csv")


def test_a_folder_is_not_a_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="this is a folder"):
        read_table(tmp_path)


@pytest.mark.parametrize("suffix", [suffix for known in FORMATS for suffix in known.suffixes])
def test_an_empty_file_of_any_kind_says_so(written: Written, suffix: str) -> None:
    with pytest.raises(InputError, match="the file is empty"):
        read_table(written(b"", "run" + suffix))


@pytest.mark.parametrize("suffix", [suffix for known in FORMATS for suffix in known.suffixes])
def test_garbage_of_any_kind_is_refused_in_one_sentence(written: Written, suffix: str) -> None:
    path = written(bytes(range(256)) * 40, "run" + suffix)
    with pytest.raises(InputError) as caught:
        read_table(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


@given(st.sampled_from(FORMATS), st.binary(min_size=1) | st.text(min_size=1).map(str.encode))
def test_whatever_the_bytes_the_answer_is_a_table_or_a_sentence(
    known: Format, content: bytes
) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / ("run" + known.suffixes[0])
        path.write_bytes(content)
        try:
            table = read_table(path)
        except InputError as error:
            assert str(error).startswith(f"{path}: ")  # noqa: PT017 (either outcome is right)
        else:
            assert table.columns


def test_a_file_that_may_not_be_read_says_why(
    written: Written, lines: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = written(lines)

    def refuse(*_: object) -> bytes:
        raise PermissionError(13, "Permission denied")

    with monkeypatch.context() as patched:
        patched.setattr(Path, "open", refuse)
        with pytest.raises(InputError, match=r"cannot be read \(Permission denied\)"):
            read_table(path)
    assert read_table(path).columns


@pytest.mark.parametrize("content", [b'"', b'""', b'"\n"', b";", b","])
def test_a_first_line_of_marks_alone_is_refused_in_a_sentence(tmp_path, content):
    file = tmp_path / "log.csv"
    file.write_bytes(content)
    with pytest.raises(InputError, match=r"no column; write a line of names|has a header"):
        read_table(file)
