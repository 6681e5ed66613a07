"""What every verb that takes a session does with it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from .. import session as sessions
from .._support.file_kinds import kind_of, kind_of_table
from ..errors import InputError
from ..plant import Plant
from ..plant.plant_file import read_toml
from ..recording.names import names_of
from ..session import Session

__all__ = [
    "load_session",
    "name_file_in_errors",
    "refuse_other_than_session",
    "refuse_overwrite",
    "repairs_of",
]


def load_session(path: Path, *, keep_faulty: bool = False) -> tuple[Session, Plant]:
    """A session file and the plant that it names.

    Raises
    ------
    InputError
        As for ``stiction.load``; a session without a plant, or another file in place of one.
    """
    refuse_other_than_session(path)
    session = sessions.load(path, keep_faulty=keep_faulty)
    if session.plant is None:
        raise InputError(f'{path}: plant is missing; write plant = "plant.toml"')
    return session, session.plant


def refuse_other_than_session(path: Path) -> None:
    """Refuses a file that is taken for a session by mistake.

    Raises
    ------
    InputError
        It is a recording, a plant or a robot's file.
    """
    if kind := _kind_of(path):
        raise InputError(
            f"{path}: is a {kind}, and a session file is wanted, which names plant and "
            "recordings; stiction init writes one"
        )


def _kind_of(path: Path) -> str:
    """What a file is that is taken for a session by mistake, "" where it may be one."""
    if kind := kind_of(path):
        return kind
    try:
        kind = kind_of_table(read_toml(path))
    except InputError:
        # What is wrong with it is told where it is read.
        return ""
    return "" if kind == "session file" else kind


@contextmanager
def name_file_in_errors(path: Path, session: Session, plant: Plant) -> Iterator[None]:
    """Lets refusals name a file: the session's where they speak of all recordings together."""
    try:
        # Absurd numbers are refused in words, not by warnings.
        with np.errstate(all="ignore"):
            yield
    except InputError as error:
        told = str(error).removeprefix("session: ")
        named = [*(str(recording.path) for recording in session), plant.source]
        known = any(name in told for name in named)
        raise InputError(told if known else f"{path}: {told}") from None


def refuse_overwrite(plant: Plant, where: Path) -> None:
    """Refuse to write a plant.toml over the one that was read: what its user wrote would be gone.

    Raises
    ------
    InputError
        The folder ``where`` is the one in which the plant file is.
    """
    file = where / "plant.toml"
    try:
        same = file.samefile(plant.source)
    except OSError:  # one of them is not there
        return
    if same:
        raise InputError(
            f"{file}: is the plant file of this session and is not overwritten; give another "
            "folder with --out"
        )


def repairs_of(session: Session) -> list[str]:
    """What was left out or repaired on reading, a sentence each."""
    return [
        *(f"left out: {fault}" for fault in session.left_out),
        *_repaired(session),
    ]


def _repaired(session: Session) -> list[str]:
    return [
        f"{name}: {repair}"
        for name, recording in zip(names_of(list(session)), session, strict=True)
        for repair in recording.quality
    ]
