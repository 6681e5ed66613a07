"""Every verb of the command on a small session, in processes that something happens to."""

from __future__ import annotations

import json
import multiprocessing
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from multiprocessing.process import BaseProcess
from pathlib import Path

from tests.cli.desk import Desk

from stiction.cli import app as cli

PROGRESS = re.compile(r"\d[\d a-z]*: ")
"""A line of what a long run is doing begins with the time that has gone."""
COLUMNS = "time=t, input=u [Nm], position=q [rad]"
VERBS: dict[str, tuple[str, ...]] = {
    "simulate": ("simulate", "plant.toml", "run.csv", "--columns", COLUMNS),
    "fit": ("fit", "session.toml"),
    "diagnose": ("diagnose", "session.toml", "--surrogates", "4"),
    "watch": ("watch", "logs", "--once", "--columns", COLUMNS, "--surrogates", "4"),
    "plan": ("plan", "plant.toml", "--only", "turns"),
    "init": ("init", "run.csv"),
    "import": ("import", "params.json"),
    "library": ("library", "ur10e_wrist", "--session", "session.toml"),
    "export": ("export", "plant.toml", "--to", "table", "--to", "urdf", "--to", "c"),
    "compensate": ("compensate", "plant.toml", "--session", "loop.toml"),
    "compare": ("compare", "coulomb", "--steps", "1000", "--draws", "0"),
    "bench": ("bench", "score", "bench", "bench/answers"),
    "laws": ("laws",),
    "effects": ("effects",),
    "completion": ("completion", "man"),
    "paper": ("paper",),
    "demo": ("demo",),
}
"""How each verb is run in a folder that holds the session; --out follows."""
QUICK = tuple(verb for verb in VERBS if verb not in ("paper", "demo"))
"""Those that are done in seconds."""
KEEPERS = ("plan", "init", "import")
"""Verbs that refuse a folder which holds their files already."""
PATIENCE_S = 240.0
"""Far more than any of it takes, on a machine that has much else to do."""


@dataclass(frozen=True)
class Ended:
    """How a process ended: its status as a shell counts it, and what it said."""

    status: int
    out: str
    error: str


def arguments(verb: str, out: Path) -> list[str]:
    return [*VERBS[verb], "--out", str(out)]


class Running:
    """A verb at work in a process of its own, which was forked from one that has all imports.

    Parameters
    ----------
    words : sequence of str
        Of the command.
    folder : Path
        In which it runs.
    before : callable, optional
        Called in the process before anything else.
    """

    def __init__(
        self, words: Sequence[str], folder: Path, before: Callable[[], None] | None = None
    ) -> None:
        self._said = [folder.parent / f"{folder.name}.{name}" for name in ("out", "err")]
        args = (list(words), folder, self._said, before)
        self.process: BaseProcess = forks().Process(target=_command, args=args)
        self.process.start()

    def strike(self, number: int) -> None:
        """Send a signal, where it is still at work."""
        with suppress(ProcessLookupError):
            os.kill(self.process.pid or 0, number)

    def interrupted(self) -> bool:
        """Whether it says by now that it was interrupted, and writes what there is."""
        return self._said[1].exists() and "interrupted" in self._said[1].read_text()

    def ended(self) -> Ended:
        """How it ended."""
        self.process.join(PATIENCE_S)
        if self.process.is_alive():
            self.process.kill()
            self.process.join()
            raise AssertionError(f"it does not end: {self._said[1].read_text()}")
        out, error = (path.read_text(encoding="utf-8") for path in self._said)
        return Ended(self.process.exitcode or 0, out, error)


@cache
def forks() -> multiprocessing.context.ForkServerContext:
    """Processes that have all imports from the start, and no threads."""
    context = multiprocessing.get_context("forkserver")
    # The server imports before it is told where from.
    os.environ["PYTHONPATH"] = os.pathsep.join(path for path in sys.path if path)
    # What a verb needs is imported when it is asked for.
    verbs = sorted({f"stiction.cli.{verb.where.partition(':')[0]}" for verb in cli.VERBS})
    context.set_forkserver_preload(["tests.faults.verbs", *verbs])
    return context


