"""A unit of one's own beside an entry: a fit that starts there, and number by number."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, Final, Literal

import numpy as np

from .._support import given
from .._support.arrays import FloatArray
from .._support.json_text import json_of
from .._support.wording import commas, plural
from ..errors import InputError
from ..fitting import FitParameter, FitResult, fit
from ..fitting.start import free_paths
from ..plant import Plant
from ..plant.begins import begin_of
from ..plant.parameter import Parameter
from ..recording import Recording
from ..recording.names import names_of
from ..recording.recording import recordings_of
from ..residual.compared import comparison_of
from ..residual.effort import EffortResidual, effort_residual, free_run
from ..session import Session
from .entry_file import Entry, EntryNumber, span

__all__ = ["UnitComparison", "UnitNumber", "compare", "plant_like"]

OWN: Final = ("motion", "drive", "body", "sensor", "controller")
"""Tables of a plant file that say how one's own machine is driven and read, and what it carries."""
LOST: Final = "not determined"
"""Of every number where a fit leaves no inertia: nothing of it is one of the machine then."""
NEARLY: Final = 1.2
"""Times what a fit leaves that an entry leaves as it is: below it numbers of both are as good."""
PUSHED: Final = 8.0
"""Times the median of what a fit leaves beyond which something else moved the machine: such rows
are left out, as fits do."""
Said = Literal["alike", "differs", "beyond the interval", "not determined"]


@dataclass(frozen=True)
class UnitNumber:
    """One number of a unit beside that of the library.

    Attributes
    ----------
    path : str
    own : FitParameter
        With its interval.
    library : EntryNumber
    said : str
        "alike" where the interval of the unit meets that of the library, or the band in which units
        are expected, or sessions of the one unit that is known; "differs" where it meets none of
        them; "beyond the interval" where it does not, and nobody knows what differs from unit to
        unit; "not determined" where the recordings do not tell the number.
    """

    path: str
    own: FitParameter
    library: EntryNumber
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
class UnitComparison:
    """A unit beside an entry.

    Attributes
    ----------
    entry : Entry
    result : FitResult
        Of the plant of the entry, fitted to the recordings.
    numbers : tuple of UnitNumber
    seconds : float
        That were recorded.
    held : tuple of str
        Effects of the drive whose numbers stay as they are in the entry.
    kept, fitted : float
        What is left unexplained as a share of the effort, of a servo of the motion (2-norm): with
        friction and effects of the entry on the body of the unit, and as fitted.
    """

    entry: Entry
    result: FitResult
    numbers: tuple[UnitNumber, ...]
    seconds: float
    held: tuple[str, ...] = ()
    kept: float = math.nan
    fitted: float = math.nan

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
        parts = [f"{commas(e.path for e in group)}: {word}" for word, group in groups if group]
        name, many = self.entry.name, plural(len(own), "number")
        first = (
            f"differs from {name}: {'; '.join(parts)}" if parts else f"agrees with {name} in {many}"
        )
        load = [each.path for each in told if each.carried and each.said != "alike"]
        told_all = f"{first}; what it carries differs: {commas(load)}" if load else first
        if parts and self.hardly_more:
            return (
                f"{told_all}; but the entry as it is leaves hardly more: these recordings do not "
                "tell such numbers apart, record other motions"
            )
        return told_all

    @property
    def hardly_more(self) -> bool:
        """Whether friction and effects of the entry explain the recordings nearly as well."""
        return self.kept < NEARLY * self.fitted

    @property
    def left(self) -> str:
        """What the entry leaves unexplained in the recordings, and its plant fitted, in words."""
        by = comparison_of(self.result.plant)
        kept, fitted = by.share(self.kept, 3), by.share(self.fitted, 3)
        return f"{by.error}: {kept} with numbers of the entry, {fitted} with those of the unit"

    def __str__(self) -> str:
        rows = [("number", "your unit", "library", "interval", "95 % are in", "unit", "")]
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
                    "none stated" if library.ci95 is None else span(library.ci95),
                    library.expected,
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
            [
                head,
                self.message,
                self.left,
                "",
                *table,
                *stays,
                *(f"  {s}" for s in self.result.remarks),
            ]
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
            "hardly_more": self.hardly_more,
            "kept": self.kept,
            "fitted": self.fitted,
            "numbers": {each.path: each.to_dict() for each in self.numbers},
            "fit": self.result.to_dict(),
        }

    def to_json(self) -> str:
        """Everything as JSON."""
        return json_of(self.to_dict())


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


