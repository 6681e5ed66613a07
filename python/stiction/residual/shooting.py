"""Shooting over short horizons: where a plant gets to by itself, against what was measured."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from .._support.arrays import FloatArray
from ..catalogue import effects
from ..errors import InputError
from ..recording.motion import GAUSSIAN
from .accompanied import nearby_motion
from .weak_form import Candidate, Places, Start, WeakForm

if TYPE_CHECKING:
    from ..plant import Plant
    from ..recording import Recording

__all__ = ["MOST_OVERLAP", "ShootingForm"]

MOST_OVERLAP: Final = 4.0
"""Windows that overlap at any moment, at most: the kernel is a cubic spline with knots a quarter of
its support apart, and rows closer than those tell little more."""
RESPONSE_PARTS: Final = 16
"""Parts of a window whose efforts are told apart for screening: four to a knot of the kernel."""
READ_AGAIN: Final = 11
"""Seed of the noise with which a motion is read again: always the same."""
STARTED: Final = 8
"""Readings of one motion from which its windows are begun, to see what errors of the start do."""
DECIDED: Final = 3.0
"""Times the usual size that errors of the start may come to in a window before it counts less."""
MOST_LED: Final = 2
"""Plants by whose motion windows begin at a time, beside the first one: each holds its motion."""
MOVES_TIMES: Final = 2.0
"""Counts, or four times as many standard deviations of the white noise, that a machine must travel
within a horizon to be moving."""


class ShootingForm(WeakForm):
    """A recording cut into overlapping windows, in each of which a plant is simulated.

    Where the encoder is coarse, friction that is driven by the measured motion is wrong: while the
    reading stands still the machine moves within a count, pre-sliding is over after a few, and a
    dry contact turns round with the reading. Errors of the readings are then errors of the
    regressors, which bend every fit (errors in variables). Here the plant's own motion drives its
    friction, and errors of the readings are noise of the output alone. Each window starts at the
    smoothed measured position and velocity, with friction, effects and clock as they are after
    following the measured motion up to there, and runs with the measured input over the support
    of the kernel. The measured motion is smoothed once more by a run of the plant that is drawn to
    it (see ``nearby_motion``): a rigid contact stops where a machine would, and within a count one
    that yields does so as far as its effort takes it. The residual is

        r = J₀·K''∗x̂ − J₀·K''∗x,

    x̂ simulated and x as it was read. Since J·x̂'' is what drive, load and gravity leave after
    friction, this is the residual of the weak form with K∗F of the plant's own motion: measured
    minus needed effort, with the same sign. J₀ is no parameter: counted by the inertia of a trial,
    noise of the readings would pull that down, and a plant without any would leave nothing. K''
    takes out what is linear in time, so position and velocity at the start need no fit. (Multiple
    shooting: H. G. Bock, in Modelling of Chemical Reaction Systems, Springer (1981).)

    A machine at rest leaves next to nothing whatever it lacks: within a count it shows nothing.

    Parameters
    ----------
    plant : Plant
        For its drive and sensor; no prescribed motion.
    recording : Recording
        With position and input.
    horizon : float
        Length of a window, which is the support of the kernel, s.
    overlap : float, optional
        Windows at any moment.

    Attributes
    ----------
    moves : numpy.ndarray of bool, shape (n,)
        Windows in which the machine was seen to move.
    white : float
        Noise of the readings beside their rounding, rad or m.
    unit : float or numpy.ndarray, shape (n,)
        Inertia J₀ by which accelerations count as efforts; 1 as long as no plant states one. Less
        in windows that the errors of their starts decide.

    Raises
    ------
    InputError
        As for ``WeakForm``.
    """

    simulated: ClassVar[bool] = True

    def __init__(
        self, plant: Plant, recording: Recording, *, horizon: float, overlap: float = MOST_OVERLAP
    ) -> None:
        self.unit: float | FloatArray = 1.0
        super().__init__(plant, recording, support=horizon, every=horizon / overlap)
        self._begin_with(plant)
        self.white = float(np.sqrt(max(self.noise**2 - self.count**2 / 12.0, 0.0)))
        least = MOVES_TIMES * max(self.count, 4.0 * self.white)
        self.moves = np.abs(self.velocity) * self.kernel.support > least

    def go_by(self, plant: Plant) -> None:
        """Counts accelerations by the inertia of a plant, and starts windows from its runs.

        A contact near the effort at which it breaks away does so in a window, or not, as the
        readings at its start fall: what is left there says nothing of the plant, and may be a
        thousand times what is left elsewhere. Such windows count less, by as much as readings
        alone leave more of them than usual.
        """
        self._begin_with(plant)
        if self.leads:
            self.unit = self.unit * self._weights(plant)

    def _weights(self, plant: Plant) -> FloatArray:
        """Weight of every window, 1 of most, by what errors of its start come to; shape (n,).

        1 of all where no run of the plant is kept near the readings.
        """
        left = self.residual(plant)
        try:
            alone = self.from_readings_alone(plant, number=STARTED)
        except InputError:
            return np.ones(len(self))
        sizes = np.sqrt(np.mean(np.square(alone), axis=0))
        if not (self.moves.any() and np.isfinite(sizes).all() and np.isfinite(left).all()):
            return np.ones(len(self))
        readings, rest = sizes[self.moves], np.abs(left[self.moves])
        usual = max(float(np.median(readings)), GAUSSIAN * float(np.median(rest)))
        most = max(DECIDED * usual, np.finfo(float).tiny)
        weights: FloatArray = most / np.maximum(sizes, most)
        return weights

    def _begin_with(self, plant: Plant) -> None:
        """Leader and inertia, all windows alike."""
        stated = "inertia" in plant.body
        self.unit = self.own(plant).inertia if stated else 1.0
        if stated:
            self.lead(plant)

    @property
    def adapts(self) -> bool:
        """Always: readings tell no more than where a window starts, and no contact rests there."""
        return True

    @property
    def inertial(self) -> FloatArray:
        """J₀·K''∗x: what a machine leaves that goes on as it set out; shape (rows,)."""
        return self.unit * self.acceleration

    @property
    def noisy_rows(self) -> np.ndarray[Any, np.dtype[np.bool_]]:
        """Rows that noise of the effort reaches: a machine at rest keeps it to itself."""
        return self.moves

    def efforts(self, plant: Plant, start: Start = None) -> tuple[FloatArray, FloatArray]:
        """Measured effort, and what the plant needs to get where the machine got; shape (n,) each.

        NaN where the plant cannot be simulated at this sample time (see ``Motor.simulate``).
        """
        measured = self.measured_effort(plant)
        return measured, measured - self.residual(plant, start)

    def residual(self, plant: Plant, start: Start = None) -> FloatArray:
        """Measured minus needed effort of every row; NaN as for ``efforts``."""
        return self.unit * self._missed(plant, start)

    def late(self, plant: Plant) -> FloatArray:
        """As for the weak form where the machine moves; at rest a timing offset shows nothing."""
        return np.where(self.moves, super().late(plant), 0.0)

    def jacobian(self, plant: Plant, paths: Sequence[str], start: Start = None) -> FloatArray:
        """Derivatives of measured minus needed effort by parameters; shape (n, parameters).

        Exact, along the simulated motion; start quantities as in ``WeakForm``. 0 where the plant
        cannot be simulated.
        """
        wanted = list(paths)
        motor = self.start_motor(plant, self.position)
        try:
            moved = motor.shoot_sensitivity(
                self.motion, self.kernel.second, self.stride, wanted, start=start, strict=False
            )
        except InputError:
            return np.zeros((len(self), len(wanted)))
        columns: FloatArray = (self.unit * moved).T
        return columns

    def signatures(
        self,
        plant: Plant,
        candidates: Sequence[Candidate],
        start: Start = None,
        kept: Places | None = None,
    ) -> FloatArray:
        """Derivatives of measured minus needed effort by the gains of effects that are not there.

        Of first order in two places: what an effect adds is taken along the measured motion, as in
        the weak form, and how the simulated motion answers to an effort along its own, in 16 parts
        of a window. A machine at rest answers to nothing. That is enough to screen by; a refit is
        exact. 0 where the plant cannot be simulated.

        Parameters and return value are those of ``WeakForm.signatures``.
        """
        weights, wanted = self.kernel.second, list(candidates)
        number = min(RESPONSE_PARTS, len(weights))
        motor = self.start_motor(plant, self.position)
        try:
            found = motor.shoot_signatures(
                self.motion, weights, self.stride, wanted, number, start=start, strict=False
            )
        except InputError:
            gains = {record.name: len(record.gains) for record in effects()}
            found = np.zeros((sum(gains[name] for name, _ in wanted), len(self)))
        columns: FloatArray = (self.unit * found).T
        return columns if kept is None else columns[kept]

    def residual_for(
        self, plant: Plant, start: Start, readings: FloatArray, load: FloatArray
    ) -> FloatArray:
        """Residual of other readings under another load; shape (n,).

        Parameters
        ----------
        plant : Plant
        start : dict or None
        readings : numpy.ndarray, shape (rows,)
            Of the position.
        load : numpy.ndarray, shape (rows - 1,)
            Beside the recorded input.
        """
        motion = self.driving_motion(readings, load)
        got = self._shot(plant, start, motion, load)
        missed: FloatArray = self.unit * (got - self.accelerations(readings))
        return missed

    def from_readings_alone(
        self, plant: Plant, start: Start = None, *, number: int = 1
    ) -> list[FloatArray]:
        """Residuals that noise and rounding of the position leave a right plant; shape (n,) each.

        Of one motion that is read ``number`` times, after the first time with counts that stand
        elsewhere.
        """
        motion, load = nearby_motion(self, plant, start)
        source = np.random.default_rng(READ_AGAIN)
        found = []
        for k in range(number):
            readings = motion + self.white * source.standard_normal(len(motion))
            if self.count > 0.0:
                phase = self.count * source.uniform() if k else 0.0
                readings = np.round((readings + phase) / self.count) * self.count - phase
            found.append(self.residual_for(plant, start, readings, load))
        return found

    def _missed(self, plant: Plant, start: Start) -> FloatArray:
        """Acceleration of the simulated motion beyond the measured one, through the kernel."""
        return self._shot(plant, start, self.position, self.load[:-1]) - self.acceleration

    def _shot(self, plant: Plant, start: Start, motion: FloatArray, load: FloatArray) -> FloatArray:
        """Acceleration of the simulated motion of each window, through the kernel."""
        motor = self.start_motor(plant, motion)
        try:
            moved = self.with_motion(motion, load=load)
            return motor.shoot(moved, self.kernel.second, self.stride, start=start, strict=False)
        except InputError:
            # A trial of a fit that is too stiff for the sample time: it must look bad, not end it.
            return np.full(len(self), np.nan)
