"""What a session of the reference plant consists of, and its files."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

SAMPLE_TIME = 1e-3


@dataclass
class HiddenEffect:
    """A hidden effect of a session: what was asked for and what it became."""

    name: str
    form: str
    size: float | None  # RMS of the hidden torque / F_c, asked for
    shape: dict
    amplitude: float = 0.0
    reached: float = 0.0  # the same, measured as the size is
    raw: float = 0.0  # the same without any smoothing
    smoothed: float = 0.0  # the same behind a kernel of 30 ms
    last: tuple | None = None  # amplitude and size of the simulation before
    aim: float | None = None  # in place of the amplitude, of effects that a shape brings to size


@dataclass
class Recording:
    """Columns at 1 kHz; row k is the state at time_s[k] and the input that holds from there."""

    kind: str
    role: str
    start_s: float
    time_s: np.ndarray
    torque_nm: np.ndarray  # commanded
    position_rad: np.ndarray  # read by the encoder
    reference_rad: np.ndarray | None
    truth: dict  # hidden, parts (effect, sample), position, velocity, friction
    load_nm: np.ndarray | None = None  # external effort on the body
    temperature_c: np.ndarray | None = None
    cold: bool = False  # switched on anew: clock and path of the effects begin at 0

    @property
    def name(self):
        return f"{self.kind}_{self.role}"


@dataclass
class Session:
    """Recordings in the order in which they were made."""

    spec: object  # of session_reference
    plant: dict
    controller: dict
    recordings: list
    effects: list = field(default_factory=list)

    def write(self, folder, truth=False):
        """Write session.toml, plant.toml and the CSVs; `truth` adds truth.json."""
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        lines = ['plant = "plant.toml"\n']
        for i, r in enumerate(self.recordings):
            file = f"{i + 1:02d}_{r.name}.csv"
            _write_csv(folder / file, r)
            lines.append(
                f'\n[[recordings]]\nfile = "{file}"\nrole = "{r.role}"\n'
                f'kind = "{r.kind}"\nstart_s = {r.start_s:.3f}\n'
                + ("cold = true\n" if r.cold else "")
            )
        (folder / "session.toml").write_text("".join(lines), encoding="utf-8")
        sensor = f"\n[sensor]\ncounts_per_rev = {self.spec.counts_per_rev}\n"
        (folder / "plant.toml").write_text(
            '[motion]\nkind = "rotary"\n\n[drive]\ninput = "torque_nm"\ngain = 1.0\n\n'
            f'[friction]\nlaw = "{self.spec.base}"\n'
            + (sensor if self.spec.counts_per_rev else ""),
            encoding="utf-8",
        )
        if truth:
            _write_truth(folder / "truth.json", self)
        return folder


def rms_behind_kernel(columns, support):
    """RMS of columns smoothed by a cubic B-spline of `support` seconds (0: as they are)."""
    box = round(support / 4.0 / SAMPLE_TIME)
    for _ in range(4 if box > 1 else 0):
        total = np.cumsum(columns, axis=0)
        columns = (total[box:] - total[:-box]) / box
    return float(np.sqrt(np.mean(columns**2)))


def _write_csv(path, recording):
    names = ["time_s", "torque_nm", "position_rad"]
    columns = [recording.time_s, recording.torque_nm, recording.position_rad]
    for name in ("reference_rad", "load_nm", "temperature_c"):
        if (column := getattr(recording, name)) is not None:
            names.append(name)
            columns.append(column)
    row = ",".join(["%.3f"] + ["%.12g"] * (len(columns) - 1))
    table = np.column_stack(columns).tolist()
    text = "\n".join([",".join(names), *(row % tuple(line) for line in table)])
    path.write_text(text + "\n", encoding="utf-8")


def _write_truth(path, session):
    def plain(value):
        return value.tolist() if isinstance(value, np.ndarray) else value

    found = {
        "plant": {k: plain(v) for k, v in session.plant.items()},
        "controller": session.controller,
        "effects": [
            vars(e) | {"shape": {k: plain(v) for k, v in e.shape.items()}} for e in session.effects
        ],
    }
    path.write_text(json.dumps(found, indent=1), encoding="utf-8")
