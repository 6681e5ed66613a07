"""Whether what a diagnosis advises to record tells its look-alikes apart.

A session with one effect of a declared pair; where its diagnosis is undecided, the experiment that
it advises is planned for the plant that it found, recorded on the same machine, and added.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from tests.reference.more_recordings import Wanted, record_more
from tests.reference.session_reference import make_sessions

import stiction as st
from stiction.plan import plan
from stiction.plan.experiments import EXPERIMENTS

from .score import told
from .table import wilson
from .way import walked

PAIRED = (
    "torque_bias",
    "direction_asymmetry",
    "warm_up",
    "run_in",
    "torque_constant_ripple",
    "position_dependent_friction",
    "dwell_strengthening",
    "rate_dependent_breakaway",
    "stribeck",
)
FIRST_SEED = 10_000_000
REACH = 6.0
"""rad on either side: the machine may make a turn."""
PAUSE_S, LONG_REST_S = 2.0, 90.0
PLANNED = {experiment.name for experiment in EXPERIMENTS}
"""What can be recorded without the owner's hands: nobody turns this machine round."""
COLD = ("cycle", "rest", "cycle", "fast", "cycle", "rest", "fast", "cycle")
"""What tells time from path: a machine that is cold, rests, and then travels."""
NIGHT_S = 50_000.0
"""Until a machine is cold again."""


def advised(findings):
    """Names of the planned experiments that tell undecided causes apart, the first one first."""
    advice = [each for each in findings["advice"] if each["separates"]]
    names = [each["experiment"].split(":")[0] for each in advice]
    return [name for name in dict.fromkeys(names) if name in PLANNED]


def recorded(made, plant, name):
    """The session with the advised experiment recorded after it, a cycle once it is cold again."""
    gain = float(plant.drive.get("gain", 1.0))
    cold = name == "cycle"
    names = ("cycle", "fast") if cold else (name,)
    signals = plan(plant, position=REACH, only=names).signals
    order = COLD if cold else (name,)
    end = max(r.start_s + r.time_s[-1] for r in made.recordings) + PAUSE_S
    at = 0.0 if cold else end
    wanted = []
    for each in order:
        if each == "rest":
            at += LONG_REST_S
            continue
        for signal in (s for s in signals if s.experiment == each):
            kind = {"reference": "reference", "input": "torque"}[signal.kind]
            values = signal.values if kind == "reference" else signal.values * gain
            wanted.append(Wanted(signal.experiment, signal.role, at, **{kind: values}))
            at += signal.duration + PAUSE_S
    more = record_more(made, wanted, cold=cold)
    if cold:
        more = [replace(r, start_s=r.start_s + end + NIGHT_S) for r in more]
        more[0] = replace(more[0], cold=True)
    return replace(made, recordings=[*made.recordings, *more])


def resolved(made, folder):
    """Verdicts before and after; None where nothing was undecided, or an answer was lost."""
    names = [effect.name for effect in made.effects]
    before = _diagnosed(made, folder / "before")
    row = {"hidden": names, "before": told(before), "advised": [], "resolved": None}
    if before.findings is None or before.findings["verdict"] != "ambiguous":
        return row
    row["advised"] = advised(before.findings)
    if not row["advised"] or not (before.folder / "plant.toml").is_file():
        return row
    plant = st.Plant.load(before.folder / "plant.toml")
    after = _diagnosed(recorded(made, plant, row["advised"][0]), folder / "after")
    row["after"] = told(after)
    if after.findings is not None:
        causes = [cause["name"] for cause in after.findings["effects"]]
        row["resolved"] = after.findings["verdict"] == "missing_effect" and causes == names
    return row


def _diagnosed(made, folder):
    path = made.write(folder / "session") / "session.toml"
    return walked(path, folder / "diagnosis", ["--threads", "1"])


def main():
    parser = argparse.ArgumentParser(prog="python -m tests.blind.resolve", description=__doc__)
    parser.add_argument("--number", type=int, default=18)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--base", default="maxwell_slip")
    parser.add_argument("--size", type=float, default=0.008)
    parser.add_argument("--effects", default=",".join(PAIRED))
    parser.add_argument("--out", type=Path, default=Path("resolve.jsonl"))
    args = parser.parse_args()
    names = args.effects.split(",")
    rows = []
    for k in range(args.number):
        seed = FIRST_SEED + 10_000 * args.seed + k
        hidden = ((names[k % len(names)], args.size),)
        (made,) = make_sessions([{"seed": seed, "base": args.base, "hidden": hidden}])
        with tempfile.TemporaryDirectory(prefix="stiction-resolve-") as name:
            row = {"seed": seed, "base": args.base} | resolved(made, Path(name))
        rows.append(row)
        with args.out.open("a", encoding="utf-8") as file:
            file.write(json.dumps(row) + "\n")
        print(json.dumps(row), flush=True)
    asked = [row for row in rows if row["resolved"] is not None]
    right = int(np.sum([row["resolved"] for row in asked]))
    if asked:
        low, high = wilson(right, len(asked))
        share = 100.0 * right / len(asked)
        print(f"resolved: {right}/{len(asked)} = {share:.1f} % ({100 * low:.1f}–{100 * high:.1f})")


if __name__ == "__main__":
    main()
