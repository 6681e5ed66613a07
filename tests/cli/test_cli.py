"""The command line: answers on stdout, one sentence on stderr, exit status."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from stiction.cli import run

PLANT = """
[drive]
input = "torque_nm"
gain = 1.0
[body]
inertia = 0.0076
[friction]
law = "coulomb"
coulomb = 0.3
viscous = 0.05
"""


@pytest.fixture
def plant(tmp_path: Path) -> Path:
    path = tmp_path / "plant.toml"
    path.write_text(PLANT)
    return path


def recording(
    folder: Path, *, motion: bool = True, names: tuple[str, str, str] | None = None
) -> Path:
    from stiction import Plant

    time = np.arange(2000) * 1e-3
    effort = np.sin(6.0 * time)
    position = np.concatenate(
        [[0.0], Plant.load(folder / "plant.toml").simulate(effort[:-1], 1e-3).position]
    )
    header = names or ("time_s", "torque_nm", "position_rad")
    columns = [time, effort, position] if motion else [time, effort]
    path = folder / "run.csv"
    np.savetxt(path, np.column_stack(columns), delimiter=",", comments="",
               header=",".join(header[: len(columns)]), fmt="%.12g")  # fmt: skip
    return path


def test_simulate_prints_both_errors_and_writes_figures(
    plant: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert run(["simulate", str(plant), str(recording(tmp_path)), "-o", str(out)]) == 0
    text = capsys.readouterr().out
    assert "free run: position error" in text
    assert "effort along the measured motion: error" in text
    names = {path.name for path in out.iterdir()}
    assert {"run-free-run.svg", "run-effort-residual.png", "run-trajectory.csv"} <= names


def test_simulate_takes_columns_and_prints_json_alone(
    plant: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = recording(tmp_path, names=("t", "u", "angle"))
    columns = "time=t, input=u [Nm], position=angle [rad]"
    arguments = ["simulate", str(plant), str(path), "--columns", columns, "--json"]
    assert run([*arguments, "--out", str(tmp_path / "o")]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["free_run"]["rms"] < 1e-9
    assert data["effort_residual"]["relative"] < 0.05


def test_simulate_takes_a_session_file(
    plant: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording(tmp_path, names=("t", "u", "angle"))
    session = tmp_path / "session.toml"
    session.write_text(
        '[columns]\ntime = "t"\ninput = { name = "u", unit = "N·m" }\nposition = "angle"\n'
        '[[recordings]]\nfile = "run.csv"\nkind = "sine"\n'
    )
    assert run(["simulate", str(plant), str(session), "-o", str(tmp_path / "o")]) == 0
    assert "free run" in capsys.readouterr().out


def test_an_input_alone_is_simulated(
    plant: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = recording(tmp_path, motion=False)
    assert run(["simulate", str(plant), str(path), "-o", str(tmp_path / "o")]) == 0
    text = capsys.readouterr().out
    assert "simulated: 1999 samples" in text
    assert "error" not in text


@pytest.mark.parametrize("verb", ["laws", "effects"])
def test_the_catalogue_is_listed_and_shown(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run([verb, "--json"]) == 0
    records = json.loads(capsys.readouterr().out)
    assert run([verb]) == 0
    listing = capsys.readouterr().out
    for record in records:
        assert record["name"] in listing
        assert run([verb, record["name"]]) == 0
        page = capsys.readouterr().out
        assert all(parameter["name"] in page for parameter in record["parameters"])


REFUSED = {
    "unknown verb": (["simulat"], "simulat"),
    "unknown option": (["laws", "--nosuch"], "--nosuch"),
    "missing argument": (["simulate"], "PLANT is missing; write stiction simulate PLANT"),
    "unknown law": (["laws", "colomb"], "did you mean 'coulomb'"),
    "unknown effect": (["effects", "coging"], "did you mean 'cogging'"),
    "missing plant": (["simulate", "none.toml", "none.csv"], "none.toml: there is no such file"),
}


@pytest.mark.parametrize("fault", REFUSED)
def test_an_unreadable_request_is_one_sentence_and_exit_2(
    fault: str, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments, sentence = REFUSED[fault]
    assert run(arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert sentence in captured.err
    assert captured.err.count("\n") == 1


def test_bad_recordings_and_columns_exit_2(
    plant: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = recording(tmp_path)
    for arguments, sentence in (
        ([str(path), "--columns", "time"], "is not role=name"),
        ([str(path), "--columns", "time=nosuch"], "nosuch"),
        ([str(path), "--columns", "tme=time_s"], "tme"),
        ([str(tmp_path / "none.csv")], "none.csv"),
        ([str(plant)], "recordings"),
    ):
        assert run(["simulate", str(plant), *arguments]) == 2, arguments
        captured = capsys.readouterr()
        assert sentence in captured.err
        assert captured.err.count("\n") == 1


@pytest.mark.parametrize("support", ["nan", "inf", "1e300", "-1", "0"])
def test_a_kernel_that_cannot_be_is_refused(
    plant: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], support: str
) -> None:
    path = recording(tmp_path)
    arguments = ["simulate", str(plant), str(path), f"--support={support}", "-o", str(tmp_path)]
    assert run(arguments) == 2
    captured = capsys.readouterr()
    assert "support" in captured.err
    assert str(path) in captured.err
    assert captured.err.count("\n") == 1
    assert run([*arguments[:3], "--support=0.017", *arguments[4:]]) == 0
    assert "kernel of 17 ms" in capsys.readouterr().out


def test_absurd_cells_are_refused_in_one_sentence(
    plant: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = recording(tmp_path)
    lines = path.read_text().splitlines()
    cells = lines[700].split(",")
    path.write_text("\n".join([*lines[:700], f"{cells[0]},1e300,{cells[2]}", *lines[701:]]))
    assert run(["simulate", str(plant), str(path), "-o", str(tmp_path)]) == 2
    captured = capsys.readouterr()
    assert str(path) in captured.err
    assert captured.err.count("\n") == 1


@pytest.mark.parametrize("verb", ["laws", "effects"])
def test_the_catalogue_is_written_where_that_is_asked_for(verb: str, tmp_path: Path) -> None:
    assert run([verb, "-o", str(tmp_path / "o")]) == 0
    assert json.loads((tmp_path / "o" / f"{verb}.json").read_text())


def test_help_and_version_answer(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["--version"]) == 0
    assert capsys.readouterr().out.startswith("stiction ")
    assert run(["--help"]) == 0
    assert "simulate" in capsys.readouterr().out


def test_import_is_quick() -> None:
    code = (
        "import time; t = time.perf_counter(); import stiction; "
        "import sys; print(time.perf_counter() - t); "
        "assert not {'scipy', 'matplotlib', 'jinja2'} & set(sys.modules)"
    )
    runs = [
        float(subprocess.run([sys.executable, "-c", code], capture_output=True, check=True).stdout)
        for _ in range(3)
    ]
    # The promise is 0.3 s on a laptop; a loaded test machine gets some room.
    assert min(runs) < 1.0
