"""Rows of a recording that are fitted, and what a recording brings along beside the plant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from copy import copy
from dataclasses import dataclass, field, replace
from typing import Any, Final

import numpy as np

from .._support.arrays import FloatArray
from ..catalogue import ParameterRecord, effects
from ..errors import NotEnoughData
from ..plant import Plant
from ..recording import Part, Recording
from ..recording.checks.clock import LOST, usual_steps
from ..residual.weak_form import WeakForm
from .statistics import CORRELATED_S

__all__ = [
    "TURNS",
    "Mask",
    "Nuisances",
    "Push",
    "Rows",
    "Start",
    "add_starts",
    "count_by",
    "numbers",
    "require_motion",
    "rows_of",
    "start_guess",
    "start_quantities",
    "timing_bound",
    "timing_is_free",
]

WARM_UP_S: Final = 0.2
"""Left out at the start of a recording: what the fitted start does not tell is forgotten then."""
TIMING_SHARE: Final = 0.5
"""Bound of the timing offset in samples: more than this is a delay of the machine."""
INSIDE: Final = 0.98
"""A timing offset beyond this share of its bound is held by the bound."""
TURNS: Final = ("turned", "turned_again")
"""Start quantities of springs with memory: where the contact turned round before. No row tells of
them beside a contact that never did; see `fit_turns` of the starts."""
TOLD: Final = 0.01
"""A start quantity is fitted where it changes any row by this share of the residual."""
GAP_SHARE: Final = 0.25
"""Share of the kernel from which on a gap between two stamps counts: over the distance of its knots
the motion in between is anybody's guess, shorter ones it averages."""

Mask = np.ndarray[Any, np.dtype[np.bool_]]
Start = dict[str, float]


@dataclass(frozen=True)
class Nuisances:
    """What is fitted along and belongs to recordings, not to the machine.

    Attributes
    ----------
    timing : float
        By how much the input is stamped early, s; one for all recordings.
    starts : Mapping of int to dict
        Friction state at the first row, by the index of the recording.
    leader : Plant or None
        Of whose motion windows begin (see ``ShootingForm``); None for that of their form.
    """

    timing: float = 0.0
    starts: Mapping[int, Start] = field(default_factory=dict)
    leader: Plant | None = None

    def start(self, index: int) -> Start | None:
        """Start of a recording, None where it was never moved as far as anybody knows."""
        return self.starts.get(index) or None

    def of(self, recordings: Set[int]) -> Nuisances:
        """The same with the starts of these recordings alone."""
        starts = {index: start for index, start in self.starts.items() if index in recordings}
        return replace(self, starts=starts)

    def merge(self, others: Nuisances) -> Nuisances:
        """The same with the starts of others where it has none."""
        return replace(self, starts={**others.starts, **self.starts})


