"""A recording of a machine: channels in SI values over one clock."""

from __future__ import annotations

import hashlib
import math
import os
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from .._support.arrays import FloatArray
from .._support.frozen import Frozen
from .._support.given import brief, instance, mapping, number, numbers, real, whole
from .._support.given import path as file_path
from .._support.keywords import explain_constructor
from .._support.readers import FromFile
from .._support.units import Motion
from .._support.wording import did_you_mean
from ..errors import InputError
from .columns import ROLES, Columns
from .formats import read_table
from .mapping import read_channels
from .part import part_of
from .rendering import as_html, as_text
from .repair import FEWEST_ROWS, Place, Repair, check_lengths, mend
from .signals import read_signals
from .table import Table

SPLIT_ROLES: Final = ("train", "select", "test")
"""What a recording may be used for."""

SETTINGS: Final = (
    "proportional",
    "integral",
    "derivative",
    "supply_v",
    "payload_kg",
    "payload_m",
)
"""What may be set anew for a recording: gains and supply of a servo, what hangs on the machine."""

_MAIN: Final = ("time", "input", "position")
_HELD: Final = ("input", "load", "transmitted")
"""Channels that hold from a row to the next; others are readings at it."""
_OPTIONAL: Final = tuple(role for role in ROLES if role not in _MAIN)


