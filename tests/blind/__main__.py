"""Command line: draw, simulate, diagnose, count; every session is written as it is scored."""

from __future__ import annotations

import argparse
import json
import subprocess
from dataclasses import replace
from pathlib import Path

from tests.reference.session_reference import make_sessions

from .draw import MIX, SIZES, cases, library
from .score import scored
from .table import report

TOGETHER = 8
"""Sessions simulated side by side: memory against speed."""


def main():
    args = _arguments()
    rows = read_rows(args.out)
    done = {row["key"] for row in rows}
    plan = cases(args.number, args.seed, args.base, args.sizes, args.kinds, args.effects)
    plan = [replace(case, flicker=args.flicker, log_noise=args.log_noise) for case in plan]
    plan = [case for case in plan if case.key not in done]
    state = state_of()
    try:
        for begin in range(0, len(plan), TOGETHER):
            some = plan[begin : begin + TOGETHER]
            for case, made in zip(some, make_sessions([c.spec for c in some]), strict=True):
                row = {"state": state} | scored(case, made, args.threads)
                with args.out.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(row) + "\n")
                rows.append(row)
                print(_line(row), flush=True)
    except KeyboardInterrupt:
        print("interrupted: these are the scores so far; the same command goes on from here")
    text = report(rows)
    args.out.with_suffix(".md").write_text(text, encoding="utf-8")
    print(text)


def read_rows(path):
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        return []
    lines = path.read_text(encoding="utf-8").splitlines()
    return [json.loads(line) for line in lines]


def state_of():
    """The commit that was measured, with a + where files differ from it."""
    git = ("git", "describe", "--always", "--abbrev=7", "--dirty=+")
    told = subprocess.run(git, capture_output=True, text=True, check=False)
    return told.stdout.strip()


def _line(row):
    hidden = " + ".join(
        f"{h['name']}:{h['form']} {100 * h['reached']:.2f} %" for h in row["hidden"]
    )
    if "verdict" not in row:
        return f"{row['seed']} {row['kind']:8} {hidden or '-'}: LOST, {row['lost_kinds']}"
    lost = f" LOST, {row['lost_kinds']}" if row["lost"] else ""
    found = ", ".join(c["name"] + ("" if c["decided"] else "?") for c in row["found"])
    return (
        f"{row['seed']} {row['kind']:8} {hidden or '-'}: {row['verdict']} [{found}] "
        f"clair {row['clair']:.3f} gain {row['gain'] or 0.0:.3f} {row['seconds']:.1f} s{lost}"
    )


def _arguments():
    parser = argparse.ArgumentParser(prog="python -m tests.blind", description=__doc__)
    parser.add_argument("--number", type=int, default=200, help="sessions; 0 counts only")
    parser.add_argument("--seed", type=int, default=0, help="of the draw, from 0")
    parser.add_argument("--base", default="maxwell_slip", help="law of the plant")
    parser.add_argument("--sizes", type=pair, default=SIZES, help="shares of F_c: 0.001,0.03")
    parser.add_argument("--kinds", type=_words(MIX), default=tuple(MIX), help=", ".join(MIX))
    parser.add_argument(
        "--effects", type=_words(library()), default=(), help="hidden ones; all without it"
    )
    parser.add_argument("--log-noise", type=float, default=0.0, help="share of F_c, of the log")
    parser.add_argument("--flicker", type=float, default=0.0, help="counts, of the readings")
    parser.add_argument("--out", type=Path, default=Path("blind.jsonl"), help="one line a session")
    parser.add_argument("--threads", type=int, default=1)
    return parser.parse_args()


def pair(text):
    low, high = (float(word) for word in text.split(","))
    return low, high


def _words(known):
    def parse(text):
        words = tuple(text.split(","))
        for word in words:
            if word not in known:
                raise argparse.ArgumentTypeError(f"{word!r} is none of {', '.join(known)}")
        return words

    return parse


if __name__ == "__main__":
    main()
