"""The entry of the package itself: every session of a bench, diagnosed."""

from __future__ import annotations

import logging
from pathlib import Path

from .. import session as sessions
from .._support import given
from .._support.atomic_files import write_text
from .._support.progress import phase, steps
from ..diagnosis import diagnose
from ..errors import InputError
from .read import manifest_of

__all__ = ["run"]

_log = logging.getLogger(__name__)


def run(folder: Path | str, answers: Path | str, *, threads: int | None = None) -> dict[str, str]:
    """Diagnose every session that has no answer yet, as ``stiction diagnose`` does.

    Parameters
    ----------
    folder : path
        Of the bench.
    answers : path
        Folder for ``session_0001.json`` and so on, made where it is not there. Sessions whose
        answer is in it are passed over, so that a run goes on where it was interrupted.
    threads : int, optional
        As for ``diagnose``.

    Returns
    -------
    dict of str to str
        Verdict of each session that was diagnosed now, or the sentence that it was refused with.

    Raises
    ------
    InputError
        The folder is no bench.
    OSError
        An answer cannot be written.
    KeyboardInterrupt
        What was interrupted is no answer; those before it are written.
    """
    where, told = given.path(folder, "bench: folder"), given.path(answers, "bench: answers")
    names = list(manifest_of(where)["sessions_sha256"])
    told.mkdir(parents=True, exist_ok=True)
    left = [name for name in names if not (told / f"{name}.json").is_file()]
    said = {}
    for name in steps(left, "session"):
        phase(_log, "diagnosing %s", name)
        try:
            session = sessions.load(where / name / "session.toml", keep_faulty=True)
            found = diagnose(None, session, threads=threads)
        except InputError as error:
            said[name] = str(error)
            continue
        if not found.success:
            raise KeyboardInterrupt
        write_text(told / f"{name}.json", found.to_json() + "\n")
        said[name] = found.verdict
    return said
