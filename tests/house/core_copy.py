"""A copy of the core that a test may change and compile."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]


class Copy:
    """The workspace of the core in a folder of its own."""

    def __init__(self, folder: Path) -> None:
        self.root = folder / "stiction"
        self.root.mkdir()
        for name in ("crates", "benches"):
            ignored = shutil.ignore_patterns("target")
            shutil.copytree(REPOSITORY / name, self.root / name, ignore=ignored)
        for name in ("Cargo.toml", "Cargo.lock"):
            shutil.copy(REPOSITORY / name, self.root / name)
        self.source = self.root / "crates" / "stiction-core" / "src"

    def cargo(self, *words: str, **settings: str) -> subprocess.CompletedProcess[str]:
        """Run cargo there; what is built already of other crates need not be built again."""
        target = os.environ.get("CARGO_TARGET_DIR") or str(REPOSITORY / "target")
        return subprocess.run(
            ["cargo", *words],
            cwd=self.root,
            env={**os.environ, "CARGO_TARGET_DIR": target, **settings},
            capture_output=True,
            text=True,
            check=False,
        )
