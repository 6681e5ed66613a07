"""``stiction init``: drafts that parse, that say why, and that a fit runs on."""

from __future__ import annotations

import json
import tomllib
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import stiction as st
from stiction.cli import run
from stiction.drafting.text import kinds_of

ROWS = 3000
DRAFTS = ("plant.toml", "session.toml")


def channels(seed: int = 0) -> dict[str, np.ndarray]:
    """What a recorder keeps of a driven shaft, SI values."""
    time = np.arange(ROWS) * 1e-3
    drive = 0.8 * np.sin(3.0 * time + seed) + 0.5 * np.sin(11.0 * time)
    shaft = st.Motor(0.0076, friction=st.FrictionModel("coulomb", coulomb=0.2, viscous=0.05))
    motion = shaft.simulate(drive[:-1], 1e-3).position
    return {"time": time, "drive": drive, "position": np.concatenate([[0.0], motion])}


def write(path: Path, names: tuple[str, ...] = ("t", "i", "theta"), seed: int = 0) -> Path:
    """A recording in the format that its ending says."""
    columns = dict(zip(names, channels(seed).values(), strict=True))
    if path.suffix == ".csv":
        head = ",".join(columns)
        np.savetxt(path, np.column_stack(list(columns.values())), delimiter=",", header=head,
                   comments="", encoding="utf-8")  # fmt: skip
    elif path.suffix == ".npz":
        np.savez(path, **columns)
    elif path.suffix == ".mat":
        from scipy.io import savemat

        savemat(path, {**columns, "gain": 0.3})
    elif path.suffix == ".json":
        rows = zip(*(column.tolist() for column in columns.values()), strict=True)
        path.write_text(json.dumps({"log": [dict(zip(columns, row, strict=True)) for row in rows]}))
    elif path.suffix == ".parquet":
        pyarrow = pytest.importorskip("pyarrow")
        from pyarrow import parquet

        parquet.write_table(pyarrow.table(columns), path)
    return path


