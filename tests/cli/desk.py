"""A good session in a folder, whose parts tests can spoil."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

# Long enough to be cut into blocks: 6.4 s.
ROWS = 640
DT = 1e-2

PLANT = """\
[motion]
kind = "rotary"
[drive]
input = "torque_nm"
gain = 1.0
[body]
inertia = 0.01
[friction]
law = "coulomb"
coulomb = 0.2
viscous = 0.05
[[effects]]
name = "torque_bias"
[sensor]
counts_per_rev = 4096
[controller]
kind = "pd"
kp = 2.0
"""

SESSION = """\
plant = "plant.toml"
[columns]
time = "t"
input = { name = "u", unit = "Nm" }
position = { name = "q", unit = "rad" }
[[recordings]]
file = "run.csv"
kind = "sine"
"""


class Desk:
    """A folder with a good session, whose parts can be spoiled."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.session = folder / "session.toml"
        self.plant = folder / "plant.toml"
        self.csv = folder / "run.csv"
        self.arguments: list[str] = []
        self.session.write_text(SESSION, encoding="utf-8")
        self.plant.write_text(PLANT, encoding="utf-8")
        self.columns = motion()
        self.write_csv()

    def loop(self) -> Path:
        """A session file beside it whose reference is the motion itself."""
        path = self.folder / "loop.toml"
        reference = 'reference = { name = "q", unit = "rad" }\n[[recordings]]'
        path.write_text(SESSION.replace("[[recordings]]", reference), encoding="utf-8")
        return path

    def parameters(self) -> Path:
        """A file of parameters of better-actuator-models beside it."""
        path = self.folder / "params.json"
        numbers = {"kt": 1.6, "R": 3.0, "armature": 0.01, "friction_base": 0.1}
        table = {"model": "m1", "actuator": "mx64", "friction_viscous": 0.02, **numbers}
        path.write_text(json.dumps(table), encoding="utf-8")
        return path

    def write_csv(self) -> None:
        """The columns as they are now, into run.csv."""
        rows = [",".join(map(repr, row)) for row in zip(*map(list, self.floats()), strict=True)]
        self.csv.write_text("\n".join([",".join(self.columns), *rows, ""]), encoding="utf-8")

    def floats(self) -> list[list[float]]:
        return [[float(cell) for cell in column] for column in self.columns.values()]

    def edit(self, file: Path, old: str, new: str) -> None:
        """Replace a text that stands in a file once."""
        text = file.read_text(encoding="utf-8")
        assert text.count(old) == 1, f"{old!r} stands {text.count(old)} times in {file.name}"
        file.write_text(text.replace(old, new), encoding="utf-8")

    def line(self, number: int, new: Callable[[str], str]) -> None:
        """Replace a line of run.csv, counted from 1 as editors do."""
        lines = self.csv.read_text(encoding="utf-8").split("\n")
        lines[number - 1] = new(lines[number - 1])
        self.csv.write_text("\n".join(lines), encoding="utf-8")

    def cells(self, name: str, rows: slice, value: float) -> None:
        """Overwrite cells of a column of run.csv."""
        self.columns[name][rows] = value
        self.write_csv()

    def instead(self, name: str) -> Path:
        """Let the session name another file than run.csv."""
        self.edit(self.session, '"run.csv"', f'"{name}"')
        return self.folder / name


def motion() -> dict[str, np.ndarray]:
    """A shaft that swings, and the torque that would make it: made with NumPy alone."""
    t = DT * np.arange(ROWS)
    q = 0.4 * np.sin(5.0 * t) + 0.1 * np.sin(17.0 * t)
    v = 2.0 * np.cos(5.0 * t) + 1.7 * np.cos(17.0 * t)
    a = -10.0 * np.sin(5.0 * t) - 28.9 * np.sin(17.0 * t)
    noise = 1e-4 * np.random.default_rng(3).standard_normal(ROWS)
    return {"t": t, "u": 0.01 * a + 0.05 * v + 0.2 * np.tanh(50.0 * v) + noise, "q": q}


def in_csv(folder: Path) -> Desk:
    return Desk(folder)


def in_npz(folder: Path) -> Desk:
    desk = Desk(folder)
    np.savez(desk.instead("run.npz"), **desk.columns)
    return desk


def in_mat(folder: Path) -> Desk:
    from scipy.io import savemat

    desk = Desk(folder)
    savemat(desk.instead("run.mat"), desk.columns)
    return desk


def in_json(folder: Path) -> Desk:
    desk = Desk(folder)
    rows = [dict(zip(desk.columns, row, strict=True)) for row in zip(*desk.floats(), strict=True)]
    desk.instead("run.json").write_text(json.dumps(rows))
    return desk


def in_parquet(folder: Path) -> Desk:
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    desk = Desk(folder)
    parquet.write_table(pyarrow.table(desk.columns), desk.instead("run.parquet"))
    return desk


def of_two(folder: Path) -> Desk:
    """Two recordings, of which the second tests."""
    desk = Desk(folder)
    first, *lines = desk.csv.read_text(encoding="utf-8").splitlines()
    (folder / "two.csv").write_text("\n".join([first, *lines[5:]]), encoding="utf-8")
    with desk.session.open("a", encoding="utf-8") as file:
        file.write('[[recordings]]\nfile = "two.csv"\nrole = "test"\n')
    return desk


def moved(folder: Path) -> Desk:
    """A linear machine with prescribed motion."""
    desk = Desk(folder)
    desk.plant.write_text(
        '[motion]\nkind = "linear"\n[drive]\nkind = "prescribed_motion"\n'
        '[friction]\nlaw = "coulomb"\n'
    )
    desk.edit(desk.session, 'input = { name = "u", unit = "Nm" }', 'effort = "u"')
    desk.edit(desk.session, 'unit = "rad"', 'unit = "mm"')
    return desk
