"""``stiction simulate``: all that acted is simulated, and all that is told is told once."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

import stiction as st
from stiction import Plant
from stiction.cli import run
from stiction.cli.recording_run import stems_of
from stiction.plant.begins import load_begins, save_begins
from stiction.residual.effort import started

DT = 1e-3
ROWS = 2000
TIME = np.arange(ROWS) * DT
EFFORT = np.sin(6.0 * TIME)

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
    path.write_text(PLANT, encoding="utf-8")
    return path


def written(path: Path, **columns: np.ndarray) -> Path:
    """A CSV file of these columns."""
    path.parent.mkdir(exist_ok=True)
    rows = np.column_stack(list(columns.values()))
    np.savetxt(path, rows, delimiter=",", comments="", header=",".join(columns), fmt="%.17g")
    return path


def column(path: Path, k: int) -> np.ndarray:
    return np.loadtxt(path, delimiter=",", skiprows=1)[:, k]


def test_an_input_alone_is_simulated_with_all_that_acted_beside_it(
    plant: Path, tmp_path: Path
) -> None:
    load, on = 0.4 * np.cos(5.0 * TIME), (TIME < 1.5) * 1.0
    run_csv = written(tmp_path / "run.csv", time_s=TIME, torque_nm=EFFORT, load_nm=load, enabled=on)
    assert run(["simulate", str(plant), str(run_csv), "-o", str(tmp_path / "o")]) == 0
    expected = Plant.load(plant).simulate(EFFORT[:-1], DT, load=load[:-1], enabled=on[:-1])
    found = column(tmp_path / "o" / "run-trajectory.csv", 1)
    assert found == pytest.approx(expected.position, abs=1e-9)


def test_an_input_alone_is_simulated_with_what_was_set_for_it(plant: Path, tmp_path: Path) -> None:
    written(tmp_path / "run.csv", time_s=TIME, torque_nm=EFFORT)
    session = tmp_path / "session.toml"
    session.write_text(
        '[[recordings]]\nfile = "run.csv"\npayload_kg = 2.0\npayload_m = 0.1\n', encoding="utf-8"
    )
    assert run(["simulate", str(plant), str(session), "-o", str(tmp_path / "o")]) == 0
    heavy = Plant.load(plant).under({"payload_kg": 2.0, "payload_m": 0.1})
    expected = heavy.simulate(EFFORT[:-1], DT)
    found = column(tmp_path / "o" / "run-trajectory.csv", 1)
    assert found == pytest.approx(expected.position, abs=1e-9)


def test_recordings_of_one_name_keep_their_files_apart(
    plant: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = ("a/run.csv", "b/run.csv", "c/run.csv", "other.csv")
    for k, name in enumerate(files, 1):
        written(tmp_path / name, time_s=TIME, torque_nm=k * EFFORT)
    session = tmp_path / "session.toml"
    listed = "".join(f'[[recordings]]\nfile = "{name}"\n' for name in files)
    session.write_text(listed, encoding="utf-8")
    out = tmp_path / "o"
    assert run(["simulate", str(plant), str(session), "-o", str(out), "--json"]) == 0
    stems = ["a-run", "b-run", "c-run", "other"]
    assert [each["recording"] for each in json.loads(capsys.readouterr().out)] == stems
    assert {path.name for path in out.iterdir()} == {f"{stem}-trajectory.csv" for stem in stems}


def test_files_that_differ_in_their_ending_or_fold_into_one_are_told_apart(tmp_path: Path) -> None:
    columns = {"time_s": TIME, "torque_nm": EFFORT}
    files = [
        written(tmp_path / name, **columns) for name in ("run.csv", "a/x.csv", "b/x.csv", "b-x.csv")
    ]
    np.savez(tmp_path / "run.npz", **columns)
    recordings = [st.Recording.load(file) for file in (*files, tmp_path / "run.npz")]
    stems = stems_of(recordings)
    assert stems[0] == "run-csv"
    assert stems[4] == "run-npz"
    assert len(set(stems)) == len(stems)
    assert stems_of(recordings[:1]) == ["run"]


def test_a_loop_that_cannot_be_simulated_says_so_in_json_too(
    plant: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with plant.open("a", encoding="utf-8") as file:
        file.write('[controller]\nkind = "pd"\nkp = -9.0\n')
    position = 0.1 * np.sin(6.0 * TIME)
    path = written(
        tmp_path / "run.csv",
        time_s=TIME, torque_nm=EFFORT, position_rad=position, reference_rad=position,
    )  # fmt: skip
    assert run(["simulate", str(plant), str(path), "-o", str(tmp_path / "o"), "--json"]) == 0
    loop = json.loads(capsys.readouterr().out)["closed_loop"]
    assert list(loop) == ["error"]
    assert "runs away" in loop["error"]


def test_a_drive_that_gives_nothing_leaves_an_error_without_a_share(
    plant: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with plant.open("a", encoding="utf-8") as file:
        file.write('[[effects]]\nname = "drive_deadband"\ndeadband = 2.0\n')
    position = 0.1 * np.sin(6.0 * TIME)
    path = written(tmp_path / "run.csv", time_s=TIME, torque_nm=EFFORT, position_rad=position)
    command = ["simulate", str(plant), str(path), "-o", str(tmp_path / "o")]
    assert run(command) == 0
    assert "N·m rms, and the measured effort is 0" in capsys.readouterr().out
    assert run([*command[:-1], str(tmp_path / "json"), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["effort_residual"]
    assert found["relative"] is None
    assert found["rms"] > 0.1


def test_a_repair_is_told_once(
    plant: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    holed = EFFORT.copy()
    holed[700:703] = np.nan
    path = written(tmp_path / "run.csv", time_s=TIME, torque_nm=holed)
    assert run(["simulate", str(plant), str(path), "-o", str(tmp_path / "o")]) == 0
    lines = [line.strip() for line in capsys.readouterr().out.splitlines()]
    assert len([line for line in lines if "interpolated" in line]) == 1
    assert len(set(lines)) == len(lines)


def test_a_velocity_alone_is_refused_with_what_would_do(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    machine = tmp_path / "damper.toml"
    machine.write_text(
        '[drive]\nkind = "prescribed_motion"\n[friction]\nlaw = "coulomb"\n', encoding="utf-8"
    )
    path = written(tmp_path / "swept.csv", time_s=TIME, torque_nm=EFFORT, velocity_rad_s=EFFORT)
    assert run(["simulate", str(machine), str(path), "-o", str(tmp_path / "o")]) == 2
    said = capsys.readouterr().err
    assert said.count("swept") == 1
    assert "there is no position" in said
    assert "call it position_rad" in said


@pytest.mark.parametrize("motion", ["rotary", "linear"])
def test_what_simulate_writes_is_a_recording(motion: str, tmp_path: Path) -> None:
    effort, position, velocity = (
        ("torque_nm", "position_rad", "velocity_rad_s")
        if motion == "rotary"
        else ("force_n", "position_m", "velocity_m_s")
    )
    friction, load = ("friction_nm", "load_nm") if motion == "rotary" else ("friction_n", "load_n")
    machine = tmp_path / "machine.toml"
    text = PLANT.replace("torque_nm", effort).replace('"coulomb"', '"hsieh_pan"')
    sensor = "counts_per_rev = 65536" if motion == "rotary" else "count_m = 1e-6"
    machine.write_text(f'[motion]\nkind = "{motion}"\n{text}[sensor]\n{sensor}\n')
    pushed = {"time_s": TIME, effort: EFFORT, load: 0.1 * np.cos(4.0 * TIME)}
    path = written(tmp_path / "run.csv", **pushed)
    out = tmp_path / "o"
    assert run(["simulate", str(machine), str(path), "-o", str(out)]) == 0
    made = out / "run-trajectory.csv"
    header = made.read_text(encoding="utf-8").splitlines()[0].split(",")
    assert header[0] == "time_s"
    assert {position, velocity, friction, effort, load} <= set(header)
    again = st.session.load_recording(made, Plant.load(machine))
    assert again.position is not None
    assert again.input == pytest.approx(EFFORT[1:], abs=0.0)
    # Row by row it is the motion of the plant: simulated from there it comes out once more.
    first = st.residual.free_run(Plant.load(machine), again)
    assert first.rms < 1e-3 * np.ptp(again.position)
    assert run(["init", str(made), "-o", str(tmp_path / "draft")]) == 0
    (drafted,) = st.load(tmp_path / "draft" / "session.toml")
    assert drafted.position == pytest.approx(again.position, abs=0.0)
    assert drafted.input == pytest.approx(again.input, abs=0.0)
    assert drafted.motion == motion


PRESLIDING = """
[drive]
input = "torque_nm"
gain = 1.0
[body]
inertia = { value = 0.0076, fixed = true }
[friction]
law = "dahl"
coulomb = { value = 0.4, fixed = true }
initial_stiffness = 400.0
viscous = { value = 1.0, fixed = true }
"""
DRIVE = {"input": "torque_nm", "gain": 1.0}
BEGIN = {"clock_s": 3.0, "path": 0.5, "force": 0.2}


@pytest.fixture
def preloaded(tmp_path: Path) -> tuple[Path, Path]:
    """A plant and a recording far below break-away, which begins with a bent contact."""
    path = tmp_path / "plant.toml"
    path.write_text(PRESLIDING, encoding="utf-8")
    plant = Plant.load(path)
    effort = 0.2 + 0.1 * np.sin(6.0 * TIME)
    motor = started(plant, 0.0, 0.0, {"force": BEGIN["force"]})
    position = np.append(0.0, motor.simulate(effort[:-1], DT).position)
    return path, written(tmp_path / "run.csv", time_s=TIME, torque_nm=effort, position_rad=position)


def error_of(path: Path, plant: Path, recording: Path, capsys) -> tuple[float, float]:
    capsys.readouterr()
    assert run(["simulate", str(plant), str(recording), "-o", str(path), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    return told["free_run"]["rms"], told["effort_residual"]["relative"]


def test_a_recording_begins_as_the_file_beside_the_plant_says(preloaded, tmp_path, capsys):
    plant, recording = preloaded
    never = error_of(tmp_path / "o", plant, recording, capsys)
    save_begins(tmp_path, {"run.csv": BEGIN, "other.csv": BEGIN | {"force": -0.3}})
    begun = error_of(tmp_path / "o", plant, recording, capsys)
    assert begun[0] < 0.01 * never[0]
    assert begun[1] < 0.1 * never[1]


def test_a_fit_can_be_simulated_again(preloaded, tmp_path, capsys):
    _, recording = preloaded
    session = tmp_path / "session.toml"
    session.write_text('plant = "plant.toml"\n[[recordings]]\nfile = "run.csv"\n', encoding="utf-8")
    assert run(["fit", str(session), "-o", str(tmp_path / "fit")]) == 0
    begins = tomllib.loads((tmp_path / "fit" / "begins.toml").read_text(encoding="utf-8"))
    assert begins["run.csv"]["force"] == pytest.approx(BEGIN["force"], abs=0.01)
    rms, _ = error_of(tmp_path / "o", tmp_path / "fit" / "plant.toml", recording, capsys)
    assert rms < 1e-5


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ('["run.csv"]\nclock_s = 0.0\npath = 0.0\nforces = 1.0\n', "forces"),
        ('["run.csv"]\nforce = 1.0\n', "clock_s, path are needed"),
        ('["run.csv"]\nclock_s = 0.0\npath = 0.0\nforce = "a"\n', "force: 'a'"),
        ('"run.csv" = 3\n', "no table"),
        ("[\n", "begins.toml"),
    ],
)
def test_a_file_of_begins_that_is_none_is_refused(preloaded, tmp_path, capsys, text, word):
    plant, recording = preloaded
    (tmp_path / "begins.toml").write_text(text, encoding="utf-8")
    assert run(["simulate", str(plant), str(recording), "-o", str(tmp_path / "o")]) == 2
    said = capsys.readouterr().err
    assert word in said
    assert "begins.toml" in said


def test_a_name_of_any_characters_comes_back(tmp_path):
    plant = Plant.from_dict({"friction": {"law": "dahl"}, "body": {"inertia": 1.0}, "drive": DRIVE})
    found = {'a "b"\\c\n\x01é.csv': BEGIN}
    save_begins(tmp_path, found)
    assert load_begins(tmp_path / "plant.toml", plant) == found
