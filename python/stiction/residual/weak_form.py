"""The weak form of a plant along a recording: efforts and their derivatives through one kernel."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Final, Self, TypedDict

import numpy as np

from .._native import Motion, RowKernel
from .._support.arrays import FloatArray
from .._support.wording import NO_POSITION
from ..errors import InputError, NotEnoughData
from ..plant.drive import unscaled_unit
from ..recording.checks.signal import without_spikes
from ..recording.motion import (
    FEWEST_SAMPLES,
    SUPPORTS_S,
    WIDEST,
    Kernel,
    count_of,
    evenly,
    narrowest,
    noise_of,
    stirs,
    zero_order_hold,
)
from .accompanied import nearby_motion
from .driving import Driving

if TYPE_CHECKING:
    from ..motor import Motor
    from ..plant import Plant
    from ..recording import Recording

__all__ = ["Around", "Candidate", "Places", "Start", "WeakForm"]

Start = dict[str, float] | None
"""Friction state at the first row of a recording; None where it was never moved."""
Candidate = tuple[str, dict[str, float]]
"""An effect that may be missing, with the values of its shape parameters."""
Places = np.ndarray[Any, np.dtype[np.intp]]


class Around(TypedDict):
    """What acts beside the input; shapes (rows - 1,)."""

    load: FloatArray | None
    temperature: FloatArray | None
    enabled: FloatArray | None
    transmitted: FloatArray | None


NOISE_SHARE: Final = 0.02
"""The kernel is widened until the inertia term holds less position noise than this share of the
effort: a coarse encoder needs more than 30 ms."""
ACCELERATION_SHARE: Final = 0.1
"""Where no inertia is stated: share of the acceleration that may be noise."""

MOST_LED: Final = 2
"""Plants by whose motions friction is driven at a time, beside the first: each holds its own."""
_CACHED: Final = ("motion", "lateness", "_answers", "_known", "_otherwise", "_led", "stirs")
"""What is computed once from readings and effort."""
MOSTLY: Final = 0.9
"""Share of the kernel through which a machine with a rigid contact moves in rows that tell of
noise."""


class WeakForm:
    """A recording seen through a kernel, ready to be compared with a plant again and again.

    Everything that no parameter changes is computed once: even stamps, the motion that drives
    friction, the inertia term of a unit inertia.

    Parameters
    ----------
    plant : Plant
        For its kind of motion, drive and sensor.
    recording : Recording
        With position, and input or (for prescribed motion) effort.
    support : float, optional
        Width of the kernel in s. Without it the narrowest one from 30 ms on that keeps the
        position noise in the inertia term below 2 % of the effort.
    every : float, optional
        Spacing of the results in s; every sample without it.

    Attributes
    ----------
    time : numpy.ndarray, shape (n,)
        Centres of the kernel, s.
    acceleration : numpy.ndarray, shape (n,)
        rad/s² or m/s², through the kernel.
    kernel : Kernel
    stamps, readings, position : numpy.ndarray, shape (rows,)
        Even stamps in s, the position as it was read there, and as it drives friction.
    count, noise : float
        Step of the readings, 0 where there is none, and standard deviation of their noise, rounding
        included; rad or m.
    clock, path : float
        Time since the machine was switched on in s and path travelled since in rad or m, at the
        first row; 0 until they are set.

    Raises
    ------
    InputError
        No position, no input, or too short for the kernel.
    """

    simulated: ClassVar[bool] = False
    """Whether the plant moves by itself, and is not led along the measured motion."""
    counted: float | None = None
    """Inertia by which accelerations are counted where friction grows with the effort itself (see
    ``Rows.scale``); None until a fit has one."""
    stiffness: float | None = None
    """Effort per position where the residual is an error of position, counted as an effort."""

    def __init__(
        self,
        plant: Plant,
        recording: Recording,
        *,
        support: float | None = None,
        every: float | None = None,
    ) -> None:
        source = str(recording.path) if recording.path is not None else "recording"
        self.settings = recording.settings
        self.input_unit = recording.units.get("input", "")
        plant = self.own(plant)
        if recording.position is None:
            raise InputError(f"{source}: {NO_POSITION}")
        self.prescribed = plant.prescribed_motion or recording.input is None
        driving = recording.effort if self.prescribed else recording.input
        own = unscaled_unit(plant.drive, self.input_unit) or plant.si_effort_unit
        self.effort_unit = recording.units.get("effort") or own if self.prescribed else own
        if driving is None:
            raise InputError(
                f"{source}: there is no effort; prescribed motion needs an effort column"
            )
        if self.prescribed:
            driving = without_spikes(driving)
        stamps, time, self.dt = self.timestamps(recording.time)
        self.stamps = time
        least = support or max(SUPPORTS_S[0], FEWEST_SAMPLES * self.dt)
        # Before any kernel is made: at 10 MHz one of 30 ms would have 300 000 samples.
        possible = support is None or support <= WIDEST * self.dt
        self.widened = support is not None
        if possible and recording.duration < 1.5 * least:
            raise NotEnoughData(_too_few(source, len(time), least))
        x = np.interp(time, stamps, without_spikes(recording.position))
        u = zero_order_hold(time, stamps, driving)
        # Of the readings themselves: between them, on even stamps, there are no steps.
        self.count = plant.count or count_of(recording.position)
        noise = noise_of(x, self.count)
        self.temperature, self.enabled, self.transmitted = (
            None if values is None else zero_order_hold(time, stamps, values)
            for values in map(recording.channels.get, ("temperature", "enabled", "transmitted"))
        )
        driven = u if self.prescribed else _commanded(plant, u, x, self.dt)
        if support is not None:
            self.kernel = Kernel(support, self.dt)
        elif "inertia" in plant.body or self.prescribed:
            level = NOISE_SHARE * float(np.sqrt(np.mean(driven**2)))
            inertia = plant.inertia
            self.kernel = narrowest(self.dt, lambda k: inertia * noise * k.roughness <= level)
        else:
            # Without an inertia the accelerations themselves have to stand above their noise.
            self.kernel = narrowest(
                self.dt, lambda k: noise * k.roughness <= ACCELERATION_SHARE * _rms(k, x)
            )
        if len(time) < 4 * self.kernel.half:
            raise NotEnoughData(_too_few(source, len(time), self.kernel.support))
        self.stride = 1 if every is None else max(1, round(every / self.dt))
        load = recording.channels.get("load")
        self.load = np.zeros_like(x) if load is None else zero_order_hold(time, stamps, load)
        self.effort = driven if plant.gain == 1.0 else driven / plant.gain
        self.springy = plant.friction.springy
        self._leader: Plant | None = None
        self._pull: float | None = None
        self.readings = x
        self.denoise(noise)
        self.input = np.zeros(len(x) - 1) if self.prescribed else u[:-1]
        self.clock = self.path = 0.0
        self.time = self._thin(time[1:][self.kernel.half : -self.kernel.half])

    def for_plant(self, plant: Plant) -> Self:
        """The recording with friction driven as that of a plant has to be.

        What keeps a rigid contact at rest between two counts would lead one that yields in steps,
        and a motion that is smooth throughout never lets a rigid one rest: a law compared along
        the motion of another one would be outdone whatever it is worth.
        """
        alike = self.simulated or plant.friction.springy == self.springy
        return self if alike else self._otherwise

    @property
    def leads(self) -> bool:
        """Whether friction is driven by the motion that a plant makes near the measured one."""
        return self._leader is not None

    @cached_property
    def _led(self) -> list[Self]:
        """The same led by other plants, the last ones of them."""
        return []

    def with_leader(self, leader: Plant | None) -> Self:
        """The recording with friction driven by the motion that a plant makes near it.

        What a plant lacks makes its run late, by up to what is missing over its inertia and the
        square of the rate of the pull: the friction of a plant that lacks nothing must not be
        driven by that.
        """
        if leader is None or leader is self._leader or self._leader is None:
            return self
        for known in self._led:
            if known._leader is leader:
                return known
        other = copy(self)
        other.lead(leader)
        self._led.append(other)
        del self._led[:-MOST_LED]
        return other

    def lead(self, leader: Plant, pull: float | None = None) -> None:
        """Drives friction by the motion that a plant makes near the measured one.

        ``pull`` is the rate, 1/s, at which its run is drawn to the readings.
        """
        self._leader = leader
        self._pull = pull or self._pull
        self.denoise(self.noise)

    @cached_property
    def _otherwise(self) -> Self:
        other = copy(self)
        other.springy = not self.springy
        # The run of a contact that yields never rests, and that of a rigid one never yields.
        other._leader = None
        other.denoise(self.noise)
        return other

    @staticmethod
    def timestamps(time: FloatArray) -> tuple[FloatArray, FloatArray, float]:
        """Stamps as they were meant, those of the rows that are made of them, and their spacing."""
        return evenly(time)

    def denoise(self, noise: float) -> None:
        """Drives friction by what the readings are without so much noise; forgets what it knew.

        The kernel stays as wide as the recording's own noise made it.
        """
        for name in _CACHED:
            self.__dict__.pop(name, None)
        self.noise = noise
        self._driving = Driving(
            self.readings,
            self.kernel,
            noise=noise,
            count=self.count,
            springy=self.adapts,
            prescribed=self.prescribed,
        )
        self.position = self.driving_motion(self.readings)
        self.acceleration = self.accelerations(self.readings, self.position)

    def __len__(self) -> int:
        return len(self.time)

    @property
    def velocity(self) -> FloatArray:
        """Velocity through the kernel, shape (n,)."""
        return self.velocities(self.position)

    def velocities(self, position: FloatArray) -> FloatArray:
        """Velocity of a position at the stamps of the recording, through the kernel."""
        return self._mean(np.gradient(position, self.dt)[1:])

    def accelerations(self, readings: FloatArray, driving: FloatArray | None = None) -> FloatArray:
        """Acceleration behind readings at the stamps of the recording, through the kernel.

        ``driving`` is the motion that drives friction: where it rests under the whole kernel, a
        machine that noise seems to move has none.
        """
        found = self.kernel.second_derivative(readings[1:], every=self.stride)
        if driving is not None and not (self.adapts or self.prescribed):
            found[self._mean(_moves(driving)) == 0.0] = 0.0
        return found

    @property
    def around(self) -> Around:
        """What acted beside the input in every sample, as ``Motor.simulate`` takes it."""
        return {
            "load": self.load[:-1],
            "temperature": None if self.temperature is None else self.temperature[:-1],
            "enabled": None if self.enabled is None else self.enabled[:-1],
            "transmitted": None if self.transmitted is None else self.transmitted[:-1],
        }

    @cached_property
    def motion(self) -> Motion:
        """The measured motion, and what acted in every sample."""
        return self.with_motion()

    def with_motion(
        self,
        position: FloatArray | None = None,
        *,
        current: FloatArray | None = None,
        load: FloatArray | None = None,
    ) -> Motion:
        """The measured motion with something else in the place of what was measured.

        ``position`` has the shape of the recording, ``current`` and ``load`` one row less.
        """
        around = self.around if load is None else {**self.around, "load": load}
        return Motion(
            self.position if position is None else position,
            self.input if current is None else current,
            self.dt,
            **around,
            averaged=not self.prescribed,
        )

    def reread(self, readings: FloatArray, acted: FloatArray) -> Self:
        """The same recording with other readings, seen alike, and with other efforts that acted.

        Both have the shape of the recording. What acted is the measured effort of a machine that is
        moved, and the load of one that its drive moves: the input stays.
        """
        other = copy(self)
        for name in _CACHED:
            other.__dict__.pop(name, None)
        other.readings = readings
        if self.prescribed:
            other.effort = acted
        else:
            other.load = acted
        other.position = self.driving_motion(readings, None if self.prescribed else acted[:-1])
        other.acceleration = other.accelerations(readings, other.position)
        return other

    def with_input(self, given: FloatArray) -> Self:
        """The same recording with another input, shape (rows - 1,), held over each sample."""
        other = copy(self)
        for name in ("motion", "_otherwise", "_led"):
            other.__dict__.pop(name, None)
        other.input = given
        return other

    def own(self, plant: Plant) -> Plant:
        """The plant as it was set for this recording."""
        return plant.under(self.settings)

    @property
    def noisy_rows(self) -> np.ndarray[Any, np.dtype[np.bool_]]:
        """Rows that noise of the effort reaches; shape (n,).

        All of them, but a rigid contact at rest answers whatever acts on it, noise as well.
        """
        reached: np.ndarray[Any, np.dtype[np.bool_]] = self._mean(self._answers) > MOSTLY
        return reached

    @cached_property
    def stirs(self) -> bool:
        """Whether the readings hold more than white noise."""
        return stirs(self.readings)

    @cached_property
    def _answers(self) -> FloatArray:
        """Share of an effort to which the motion answers about each stamp; as ``position[1:]``."""
        if self.adapts or self.prescribed:
            return np.ones(len(self.position) - 1)
        return _moves(self.position)

    @property
    def adapts(self) -> bool:
        """Whether readings are smoothed as far as their motion allows, and not all alike."""
        return self.springy

    @property
    def flickers(self) -> bool:
        """Whether readings flicker, and noise had to be kept from friction by a backlash."""
        return self._driving.flickers

    @property
    def smoothing_support(self) -> float:
        """Support, s, over which the motion was smoothed because noise is much of its speed."""
        return self._driving.steadied

    @cached_property
    def lateness(self) -> float:
        """Time, s, by which friction may follow late because noise had to be kept from it."""
        return self._driving.lateness(self.position, self.readings)

    def mean(self, values: FloatArray) -> FloatArray:
        """Values at the ends of the samples (shape of ``position[1:]``) through the kernel."""
        return self._mean(values)

    def applied_effort(self, drive: FloatArray, load: FloatArray) -> FloatArray:
        """What drive and load gave, held over each sample, through the kernel; shape (n,)."""
        return self._mean(_centred(drive) + _centred(load))

    def measured_effort(self, plant: Plant) -> FloatArray:
        """Effort of the drive and load (prescribed motion: the measured one); shape (n,)."""
        if self.prescribed:
            return self._mean(self.effort[1:] + _centred(self.load[:-1]))
        return self.applied_effort(self._driven(plant, self.input), self.load[:-1])

    def whole(self, plant: Plant) -> FloatArray:
        """What a residual is a part of, to tell how much of it a plant explains; shape (n,)."""
        return self.measured_effort(plant)

    def noise_free_effort(self, plant: Plant) -> FloatArray:
        """Effort of the drive and load that the noise of no reading is in, as far as may be."""
        return self.measured_effort(plant)

    def _driven(self, plant: Plant, given: FloatArray) -> FloatArray:
        """Effort of the drive for an input held over each sample, effects left out."""
        plant = self.own(plant)
        if not plant.servo:
            limit = float(plant.drive.get("limit", np.inf))
            on = 1.0 if self.enabled is None else self.enabled[:-1] != 0.0
            driven: FloatArray = plant.gain * np.clip(given, -limit, limit) * on
            return driven
        motor = replace(plant, effects=()).follower()
        motor.reset(float(self.position[0]), 0.0)
        drive: FloatArray = motor.follow(self.with_motion(current=given), strict=False)[0]
        return drive

    def driving_motion(self, readings: FloatArray, load: FloatArray | None = None) -> FloatArray:
        """The motion that drives friction, from readings of a position; same shape.

        Under a load in the place of the recorded one (rows - 1), where a plant makes the motion.
        """
        smoothed = self._driving.motion(readings)
        if self._leader is None:
            return smoothed
        try:
            return nearby_motion(
                self, _rigid(self._leader), position=smoothed, load=load, rate=self._pull
            )[0]
        except InputError:
            # Too stiff for the sample time.
            return smoothed

    def efforts(self, plant: Plant, start: Start = None) -> tuple[FloatArray, FloatArray]:
        """Measured effort, and what the plant needs for the measured motion; shape (n,) each.

        ``start`` holds the friction state at the first row (see ``LawRecord.start``); without it
        the friction was never moved.
        """
        drive, needed, ahead = self.along(plant, start)
        # Stamps of `follow` are the sample ends. A measured effort belongs to its stamp; a held
        # one is the mean of what held before and after, or it is half a sample late.
        measured = self.effort[1:] if self.prescribed else _centred(drive)
        measured = measured + _centred(self.load[:-1])
        own = self.own(plant)
        inertial = own.inertia * (self.acceleration + self._bent(ahead))
        return self._mean(measured), inertial + self.needed_effort(own, needed)

    def needed_effort(self, plant: Plant, needed: FloatArray) -> FloatArray:
        """What a contact takes at the ends of the samples, through the kernel; shape (n,)."""
        if plant.friction.springy and not self.prescribed:
            # As `RowKernel` has it where it is smooth.
            needed = needed + np.diff(needed, 2, prepend=needed[:1], append=needed[-1:]) / 12.0
        return self._mean(needed)

    def residual(self, plant: Plant, start: Start = None) -> FloatArray:
        """Measured minus needed effort of every row, starts as in ``efforts``; shape (n,)."""
        return self.short(plant, start) + self._known - self.own(plant).inertia * self.acceleration

    @cached_property
    def _known(self) -> FloatArray:
        """What was measured of efforts beside that of a drive; shape (n,)."""
        load = _centred(self.load[:-1])
        return self._mean(self.effort[1:] + load if self.prescribed else load)

    def short(
        self,
        plant: Plant,
        start: Start = None,
        *,
        position: FloatArray | None = None,
        load: FloatArray | None = None,
        driven: bool = True,
    ) -> FloatArray:
        """What a drive gives less what is needed beside the load and the motion that shows.

        ``position`` and ``load`` as in ``along``; with ``driven`` False the drive is left out.
        """
        measured = position is None and load is None
        motion = self.motion if measured else self.with_motion(position, load=load)
        motor = self.start_motor(plant, self.position if position is None else position)
        rows = self._rows(plant, driven=driven)
        # A trial of a fit may run away: it must look bad, not end it.
        return motor.follow_rows(motion, rows, start=start, strict=False)

    def along(
        self,
        plant: Plant,
        start: Start = None,
        *,
        position: FloatArray | None = None,
        load: FloatArray | None = None,
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Efforts at the sample ends, and what of the motion the sensor does not show.

        Effort of the drive; friction less gravity and added efforts; how far the centre of mass is
        ahead of the reading. Shape of ``position[1:]`` each, before the kernel; ``position`` takes
        the place of the measured motion, and ``load`` of what acted beside the input (rows - 1).
        """
        measured = position is None and load is None
        motion = self.motion if measured else self.with_motion(position, load=load)
        motor = self.start_motor(plant, self.position if position is None else position)
        drive, ambient, friction, ahead = motor.follow(motion, start=start, strict=False)
        return drive, friction - ambient, ahead

    def start_motor(self, plant: Plant, motion: FloatArray, *, velocity: float = 0.0) -> Motor:
        """The plant as it is for this recording, where a motion starts.

        It knows the step of the readings also where the plant states no sensor.
        """
        motor = self.own(plant).follower(count=self.count)
        motor.reset(float(motion[0]), velocity, time=self.clock, path=self.path)
        return motor

    def late(self, plant: Plant) -> FloatArray:
        """Derivative of the measured effort by a timing offset of its own, per s; shape (n,).

        Input and position are read by different parts of a machine, at instants that nobody
        calibrated: an offset of a fraction of a sample must not be taken for a delay.
        """
        if self.own(plant).servo:
            before = np.concatenate([self.input[:1], self.input[:-1]])
            late = self._driven(plant, before) - self._driven(plant, self.input)
            return self._mean(_centred(late)) / self.dt
        gain = 1.0 if self.prescribed else plant.gain
        # A measured effort belongs to its stamp. Of a held one the mean of two samples does, and
        # its slope is their difference: any other one goes with the noise of that mean, and noise
        # of the log alone would look like an offset.
        rate = (
            np.gradient(self.effort, self.dt)[1:]
            if self.prescribed
            else np.diff(self.effort) / self.dt
        )
        limit = float(plant.drive.get("limit", np.inf))
        if not self.prescribed and np.isfinite(limit):
            rate = np.where(np.abs(self.effort[1:]) < limit, rate, 0.0)
        return -gain * self._mean(rate * self._answers)

    def jacobian(self, plant: Plant, paths: Sequence[str], start: Start = None) -> FloatArray:
        """Derivatives of measured minus needed effort by parameters; shape (n, parameters).

        Beside parameters of the plant the paths may name quantities of the start, such as
        ``start.force``.
        """
        motor = self.start_motor(plant, self.position)
        found = motor.follow_columns(
            self.motion, list(paths), self._rows(plant), start=start, strict=False
        )
        columns: FloatArray = found.T
        if "body.inertia" in paths:
            place = list(paths).index("body.inertia")
            columns[:, place] -= self.acceleration
            if plant.shifts_mass:
                columns[:, place] -= self._bent(self.along(plant, start)[2])
        return columns

    def signatures(
        self,
        plant: Plant,
        candidates: Sequence[Candidate],
        start: Start = None,
        kept: Places | None = None,
    ) -> FloatArray:
        """Derivatives of measured minus needed effort by the gains of effects that are not there.

        Parameters
        ----------
        plant : Plant
        candidates : sequence of (str, dict)
            Name of an effect and values of its shape parameters.
        start : dict, optional
        kept : numpy.ndarray of int, optional
            Rows that are wanted, rising; all n of them without it.

        Returns
        -------
        numpy.ndarray, shape (kept, gains)
            In the order of the candidates and of the gains of each.
        """
        motor = self.start_motor(plant, self.position)
        rows = self._rows(plant)
        found = motor.signature_columns(
            self.motion,
            list(candidates),
            rows,
            start=start,
            strict=False,
            kept=None if kept is None else kept.tolist(),
        )
        columns: FloatArray = found.T
        return columns

    def _rows(self, plant: Plant, *, driven: bool = True) -> RowKernel:
        """What the core needs to see efforts and their derivatives as rows."""
        return RowKernel(
            self.kernel.weights[::-1].copy(),
            self.kernel.second,
            self.stride,
            self.own(plant).inertia,
            held=driven and not self.prescribed,
            smooth=not self.prescribed and self.own(plant).friction.springy,
        )

    def _bent(self, ahead: FloatArray) -> FloatArray:
        """Second derivative, through the kernel, of a distance at the sample ends."""
        if not np.any(ahead):
            return np.zeros(len(self))
        return self.kernel.second_derivative(ahead, every=self.stride)

    def _mean(self, values: FloatArray) -> FloatArray:
        return self.kernel.mean(values, every=self.stride)

    def _thin(self, values: FloatArray) -> FloatArray:
        thinned: FloatArray = values[:: self.stride]
        return thinned


