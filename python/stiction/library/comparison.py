"""A unit of one's own beside an entry: a fit that starts there, and number by number."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Literal

from .. import given
from ..errors import InputError
from ..fitting import FitParameter, FitResult, fit
from ..json_text import json_of
from ..plant import Plant
from ..recording import Recording
from ..recording.recording import recordings_of
from ..session import Session
from ..wording import counted, listed
from .entry_file import Entry, Number

__all__ = ["Compared", "Comparison", "compare", "plant_like"]

OWN: Final = ("motion", "drive", "body", "sensor", "controller")
"""Tables of a plant file that say how one's own machine is driven and read, and what it carries."""
LOST: Final = "not determined"
"""Of every number where a fit leaves no inertia: nothing of it is one of the machine then."""
Said = Literal["alike", "differs", "beyond the interval", "not determined"]


@dataclass(frozen=True)
class Compared:
    """One number of a unit beside that of the library.

    Attributes
    ----------
    path : str
    own : FitParameter
        With its interval.
    library : Number
    said : str
        "differs" where the intervals of both do not meet, though that of the library holds what
        differs from unit to unit; "beyond the interval" where they do not meet and nobody knows
        what differs from unit to unit; "alike" where they meet; "not determined" where the
        recordings do not tell the number.
    """

    path: str
    own: FitParameter
    library: Number
    said: Said

    @property
    def carried(self) -> bool:
        """Whether it is a number of the body, which is what a motor carries as well."""
        return self.path.startswith("body.")

    def to_dict(self) -> dict[str, Any]:
        """As plain data."""
        return {
            "own": {
                "value": self.own.value,
                "ci95": list(self.own.ci95),
                "at_bound": self.own.at_bound,
            },
            "library": self.library.to_dict(),
            "said": self.said,
        }


@dataclass(frozen=True)
class Comparison:
    """A unit beside an entry.

    Attributes
    ----------
    entry : Entry
    result : FitResult
        Of the plant of the entry, fitted to the recordings.
    numbers : tuple of Compared
    seconds : float
        That were recorded.
    held : tuple of str
        Effects of the drive whose numbers stay as they are in the entry.
    """

    entry: Entry
    result: FitResult
    numbers: tuple[Compared, ...]
    seconds: float
    held: tuple[str, ...] = ()

    @property
    def differing(self) -> tuple[str, ...]:
        """Paths of numbers that differ by more than units do, or beyond what is known of them."""
        return tuple(e.path for e in self.numbers if e.said in ("differs", "beyond the interval"))

    @property
    def message(self) -> str:
        """What came out, in a sentence."""
        told = [each for each in self.numbers if each.said != LOST]
        if not told:
            return f"these recordings tell no number of {self.entry.name}"
        own = [each for each in told if not each.carried]
        groups = (
            ("more than from unit to unit", [e for e in own if e.said == "differs"]),
            (
                "beyond the interval of the unit that is known",
                [e for e in own if e.said == "beyond the interval"],
            ),
        )
        parts = [f"{listed(e.path for e in group)}: {word}" for word, group in groups if group]
        name, many = self.entry.name, counted(len(own), "number")
        first = f"differs from {name}: {'; '.join(parts)}" if parts else f"as {name} in {many}"
        load = [each.path for each in told if each.carried and each.said != "alike"]
        return f"{first}; what it carries differs: {listed(load)}" if load else first

    def __str__(self) -> str:
        rows = [("number", "your unit", "library", "interval", "95 % of units", "unit", "")]
        for each in self.numbers:
            own, library = each.own, each.library
            bound = f" ({own.at_bound} bound)" if own.at_bound else ""
            half = 0.5 * (own.ci95[1] - own.ci95[0])
            mine = f"{own.value:.4g} ± {half:.2g}{bound}" if math.isfinite(half) else "?"
            rows.append(
                (
                    each.path,
                    mine,
                    f"{library.value:.4g}",
                    _span(library.ci95, "none stated"),
                    _span(library.band, "not known"),
                    library.unit,
                    each.said,
                )
            )
        widths = [max(len(row[k]) for row in rows) for k in range(6)]
        table = [
            "  ".join([*(f"{r[k]:<{widths[k]}}" for k in range(6)), r[6]]).rstrip() for r in rows
        ]
        stays = [
            f"  {name} stays as it is in the entry, for a fit cannot tell a drive that gives less "
            "from a machine that takes less"
            for name in self.held
        ]
        head = f"{self.entry.name}: {self.entry.machine}; {self.seconds:.3g} s of your unit"
        return "\n".join(
            [head, self.message, "", *table, *stays, *(f"  {s}" for s in self.result.remarks)]
        )

    def to_dict(self) -> dict[str, Any]:
        """As plain data."""
        return {
            "schema": 1,
            "entry": self.entry.name,
            "message": self.message,
            "seconds": self.seconds,
            "differing": list(self.differing),
            "held": list(self.held),
            "numbers": {each.path: each.to_dict() for each in self.numbers},
            "fit": self.result.to_dict(),
        }

    def to_json(self) -> str:
        """Everything as JSON."""
        return json_of(self.to_dict())


