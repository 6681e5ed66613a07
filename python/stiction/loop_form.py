"""The residual of a servo: its loop simulated from the goal alone, beside what was measured."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from .errors import InputError
from .residual import started, starting_velocity
from .trajectory import FloatArray
from .weak_form import Start, WeakForm

if TYPE_CHECKING:
    from .motor import Motor
    from .plant import Plant
    from .recording import Recording

__all__ = ["LoopForm"]

RAN_AWAY: Final = 1e12
"""Derivatives of a position beyond this are those of a loop that runs away."""


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

    def __init__(self, plant: Plant, recording: Recording) -> None:
        super().__init__(plant, recording)
        drive = plant.drive
        self.stiffness = abs(
            plant.gain * drive["proportional"] * drive["supply_v"] / drive["resistance_ohm"]
        )
        stamps = recording.time[0] + self.dt * np.arange(len(self.readings))
        self.velocity_at_start = starting_velocity(stamps, self.readings, self.count)
        self.stride = 1
        self.time = stamps[1:]

    @property
    def velocity(self) -> FloatArray:
        """Velocity at the sample ends, shape (n,)."""
        slope: FloatArray = np.gradient(self.position, self.dt)[1:]
        return slope

    def measured(self, plant: Plant) -> FloatArray:
        """Effort that the drive gives along the measured motion; shape (n,)."""
        return self._driven(plant, self.input)

    def efforts(self, plant: Plant, start: Start = None) -> tuple[FloatArray, FloatArray]:
        """Measured effort, and that less the residual; shape (n,) each."""
        measured = self.measured(plant)
        return measured, measured - self.residual(plant, start)

    def residual(self, plant: Plant, start: Start = None) -> FloatArray:
        """The effort by which the servo would pull the simulated position to the measured one."""
        motor = self._begun(plant, start)
        try:
            reached = motor.simulate(
                self.input, self.dt, **self.around, outputs=["position"]
            ).position
        except InputError:
            # A trial of a fit that is too stiff for the sample time: it must look bad, not end it.
            reached = np.full(len(self.input), np.nan)
        missed: FloatArray = self.stiffness * (self.readings[1:] - reached)
        return missed

    def late(self, plant: Plant) -> FloatArray:
        """0: where goal and position are stamped hardly matters to a loop that is simulated."""
        return np.zeros(len(self))

    def jacobian(self, plant: Plant, paths: Sequence[str], start: Start = None) -> FloatArray:
        """Derivatives of the residual by parameters, exact; shape (n, parameters).

        Start quantities are left as they are: their columns are 0.
        """
        columns = np.zeros((len(self), len(paths)))
        own = [place for place, path in enumerate(paths) if not path.startswith("start.")]
        motor = self._begun(plant, start)
        try:
            moved, _ = motor.sensitivity(
                self.input, self.dt, [paths[place] for place in own], **self.around
            )
        except InputError:
            return columns
        # Where a loop runs away its derivatives do so first, and say nothing.
        moved = np.where(np.abs(moved) < RAN_AWAY, moved, 0.0)
        columns[:, own] = -self.stiffness * moved.T
        return columns

    def _begun(self, plant: Plant, start: Start) -> Motor:
        begin = float(self.readings[0]), self.velocity_at_start
        return started(self.own(plant), *begin, start)
