"""Ctrl-C and SIGTERM at any moment: nothing is half there, and Ctrl-C is answered.

``python -m tests.faults.test_interrupt --number 100`` interrupts at that many moments, of native
calls and verbs drawn at random, and says how long each took to answer. Beside the clock stands what
the process did not wait for a processor that others had (Linux tells).
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.core import test_interrupt as native
from tests.core.rigs import contact, motor
from tests.faults.verbs import (
    KEEPERS,
    PATIENCE_S,
    Running,
    arguments,
    assert_whole,
    contents,
    desk,
    forks,
    lay,
    run_verb,
)

import stiction as st

VERBS = ("simulate", "fit", "diagnose", "plan", "demo")
MOMENTS = 2
"""Of each verb: what is missed by one run is met by the next, for the seed differs."""
SHORTEST_S = 0.02
MOST_TRIES = 8
"""Of a verb that is over before it is interrupted."""
SOON_S = 0.2
"""In which Ctrl-C is to be answered."""
BEGUN_S = 1.0
"""A call is interrupted within its first so many seconds."""


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
    # The best so far, which Ctrl-C ends with, has the figures that it can have.
    cut = {name for name in good(verb) if ended.status == 130 and name.startswith("figures")}
    assert set(now) >= set(good(verb)) - cut
    # What was being written beside when the process was ended is no file of the answer.
    lay({name: now[name] for name in good(verb) if name in now}, tmp_path / "answer")
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


def fleet() -> Callable[[], Any]:
    """Samples of many motors."""
    many = st.Ensemble(motor("hook"), 200)
    current = np.full(200_000, 0.1)
    return lambda: many.simulate(current, 1e-4, reduce="last", threads=2)


def one_sample() -> Callable[[], Any]:
    """A single sample of many motors, each of which divides it."""
    many = st.Ensemble(native.slow(), 3000)
    return lambda: many.step_many(0.1, 1e-4)


def moved() -> Callable[[], Any]:
    """A contact that is moved."""
    model, held = contact("hook"), np.zeros(2_000_000)
    return lambda: model.simulate(held, 1e-4)


def smoothing() -> Callable[[], Any]:
    """Windows without end."""
    readings, halves = np.zeros(300_000), list(range(400))
    return lambda: st._native.adaptively_smoothed(readings, 1e-6, halves)


def called(name: str) -> Callable[[], Any]:
    """A call of a motor, ready to be made."""
    if name in OTHERS:
        return OTHERS[name]()
    machine = native.MADE.get(name, lambda: motor("hook"))()
    motion = native.swing()
    return lambda: native.CALLS[name](machine, motion)


OTHERS: dict[str, Callable[[], Callable[[], Any]]] = {
    "Ensemble.simulate": fleet,
    "Ensemble.step_many": one_sample,
    "FrictionModel.simulate": moved,
    "adaptively_smoothed": smoothing,
}
INTERRUPTED = ("simulate", "fit", "diagnose", "plan", "compare", "paper", "demo")
"""Verbs that work for long enough."""


def _works(name: str, ready: Path) -> None:
    """Make a call again and again."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        call = called(name)
        ready.touch()
        while True:
            call()
    except KeyboardInterrupt:
        os._exit(130)


def _waited(process: BaseProcess) -> float:
    """Seconds that a process waited for a processor; 0 where the system does not say."""
    with suppress(OSError, ValueError, IndexError):
        return 1e-9 * int(Path(f"/proc/{process.pid}/schedstat").read_text().split()[1])
    return 0.0


def answered(
    process: BaseProcess, strike: Callable[[], None], told: Callable[[], bool]
) -> tuple[float, float]:
    """How long a process takes to end or to tell that it was interrupted, s.

    By the clock, and without its waits for a processor.
    """
    before, last = _waited(process), 0.0
    began = time.monotonic()
    strike()
    while process.is_alive() and not told() and time.monotonic() - began < PATIENCE_S:
        last = max(last, _waited(process))
        process.join(0.002)
    took = time.monotonic() - began
    return took, took - max(last - before, 0.0)


def interrupted(name: str, folder: Path, source: random.Random) -> tuple[int, float, float]:
    """Interrupt a verb or a call at some moment; its status and what `answered` tells."""
    if name in INTERRUPTED:
        running = Running(arguments(name, desk(folder) / "out"), folder)
        process, number = running.process, lambda: running.strike(signal.SIGINT)
        told = running.interrupted
        time.sleep(source.uniform(SHORTEST_S, {"simulate": 0.3}.get(name, 4.0)))
    else:
        ready = folder.with_suffix(".ready")
        process = forks().Process(target=_works, args=(name, ready))
        process.start()
        while not ready.exists():
            time.sleep(0.005)
        time.sleep(source.uniform(0.0, BEGUN_S))

        def number() -> None:
            os.kill(process.pid or 0, signal.SIGINT)

        def told() -> bool:
            return False

    took = answered(process, number, told)
    process.join()
    return process.exitcode or 0, *took


def main() -> int:
    """Interrupt at many moments and count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--number", type=int, default=100)
    parser.add_argument("--seed", type=int, default=int(time.time()))
    chosen = parser.parse_args()
    source = random.Random(chosen.seed)
    print(f"seed {chosen.seed}")
    names = [*native.CALLS, *OTHERS, *INTERRUPTED]
    late = busy = done = over = 0
    with tempfile.TemporaryDirectory() as where:
        while done < chosen.number:
            name = source.choice(names)
            status, clock, own = interrupted(name, Path(where) / f"{done}-{over}", source)
            if status == 0:
                # It was over before it was interrupted.
                over += 1
                continue
            done += 1
            late += own > SOON_S
            busy += clock > SOON_S
            mark = " LATE" if own > SOON_S else ""
            print(f"{name}: {1e3 * clock:.0f} ms, {1e3 * own:.0f} without waits{mark}", flush=True)
    print(f"{done - busy} of {done} within {1e3 * SOON_S:.0f} ms, {done - late} without waits")
    return 1 if late else 0


if __name__ == "__main__":
    sys.exit(main())
