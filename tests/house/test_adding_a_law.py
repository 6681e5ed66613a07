"""A law is one file and one line: the page that says so is followed to the letter."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from .core_copy import REPOSITORY, Copy

GENERIC = ("every_file", "parameters_are_documented", "laws_oppose", "slope_is_the_derivative")


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("cargo") is None, reason="cargo is not installed")
def test_the_law_of_the_page_builds_and_passes_the_generic_tests(tmp_path: Path) -> None:
    page = (REPOSITORY / "docs" / "adding-a-law.md").read_text("utf-8")
    line = re.search(r"^    (\w+ => \w+),$(?=\n    hsieh_pan)", page, re.M)
    file = re.search(r"`[\w/-]+/friction/(\w+)\.rs`, complete:\n\n```rust\n(.*?)```", page, re.S)
    assert line is not None
    assert file is not None
    copy = Copy(tmp_path)
    friction = copy.source / "friction"
    (friction / f"{file[1]}.rs").write_text(file[2], "utf-8")
    catalogue = (friction / "mod.rs").read_text("utf-8")
    extended = catalogue.replace("\nlaws! {\n", f"\nlaws! {{\n    {line[1]},\n")
    assert extended != catalogue
    (friction / "mod.rs").write_text(extended, "utf-8")
    # Few steps are run: not to optimise is quicker by far.
    words = ("test", "-p", "stiction-core", "--test", "catalogue", "--", *GENERIC)
    done = copy.cargo(*words, CARGO_PROFILE_TEST_OPT_LEVEL="0")
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    assert f"{len(GENERIC)} passed" in done.stdout
