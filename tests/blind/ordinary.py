"""Counts ordinary sessions: many kinds of machines, drives, loops and logs, whatever law is stated.

    python -m tests.blind.ordinary --cases grid --out grid.jsonl
    python -m tests.blind.ordinary --cases null,hidden --number 100 --seed 3 --out ordinary.jsonl

    python -m tests.blind.ordinary --plant axis4 --number 32 --seed 4 --out axis4.jsonl

`grid` is two dozen fixed sessions with nothing hidden, `null` and `hidden` are drawn. `--plant` is
who made the machines: the bench, or a stranger (`plants.py`). Every session
is a line of the `.jsonl` as soon as it is judged; the same command goes on where it was.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from .__main__ import pair, read_rows, state_of
from .ordinary_table import report
from .plants import PLANTS
from .score import families_of, told
from .way import PATIENCE, walked

CASES = ("grid", "null", "hidden")


def judged(case, patience=PATIENCE):
    """One case, the user's way: a line of the results."""
    with tempfile.TemporaryDirectory(prefix="stiction-ordinary-") as name:
        laid = case.lay(Path(name) / "session")
        row = told(walked(laid.path, Path(name) / "out", ["--threads", "1"], patience=patience))
    families = families_of()
    return {
        "key": case.key,
        "kind": case.kind,
        "seed": laid.seed,
        "spec": laid.spec,
        "names": laid.names,
        "classes": sorted({families.get(name, "foreign") for name in laid.names}),
        "reached": laid.reached,
        "left": laid.left,
        "truth": laid.truth,
        **row,
    }


def main():
    args = _arguments()
    rows = read_rows(args.out)
    done, state = {row["key"] for row in rows}, state_of()
    cases = PLANTS[args.plant](args.cases, args.number, args.seed, args.seconds)
    plan = [case for case in cases if case.key not in done]
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
    parser.add_argument("--plant", choices=PLANTS, default="ordinary", help="who made the machines")
    parser.add_argument("--number", type=int, default=48, help="drawn sessions; 0 counts only")
    parser.add_argument("--seed", type=int, default=0, help="of the draw, from 0")
    parser.add_argument("--seconds", type=pair, default=None, help="of a session: 20,40")
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
