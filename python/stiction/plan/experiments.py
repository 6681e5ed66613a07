"""The experiments of a session, each a signal sized by the plant."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from .._support.arrays import FloatArray
from ..plant import Plant
from .limits import Sizes
from .moves import Motion, cosine_taper

__all__ = ["EXPERIMENTS", "Experiment"]

DECADES: Final = 3.0
RAMPS: Final = 7
RAMP_S: Final = 2.0
"""Speeds of the ramps, and how long one goes one way."""
CYCLE_REACH: Final = 0.15
"""Of the range: a cycle that travels far wears off by itself what it is there to show."""
RESTS_S: Final = (0.1, 0.3, 1.0, 3.0, 5.0)
LOADINGS: Final = (0.01, 0.1, 0.5)
"""Rests, and the shares of the greatest speed at which they end."""
LOADING_S: Final = 4.0
"""Time that a loading takes at most."""
LEVELS: Final = (0.3, 0.6, 0.95)
HOLD_S: Final = 5.0
"""Levels of the holds in shares of friction, and how long they last."""
NESTED: Final = (0.8, 0.55, 0.35, 0.2)
"""Amplitudes of nested loops in shares of friction."""
LOOP_S: Final = 0.8
PULSES: Final = (1.2, 1.6, 2.2)
PULSE_S: Final = 5.0
"""Heights of pulses in shares of friction, and how long one lasts at most."""
SHARES: Final = (0.05, 0.2, 0.8)
"""Amplitudes of sines in shares of the reach."""
WAVES: Final = 12
MULTISINE_S: Final = 20.0
CHIRP_S: Final = 15.0
CHIRP_TO: Final = 0.1
"""End of a chirp in shares of the sampling rate."""
STEADY_S: Final = 5.0
CROSSING_S: Final = 15.0
"""Time in which the range is crossed at most; a slow machine then crosses a part of it."""
FASTEST: Final = 0.05
"""Frequency of a sine at most, in shares of the sampling rate."""

Kind = Literal["reference", "input"]
Build = Callable[[Plant, Sizes, float, np.random.Generator, float], FloatArray]
"""Signal from plant, sizes, sample time, source of chance, and a share of its usual size."""


@dataclass(frozen=True)
class Experiment:
    """One kind of recording.

    Attributes
    ----------
    name : str
    kind : {"reference", "input"}
        Whether a controller follows it or the drive gets it.
    purpose : str
        What it shows, in words.
    build : callable
        From plant, sizes, sample time, source of chance and share of the size to the signal.
    """

    name: str
    kind: Kind
    purpose: str
    build: Build


def _tracking(
    plant: Plant, sizes: Sizes, dt: float, source: np.random.Generator, share: float
) -> FloatArray:
    time = np.arange(round(MULTISINE_S / dt)) * dt
    low, high = 0.1, 0.25 * math.sqrt(sizes.acceleration / (0.05 * sizes.reach)) / math.pi
    high = min(max(high, 2.0 * low), FASTEST / dt)
    orders = low * (high / low) ** (np.arange(WAVES) / (WAVES - 1))
    waves = [
        np.sin(2.0 * math.pi * f * time + source.uniform(0.0, 2.0 * math.pi)) / f for f in orders
    ]
    return _within(np.sum(waves, axis=0) * cosine_taper(len(time)), sizes, dt, share)


def _ramps(
    plant: Plant, sizes: Sizes, dt: float, source: np.random.Generator, share: float
) -> FloatArray:
    motion = Motion(dt, share * sizes.acceleration)
    motion.rest(0.5)
    shares = 10.0 ** (-DECADES * np.arange(RAMPS) / (RAMPS - 1))
    for k in source.permutation(RAMPS):
        speed = share * sizes.speed * float(shares[k])
        distance = min(sizes.reach, RAMP_S * speed) * float(source.choice([-1.0, 1.0]))
        motion.ramp(distance, speed)
        motion.ramp(-distance, speed)
    motion.rest(0.5)
    return motion.positions()


def _dwells(
    plant: Plant, sizes: Sizes, dt: float, source: np.random.Generator, share: float
) -> FloatArray:
    motion = Motion(dt, share * sizes.acceleration)
    cells = [(rest, loading) for rest in RESTS_S for loading in LOADINGS]
    sign = 1.0
    for k in source.permutation(len(cells)):
        rest, loading = cells[int(k)]
        motion.rest(rest)
        speed = share * loading * sizes.speed
        distance = max(20.0 * sizes.presliding, 0.4 * speed)
        distance = min(0.5 * sizes.reach, LOADING_S * speed, distance)
        # On in the same direction or back: a contact remembers from where it came.
        turn = float(source.choice([-1.0, 1.0]))
        sign = turn if abs(motion.at + turn * distance) <= sizes.reach else -turn
        motion.ramp(sign * distance, speed)
    motion.rest(0.5)
    return motion.positions()


def _turns(
    plant: Plant, sizes: Sizes, dt: float, source: np.random.Generator, share: float
) -> FloatArray:
    return _crossings(sizes, dt, source, share, source.uniform(0.07, 0.1) * sizes.speed)


def _fast(
    plant: Plant, sizes: Sizes, dt: float, source: np.random.Generator, share: float
) -> FloatArray:
    speed = source.uniform(0.9, 1.0) * sizes.speed
    return _crossings(sizes, dt, source, share, speed, times=3)


def _crossings(
    sizes: Sizes,
    dt: float,
    source: np.random.Generator,
    share: float,
    speed: float,
    *,
    times: int = 1,
) -> FloatArray:
    motion = Motion(dt, share * sizes.acceleration)
    motion.rest(0.5)
    far = min(sizes.reach, CROSSING_S * share * speed) * float(source.choice([-1.0, 1.0]))
    for _ in range(times):
        motion.go(far, share * speed)
        motion.go(-far, share * speed)
    motion.go(0.0, share * speed)
    motion.rest(0.5)
    return motion.positions()


def _sines(
    plant: Plant, sizes: Sizes, dt: float, source: np.random.Generator, share: float
) -> FloatArray:
    motion = Motion(dt, sizes.acceleration)
    for k in source.permutation(len(SHARES)):
        amplitude = SHARES[int(k)] * sizes.reach
        fastest = min(sizes.speed / amplitude, math.sqrt(sizes.acceleration / amplitude)) / (
            2.0 * math.pi
        )
        # The last one of a block is of high acceleration: the input varies at the same place.
        for times in (0.3, 1.0):
            frequency = min(max(times * share * fastest, 0.15), FASTEST / dt)
            samples = round(3.0 / frequency / dt)
            wave = np.sin(2.0 * math.pi * frequency * np.arange(samples) * dt)
            motion.add(_within(amplitude * wave * cosine_taper(samples, 0.2), sizes, dt, share))
            motion.rest(0.2)
    return motion.positions()


def _cycle(
    plant: Plant, sizes: Sizes, dt: float, source: np.random.Generator, share: float
) -> FloatArray:
    motion = Motion(dt, share * sizes.acceleration)
    motion.rest(1.0)
    for speed in (0.5, 0.05):
        distance = min(CYCLE_REACH * sizes.reach, speed * sizes.speed * RAMP_S)
        for sign in (1.0, -1.0, -1.0, 1.0):
            motion.ramp(sign * distance, share * speed * sizes.speed)
    motion.rest(1.0)
    return motion.positions()


def _rests(
    plant: Plant, sizes: Sizes, dt: float, source: np.random.Generator, share: float
) -> FloatArray:
    motion = Motion(dt, share * sizes.acceleration)
    motion.rest(STEADY_S)
    speed = min(sizes.speed, source.uniform(1.5, 1.8) * sizes.reach / STEADY_S)
    distance = min(0.9 * sizes.reach, STEADY_S * speed) * float(source.choice([-1.0, 1.0]))
    motion.go(-distance, sizes.speed * 0.5)
    motion.go(distance, share * speed)
    motion.go(-distance, share * speed)
    motion.go(0.0, sizes.speed * 0.5)
    motion.rest(STEADY_S)
    return motion.positions()


def _pulses(
    plant: Plant, sizes: Sizes, dt: float, source: np.random.Generator, share: float
) -> FloatArray:
    heights = [h for h in PULSES if h * sizes.friction <= sizes.effort] or [
        sizes.effort / sizes.friction
    ]
    parts = [np.zeros(round(0.5 / dt))]
    for _ in range(4):
        for k in source.permutation(len(heights)):
            force = heights[int(k)] * sizes.friction
            over = max(force - sizes.friction, 0.05 * force)
            # Accelerated over w, braked by friction alone: x = over·w²/(2·J)·(force/friction).
            far = 0.1 * share * sizes.reach
            width = math.sqrt(2.0 * far * sizes.inertia * sizes.friction / (over * force))
            width = min(width, share * sizes.speed * sizes.inertia / over, PULSE_S)
            samples = max(2, round(width / dt))
            for sign in (1.0, -1.0):
                parts += [np.full(samples, sign * force), np.zeros(round(0.6 / dt))]
    return np.concatenate(parts)


def _loops(
    plant: Plant, sizes: Sizes, dt: float, source: np.random.Generator, share: float
) -> FloatArray:
    samples = round(LOOP_S / dt)
    wave = np.sin(2.0 * math.pi * np.arange(samples) / samples)
    parts = [np.zeros(samples)]
    amplitudes = (*NESTED, *NESTED[::-1])
    parts += [share * a * source.uniform(0.9, 1.0) * wave for a in amplitudes]
    for k in source.permutation(len(LEVELS)):
        for sign in (1.0, -1.0):
            level = share * sign * LEVELS[int(k)]
            rise = level * (0.5 - 0.5 * np.cos(math.pi * np.arange(samples) / samples))
            parts += [rise, np.full(round(HOLD_S / dt), level), rise[::-1]]
    return sizes.friction * np.concatenate(parts)


def _chirp(
    plant: Plant, sizes: Sizes, dt: float, source: np.random.Generator, share: float
) -> FloatArray:
    force = min(1.8 * sizes.friction, sizes.effort)
    # Below this the machine would go further, or faster, than a fifth of what it may.
    far = math.sqrt(force / (sizes.inertia * 0.2 * share * sizes.reach)) / (2.0 * math.pi)
    fast = force / (sizes.inertia * 0.5 * share * sizes.speed) / (2.0 * math.pi)
    high = CHIRP_TO / dt
    low = min(max(far, fast, 0.5), 0.5 * high)
    time = np.arange(round(CHIRP_S / dt)) * dt
    rate = math.log(high / low) / CHIRP_S
    phase = 2.0 * math.pi * low * np.expm1(rate * time) / rate
    wave: FloatArray = (
        force * np.sin(phase + source.uniform(0.0, 2.0 * math.pi)) * cosine_taper(len(time))
    )
    return np.concatenate([np.zeros(round(0.5 / dt)), wave, np.zeros(round(0.5 / dt))])


def _within(path: FloatArray, sizes: Sizes, dt: float, share: float) -> FloatArray:
    """A path made as large as reach, speed and acceleration allow."""
    speed = np.diff(path, prepend=path[0]) / dt
    bend = np.diff(speed, prepend=speed[0]) / dt
    ratios = [
        sizes.reach / max(float(np.max(np.abs(path))), 1e-300),
        sizes.speed / max(float(np.max(np.abs(speed))), 1e-300),
        sizes.acceleration / max(float(np.max(np.abs(bend))), 1e-300),
    ]
    scaled: FloatArray = share * min(ratios) * (path - path[0])
    return scaled


EXPERIMENTS: Final = (
    Experiment(
        "tracking",
        "reference",
        "sines of many frequencies: all speeds and accelerations mixed",
        _tracking,
    ),
    Experiment(
        "ramps",
        "reference",
        "two-way ramps of constant speed over three decades, without rests",
        _ramps,
    ),
    Experiment("dwells", "reference", "rests of 0.1 to 5 s, each ended slowly and fast", _dwells),
    Experiment(
        "sines", "reference", "sines over amplitude and frequency, with high accelerations", _sines
    ),
    Experiment("turns", "reference", "slow full turns (or full strokes) both ways", _turns),
    Experiment("fast", "reference", "fast constant speed over the whole range, both ways", _fast),
    Experiment("rests", "reference", "5 s of rest and 5 s of constant speed", _rests),
    Experiment("cycle", "reference", "a short cycle, to be repeated through the session", _cycle),
    Experiment("pulses", "input", "pulses of effort: what the machine does by itself", _pulses),
    Experiment(
        "loops", "input", "nested loops below break-away, and holds at three levels", _loops
    ),
    Experiment("chirp", "input", "a chirp of the input up to a tenth of the sampling rate", _chirp),
)
"""All experiments, in the order in which a session records them."""
