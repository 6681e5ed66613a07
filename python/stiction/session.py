"""Sessions: recordings of one machine, as a session file lists them."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from ._support import given
from ._support.arrays import FloatArray
from ._support.file_kinds import kind_of_table
from ._support.frozen import Frozen, freeze
from ._support.keys import check_keys
from ._support.keywords import explain_constructor
from ._support.progress import phase, steps
from ._support.readers import FromFile
from ._support.units import Motion
from ._support.wording import commas, did_you_mean, plural
from .errors import InputError
from .plant import Plant
from .plant.plant_file import read_toml, section
from .recording import Columns, Recording
from .recording.names import names_of
from .recording.recording import recordings_of
from .recording.session_clock import ages_of, starts_of
from .recording.split import BLOCK_S, EDGE_S, Split, split
from .session_entries import Entry, all_faults, beside, entries_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Session", "both_of", "load", "load_beside", "load_recording"]

MOST_WITHIN: Final = 8
"""Recordings whose names stand within a figure of the session."""

_TABLES = ("plant", "columns", "recordings")


@explain_constructor
@dataclass(frozen=True)
class Session(metaclass=FromFile):
    """Recordings of one machine.

    Parameters
    ----------
    recordings : sequence of Recording
    plant : Plant, optional
    replicates : mapping of int to int, optional
        Index of a recording to the index of the one whose motion it repeats.
    left_out : sequence of str, optional
        Files that were found and could not be read, a sentence each.

    Attributes
    ----------
    recordings : tuple of Recording
    plant : Plant or None
    replicates : mapping of int to int
        Index of a recording to the index of the one whose motion it repeats.
    starts : tuple of float
        When each recording starts on the session clock, s: its ``start_s``, or, where none is
        stated, the end of the one before it.
    ages : tuple of float
        How long the machine has been on by then, s: the same, but that it begins at 0 with each
        recording that is ``cold``, and with the first one where the clock began long before the
        session, as one that counts from 1970.

    Raises
    ------
    InputError
        Something else than recordings or a plant, recordings that overlap on the session clock, or
        a replicate of nothing or of itself.
    """

    recordings: Sequence[Recording]
    plant: Plant | None = None
    replicates: Mapping[int, int] = field(default_factory=dict)
    left_out: Sequence[str] = ()
    starts: tuple[float, ...] = field(init=False)
    ages: tuple[float, ...] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "recordings", recordings_of(self.recordings, "session"))
        if self.plant is not None:
            given.instance(self.plant, Plant, "session: plant", "a Plant, as Plant.load returns it")
        given.mapping(self.replicates, "session: replicates", "indices, as in { 1: 0 }")
        freeze(self, Frozen, "replicates")
        for index, of in self.replicates.items():
            if index == of or not {index, of} <= set(range(len(self.recordings))):
                raise InputError(
                    f"session: replicates says that recording {index} repeats recording {of}; "
                    f"give two different indices from 0 to {len(self.recordings) - 1}"
                )
        told = given.each_of(self.left_out, "session: left_out", "sentences")
        sentences = tuple(given.word(each, "session: left_out: a sentence") for each in told)
        object.__setattr__(self, "left_out", sentences)
        object.__setattr__(self, "starts", starts_of(self.recordings))
        object.__setattr__(self, "ages", ages_of(self.recordings))

    @property
    def hashes(self) -> tuple[str, ...]:
        """SHA-256 of each recording's channels, in hexadecimal."""
        return tuple(recording.hash for recording in self.recordings)

    def clock(self, index: int) -> FloatArray:
        """Time of every row of a recording on the session clock.

        Parameters
        ----------
        index : int
            Of the recording; from the end where it is negative.

        Returns
        -------
        ndarray, shape (rows,)
            s.

        Raises
        ------
        IndexError
            There is no such recording.
        InputError
            No whole number.
        """
        most = given.MOST_WHOLE
        index = given.whole(index, "Session.clock: index", least=-most, most=most)
        time = self.recordings[index].time
        clock: FloatArray = time - time[0] + self.starts[index]
        return clock

    def split(self, *, block_s: float = BLOCK_S, edge_s: float = EDGE_S) -> Split:
        """Which rows train, select and test; see ``stiction.recording.split.split``.

        Parameters
        ----------
        block_s, edge_s : float
            Length of interleaved blocks, and what they lose at an edge, s.

        Raises
        ------
        InputError
            As there.
        """
        return split(self.recordings, block_s=block_s, edge_s=edge_s)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Position over time of each recording, on the session clock.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            To draw into, one of a new figure without it.

        Returns
        -------
        matplotlib Axes

        Raises
        ------
        InputError
            ``ax`` is something else than axes.
        """
        from . import plot

        panel = plot.panel_for(ax)
        for index, (name, each) in enumerate(
            zip(names_of(self.recordings), self.recordings, strict=True)
        ):
            if each.position is not None:
                line = plot.thinned(self.clock(index), each.position)
                panel.plot(*line, label=name, linewidth=1.0)
        panel.set_xlabel("session clock (s)")
        panel.set_ylabel(f"position ({self._position_unit})")
        lines = len(panel.get_legend_handles_labels()[0])
        if lines > MOST_WITHIN:  # beside the panel, where they cover nothing
            plot.legend(
                panel, loc="upper left", bbox_to_anchor=(1.0, 1.05), fontsize=plot.SMALL - 2
            )
        elif lines:
            plot.legend(panel)
        return panel

    @property
    def _position_unit(self) -> str:
        units = {each.units.get("position", "") for each in self.recordings} - {""}
        if self.plant is not None:
            units = {self.plant.position_unit}
        return units.pop() if len(units) == 1 else "rad or m"

    def __iter__(self) -> Iterator[Recording]:
        return iter(self.recordings)

    def __len__(self) -> int:
        return len(self.recordings)

    def __repr__(self) -> str:
        return f"Session({plural(len(self.recordings), 'recording')}, plant {self.plant!r})"

    def _repr_html_(self) -> str:
        from .notebook import drawing, table

        names = names_of(self.recordings)
        moved = [
            (name, each.time, each.position)
            for name, each in zip(names[:_DRAWN], self.recordings, strict=False)
            if each.position is not None
        ]
        return (
            f"<p><b>{escape(repr(self))}</b></p>"
            f"{table(_HEAD, [self._row(index) for index in range(len(self.recordings))])}"
            f"{drawing(moved, 'time (s)', f'position ({self._position_unit})')}"
        )

    def _row(self, index: int) -> tuple[str, ...]:
        recording = self.recordings[index]
        of, names = self.replicates.get(index), names_of(self.recordings)
        return (
            names[index],
            recording.role or "",
            recording.kind,
            f"{self.starts[index]:.6g}{', cold' if recording.cold else ''}",
            f"{recording.duration:.6g}",
            str(len(recording)),
            "" if of is None else names[of],
        )


_logger = logging.getLogger(__name__)

_DRAWN = 4
"""Recordings whose motion a notebook shows."""
_HEAD = ("recording", "role", "kind", "starts at s", "lasts s", "rows", "replicate of")


def load(path: str | Path, *, plant: Plant | None = None, keep_faulty: bool = False) -> Session:
    """Read a session file, its plant and its recordings.

    Parameters
    ----------
    path : str or Path
        ``session.toml``; the paths in it are relative to it.
    plant : Plant, optional
        Takes the place of the plant that the file names.
    keep_faulty : bool
        Load recordings with too many missing cells too; they say so in their ``faults``.

    Returns
    -------
    Session

    Raises
    ------
    InputError
        Missing or unparsable file, unknown keys, no recordings, one file twice, a replicate of a
        file that is not listed, recordings that overlap on the session clock, and all that
        ``Plant.load`` and ``Recording.load`` refuse.
    """
    path = given.path(path, "load")
    if plant is not None:
        given.instance(plant, Plant, "load: plant", "a Plant, as Plant.load returns it")
    table = read_toml(path, least='plant = "…" and one [[recordings]]')
    source = str(path)
    if (kind := kind_of_table(table)) in ("plant file", "robot file"):
        raise InputError(f"{source}: is a {kind}, and a recording or a session file is wanted here")
    check_keys(table, _TABLES, source)
    if plant is None and "plant" in table:
        named = table["plant"]
        if not isinstance(named, str) or not named:
            raise InputError(
                f'{source}: plant = {named!r} is not a path; write plant = "plant.toml"'
            )
        itself = beside(path, named, f"{source}: plant") == path.resolve()
        if itself or os.path.isdir(path.parent / named):
            what = "this file itself" if itself else "a folder"
            raise InputError(f"{source}: plant = {named!r} is {what}; name the plant's own file")
        plant = Plant.load(path.parent / named)
    columns = section(table, "columns", source)
    entries = table.get("recordings", [])
    if not isinstance(entries, list) or not all(isinstance(e, dict) for e in entries):
        raise InputError(f"{source}: recordings is not a list of tables; write [[recordings]]")
    if not entries:
        raise InputError(f"{source}: there are no [[recordings]]; list at least one file")
    listed_ = entries_of(path, entries)
    recordings: dict[int, Recording] = {}
    faults: list[str] = []
    left_out: list[str] = []
    phase(_logger, "reading the recordings")
    for index, entry in enumerate(steps(listed_, "recording")):
        try:
            recordings[index] = load_recording(
                entry.files if len(entry.files) > 1 else entry.files[0],
                plant,
                {**columns, **entry.columns},
                keep_faulty=keep_faulty,
                where=source,
                **entry.labels,
            )
        except InputError as error:
            # What a pattern finds need not be a recording; what is named has to be.
            (left_out if entry.found else faults).append(str(error))
    if faults or not recordings:
        raise InputError(all_faults(source, faults or left_out))
    kept = {index: place for place, index in enumerate(recordings)}
    replicates = {
        kept[index]: kept[of]
        for index, of in _replicates(path, listed_).items()
        if index in kept and of in kept
    }
    try:
        return Session(tuple(recordings.values()), plant, replicates, tuple(left_out))
    except InputError as error:
        raise InputError(f"{source}: {str(error).removeprefix('session: ')}") from None


def load_beside(path: str | Path, files: Sequence[Path], plant: Plant) -> list[Recording]:
    """Read recordings that a session file does not list, in the columns that it states.

    Parameters
    ----------
    path : str or Path
        ``session.toml``.
    files : sequence of Path
        Relative to where the program runs.
    plant : Plant
        That the session names.

    Raises
    ------
    InputError
        As for ``Recording.load``.
    """
    source = str(path)
    columns = section(read_toml(Path(path)), "columns", source)
    return [load_recording(file, plant, dict(columns), where=source) for file in files]


def both_of(plant: Any, session: Any, where: str) -> tuple[Any, Any]:
    """A plant and recordings; of a session alone, given in either place, its own plant.

    Raises
    ------
    InputError
        A session without a plant, or a plant without recordings.
    """
    if session is None and isinstance(plant, Session):
        plant, session = None, plant
    if session is None and isinstance(plant, str | Path):
        raise InputError(
            f"{where}: '{plant}' is the name of a file; give what stiction.load('{plant}') returns"
        )
    if session is None:
        raise InputError(
            f"{where}: there are no recordings; give a session, or a plant and recordings"
        )
    if plant is None:
        plant = session.plant if isinstance(session, Session) else None
        if plant is None:
            raise InputError('session: plant is missing; write plant = "plant.toml", or give one')
    return plant, session


def _replicates(path: Path, entries: Sequence[Entry]) -> dict[int, int]:
    """Index to index, from what ``replicate_of`` names."""
    places = {entry.files[0]: index for index, entry in reversed([*enumerate(entries)])}
    replicates = {}
    for index, entry in enumerate(entries):
        named = entry.replicate_of
        if named is None:
            continue
        where = f"{path}: [[recordings]] {entry.place} replicate_of = {named!r}"
        if not isinstance(named, str):
            raise InputError(f'{where} is not a path; write replicate_of = "…"')
        file = beside(path, named, f"{path}: [[recordings]] {entry.place} replicate_of")
        of = places.get(file)
        if of is None:
            files = [other.named for other in entries if other is not entry]
            raise InputError(
                f"{where} is none of the recordings{did_you_mean(named, files)}; name the file of "
                f"another one: {commas(files)}"
            )
        if of == index or file == entry.files[0]:
            raise InputError(f"{where} is the recording itself; name another, or leave it out")
        replicates[index] = of
    return replicates


def load_recording(
    file: str | Path | Sequence[Path],
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
