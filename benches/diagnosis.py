"""What a diagnosis costs by the command, from the files to the last page, beside a loop in C.

Sessions come from the reference plant of the tests, which shares no code with the core; the servo
logs are recordings that STICTION_DATA leads to. Each figure is seconds of a clock, seconds of a
processor and the largest resident memory of a process of its own, and the first of these as a
multiple of what the loop in C (`c/hsieh_pan.c`, 10⁸ samples) took just before it.

    python -m benches.diagnosis [--only NAMES] [--seed 1] [--threads 2] [--json FILE] [--keep DIR]
"""

from __future__ import annotations

import argparse
import ctypes
import json
import os
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from benches.peers import SAMPLES, c_loop, efforts
from tests.blind import real
from tests.reference.session_reference import make_session

YARDSTICK_SAMPLES = 100_000_000

Lay = Callable[[int, Path], Path]


@dataclass(frozen=True)
class Case:
    """A session and what its diagnosis may cost.

    Attributes
    ----------
    lay : callable
        Writes it from a seed into a folder and returns its session file.
    seconds : float
        Of a clock at most, on two cores.
    megabytes : float, optional
        Of resident memory at most.
    """

    lay: Lay
    seconds: float
    megabytes: float | None = None


@dataclass(frozen=True)
class Cost:
    """What a diagnosis took: s, s, MB, multiples of the loop in C, and what it found."""

    clock: float
    processor: float
    megabytes: float
    per_loop: float
    verdict: str
    effects: tuple[str, ...]


def _dry(seconds: float, *hidden: str, recordings: int = 18, stated: str | None = None) -> Lay:
    """A dry contact with effects of 5 % of its friction, in so many recordings."""
    return _session("coulomb", seconds, hidden, recordings, stated)


def _session(
    base: str,
    seconds: float,
    hidden: tuple[str, ...],
    recordings: int,
    stated: str | None = None,
    pieces: int = 1,
) -> Lay:
    """Recordings of a plant of the tests, each cut into so many files."""

    def laid(seed: int, folder: Path) -> Path:
        roles = ("train", "select", "test") if recordings == 18 else ("train", "test")
        made = make_session(
            seed,
            base=base,
            hidden=[(name, 0.05) for name in hidden],
            roles=roles,
            seconds=seconds,
        )
        made.write(folder)
        if stated is not None:
            plant = folder / "plant.toml"
            text = plant.read_text(encoding="utf-8")
            plant.write_text(text.replace(f'"{base}"', f'"{stated}"'), encoding="utf-8")
        if pieces > 1:
            _cut(folder, pieces)
        return folder / "session.toml"

    return laid


def _cut(folder: Path, pieces: int) -> None:
    """Cut each recording of a session into files of the same length, which begin on the way."""
    session = folder / "session.toml"
    lines = ['plant = "plant.toml"']
    for entry in tomllib.loads(session.read_text(encoding="utf-8"))["recordings"]:
        file = folder / entry["file"]
        head, *rows = file.read_text(encoding="utf-8").splitlines()
        length = len(rows) // pieces
        for piece in range(pieces):
            own = rows[piece * length : (piece + 1) * length]
            name = f"{file.stem}_{piece + 1}.csv"
            (folder / name).write_text("\n".join([head, *own]) + "\n", encoding="utf-8")
            start = entry["start_s"] + float(own[0].split(",")[0])
            lines += ["", "[[recordings]]", f'file = "{name}"', f'role = "{entry["role"]}"']
            lines += [f'kind = "{entry["kind"]}"', f"start_s = {start:.3f}"]
        file.unlink()
    session.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _servo_logs(seed: int, folder: Path) -> Path:
    """Logs of servos, 6 s each, of every load."""
    folder.mkdir(parents=True, exist_ok=True)
    source = Path(os.environ["STICTION_DATA"]) / "sts3215"
    return real.sts3215_logs(source, folder, 59)


