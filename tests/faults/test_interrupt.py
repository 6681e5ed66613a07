"""Ctrl-C and SIGTERM at any moment: nothing is half there, and Ctrl-C is answered."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.faults.verbs import (
    KEEPERS,
    PATIENCE_S,
    Running,
    arguments,
    assert_whole,
    contents,
    desk,
    lay,
    run_verb,
)

VERBS = ("simulate", "fit", "diagnose", "plan", "demo")
MOMENTS = 2
"""Of each verb: what is missed by one run is met by the next, for the seed differs."""
SHORTEST_S = 0.02
MOST_TRIES = 8
"""Of a verb that is over before it is interrupted."""


@pytest.fixture(scope="module")
def lasts(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], float]:
    """How long a verb works where nobody stops it, s."""
    known: dict[str, float] = {"demo": 5.0}

    def measured(verb: str) -> float:
        if verb not in known:
            folder = desk(tmp_path_factory.mktemp("lasts") / verb)
            began = time.monotonic()
            assert run_verb(arguments(verb, folder / "out"), folder).status == 0
            known[verb] = time.monotonic() - began
        return known[verb]

    return measured


@pytest.fixture
def source() -> random.Random:
    """Draws moments anew for each test; what failed shows the seed, and ``SEED`` gives it again."""
    seed = int(os.environ.get("SEED") or random.SystemRandom().randrange(10**6))
    print(f"SEED={seed}")
    return random.Random(seed)


def moments(verb: str, lasts: float, source: random.Random) -> list[float]:
    """Early, in the middle and late."""
    number = 1 if verb == "demo" else MOMENTS
    return [SHORTEST_S + lasts * (k + source.random()) / number for k in range(number)]


@pytest.mark.parametrize("verb", VERBS)
def test_an_interrupted_command_says_so_and_leaves_whole_files(
    verb: str, tmp_path: Path, lasts: Callable[[str], float], source: random.Random
) -> None:
    answers: list[int] = []
    asked = moments(verb, lasts(verb), source)
    for k, moment in enumerate(asked):
        folder = desk(tmp_path / f"desk{k}")
        running = Running(arguments(verb, folder / "out"), folder)
        time.sleep(moment)
        running.strike(signal.SIGINT)
        ended = running.ended()
        told = f"after {moment:.3f} s: {ended}"
        assert "Traceback" not in ended.error, told
        assert ended.status in (0, 130), told
        if ended.status == 130:
            assert "interrupted" in ended.error + ended.out, told
        assert_whole(folder)
        answers.append(ended.status)
        if 130 not in answers and len(asked) == k + 1 < MOST_TRIES:
            # What it took the first time it may not take again.
            asked.append(0.5 * moment)
    assert 130 in answers, "it was over before it was interrupted"


@pytest.mark.parametrize("verb", [verb for verb in VERBS if verb not in (*KEEPERS, "demo")])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_old_files_or_new_ones_are_there_after_a_signal(
    verb: str,
    number: int,
    tmp_path: Path,
    lasts: Callable[[str], float],
    good: Callable[[str], dict[str, bytes]],
    source: random.Random,
) -> None:
    folder = desk(tmp_path / "desk")
    out = folder / "out"
    lay(good(verb), out)
    running = Running(arguments(verb, out), folder)
    # Files are written at the end.
    time.sleep(source.uniform(0.8, 1.05) * lasts(verb))
    running.strike(number)
    ended = running.ended()
    assert ended.status in (0, 130, -signal.SIGTERM), ended
    assert "Traceback" not in ended.error
    now = contents(out)
    assert set(now) >= set(good(verb))
    # What was being written beside when the process was ended is no file of the answer.
    lay({name: now[name] for name in good(verb)}, tmp_path / "answer")
    assert_whole(tmp_path / "answer")


def test_ctrl_c_while_the_program_starts_is_heard(tmp_path: Path, source: random.Random) -> None:
    folder = desk(tmp_path / "desk")
    started = subprocess.Popen(
        [sys.executable, "-m", "stiction", *arguments("diagnose", folder / "out")],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # What runs in the background may be told to ignore Ctrl-C.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    time.sleep(source.uniform(0.3, 1.5))
    started.send_signal(signal.SIGINT)
    _, error = started.communicate(timeout=PATIENCE_S)
    assert started.returncode in (0, 130, -signal.SIGINT), error
    # Before the package is there at all, it is Python that says how it ends.
    assert "/stiction/" not in error
    if started.returncode == 130:
        assert "interrupted" in error


def test_patience_is_more_than_any_verb_takes(lasts: Callable[[str], float]) -> None:
    assert max(lasts(verb) for verb in VERBS) < 0.9 * PATIENCE_S