class Rows:
    """One recording through a kernel, and which of its rows count.

    Attributes
    ----------
    form : WeakForm
    index : int
        Of the recording in its session.
    mask : numpy.ndarray of bool, shape (n,)
    weight : float
    late : numpy.ndarray, shape (n,)
        Derivative of the measured effort by the timing offset, 1/s.
    per_block : int
        Rows over which residuals are taken as correlated.
    """

    def __init__(self, plant: Plant, form: WeakForm, index: int, mask: Mask) -> None:
        self.form, self.index, self.mask = form, index, mask
        self.weight = 1.0
        self.late = form.late(plant)
        self.per_block = max(1, round(CORRELATED_S / (form.dt * form.stride)))

    def of(self, mask: Mask) -> Rows:
        """The same with others of its rows."""
        other = copy(self)
        other.mask = mask
        return other

    def with_input(self, given: FloatArray) -> Rows:
        """The same of a recording with another input; see ``WeakForm.with_input``."""
        other = copy(self)
        other.form = self.form.with_input(given)
        return other

    def with_leader(self, nuisances: Nuisances) -> Rows:
        """The same with windows that begin as they did for a plant with these nuisances."""
        other = copy(self)
        other.form = self.form.with_leader(nuisances.leader)
        return other

    def form_for(self, plant: Plant, nuisances: Nuisances) -> WeakForm:
        """The recording as a plant has to be driven along it, from where its windows begin."""
        return self.form.for_plant(plant).with_leader(nuisances.leader)

    def residual(self, plant: Plant, nuisances: Nuisances) -> FloatArray:
        """Measured minus needed effort of every row, times ``scale``; shape (n,)."""
        left = self.form_for(plant, nuisances).residual(plant, nuisances.start(self.index))
        found: FloatArray = self.scale(plant) * (left + nuisances.timing * self.late)
        return found

    def scale(self, plant: Plant) -> float:
        """What an effort that is left counts for: 1, but where friction grows with the effort.

        Where a machine drives all the time, (1 − c)·u = J·x'' + F holds for any share c that
        friction has of the effort u, with J and F scaled along; measured effort that is left is
        least where all is friction and nothing is explained. The effort is no dependent variable
        there. So the acceleration is: what is left over J, times an inertia that stays
        (``counted`` of the form).
        """
        counted = self.form.counted
        if counted is None or not plant.friction_by_motor or self.form.simulated:
            return 1.0
        own = self.form.own(plant).inertia
        return counted / own if own > 0.0 else 1.0

    def jacobian(self, plant: Plant, paths: Sequence[str], nuisances: Nuisances) -> FloatArray:
        """Derivatives of the residual by parameters and start quantities; shape (n, paths).

        What the plant leaves open and follows a parameter moves with it.
        """
        follows = plant.following(paths)
        every = [*paths, *(path for path, _, _ in follows)]
        form = self.form_for(plant, nuisances)
        found = form.jacobian(plant, every, nuisances.start(self.index))
        columns = found[:, : len(paths)]
        scale = self.scale(plant)
        if scale != 1.0:
            found *= scale
            if "body.inertia" in paths:
                left = self.residual(plant, nuisances) / form.own(plant).inertia
                columns[:, list(paths).index("body.inertia")] -= left
        for column, (_, place, factor) in enumerate(follows, len(paths)):
            columns[:, place] += factor * found[:, column]
        return columns


def count_by(plant: Plant, forms: Sequence[WeakForm]) -> None:
    """Counts accelerations by the inertia of a plant, where that matters (see ``Rows.scale``)."""
    for form in forms:
        form.counted = None if form.prescribed else form.own(plant).inertia


def warm(form: WeakForm, recording: Recording) -> Mask:
    """Rows after the warm-up."""
    after: Mask = form.time >= recording.time[0] + WARM_UP_S
    return after


@dataclass(frozen=True)
class Push:
    """A time in which something else than the drive moved the machine.

    Attributes
    ----------
    recording : int
        Index in the session.
    start, end : float
        s since the first row of the recording.
    sure : bool
        Rows alike elsewhere show that it was not the machine.
    """

    recording: int
    start: float
    end: float
    sure: bool = True

    def words(self) -> str:
        """That in words."""
        return f"{self.what} from {self.when()}"

    @property
    def what(self) -> str:
        """What happened, as far as it is sure."""
        unsure = "" if self.sure else ", or it does there what it does nowhere else,"
        return f"something pushed the machine{unsure}"

    def when(self) -> str:
        """When."""
        return f"{self.start:.1f} s to {self.end:.1f} s"


def require_motion(rows: Sequence[Rows], plant: Plant) -> None:
    """Refuse rows that tell nothing of a machine.

    A contact without a spring that rests in all of them holds whatever acts on it, so that every
    plant leaves nothing: of readings that are noise alone it would be a perfect one. One that
    yields would be led by that noise.

    Parameters
    ----------
    rows : sequence of Rows
        That are to be fitted.
    plant : Plant
        To which they are to be compared.

    Raises
    ------
    NotEnoughData
    """
    if not rows:
        raise NotEnoughData("no rows are left to fit after the warm-up; give longer recordings")
    seen = [(each.form.for_plant(plant), each.mask) for each in rows]
    if not any(np.any(form.noisy_rows[mask]) and form.stirs for form, mask in seen):
        raise NotEnoughData(
            "nothing moves beyond the noise of its position in the rows to fit; record a motion, "
            "or check which column is position"
        )