CASES = {
    "nothing missing, 234 s": Case(_dry(234.0), 4.0),
    "one cause, 234 s": Case(_dry(234.0, "cogging"), 5.0),
    "one cause, 500 s in 12": Case(_dry(500.0, "cogging", recordings=12), 10.0, 400.0),
    "one cause, 3 600 s": Case(_dry(3600.0, "cogging"), 60.0, 1500.0),
    "59 servo logs": Case(_servo_logs, 60.0),
    "lugre stated, two causes, 60 s": Case(_dry(60.0, "cogging", "stribeck", stated="lugre"), 10.0),
    "maxwell_slip, 72 of 10 s": Case(
        _session("maxwell_slip", 720.0, ("cogging",), 18, pieces=4), 30.0
    ),
}


def loop_seconds(folder: Path) -> float:
    """Seconds of the loop in C over its samples."""
    loop = c_loop("hsieh_pan", folder)
    effort = efforts()
    x, v = np.empty_like(effort), np.empty_like(effort)
    counted = (ctypes.c_long * 2)()
    effort_, x_, v_ = (a.ctypes.data_as(ctypes.c_void_p) for a in (effort, x, v))
    samples = ctypes.c_size_t(SAMPLES)
    begin = time.perf_counter()
    for _ in range(YARDSTICK_SAMPLES // SAMPLES):
        loop(effort_, samples, x_, v_, counted)
    return time.perf_counter() - begin


def cost(session: Path, out: Path, threads: int, loop: float) -> Cost:
    """What the command takes for a session."""
    command = [sys.executable, "-m", "stiction", "diagnose", str(session), "-o", str(out)]
    begin = time.perf_counter()
    process = subprocess.Popen(
        [*command, "--quiet", "--threads", str(threads)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stderr is not None
    said = process.stderr.read()
    _, status, used = os.wait4(process.pid, 0)
    clock = time.perf_counter() - begin
    if not (out / "findings.json").exists():
        raise SystemExit(f"{session}: the command ended with {status} and no findings:\n{said}")
    found = json.loads((out / "findings.json").read_text(encoding="utf-8"))
    return Cost(
        clock,
        used.ru_utime + used.ru_stime,
        used.ru_maxrss / 1024.0,
        clock / loop,
        found["verdict"],
        tuple(effect["name"] for effect in found["effects"]),
    )


def main() -> None:
    """Lay out the sessions, diagnose them, print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--only", help="cases that contain one of these words, with commas")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--keep", type=Path, help="folder for sessions and findings")
    args = parser.parse_args()
    words = args.only.split(",") if args.only else [""]
    rows = {}
    print(f"{'':32} {'s':>6} {'of':>4} {'cpu s':>6} {'MB':>6} {'of':>5} {'C loops':>8}  found")
    with tempfile.TemporaryDirectory(prefix="stiction-bench-") as name:
        folder = args.keep or Path(name)
        folder.mkdir(parents=True, exist_ok=True)
        for case_name, case in CASES.items():
            if not any(word in case_name for word in words):
                continue
            if "servo" in case_name and "STICTION_DATA" not in os.environ:
                print(f"{case_name:32} not run: STICTION_DATA leads to no recordings")
                continue
            at = folder / case_name.replace(" ", "_").replace(",", "")
            session = at / "session.toml"
            if not session.exists():
                session = case.lay(args.seed, at)
            took = cost(session, at / "found", args.threads, loop_seconds(folder))
            rows[case_name] = asdict(took)
            memory = "" if case.megabytes is None else f"{case.megabytes:.0f}"
            print(
                f"{case_name:32} {took.clock:6.1f} {case.seconds:4.0f} {took.processor:6.1f} "
                f"{took.megabytes:6.0f} {memory:>5} {took.per_loop:8.2f}  "
                f"{took.verdict}: {', '.join(took.effects) or '-'}",
                flush=True,
            )
    if args.json:
        args.json.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
