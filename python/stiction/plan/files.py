"""Names and files of a plan, of one axis or of a robot."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from .._support.atomic_files import subfolder, write_text
from ..errors import InputError, UnknownName

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["PlannedSignal", "find_signal", "write_plan"]


class PlannedSignal(Protocol):
    """A signal that is played to a machine."""

    @property
    def name(self) -> str:
        """Of its files."""

    def save(self, where: str | Path) -> Path:
        """Write it as CSV into a folder."""

    def plot(self) -> Figure:
        """Its figure."""


_Signal = TypeVar("_Signal", bound=PlannedSignal)


def find_signal(signals: Sequence[_Signal], name: str) -> _Signal:
    """A signal by its name.

    Raises
    ------
    UnknownName
        An ``InputError`` and a ``KeyError``: there is no such signal.
    """
    for signal in signals:
        if signal.name == name:
            return signal
    known = ", ".join(signal.name for signal in signals)
    raise UnknownName(f"plan: there is no signal '{name}'; there are {known}")


def write_plan(
    folder: Path,
    signals: Sequence[PlannedSignal],
    told: dict[str, Any],
    write_machine: Callable[[], object],
    session: str,
) -> Path:
    """Writes signals, plan.json, the file of the machine and session.toml, and then draws.

    Parameters
    ----------
    folder : Path
        Made where it is not there.
    signals : sequence of PlannedSignal
    told : dict
        What plan.json holds.
    write_machine : callable
        Writes plant.toml or robot.toml.
    session : str
        What session.toml holds.

    Raises
    ------
    InputError
        The folder cannot be written.
    """
    from .. import plot
    from .._support.json_text import json_of

    try:
        folder.mkdir(parents=True, exist_ok=True)
        place = subfolder(folder, "signals")
        for signal in signals:
            signal.save(place)
        write_text(folder / "plan.json", json_of(told) + "\n")
        write_machine()
        write_text(folder / "session.toml", session)
        for signal in signals:
            drawn = place / f"{signal.name}.svg"
            plot.save_or_say(f"the figure of {signal.name}", signal.plot, drawn)
    except OSError as error:
        raise InputError(
            f"{folder}: cannot be written ({error.strerror}); give another folder with --out"
        ) from None
    return folder
