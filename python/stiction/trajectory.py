"""What a simulation returns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from ._support import given
from ._support.arrays import FloatArray
from ._support.frozen import Frozen
from ._support.keys import choice
from ._support.table_file import save_table
from .errors import InputError, UnknownName

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .plot import Panels

__all__ = ["Trajectory"]

_MOTION = ("position", "velocity", "friction", "measured")
_UNITS: Final = {
    motion: dict(zip(_MOTION, units, strict=True))
    for motion, units in (
        ("rotary", ("rad", "rad/s", "N·m", "rad")),
        ("linear", ("m", "m/s", "N", "m")),
        ("", ("rad or m", "rad/s or m/s", "N·m or N", "rad or m")),
    )
}


class Trajectory:
    """Columns of a simulation, each of shape (n,); read them as attributes or by name.

    Entry k is the state after input k, at ``time[k]``, the end of sample k.

    Attributes
    ----------
    columns : Mapping of str to numpy.ndarray, shape (n,)
        The columns that were asked for, by name. No column can be written to: arrays that were
        given as ``out`` are written through the caller's own.
    dt : float or numpy.ndarray, shape (n,)
        Duration of a sample in s, or of each.
    time : numpy.ndarray, shape (n,)
        Seconds since the motor's last reset; computed on access.
    position, velocity, friction, measured, … : numpy.ndarray, shape (n,)
        The same: rad or m, rad/s or m/s, N·m or N; the law's own states under their names.
    units : Mapping of str to str
        Of position, velocity, friction and measured; of a motor alone both that they may have.
    statistics : Mapping of str to int
        How often each branch was taken since the last reset.
    success : bool
        Whether no value is NaN, and motion and friction are finite.
    message : str
        What happened, in words.
    """

    # In one tuple that is kept once: a call of `simulate` that other work has pushed out of the
    # cache takes as long as what it looks up. What is given is the trajectory's own from now on.
    __slots__ = ("__weakref__", "_own")
    _own: tuple[dict[str, FloatArray], float | FloatArray, int, float, dict[str, int], str]

    def __init__(
        self,
        columns: dict[str, FloatArray],
        dt: float | FloatArray,
        length: int,
        start: float,
        statistics: dict[str, int],
        motion: str = "",
    ) -> None:
        _keep(self, (columns, dt, length, start, statistics, motion))

    def of_motion(self, motion: str) -> Trajectory:
        """The same of a machine of this kind, which a motor does not know: it then has units.

        Parameters
        ----------
        motion : {"rotary", "linear"}

        Raises
        ------
        InputError
            Another word.
        """
        return Trajectory(*self._own[:5], choice(motion, ("rotary", "linear"), "motion"))

    @property
    def _columns(self) -> dict[str, FloatArray]:
        return self._own[0]

    @property
    def _dt(self) -> float | FloatArray:
        return self._own[1]

    @property
    def _length(self) -> int:
        return self._own[2]

    @property
    def _start(self) -> float:
        return self._own[3]

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a trajectory is frozen: {name} cannot be set")

    @property
    def statistics(self) -> Mapping[str, int]:
        """How often each branch was taken since the last reset."""
        return Frozen(self._own[4])

    @property
    def units(self) -> Mapping[str, str]:
        """Units of position, velocity, friction and measured position, as far as it has them.

        Both where nobody said whether it turns; of a simulation of a ``Plant`` that is known.
        """
        units = {name: each for name, each in _UNITS[self._own[5]].items() if name in self._columns}
        return Frozen(units)

    @property
    def columns(self) -> Mapping[str, FloatArray]:
        """The columns by name."""
        return Frozen({name: _read_only(values) for name, values in self._columns.items()})

    @property
    def dt(self) -> float | FloatArray:
        """Duration of a sample in s, or of each."""
        return _read_only(self._dt) if isinstance(self._dt, np.ndarray) else self._dt

    @property
    def time(self) -> FloatArray:
        """Time at the end of each sample in s."""
        if isinstance(self._dt, np.ndarray):
            return np.asarray(self._start + np.cumsum(self._dt), dtype=np.float64)
        return np.asarray(self._start + self._dt * np.arange(1, self._length + 1), dtype=np.float64)

    @property
    def success(self) -> bool:
        """Whether no value is NaN and motion and friction are finite."""
        # A level may be infinite by definition: break-away of a contact that never slips.
        finite = [self._columns[name] for name in _MOTION if name in self._columns]
        return all(bool(np.isfinite(values).all()) for values in finite) and not any(
            bool(np.isnan(values).any()) for values in self._columns.values()
        )

    @property
    def message(self) -> str:
        """What happened, in words."""
        if not self.success:
            return "the motion ran away: some values are not finite; check units and inertia"
        counted = self.statistics
        slides, stops = counted.get("breakaways", 0), counted.get("sticks", 0)
        # The counts go on from run to run; of one that starts at 0 they are its own.
        since = " since the last reset" if self._start else ""
        return f"{self._length} samples, {slides} break-aways, {stops} stops{since}"

    def __getattr__(self, name: str) -> FloatArray:
        # No column has such a name; of one that holds nothing yet, asking would go on for ever.
        columns = {} if name.startswith("_") else self._columns
        try:
            return _read_only(columns[name])
        except KeyError:
            have = ", ".join(columns)
            raise AttributeError(f"trajectory has no column '{name}'; it has {have}") from None

    def __getitem__(self, name: str) -> FloatArray:
        """A column by its name, shape (n,).

        Raises
        ------
        UnknownName
            An ``InputError`` and a ``KeyError``: there is none of this name.
        """
        try:
            return _read_only(self._columns[name])
        except KeyError:
            have = ", ".join(self._columns)
            raise UnknownName(f"column '{name}' is not in the trajectory; it has {have}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return self._length

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._columns]

    def __getstate__(self) -> dict[str, Any]:
        return {
            "columns": dict(self._columns),
            "dt": self._dt,
            "length": self._length,
            "start": self._start,
            "statistics": dict(self.statistics),
            "motion": self._own[5],
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__(**state)  # type: ignore[misc]

    def __repr__(self) -> str:
        span = self.time[-1] - self._start if self._length else 0.0
        return f"Trajectory({self._length} samples, {span:.6g} s: {', '.join(self._columns)})"

    def _repr_html_(self) -> str:
        units = self.units
        rows = "".join(
            f"<tr><th>{name}</th><td>{units.get(name, '')}</td><td>{values[0]:.6g}</td>"
            f"<td>{values.min():.6g}</td>"
            f"<td>{values.max():.6g}</td><td>{values[-1]:.6g}</td></tr>"
            for name, values in self._columns.items()
            # A chunk of a stream may be shorter than what it keeps a row of.
            if values.size
        )
        return (
            f"<p>{self.message}</p>{self._drawing()}<table><tr><th>column</th><th>unit</th><th>first</th><th>least</th>"
            f"<th>greatest</th><th>last</th></tr>{rows}</table>"
        )

    def _drawing(self) -> str:
        """Position over time, or the first column where there is none."""
        from .notebook import drawing

        name = "position" if "position" in self._columns else next(iter(self._columns), "")
        if not name:
            return ""
        label = f"{name} ({self.units[name]})" if name in self.units else name
        return drawing([(name, self.time, self._columns[name])], "time (s)", label)

    def to_frame(self) -> Any:
        """A pandas DataFrame indexed by time (pandas is an extra: ``stiction[pandas]``).

        Raises
        ------
        InputError
            pandas is not installed.
        """
        try:
            import pandas as pd
        except ImportError:
            raise InputError(
                "to_frame needs pandas; install it with: pip install 'stiction[pandas]'"
            ) from None
        return pd.DataFrame(dict(self._columns), index=pd.Index(self.time, name="time_s"))

    def save(self, path: str | Path) -> Path:
        """Write time, s, and columns to a file.

        A CSV file gets one more column, such as ``row_of_4000``, which counts its rows: read as a
        recording, a file that was cut short is refused.

        Parameters
        ----------
        path : str or Path
            NPZ or CSV, by the name's ending.

        Returns
        -------
        Path
            Of the file.

        Raises
        ------
        InputError
            No path, an unknown ending, a folder that is not there, a file that cannot be written.
        """
        path = given.path(path, "Trajectory.save")
        return save_table(path, {"time_s": self.time, **self._columns})

    def plot(self, ax: Axes | Sequence[Axes] | None = None) -> Panels:
        """Position, velocity and friction over time, with their units.

        Parameters
        ----------
        ax : matplotlib Axes, or a sequence of them, optional
            To draw into, one a column in this order; those of a new figure without it.

        Returns
        -------
        Panels
            The axes, a tuple that a notebook shows as a figure; ``.figure`` is that.

        Raises
        ------
        InputError
            There are no columns to draw; ``ax`` is something else than axes, or too many.
        """
        from . import plot

        return plot.trajectory(self, ax)


def _read_only(values: FloatArray) -> FloatArray:
    """The same numbers, not to be written to."""
    view = values.view()
    view.flags.writeable = False
    return view


_keep: Final = Trajectory._own.__set__  # type: ignore[attr-defined, misc]
"""Past the guard of ``__setattr__``, once."""
