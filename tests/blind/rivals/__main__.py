"""Runs every rival on the sessions of a plant, and sets their counts beside the diagnosis's own."""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from pathlib import Path

from ..__main__ import pair, read_rows
from ..ordinary_table import beside
from ..plants import PLANTS
from ..score import families_of
from . import bic, e_process, f_test, l1
from .library import library

RIVALS = {
    "F-test": f_test.names,
    "BIC, forward": bic.names,
    "L1, all at once": l1.names,
    "e-process": e_process.names,
}
OURS = "stiction diagnose"


def answers(case):
    """A line of the results for each rival, in the form that the diagnosis's own lines have."""
    families = families_of()
    with tempfile.TemporaryDirectory(prefix="stiction-rivals-") as name:
        laid = case.lay(Path(name) / "session")
        began = time.process_time()
        lib = library(laid.path)
        read = time.process_time() - began
    about = {
        "key": case.key,
        "kind": case.kind,
        "seed": laid.seed,
        "spec": laid.spec,
        "names": laid.names,
        "classes": sorted({families.get(each, "foreign") for each in laid.names}),
        "reached": laid.reached,
        "left": laid.left,
        "lost": [],
        "lost_kinds": [],
    }
    for rival, names in RIVALS.items():
        began = time.process_time()
        said = [] if lib is None else names(lib)
        yield {
            **about,
            "rival": rival,
            "verdict": "missing_effect" if said else "nothing_missing" if lib else "not_testable",
            "found": [_cause(each, families) for each in said],
            "seconds": round(read + time.process_time() - began, 2),
        }


def _cause(name, families):
    return {
        "name": name,
        "decided": True,
        "look_alikes": [],
        "class": families[name],
        "classes": [families[name]],
    }


def main():
    args = _arguments()
    rows = read_rows(args.out)
    done = {row["key"] for row in rows}
    for case in PLANTS[args.plant](args.cases, args.number, args.seed, args.seconds):
        if case.key in done:
            continue
        own = list(answers(case))
        with args.out.open("a", encoding="utf-8") as file:
            file.writelines(json.dumps(row) + "\n" for row in own)
        rows += own
        said = "; ".join(
            f"{row['rival']} [{', '.join(c['name'] for c in row['found'])}]" for row in own
        )
        print(f"{own[0]['seed']} {own[0]['names'] or '-'}: {said}", flush=True)
    judges = {OURS: read_rows(args.ours)} if args.ours else {}
    keys = {row["key"] for row in rows}
    judges = {name: [row for row in some if row["key"] in keys] for name, some in judges.items()}
    judges |= {rival: [row for row in rows if row["rival"] == rival] for rival in RIVALS}
    text = beside(judges)
    args.out.with_suffix(".md").write_text(text, encoding="utf-8")
    print(text)


def _arguments():
    parser = argparse.ArgumentParser(prog="python -m tests.blind.rivals", description=__doc__)
    parser.add_argument("--plant", choices=PLANTS, default="ordinary", help="who made the machines")
    parser.add_argument(
        "--cases", type=lambda text: tuple(text.split(",")), default=("null", "hidden")
    )
    parser.add_argument("--number", type=int, default=32)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--seconds", type=pair, default=None)
    parser.add_argument("--ours", type=Path, help="lines of tests.blind.ordinary, same sessions")
    parser.add_argument("--out", type=Path, default=Path("rivals.jsonl"))
    return parser.parse_args()


if __name__ == "__main__":
    main()
