"""What recordings are called in sentences, tables and figures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import PurePath
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .recording import Recording

__all__ = ["names_of", "places_in_session"]


def names_of(recordings: Sequence[Recording]) -> list[str]:
    """A name for each recording that no other one has.

    The file, with as many of its folders as tell it from others; the number, counted from 1, of a
    recording without a file, and behind the name of one of which even the folders are alike. What
    was taken out of a session keeps the name that it has there.

    Parameters
    ----------
    recordings : sequence of Recording

    Returns
    -------
    list of str
    """
    paths = [recording.path for recording in recordings]
    depth = [1] * len(paths)
    names = [_named(path, 1, index) for index, path in enumerate(paths)]
    for index, recording in enumerate(recordings):
        if recording.entry is not None:
            paths[index], names[index] = None, recording.entry[1]
    while alike := _alike(names):
        grown = False
        for index in alike:
            path = paths[index]
            if path is not None and depth[index] < len(path.parts):
                depth[index] += 1
                names[index] = _named(path, depth[index], index)
                grown = True
        if not grown:
            for index in alike:
                names[index] = f"{names[index]} ({index + 1})"
            break
    return names


def places_in_session(recordings: Sequence[Recording]) -> list[int]:
    """Place of each recording, from 0, in the session that it was taken out of; else among these.

    Parameters
    ----------
    recordings : sequence of Recording
    """
    return [k if each.entry is None else each.entry[0] for k, each in enumerate(recordings)]


def _alike(names: Sequence[str]) -> list[int]:
    counts = Counter(names)
    return [index for index, name in enumerate(names) if counts[name] > 1]


def _named(path: PurePath | None, depth: int, index: int) -> str:
    if path is None:
        return f"recording {index + 1}"
    return PurePath(*path.parts[-depth:]).as_posix()
