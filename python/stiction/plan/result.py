"""A plan: signals, their files and figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from .._support import given
from .._support.arrays import FloatArray
from .._support.atomic_files import atomic_write
from .._support.wording import plural
from ..plant import Plant
from ..recording.recording import SPLIT_ROLES
from .files import find_signal, write_plan

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Plan", "Signal"]

FILLED_IN: Final = ("session.toml", "plant.toml")
"""Files that whoever records goes on writing in: an earlier one is never replaced."""
PAUSE_S: Final = 5.0
"""Between recordings."""
LONG_REST_S: Final = 120.0
"""After the first cycle, while the machine is cold."""


@dataclass(frozen=True)
class Signal:
    """What a recording is made with.

    Attributes
    ----------
    experiment : str
    kind : {"reference", "input"}
    purpose : str
        What it shows, in words.
    role : str
        Of the recording that it makes.
    time, values : numpy.ndarray, shape (n,)
        Values in rad or m about the start, or in the unit of the drive's input.
    column : str
        Their name in the file.
    expected : numpy.ndarray, shape (n,)
        Position that the plant comes to, rad or m about the start; a reference itself.
    greatest : dict of str to float
        Greatest distance, speed and effort that the plant comes to.
    """

    experiment: str
    kind: str
    purpose: str
    role: str
    time: FloatArray
    values: FloatArray
    column: str
    expected: FloatArray
    greatest: dict[str, float]

    @property
    def name(self) -> str:
        """Of its files."""
        return f"{self.experiment}-{self.role}"

    @property
    def duration(self) -> float:
        """In seconds."""
        return float(self.time[-1])

    def __repr__(self) -> str:
        most = ", ".join(f"{name} {value:.3g}" for name, value in self.greatest.items())
        return f"Signal({self.name}, {self.kind}, {self.duration:.1f} s, greatest {most})"

    def save(self, where: str | Path) -> Path:
        """Write it as CSV into a folder; returns the path.

        Raises
        ------
        InputError
            No name of a folder, or one that is not there or cannot be written to.
        """
        path = given.path(where, "Signal.save") / f"{self.name}.csv"
        rows = np.column_stack([self.time, self.values])
        with given.explain_write_errors(path), atomic_write(path) as file:
            file.write(f"time_s,{self.column}\n".encode())
            np.savetxt(file, rows, fmt="%.9g", delimiter=",")
        return path

    def plot(self) -> Figure:
        """The signal over time, and where it takes the machine."""
        from .. import plot

        rows = 2 if self.kind == "input" else 1
        figure, axes = plot.figure(
            rows, height=2.2 * rows, title=f"{self.experiment}: {self.purpose}", sharex=True
        )
        axes[0].plot(*plot.thinned(self.time, self.values), color=plot.SIMULATED, lw=0.9)
        axes[0].set_ylabel(self.column)
        if self.kind == "input":
            axes[1].plot(*plot.thinned(self.time, self.expected), color=plot.ACCENT, lw=0.9)
            axes[1].set_ylabel("simulated position")
        axes[-1].set_xlabel("time / s")
        return figure


@dataclass(frozen=True)
class Plan:
    """Signals for a session of one machine.

    Attributes
    ----------
    plant : Plant
    signals : tuple of Signal
        In the order of the session.
    notes : tuple of str
        What was left out or made smaller, and why.
    success : bool
    message : str
    """

    plant: Plant
    signals: tuple[Signal, ...]
    notes: tuple[str, ...] = ()
    success: bool = True
    message: str = ""

    def __getitem__(self, name: str) -> Signal:
        """A signal by its name, such as ``ramps-train``.

        Raises
        ------
        UnknownName
            An ``InputError`` and a ``KeyError``: there is no such signal.
        """
        return find_signal(self.signals, name)

    def schedule(self) -> list[dict[str, Any]]:
        """What to record when: file, role, kind and start of every recording, pauses included."""
        entries: list[dict[str, Any]] = []
        written: set[str] = set()
        at = 0.0
        for each in _session_order(self.signals):
            if each is None:
                at += LONG_REST_S
                continue
            name = each.name if each.name not in written else f"{each.name}-again"
            entry = {
                "file": f"{name}.csv",
                "role": each.role if name == each.name else "test",
                "kind": each.experiment,
                "start_s": round(at, 3),
                "signal": f"{each.name}.csv",
            }
            if name != each.name:
                entry["replicate_of"] = f"{each.name}.csv"
            written.add(name)
            entries.append(entry)
            at += each.duration + PAUSE_S
        return entries

    def save(self, where: str | Path) -> Path:
        """Write signals, figures, plan.json and a session.toml to be filled with recordings.

        Parameters
        ----------
        where : str or Path
            Folder, made where it is not there.

        Returns
        -------
        Path
            The folder.

        Raises
        ------
        InputError
            A session.toml or plant.toml is there already, which may have been filled in, and
            nothing is written then; the folder cannot be written.
        """
        folder = given.path(where, "Plan.save")
        given.vacant(folder, FILLED_IN)
        return write_plan(
            folder,
            self.signals,
            self.to_dict(),
            lambda: self.plant.save(folder / "plant.toml"),
            self._session(),
        )

    def to_dict(self) -> dict[str, Any]:
        """As in plan.json."""
        return {
            "signals": [
                {
                    "name": s.name,
                    "experiment": s.experiment,
                    "kind": s.kind,
                    "purpose": s.purpose,
                    "role": s.role,
                    "column": s.column,
                    "duration_s": s.duration,
                    "greatest": s.greatest,
                }
                for s in self.signals
            ],
            "schedule": self.schedule(),
            "notes": list(self.notes),
        }

    def _session(self) -> str:
        lines = [
            "# Recordings to be made with the signals beside this file, in this order. Input as it",
            "# was commanded, and as it was measured where that differs; position; reference;",
            "# temperature and load where they are known. start_s is the clock of the whole",
            "# session: write down when each recording began, pauses included. To add them to an",
            "# earlier session go on with its clock, and where the machine has cooled down in",
            "# between write cold = true for the first one: what goes with time or with the way",
            "# travelled then begins anew.",
            'plant = "plant.toml"',
        ]
        for entry in self.schedule():
            lines += [
                "",
                f"# {'moved again exactly as ' if 'replicate_of' in entry else 'with '}"
                f"signals/{entry['signal']}",
                "[[recordings]]",
                f'file = "{entry["file"]}"',
                f'role = "{entry["role"]}"',
                f'kind = "{entry["kind"]}"',
                f"start_s = {entry['start_s']}",
            ]
            if "replicate_of" in entry:
                lines.append(f'replicate_of = "{entry["replicate_of"]}"')
        return "\n".join(lines) + "\n"

    def __repr__(self) -> str:
        """A table of the signals, with what the machine comes to at most."""
        total = sum(signal.duration for signal in self.signals)
        unit, effort = self.plant.position_unit, self.plant.effort_unit
        rows = [
            ("signal", "kind", "length", "position", "speed", "effort", "what it is for"),
            ("", "", "s", unit, f"{unit}/s", effort, ""),
            *map(_row, self.signals),
        ]
        widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]) - 1)]
        # Words begin below one another, numbers end so.
        sides = "<<>>>>"
        lines = [
            "  ".join(
                [
                    *(f"{row[k]:{sides[k]}{width}}" for k, width in enumerate(widths)),
                    row[-1],
                ]
            ).rstrip()
            for row in rows
        ]
        head = f"{plural(len(self.signals), 'signal')}, {total:.0f} s in all"
        told = "position, speed and effort are the greatest that the plant comes to"
        return "\n".join(
            [f"{head}; {told}:", "", *lines, *([""] if self.notes else []), *self.notes]
        )

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{escape(s.name)}</td><td>{escape(s.purpose)}</td>"
            f"<td>{s.duration:.1f} s</td></tr>"
            for s in self.signals
        )
        return f"<table><tr><th>signal</th><th>purpose</th><th>length</th></tr>{rows}</table>"


def _row(signal: Signal) -> tuple[str, ...]:
    most = (f"{signal.greatest[name]:.3g}" for name in ("distance", "speed", "effort"))
    return (signal.name, signal.kind, f"{signal.duration:.1f}", *most, signal.purpose)


def _session_order(signals: Sequence[Signal]) -> list[Signal | None]:
    """Each role in turn, and one signal once more; None is a long rest.

    The cycle comes first of all, while the machine is cold, and again right after a long rest: time
    has gone on then and the machine has not moved. It comes again in the middle and at the end.
    """
    cycle = [s for s in signals if s.experiment == "cycle"]
    others = [s for s in signals if s.experiment != "cycle"]
    by_role = [s for role in SPLIT_ROLES for s in others if s.role == role]
    half = len(by_role) // 2
    again = [s for s in others if s.kind == "reference"][:1]
    begin: list[Signal | None] = [cycle[0], None, cycle[1]] if cycle else [None]
    return [*begin, *by_role[:half], *cycle[2:], *by_role[half:], *again, *cycle[:1]]
