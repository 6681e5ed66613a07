"""Sessions: recordings of one machine, as a session file lists them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .errors import InputError
from .parameter import number
from .plant import Plant
from .plant_file import choice, known, read_toml, section
from .recording import Columns, Recording
from .recording.units import Motion

__all__ = ["Session", "load", "load_recording"]

_TABLES = ("plant", "columns", "recordings")
_RECORDING = ("file", "role", "kind", "start_s", "replicate_of", "columns")
_ROLES = ("train", "select", "test")


@dataclass(frozen=True)
class Session:
    """Recordings of one machine.

    Attributes
    ----------
    recordings : tuple of Recording
    plant : Plant or None
    """

    recordings: tuple[Recording, ...]
    plant: Plant | None = None

    def __iter__(self) -> Iterator[Recording]:
        return iter(self.recordings)

    def __len__(self) -> int:
        return len(self.recordings)

    def __repr__(self) -> str:
        return f"Session({len(self.recordings)} recordings, plant {self.plant!r})"


def load(path: str | Path, *, plant: Plant | None = None) -> Session:
    """Read a session file, its plant and its recordings.

    Parameters
    ----------
    path : str or Path
        ``session.toml``; the paths in it are relative to it.
    plant : Plant, optional
        Takes the place of the plant that the file names.

    Raises
    ------
    InputError
        Missing or unparsable file, unknown keys, no recordings, one file twice, and all that
        ``Plant.load`` and ``Recording.load`` refuse.
    """
    path = Path(path)
    table = read_toml(path)
    source = str(path)
    known(table, _TABLES, source)
    if plant is None and "plant" in table:
        named = table["plant"]
        if not isinstance(named, str):
            raise InputError(f'{source}: plant = {named!r} is not a path; write plant = "…"')
        plant = Plant.load(path.parent / named)
    columns = section(table, "columns", source)
    entries = table.get("recordings", [])
    if not isinstance(entries, list) or not all(isinstance(e, dict) for e in entries):
        raise InputError(f"{source}: recordings is not a list of tables; write [[recordings]]")
    if not entries:
        raise InputError(f"{source}: there are no [[recordings]]; list at least one file")
    seen: dict[Path, int] = {}
    recordings = []
    for index, entry in enumerate(entries, 1):
        where = f"{source}: [[recordings]] {index}"
        known(entry, _RECORDING, where)
        if not isinstance(entry.get("file"), str):
            raise InputError(f'{where}: file is missing; write file = "…"')
        file = (path.parent / entry["file"]).resolve()
        if file in seen:
            raise InputError(
                f"{where}: {entry['file']} is already recording {seen[file]}; "
                "a file has one role, drop one of the two"
            )
        seen[file] = index
        role = choice(entry["role"], _ROLES, f"{where} role") if "role" in entry else None
        kind = entry.get("kind", "")
        if not isinstance(kind, str):
            raise InputError(f"{where} kind = {kind!r} is not a word")
        start = number(entry.get("start_s", 0.0), f"{where} start_s")
        own = {**columns, **section(entry, "columns", where)}
        recordings.append(
            load_recording(file, plant, own, role=role, kind=kind, start_s=start, where=source)
        )
    return Session(tuple(recordings), plant)


def load_recording(
    file: str | Path,
    plant: Plant | None,
    columns: dict[str, Any] | None = None,
    *,
    where: str = "columns",
    **labels: Any,
) -> Recording:
    """Read a recording as a plant's drive and motion say.

    Raises
    ------
    InputError
        As for ``Recording.load``.
    """
    mapped = Columns.parse(columns, where=f"{where}: [columns]") if columns else None
    drive: str | None = None
    motion: Motion | None = None
    count: float | None = None
    if plant is not None:
        drive = "prescribed_motion" if plant.prescribed_motion else plant.drive.get("input")
        motion = plant.motion
        count = plant.count or None
    return Recording.load(file, mapped, motion=motion, drive=drive, count_size=count, **labels)
