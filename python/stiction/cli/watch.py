"""``stiction watch``: an answer that goes on while recordings come in."""

from __future__ import annotations

import json as reader
import os
import sys
import time
from pathlib import Path
from typing import Annotated, Any, Final

from cyclopts import Parameter

from ..diagnosis import SURROGATES
from ..errors import InputError
from .diagnose import diagnose
from .given import Quiet, Whole

__all__ = ["watch"]

LEAST_S: Final = 0.05
"""Seconds between two looks; less would keep a processor busy."""

_Seen = dict[Path, tuple[int, int]]


def watch(
    directory: Path,
    *,
    once: Annotated[bool, Parameter(negative="")] = False,
    every: float = 2.0,
    columns: Annotated[str, Parameter(name=["--columns", "-c"])] = "",
    gain: float | None = None,
    law: str = "",
    joint: str = "",
    header: str = "",
    surrogates: Whole = SURROGATES,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    json: Annotated[bool, Parameter(negative="")] = False,
    quiet: Quiet = False,
) -> None:
    """Diagnose the recordings of a folder, and go on when one is added or changed.

    A recording that is added is held against the diagnosis that is there, as by stiction diagnose
    --add; one that is changed or taken away starts a whole diagnosis. Ctrl-C ends it.

    Parameters
    ----------
    directory
        Folder of recordings with the same columns.
    once
        Look once and end.
    every
        Seconds between two looks; a file counts when it has not changed from one to the next.
    columns
        Columns that are something else than guessed: "input=vir [V], position=qm [mm]".
    gain
        Effort per SI unit of the input.
    law
        Friction law of the plant, coulomb without it.
    joint
        Of recordings of several joints the one that is wanted.
    header
        Names for the columns of files that have none, as for stiction init.
    surrogates
        Replays of the fitted plant with noise alone, which thresholds come from.
    out
        Folder for the results, ./<folder>-diagnosis/ without it.
    json
        Print JSON.
    """
    if not os.path.isdir(directory):
        raise InputError(f"{directory}: is no folder; give one that recordings come into")
    if not LEAST_S <= every < float("inf"):
        raise InputError(f"--every = {every} is out of bounds: give seconds from {LEAST_S}")
    where = Path(f"{directory.resolve().name}-diagnosis") if out is None else out
    if where.resolve() == directory.resolve():
        raise InputError(
            f"{where}: is the folder that is watched, and results in it would be taken for "
            "recordings; give another folder with --out"
        )
    stated: dict[str, Any] = {
        "columns": columns, "gain": gain, "law": law, "joint": joint, "header": header
    }  # fmt: skip
    whole = {**stated, "surrogates": surrogates, "quiet": quiet}
    if once:
        _look(directory, where, whole, as_json=json)
        return
    _watch(directory, where, whole, every, as_json=json)


def _watch(
    directory: Path, where: Path, whole: dict[str, Any], every: float, *, as_json: bool
) -> None:
    answered: _Seen | None = None
    before: _Seen | None = None
    while True:
        seen = _seen(directory)
        if seen and seen == before and seen != answered:
            answered = seen
            try:
                _look(directory, where, whole, as_json=as_json)
            except InputError as error:
                # The next recording may mend it.
                print(f"stiction: {error}", file=sys.stderr, flush=True)
        before = seen
        try:
            time.sleep(every)
        except KeyboardInterrupt:
            # Nothing is at work: this is how it is ended.
            return


def _seen(directory: Path) -> _Seen:
    """Size and time of every recording of a folder; none where there is none."""
    from ..drafting import recordings_in

    found: _Seen = {}
    try:
        for file in recordings_in(directory):
            state = file.stat()
            found[file.resolve()] = (state.st_size, state.st_mtime_ns)
    except (InputError, OSError):
        # Nothing is there yet, or a file went while it was looked at.
        return {}
    return found


def _look(directory: Path, where: Path, whole: dict[str, Any], *, as_json: bool) -> None:
    """Answer what is in the folder now: by what was added, where that is all that is new."""
    from ..drafting import FILES, recordings_in
    from .drafts import FOLDER

    known = _known(where)
    files = {file.resolve(): file for file in recordings_in(directory)}
    if known is None or not known <= files.keys():
        diagnose(directory, **whole, out=where, json=as_json)
        return
    new = tuple(files[file] for file in sorted(files.keys() - known))
    if new:
        diagnose(where / FOLDER / FILES[1], add=new, out=where, json=as_json, quiet=whole["quiet"])


def _known(where: Path) -> set[Path] | None:
    """Recordings that a diagnosis in a folder holds; None where it is to be made again."""
    from .. import session as sessions
    from ..drafting import FILES
    from .drafts import FOLDER

    try:
        session = sessions.load(where / FOLDER / FILES[1], keep_faulty=True)
        content = reader.loads((where / "findings.json").read_text(encoding="utf-8"))
        if content["extended"] is None or content["data"]["hashes"] != list(session.hashes):
            return None
        paths = [each.path for each in session] + [each["recording"] for each in _added(content)]
        return {Path(str(path)).resolve() for path in paths}
    except (InputError, OSError, ValueError, KeyError, TypeError, AttributeError):
        return None


def _added(content: dict[str, Any]) -> list[dict[str, Any]]:
    return list(content.get("added", ()))
