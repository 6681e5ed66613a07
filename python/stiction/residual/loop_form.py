"""The residual of a servo: its loop simulated from the goal alone, beside what was measured."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, Final

import numpy as np

from .._support.arrays import FloatArray
from ..catalogue import EffectRecord, effects
from ..errors import InputError
from ..plant import Plant
from ..plant.parameter import Parameter
from ..plant.stated import Effect
from ..recording.motion import GAUSSIAN, evenly, smooth
from .effort import started, starting_velocity
from .weak_form import Candidate, Places, Start, WeakForm

if TYPE_CHECKING:
    from ..motor import Motor
    from ..recording import Recording

__all__ = ["LoopForm"]

EVEN: Final = 1e-6
"""Steps that differ by less, as a share of the usual one, are alike."""
RAN_AWAY: Final = 1e12
"""Positions and their derivatives beyond this are those of a loop that runs away."""
TRIED: Final = frozenset({"second mass", "input rate"})
"""Hooks of effects whose slope at their neutral point tells nothing of them: of a second mass there
is none, and a goal that is barely held back differs for one sample after a step."""


class LoopForm(WeakForm):
    """A recording of a servo, simulated as a whole.

    The effort of a servo is what its own law makes of goal and position: a law that is late or
    limited where nobody knows makes an effort that never was, and along the measured motion that
    error cannot be told from friction. Simulated, the loop holds itself together, so a whole
    recording can be compared. The residual is the effort by which the servo would pull the
    simulated position to the measured one, K·(x − x̂), K = k·P·V/R of the plant as it stands: the
    same for all recordings, whatever gains they were made with.

    Parameters and attributes are those of ``WeakForm``; rows are the sample ends.
    """

    simulated: ClassVar[bool] = True

    def __init__(self, plant: Plant, recording: Recording) -> None:
        super().__init__(plant, recording)
        self.stiffen(plant)
        # A reading that failed for one sample is no noise of all the others, nor is a fast motion.
        third = np.abs(np.diff(self.readings, 3))
        white = GAUSSIAN * float(np.median(third)) / np.sqrt(20.0) if len(third) else 0.0
        self.noise = max(white, self.count / np.sqrt(12.0))
        self.steps = self.dt if self._even is None else np.diff(self.stamps)
        self.velocity_at_start = starting_velocity(self.stamps, self.readings, self.count)
        self.stride = 1
        self.time = self.stamps[1:]

    def for_plant(self, plant: Plant) -> LoopForm:
        """As it is: the simulated motion drives friction."""
        return self

    @staticmethod
    def timestamps(time: FloatArray) -> tuple[FloatArray, FloatArray, float]:
        """Even ones where the rows are those of a timer; else those of the rows themselves.

        A goal that is held to the next even stamp comes half a sample late, and a simulated loop
        has no kernel that would ask for even ones. Where rows are missing some are put in between.
        """
        stamps, even, usual = evenly(time)
        if stamps is not time:
            return stamps, even, usual
        parts = np.maximum(np.round(np.diff(time) / float(np.median(np.diff(time)))), 1.0)
        place = np.concatenate([[0.0], np.cumsum(parts)])
        rows = np.interp(np.arange(int(place[-1]) + 1), place, time)
        return time, rows, float(rows[-1] - rows[0]) / (len(rows) - 1)

    def stiffen(self, plant: Plant) -> None:
        """Takes the stiffness K of a plant as it stands, whatever a recording was set to."""
        drive = plant.drive
        self.stiffness: float = abs(
            plant.gain * drive["proportional"] * drive["supply_v"] / drive["resistance_ohm"]
        )

    @property
    def flickers(self) -> bool:
        """Never: friction is driven by the simulated motion, which has no noise."""
        return False

    @cached_property
    def lateness(self) -> float:
        """0, for the same reason."""
        return 0.0

    @cached_property
    def _even(self) -> FloatArray | None:
        """As many even stamps over the same time; None where those of the rows are even."""
        if np.ptp(np.diff(self.stamps)) <= EVEN * self.dt:
            return None
        return np.linspace(self.stamps[0], self.stamps[-1], len(self.stamps))

    def _seen(self, smoothed: Callable[[FloatArray], FloatArray], values: FloatArray) -> FloatArray:
        """What a kernel, which is as wide in samples everywhere, makes of values at the rows."""
        if self._even is None:
            return smoothed(values)
        made = smoothed(np.interp(self._even, self.stamps, values))
        seen: FloatArray = np.interp(self.stamps, self._even, made)
        return seen

    def driving_motion(self, readings: FloatArray, load: FloatArray | None = None) -> FloatArray:
        """The motion that views look at, from readings of a position; same shape."""
        return self._seen(super().driving_motion, readings)

    def velocities(self, position: FloatArray) -> FloatArray:
        """Velocity of a position at the sample ends, shape (n,)."""
        slope: FloatArray = np.gradient(position, self.dt if self._even is None else self.stamps)
        return slope[1:]

    def accelerations(self, readings: FloatArray, driving: FloatArray | None = None) -> FloatArray:
        """Acceleration of a position at the sample ends, through the kernel, shape (n,)."""
        half = self.kernel.half

        def bent(values: FloatArray) -> FloatArray:
            padded = np.pad(values, half, "reflect", reflect_type="odd")
            return self.kernel.second_derivative(padded)

        return self._seen(bent, readings)[1:]

    def measured_effort(self, plant: Plant) -> FloatArray:
        """Effort that the drive gives along the measured motion; shape (n,)."""
        return self._driven(plant, self.input)

    def whole(self, plant: Plant) -> FloatArray:
        """The motion, counted as the residual is: a loop explains where the servo goes."""
        moved: FloatArray = self.stiffness * (self.readings[1:] - np.mean(self.readings))
        return moved

    def efforts(self, plant: Plant, start: Start = None) -> tuple[FloatArray, FloatArray]:
        """Measured effort, and that less the residual; shape (n,) each."""
        measured = self.measured_effort(plant)
        return measured, measured - self.residual(plant, start)

    def residual(self, plant: Plant, start: Start = None) -> FloatArray:
        """The effort by which the servo would pull the simulated position to the measured one."""
        missed: FloatArray = self.stiffness * (self.readings[1:] - self.reaches(plant, start))
        return missed

    def reaches(self, plant: Plant, start: Start = None) -> FloatArray:
        """Simulated position at the sample ends, shape (n,); NaN where none is, or it runs away."""
        motor = self._begun(plant, start)
        try:
            run = motor.simulate(self.input, self.steps, **self.around, outputs=["position"])
        except InputError:
            # A trial of a fit that is too stiff for the sample time: it must look bad, not end it.
            return np.full(len(self.input), np.nan)
        return np.where(np.abs(run.position) < RAN_AWAY, run.position, np.nan)

    def late(self, plant: Plant) -> FloatArray:
        """What a later goal changes of the residual, per s: all that follows it is later too."""
        moved = self._seen(lambda read: smooth(read, self.dt, self.kernel.support), self.readings)
        return self.stiffness * self.velocities(moved)

    def noise_free_effort(self, plant: Plant) -> FloatArray:
        """Effort that the drive gives along the simulated motion; shape (n,).

        What a servo answers to the noise of its readings goes with that, and so does what is left.
        """
        reached = self.reaches(plant)
        there = np.where(np.isfinite(reached), reached, self.position[1:])
        motor = replace(self.own(plant), effects=()).follower()
        motor.reset(float(self.position[0]), 0.0)
        along = np.concatenate([self.position[:1], there])
        drive: FloatArray = motor.follow(self.with_motion(along), strict=False)[0]
        return drive

    def jacobian(self, plant: Plant, paths: Sequence[str], start: Start = None) -> FloatArray:
        """Derivatives of the residual by parameters, exact; shape (n, parameters).

        Start quantities are left as they are: their columns are 0.
        """
        columns = np.zeros((len(self), len(paths)))
        own = [place for place, path in enumerate(paths) if not path.startswith("start.")]
        motor = self._begun(plant, start)
        try:
            moved, _ = motor.sensitivity(
                self.input,
                self.steps,
                [paths[place] for place in own],
                strict=False,
                **self.around,
            )
        except InputError:
            return columns
        # Where a loop runs away its derivatives do so first, and say nothing.
        moved = np.where(np.abs(moved) < RAN_AWAY, moved, 0.0)
        columns[:, own] = -self.stiffness * moved.T
        return columns

    def signatures(
        self,
        plant: Plant,
        candidates: Sequence[Candidate],
        start: Start = None,
        kept: Places | None = None,
    ) -> FloatArray:
        """Derivatives of the residual by the gains of effects that are not there, exact.

        Effects at their neutral point change nothing, so a simulation carries several of them at
        once, one of a kind. What has no slope there to speak of is tried out at its typical size.

        Parameters and return value are those of ``WeakForm.signatures``.
        """
        records = {record.name: record for record in effects()}
        places, at = [], 0
        for name, _ in candidates:
            places.append(slice(at, at + len(records[name].gains)))
            at += len(records[name].gains)
        columns = np.zeros((len(self), at))
        left = self.residual(plant, start)
        for batch in _batches([name for name, _ in candidates]):
            smooth = [k for k in batch if TRIED.isdisjoint(records[candidates[k][0]].hooks)]
            with_them = _beside(plant, [candidates[k] for k in smooth], records)
            paths = [
                f"effects.{candidates[k][0]}.{gain}"
                for k in smooth
                for gain in records[candidates[k][0]].gains
            ]
            found = self.jacobian(with_them, paths, start)
            own = [place for k in smooth for place in range(places[k].start, places[k].stop)]
            columns[:, own] = found
            for k in set(batch) - set(smooth):
                columns[:, places[k]] = self._tried(plant, candidates[k], records, left, start)
        return columns if kept is None else columns[kept]

    def _tried(
        self,
        plant: Plant,
        candidate: Candidate,
        records: dict[str, EffectRecord],
        left: FloatArray,
        start: Start,
    ) -> FloatArray:
        """What an effect of typical size changes, per unit of its gain; 0 where it cannot be."""
        record = records[candidate[0]]
        typical = {each.name: each.typical for each in record.parameters}
        columns = []
        for gain in record.gains:
            size = typical[gain]
            there = _beside(plant, [candidate], records, {gain: size})
            changed = (self.residual(there, start) - left) / size
            columns.append(np.where(np.isfinite(changed), changed, 0.0))
        return np.column_stack(columns)

    def _mean(self, values: FloatArray) -> FloatArray:
        """As they are: nothing is averaged."""
        return values

    def _begun(self, plant: Plant, start: Start) -> Motor:
        begin = float(self.readings[0]), self.velocity_at_start
        return started(self.own(plant), *begin, start, clock=self.clock, path=self.path)


def _batches(names: Sequence[str]) -> list[list[int]]:
    """Places of candidates, in groups in which no effect comes twice."""
    seen: dict[str, int] = {}
    batches: list[list[int]] = []
    for place, name in enumerate(names):
        group = seen.get(name, 0)
        seen[name] = group + 1
        if group == len(batches):
            batches.append([])
        batches[group].append(place)
    return batches


def _beside(
    plant: Plant,
    candidates: Sequence[Candidate],
    records: dict[str, EffectRecord],
    gains: dict[str, float] | None = None,
) -> Plant:
    """A plant with effects of these shapes, neutral unless gains are given; others stay."""
    added = []
    for name, shape in candidates:
        values = {**dict.fromkeys(records[name].gains, 0.0), **(gains or {}), **shape}
        added.append(Effect(name, {each: Parameter(value) for each, value in values.items()}))
    return replace(plant, effects=(*plant.effects, *added))
