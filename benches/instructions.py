"""Instructions a sample of the motor loop, of the parent commit and of this one, in one run.

Counted by valgrind, so a busy machine changes nothing. Without valgrind there is nothing to count.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
PLANTS = (
    "coulomb",
    "hsieh_pan",
    "hsieh_pan:breakaway=100",
    "hsieh_pan:hardening_exponent=2.5",
    "maxwell_slip",
    "maxwell_slip:weight_1=10",
    "bristle",
    "bristle:coulomb=3.5e-4",
    "elasto_plastic",
    "elasto_plastic:breakaway=2.3e-3",
    "coulomb+position_dependent_friction",
    "hsieh_pan+cogging",
    "hsieh_pan+direction_asymmetry",
    "lugre+cogging+position_dependent_friction+torque_bias",
)
"""A law, maybe with a parameter of it at which a sample is dear, and effects behind it."""
SAMPLES = 20_000


def built(source: Path, target: Path) -> Path | None:
    """The counting program of a tree, where it has one."""
    if not (source / "benches" / "count.rs").exists():
        return None
    build = ["cargo", "build", "--quiet", "--release", "-p", "stiction-benches", "--bin", "count"]
    subprocess.run([*build, "--target-dir", str(target)], cwd=source, check=True)
    return target / "release" / "count"


def instructions(program: Path, plant: str, passes: int) -> int | None:
    """Instructions of a whole run; None of a program that does not know the plant."""
    tool = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]
    done = subprocess.run(
        [*tool, program, plant, str(passes)], capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        return None
    found = re.search(r"Collected : (\d+)", done.stderr)
    if found is None:
        raise RuntimeError("valgrind tells no number")
    return int(found[1])


def a_sample(program: Path | None, plant: str) -> float | None:
    """Instructions a sample; the start of the program is taken off."""
    if program is None:
        return None
    twice, once = instructions(program, plant, 2), instructions(program, plant, 1)
    return None if twice is None or once is None else (twice - once) / SAMPLES


def main() -> None:
    """Print both numbers of each plant, and their ratio."""
    if shutil.which("valgrind") is None:
        sys.exit("not run: valgrind is missing; on Debian: apt-get install valgrind")
    now = built(ROOT, ROOT / "target")
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder) / "parent"
        git = ["git", "-C", str(ROOT), "worktree"]
        subprocess.run([*git, "add", "--quiet", "--detach", tree, "HEAD^"], check=True)
        try:
            before = built(tree, ROOT / "target" / "parent")
        finally:
            subprocess.run([*git, "remove", "--force", tree], check=True)
    for plant in PLANTS:
        own, old = a_sample(now, plant), a_sample(before, plant)
        if own is None:
            sys.exit(f"{plant} does not run")
        if old is None:
            print(f"{plant:56}{own:8.1f}   the parent commit does not count it")
            continue
        print(f"{plant:56}{old:8.1f} ->{own:8.1f}   {own / old:.3f}")


if __name__ == "__main__":
    main()
