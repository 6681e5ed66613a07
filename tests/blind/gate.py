"""No session may be lost: fresh short ones of every family, and every real recording.

    python -m tests.blind.gate                    # a fresh seed, which is printed
    python -m tests.blind.gate --seed 7 --only planned --only emps

Judged is what a user needs to go on, not whether the name is right: exit status, files, finite
numbers, a whole page, an extended plant that simulates. What is lost stays in the folder of
``--out`` with the command that shows it again.
"""

from __future__ import annotations

import argparse
import secrets
import shlex
import shutil
import sys
import time
import tomllib
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from tests.reference.effect_catalogue import FOREIGN
from tests.reference.session_reference import make_session

import stiction as st
from stiction.bench.ordinary.draw import MOVED_HIDDEN, Spec, ordinary, size_of
from stiction.bench.ordinary.files import write
from stiction.bench.ordinary.hidden import HIDDEN

from .draw import deck, library
from .real import data_folder, lay, machines
from .way import Answer, walked

PATIENCE = 600.0
"""s of one command: of these sessions none takes a tenth of it on a machine that is not busy."""
SECONDS = (8.0, 18.0)
"""Of an ordinary session."""
SAMPLE_TIMES = (1e-3, 2e-3, 4e-3, 5e-3)
PLANNED = {"kinds": ("tracking", "ramps", "dwell"), "seconds": 18.0}
"""Of a planned session: half of the experiments, each once for each role."""
SIZES = (0.004, 0.03)
"""Of what planned sessions hide."""
KEPT = Path(__file__).with_name("kept.toml")
UNTRIED = ("lugre", "leuven")
"""Laws whose diagnosis takes minutes, which a gate has not."""


@dataclass(frozen=True)
class Entry:
    """One session of the gate.

    Attributes
    ----------
    name : str
        Family and number, or machine.
    lay : callable
        Writes it into a folder and returns the path of session.toml.
    options : tuple of str
        Further words of the command.
    """

    name: str
    lay: Callable[[Path], Path]
    options: tuple[str, ...] = ()


def entries(seed: int) -> list[Entry]:
    """Every real machine that is there, what was lost once, and fresh ones of every family."""
    rng = np.random.default_rng([seed, 24])
    hidden, moved = deck(rng, HIDDEN), deck(rng, MOVED_HIDDEN)
    found = [
        *_planned("planned null", rng, 2, lambda: ()),
        *_planned("planned single", rng, 2, lambda: _some(rng, library("maxwell_slip"), 1)),
        *_planned("planned pair", rng, 2, lambda: _some(rng, library("maxwell_slip"), 2)),
        *_planned("planned foreign", rng, 1, lambda: _some(rng, list(FOREIGN), 1)),
        *_left_out(rng),
        *_ordinary("ordinary null", rng, 5, lambda: {}),
        *_ordinary("ordinary hidden", rng, 6, lambda: _hidden(rng, hidden)),
        *_ordinary("servo", rng, 1, lambda: {"kind": "servo", "dt": 1e-2, "law": "coulomb"}),
        *_ordinary("moved", rng, 2, lambda: {"kind": "moved"} | _hidden(rng, moved)),
        *_ordinary("data fault", rng, 1, lambda: {"flaw": "constant"}),
        *_ordinary("data fault, holes", rng, 1, lambda: {"flaw": "holes"}),
        *_ordinary("not testable", rng, 1, lambda: {"flaw": "still", "loop": "open"}),
    ]
    folder = data_folder()
    real = [
        Entry(machine.name, lambda where, machine=machine: lay(machine, folder, where))
        for machine in machines(folder, seed % 2)
    ]
    return real + kept() + found


def kept() -> list[Entry]:
    """Ordinary sessions that were lost once."""
    found = []
    for each in tomllib.loads(KEPT.read_text(encoding="utf-8")).get("sessions", ()):
        given = {name: value for name, value in each.items() if name != "why"}
        spec = Spec(**given)
        found.append(Entry(f"kept {spec.seed}", lambda where, spec=spec: _made(spec, where)))
    return found


def _made(spec, where):
    return write(ordinary(spec), where)


