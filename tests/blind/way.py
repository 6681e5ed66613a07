"""The way that a user goes: files, the command, its exit status, its files, simulated again.

`walked` diagnoses a session file with the command in a process of its own and looks at what came of
it. Whatever a user could not go on with is a loss: no answer, a traceback, a file that is missing
or broken, a number that is none, a page with a hole, an extended plant that does not simulate.
"""

from __future__ import annotations

import csv
import json
import math
import os
import re
import subprocess
import sys
import time
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

VERDICTS = (
    "data_fault",
    "not_testable",
    "unexplained",
    "ambiguous",
    "missing_effect",
    "nothing_missing",
)
KEYS = (
    *("schema", "verdict", "sentence", "effects", "gain", "candidates", "laws", "baseline"),
    *("extended", "unexplained", "advice", "data", "version", "seed", "seconds"),
)
"""Of findings.json, schema 1."""
FITTED = ("data_fault", "not_testable")
"""Verdicts with which nothing may have been fitted."""
PATIENCE = 900.0
"""s: nobody waits longer for an answer of a bench."""
LAST_LINES = 12
"""Of a traceback, that are kept."""


@dataclass(frozen=True)
class Loss:
    """What was lost: a kind to count by, and what was seen."""

    kind: str
    what: str

    def __str__(self) -> str:
        return f"{self.kind}: {self.what}"


@dataclass(frozen=True)
class Answer:
    """What the command left: findings where there are any, and what was lost."""

    folder: Path
    findings: dict[str, Any] | None
    losses: tuple[Loss, ...] = ()
    seconds: float = 0.0
    remarks: list[str] = field(default_factory=list)

    @property
    def lost(self) -> bool:
        return bool(self.losses)


def walked(
    session: Path,
    folder: Path,
    options: Sequence[str] = (),
    *,
    patience: float = PATIENCE,
    again: bool = True,
    command: Sequence[str] = (sys.executable, "-m", "stiction"),
) -> Answer:
    """Diagnose a session as a user does, and simulate what comes of it on what tested.

    Parameters
    ----------
    session : Path
        session.toml.
    folder : Path
        For the results.
    options : sequence of str
        More words of ``stiction diagnose``.
    patience : float
        s, for each command.
    again : bool
        Whether the extended plant is simulated.
    command : sequence of str
        In place of the program, for tests of this.
    """
    began = time.monotonic()
    words = [*command, "diagnose", str(session), "--out", str(folder), *options]
    losses = _run(words, patience)
    findings, more = _findings(folder / "findings.json")
    losses += more
    losses += _page(folder / "report.html")
    losses += _plant(folder / "plant.toml")
    if again and findings is not None and not any(loss.kind == "plant.toml" for loss in losses):
        losses += _again(session, folder, findings, patience, command)
    # Without an answer at all, that files are missing is no news.
    if losses and losses[0].kind.startswith(("traceback", "refused", "time", "exit")):
        losses = [loss for loss in losses if not loss.what.endswith("is missing")]
    return Answer(folder, findings, tuple(losses), time.monotonic() - began)


def _run(words: Sequence[str], patience: float, told: str = "") -> list[Loss]:
    """Run a command; what it says of itself."""
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "agg"}
    try:
        done = subprocess.run(
            words, capture_output=True, text=True, check=False, timeout=patience, env=environment
        )
    except subprocess.TimeoutExpired:
        return [Loss(f"{told}time", f"no answer within {patience:.0f} s")]
    return judged(done.returncode, done.stderr, told)


def judged(status: int, errors: str, told: str = "") -> list[Loss]:
    """What exit status and stderr of a command say was lost; every session here can be read."""
    errors = errors.strip()
    last = "\n".join(errors.splitlines()[-LAST_LINES:])
    if "Traceback (most recent call last)" in errors or "panicked at" in errors:
        return [Loss(f"{told}traceback {_place(errors)}", last)]
    if status == 2:
        return [Loss(f"{told}refused", last)]
    if status:
        return [Loss(f"{told}exit {status}", last)]
    holes = [line for line in errors.splitlines() if "could not be made" in line]
    return [Loss(f"{told}page", line) for line in holes]