@explain_constructor
@dataclass(frozen=True, init=False, eq=False, repr=False)
class Recording(metaclass=FromFile):
    """What was measured on a machine, in SI values.

    Row k is the state at ``time[k]``; the input of row k holds from there to row k + 1.

    Parameters
    ----------
    time : array_like, shape (rows,)
        Seconds, increasing; at least 200 rows.
    input : array_like, shape (rows,), or None
        A, V, N·m or N.  None where the motion is prescribed; then give ``effort``.
    position : array_like, shape (rows,), or None
        rad or m.  None for a recording of the input alone.
    role : {"train", "select", "test"}, optional
        What the recording may be used for; without it the split is made later.
    kind : str
        Free words; recordings of one kind are alike.
    start_s : float
        When the recording starts on the clock of the session, in seconds.
    cold : bool
        Whether the machine had been switched off until it was as it is in the morning: the time
        and the path that effects go by begin anew with this recording.
    **channels : array_like, shape (rows,)
        Any of ``effort`` (N·m or N, positive along positive motion), ``velocity``,
        ``reference``, ``load``, ``temperature`` (degC), ``normal_force``,
        ``friction_coefficient``, ``enabled`` (0 where the drive is off).
    settings : mapping of str to float, optional
        What was set for this recording and differs from the plant: any of ``proportional``,
        ``integral``, ``derivative``, ``supply_v`` of a servo, ``payload_kg`` and ``payload_m``.

    Attributes
    ----------
    quality : tuple of Repair
        What was mended, how often and where first.
    faults : tuple of str
        Why the recording is unusable; empty unless it was loaded with ``keep_faulty``.
    notes : tuple of str
        The repairs and all else that was decided on the way, in sentences.
    units : mapping of str to str
        SI unit of each channel, "" where nothing tells.
    motion : {"rotary", "linear"} or None
        As stated, or told by the units.
    path : Path or None
        The file.

    Raises
    ------
    InputError
        If lengths differ, rows are fewer than 200, the clock runs backward, or 5 % of a
        channel's cells or more are missing.

    Notes
    -----
    Arrays are copied and cannot be written to.
    """

    time: FloatArray
    input: FloatArray | None
    position: FloatArray | None
    role: str | None
    kind: str
    start_s: float
    cold: bool
    settings: Mapping[str, float]
    quality: tuple[Repair, ...]
    faults: tuple[str, ...]
    notes: tuple[str, ...]
    motion: Motion | None
    path: Path | None

    def __init__(
        self,
        time: npt.ArrayLike,
        input: npt.ArrayLike | None,
        position: npt.ArrayLike | None,
        *,
        role: str | None = None,
        kind: str = "",
        start_s: float = 0.0,
        cold: bool = False,
        settings: Mapping[str, float] | None = None,
        **channels: npt.ArrayLike,
    ) -> None:
        for name in channels:
            if name not in _OPTIONAL:
                raise InputError(
                    f"Recording: there is no channel '{name}'{did_you_mean(name, _OPTIONAL)}; "
                    f"the channels are {', '.join(_OPTIONAL)}"
                )
        given: dict[str, Any] = {"time": time, "input": input, "position": position, **channels}
        values = {
            name: _flat(name, array)
            for name, array in given.items()
            if array is not None or name == "time"
        }
        check_lengths("Recording", {name: len(array) for name, array in values.items()})
        self._fill(
            values,
            source="Recording",
            place=lambda row: f"index {row}",
            labels=_labels(role, kind, start_s, cold, settings),
        )

    @classmethod
    def load(
        cls,
        path: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
        columns: Mapping[str, Any] | Columns | None = None,
        *,
        begin: float | str | None = None,
        end: float | str | None = None,
        motion: Motion | None = None,
        drive: str | None = None,
        count_size: float | None = None,
        role: str | None = None,
        kind: str = "",
        start_s: float = 0.0,
        cold: bool = False,
        settings: Mapping[str, float] | None = None,
        keep_faulty: bool = False,
    ) -> Recording:
        """Read a recording from a file of any of the formats, or from several of one signal each.

        Parameters
        ----------
        path : str or path-like, or a sequence of them
            Several files were recorded at once, each with a time of its own: what is not on the
            clock of the channel time is brought to its rows.
        columns : mapping of role to column, optional
            As ``[columns]`` of session.toml: each a name, a number from 1, or a table of name,
            unit, scale and offset.  Roles left out are looked for under their canonical names
            (``time_s``).
        begin, end : float or str, optional
            The part that is read, both ends in it: s on the clock of the file, or a row as in
            ``"row 120"``, counted from 1.
        motion : {"rotary", "linear"}, optional
            Without it the units tell.
        drive : str, optional
            Which canonical column is the input: "current_a", "voltage_v", "torque_nm", "force_n",
            or "goal_rad" or "goal_m" of a servo; or "prescribed_motion". With "prescribed_motion"
            ``torque_nm`` and ``force_n`` are the measured effort.
        count_size : float, optional
            Size of one sensor count in rad or m, for columns in ``count``.
        role, kind, start_s, cold, settings
            As for `Recording`.
        keep_faulty : bool
            Load a recording with too many missing cells too, and say so in ``faults``.

        Raises
        ------
        InputError
            If the file or a column cannot be used; the message is one sentence that says where
            and what to do.
        """
        labels = _labels(role, kind, start_s, cold, settings)
        mapped = Columns.parse(columns)
        if count_size is not None and not 0.0 < number(count_size, "count_size") < math.inf:
            raise InputError(f"count_size = {count_size!r} is not a finite number above 0")
        if isinstance(path, (list, tuple)):
            table = read_signals([file_path(each, "Recording.load") for each in path])
        else:
            table = read_table(file_path(path, "Recording.load"))  # type: ignore[arg-type]
        return cls._of(
            table,
            mapped,
            labels,
            begin=begin,
            end=end,
            motion=motion,
            drive=drive,
            count_size=count_size,
            keep_faulty=keep_faulty,
        )

    @classmethod
    def _of(
        cls,
        table: Table,
        columns: Columns,
        labels: Mapping[str, Any],
        *,
        begin: float | str | None,
        end: float | str | None,
        motion: Motion | None,
        drive: str | None,
        count_size: float | None,
        keep_faulty: bool,
    ) -> Recording:
        channels = read_channels(table, columns, drive=drive, motion=motion, count_size=count_size)
        rows = part_of(channels.values["time"], begin, end, str(table.path))
        first = channels.first + rows.start
        # The columns have been copied, and may be a good part of the memory at hand.
        table = replace(table, columns={})
        recording = cls.__new__(cls)
        recording._fill(
            {role: values[rows] for role, values in channels.values.items()},
            source=str(table.path),
            place=lambda row: table.place(first + row),
            labels=labels,
            units=channels.units,
            motion=channels.motion,
            notes=channels.notes,
            path=table.path,
            keep_faulty=keep_faulty,
        )
        return recording

    def from_cold(self) -> Recording:
        """The same recording, ``cold``."""
        again = copy(self)
        object.__setattr__(again, "cold", True)
        return again

    def with_role(self, role: str | None) -> Recording:
        """The same recording in another role of the split.

        Parameters
        ----------
        role : str
            train, select or test; None for whatever the split makes of it.

        Raises
        ------
        InputError
            Another word.
        """
        again = copy(self)
        object.__setattr__(again, "role", _role(role))
        return again

    @property
    def entry(self) -> tuple[int, str] | None:
        """Place and name in the session that it was taken out of, where others were left out."""
        return self.__dict__.get("_entry")

    def entered(self, place: int, name: str) -> Recording:
        """The same recording, called as it is in its session whatever is left of that.

        Parameters
        ----------
        place : int
            In the session, from 0.
        name : str
        """
        again = copy(self)
        object.__setattr__(again, "_entry", (place, name))
        return again

    def with_input(self, values: FloatArray) -> Recording:
        """The same recording with another input.

        Parameters
        ----------
        values : numpy.ndarray, shape (rows,)
            In the unit of the input; copied.

        Raises
        ------
        InputError
            No numbers, or not one for each row.
        """
        again = copy(self)
        object.__setattr__(again, "input", self._held(values, "with_input"))
        return again

    def with_load(self, values: FloatArray, transmitted: FloatArray | None = None) -> Recording:
        """The same recording with another load.

        Parameters
        ----------
        values : numpy.ndarray, shape (rows,)
            External effort from each row to the next, positive along positive motion, N·m or N;
            copied.
        transmitted : numpy.ndarray, shape (rows,), optional
            Effort that the gear transmits, with the sign of a load: friction that grows with the
            load grows with it. Without it that is the load and gravity, which lacks what
            accelerates the inertia behind the gear. Copied.

        Raises
        ------
        InputError
            No numbers, or not one for each row.
        """
        again = copy(self)
        channels = {**self.__dict__["_channels"], "load": self._held(values, "with_load")}
        channels.pop("transmitted", None)
        if transmitted is not None:
            channels["transmitted"] = self._held(transmitted, "with_load", "transmitted")
        object.__setattr__(again, "_channels", channels)
        return again

    def without_ends(self, rows: int) -> Recording:
        """The same recording without as many rows at its beginning and at its end.

        Parameters
        ----------
        rows : int

        Raises
        ------
        InputError
            Fewer than 200 rows would be left.
        """
        rows = whole(rows, "Recording.without_ends: rows", least=0)
        if len(self) - 2 * rows < FEWEST_ROWS:
            raise InputError(
                f"Recording.without_ends: rows = {rows} leaves less than {FEWEST_ROWS} of "
                f"{len(self)} rows; give fewer"
            )
        again = copy(self)
        kept = slice(rows, len(self) - rows)

        def part(values: FloatArray | None) -> FloatArray | None:
            return None if values is None else values[kept]

        for name in _MAIN:
            object.__setattr__(again, name, part(getattr(self, name)))
        channels = {name: part(values) for name, values in self.__dict__["_channels"].items()}
        object.__setattr__(again, "_channels", channels)
        began = float(self.time[rows] - self.time[0])
        # A clock of the session that nobody stated stays unstated.
        object.__setattr__(again, "start_s", self.start_s + began if self.start_s else 0.0)
        return again

    def decimate(self, every: int) -> Recording:
        """The same recording with one row for as many of these.

        What holds from a row to the next, input and load, is the mean of what held in between;
        readings are those of the rows that are kept. Rows at the end that make up no whole one are
        left out.

        Parameters
        ----------
        every : int
            1 keeps all rows.

        Raises
        ------
        InputError
            Fewer than 200 rows would be left.

        Examples
        --------
        >>> import numpy as np, stiction as st
        >>> time = np.arange(1000) * 1e-3
        >>> slow = st.Recording(time, np.sin(time), time).decimate(4)
        >>> len(slow), round(slow.dt, 6)
        (250, 0.004)
        """
        every = whole(every, "Recording.decimate: every", least=1)
        rows = len(self) // every
        if rows < FEWEST_ROWS:
            raise InputError(
                f"Recording.decimate: every = {every} leaves less than {FEWEST_ROWS} of "
                f"{len(self)} rows; give fewer"
            )
        steps = np.diff(self.time, append=2.0 * self.time[-1] - self.time[-2])
        spans = steps[: rows * every].reshape(rows, every)

        def kept(name: str, values: FloatArray | None) -> FloatArray | None:
            if values is None:
                return None
            taken = values[: rows * every].reshape(rows, every)
            held = name in _HELD
            found = np.sum(taken * spans, axis=1) / np.sum(spans, axis=1) if held else taken[:, 0]
            found = np.ascontiguousarray(found)
            found.flags.writeable = False
            return found

        again = copy(self)
        for name in _MAIN:
            object.__setattr__(again, name, kept(name, getattr(self, name)))
        channels = {name: kept(name, values) for name, values in self.__dict__["_channels"].items()}
        object.__setattr__(again, "_channels", channels)
        return again

    def _held(self, values: FloatArray, method: str, name: str = "values") -> FloatArray:
        """One number a row, copied, that cannot be written to."""
        held = numbers(values, f"Recording.{method}: {name}").copy()
        if held.shape != self.time.shape:
            raise InputError(
                f"Recording.{method}: {name} has shape {held.shape} where {self.time.shape} is "
                "needed; give one value a row"
            )
        held.flags.writeable = False
        return held

    def _fill(
        self,
        values: Mapping[str, FloatArray],
        *,
        source: str,
        place: Place,
        labels: Mapping[str, Any],
        units: Mapping[str, str] | None = None,
        motion: Motion | None = None,
        notes: tuple[str, ...] = (),
        path: Path | None = None,
        keep_faulty: bool = False,
    ) -> None:
        _check_channels(source, values)
        mended = mend(values, source=source, place=place, keep_faulty=keep_faulty)
        arrays = dict(mended.values)
        for array in arrays.values():
            array.flags.writeable = False
        state = {
            **labels,
            **{name: arrays.pop(name, None) for name in _MAIN},
            "_channels": arrays,
            "_units": dict.fromkeys(values, "") | {"time": "s"} | dict(units or {}),
            "quality": mended.repairs,
            "faults": mended.faults,
            "notes": (*mended.faults, *(str(repair) for repair in mended.repairs), *notes),
            "motion": motion,
            "path": path,
        }
        for name, value in state.items():
            object.__setattr__(self, name, value)

    @property
    def channels(self) -> Mapping[str, FloatArray]:
        """Every channel besides time, input and position, by name."""
        return Frozen(self.__dict__["_channels"])

    @property
    def units(self) -> Mapping[str, str]:
        """SI unit of every channel, "" where nothing tells it."""
        return Frozen(self.__dict__["_units"])

    @property
    def effort(self) -> FloatArray | None:
        """Measured effort, shape (rows,), N·m or N: stands in place of input where None."""
        return self.channels.get("effort")

    @property
    def dt(self) -> float:
        """Median time step, s."""
        return float(np.median(np.diff(self.time)))

    @property
    def duration(self) -> float:
        """Time from the first to the last row, s."""
        return float(self.time[-1] - self.time[0])

    @property
    def hash(self) -> str:
        """SHA-256 of the names and bytes of all channels, time included, in hexadecimal."""
        digest = hashlib.sha256()
        main = {name: getattr(self, name) for name in _MAIN}
        for name, array in sorted({**main, **self.channels}.items()):
            if array is not None:
                digest.update(name.encode() + b"\0" + array.astype("<f8").tobytes())
        for name, value in sorted(self.settings.items()):
            digest.update(f"{name}={value!r}".encode())
        return digest.hexdigest()

    def __len__(self) -> int:
        return len(self.time)

    def __repr__(self) -> str:
        return as_text(self)

    def _repr_html_(self) -> str:
        return as_html(self)

    def __setstate__(self, state: dict[str, Any]) -> None:
        # Copies and pickles come back with writeable arrays.
        self.__dict__.update(state)
        for array in (self.time, self.input, self.position, *self.channels.values()):
            if array is not None:
                array.flags.writeable = False


