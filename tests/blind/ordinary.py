"""Counts ordinary sessions: many kinds of machines, drives, loops and logs, whatever law is stated.

    python -m tests.blind.ordinary --cases grid --out grid.jsonl
    python -m tests.blind.ordinary --cases null,hidden --number 100 --seed 3 --out ordinary.jsonl

`grid` is two dozen fixed sessions with nothing hidden, `null` and `hidden` are drawn. Every session
is a line of the `.jsonl` as soon as it is judged; the same command goes on where it was.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import zlib
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import numpy as np

import stiction as st
from stiction.bench.ordinary.draw import SECONDS, Spec, null_grid, ordinary, size_of
from stiction.bench.ordinary.files import write
from stiction.bench.ordinary.hidden import HIDDEN

from .__main__ import pair, read_rows, state_of
from .draw import deck
from .ordinary_table import report
from .score import families_of, told
from .way import PATIENCE, walked

CASES = ("grid", "null", "hidden")
FIRST_SEED = 5_000_000
SEEDS_EACH = 10_000
USUAL = 0.6
"""Share of sessions whose plant file states the usual law of such a machine; others state any."""
USUAL_LAWS = {"dry": "coulomb", "bristle": "dahl"}
"""What somebody would state of a machine with such a contact."""


@dataclass(frozen=True)
class Case:
    """A session to be diagnosed, and what it is counted as."""

    kind: str
    spec: Spec

    @property
    def key(self) -> str:
        spec = self.spec
        return f"{self.kind} {spec.seed} {spec.law} {spec.hidden} {spec.size}"


def cases(kinds, number, seed, seconds=SECONDS):
    """The cases of some kinds; a longer list begins with the shorter one."""
    found = [Case("grid", spec) for spec in null_grid()] if "grid" in kinds else []
    drawn = [kind for kind in kinds if kind != "grid"]
    rng = np.random.default_rng([seed, zlib.crc32(b"ordinary cases")])
    laws, effects = deck(rng, [law.name for law in st.laws()]), deck(rng, HIDDEN)
    for k in range(number if drawn else 0):
        contact = str(rng.choice(["dry", "dry", "bristle"]))
        law = USUAL_LAWS[contact] if rng.random() < USUAL else next(laws)
        kind = drawn[k % len(drawn)]
        length = None if seconds == SECONDS else float(rng.uniform(*seconds))
        own = FIRST_SEED + SEEDS_EACH * seed + k
        spec = Spec(own, law=law, contact=contact, seconds=length)
        if kind == "hidden":
            spec = Spec(**asdict(spec) | {"hidden": next(effects), "size": size_of(rng)})
        found.append(Case(kind, spec))
    return found


def judged(case, patience=PATIENCE):
    """One case, the user's way: a line of the results."""
    made = ordinary(case.spec)
    with tempfile.TemporaryDirectory(prefix="stiction-ordinary-") as name:
        path = write(made, Path(name) / "session")
        row = told(walked(path, Path(name) / "out", ["--threads", "1"], patience=patience))
    families, spec = families_of(), made.spec
    return {
        "key": case.key,
        "kind": case.kind,
        "seed": spec.seed,
        "spec": {name: value for name, value in asdict(spec).items() if name != "seed"},
        "names": made.names,
        "classes": sorted({families[name] for name in made.names}),
        "reached": made.reached,
        "truth": {
            "inertia": made.machine.inertia,
            "coulomb": made.machine.coulomb,
            "viscous": made.machine.viscous + made.machine.counter,
        },
        **row,
    }


def main():
    args = _arguments()
    rows = read_rows(args.out)
    done, state = {row["key"] for row in rows}, state_of()
    plan = [c for c in cases(args.cases, args.number, args.seed, args.seconds) if c.key not in done]
    try:
        with ThreadPoolExecutor(args.jobs) as pool:
            for row in pool.map(partial(judged, patience=args.patience), plan):
                row = {"state": state} | row
                with args.out.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(row) + "\n")
                rows.append(row)
                print(_line(row), flush=True)
    except KeyboardInterrupt:
        print("interrupted: these are the counts so far; the same command goes on from here")
    text = report(rows)
    args.out.with_suffix(".md").write_text(text, encoding="utf-8")
    print(text)


def _line(row):
    spec = row["spec"]
    hidden = f"{row['names'][0]} {100 * row['reached']:.1f} %" if row["names"] else "-"
    about = (
        f"{row['seed']} {row['kind']:6} {hidden} ({spec['law']} stated of a {spec['contact']} one, "
        f"{spec['recordings']} x {spec['dt']:g} s, {spec['counts']} counts, {spec['loop']})"
    )
    if "verdict" not in row:
        return f"{about}: LOST, {row['lost_kinds']} {row['walk_seconds']:.0f} s"
    found = ", ".join(c["name"] + ("" if c["decided"] else "?") for c in row["found"])
    lost = f" LOST, {row['lost_kinds']}" if row["lost"] else ""
    return f"{about}: {row['verdict']} [{found}] {row['walk_seconds']:.0f} s{lost}"


def _arguments():
    parser = argparse.ArgumentParser(prog="python -m tests.blind.ordinary", description=__doc__)
    parser.add_argument("--cases", type=_kinds, default=("null", "hidden"), help=", ".join(CASES))
    parser.add_argument("--number", type=int, default=48, help="drawn sessions; 0 counts only")
    parser.add_argument("--seed", type=int, default=0, help="of the draw, from 0")
    parser.add_argument("--seconds", type=pair, default=SECONDS, help="of a session: 20,40")
    parser.add_argument("--jobs", type=int, default=1, help="sessions side by side")
    parser.add_argument("--patience", type=float, default=PATIENCE, help="s, of one command")
    parser.add_argument("--out", type=Path, default=Path("ordinary.jsonl"), help="a line a session")
    return parser.parse_args()


def _kinds(text):
    words = tuple(text.split(","))
    for word in words:
        if word not in CASES:
            raise argparse.ArgumentTypeError(f"{word!r} is none of {', '.join(CASES)}")
    return words


if __name__ == "__main__":
    main()
