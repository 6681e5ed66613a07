"""``stiction simulate``: all that acted is simulated, and all that is told is told once."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from stiction import Plant
from stiction.cli import run

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