def recording_of(
    table: Table,
    columns: Columns,
    *,
    drive: str,
    motion: Motion,
    begin: float | str | None = None,
    end: float | str | None = None,
    role: str | None = None,
    kind: str = "",
    start_s: float = 0.0,
    cold: bool = False,
    settings: Mapping[str, float] | None = None,
) -> Recording:
    """A recording from a table that was read already: of one joint of several in a file.

    Parameters
    ----------
    table : Table
    columns, drive, motion, begin, end, role, kind, start_s, cold, settings
        As for ``Recording.load``.

    Raises
    ------
    InputError
        As there.
    """
    return Recording._of(
        table,
        columns,
        _labels(role, kind, start_s, cold, settings),
        begin=begin,
        end=end,
        motion=motion,
        drive=drive,
        count_size=None,
        keep_faulty=False,
    )


def recordings_of(given: Any, where: str) -> tuple[Recording, ...]:
    """Recordings of a session, a sequence of them, or one.

    Parameters
    ----------
    given : Session, sequence of Recording, or Recording
    where : str
        What the error sentence begins with.

    Raises
    ------
    InputError
        Anything else.
    """
    if isinstance(given, Recording):
        return (given,)
    wanted = "a Session, as stiction.load returns it, or Recordings"
    try:
        found = (given,) if isinstance(given, str) else tuple(given)
    except TypeError:
        found = (given,)
    return tuple(instance(each, Recording, f"{where}: a recording", wanted) for each in found)