def _span(ends: tuple[float, float] | None, none: str) -> str:
    return none if ends is None else f"{ends[0]:.4g} to {ends[1]:.4g}"


def plant_like(entry: Entry, plant: Plant | None) -> Plant:
    """The plant of an entry under the drive, on the body and read by the sensor of another.

    Parameters
    ----------
    entry : Entry
    plant : Plant or None
        What its owner states; None takes the entry as it is.

    Raises
    ------
    InputError
        One is rotary and the other linear, or an effect goes with no such drive.
    """
    if plant is None:
        return entry.plant
    if plant.motion != entry.plant.motion:
        raise InputError(
            f"{plant.source}: is {plant.motion}, and {entry.name} is {entry.plant.motion}; compare "
            "it with another entry"
        )
    own, table = plant.to_dict(), entry.plant.to_dict()
    table |= {name: own[name] for name in OWN if name in own}
    return Plant.from_dict(table, source=plant.source)


def compare(entry: Entry, session: Session | Recording | Sequence[Recording]) -> Comparison:
    """Fit recordings of a unit from where an entry stands, and put both side by side.

    Parameters
    ----------
    entry : Entry
    session : Session, Recording or sequence of Recording
        The plant of a session, where it has one, says how the unit is driven and read and what it
        carries; law, effects and where the fit starts are those of the entry.

    Returns
    -------
    Comparison

    Raises
    ------
    InputError
        As for ``stiction.fit``; a plant that moves another way than the entry.
    """
    given.instance(entry, Entry, "compare: entry", "an entry, as stiction.library.entry returns it")
    own = session.plant if isinstance(session, Session) else None
    plant = plant_like(entry, own)
    plant, held = _with_drive_held(plant)
    result = fit(plant, session)
    inertia = result.parameters.get("body.inertia")
    lost = inertia is not None and inertia.at_bound == "lower"
    numbers = tuple(
        Compared(path, each, entry.numbers[path], LOST if lost else said(each, entry.numbers[path]))
        for path, each in result.parameters.items()
        if path in entry.numbers
    )
    seconds = sum(each.duration for each in recordings_of(session, "compare"))
    return Comparison(entry, result, numbers, seconds, held)


def _with_drive_held(plant: Plant) -> tuple[Plant, tuple[str, ...]]:
    """A plant whose drive stays as it is, and the names of effects that are held for it.

    Along a measured motion a drive that gives nothing leaves nothing. The loop of a servo does not
    follow such a drive: there they are fitted.
    """
    held = [e.name for e in plant.effects if "input map" in e.record.hooks and not plant.servo]
    effects = (
        replace(each, parameters={n: replace(p, fixed=True) for n, p in each.parameters.items()})
        if each.name in held
        else each
        for each in plant.effects
    )
    return replace(plant, effects=tuple(effects)), tuple(held)


def said(own: FitParameter, library: Number) -> Said:
    """What is to be said of two numbers."""
    low, high = own.ci95
    if not (math.isfinite(low) and math.isfinite(high)) or own.at_bound:
        return "not determined"
    spread = library.band
    known = [ends for ends in (library.ci95, spread, (library.value,) * 2) if ends is not None]
    least, most = min(ends[0] for ends in known), max(ends[1] for ends in known)
    if low <= most and least <= high:
        return "alike"
    return "beyond the interval" if spread is None else "differs"
