"""No stump is left where a command is killed: every file is the earlier one or a whole new one.

``python -m tests.faults.test_kill --number 200`` kills at that many moments, over all verbs.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from tests.cli.desk import Desk

from stiction.cli.app import build
from stiction.recording import read_table

pytestmark = pytest.mark.skipif(os.name != "posix", reason="kills as POSIX does")

EARLIER = b"the last good file"
KILLS = 10
STREAM = (
    "import sys, numpy as np, stiction as st\n"
    "motor = st.Motor(0.0076, friction=st.FrictionModel('maxwell_slip'))\n"
    "chunks = (np.full(20000, 0.1) for _ in range(60))\n"
    "for part in st.stream(motor, chunks, 1e-4, checkpoint=sys.argv[1]): pass"
)
REPORT = (
    "import sys; from tests.report.canned import diagnosis\n"
    "diagnosis('missing_effect', names=1).save(sys.argv[1])"
)
COLUMNS = "time=t, input=u [Nm], position=q [rad]"
VERBS: dict[str, list[str]] = {
    "init": ["init", "CSV", "-o", "OUT"],
    "simulate": ["simulate", "PLANT", "SESSION", "-o", "OUT"],
    "import": ["import", "BAM", "-o", "OUT"],
    "library": ["library", "ur10e_wrist", "--session", "SESSION", "-o", "OUT"],
    "fit": ["fit", "SESSION", "-o", "OUT"],
    "diagnose": ["diagnose", "SESSION", "-o", "OUT"],
    "watch": ["watch", "LOGS", "--once", "--columns", COLUMNS, "-o", "OUT"],
    "plan": ["plan", "PLANT", "--only", "ramps", "-o", "OUT"],
    "export": ["export", "PLANT", "--to", "table", "--to", "urdf", "--to", "c", "-o", "OUT"],
    "compensate": ["compensate", "PLANT", "--session", "LOOP", "-o", "OUT"],
    "bench": ["bench", "make", "OUT", "--number", "6", "--seconds", "4,6"],
    "laws": ["laws", "-o", "OUT"],
    "effects": ["effects", "-o", "OUT"],
    "compare": ["compare", "coulomb", "--steps", "1000", "--draws", "0", "-o", "OUT"],
    "completion": ["completion", "man", "-o", "OUT"],
    "demo": ["demo", "--copy", "OUT"],
    "paper": ["paper", "-o", "OUT"],
    "report": ["-c", REPORT, "OUT"],
    "stream": ["-c", STREAM, "OUT/state.npz"],
}
"""Arguments of the command line, or of Python where they begin with -c."""
FRESH = {"init", "import", "plan", "demo", "stream", "bench"}
"""What refuses to write over a file, or goes on from it."""
SLOW = {"paper", "diagnose", "watch"}
"""Left to the long run: most of what they do is no writing."""


def parses_csv(path: Path) -> object:
    if path.name.endswith("-trajectory.csv"):
        return read_table(path)
    lines = path.read_text("utf-8").splitlines()
    return (lines[0], np.loadtxt(lines, delimiter=",", skiprows=1, ndmin=2)[-1])


def ends_in(end: bytes) -> Callable[[Path], object]:
    def looked(path: Path) -> None:
        assert path.read_bytes().rstrip().endswith(end)

    return looked


WHOLE: dict[str, Callable[[Path], object]] = {
    ".json": lambda path: json.loads(path.read_bytes()),
    ".toml": lambda path: tomllib.loads(path.read_text("utf-8")),
    ".svg": ElementTree.parse,
    ".urdf": ElementTree.parse,
    ".1": ends_in(b"fault of the program"),
    ".c": ends_in(b"}"),
    ".h": ends_in(b"#endif"),
    ".png": ends_in(b"IEND\xaeB`\x82"),
    ".html": ends_in(b"</html>"),
    ".csv": parses_csv,
    ".npz": lambda path: dict(np.load(path)),
    ".mat": read_table,
    ".md": lambda path: path.read_text("utf-8"),
    ".txt": lambda path: path.read_text("utf-8"),
}
"""Raises for a file that is not whole."""


class Killed:
    """A verb that is run once to its end and then killed at random moments."""

    def __init__(self, verb: str, folder: Path) -> None:
        folder.mkdir()
        self.verb = verb
        self._desk = Desk(folder)
        self._folder = folder
        self._runs = 0
        began = time.monotonic()
        out = self._out()
        process = self._started(out)
        # What comes before the first file, imports above all, writes nothing.
        while process.poll() is None and not _files(out):
            time.sleep(0.002)
        self._first = time.monotonic() - began
        assert process.wait() == 0
        self._last = time.monotonic() - began
        self.reference = {str(path.relative_to(out)): path.read_bytes() for path in _files(out)}

    def kill(self, source: random.Random) -> int:
        """Kill a run once; how many new files were there by then."""
        out = self._out()
        if self.verb not in FRESH:
            for name in self.reference:
                path = out / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(EARLIER)
        before = _seen(out)
        process = self._started(out)
        if source.random() < 0.5:
            # While something is being written.
            while process.poll() is None and _seen(out) == before:
                time.sleep(0.0005)
            time.sleep(source.uniform(0.0, self._last - self._first) ** 2 / 4.0)
        else:
            time.sleep(source.uniform(0.8 * self._first, self._last))
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        return self._looked_at(out)

    def _looked_at(self, out: Path) -> int:
        new = 0
        for path in _files(out):
            name = str(path.relative_to(out))
            assert name in self.reference, f"{self.verb} left {name}"
            if path.read_bytes() != EARLIER:
                try:
                    WHOLE[path.suffix](path)
                except Exception as error:
                    raise AssertionError(f"{self.verb} left a stump of {name}") from error
                new += 1
        if self.verb not in FRESH:
            assert len(_files(out)) == len(self.reference), f"{self.verb} lost a file"
        return new

    def _out(self) -> Path:
        self._runs += 1
        out = self._folder / f"out-{self._runs}"
        out.mkdir()
        return out

    def _logs(self) -> Path:
        """A folder with the recording alone."""
        logs = self._folder / "logs"
        logs.mkdir(exist_ok=True)
        (logs / "run.csv").write_bytes(self._desk.csv.read_bytes())
        return logs

    def _started(self, out: Path) -> subprocess.Popen[bytes]:
        paths = {
            "SESSION": str(self._desk.session),
            "PLANT": str(self._desk.plant),
            "CSV": str(self._desk.csv),
            "LOOP": str(self._desk.loop()),
            "BAM": str(self._desk.parameters()),
            "LOGS": str(self._logs()),
        }
        words = [paths.get(each, each.replace("OUT", str(out))) for each in VERBS[self.verb]]
        module = [] if words[0] == "-c" else ["-m", "stiction"]
        return subprocess.Popen(
            [sys.executable, *module, *words],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            cwd=Path(__file__).parents[2],
        )


def _files(out: Path, *, drafts: bool = False) -> list[Path]:
    return [
        path
        for path in sorted(out.rglob("*"))
        if path.is_file() and (drafts or ".stiction-" not in str(path.relative_to(out)))
    ]


def _seen(out: Path) -> set[tuple[str, int]]:
    """Files and when each was changed: also one that is written in place shows."""
    seen = set()
    for path in _files(out, drafts=True):
        with suppress(FileNotFoundError):
            seen.add((str(path), path.stat().st_mtime_ns))
    return seen


def test_no_verb_is_left_out() -> None:
    verbs = {verb for verb in build() if not verb.startswith("-")}
    assert verbs <= VERBS.keys()


@pytest.mark.parametrize("verb", sorted(VERBS.keys() - SLOW))
def test_a_command_that_is_killed_leaves_no_stump(verb: str, tmp_path: Path) -> None:
    killed = Killed(verb, tmp_path / verb)
    source = random.Random(verb)
    for _ in range(max(KILLS // len(VERBS.keys() - SLOW), 1)):
        killed.kill(source)


def main() -> None:
    """Kill at many moments and count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--number", type=int, default=200)
    parser.add_argument("--seed", type=int, default=int(time.time()))
    parser.add_argument("--only", nargs="*", default=list(VERBS), help="verbs, in place of all")
    chosen = parser.parse_args()
    source = random.Random(chosen.seed)
    print(f"seed {chosen.seed}")
    with tempfile.TemporaryDirectory() as name:
        verbs = {verb: Killed(verb, Path(name) / verb) for verb in chosen.only}
        counts = dict.fromkeys(chosen.only, 0)
        amid = dict.fromkeys(chosen.only, 0)
        for k in range(chosen.number):
            verb = chosen.only[k % len(chosen.only)]
            new = verbs[verb].kill(source)
            counts[verb] += 1
            amid[verb] += 0 < new < len(verbs[verb].reference)
    for verb, count in counts.items():
        print(f"{verb}: {count} kills, {amid[verb]} of them between its files, 0 stumps")


if __name__ == "__main__":
    main()