def _command(
    words: list[str], folder: Path, said: list[Path], before: Callable[[], None] | None
) -> None:
    from stiction.cli import run

    os.chdir(folder)
    for number, path in enumerate(said, 1):
        file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(file, number)
    sys.stdout, sys.stderr = (open(n, "w", closefd=False) for n in (1, 2))  # noqa: SIM115
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if before is not None:
        before()
    status = run(words)
    with suppress(OSError):
        sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


def run_verb(words: Sequence[str], folder: Path, before: Callable[[], None] | None = None) -> Ended:
    """Run a verb to its end."""
    return Running(words, folder, before).ended()


def shell(script: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """A line of shell in which ``stiction`` is the command, from its start to its last word."""
    environment = {**os.environ, "STICTION": f"{sys.executable} -m stiction"}
    return subprocess.run(
        ["bash", "-c", f'stiction() {{ $STICTION "$@"; }}; {script}'],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )


def limited(size: int) -> None:
    """No file may become longer than this."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))


def gone() -> None:
    """The folder in which the process stands, removed."""
    shutil.rmtree(os.getcwd())


def desk(folder: Path) -> Path:
    """A folder with a good session in it."""
    folder.mkdir(parents=True)
    Desk(folder).loop()
    Desk(folder).parameters()
    logs = folder / "logs"
    logs.mkdir()
    Desk(logs)
    for name in ("plant.toml", "session.toml"):
        (logs / name).unlink()
    lay(answered_bench(), folder / "bench")
    return folder


@cache
def answered_bench() -> dict[str, bytes]:
    """What is looked at where a bench of a session is scored, and an answer to it."""
    from stiction.bench import make

    with tempfile.TemporaryDirectory() as name:
        where = Path(name) / "bench"
        make(where, number=1, seconds=(4.0, 4.0))
        answer = json.dumps({"verdict": "nothing_missing", "effects": []})
        made = contents(where)
    kept = {name: made[name] for name in made if name.startswith(("truth/", "bench.json"))}
    return kept | {"answers/session_0001.json": answer.encode()}


def lay(files: dict[str, bytes], folder: Path) -> None:
    """Write files into a folder."""
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)


def contents(folder: Path) -> dict[str, bytes]:
    """Every file of a folder."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def assert_one_sentence(ended: Ended) -> None:
    """It was refused, with one sentence and nothing else."""
    assert ended.status == 2, ended
    # Beside it stand only lines of what a long run is doing.
    said = [line for line in ended.error.splitlines() if not PROGRESS.match(line)]
    assert len(said) == 1, ended.error
    assert said[0].startswith("stiction: "), ended.error
    assert "Traceback" not in ended.error


def assert_whole(folder: Path) -> None:
    """No file of a folder is a stump, and nothing is left of what was being written."""
    for name, content in contents(folder).items():
        assert content, f"{name} is empty"
        assert is_whole(name, content), f"{name} is a stump of {len(content)} bytes"


def is_whole(name: str, content: bytes) -> bool:
    """Whether a file has its end."""
    ending = name.rpartition(".")[2]
    if ending == "json":
        return _reads(lambda: json.loads(content))
    if ending == "toml":
        return _reads(lambda: tomllib.loads(content.decode()))
    if ending == "csv":
        rows = content.split(b"\n")
        return rows[-1] == b"" and len({row.count(b",") for row in rows[:-1]}) == 1
    ends = {"html": b"</html>", "svg": b"</svg>", "png": b"IEND\xaeB`\x82", "md": b"\n"}
    if ending in ends:
        return content.rstrip(b"\n").endswith(ends[ending].rstrip(b"\n"))
    return ending == "txt"


def _reads(read: Callable[[], object]) -> bool:
    try:
        read()
    except (ValueError, UnicodeDecodeError):
        return False
    return True
