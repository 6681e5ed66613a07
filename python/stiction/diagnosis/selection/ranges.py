"""What a refit says against its own effect: shapes and gains that are not what its name says."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np

from ..._support.arrays import FloatArray
from ...fitting.noise import input_noise
from ...fitting.start import largest_command
from ..data.evidence import Evidence
from ..screening.candidates import Candidate
from ..screening.model import Model

__all__ = [
    "OF_READING",
    "is_placed",
    "is_whole",
    "out_of_its_range",
    "partial_loss",
    "surely_a_part",
]


MEMORY: Final = "memory"
"""Family of what builds up over a way behind a turn."""
INPUT: Final = "input"
"""Unit of what is measured in inputs."""


class Whole(NamedTuple):
    """A gain that is 1 where the cause is what its name says."""

    gain: str
    partly: float
    """What is surely below this is another cause: a limit that rounds off loses a part at first."""
    whole: float
    """From here on it came out as 1."""
    why: str


LIMIT: Final = Whole("share", 0.25, 0.95, "beyond a limit nothing gets through")
"""Of effects that act beyond a limit alone: a part that is lost of large inputs is a torque
constant that falls, whatever its curve."""
MOST_BEYOND: Final = 3.0
"""Largest input over a limit: a drive is not asked for more, and what is beyond is a reading that
was never there."""
FEWEST_INSIDE: Final = 2
"""Readings on the way behind a turn that tell how something builds up: one tells how much."""
AT_REST: Final = 0.1
"""Share of such a way that is still the turn itself."""
SURELY: Final = 2.0
"""Standard errors by which a gain is surely less."""
BELOW_A_KERNEL: Final = "went below what a kernel shows"
"""What is late by so little is the reading of the motion, and nothing that is missing."""
WITHIN_NOISE: Final = "lies within the noise of the input"
"""So narrow a dead zone takes noise off the log where the machine coasts at an input of 0."""
BETWEEN_STAMPS: Final = "is over between two readings"
"""What builds up over so short a way behind a turn is where the machine turned."""
ABOVE_SAMPLES: Final = "sets a resonance above half the rate of the samples"
"""Of what swings so fast no reading tells."""
SHOWN: Final = 0.5
"""Share of the rate of the samples up to which they show an oscillation (Nyquist)."""
OF_READING: Final = (BELOW_A_KERNEL, WITHIN_NOISE, BETWEEN_STAMPS, ABOVE_SAMPLES)
"""What imitates a reading, and nothing that is missing."""
REACH_OF_NOISE: Final = 3.0
"""Standard deviations that white noise stays within."""
AT_THE_EDGE: Final = 0.98
"""A shape that has come this near to the end of where it may be stands there."""


def out_of_its_range(candidate: Candidate, model: Model) -> str:
    """The shape that a refit took out of where it means what it says, "" where there is none.

    A change with speed that is not over where the speeds end is a curve of viscous friction; what
    is late by far less than the kernel is wide is the reading of the motion. A speed whose grid
    begins below all speeds is no such change: over it one direction goes over into the other, and
    the friction of the two differs however slowly that comes about. And what is late and over below
    the slowest speeds is no lag of sliding friction: there the curve of the contact is off. A dead
    zone that noise of the input does not leave is a filter of that noise, and a way that is over
    between two stamps behind most turns is where the machine turned between them. What swings
    faster than samples can show is not seen to swing.
    """
    if narrow := _within_noise(candidate, model):
        return f"{narrow} {WITHIN_NOISE}"
    if fast := _swings_unseen(candidate, model):
        return f"{fast} {ABOVE_SAMPLES}"
    late = any(shape.scale == "kernel" for shape in candidate.record.shapes)
    effect = next(each for each in model.plant.effects if each.name == candidate.name)
    for shape in candidate.record.shapes:
        stated = effect.parameters[candidate.own(shape.parameter)]
        builds_up = candidate.record.family == MEMORY and shape.scale == "presliding"
        if builds_up and _is_over_between(stated.value, model.evidence):
            return f"{shape.parameter} {BETWEEN_STAMPS}"
        if stated.fixed or stated.max is None or stated.min is None:
            continue
        changes = shape.scale == "speed" and min(shape.grid) >= 0.0
        if changes and stated.value >= AT_THE_EDGE * stated.max:
            where = "top of all speeds" if max(shape.grid) >= 1.0 else "end of its range"
            return f"{shape.parameter} went to the {where}"
        if changes and late and stated.value <= stated.min / AT_THE_EDGE:
            return f"{shape.parameter} went below the usual speeds"
        if shape.scale == "kernel" and stated.value <= stated.min / AT_THE_EDGE:
            return f"{shape.parameter} {BELOW_A_KERNEL}"
    return ""


def _within_noise(candidate: Candidate, model: Model) -> str:
    """The gain that is an input no greater than noise of its log, "" where there is none."""
    units = {each.name: each.unit for each in candidate.record.parameters}
    widths = [name for name in candidate.gains if units[name] == INPUT]
    if not widths or model.plant.servo:
        return ""
    plant, nuisances, evidence = model.plant, model.nuisances, model.evidence
    noises = evidence.each(lambda rows: input_noise(rows, plant, nuisances), evidence.train)
    reach = REACH_OF_NOISE * float(np.median(noises))
    widest = {w: abs(plant.gain * _value(candidate, model, w)) for w in widths}
    return next((name for name, width in widest.items() if width <= reach), "")


def _swings_unseen(candidate: Candidate, model: Model) -> str:
    """The gain that sets a resonance which no samples show, "" where there is none."""
    record = candidate.record
    if not record.swings:
        return ""
    (gain,) = record.gains
    compliance, share = (_value(candidate, model, each) for each in (gain, "inertia_share"))
    softness = compliance * share * (1.0 - share) * model.plant.inertia
    spacing = min(form.dt for form in model.evidence.forms)
    fastest = 2.0 * math.pi * SHOWN / spacing
    return gain if softness * fastest**2 < 1.0 else ""


def _is_over_between(way: float, evidence: Evidence) -> bool:
    """Whether behind most turns hardly any reading lies within a way, rad or m."""
    inside = [
        number for rows in evidence.train for number in _readings_within(rows.form.position, way)
    ]
    return bool(inside) and float(np.median(inside)) < FEWEST_INSIDE


def _readings_within(position: FloatArray, way: float) -> list[int]:
    """How many readings lie within a way behind each turn that is left by more than that.

    Those that have hardly left the turn are none: the machine rests.
    """
    steps = np.diff(position)
    moved = np.flatnonzero(steps)
    turns = moved[1:][np.diff(np.sign(steps[moved])) != 0.0]
    found = []
    for first, last in pairwise([*turns, len(position) - 1]):
        gone = np.abs(position[first : last + 1] - position[first])
        if gone.max() > way:
            gone = gone[: int(np.argmax(gone > way))]
            found.append(int(np.sum(gone > AT_REST * way)))
    return found


def is_whole(candidate: Candidate, model: Model) -> bool:
    """Whether a gain came out as what was known of it, of inputs that a drive may be asked for."""
    if not candidate.record.limits:
        return False
    limits = [_value(candidate, model, s.parameter) for s in candidate.record.shapes]
    asked = max(largest_command(rows.form, model.plant) for rows in model.evidence.shown)
    came_out = _value(candidate, model, LIMIT.gain) >= LIMIT.whole
    return came_out and asked <= MOST_BEYOND * min(limits)


def surely_a_part(candidate: Candidate, model: Model) -> bool:
    """Whether a gain that would have to be whole surely is not, by the interval that is told."""
    if not candidate.record.limits:
        return False
    number = model.fit_result.parameters[f"effects.{candidate.name}.{LIMIT.gain}"]
    return number.value + SURELY * number.stderr < LIMIT.whole


def is_placed(candidate: Candidate, model: Model) -> bool:
    """Whether the data tell where a limit lies; of anything else nobody asks."""
    if not candidate.record.limits:
        return True
    numbers = model.fit_result.parameters
    paths = [f"effects.{candidate.name}.{s.parameter}" for s in candidate.record.shapes]
    ends = [end for path in paths if path in numbers for end in numbers[path].ci95]
    return all(map(math.isfinite, ends))


def _value(candidate: Candidate, model: Model, name: str) -> float:
    effect = next(each for each in model.plant.effects if each.name == candidate.name)
    return effect.parameters[candidate.own(name)].value


def partial_loss(candidate: Candidate, model: Model, strength: float) -> str:
    """The gain that would have to be whole and surely is not, "" where there is none."""
    if not candidate.record.limits:
        return ""
    value = _value(candidate, model, LIMIT.gain)
    surely_less = value * (1.0 + SURELY / max(strength, 1e-300)) < LIMIT.partly
    return f"{LIMIT.gain} is {value:.2g}, and {LIMIT.why}" if surely_less else ""
