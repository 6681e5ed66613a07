"""Sessions that are drafted from recordings on the way to an answer, and kept beside it."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final
from zlib import crc32

from .._support.atomic_files import write_text
from .._support.wording import commas
from ..drafting import FILES, assumptions, draft
from ..errors import InputError
from ..plant import Plant
from ..recording.formats import FORMATS
from ..session import Session
from .answer import folder, protect_writes
from .columns import read_columns
from .sessions import load_session

__all__ = ["FOLDER", "Opened", "Stated", "open_session"]

FOLDER: Final = "draft"
"""In the folder for the results: plant.toml there is what was assumed, not what was found."""
_SUM: Final = "# Drafted again from the recordings as long as this fits: "
_SUM_LINE: Final = re.compile(rf"\n{_SUM}([0-9a-f]{{8}})\n\Z")
_VERBS: Final = {"diagnosis": "diagnose", "fit": "fit"}
"""What a folder for results ends in, and the verb that writes it."""
_EXAMPLE: Final = {"time": "NAME [s]", "input": "NAME [A]", "position": "NAME [rad]"}
_OPTIONS: Final = ("columns", "gain", "law", "joint", "header")


@dataclass(frozen=True)
class Stated:
    """What is stated of recordings on the command line; what is empty is not."""

    columns: str = ""
    gain: float | None = None
    law: str = ""
    joint: str = ""
    header: str = ""

    @property
    def options(self) -> list[str]:
        """Those that are given."""
        given = {name: getattr(self, name) for name in _OPTIONS}
        return [f"--{name}" for name, value in given.items() if value not in ("", None)]


@dataclass(frozen=True)
class Opened:
    """What a verb works on.

    Attributes
    ----------
    path : Path
        Of the session file.
    session, plant
        As they were read.
    where : Path
        Folder for the results.
    assumed : tuple of str
        Lines; none where the session was stated.
    drafted : tuple of Path
        Files that were written.
    """

    path: Path
    session: Session
    plant: Plant
    where: Path
    assumed: tuple[str, ...] = ()
    drafted: tuple[Path, ...] = field(default=())


def open_session(
    paths: Sequence[Path],
    out: Path | None,
    verb: str,
    stated: Stated,
    *,
    keep_faulty: bool = False,
) -> Opened:
    """A session file, or the session that is drafted of recordings.

    Parameters
    ----------
    paths : sequence of Path
        A session file, or recordings and folders of them.
    out : Path, optional
        Folder for the results.
    verb : str
        What the folder for the results ends in without ``out``.
    stated : Stated
    keep_faulty : bool
        As for ``stiction.load``.

    Raises
    ------
    InputError
        As for ``load_session`` and ``draft``; options of a draft beside a session file; recordings
        that do not tell what is needed; a draft that somebody has changed.
    """
    first = paths[0]
    if not all(map(is_data, paths)):
        return _of_session(paths, out, verb, stated, keep_faulty)
    resolved = [path.resolve() for path in paths]
    for place, path in enumerate(paths):
        if resolved[place] in resolved[:place]:
            raise InputError(f"{path}: is given twice; drop one")
    name = first.resolve().name if os.path.isdir(first) else first.stem
    where = Path(f"{name}-{verb}") if out is None else out
    made = draft(
        paths,
        joint=stated.joint,
        header=stated.header,
        columns=read_columns(stated.columns) if stated.columns else None,
        where="--columns",
        law=stated.law or "coulomb",
        gain=stated.gain,
    )
    if todo := made.to_do:
        wanted = ", ".join(f"{role}={_EXAMPLE[role]}" for role in made.found.missing)
        state = f'state it here, as in --columns "{wanted}", or ' if wanted else ""
        raise InputError(f"{first}: {todo[0]}; {state}finish the drafts of stiction init")
    inside = folder(folder(where) / FOLDER)
    files = tuple(inside / name for name in FILES)
    with protect_writes(inside):
        for file, text in zip(files, made.texts(inside), strict=True):
            _keep_what_was_changed(file)
            write_text(file, _summed(text))
    session, plant = load_session(files[1], keep_faulty=keep_faulty)
    return Opened(files[1], session, plant, where, assumptions(made, session, plant), files)


def is_data(path: Path) -> bool:
    """Whether a path is a recording by its ending, or a folder."""
    endings = [suffix for known in FORMATS for suffix in known.suffixes]
    ending = path.suffix.casefold()
    return ending in endings or (os.path.isdir(path) and ending != ".toml")


def _of_session(
    paths: Sequence[Path], out: Path | None, verb: str, stated: Stated, keep_faulty: bool
) -> Opened:
    path = paths[0]
    if len(paths) > 1:
        other = next(each for each in reversed(paths) if not is_data(each))
        raise InputError(
            f"{other}: is no recording by its ending, and of several files each has to be one; "
            f"give recordings, or one session file (see: stiction {_VERBS[verb]} --help)"
        )
    if stated.options:
        raise InputError(
            f"{path}: {commas(stated.options)} is for recordings, and a session file states it "
            "itself; leave it out and write it there"
        )
    try:
        session, plant = load_session(path, keep_faulty=keep_faulty)
    except InputError:
        if path.suffix.casefold() == ".toml" or not os.path.isfile(path):
            raise
        endings = commas(suffix for known in FORMATS for suffix in known.suffixes)
        raise InputError(
            f"{path}: is no session file, and no recording by its ending (known are {endings}); "
            "save a spreadsheet or a log as CSV"
        ) from None
    return Opened(path, session, plant, Path(f"{path.stem}-{verb}") if out is None else out)


def _summed(text: str) -> str:
    return f"{text}\n{_SUM}{crc32(text.encode()):08x}\n"


def _keep_what_was_changed(file: Path) -> None:
    """Refuse to draft over a file that is no draft any more."""
    try:
        text = file.read_text(encoding="utf-8")
    except FileNotFoundError:
        return
    except UnicodeDecodeError:
        text = ""
    found = _SUM_LINE.search(text)
    if found is None or f"{crc32(text[: found.start()].encode()):08x}" != found[1]:
        raise InputError(
            f"{file}: was changed since it was drafted and is not overwritten; go on from it with "
            f"stiction diagnose {file.parent / FILES[1]}, or give another folder with --out"
        )
