"""Runs cases in processes of their own, so that what hangs or ends the process is a find."""

from __future__ import annotations

import contextlib
import faulthandler
import math
import multiprocessing
import os
import re
import resource
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

from .cases import LONG, SCENES, names, program
from .judge import Find, callee, close_figures, judge
from .surface import targets

CPU_S = 5.0
"""What a line may take on the few samples that cases have."""
LONG_CPU_S = 90.0
"""And one that simulates many times: a fit, a diagnosis, a comparison."""
FORMS = 4
"""Calls in a line that looks whether a state comes back."""
WALL_TIMES = 12.0
"""Longer than so many times its patience on the clock, a case does not work: it waits."""
IDLE = 0.01
"""Share of the clock below which a process does nothing."""
MEMORY = 6 << 30
"""Bytes that a worker may ask for."""
LIVES = 3000
"""Cases after which a worker is replaced: what leaks must not end the hunt."""
FIRST_S = 0.05
"""What a first case is taken to cost, s: what costs little is begun with."""


@dataclass
class Task:
    """A case: its target and seed, or a program that stands for itself."""

    name: str
    seed: str
    lines: list[str] | None = None

    @property
    def case(self) -> str:
        return f"{self.name}/{self.seed}"

    def program(self) -> list[str]:
        if self.lines is None:
            self.lines = program(self.name, self.seed)
        return self.lines


def patience(line: str, name: str) -> float:
    """Seconds of processor that a line may take."""
    slow = name in LONG or name.startswith(("paper.", "command.", "report."))
    heavy = callee(line) in LONG or "made(" in line or "paper." in line
    if slow or heavy:
        return LONG_CPU_S
    # Each of four forms goes on by itself, and may come to the ceiling of a call.
    return FORMS * CPU_S if line.startswith("round_trips(") else CPU_S


class Worker:
    """A process that runs one case at a time, under a watch."""

    def __init__(self) -> None:
        self._dump = tempfile.NamedTemporaryFile(prefix="fuzz-dump-", delete=False)  # noqa: SIM115
        self._line = tempfile.NamedTemporaryFile(prefix="fuzz-line-", delete=False)  # noqa: SIM115
        self.task: Task | None = None
        self.done = 0
        self._start()

    def _start(self) -> None:
        # What all need is imported once, here.
        targets()
        context = multiprocessing.get_context("fork")
        self.pipe, theirs = context.Pipe()
        args = (theirs, self._dump.name, self._line.name)
        self.process = context.Process(target=_work, args=args, daemon=True)
        self.process.start()
        theirs.close()
        self.lives = LIVES

    def give(self, task: Task) -> None:
        """Start a case."""
        if self.lives <= 0:
            self.end()
            self._start()
        self.lives -= 1
        self.task, self.began = task, time.monotonic()
        self._worked = _worked(self.process.pid or 0)
        Path(self._line.name).write_bytes(b"0")
        Path(self._dump.name).write_bytes(b"")
        self._patience = max(patience(line, task.name) for line in task.program())
        self.pipe.send((task.name, task.seed, task.lines))

    def poll(self) -> tuple[list[Find], float] | None:
        """What a case found and how long it took, None where it is still at work."""
        assert self.task is not None
        try:
            if self.pipe.poll():
                return self.pipe.recv()  # type: ignore[no-any-return]
        except (EOFError, OSError):
            return [self._lost()], time.monotonic() - self.began
        if not self.process.is_alive():
            return [self._lost()], time.monotonic() - self.began
        if self._waits():
            with contextlib.suppress(ProcessLookupError):
                os.kill(self.process.pid or 0, signal.SIGABRT)
            self.process.join(5.0)
        return None

    def _waits(self) -> bool:
        """Whether a case is late by the clock, and not because others have the processor."""
        lasted = time.monotonic() - self.began
        if lasted < WALL_TIMES * self._patience:
            return False
        return _worked(self.process.pid or 0) - self._worked < IDLE * lasted

    def _lost(self) -> Find:
        """What ended the process, from the dump that it left; a new one is started."""
        assert self.task is not None
        self.process.join()
        shutil.rmtree(Path(tempfile.gettempdir()) / f"fuzz-{self.process.pid}", ignore_errors=True)
        code = self.process.exitcode or 0
        dump = Path(self._dump.name).read_text(encoding="utf-8", errors="replace")
        number = int(Path(self._line.name).read_bytes() or b"0")
        line = self.task.program()[number]
        waits = time.monotonic() - self.began > WALL_TIMES * self._patience
        kind = {-signal.SIGPROF: "hang", -signal.SIGABRT: "waits for ever" if waits else "abort"}
        self._start()
        name = kind.get(code, f"ended by {-code}" if code < 0 else f"exit {code}")
        called = callee(line, self.task.name.partition(".")[0])
        return Find(name, _place(dump) or called, f"{name} in {called}", line)

    def run(self, task: Task, until: float = math.inf) -> list[Find]:
        """Run one case to its end, or to this time of the clock, by which it found nothing."""
        self.give(task)
        while True:
            left = until - time.monotonic()
            if left <= 0.0:
                self.end()
                self._start()
                return []
            wait([self.pipe, self.process.sentinel], timeout=min(1.0, left))
            found = self.poll()
            if found is not None:
                return found[0]

    def end(self) -> None:
        self.pipe.close()
        self.process.kill()
        self.process.join()
        shutil.rmtree(Path(tempfile.gettempdir()) / f"fuzz-{self.process.pid}", ignore_errors=True)

    def close(self) -> None:
        self.end()
        for file in (self._dump, self._line):
            file.close()
            Path(file.name).unlink(missing_ok=True)


