"""A law is one file and one line: the page that says so is followed to the letter."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
GENERIC = ("every_file", "parameters_are_documented", "laws_oppose", "slope_is_the_derivative")


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("cargo") is None, reason="cargo is not installed")
def test_the_law_of_the_page_builds_and_passes_the_generic_tests(tmp_path: Path) -> None:
    page = (REPOSITORY / "docs" / "adding-a-law.md").read_text("utf-8")
    line = re.search(r"^    (\w+ => \w+),$(?=\n    hsieh_pan)", page, re.M)
    file = re.search(r"`[\w/-]+/friction/(\w+)\.rs`, complete:\n\n```rust\n(.*?)```", page, re.S)
    assert line is not None
    assert file is not None
    copy = tmp_path / "stiction"
    copy.mkdir()
    for name in ("crates", "benches"):
        shutil.copytree(REPOSITORY / name, copy / name, ignore=shutil.ignore_patterns("target"))
    for name in ("Cargo.toml", "Cargo.lock"):
        shutil.copy(REPOSITORY / name, copy / name)
    friction = copy / "crates" / "stiction-core" / "src" / "friction"
    (friction / f"{file[1]}.rs").write_text(file[2], "utf-8")
    catalogue = (friction / "mod.rs").read_text("utf-8")
    extended = catalogue.replace("\nlaws! {\n", f"\nlaws! {{\n    {line[1]},\n")
    assert extended != catalogue
    (friction / "mod.rs").write_text(extended, "utf-8")
    # What is built already of other crates need not be built again.
    target = os.environ.get("CARGO_TARGET_DIR") or str(REPOSITORY / "target")
    done = subprocess.run(
        ["cargo", "test", "-p", "stiction-core", "--test", "catalogue", "--", *GENERIC],
        cwd=copy,
        # Few steps are run: not to optimise is quicker by far.
        env={**os.environ, "CARGO_TARGET_DIR": target, "CARGO_PROFILE_TEST_OPT_LEVEL": "0"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    assert f"{len(GENERIC)} passed" in done.stdout
