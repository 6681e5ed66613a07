"""On a full disk a command says so in one sentence, and leaves what was there before."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
from tests.faults.verbs import (
    QUICK,
    VERBS,
    arguments,
    assert_one_sentence,
    assert_whole,
    contents,
    desk,
    lay,
    limited,
    run_verb,
    shell,
)

from stiction.cli.app import build


def test_every_verb_is_tried() -> None:
    assert set(VERBS) == {verb for verb in build() if not verb.startswith("-")}


@pytest.mark.parametrize("verb", QUICK)
def test_on_a_full_disk_nothing_is_half_there(
    verb: str, tmp_path: Path, full: tuple[Path, Callable[[], None] | None]
) -> None:
    folder = desk(tmp_path / "desk")
    out, before = full[0] / "out", full[1]
    kept = contents(full[0])
    assert_one_sentence(run_verb(arguments(verb, out), folder, before))
    assert contents(full[0]) == kept


@pytest.mark.parametrize(
    ("verb", "share"),
    [
        ("simulate", 0.5),
        ("fit", 0.1),
        ("fit", 0.95),
        ("diagnose", 0.5),
        ("compare", 0.5),
        ("laws", 0.1),
        ("effects", 0.95),
    ],
)
def test_old_files_stay_whole_where_the_new_ones_do_not_fit(
    verb: str, share: float, tmp_path: Path, good: Callable[[str], dict[str, bytes]]
) -> None:
    folder = desk(tmp_path / "desk")
    out = folder / "out"
    lay(good(verb), out)
    before = contents(out)
    size = 1 + int(share * max(map(len, before.values())))
    assert_one_sentence(run_verb(arguments(verb, out), folder, partial(limited, size)))
    assert_whole(out)
    assert set(contents(out)) == set(before)


def test_a_full_standard_output_is_told_in_a_sentence(tmp_path: Path) -> None:
    for words in ("laws", "--help", "laws --json"):
        done = shell(f"stiction {words} > /dev/full", tmp_path)
        assert done.returncode == 2, (words, done)
        assert done.stderr.count("\n") == 1
        assert done.stderr.startswith("stiction: ")