def _worked(pid: int) -> float:
    """Seconds of processor that a process had; 0 where the system does not say."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / float(os.sysconf("SC_CLK_TCK"))


def _place(dump: str) -> str:
    """The innermost place of the package in a dump of the thread that was at work."""
    stacks = dump.split("Current thread")[-1]
    for file, function in re.findall(r'File "([^"]+)", line \d+ in (\S+)', stacks):
        if "/stiction/" in file and "/tests/" not in file:
            return f"{file.rpartition('/stiction/')[2]} {function}"
    return ""


def _work(pipe: Connection, dump: str, line: str) -> None:
    """What a worker does."""
    quiet = os.open(os.devnull, os.O_WRONLY)
    # A panic prints itself as well; it is told once.
    os.dup2(quiet, sys.stderr.fileno())
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    limits = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, limits[1]))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    with open(dump, "ab") as out, open(line, "r+b", buffering=0) as place:
        faulthandler.enable(out)
        faulthandler.register(signal.SIGPROF, out, chain=True)
        while True:
            try:
                name, seed, lines = pipe.recv()
            except (EOFError, OSError):
                os._exit(0)
            task = Task(name, seed, lines)
            texts = task.program()

            def beginning(number: int, texts: list[str] = texts, name: str = name) -> None:
                place.seek(0)
                place.write(str(number).encode())
                place.truncate()
                signal.setitimer(signal.ITIMER_PROF, patience(texts[number], name))

            began = time.process_time()
            try:
                finds = judge(texts, beginning)
            except BaseException as error:
                # A fault of the fuzzer itself is told, and never hidden.
                finds = [Find("fuzzer", type(error).__name__, f"{error!r}", texts[0])]
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            close_figures()
            pipe.send((finds, time.process_time() - began))


@dataclass
class Tally:
    """What was run, and what was found."""

    calls: dict[str, int] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)
    finds: dict[str, list[tuple[str, Find]]] = field(default_factory=dict)

    def add(self, task: Task, finds: list[Find], seconds: float) -> list[Find]:
        """Count a case; finds that are new."""
        self.calls[task.name] = self.calls.get(task.name, 0) + 1
        self.seconds[task.name] = self.seconds.get(task.name, 0.0) + seconds - FIRST_S + 1e-3
        new = [find for find in finds if find.signature not in self.finds]
        for find in finds:
            self.finds.setdefault(find.signature, []).append((task.case, find))
        return new

    def next(self, known: tuple[str, ...]) -> str:
        """What is due: that on which least time was spent, called once at least."""
        return min(known, key=lambda name: (self.seconds.get(name, FIRST_S) / weight(name), name))


def weight(name: str) -> float:
    """How much time something gets beside others: what has most to it, most."""
    if name in SCENES or name.startswith("file."):
        return 10.0
    first = name.partition(".")[0]
    return {"Motor": 6.0, "FrictionModel": 4.0, "Ensemble": 3.0, "paper": 0.3}.get(first, 1.0)


def hunt(
    seconds: float, seed: int, workers: int, tally: Tally, known: tuple[str, ...] = ()
) -> Iterator[tuple[Task, Find]]:
    """Run cases for a time; each new find as it comes.

    Parameters
    ----------
    seconds : float
    seed : int
        Of all cases.
    workers : int
        Processes.
    tally : Tally
        Is counted on.
    known : tuple of str, optional
        Targets; all without it.
    """
    pool = [Worker() for _ in range(workers)]
    started: dict[str, int] = {}
    end = time.monotonic() + seconds
    wanted = known or names()

    def start(worker: Worker) -> None:
        name = tally.next(wanted)
        number = started.get(name, 0)
        started[name] = number + 1
        # What is at work is not due again before anything else is.
        tally.seconds[name] = tally.seconds.get(name, 0.0) + FIRST_S
        worker.give(Task(name, f"{seed}.{number}"))

    try:
        for worker in pool:
            start(worker)
        while time.monotonic() < end:
            waited: list[Any] = [w.pipe for w in pool] + [w.process.sentinel for w in pool]
            wait(waited, timeout=min(1.0, max(0.0, end - time.monotonic())))
            for worker in pool:
                answer = worker.poll()
                if answer is None or worker.task is None:
                    continue
                task = worker.task
                for find in tally.add(task, *answer):
                    yield task, find
                start(worker)
    finally:
        for worker in pool:
            worker.close()


def workers_for(cores: int | None = None) -> int:
    return max(1, math.floor(cores or os.cpu_count() or 1))