def _place(errors: str) -> str:
    """`IndexError report/figures.py _merged` of a traceback: what it is counted by."""
    frames = re.findall(r'File ".*?stiction/([^"]+)", line \d+, in (\w+)', errors)
    kinds = re.findall(r"^(?:\w+\.)*(\w+(?:Error|Exception|Warning|Interrupt))\b", errors, re.M)
    where = " ".join(frames[-1]) if frames else "outside"
    return f"{kinds[-1] if kinds else 'panic'} {where}"


# --- findings.json


def _none(word: str) -> float:
    raise ValueError(f"{word} is no JSON")


def _findings(path: Path) -> tuple[dict[str, Any] | None, list[Loss]]:
    if not path.is_file():
        return None, [Loss("findings.json", f"{path.name} is missing")]
    try:
        found = json.loads(path.read_text(encoding="utf-8"), parse_constant=_none)
    except ValueError as error:
        return None, [Loss("findings.json", f"is not strict JSON: {error}")]
    if absent := [key for key in KEYS if not isinstance(found, dict) or key not in found]:
        return None, [Loss("findings.json", f"{key} is not there") for key in absent]
    wrong = _of_schema(found)
    wrong += [f"{where} is not finite" for where in _not_finite(found)]
    return found, [Loss("findings.json", each) for each in wrong]


def _of_schema(found: dict[str, Any]) -> list[str]:
    """What is wrong with the content; null stands for a number that is not known, as few may be."""
    wrong = []
    if found["schema"] != 1 or found["verdict"] not in VERDICTS or not found["sentence"]:
        wrong.append(f"schema {found['schema']!r}, verdict {found['verdict']!r} or no sentence")
    for name in ("baseline", "extended"):
        model = found[name]
        if model is None:
            wrong += [f"{name} is not there"] if found["verdict"] not in FITTED else []
            continue
        wrong += [
            f"{name}.{key} is no number"
            for key in ("train_rms", "noise_floor_rms")
            if not isinstance(model[key], int | float)
        ]
        wrong += _without_value(f"{name}.", model["parameters"])
    for effect in found["effects"]:
        wrong += _without_value(f"{effect['name']}: ", effect["parameters"])
    return wrong


def _without_value(where: str, parameters: dict[str, Any]) -> list[str]:
    return [
        f"{where}{path} has no value"
        for path, parameter in parameters.items()
        if not isinstance(parameter["value"], int | float)
    ]


def _not_finite(data: Any, where: str = "") -> list[str]:
    """Paths of numbers that are none: 1e999 is strict JSON, and infinite."""
    if isinstance(data, dict):
        return [p for key, each in data.items() for p in _not_finite(each, f"{where}.{key}")]
    if isinstance(data, list):
        return [p for k, each in enumerate(data) for p in _not_finite(each, f"{where}[{k}]")]
    return [where] if isinstance(data, float) and not math.isfinite(data) else []


# --- report.html


class _Page(HTMLParser):
    """Whether every element that is opened is closed, and what stands where something is not."""

    VOID = frozenset(("area", "base", "br", "col", "hr", "img", "input", "link", "meta", "wbr"))

    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[str] = []
        self.wrong: list[str] = []
        self.notes: list[str] = []
        self.noted = 0
        self.words: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag in self.VOID:
            return
        self.open.append(tag)
        # A figure or a section that failed, and a diagnosis that was broken off, are notes.
        if dict(attrs).get("role") == "note":
            self.noted = len(self.open)
            self.notes.append("")

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        pass

    def handle_endtag(self, tag: str) -> None:
        if tag in self.VOID:
            return
        if not self.open or self.open[-1] != tag:
            self.wrong.append(f"</{tag}> closes <{self.open[-1] if self.open else 'nothing'}>")
            return
        if self.noted == len(self.open):
            self.noted = 0
        self.open.pop()

    def handle_data(self, data: str) -> None:
        if self.noted:
            self.notes[-1] += data
        if not {"style", "script"} & set(self.open):
            self.words.append(data)


