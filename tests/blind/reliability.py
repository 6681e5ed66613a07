"""Counts how often names were right, by how they were told, and writes what a diagnosis says of it.

    python -m tests.blind.reliability grid.jsonl ordinary.jsonl axis4.jsonl

The files are results of the counts of sessions (``python -m tests.blind.ordinary``), of as many
plants as there are. Manners are those of ``stiction.diagnosis.findings.reliability``.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from itertools import product
from pathlib import Path

from stiction.diagnosis.findings.reliability import COUNTS, manner

HEAD = """# How often names were right in sessions whose truth was known, by how they were told.
# Written by `python -m tests.blind.reliability`: {sessions} sessions of {files} counts.
# told: names; first: right ones; listed: right ones, or with the right one among their look-alikes.
"""


def counted(rows):
    """Names by manner: ``told``, ``first`` and ``listed``."""
    found = {
        manner(decided=decided, several=several, unexplained=unexplained): Counter()
        for decided, several, unexplained in product((True, False), repeat=3)
    }
    for row in rows:
        for cause in row.get("found", ()):
            own = found[
                manner(
                    decided=cause["decided"],
                    several=bool(cause["look_alikes"]),
                    unexplained=row["verdict"] == "unexplained",
                )
            ]
            hidden = set(row["names"])
            own["told"] += 1
            own["first"] += cause["name"] in hidden
            own["listed"] += bool(hidden & {cause["name"], *cause["look_alikes"]})
    return found


def text_of(files):
    """The content of the file that the package reads."""
    rows = [json.loads(line) for file in files for line in file.read_text("utf-8").splitlines()]
    told = HEAD.format(sessions=len(rows), files=len(files))
    for name, own in counted(rows).items():
        numbers = "\n".join(f"{key} = {own[key]}" for key in ("told", "first", "listed"))
        told += f"\n[manner.{name}]\n{numbers}\n"
    return told


def main():
    parser = argparse.ArgumentParser(prog="python -m tests.blind.reliability", description=__doc__)
    parser.add_argument("results", nargs="+", type=Path)
    COUNTS.write_text(text_of(parser.parse_args().results), encoding="utf-8")
    print(COUNTS.read_text(encoding="utf-8"))


if __name__ == "__main__":
    main()
