"""Command line: hunt for a time, or run one case or one program again."""

from __future__ import annotations

import argparse
import random
import sys
import time

from .cases import names
from .corpus import keep
from .hunt import Tally, Task, Worker, hunt, workers_for
from .judge import Find
from .shrink import shrunk

SHRINK_S = 20.0
"""For making one find short."""
SLOWER = 4.0
"""Times that for one that shows only after seconds."""
ALL_SHRINK_S = 60.0
"""For all of them together, on the clock: who waits for an answer must know how long."""


def main() -> int:
    args = _arguments()
    if args.case:
        return _again(args.case)
    seed = random.SystemRandom().randrange(10**6) if args.seed is None else args.seed
    chosen = tuple(n for n in names() if not args.only or any(w in n for w in args.only))
    if not chosen:
        print(f"nothing is called {' or '.join(args.only)}", file=sys.stderr)
        return 2
    print(f"seed {seed}, {len(chosen)} targets, {args.workers} processes", flush=True)
    tally = Tally()
    began = time.monotonic()
    found: list[tuple[Task, Find]] = []
    try:
        for task, find in hunt(args.seconds, seed, args.workers, tally, chosen):
            found.append((task, find))
            print(f"{find.signature}: {find.what[:300]}", flush=True)
            print(f"    python -m tests.fuzz --case {task.case}", flush=True)
    except KeyboardInterrupt:
        print("interrupted")
    _shrink_all(
        found, min(SHRINK_S, args.seconds / 6.0), min(ALL_SHRINK_S, args.seconds), args.keep
    )
    print(summary(tally, time.monotonic() - began))
    return 1 if tally.finds else 0


def _shrink_all(
    found: list[tuple[Task, Find]], seconds: float, altogether: float, keeping: bool
) -> None:
    """Each find once more, as short as it gets in its share of the time."""
    found = [(task, find) for task, find in found if find.kind != "fuzzer"]
    if not found:
        return
    last = time.monotonic() + altogether
    worker = Worker()
    try:
        for number, (task, find) in enumerate(found):
            slow = find.kind in ("hang", "waits for ever")
            now = time.monotonic()
            share = max(last - now, 0.0) / (len(found) - number)
            end = now + min(seconds * (SLOWER if slow else 1.0), share)
            program = shrunk(
                task.program(),
                find,
                lambda lines, name=task.name, end=end: worker.run(Task(name, "shrunk", lines), end),
                end,
            )
            print(f"\n{find.signature} ({task.case})\n    " + "\n    ".join(program), flush=True)
            if keeping:
                print(f"    kept as {keep(find.signature, task.case, program).name}")
    except KeyboardInterrupt:
        print("interrupted: the rest is not made short")
    finally:
        worker.close()


def _again(case: str) -> int:
    """One case, line by line, and what it finds."""
    name, _, seed = case.rpartition("/")
    task = Task(name, seed)
    print("\n".join(task.program()))
    worker = Worker()
    try:
        finds = worker.run(task)
    finally:
        worker.close()
    for find in finds:
        print(f"{find.signature}: {find.what}\n    {find.line}")
    return 1 if finds else 0


def summary(tally: Tally, seconds: float) -> str:
    """Calls of each target, and finds of each kind."""
    lines = [f"\n{sum(tally.calls.values())} cases in {seconds:.0f} s"]
    rows = sorted(tally.calls.items(), key=lambda row: -row[1])
    lines += [f"{count:8d} {name}" for name, count in rows]
    lines += [f"{len(tally.finds)} kinds of finds"]
    for signature, cases in sorted(tally.finds.items(), key=lambda row: -len(row[1])):
        lines.append(f"{len(cases):8d} {signature}, first {cases[0][0]}")
    return "\n".join(lines)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("--seconds", type=float, default=3600.0, help="how long; an hour")
    parser.add_argument("--seed", type=int, help="of all cases; a fresh one without it")
    parser.add_argument("--workers", type=int, default=workers_for(), help="processes; all cores")
    parser.add_argument("--only", nargs="*", default=(), help="parts of names of targets")
    parser.add_argument("--case", help="one case again, as it was printed: Motor.step/7.12")
    parser.add_argument("--keep", action="store_true", help="keep finds in the corpus")
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
