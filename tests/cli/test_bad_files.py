"""Bad input, end to end: every kind beside its good twin.

A good session exits 0; the same with one thing spoiled exits 2, with one sentence that names the
file, the field or row, and the value, and says what is allowed or what to do.

A new kind is one entry of ``KINDS``; a new verb that takes a session is one entry of ``VERBS``.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest
from tests.cli.desk import (
    DT,
    PLANT,
    ROWS,
    SESSION,
    Desk,
    in_csv,
    in_json,
    in_mat,
    in_npz,
    in_parquet,
    moved,
    of_two,
)

from stiction.cli import run

VERBS = ("fit", "diagnose")
READ = ("fit",)
"""What cannot be fitted and can be read: a diagnosis answers it with a verdict."""
Twin = Callable[[Path], Desk]

DAMAGES = 15  # of each file


@dataclass(frozen=True)
class Kind:
    """One kind of bad input.

    Attributes
    ----------
    name : str
    spoil : callable
        Spoils one thing of a good desk.
    words : tuple of str
        All stand in the sentence: file, field or row, value, what is allowed or the remedy.
    twin : callable
        Makes the good desk.
    verbs : tuple of str
        What the kind is a fault for; verbs that answer it otherwise have their own tests.
    """

    name: str
    spoil: Callable[[Desk], object]
    words: tuple[str, ...]
    twin: Twin = in_csv
    verbs: tuple[str, ...] = field(default=VERBS)


def plant(name: str, old: str, new: str, *words: str) -> Kind:
    """A fault in the plant file."""
    return Kind(name, lambda desk: desk.edit(desk.plant, old, new), ("plant.toml", *words))


def session(
    name: str, old: str, new: str, *words: str, twin: Callable[[Path], Desk] = in_csv
) -> Kind:
    """A fault in the session file."""
    return Kind(
        name, lambda desk: desk.edit(desk.session, old, new), ("session.toml", *words), twin
    )


def bytes_of(
    name: str, file: str, content: bytes, *words: str, twin: Callable[[Path], Desk] = in_csv
) -> Kind:
    """A file that holds something else."""
    return Kind(name, lambda desk: (desk.folder / file).write_bytes(content), (file, *words), twin)


def encoded(desk: Desk, file: Path, encoding: str, extra: str = "") -> None:
    file.write_bytes((file.read_text(encoding="utf-8") + extra).encode(encoding))


def folder_instead(file: Path) -> None:
    file.unlink()
    file.mkdir()


def npz(desk: Desk, **changed: np.ndarray) -> None:
    np.savez(desk.folder / "run.npz", **{**desk.columns, **changed})


def mat(desk: Desk, **changed: object) -> None:
    from scipy.io import savemat

    savemat(desk.folder / "run.mat", {**desk.columns, **changed})


JUNK = bytes(range(1, 256)) * 40

FILES = [
    Kind("session missing", lambda desk: desk.session.unlink(), ("session.toml", "no such file")),
    Kind("plant missing", lambda desk: desk.plant.unlink(), ("plant.toml", "no such file")),
    Kind("recording missing", lambda desk: desk.csv.unlink(), ("run.csv", "no such file")),
    Kind("session is a folder", lambda desk: folder_instead(desk.session),
         ("session.toml", "directory", "give the file in it")),
    Kind("plant is a folder", lambda desk: folder_instead(desk.plant),
         ("session.toml", "plant = 'plant.toml'", "folder", "own file")),
    Kind("recording is a folder", lambda desk: folder_instead(desk.csv),
         ("run.csv", "folder", "name a file in it")),
    bytes_of("recording empty", "run.csv", b"", "the file is empty", "record it again"),
    bytes_of("recording of blank lines", "run.csv", b"\n \n\n", "no line of data"),
    bytes_of("header only", "run.csv", b"t,u,q\n", "3 columns", "no rows"),
    bytes_of("three rows", "run.csv", b"t,u,q\n0,1,2\n1,2,3\n2,3,4\n", "3 rows", "200"),
    bytes_of("binary junk in CSV", "run.csv", JUNK, "byte 0x80", "UTF-8"),
    bytes_of("zero bytes in CSV", "run.csv", b"t,u,q\n\0\0", "line 2", "zero byte"),
    bytes_of("binary junk in MAT", "run.mat", JUNK, "cannot be read as a MAT file", twin=in_mat),
    bytes_of("binary junk in NPZ", "run.npz", JUNK, "not an NPZ archive", twin=in_npz),
    bytes_of("binary junk in JSON", "run.json", JUNK, "not UTF-8", twin=in_json),
    bytes_of("binary junk in Parquet", "run.parquet", JUNK, "PAR1", twin=in_parquet),
    bytes_of("session empty", "session.toml", b"", "is empty", "plant"),
    bytes_of("plant empty", "plant.toml", b"", "is empty", "[friction] law"),
    bytes_of("binary junk in a session", "session.toml", JUNK, "UTF-8"),
    Kind("UTF-16 plant", lambda desk: encoded(desk, desk.plant, "utf-16"),
         ("plant.toml", "UTF-8")),
    Kind("UTF-16 that breaks off", lambda desk: desk.csv.write_bytes(
        desk.csv.read_text().encode("utf-16")[:-1]),
         ("run.csv", "UTF-16", "save it as UTF-8")),
    Kind("Latin-1 session", lambda desk: encoded(desk, desk.session, "latin-1", "# Öl\n"),
         ("session.toml", "UTF-8")),
    Kind("JSON that is no list of records",
         lambda desk: (desk.folder / "run.json").write_text("[1, 2, 3]"),
         ("run.json", "no list of records", "time_s"), in_json),
    Kind("JSON that is cut off",
         lambda desk: (desk.folder / "run.json").write_text('[{"t": 0.0,\n'),
         ("run.json", "line 2", "not JSON", "cut off"), in_json),
    Kind("unknown ending", lambda desk: desk.csv.rename(desk.instead("run.xlsx")),
         ("run.xlsx", "'.xlsx'", ".csv")),
    Kind("zero-length file name", lambda desk: desk.instead(""), ("session.toml", "file", "''")),
    Kind("zero-length plant name",
         lambda desk: desk.edit(desk.session, '"plant.toml"', '""'),
         ("session.toml", "plant", "''")),
]  # fmt: skip

ROWS_AND_CELLS = [
    Kind("text in a cell", lambda desk: desk.line(58, lambda line: line.replace(",", ",x", 1)),
         ("run.csv", "line 58", "column 'u'", "'x", "not a number", "correct the cell")),
    Kind("text in a JSON cell", lambda desk: (desk.folder / "run.json").write_text(
        (desk.folder / "run.json").read_text().replace('"u": ', '"u": "oops", "x": ', 1)),
         ("run.json", "row 1", "'u'", "'oops'", "not a number"), in_json),
    Kind("too many cells missing", lambda desk: desk.cells("q", slice(100, 140), np.nan),
         ("run.csv", "position", "40 missing", str(ROWS), "line 102", "5 %"), verbs=READ),
    Kind("too many cells infinite", lambda desk: desk.cells("u", slice(100, 140), np.inf),
         ("run.csv", "input", "40 missing or infinite", "line 102", "5 %"), verbs=READ),
    Kind("a column without a number", lambda desk: desk.cells("q", slice(None), np.nan),
         ("run.csv", "position", f"{ROWS} missing", "line 2"), verbs=READ),
    Kind("time runs backward", lambda desk: desk.cells("t", slice(None), desk.columns["t"][::-1]),
         ("run.csv", "time decreases", "6.39 s to 0 s", "sort the rows")),
    Kind("time starts again",
         lambda desk: desk.cells("t", slice(320, None), desk.columns["t"][:320]),
         ("run.csv", "line 322", "3.19 s to 0 s", "split the file")),
    Kind("time is constant", lambda desk: desk.cells("t", slice(None), 3.0),
         ("run.csv", "time stamps repeat", "line 3", "more digits")),
    Kind("time is missing", lambda desk: desk.cells("t", slice(10, 200), np.nan),
         ("run.csv", "190 time stamps", "line 12", "every row")),
    Kind("ragged rows", lambda desk: desk.line(40, lambda line: line + ",1.0"),
         ("run.csv", "line 40", "4 cells", "3 columns")),
    Kind("column twice", lambda desk: desk.line(1, lambda line: "t,u,u"),
         ("run.csv", "line 1", "two columns 'u'", "its own name")),
    Kind("numbers where the header belongs", lambda desk: desk.line(1, lambda line: "0,0,0"),
         ("run.csv", "no column 't'", "column 1, column 2, column 3")),
    Kind("absurd cell", lambda desk: desk.cells("q", slice(300, 301), 1e300),
         ("run.csv", "position is 1e+300", "line 302", "correct the cell")),
    Kind("absurd unit of time",
         lambda desk: desk.cells("t", slice(None), 1e12 * desk.columns["t"]),
         ("run.csv", "1e+10 s", "1e-09 s to 1e+06 s", "unit of time")),
    Kind("clock that jumps", lambda desk: desk.cells("t", slice(300, None),
                                                     1e7 + desk.columns["t"][300:]),
         ("run.csv", "line 302", "time jumps by 1e+07 s", "split the file")),
    Kind("too short for any kernel",
         lambda desk: desk.cells("t", slice(None), 1e-5 * desk.columns["t"]),
         ("run.csv", f"{ROWS} samples are too few", "0.03 s", "longer recording"), verbs=READ),
    Kind("2-D variable in MAT", lambda desk: mat(desk, q=np.ones((ROWS, 2))),
         ("run.mat", "'q'", "position", f"{ROWS} x 2 matrix", "vector"), in_mat),
    Kind("text in MAT", lambda desk: mat(desk, u="hello"),
         ("run.mat", "'u'", "input", "text"), in_mat),
    Kind("shorter column in NPZ", lambda desk: npz(desk, u=np.ones(ROWS - 1)),
         ("run.npz", "input", "'u'", f"{ROWS - 1} rows", str(ROWS)), in_npz),
    Kind("NPZ without the column", lambda desk: desk.edit(desk.session, '"u"', '"v"'),
         ("run.npz", "'v'", "input", "t, u, q"), in_npz),
    Kind("unknown column", lambda desk: desk.line(1, lambda line: "t,u,angle"),
         ("run.csv", "'q'", "position", "t, u, angle")),
]  # fmt: skip

# A machine that never moves can be read and tells nothing.
UNUSABLE = [
    Kind("position is constant", lambda desk: desk.cells("q", slice(None), 0.25),
         ("session.toml", "nothing moves", "record a motion"), verbs=READ),
    Kind("position and input are constant",
         lambda desk: (desk.cells("q", slice(None), 0.25), desk.cells("u", slice(None), 0.1)),
         ("session.toml", "nothing moves", "record a motion"), verbs=READ),
]  # fmt: skip

PLANTS = [
    plant("plant is not TOML", "gain = 1.0", "gain = ", "not TOML", "line 5"),
    plant("unknown table", "[body]", "[bodies]", "'bodies'", "did you mean 'body'", "friction"),
    plant("unknown key in [motion]", 'kind = "rotary"', 'kinds = "rotary"', "[motion]", "'kinds'"),
    plant("unknown key in [drive]", "gain", "gian", "[drive]", "'gian'", "did you mean 'gain'"),
    plant("unknown key in [body]", "inertia", "mass", "[body]", "'mass'", "inertia"),
    plant("unknown key in [friction]", "viscous", "viscosity", "[friction]", "'viscosity'",
          "did you mean 'viscous'"),
    plant("unknown key in [[effects]]", 'name = "torque_bias"', 'name = "torque_bias"\nsize = 1',
          "[[effects]] 1", "'size'"),
    plant("unknown key in [sensor]", "counts_per_rev", "counts", "[sensor]", "'counts'"),
    plant("unknown key in [controller]", "kp =", "gain_p =", "[controller]", "'gain_p'", "kp"),
    plant("unknown key of a parameter", "0.2", "{ value = 0.2, minimum = 0 }", "[friction] coulomb",
          "'minimum'", "min"),
    plant("unknown law", '"coulomb"', '"colomb"', "[friction] law", "'colomb'",
          "did you mean 'coulomb'"),
    plant("law missing", 'law = "coulomb"', "", "[friction] law", "missing", "coulomb"),
    plant("law is a number", '"coulomb"', "3", "[friction] law", "3", "coulomb"),
    plant("unknown effect", '"torque_bias"', '"torqe_bias"', "[[effects]] 1", "'torqe_bias'",
          "did you mean 'torque_bias'"),
    plant("effect without a name", 'name = "torque_bias"', "", "[[effects]] 1", "name is missing"),
    plant("effect twice", 'name = "torque_bias"',
          'name = "torque_bias"\n[[effects]]\nname = "torque_bias"',
          "[[effects]] 2", "'torque_bias'", "drop one"),
    plant("unknown motion", '"rotary"', '"rotating"', "[motion] kind", "'rotating'", "linear"),
    plant("unknown input", '"torque_nm"', '"torque"', "[drive] input", "'torque'",
          "did you mean 'torque_nm'"),
    plant("input of the other motion", '"torque_nm"', '"force_n"', "[drive] input", "'force_n'",
          "rotary"),
    plant("unknown controller", '"pd"', '"pod"', "[controller] kind", "'pod'", "position_velocity"),
    plant("gain 0", "gain = 1.0", "gain = 0.0", "[drive] gain", "0", "moves nothing"),
    plant("gain infinite", "gain = 1.0", "gain = inf", "gain = inf", "out of bounds"),
    plant("negative inertia", "inertia = 0.01", "inertia = -0.01", "[body] inertia", "-0.01",
          "from 0"),
    plant("inertia infinite", "inertia = 0.01", "inertia = inf", "[body] inertia", "inf", "finite"),
    plant("inertia nan", "inertia = 0.01", "inertia = nan", "[body] inertia", "nan"),
    plant("inertia is text", "inertia = 0.01", 'inertia = "0.01"', "[body] inertia", "'0.01'",
          "number"),
    plant("gain is true", "gain = 1.0", "gain = true", "[drive] gain", "True", "number"),
    Kind("table is a number", lambda desk: desk.plant.write_text(
        "body = 5\n" + PLANT.replace("[body]\ninertia = 0.01\n", "")),
         ("plant.toml", "body = 5", "[body]")),
    plant("out of the catalogue", "viscous = 0.05", "viscous = -1.0", "viscous", "-1", "0"),
    plant("infinite where a number is needed", "viscous = 0.05", "viscous = inf", "viscous", "inf"),
    plant("value outside its own bounds", "0.05", "{ value = 0.05, min = 0.1, max = 0.2 }",
          "[friction] viscous", "0.05", "0.1 to 0.2"),
    plant("bounds in the wrong order", "0.05", "{ value = 0.05, min = 0.2, max = 0.1 }",
          "[friction] viscous", "min = 0.2", "max = 0.1", "swap"),
    plant("value missing", "0.05", "{ min = 0.1 }", "[friction] viscous", "'value' is missing"),
    plant("fixed is no yes or no", "0.05", '{ value = 0.05, fixed = "yes" }', "[friction] viscous",
          "'yes'", "true or false"),
    plant("no counts in a turn", "4096", "0", "[sensor] counts_per_rev", "0", "above 0"),
    plant("sensor of the other motion", "counts_per_rev = 4096", "count_m = 1e-6", "[sensor]",
          "'count_m'", "counts_per_rev"),
    plant("number of 400 digits", "inertia = 0.01", f"inertia = {'9' * 400}", "[body] inertia",
          "1e308"),
    plant("number of 5000 digits", "inertia = 0.01", f"inertia = {'9' * 5000}", "digits"),
    plant("nested without end", "gain = 1.0", f"gain = {'[' * 5000}", "nested too deeply"),
    plant("gain of another world", "gain = 1.0", "gain = 1e-300", "[drive] gain", "1e-300",
          "1e-12"),
    plant("key twice", "gain = 1.0", "gain = 1.0\ngain = 2.0", "not TOML", "line 6"),
]  # fmt: skip

SESSIONS = [
    session("session is not TOML", "[columns]", "[columns", "not TOML", "line 2"),
    session("unknown table of a session", "[columns]", "[colums]", "'colums'",
            "did you mean 'columns'"),
    session("unknown key of a recording", 'kind = "sine"', 'type = "sine"', "[[recordings]] 1",
            "'type'", "kind"),
    session("unknown key of a column", 'unit = "Nm"', 'units = "Nm"', "input", "'units'", "unit"),
    session("unknown role of a column", 'time = "t"', 'times = "t"', "[columns]", "'times'",
            "did you mean 'time'"),
    session("unknown unit", '"Nm"', '"Nmm"', "input", "'Nmm'", "did you mean", "mNm"),
    session("unit of another quantity", '"Nm"', '"deg"', "input", "deg", "Nm"),
    session("unit of another drive", '"Nm"', '"A"', "input", "A", "torque_nm", "Nm"),
    session("rotary plant, position in mm", '"rad"', '"mm"', "position", "mm", "rotary", "rad"),
    session("linear plant, position in deg", '"mm"', '"deg"', "position", "deg", "linear", "mm",
            twin=moved),
    session("scale 0", '"Nm"', '"Nm", scale = 0', "input", "scale is 0"),
    session("scale of 400 digits", '"Nm"', f'"Nm", scale = {"9" * 400}', "input", "scale",
            "finite"),
    session("scale is text", '"Nm"', '"Nm", scale = "2"', "input", "scale", "'2'", "number"),
    session("column is number 0", '"t"', "0", "time", "0", "number from 1"),
    session("column without a name", '"t"', '""', "time", "''", "header"),
    session("input and effort", 'time = "t"', 'time = "t"\neffort = "u"', "[columns]",
            "both input and effort"),
    session("no recordings", SESSION[SESSION.index("[[rec"):], "", "[[recordings]]",
            "at least one"),
    session("recordings is a table", "[[recordings]]", "[recordings]", "recordings",
            "[[recordings]]"),
    session("recording without a file", 'file = "run.csv"', "", "[[recordings]] 1", "file",
            "missing"),
    session("file is a number", '"run.csv"', "5", "[[recordings]] 1", "file = 5"),
    session("unknown role", 'kind = "sine"', 'role = "trian"', "[[recordings]] 1 role", "'trian'",
            "did you mean 'train'"),
    session("kind is a number", '"sine"', "5", "[[recordings]] 1 kind", "5"),
    session("start is text", '"sine"', '"sine"\nstart_s = "noon"', "[[recordings]] 1 start_s",
            "'noon'", "number"),
    session("start is infinite", '"sine"', '"sine"\nstart_s = inf', "start_s", "inf", "finite"),
    session("cold is text", '"sine"', '"sine"\ncold = "yes"', "[[recordings]] 1 cold", "'yes'",
            "true or false"),
    session("one file in two roles", '"two.csv"', '"run.csv"', "[[recordings]] 2", "run.csv",
            "recording 1", "drop one", twin=of_two),
    session("one file in two roles by another path", '"two.csv"', '"./x/../run.csv"',
            "[[recordings]] 2", "run.csv", "recording 1", "drop one", twin=of_two),
    Kind("one recording under two names",
         lambda desk: (desk.folder / "two.csv").write_bytes(desk.csv.read_bytes()),
         ("session.toml", "run.csv", "two.csv", "same recording", "drop one"), of_two),
    session("only recordings to test", '"sine"', '"sine"\nrole = "test"', "'test'", "train",
            twin=of_two),
    session("replicate of nothing", 'role = "test"', 'replicate_of = "three.csv"',
            "[[recordings]] 2 replicate_of", "'three.csv'", "run.csv", twin=of_two),
    session("recordings that overlap", 'role = "test"', "start_s = 0.5", "two.csv", "0.5 s",
            "run.csv", twin=of_two),
    session("plant not named", 'plant = "plant.toml"', "", "plant is missing",
            'plant = "plant.toml"'),
    session("plant is a number", '"plant.toml"', "7", "plant", "7"),
    session("session names itself as plant", '"plant.toml"', '"session.toml"', "plant",
            "session.toml", "itself"),
    Kind("recording names the plant", lambda desk: desk.instead("plant.toml"),
         ("plant.toml", "is a TOML file", ".csv")),
    Kind("no effort where the motion is prescribed",
         lambda desk: desk.edit(desk.session, 'effort = "u"', ""),
         ("run.csv", "effort", "t, u, q", "[columns]"), moved),
]  # fmt: skip


def with_option(*words: str) -> Callable[[Desk], object]:
    return lambda desk: desk.arguments.extend(words)


COMMANDS = [
    Kind("unknown option", with_option("--nosuch"), ("--nosuch", "--help")),
    Kind("one word too many", with_option("more.toml"), ("more.toml", "--help")),
    Kind("out without a folder", with_option("--out"), ("--out", "--help")),
    Kind("out is a file", lambda desk: with_option("--out", str(desk.csv))(desk),
         ("run.csv", "--out")),
]  # fmt: skip

KINDS = [*FILES, *ROWS_AND_CELLS, *UNUSABLE, *PLANTS, *SESSIONS, *COMMANDS]


ANSWERED: set[tuple[str, Twin]] = set()
"""Good twins that were tried: there are few, and each serves many kinds."""


def is_answered(verb: str, twin: Twin, desk: Desk) -> bool:
    if (verb, twin) not in ANSWERED:
        if status(verb, desk) != 0:
            return False
        ANSWERED.add((verb, twin))
    return True


def status(verb: str, desk: Desk) -> int:
    out = [] if "--out" in desk.arguments else ["--out", str(desk.folder / "out")]
    return run([verb, str(desk.session), *out, *desk.arguments])


@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_a_bad_file_is_one_sentence_and_its_good_twin_an_answer(
    verb: str, kind: Kind, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if verb not in kind.verbs:
        pytest.skip(f"{verb} answers this otherwise")
    desk = kind.twin(tmp_path)
    assert is_answered(verb, kind.twin, desk), capsys.readouterr().err
    capsys.readouterr()
    kind.spoil(desk)
    assert status(verb, desk) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    error = captured.err
    assert error.startswith("stiction: ")
    assert error.endswith("\n")
    assert error.count("\n") == 1, error
    for word in kind.words:
        assert word in error, f"{word!r} is not in: {error}"
    assert "Traceback" not in error
    assert not re.search("[╭╮╰╯│─]", error)
    assert len(error) < 800


REPAIRED = {
    "cells missing under 5 %": ("q", slice(100, 120), np.nan, f"20 of {ROWS} cells were missing"),
    "cells infinite under 5 %": ("u", slice(100, 102), np.inf, f"2 of {ROWS} cells were"),
    "a stamp that repeats": ("t", slice(300, 301), 299 * DT, "1 stamp that was missing, repeated"),
    "a stamp that steps back": ("t", slice(300, 301), 0.1, "spaced anew"),
}  # fmt: skip


@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize("case", REPAIRED)
def test_a_small_fault_is_repaired_and_told(
    verb: str, case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name, rows, value, words = REPAIRED[case]
    desk = Desk(tmp_path)
    desk.cells(name, rows, value)
    assert status(verb, desk) == 0
    captured = capsys.readouterr()
    assert words in captured.out
    assert captured.err == ""


def test_a_recording_of_one_second_is_an_answer(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    desk = Desk(tmp_path)
    desk.columns = {name: column[:210] for name, column in desk.columns.items()}
    desk.cells("t", slice(None), 0.5 * desk.columns["t"])
    assert status("fit", desk) == 0
    assert capsys.readouterr().err == ""


def damaged(content: bytes, rng: np.random.Generator) -> bytes:
    """The content with a byte changed, a piece cut out or doubled, or its end torn off."""
    start, length = int(rng.integers(len(content))), int(rng.choice([1, 3, 30, 300]))
    before, piece, after = (
        content[:start],
        content[start : start + length],
        content[start + length :],
    )
    other = bytes(rng.integers(256, size=len(piece), dtype=np.uint8))
    return before + [other, b"", piece + piece, b"-", b"1e300"][rng.integers(5)] + after


@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize(
    ("twin", "name"),
    [(in_csv, "session.toml"), (in_csv, "plant.toml"), (in_csv, "run.csv"), (in_npz, "run.npz"),
     (in_mat, "run.mat"), (in_json, "run.json"), (in_parquet, "run.parquet")],
)  # fmt: skip
def test_random_damage_is_an_answer_or_one_sentence(
    verb: str,
    twin: Twin,
    name: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    desk = twin(tmp_path)
    good = (tmp_path / name).read_bytes()
    rng = np.random.default_rng(5)
    for _ in range(DAMAGES):
        (tmp_path / name).write_bytes(damaged(good, rng))
        ended = status(verb, desk)
        captured = capsys.readouterr()
        assert (ended, captured.err.count("\n")) in ((0, 0), (2, 1)), captured.err


@pytest.mark.parametrize(
    "kind", [kind for kind in KINDS if kind.verbs == READ], ids=lambda kind: kind.name
)
def test_what_can_be_read_and_not_be_used_is_a_verdict(
    kind: Kind, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    desk = kind.twin(tmp_path)
    kind.spoil(desk)
    assert run(["diagnose", str(desk.session), "--json", "--out", str(tmp_path / "out")]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["verdict"] in ("data_fault", "not_testable")
    assert found["effects"] == []
    assert "run.csv" in found["sentence"]
    for file in ("report.html", "findings.json", "plant.toml"):
        assert (tmp_path / "out" / file).exists()


def test_there_are_many_kinds_and_each_has_its_name() -> None:
    assert len({kind.name for kind in KINDS}) == len(KINDS) >= 30