def _page(path: Path) -> list[Loss]:
    if not path.is_file():
        return [Loss("page", f"{path.name} is missing")]
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        return [Loss("page", f"is not UTF-8: {error}")]
    page = _Page()
    page.feed(text)
    page.close()
    wrong = list(dict.fromkeys(page.wrong))[:3]
    if page.open or not text.rstrip().endswith("</html>"):
        wrong.append(f"ends within <{page.open[-1] if page.open else 'text'}>")
    wrong += [f"has a hole: {' '.join(note.split())}" for note in page.notes]
    said = " ".join(page.words)
    wrong += [f"says {word!r}" for word in sorted(set(re.findall(r"(?<![\w.])nan(?!\w)", said)))]
    return [Loss("page", each) for each in wrong]


# --- plant.toml, simulated again


def _plant(path: Path) -> list[Loss]:
    if not path.is_file():
        return [Loss("plant.toml", f"{path.name} is missing")]
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        return [Loss("plant.toml", f"cannot be read: {error}")]
    # Infinite is a value: a break-away that is never reached.
    wrong = [where for where, value in _numbers(table) if math.isnan(value)]
    return [Loss("plant.toml", f"{where[1:]} is no number") for where in wrong]


def _numbers(data: Any, where: str = "") -> list[tuple[str, float]]:
    if isinstance(data, dict):
        return [pair for key, each in data.items() for pair in _numbers(each, f"{where}.{key}")]
    if isinstance(data, list):
        return [pair for k, each in enumerate(data) for pair in _numbers(each, f"{where}[{k}]")]
    return [(where, data)] if isinstance(data, float) else []


def _again(
    session: Path,
    folder: Path,
    findings: dict[str, Any],
    patience: float,
    command: Sequence[str],
) -> list[Loss]:
    """Simulate the extended plant on the recordings that tested."""
    split = findings["data"].get("split")
    if not split or findings["verdict"] in FITTED:
        return []
    tested = sorted({part["recording"] for part in split["test"]})
    table = tomllib.loads(session.read_text(encoding="utf-8"))
    # Recordings with a fault are left out of a diagnosis, so they are found by name.
    names = {part["name"] for part in split["test"]}
    some = [each for each in table["recordings"] if Path(each["file"]).name in names]
    some = some or [table["recordings"][k] for k in tested if k < len(table["recordings"])]
    if not some:
        return []
    path = session.with_name("tested.toml")
    path.write_text(_session_of(table, some), encoding="utf-8")
    where = folder / "again"
    words = [*command, "simulate", str(folder / "plant.toml"), str(path), "--out", str(where)]
    losses = _run(words, patience, "again: ")
    if losses:
        return losses
    files = sorted(where.glob("*trajectory.csv"))
    moved = "prescribed_motion" in (folder / "plant.toml").read_text(encoding="utf-8")
    if not files and not moved:
        return [Loss("again: files", "no trajectory was written")]
    bad = [path.name for path in files if not finite(path)]
    return [Loss("again: not finite", name) for name in bad]


def _session_of(table: dict[str, Any], recordings: list[dict[str, Any]]) -> str:
    """A session file of some of the recordings; whose plant is another one."""
    lines = ["[columns]", *_entries(table["columns"])] if "columns" in table else []
    for each in recordings:
        lines += ["", "[[recordings]]", *_entries(each)]
    return "\n".join(lines) + "\n"


def _entries(table: dict[str, Any]) -> list[str]:
    return [f"{key} = {_toml(value)}" for key, value in table.items()]


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(_entries(value)) + " }"
    return json.dumps(value, ensure_ascii=False)


def finite(path: Path) -> bool:
    """Whether a trajectory has rows, and each cell is a finite number."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))[1:]
    try:
        return bool(rows) and all(math.isfinite(float(cell)) for row in rows for cell in row)
    except ValueError:
        return False
