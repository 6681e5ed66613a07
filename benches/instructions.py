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
LAWS = ("coulomb", "hsieh_pan", "maxwell_slip")
SAMPLES = 20_000


def built(source: Path, target: Path) -> Path | None:
    """The counting program of a tree, where it has one."""
    if not (source / "benches" / "count.rs").exists():
        return None
    build = ["cargo", "build", "--quiet", "--release", "-p", "stiction-benches", "--bin", "count"]
    subprocess.run([*build, "--target-dir", str(target)], cwd=source, check=True)
    return target / "release" / "count"


def instructions(program: Path, law: str, passes: int) -> int:
    """Instructions of a whole run."""
    tool = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]
    done = subprocess.run(
        [*tool, program, law, str(passes)], capture_output=True, text=True, check=True
    )
    found = re.search(r"Collected : (\d+)", done.stderr)
    if found is None:
        raise RuntimeError("valgrind tells no number")
    return int(found[1])


def a_sample(program: Path, law: str) -> float:
    """Instructions a sample; the start of the program is taken off."""
    return (instructions(program, law, 2) - instructions(program, law, 1)) / SAMPLES


def main() -> None:
    """Print both numbers of each law, and their ratio."""
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
    for law in LAWS:
        own = a_sample(now, law)
        if before is None:
            print(f"{law:14}{own:8.1f}   the parent commit has no counting program")
            continue
        old = a_sample(before, law)
        print(f"{law:14}{old:8.1f} ->{own:8.1f}   {own / old:.3f}")


if __name__ == "__main__":
    main()
