"""On a full disk a command says so in one sentence, and leaves what was there before."""

from __future__ import annotations

import resource
import signal
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from stiction.cli.app import build

from .verbs import (
    KEEPERS,
    QUICK,
    VERBS,
    arguments,
    assert_one_sentence,
    assert_whole,
    contents,
    desk,
    run_verb,
    shell,
)


def limited(size: int) -> None:
    """No file may become longer than this."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))


def test_every_verb_is_tried() -> None:
    assert set(VERBS) == {verb for verb in build() if not verb.startswith("-")}


@pytest.mark.parametrize("verb", QUICK)
def test_files_that_do_not_fit_are_refused_and_nothing_of_them_stays(
    verb: str, tmp_path: Path
) -> None:
    folder = desk(tmp_path / "desk")
    out = folder / "out"
    # Less than the smallest file that any verb writes.
    assert_one_sentence(run_verb(arguments(verb, out), folder, partial(limited, 200)))
    assert_whole(out)
    assert_whole(folder)


@pytest.mark.parametrize("verb", [verb for verb in QUICK if verb not in KEEPERS])
@pytest.mark.parametrize("share", [0.0, 0.5, 0.95])
def test_old_files_stay_whole_where_the_new_ones_do_not_fit(
    verb: str, share: float, tmp_path: Path, good: Callable[[str], dict[str, bytes]]
) -> None:
    folder = desk(tmp_path / "desk")
    out = folder / "out"
    for name, content in good(verb).items():
        (out / name).parent.mkdir(parents=True, exist_ok=True)
        (out / name).write_bytes(content)
    before = contents(out)
    size = 1 + int(share * max(map(len, before.values())))
    ended = run_verb(arguments(verb, out), folder, partial(limited, size))
    assert_one_sentence(ended)
    assert_whole(out)
    assert set(contents(out)) >= set(before)


@pytest.mark.parametrize("verb", QUICK)
def test_a_full_file_system_is_told_in_a_sentence(
    verb: str, tmp_path: Path, mounted: Callable[[str], Path]
) -> None:
    folder = desk(tmp_path / "desk")
    full = mounted("size=4k")
    (full / "filler").write_bytes(b"x" * 4096)
    ended = run_verb(arguments(verb, full / "out"), folder)
    assert_one_sentence(ended)
    assert "No space left" in ended.error or "cannot be" in ended.error
    assert set(contents(full)) == {"filler"}


def test_a_full_standard_output_is_told_in_a_sentence(tmp_path: Path) -> None:
    for words in ("laws", "--help", "laws --json"):
        done = shell(f"stiction {words} > /dev/full", tmp_path)
        assert done.returncode == 2, (words, done)
        assert done.stderr.count("\n") == 1
        assert done.stderr.startswith("stiction: ")