def _rigid(plant: Plant) -> Plant:
    """The plant with all of its inertia on the motor.

    The pull to the readings acts on the motor, damps a mass behind a shaft far more than the shaft
    does, and shakes it with their noise.
    """
    kept = tuple(each for each in plant.effects if not each.record.swings)
    return plant if len(kept) == len(plant.effects) else replace(plant, effects=kept)


def _commanded(plant: Plant, given: FloatArray, position: FloatArray, dt: float) -> FloatArray:
    """Effort that a drive would give for its input, without limit; roughly, for sizes alone."""
    if not plant.servo:
        return plant.gain * given
    servo = plant.drive
    duty = np.clip(servo["proportional"] * (given - position), -1.0, 1.0)
    voltage = servo["supply_v"] * duty - plant.gain * np.gradient(position, dt)
    effort: FloatArray = plant.gain * voltage / servo["resistance_ohm"]
    return effort


def _too_few(source: str, samples: int, support: float) -> str:
    return (
        f"{source}: {samples} samples are too few for a kernel of {support:.3g} s, over which the "
        "effort is averaged; give a longer recording"
    )


def _moves(position: FloatArray) -> FloatArray:
    """Share of the samples about each stamp in which something moves; as ``position[1:]``."""
    return _centred(1.0 * (np.diff(position) != 0.0))


def _centred(values: FloatArray) -> FloatArray:
    """At the end of each sample the mean of what held in it and in the next; last axis."""
    centred: FloatArray = values.copy()
    centred[..., :-1] += values[..., 1:]
    centred[..., -1] += values[..., -1]
    return 0.5 * centred


def _rms(kernel: Kernel, position: FloatArray) -> float:
    """Root mean square of the acceleration through a kernel; 0 where it does not fit."""
    if len(position) <= 2 * kernel.half:
        return 0.0
    return float(np.sqrt(np.mean(kernel.second_derivative(position) ** 2)))