def refused(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """The one sentence of a refusal."""
    assert run(arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    return captured.err


@pytest.mark.parametrize("ending", ["csv", "npz", "mat", "json", "parquet"])
def test_a_fit_runs_on_the_drafts_of_every_format(
    ending: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write(tmp_path / f"run.{ending}")
    out = tmp_path / "drafts"
    assert run(["init", str(path), "-o", str(out)]) == 0
    text = capsys.readouterr().out
    assert "theta" in text
    assert "next: read both files" in text
    assert sorted(file.name for file in out.iterdir()) == sorted(DRAFTS)
    fitted = tmp_path / "fitted"
    assert run(["fit", str(out / "session.toml"), "-o", str(fitted), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["parameters"]
    assert found["body.inertia"]["value"] == pytest.approx(0.0076, rel=0.1)


def test_the_drafts_stand_in_the_present_folder_without_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    write(Path("run.csv"))
    assert run(["init", "run.csv"]) == 0
    session = tomllib.loads(Path("session.toml").read_text("utf-8"))
    assert session["plant"] == "plant.toml"
    assert session["recordings"] == [{"file": "run.csv"}]


def test_every_line_that_is_guessed_has_a_comment_before_it(tmp_path: Path) -> None:
    write(tmp_path / "run.csv")
    assert run(["init", str(tmp_path / "run.csv"), "-o", str(tmp_path)]) == 0
    guessed = ("time", "input", "position", "kind", "gain", "law")
    for name in DRAFTS:
        lines = (tmp_path / name).read_text("utf-8").splitlines()
        assert max(map(len, lines)) <= 100
        for before, line in pairwise(lines):
            if line.startswith(tuple(f"{word} = " for word in guessed)):
                assert before.startswith("# "), line


def test_the_gain_of_a_current_has_to_be_stated_and_that_of_a_torque_not(tmp_path: Path) -> None:
    for drive, unit in (("i", "A"), ("tau", "")):
        out = tmp_path / drive
        path = write(tmp_path / "run.mat", ("t", drive, "theta"))
        assert run(["init", str(path), "-o", str(out)]) == 0
        text = (out / "plant.toml").read_text("utf-8")
        assert tomllib.loads(text)["drive"].get("gain") == (None if unit else 1.0)
        assert (f"TO DO: state the gain in N·m/{unit}" in text) == bool(unit)
        # The number beside the vectors is pointed at.
        assert ("the single numbers gain" in " ".join(text.split())) == bool(unit)


def test_a_moved_machine_with_a_measured_force_is_prescribed_motion(tmp_path: Path) -> None:
    path = write(tmp_path / "run.csv", ("t", "force", "x"))
    assert run(["init", str(path), "-o", str(tmp_path)]) == 0
    plant = tomllib.loads((tmp_path / "plant.toml").read_text("utf-8"))
    assert plant["drive"] == {"kind": "prescribed_motion"}
    assert plant["motion"] == {"kind": "linear"}
    assert plant["friction"] == {"law": "coulomb"}
    session = tomllib.loads((tmp_path / "session.toml").read_text("utf-8"))
    assert set(session["columns"]) == {"time", "effort", "position"}
    assert st.load(tmp_path / "session.toml").recordings[0].effort is not None


def test_what_is_not_guessed_is_a_line_to_finish(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write(tmp_path / "run.csv", ("t", "blue", "theta"))
    assert run(["init", str(path), "-o", str(tmp_path)]) == 0
    assert "to do: no column is known to be the input" in capsys.readouterr().out
    plant, session = ((tmp_path / name).read_text("utf-8") for name in DRAFTS)
    assert "input" not in tomllib.loads(session)["columns"]
    assert "drive" in tomllib.loads(plant)
    assert "no column is known to be the input" in run_fit(tmp_path, capsys)
    finished = session.replace('# input = { name = "…"', 'input = { name = "blue"')
    (tmp_path / "session.toml").write_text(finished, encoding="utf-8")
    finished = plant.replace("# input =", "input =").replace("# gain =", "gain =")
    (tmp_path / "plant.toml").write_text(finished, encoding="utf-8")
    assert run(["fit", str(tmp_path / "session.toml"), "-o", str(tmp_path / "f")]) == 0


def run_fit(folder: Path, capsys: pytest.CaptureFixture[str]) -> str:
    return refused(["fit", str(folder / "session.toml"), "-o", str(folder / "f")], capsys)


def test_a_column_that_did_not_qualify_is_offered_with_its_reason(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    real = channels()
    np.savez(path, t=real["time"], theta=real["position"], torque=np.abs(real["drive"]))
    assert run(["init", str(path), "-o", str(tmp_path)]) == 0
    text = (tmp_path / "session.toml").read_text("utf-8")
    assert '# input = { name = "torque", unit = "Nm" }' in text
    assert "a magnitude without sign" in " ".join(text.replace("\n#", "").split())


def test_json_says_what_was_guessed_and_nothing_else(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write(tmp_path / "run.csv", ("t [s]", "current_mA", "pos"))
    assert run(["init", str(path), "-o", str(tmp_path), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [(one["column"], one["role"], one["unit"]) for one in found["columns"]] == [
        ("t [s]", "time", "s"),
        ("current_mA", "input", "mA"),
        ("pos", "position", "rad"),
    ]
    assert all(one["reason"] for one in found["columns"])
    assert found["drive"]["kind"] == "current_a"
    assert found["complete"] is True
    assert found["to_do"] == []
    assert found["files"] == [str(tmp_path / name) for name in DRAFTS]


@pytest.mark.parametrize("name", DRAFTS)
def test_a_file_that_is_there_is_never_overwritten(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write(tmp_path / "run.csv")
    (tmp_path / name).write_text("mine")
    error = refused(["init", str(path), "-o", str(tmp_path)], capsys)
    assert str(tmp_path / name) in error
    assert "--out" in error
    assert (tmp_path / name).read_text() == "mine"
    assert len(list(tmp_path.iterdir())) == 2


def test_paths_are_relative_to_the_session(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    path = write(tmp_path / "data" / "run.csv")
    out = tmp_path / "a" / "b"
    assert run(["init", str(path), "-o", str(out)]) == 0
    session = tomllib.loads((out / "session.toml").read_text("utf-8"))
    assert session["recordings"][0]["file"] == "../../data/run.csv"
    assert len(st.load(out / "session.toml")) == 1


def test_a_folder_gives_a_session_of_its_recordings(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "data"
    folder.mkdir()
    for seed, stem in enumerate(("log_sine_1", "log_sine_2", "log_steps_1", "log_steps_2")):
        write(folder / f"{stem}.csv", seed=seed)
    write(folder / "other.csv", ("t", "volts", "angle"))
    (folder / "notes.txt").write_text("measured by hand\n")
    (folder / "README").write_text("no recording")
    assert run(["init", str(folder), "-o", str(tmp_path), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [Path(file).name for file in found["left_out"]] == ["notes.txt", "other.csv"]
    assert len(found["recordings"]) == 4
    session = tomllib.loads((tmp_path / "session.toml").read_text("utf-8"))
    assert [entry["kind"] for entry in session["recordings"]] == ["sine"] * 2 + ["steps"] * 2
    text = (tmp_path / "session.toml").read_text("utf-8")
    assert '# file = "data/other.csv"' in text
    assert "it lacks i, theta, and has angle, volts" in " ".join(text.replace("\n#", "").split())


def test_several_files_make_one_session_and_must_agree(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one, two = write(tmp_path / "a.csv"), write(tmp_path / "b.csv", seed=1)
    assert run(["init", str(one), str(two), "-o", str(tmp_path / "o")]) == 0
    assert len(st.load(tmp_path / "o" / "session.toml")) == 2
    capsys.readouterr()
    other = write(tmp_path / "c.csv", ("t", "u", "theta"))
    error = refused(["init", str(one), str(other), "-o", str(tmp_path / "p")], capsys)
    assert str(other) in error
    assert "it lacks i, and has u" in error
    assert not (tmp_path / "p").exists()


REFUSED = {
    "missing": (lambda folder: folder / "none.csv", "there is no such file"),
    "no known ending": (lambda folder: write(folder / "run.csv").rename(folder / "run.xls"),
                        "the ending '.xls' is not known"),
    "empty": (lambda folder: _bytes(folder / "run.csv", b""), "the file is empty"),
    "header only": (lambda folder: _bytes(folder / "run.csv", b"t,i,q\n"), "no rows"),
    "short": (lambda folder: _bytes(folder / "run.csv", b"t,i,q\n" + b"1,2,3\n" * 3), "3 rows"),
    "empty folder": (lambda folder: folder, "there is no recording in this folder"),
    "no table": (lambda folder: _bytes(folder / "a.json", b"{}").parent, "list of records"),
    "binary": (lambda folder: _bytes(folder / "run.npz", b"\x00\x01\x02"), "not an NPZ archive"),
}  # fmt: skip


def _bytes(path: Path, content: bytes) -> Path:
    path.write_bytes(content)
    return path


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_read_is_one_sentence(
    case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    made, words = REFUSED[case]
    folder = tmp_path / "in"
    folder.mkdir()
    path = made(folder)
    error = refused(["init", str(path), "-o", str(tmp_path / "out")], capsys)
    assert str(path) in error
    assert words in error
    assert not (tmp_path / "out").exists()


def test_what_the_names_do_not_show_is_said_at_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write(tmp_path / "run.csv")
    lines = path.read_text().splitlines()
    holes = [line.rpartition(",")[0] + "," for line in lines[1:401]]
    path.write_text("\n".join([lines[0], *holes, *lines[401:]]))
    assert run(["init", str(path), "-o", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    assert "to do: " in text
    assert "position has 400 missing" in text


def test_names_of_any_letters_survive_in_toml(tmp_path: Path) -> None:
    folder = tmp_path / 'it\'s "so" #1\\2'
    try:
        folder.mkdir()
    except OSError:
        pytest.skip("this system has no such file names")
    path = folder / "run µ.npz"
    real = channels()
    names = ('t "quoted" [s]', "i\n\x7f\t# [A]", "theta = \\ é")
    np.savez(path, **dict(zip(names, real.values(), strict=True)))
    assert run(["init", str(path), "-o", str(tmp_path / "o")]) == 0
    session = tomllib.loads((tmp_path / "o" / "session.toml").read_text("utf-8"))
    # What would act on a terminal is escaped, and called so from then on.
    told = (names[0], "i\\n\\x7f\t# [A]", names[2])
    assert [session["columns"][role]["name"] for role in ("time", "input", "position")] == [*told]
    assert len(st.load(tmp_path / "o" / "session.toml")) == 1


@pytest.mark.parametrize(
    ("names", "kinds"),
    [
        (["run1", "run2"], ["", ""]),
        (["a_up_1", "a_up_2", "a_down_1"], ["up", "up", "down"]),
        (["up-2024-01-02", "down-2024-01-02"], ["", ""]),
        (["x_sine_log", "x_sine_log2", "x_step_log"], ["sine", "sine", "step"]),
        (["2024"], [""]),
    ],
)
def test_kinds_come_from_the_words_of_file_names(names: list[str], kinds: list[str]) -> None:
    assert kinds_of([Path(f"{name}.csv") for name in names]) == kinds


REAL = {
    "emps": True,
    "mr_damper": True,
    "pick_and_place": True,
    "rock_rsf": True,
    "dfki_simple_pendulum": True,
    # A servo that is given positions: what drives it was not recorded.
    "xl330": False,
    "sts3215": False,
}


@pytest.mark.parametrize("folder", REAL)
def test_real_recordings_get_drafts_that_a_fit_runs_on(
    shared_data: Path, folder: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["init", str(shared_data / folder), "-o", str(tmp_path), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["complete"] is REAL[folder]
    assert bool(found["to_do"]) is not REAL[folder]
    assert all(tomllib.loads((tmp_path / name).read_text("utf-8")) for name in DRAFTS)
    if REAL[folder]:
        assert run(["fit", str(tmp_path / "session.toml"), "-o", str(tmp_path / "f")]) == 0
    else:
        assert 'kind = "servo"' in (tmp_path / "plant.toml").read_text("utf-8")
        assert any('kind = "servo"' in told for told in found["to_do"])
        assert "no column is known to be the input" in run_fit(tmp_path, capsys)


def test_a_line_of_units_below_the_header_is_taken_at_its_word(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write(tmp_path / "run.csv", ("t", "i", "pos"))
    names, *rows = path.read_text("utf-8").splitlines()
    path.write_text("\n".join([names, "s,mA,deg", *rows, ""]), encoding="utf-8")
    assert run(["init", str(path), "-o", str(tmp_path), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [one["unit"] for one in found["columns"]] == ["s", "mA", "deg"]
    assert found["to_do"] == []
    (recording,) = st.load(tmp_path / "session.toml")
    assert len(recording) == ROWS
    assert recording.input == pytest.approx(1e-3 * channels()["drive"])
    assert recording.position == pytest.approx(np.radians(channels()["position"]))


def test_an_input_that_nothing_tells_the_unit_of_stays_to_do(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    time = 1e-3 * np.arange(4000)
    table = np.column_stack([time, np.sin(5.0 * time), 0.2 * np.sin(3.0 * time)])
    for name in ("effort", "pwm"):
        path = tmp_path / f"{name}.csv"
        np.savetxt(path, table, delimiter=",", header=f"time,{name},position", comments="")
        assert run(["init", str(path), "-o", str(tmp_path / f"draft-{name}")]) == 0
        assert f"to do: state what '{name}' is measured in" in capsys.readouterr().out
        fit = ["fit", str(path), "-o", str(tmp_path / f"fit-{name}")]
        assert run(fit) == 0
        told = f"input = {name} [V is a guess: nothing tells what it is measured in]"
        assert told in capsys.readouterr().out
        assert run([*fit, "--columns", f"input={name} [V]"]) == 0
        assert "is a guess" not in capsys.readouterr().out.splitlines()[0]