def _some(rng, names, number):
    """Names, each with a size."""
    low, high = np.log(SIZES)
    return tuple(
        (str(name), float(np.exp(rng.uniform(low, high))))
        for name in rng.choice(names, number, replace=False)
    )


def _planned(name, rng, number, hide, options=()):
    for k in range(number):
        spec = {"seed": _seed(rng), "hidden": hide(), **PLANNED}
        hidden = " + ".join(each[0] for each in spec["hidden"])
        made = f"{name} {k + 1} ({hidden})" if hidden else f"{name} {k + 1}"
        yield Entry(made, lambda where, spec=spec: _written(spec, where), options)


def _left_out(rng):
    hidden = _some(rng, library("maxwell_slip"), 1)
    options = ("--without", hidden[0][0])
    yield from _planned("planned, left out", rng, 1, lambda: hidden, options)


def _written(spec, where):
    spec = dict(spec)
    return make_session(spec.pop("seed"), **spec).write(where) / "session.toml"


def _ordinary(name, rng, number, given):
    laws = deck(rng, [law.name for law in st.laws() if law.name not in UNTRIED])
    for k in range(number):
        usual = {
            "seed": _seed(rng),
            "law": next(laws),
            "seconds": float(rng.uniform(*SECONDS)),
            "recordings": int(rng.choice([1, 1, 2, 3])),
            "dt": float(rng.choice(SAMPLE_TIMES)),
        }
        spec = Spec(**usual | given())
        made = f"{name} {k + 1} ({spec.law}{' ' + spec.hidden if spec.hidden else ''})"
        yield Entry(made, lambda where, spec=spec: _made(spec, where))


def _hidden(rng, names):
    return {"hidden": next(names), "size": size_of(rng)}


def _seed(rng):
    return int(rng.integers(2**31))


def passed(entry: Entry, out: Path) -> Answer:
    """One session, the user's way."""
    folder = out / _plain(entry.name)
    shutil.rmtree(folder, ignore_errors=True)
    path = entry.lay(folder / "session")
    options = ["--threads", "1", *entry.options]
    return walked(path, folder / "diagnosis", options, patience=PATIENCE)


def _plain(name: str) -> str:
    return "".join(c if c.isalnum() else "_" for c in name)


def main() -> int:
    args = _arguments()
    seed = secrets.randbelow(2**31) if args.seed is None else args.seed
    plan = [e for e in entries(seed) if not args.only or e.name.startswith(tuple(args.only))]
    again = f"python -m tests.blind.gate --seed {seed}"
    print(f"seed {seed}: the same sessions again with {again}", flush=True)
    if not machines(data_folder()):
        print(f"no real recordings: STICTION_DATA names no folder ({data_folder()})")
    began, lost, verdicts = time.monotonic(), 0, Counter()
    with ThreadPoolExecutor(args.jobs) as pool:
        waiting = {pool.submit(passed, entry, args.out): entry for entry in plan}
        for done in as_completed(waiting):
            entry, answer = waiting[done], done.result()
            verdict = answer.findings["verdict"] if answer.findings else "no answer"
            verdicts[verdict] += 1
            print(f"{answer.seconds:5.1f} s  {entry.name}: {verdict}", flush=True)
            if answer.lost:
                lost += 1
                only = shlex.quote(entry.name)
                print("\n".join(f"    LOST {loss}" for loss in answer.losses))
                print(f"    {again} --only {only}", flush=True)
            elif not args.keep:
                shutil.rmtree(args.out / _plain(entry.name), ignore_errors=True)
    told = ", ".join(f"{number} {verdict}" for verdict, number in verdicts.most_common())
    took = time.monotonic() - began
    print(f"{len(plan)} sessions in {took:.0f} s ({told}); lost: {lost}; seed {seed}")
    return 1 if lost else 0


def _arguments():
    parser = argparse.ArgumentParser(prog="python -m tests.blind.gate", description=__doc__)
    parser.add_argument("--seed", type=int, help="of the draw; a fresh one without it")
    parser.add_argument(
        "--only", action="append", help="sessions whose names begin so; may be given again"
    )
    parser.add_argument("--jobs", type=int, default=2, help="sessions side by side")
    parser.add_argument("--keep", action="store_true", help="files of what is not lost, too")
    parser.add_argument("--out", type=Path, default=Path("target/gate"), help="folder of files")
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