def _flat(name: str, given: npt.ArrayLike) -> FloatArray:
    """A new flat array of doubles."""
    if isinstance(given, np.ma.MaskedArray):
        # What is masked is missing, as NaN is.
        given = np.ma.filled(given.astype(np.float64), np.nan)
    try:
        array = real(given)
        if array.dtype.kind == "O":
            raise TypeError(f"the type is {array.dtype}")
        flat = np.array(array, dtype=np.float64, order="C")
    except (TypeError, ValueError) as error:
        raise InputError(
            f"Recording: {name} cannot be read as real numbers ({error}); "
            "give a flat array of floats"
        ) from error
    if flat.ndim != 1:
        raise InputError(
            f"Recording: {name} has the shape {flat.shape}; give a flat array, one value a row"
        )
    return flat


def _role(role: str | None) -> str | None:
    if role is not None and not (isinstance(role, str) and role in SPLIT_ROLES):
        raise InputError(
            f"Recording: the role is {role!r}{did_you_mean(str(role), SPLIT_ROLES)}; "
            f"give {', '.join(SPLIT_ROLES)}, or none"
        )
    return role


def _labels(
    role: str | None,
    kind: str,
    start_s: float,
    cold: bool,
    settings: Mapping[str, float] | None,
) -> dict[str, Any]:
    _role(role)
    if not isinstance(kind, str):
        raise InputError(f"Recording: the kind is {kind!r}; give text")
    start_s = _finite(start_s, "start_s", "a finite number of seconds")
    if not isinstance(cold, (bool, np.bool_)):
        raise InputError(f"Recording: cold is {cold!r}; give True or False")
    settings = mapping(settings, "Recording: settings", "names and numbers")
    for name in settings:
        if name not in SETTINGS:
            raise InputError(
                f"Recording: there is no setting '{name}'{did_you_mean(name, SETTINGS)}; the "
                f"settings are {', '.join(SETTINGS)}"
            )
    own = {
        name: _finite(value, f"the setting {name}", "a finite number")
        for name, value in settings.items()
    }
    settled = {"role": role, "kind": kind, "start_s": start_s, "cold": bool(cold)}
    return {**settled, "settings": Frozen(own)}


def _finite(given: Any, name: str, wanted: str) -> float:
    try:
        value = number(given, name)
    except InputError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"Recording: {name} is {brief(given)}; give {wanted}")
    return value


def _check_channels(source: str, values: Mapping[str, FloatArray]) -> None:
    if "input" in values and "effort" in values:
        raise InputError(
            f"{source}: both input and effort are given; give the input of a driven machine, or "
            "the measured effort of one that is moved, and not both"
        )
    if "input" not in values and "effort" not in values:
        raise InputError(
            f"{source}: neither input nor effort is given; give the input of a driven machine, "
            "or the measured effort of one that is moved"
        )
    if "input" not in values and not {"position", "velocity"} & set(values):
        raise InputError(
            f"{source}: an effort is given without the motion it belongs to; give position as well"
        )