def compare(entry: Entry, session: Session | Recording | Sequence[Recording]) -> UnitComparison:
    """Fit recordings of a unit from where an entry stands, and put both side by side.

    Parameters
    ----------
    entry : Entry
    session : Session, Recording or sequence of Recording
        The plant of a session, where it has one, says how the unit is driven and read and what it
        carries; law, effects and where the fit starts are those of the entry.

    Returns
    -------
    UnitComparison

    Raises
    ------
    InputError
        As for ``stiction.fit``; a plant that moves another way than the entry.
    """
    given.instance(entry, Entry, "compare: entry", "an entry, as stiction.library.entry returns it")
    stated = session.plant if isinstance(session, Session) else None
    plant, held = fix_drive(plant_like(entry, stated))
    result = fit(plant, session)
    inertia = result.parameters.get("body.inertia")
    lost = inertia is not None and inertia.at_bound == "lower"
    numbers = tuple(
        UnitNumber(
            path, each, entry.numbers[path], LOST if lost else verdict_of(each, entry.numbers[path])
        )
        for path, each in result.parameters.items()
        if path in entry.numbers
    )
    recordings = recordings_of(session, "compare")
    seconds = sum(each.duration for each in recordings)
    own = _Left(recordings, result)
    kept = min(own.share(replace(plant, body=b)) for b in _bodies(plant, result, session))
    fitted = own.share(result.plant)
    return UnitComparison(entry, result, numbers, seconds, held, kept, fitted)


def fix_drive(plant: Plant) -> tuple[Plant, tuple[str, ...]]:
    """A plant whose drive stays as it is, and the names of effects that are held for it.

    Along a measured motion a drive that gives nothing leaves nothing. The loop of a servo does not
    follow such a drive: there they are fitted.
    """
    held = [e.name for e in plant.effects if "input map" in e.record.hooks and not plant.servo]
    effects = (
        replace(each, parameters=_fixed(each.parameters)) if each.name in held else each
        for each in plant.effects
    )
    return replace(plant, effects=tuple(effects)), tuple(held)


def _bodies(
    plant: Plant, result: FitResult, session: Session | Recording | Sequence[Recording]
) -> list[Mapping[str, Parameter]]:
    """What a unit may carry: as stated, as fitted with all numbers, and beside those of the entry.

    Which of them suits the entry best hangs on how much of the body is that of the motor.
    """
    found = [plant.body, result.plant.body]
    held = replace(
        plant,
        drive={n: p.value if isinstance(p, Parameter) else p for n, p in plant.drive.items()},
        friction=replace(plant.friction, parameters=_fixed(plant.friction.parameters)),
        effects=tuple(replace(e, parameters=_fixed(e.parameters)) for e in plant.effects),
    )
    # Friction of another machine may leave this one no motion at all.
    with suppress(InputError):
        if free_paths(held) and not result.interrupted:
            found.append(fit(held, session).plant.body)
    return [body for body in found if "inertia" in body or plant.prescribed_motion]


class _Left:
    """What plants leave unexplained in recordings, of the effort or of a servo's motion.

    All are seen through the kernels that the fitted plant asks for, and without the rows in which
    something else moved it.
    """

    def __init__(self, recordings: Sequence[Recording], result: FitResult) -> None:
        self._recordings = recordings
        names = names_of(list(recordings))
        self._begins = [begin_of(result.begins.get(name)) for name in names]
        self._supports: list[float | None] = [None] * len(recordings)
        if not result.plant.servo:
            self._supports = [each.support for each in self._efforts(result.plant)]
        rest, whole = self._residual(result.plant)
        self._usual = np.abs(rest) <= PUSHED * float(np.median(np.abs(rest)))
        self._size = float(np.linalg.norm(whole[self._usual]))

    def share(self, plant: Plant) -> float:
        """2-norm of the residual over that of all; infinite where a loop ran away."""
        size = float(np.linalg.norm(self._residual(plant)[0][self._usual]))
        return size / self._size if math.isfinite(size) and self._size > 0.0 else math.inf

    def _residual(self, plant: Plant) -> tuple[FloatArray, FloatArray]:
        with np.errstate(all="ignore"):
            if plant.servo:
                runs = [
                    free_run(plant, recording, **begin)
                    for recording, begin in zip(self._recordings, self._begins, strict=True)
                ]
                pairs = [(r.simulated - r.measured, r.measured - np.mean(r.measured)) for r in runs]
            else:
                pairs = [(each.residual, each.effort) for each in self._efforts(plant)]
        rest, whole = (np.concatenate(parts) for parts in zip(*pairs, strict=True))
        return rest, whole

    def _efforts(self, plant: Plant) -> list[EffortResidual]:
        given = zip(self._recordings, self._supports, self._begins, strict=True)
        return [effort_residual(plant, each, support=width, **b) for each, width, b in given]


def _fixed(parameters: Mapping[str, Parameter]) -> dict[str, Parameter]:
    return {name: replace(each, fixed=True) for name, each in parameters.items()}


def verdict_of(own: FitParameter, library: EntryNumber) -> Said:
    """What is to be said of two numbers."""
    low, high = own.ci95
    if not (math.isfinite(low) and math.isfinite(high)) or own.at_bound:
        return "not determined"
    spread = library.band
    every = (library.ci95, spread, library.within, (library.value,) * 2)
    known = [ends for ends in every if ends is not None]
    least, most = min(ends[0] for ends in known), max(ends[1] for ends in known)
    if low <= most and least <= high:
        return "alike"
    return "beyond the interval" if spread is None else "differs"
