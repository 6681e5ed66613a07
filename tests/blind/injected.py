"""Effects hidden in recordings of real machines: their motion stays, and their input is changed.

    python -m tests.blind.injected --sizes 0.1 --out injected.jsonl
    python -m tests.blind.injected --only emps --only dfki --sizes 0.03,0.1 --out injected.jsonl

The input of a recording becomes the one that would have been needed had the machine one effect
more: its readings, clock, noise and misfit are the real ones. A session counts against what is told
of the recordings as they are. Sizes are the rms of what is hidden, as a share of the dry friction.
Every session is a line of the `.jsonl` as soon as it is judged; the same command goes on where it
was.

A controller that is stated is left out: it did not command the changed input. Servos are left out,
whose input is a goal.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

import stiction as st

from .__main__ import read_rows
from .real import data_folder, lay, machines
from .score import families_of
from .table import rate

FloatArray = npt.NDArray[np.float64]
ONE_THING = frozenset({"torque_bias", "direction_asymmetry"})
"""Which beside true stick nothing tells apart."""
SMOOTHED_S = 0.03
"""Over which speeds are taken of readings."""


@dataclass(frozen=True)
class Moved:
    """A recording as effects see it: position, speed and effort of the drive, SI.

    ``dry`` is the level of friction, ``fast`` the usual speed and ``span`` the range of positions.
    """

    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    effort: FloatArray
    rotary: bool
    dry: float
    fast: float
    span: float


Needed = Callable[[Moved, float], FloatArray]
"""What the effort becomes with an effect of some strength, from 0 on."""


def _sign(moved: Moved) -> FloatArray:
    return np.tanh(moved.velocity / (0.02 * moved.fast))


def _angle(moved: Moved, periods: float) -> FloatArray:
    """Phase of a wave: periods a turn, or over the range of a linear axis."""
    return moved.position * (periods if moved.rotary else 2.0 * np.pi * periods / moved.span) + 0.7


def _late(moved: Moved, seconds: float) -> FloatArray:
    """The effort that was asked for so long before it acted."""
    return np.interp(moved.time + seconds, moved.time, moved.effort)


EFFECTS: dict[str, Needed] = {
    "torque_bias": lambda m, a: m.effort + a,
    "viscous_quadratic": lambda m, a: m.effort + a * m.velocity * np.abs(m.velocity),
    "stribeck": lambda m, a: (
        m.effort + a * _sign(m) * np.exp(-((m.velocity / (0.15 * m.fast)) ** 2))
    ),
    "cogging": lambda m, a: m.effort + a * np.sin(_angle(m, 7.0)),
    "position_dependent_friction": lambda m, a: m.effort + a * _sign(m) * np.cos(_angle(m, 3.0)),
    "drive_deadband": lambda m, a: m.effort + a * np.tanh(m.effort / (0.02 * m.dry)),
    "torque_constant_saturation": lambda m, a: m.effort * (1.0 + a * m.effort**2),
    "input_delay": _late,
}
"""Effects by their name in the catalogue, as the effort that a machine with them is asked for. The
forms are written down here and not asked of the library."""


def hidden(
    recordings: Sequence[st.Recording], plant: st.Plant, dry: float, name: str, size: float
) -> list[st.Recording]:
    """The same motions with the inputs that one more effect would need.

    Parameters
    ----------
    recordings : sequence of Recording
    plant : Plant
        For gain and kind of motion.
    dry : float
        Level of friction, N·m or N.
    name : str
        One of ``EFFECTS``.
    size : float
        rms over all recordings of what the effort changes by, as a share of ``dry``.
    """
    moved = [_moved(each, plant, dry) for each in recordings]
    fast = float(np.sqrt(np.mean(np.concatenate([m.velocity for m in moved]) ** 2)))
    span = max(float(np.ptp(m.position)) for m in moved)
    moved = [replace(each, fast=fast, span=span) for each in moved]

    def reached(strength: float) -> float:
        parts = [EFFECTS[name](m, strength) - m.effort for m in moved]
        return float(np.sqrt(np.mean(np.concatenate(parts) ** 2))) / dry

    low, high = 0.0, 1e-12
    while reached(high) < size:
        low, high = high, 2.0 * high
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if reached(middle) < size else (low, middle)
    return [
        each.with_input((EFFECTS[name](m, high)) / plant.gain)
        for each, m in zip(recordings, moved, strict=True)
    ]


def _moved(recording: st.Recording, plant: st.Plant, dry: float) -> Moved:
    position, effort = recording.position, recording.input
    assert position is not None
    assert effort is not None
    half = max(1, round(0.5 * SMOOTHED_S / recording.dt))
    window = np.hanning(2 * half + 3)
    padded = np.pad(position, half + 1, mode="edge")
    smooth = np.convolve(padded, window / window.sum(), mode="valid")
    velocity = np.gradient(smooth, recording.time)
    rotary = plant.motion == "rotary"
    return Moved(recording.time, position, velocity, plant.gain * effort, rotary, dry, 1.0, 1.0)


def sessions(only: Sequence[str]) -> list[tuple[str, st.Plant, list[st.Recording]]]:
    """Real machines that are driven, without the controllers that are stated of them."""
    found = []
    for machine in machines(data_folder(), turn=0):
        if only and machine.name.split()[0] not in only and machine.name not in only:
            continue
        with tempfile.TemporaryDirectory() as folder:
            session = st.load(lay(machine, data_folder(), Path(folder)))
        plant = session.plant
        driven = not (plant.servo or plant.prescribed_motion)
        if driven and all(each.input is not None for each in session):
            found.append((machine.name, replace(plant, controller={}), list(session)))
    return found


def told(found: st.Diagnosis) -> list[dict[str, Any]]:
    """Names, whether they are sure, and what else they may be."""
    return [
        {"name": c.name, "sure": c.decided, "or": [str(each) for each in c.look_alikes]}
        for c in found.effects
    ]


def judged(
    machine: str,
    plant: st.Plant,
    recordings: Sequence[st.Recording],
    name: str,
    size: float,
    dry: float,
    before: list[dict[str, Any]],
) -> dict[str, Any]:
    """One session: a line of the results."""
    began = time.process_time()
    found = st.diagnose(plant, hidden(recordings, plant, dry, name, size), threads=1)
    after = told(found)
    listed = {each["name"] for each in after} | {w for each in after for w in each["or"]}
    alike = {name} | (ONE_THING if name in ONE_THING else frozenset())
    families = families_of()
    known = {each["name"] for each in before} | {w for each in before for w in each["or"]}
    new = [c["name"] for c in after if c["sure"] and c["name"] not in known | alike]
    return {
        "key": f"{machine} {name} {size}",
        "machine": machine,
        "hidden": name,
        "size": size,
        "verdict": found.verdict,
        "before": before,
        "after": after,
        "named": any(c["name"] in alike for c in after),
        "listed": bool(listed & alike),
        "class": any(families.get(each) == families.get(name) for each in listed),
        "sure_and_wrong": new,
        "seconds": time.process_time() - began,
    }


def report(rows: Sequence[dict[str, Any]]) -> str:
    """Rates by size, as Markdown."""
    lines = [
        "| rms over dry friction | sessions | name | in the list | class | sure and wrong |",
        "|---|---|---|---|---|---|",
    ]
    for size in sorted({row["size"] for row in rows if row["hidden"]}):
        own = [row for row in rows if row["hidden"] and row["size"] == size]
        cells = [
            rate(own, lambda row, key=key: row[key])
            for key in ("named", "listed", "class", "sure_and_wrong")
        ]
        lines.append(f"| {size:g} | {len(own)} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Every effect in every machine."""
    args = _arguments()
    rows = read_rows(args.out)
    done = {row["key"] for row in rows}

    def keep(row: dict[str, Any]) -> None:
        with args.out.open("a", encoding="utf-8") as file:
            file.write(json.dumps(row) + "\n")
        rows.append(row)
        said = ", ".join(c["name"] + ("" if c["sure"] else "?") for c in row["after"])
        print(f"{row['key']}: {row['verdict']} [{said}] {row['seconds']:.0f} s", flush=True)

    for machine, plant, recordings in sessions(args.only):
        level = st.fit(plant, recordings).parameters.get("friction.coulomb")
        if level is None or not level.value > 0.0:
            print(f"{machine}: its law has no level of friction; left out")
            continue
        key = f"{machine} as it is"
        if key not in done:
            began = time.process_time()
            found = st.diagnose(plant, recordings, threads=1)
            own = {"key": key, "machine": machine, "hidden": "", "size": 0.0}
            seconds = time.process_time() - began
            keep(own | {"verdict": found.verdict, "after": told(found), "seconds": seconds})
        before = next(row["after"] for row in rows if row["key"] == key)
        for size in args.sizes:
            for name in args.effects:
                if f"{machine} {name} {size}" not in done:
                    keep(judged(machine, plant, recordings, name, size, level.value, before))
    text = report(rows)
    args.out.with_suffix(".md").write_text(text, encoding="utf-8")
    print(text)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.blind.injected", description=__doc__)
    parser.add_argument("--only", action="append", default=[], help="a machine; several times")
    parser.add_argument("--sizes", type=_sizes, default=(0.1,), help="0.03,0.1,0.3")
    parser.add_argument("--effects", type=_effects, default=tuple(EFFECTS), help="names, by commas")
    parser.add_argument("--out", type=Path, default=Path("injected.jsonl"), help="a line a session")
    return parser.parse_args()


def _sizes(text: str) -> tuple[float, ...]:
    return tuple(float(word) for word in text.split(","))


def _effects(text: str) -> tuple[str, ...]:
    words = tuple(text.split(","))
    for word in words:
        if word not in EFFECTS:
            raise argparse.ArgumentTypeError(f"{word!r} is none of {', '.join(EFFECTS)}")
    return words


if __name__ == "__main__":
    main()
