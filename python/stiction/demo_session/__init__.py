"""A session that ships with the package: recordings of a simulated motor with one hidden effect.

>>> from stiction import demo_session
>>> len(demo_session.load())
18

`tests/reference/make_demo_session.py` of the repository makes its files.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np

from .. import session as sessions
from .._support.atomic_files import create_text, subfolder
from .._support.given import path as file_path
from .._support.given import vacant
from ..errors import InputError
from ..session import Session

__all__ = ["copy", "hidden", "load"]

_FOLDER: Final = Path(__file__).parent
_TEXTS: Final = ("session.toml", "plant.toml", "README.txt", "what-is-hidden.txt")


def load() -> Session:
    """The session with its plant, as ``stiction.load`` reads it."""
    return sessions.load(_FOLDER / "session.toml")


def hidden() -> str:
    """What is hidden in it, in one line."""
    with (_FOLDER / "what-is-hidden.txt").open(encoding="utf-8") as text:
        return text.readline().rstrip()


def copy(folder: str | Path) -> list[Path]:
    """Lay the session out as files that can be edited; recordings as CSV, cell for cell.

    Parameters
    ----------
    folder : str or Path
        Made where it is not there.

    Returns
    -------
    list of Path
        The files, session.toml first.

    Raises
    ------
    InputError
        No path; one of the files is there already, or they cannot be written; nothing is
        overwritten.
    """
    folder = file_path(folder, "demo_session.copy")
    # Ship small, hand out readable: text takes three times the space.
    texts = {name: (_FOLDER / name).read_text(encoding="utf-8") for name in _TEXTS}
    texts["session.toml"] = texts["session.toml"].replace('.npz"', '.csv"')
    for path in sorted((_FOLDER / "recordings").glob("*.npz")):
        texts[f"recordings/{path.stem}.csv"] = _as_csv(path)
    vacant(folder, texts)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        subfolder(folder, "recordings")
        for name, text in texts.items():
            create_text(folder / name, text)
    except OSError as error:
        raise InputError(
            f"{folder}: cannot be written to ({error.strerror}); give another folder"
        ) from None
    return [folder / name for name in texts]


def _as_csv(path: Path) -> str:
    """A recording as text; repr keeps every bit, and counts stay whole numbers."""
    with np.load(path) as stored:
        columns = {name: stored[name].tolist() for name in stored.files}
    rows = zip(*(map(repr, column) for column in columns.values()), strict=True)
    return "\n".join([",".join(columns), *map(",".join, rows), ""])
