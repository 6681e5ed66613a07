"""Replays: a motion near the measured one of which all efforts are known, read with noise."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from ..catalogue import effects
from ..errors import InputError
from ..plant import Plant
from ..residual.accompanied import nearby_motion
from ..residual.loop_form import LoopForm
from ..residual.shooting import ShootingForm
from ..residual.weak_form import Start, WeakForm
from .noise import Noise, effort_noise, measure_noise
from .readings import own_motion, position_noise, read_sensor, true_motion
from .rows import Nuisances, Rows

__all__ = [
    "NearbyMotion",
    "NoReplayError",
    "hangs_on_load",
    "noise_of",
    "reread",
    "rereads",
    "simulate_alone",
]

MOST_TIMES: Final = 3.0
"""Of an estimate of noise that replays are asked about: with more they tell nothing."""
TRIED: Final = 2
"""Readings of a motion without noise of the effort, to see what they make of the residual."""


class NoReplayError(Exception):
    """No motion near the measured one could be made of which all efforts are known."""


_Residual = Callable[[FloatArray, FloatArray], FloatArray]
"""Residual of readings, shape (rows,), and of white noise on the effort, shape (rows,)."""


@dataclass(frozen=True)
class NearbyMotion:
    """A motion that a plant makes, near that of a recording, and the residual of its readings."""

    rows: Rows
    plant: Plant
    nuisances: Nuisances
    motion: FloatArray
    residual: _Residual
    load: FloatArray | None = None

    @classmethod
    def of(cls, rows: Rows, plant: Plant, nuisances: Nuisances) -> NearbyMotion:
        rows = rows.with_leader(nuisances)
        form, start = rows.form, nuisances.start(rows.index)
        if isinstance(form, LoopForm):
            motion, residual = _looped(form, plant, start)
        elif isinstance(form, ShootingForm):
            motion, residual = _shot(form, plant, start)
        else:
            own = own_motion(form, plant, start) if form.leads or not form.springy else None
            if own is not None:
                return cls(rows, plant, nuisances, *own)
            motion, residual = _followed(form, plant, start)
        return cls(rows, plant, nuisances, motion, residual)

    def noise(self) -> Noise:
        """Noise of the recording, less what reading this motion makes by itself."""
        form = self.rows.form
        if isinstance(form, LoopForm):
            # Nobody measured an effort. What varies from run to run thresholds have from the
            # residual itself, turned round block by block.
            return Noise(position_noise(form), form.count, 0.0)
        if isinstance(form, ShootingForm):
            start = self.nuisances.start(self.rows.index)
            alone = form.from_readings_alone(self.plant, start)
            return self._as_seen(measure_noise(self.rows, self.plant, self.nuisances, alone), alone)
        return measure_noise(self.rows, self.plant, self.nuisances, self.alone())

    def alone(self) -> list[FloatArray]:
        """Residuals of some readings of the motion without noise of the effort; shape (rows,)."""
        source = np.random.default_rng(self.rows.index)
        white, still = position_noise(self.rows.form), np.zeros(len(self.motion))
        return [self.residual(self.read(white, source), still) for _ in range(TRIED)]

    def _as_seen(self, noise: Noise, alone: Sequence[FloatArray]) -> Noise:
        """Noise of which as much is seen in replays as in the recording.

        A machine that rests through a part of its windows keeps noise of the effort to itself, and
        where it turns round noise does more than through a kernel.
        """
        if noise.effort <= 0.0:
            return noise
        source = np.random.default_rng([self.rows.index, TRIED])
        size = len(self.motion)
        again = [
            self.residual(
                self.read(noise.position, source), noise.effort * source.standard_normal(size)
            )
            for _ in range(TRIED)
        ]
        seen = effort_noise(self.rows, again, alone)
        times = noise.effort / seen if seen > 0.0 else 1.0
        return replace(noise, effort=noise.effort * float(np.clip(times, 1.0, MOST_TIMES)))

    def columns(self, noise: Noise, number: int, seed: int) -> FloatArray:
        """Residuals of the rows that count, of so many replays; shape (rows, number)."""
        source = np.random.default_rng([seed, self.rows.index])
        columns = np.empty((int(self.rows.mask.sum()), number))
        for k in range(number):
            readings = self.read(noise.position, source)
            added = noise.effort * source.standard_normal(len(self.motion))
            columns[:, k] = self.residual(readings, added)[self.rows.mask]
        return columns

    def read(self, white: float, source: np.random.Generator) -> FloatArray:
        """The motion as the sensor reads it."""
        return read_sensor(self.rows.form, self.motion, white, source)


def _followed(form: WeakForm, plant: Plant, start: Start) -> tuple[FloatArray, _Residual]:
    """The smoothed motion, which the plant follows, and the residual around it."""
    inertia = form.own(plant).inertia

    def needed(position: FloatArray, readings: FloatArray) -> FloatArray:
        short = form.short(plant, start, position=position, driven=False)
        return inertia * form.accelerations(readings, position) - short

    motion = true_motion(form)
    acted = needed(motion, motion)

    def residual(readings: FloatArray, added: FloatArray) -> FloatArray:
        noise = form.mean(0.5 * (added[:-1] + added[1:]))
        return acted + noise - needed(form.driving_motion(readings), readings)

    return motion, residual


def _looped(form: LoopForm, plant: Plant, start: Start) -> tuple[FloatArray, _Residual]:
    """The motion of the simulated loop, and the residual of its readings."""
    reached = form.reaches(plant, start)

    def residual(readings: FloatArray, added: FloatArray) -> FloatArray:
        missed: FloatArray = form.stiffness * (readings[1:] - reached)
        return missed

    return np.concatenate([form.readings[:1], reached]), residual


def _shot(form: ShootingForm, plant: Plant, start: Start) -> tuple[FloatArray, _Residual]:
    """A motion near the measured one that the plant makes by itself, and the residual around it.

    A motion that is smoothed from counts is none that a plant with this friction would make.
    """
    motion, load = nearby_motion(form, plant, start)

    def residual(readings: FloatArray, added: FloatArray) -> FloatArray:
        return form.residual_for(plant, start, readings, load + added[:-1])

    return motion, residual


def noise_of(rows: Rows, plant: Plant, nuisances: Nuisances) -> Noise:
    """Noise of one recording beside a plant that describes it."""
    return NearbyMotion.of(rows, plant, nuisances).noise()


def reread(rows: Rows, plant: Plant, nuisances: Nuisances, seed: Sequence[int]) -> Rows:
    """Rows of a recording in which the plant is right and only noise is added; see ``rereads``."""
    (found,) = rereads(rows, plant, nuisances, [seed])
    return found


def rereads(
    rows: Rows, plant: Plant, nuisances: Nuisances, seeds: Sequence[Sequence[int]]
) -> Iterator[Rows]:
    """The same motion read with noise of each seed, one after the other.

    Unlike surrogates they are rows in every respect: what is derived along their motion holds the
    noise that their residual holds. Of a machine that is moved, or has a rigid contact.

    Raises
    ------
    NoReplayError
        A rigid contact that no simulation keeps near the measured motion; a plant that hangs on the
        load, in whose place stands what makes it follow.
    """
    replay = NearbyMotion.of(rows, plant, nuisances)
    form, inertia = rows.form, rows.form.own(plant).inertia
    if replay.load is None and not form.prescribed:
        raise NoReplayError
    if replay.load is not None:
        if inertia <= 0.0 or hangs_on_load(plant, form):
            raise NoReplayError
        # A contact at rest answers whatever acts on it, noise as well.
        answers = form.springy | (np.diff(replay.motion, append=replay.motion[-1:]) != 0.0)
        acted = np.append(replay.load, replay.load[-1:])
    else:
        start = nuisances.start(rows.index)
        needed = form.along(plant, start, position=replay.motion)[1] - form.load[:-1]
        bent = np.gradient(np.gradient(replay.motion, form.dt), form.dt)
        answers, acted = True, np.concatenate([needed[:1], needed]) + inertia * bent
    noise = replay.noise()
    for seed in seeds:
        source = np.random.default_rng(seed)
        white = noise.effort * source.standard_normal(len(replay.motion))
        again = form.reread(replay.read(noise.position, source), acted + answers * white)
        found = Rows(plant, again, rows.index, rows.mask)
        found.weight = rows.weight
        yield found


def simulate_alone(rows: Rows, plant: Plant, nuisances: Nuisances) -> Rows:
    """Rows of a recording that the plant makes by itself near the measured one, without noise.

    The sensor rounds it to its counts, and nothing else is between the plant and its readings: what
    a fit leaves of such rows are errors of following them.

    Raises
    ------
    NoReplayError
        A machine that is moved, or rows that are simulated anyway; a plant that no simulation keeps
        near the measured motion, or that hangs on the load, in whose place stands what keeps it.
    """
    own = rows.with_leader(nuisances)
    form = own.form
    simulated = isinstance(form, LoopForm | ShootingForm)
    if simulated or form.prescribed or plant.servo or hangs_on_load(plant, form):
        raise NoReplayError
    if form.own(plant).inertia <= 0.0:
        raise NoReplayError
    start = nuisances.start(own.index)
    try:
        motion, load = nearby_motion(form, plant, start, position=true_motion(form))
    except InputError as error:
        raise NoReplayError from error
    readings = read_sensor(form, motion, 0.0, np.random.default_rng(own.index))
    found = Rows(plant, form.reread(readings, np.append(load, load[-1:])), own.index, own.mask)
    found.weight = own.weight
    return found


def hangs_on_load(plant: Plant, form: WeakForm) -> bool:
    """Whether friction or an effect of a plant reads the load that acts on it.

    Not where it is known what the gear transmits: that is read in its place.
    """
    if form.transmitted is not None:
        return False
    readers = {record.name for record in effects() if "load" in record.channels}
    reads = any(effect.name in readers for effect in plant.effects)
    return reads or plant.friction.law == "load_dependent"
