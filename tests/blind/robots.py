"""Counts simulated arms: links by MuJoCo, friction by code of the tests, one joint hides an effect.

    python -m tests.blind.robots --number 20 --seed 100 --out robots.jsonl

`--way prescribed` asks the links for the efforts of a motion; the other ways drive the arm by a
controller, joints stick where friction holds them, and the log has every effort that was set
(`held`) or one of five (`decimated`). Every fifth arm hides nothing. An arm is a line of the
`.jsonl` as soon as it is judged; the same command goes on where it was. Counted are joints with
something hidden whose effect is named, and joints with nothing hidden that get no name, sure ones
and undecided ones apart.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from functools import partial
from pathlib import Path

from tests.robot.forward import driven
from tests.robot.simulated import drawn

from .__main__ import read_rows, state_of

WAYS = {
    "prescribed": None,
    "held": {"rate": 250.0, "control": 250.0},
    "decimated": {"rate": 200.0, "control": 1000.0},
}
"""How an arm is moved and logged: rows and efforts that are set, a second."""


def judged(seed, way, seconds, threads):
    """One arm, as its session file tells it: a line of the results."""
    import numpy as np

    from stiction.robot import diagnose_robot, load_session

    robot, joint, effect = drawn(seed)
    with tempfile.TemporaryDirectory(prefix="stiction-robot-") as name:
        rates = WAYS[way]
        record = None if rates is None else partial(driven, robot, **rates)
        session = load_session(robot.lay_out(Path(name), seconds, seed, record))
        began = time.process_time()
        with np.errstate(all="ignore"):
            found = diagnose_robot(session, threads=threads)
        spent = time.process_time() - began
    return {
        "key": f"{way}-{seed}-{seconds:g}",
        "way": way,
        "seed": seed,
        "joint": joint,
        "effect": effect,
        "joints": [_told(each) for each in found.joints],
        "agreement": _agreement(found.agreement),
        "cpu_s": round(spent, 1),
    }


def _told(each):
    found = each.diagnosis
    names = [[c.name, bool(c.decided), round(float(c.size), 4)] for c in found.effects]
    return {
        "name": each.name,
        "verdict": str(found.verdict),
        "found": names,
        "alike": [list(c.look_alikes) for c in found.effects],
    }


def _agreement(rows):
    """Pairs of recordings whose intervals overlap, of all pairs; and parameters with a reason."""
    pairs = [(len(row.values) * (len(row.values) - 1) // 2, row.overlaps) for row in rows]
    told = [(n, share) for n, share in pairs if share is not None]
    return [sum(round(n * share) for n, share in told), sum(n for n, _ in told)]


def counted(rows):
    """The counts, by joint."""
    right = hidden = sure_beside = free = sure = open_ = 0
    overlap = pairs = 0
    for row in rows:
        overlap, pairs = overlap + row["agreement"][0], pairs + row["agreement"][1]
        for joint in row["joints"]:
            decided = {name for name, fine, _ in joint["found"] if fine}
            undecided = {name for name, fine, _ in joint["found"] if not fine}
            if joint["name"] == row["joint"]:
                hidden += 1
                right += row["effect"] in decided
                sure_beside += bool(decided - {row["effect"]})
            else:
                free += 1
                sure += bool(decided)
                open_ += bool(undecided)
    return {
        "arms": len(rows),
        "joint and name right": [right, hidden],
        "a second sure name in that joint": [sure_beside, hidden],
        "a sure name in a joint with nothing hidden": [sure, free],
        "an undecided name in a joint with nothing hidden": [open_, free],
        "intervals of two recordings overlap": [overlap, pairs],
        "CPU s an arm": round(sum(row["cpu_s"] for row in rows) / max(len(rows), 1), 1),
    }


def _line(row):
    hides = f"{row['joint']} {row['effect']}" if row["effect"] else "-"
    told = []
    for joint in row["joints"]:
        names = [name + ("" if fine else "?") for name, fine, _ in joint["found"]]
        if names:
            told.append(f"{joint['name']}: {', '.join(names)}")
    return f"{row['seed']} {hides}: [{'; '.join(told)}] {row['cpu_s']} s"


def main():
    args = _arguments()
    rows = read_rows(args.out)
    done = {row["key"] for row in rows}
    try:
        for seed in range(args.seed, args.seed + args.number):
            if f"{args.way}-{seed}-{args.seconds:g}" in done:
                continue
            row = {"state": state_of()} | judged(seed, args.way, args.seconds, args.threads)
            with args.out.open("a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")
            rows.append(row)
            print(_line(row), flush=True)
    except KeyboardInterrupt:
        print("interrupted: these are the counts so far; the same command goes on from here")
    for what, count in counted(rows).items():
        print(f"{what}: {' of '.join(map(str, count)) if isinstance(count, list) else count}")


def _arguments():
    parser = argparse.ArgumentParser(prog="python -m tests.blind.robots", description=__doc__)
    parser.add_argument("--number", type=int, default=20, help="arms; 0 counts only")
    parser.add_argument("--seed", type=int, default=100, help="of the first arm")
    parser.add_argument("--way", choices=WAYS, default="held", help="how arms are moved and logged")
    parser.add_argument("--seconds", type=float, default=24.0, help="of each recording")
    parser.add_argument("--threads", type=int, default=1, help="of a diagnosis")
    parser.add_argument("--out", type=Path, default=Path("robots.jsonl"), help="a line an arm")
    return parser.parse_args()


if __name__ == "__main__":
    main()