def rows_of(
    form: WeakForm,
    recording: Recording,
    index: int,
    parts: Sequence[Part],
    pushes: Sequence[Push] = (),
) -> Mask:
    """Rows of a form that lie in these parts, the warm-up, pushes and gaps left out."""
    chosen = np.zeros(len(form), dtype=bool)
    for part in parts:
        if part.recording == index:
            first, last = recording.time[part.start], recording.time[part.stop - 1]
            chosen |= (form.time >= first) & (form.time <= last)
    for push in pushes:
        if push.recording == index:
            time = form.time - recording.time[0]
            chosen &= (time < push.start) | (time > push.end)
    for start, end in _gaps(recording.time, form.kernel.support):
        chosen &= (form.time < start) | (form.time > end)
    return chosen & warm(form, recording)


def _gaps(time: FloatArray, support: float) -> list[tuple[float, float]]:
    """Between which centres a kernel would see a gap of the stamps, s.

    Or a window would start at its end, at a speed that is none of the machine's.
    """
    steps = np.diff(time)
    # Rows of a logger that goes on at a slower rate are far apart, and nothing is lost.
    long = np.flatnonzero(steps > np.maximum(GAP_SHARE * support, LOST * usual_steps(steps)))
    before, after = 0.5 * support, (0.5 + GAP_SHARE) * support
    return [(float(time[k]) - before, float(time[k + 1]) + after) for k in long]


def numbers(plant: Plant) -> dict[str, ParameterRecord]:
    """Start quantities without a unit: their size and their bounds are those of the catalogue."""
    return {each.name: each for each in plant.friction.record.start if each.unit == "1"}


def start_quantities(plant: Plant) -> tuple[str, ...]:
    """Names of what the law of a plant remembers from before a recording."""
    return tuple(quantity.name for quantity in plant.friction.record.start)


def start_guess(plant: Plant, form: WeakForm) -> Start:
    """Where the start of a recording is looked for: a measured effort tells the force."""
    force = float(form.effort[0]) if form.prescribed else 0.0
    return {name: force if name == "force" else 0.0 for name in start_quantities(plant)}


def timing_bound(plant: Plant, rows: Sequence[Rows]) -> float:
    """Greatest timing offset, s: half a sample, or 0 where the plant has a delay of its own.

    Both at once would be one number twice: then the delay holds the whole of it.
    """
    late = {record.name for record in effects() if record.late}
    if any(effect.name in late for effect in plant.effects):
        return 0.0
    return TIMING_SHARE * min(each.form.dt for each in rows)


def timing_is_free(timing: float, plant: Plant, rows: Sequence[Rows]) -> bool:
    """Whether an offset of timing that was fitted is not held by its bound."""
    return abs(timing) < INSIDE * timing_bound(plant, rows)


def add_starts(plant: Plant, rows: Sequence[Rows], nuisances: Nuisances | None = None) -> Nuisances:
    """Nuisances with a start, as begun if it was not there, for all that the rows tell of."""
    before = nuisances or Nuisances()
    new = {each.index: start_guess(plant, each.form) for each in rows}
    starts: dict[int, Start] = {}
    for index, name in observable_starts(plant, rows, before.leader):
        known = new[index] | (before.start(index) or {})
        starts.setdefault(index, {})[name] = known[name]
        starts[index] |= {turn: known[turn] for turn in TURNS if known.get(turn)}
    return replace(before, starts=starts)


def observable_starts(
    plant: Plant, rows: Sequence[Rows], leader: Plant | None = None
) -> list[tuple[int, str]]:
    """Starts that the rows tell of: index of the recording and quantity."""
    names = start_quantities(plant)
    if not names:
        return []
    told = []
    starts = {each.index: dict.fromkeys(names, 0.0) for each in rows}
    virgin = Nuisances(starts=starts, leader=leader)
    for each in rows:
        left = each.residual(plant, virgin)[each.mask]
        columns = each.jacobian(plant, [f"start.{name}" for name in names], virgin)[each.mask]
        size = float(np.sqrt(np.mean(left**2)))
        # A quantity in its own unit: what it may do is its slope times a typical size.
        scales = {"force": float(np.sqrt(np.mean(each.form.effort**2)))}
        scales |= {name: own.typical for name, own in numbers(plant).items()}
        for name, column in zip(names, columns.T, strict=True):
            typical = scales.get(name, 0.1 * float(np.ptp(each.form.position)))
            if np.max(np.abs(column)) * typical > TOLD * size:
                told.append((each.index, name))
    return told
