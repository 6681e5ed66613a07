"""Loading any file of the package: what it is, it says itself."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from . import session
from ._support import given
from ._support.file_kinds import kind_of, kind_of_table
from ._support.keywords import explain_keywords
from .errors import InputError
from .plant import Plant
from .plant.plant_file import read_toml

__all__ = ["load"]


@explain_keywords
def load(
    path: str | Path,
    *,
    plant: Plant | None = None,
    keep_faulty: bool = False,
    columns: Mapping[str, Any] | None = None,
) -> Any:
    """Read a session file, a plant file or a recording.

    Parameters
    ----------
    path : str or Path
        ``session.toml``; the paths in it are relative to it. Or ``plant.toml``; or a recording in
        any of the formats that are read, of which columns and units are guessed as ``stiction
        init`` does it.
    plant : Plant, optional
        Of a session: takes the place of the plant that the file names.
    keep_faulty : bool
        Of a session: load recordings with too many missing cells too; they say so in their
        ``faults``.
    columns : mapping, optional
        Of a recording: what is stated of its columns, as under ``[columns]``.

    Returns
    -------
    Session, Plant or Recording
        As the file is one of them.

    Raises
    ------
    InputError
        Missing or unparsable file, findings of a diagnosis, a recording whose columns tell too
        little, and all that ``Plant.load`` and ``Recording.load`` refuse; of a session: unknown
        keys, no recordings, one file twice, a replicate of a file that is not listed, recordings
        that overlap on the session clock.
    """
    path = given.path(path, "load")
    if path.name == "findings.json":
        raise InputError(
            f"{path}: holds what a diagnosis found; read it as JSON, or load plant.toml beside "
            "it, the plant with what was found"
        )
    if kind_of(path):
        return _recording(path, columns)
    if columns is not None:
        raise InputError(f"{path}: columns are for a recording; a session file states its own")
    if plant is None and _is_plant(path):
        return Plant.load(path)
    return session.load(path, plant=plant, keep_faulty=keep_faulty)


def _is_plant(path: Path) -> bool:
    try:
        return kind_of_table(read_toml(path)) == "plant file"
    except InputError:
        # What is wrong with it is told where it is read.
        return False


def _recording(path: Path, columns: Mapping[str, Any] | None) -> Any:
    from .drafting import draft
    from .recording import Columns, Recording

    made = draft([path], columns=columns)
    if todo := made.to_do:
        raise InputError(f"{path}: {todo[0]}; state it here, as in columns={{'input': '…'}}")
    found = made.found
    return Recording.load(
        path,
        Columns(found.mapping),
        motion=found.motion,
        drive=found.drive,
        count_size=None if not found.counts_per_rev else 6.283185307179586 / found.counts_per_rev,
    )
