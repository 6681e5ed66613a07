"""Coordinates in which a residual shows its cause."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from ..._support.arrays import FloatArray
from ...fitting.rows import Rows
from ...plant import Plant
from ...recording import Recording
from ...residual.weak_form import WeakForm
from ..data.contact import Slides, slides_of
from ..data.evidence import Evidence

__all__ = [
    "ANGLE",
    "COORDINATES",
    "UNJUDGED",
    "Coordinate",
    "Look",
    "looks",
]

TURNING_SHARE: Final = 1e-3
"""Speeds below this share of the usual one have no direction of their own: the last one holds."""
MOST_MISSED: Final = 0.2
"""Velocity by which a machine misses its reference, as a share of its own, and still follows it."""


@dataclass(frozen=True)
class Look:
    """What the rows of one recording are looked at by, before masking.

    Attributes
    ----------
    time, position, velocity, acceleration, effort, rate : numpy.ndarray, shape (n,)
        Through the kernel; ``rate`` is that of the effort, ``time`` the session clock. Velocity,
        acceleration and rate are those that were asked for where a reference was followed.
    direction : numpy.ndarray, shape (n,)
        Of the motion, −1 or 1; the last one where the machine rests.
    angle : numpy.ndarray, shape (n,)
        Position within a turn; over a stroke of a linear machine the position itself.
    travelled, elapsed : numpy.ndarray, shape (n,)
        Distance and time since the direction last changed.
    age, path : numpy.ndarray, shape (n,)
        Time since the machine was switched on, and travelled since then.
    bend : numpy.ndarray, shape (n,)
        Fourth derivative of the position.
    load, temperature : numpy.ndarray, shape (n,)
        What hangs on the machine and pulls at it, and degC; NaN where nothing is known.
    slides : Slides
        Of the contact.
    """

    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    effort: FloatArray
    rate: FloatArray
    direction: FloatArray
    angle: FloatArray
    travelled: FloatArray
    elapsed: FloatArray
    age: FloatArray
    path: FloatArray
    bend: FloatArray
    load: FloatArray
    temperature: FloatArray
    slides: Slides


@dataclass(frozen=True)
class Coordinate:
    """One way to look at a residual.

    Attributes
    ----------
    name : str
        As in findings.json.
    axis : str
        What its axis says, with {x} and {f} for the units of position and effort and {e} for the
        name of the effort.
    odd : bool
        The residual is counted along the motion: friction that is too low is positive both ways.
    values : callable
        From a ``Look`` to numpy.ndarray, shape (n,); NaN in rows that have no place in it.
    slow : bool
        It changes over the session, not within a recording.
    logarithmic : bool
        It is drawn over its logarithm where it spans decades.
    factor : callable, optional
        From a ``Look`` to what the residual grows with; the curve is then the residual over it.
    upright : str
        What the vertical axis says of such a curve.
    refines : str
        Name of a wider coordinate that mostly shows the same.
    rows : str
        Which rows have a place in it, "" where all have.
    fine : bool
        What depends on it may do so in a narrow place.
    tails : bool
        Few rows lie far out, and what depends on it may do so there.
    descriptive : bool
        It tells what is left by, and is no sign of itself that anything is.
    """

    name: str
    axis: str
    odd: bool
    values: Callable[[Look], FloatArray]
    slow: bool = False
    logarithmic: bool = False
    factor: Callable[[Look], FloatArray] | None = None
    upright: str = ""
    refines: str = ""
    rows: str = ""
    fine: bool = False
    tails: bool = False
    descriptive: bool = False

    def __getstate__(self) -> dict[str, Any]:
        # A finding that is copied or sent elsewhere keeps what its figures say of the coordinate;
        # functions without a name do not travel, and nothing is looked at anew there.
        return {**self.__dict__, "values": _left_behind, "factor": None}


def _left_behind(look: Look) -> FloatArray:
    raise TypeError("a coordinate of a copied finding only names what was seen")


ANGLE: Final = Coordinate(
    "angle", "angle in the turn, rad", False, lambda look: look.angle, fine=True
)
"""Residual that goes with the angle in the turn, whatever the direction."""
COORDINATES: Final = (
    Coordinate("velocity", "velocity, {x}/s", False, lambda look: look.velocity),
    Coordinate("speed", "speed, {x}/s", True, lambda look: np.abs(look.velocity), logarithmic=True),
    Coordinate("position", "position, {x}", False, lambda look: look.position, fine=True),
    Coordinate(
        "position along the motion", "position, {x}", True, lambda look: look.position, fine=True
    ),
    ANGLE,
    Coordinate(
        "angle along the motion", "angle in the turn, rad", True, lambda look: look.angle, fine=True
    ),
    Coordinate(
        "acceleration", "acceleration, {x}/s²", False, lambda look: look.acceleration, tails=True
    ),
    Coordinate("effort", "{e}, {f}", False, lambda look: look.effort, tails=True),
    Coordinate("rate of the effort", "rate of the effort, {f}/s", False, lambda look: look.rate),
    Coordinate(
        "distance since the reversal",
        "distance since the reversal, {x}",
        True,
        lambda look: look.travelled,
        logarithmic=True,
    ),
    Coordinate(
        "time since the reversal",
        "time since the reversal, s",
        True,
        lambda look: look.elapsed,
        logarithmic=True,
    ),
    Coordinate(
        "rest before the slide",
        "rest before the slide, s",
        True,
        lambda look: look.slides.rest,
        refines="time since the reversal",
        rows="where a slide begins",
        logarithmic=True,
    ),
    Coordinate(
        "loading before the slide",
        "loading before the slide, {f}/s",
        True,
        lambda look: look.slides.loading,
        refines="rate of the effort",
        rows="where a slide begins",
        logarithmic=True,
    ),
    Coordinate(
        "session time along the motion", "session clock, s", True, lambda look: look.time, slow=True
    ),
    Coordinate(
        "path along the motion",
        "path travelled in the session, {x}",
        True,
        lambda look: look.path,
        refines="session time along the motion",
        slow=True,
    ),
    Coordinate("load along the motion", "load, {f}", True, lambda look: look.load),
    Coordinate(
        "temperature along the motion", "temperature, degC", True, lambda look: look.temperature
    ),
)
"""Coordinates in which the rest is looked at."""
BRAKING: Final = Coordinate(
    "effort along the motion",
    "effort, braking below 0, {f}",
    True,
    lambda look: look.effort * look.direction,
    refines="effort",
)
"""Where braking and driving differ, as in a drive with a dead band. What is left is not judged by
it: braking comes after reversals, and there the curve of any law misses."""
BEND: Final = Coordinate(
    "fourth derivative of the position", "fourth derivative, {x}/s⁴", False, lambda look: look.bend
)
"""What a shaft that gives shows in. What is left is not judged by it: it is largest where a contact
breaks away, and there the curve of any law misses; the response to the effort tells of a shaft."""


LOOP: Final = Coordinate(
    "speed, speeding up or slowing down",
    "speed, slowing down below 0, {x}/s",
    True,
    lambda look: np.copysign(look.velocity, look.acceleration * look.direction),
)
"""Where speeding up and slowing down differ at one speed."""
CAUGHT: Final = Coordinate(
    "time since the acceleration turned round",
    "time since the acceleration turned round, s",
    False,
    lambda look: _since(np.sign(look.acceleration), look.time) * np.sign(look.acceleration),
)
"""Where a part that flew through a gap is caught. What is left is not judged by it."""
GIVEN: Final = Coordinate(
    "velocity, by what the effort gives",
    "velocity, {x}/s",
    False,
    lambda look: look.velocity,
    factor=lambda look: np.abs(look.effort),
    upright="residual over the size of the effort, %",
)
"""Where a drive gives less of what is asked the faster it runs."""
AGE: Final = Coordinate(
    "time since it was switched on",
    "time since the machine was switched on, s",
    True,
    lambda look: look.age,
    slow=True,
)
"""Where a machine that warms up shows it, however often it was cold. What is left is looked at over
the session clock: a machine that is another one on the next day shows that there."""
UNJUDGED: Final = (AGE, BEND, BRAKING, CAUGHT, GIVEN, LOOP)
"""Coordinates that single effects are drawn over; what is left is not judged by them."""


def looks(evidence: Evidence, plant: Plant, clocks: Sequence[float], window: float) -> list[Look]:
    """What the rows of each recording are looked at by.

    Parameters
    ----------
    evidence : Evidence
    plant : Plant
        Fitted.
    clocks : sequence of float
        When each recording starts on the session clock, s.
    window : float
        Displacement within which the contact counts as resting, rad or m.
    """
    return evidence.each(
        lambda each: _look(evidence, plant, clocks[each.index], window, each), evidence.shown
    )


def _look(evidence: Evidence, plant: Plant, clock: float, window: float, rows: Rows) -> Look:
    form = rows.form
    velocity = form.velocity
    usual = float(np.sqrt(np.mean(velocity**2)))
    direction = np.where(np.abs(velocity) > TURNING_SHARE * usual, np.sign(velocity), 0.0)
    direction = _carried(direction)
    last = _last_change(direction)
    position = form.mean(form.position[1:])
    effort = form.noise_free_effort(plant)
    spacing = form.dt * form.stride
    since: FloatArray = np.arange(len(direction), dtype=np.float64) - last
    pulled = effort - form.own(plant).inertia * form.acceleration
    asked = _asked(evidence.recordings[rows.index], form, plant)
    velocity, acceleration, driving = asked or (velocity, form.acceleration, effort)
    passed = form.time - evidence.recordings[rows.index].time[0]
    return Look(
        time=clock + passed,
        age=form.clock + passed,
        position=position,
        velocity=velocity,
        acceleration=acceleration,
        effort=effort,
        rate=np.gradient(driving, spacing),
        direction=direction,
        angle=np.mod(position, 2.0 * np.pi) if evidence.plant.motion == "rotary" else position,
        travelled=np.abs(position - position[last]),
        elapsed=since * spacing,
        path=form.path + np.cumsum(np.abs(np.diff(position, prepend=position[:1]))),
        bend=np.gradient(np.gradient(form.acceleration, spacing), spacing),
        load=_load(plant, form, position),
        temperature=np.full(len(form), np.nan)
        if form.temperature is None
        else form.mean(form.temperature[1:]),
        slides=slides_of(position, pulled, spacing, window),
    )


def _asked(
    recording: Recording, form: WeakForm, plant: Plant
) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Velocity, acceleration and effort that a controller was asked for, through the kernel.

    What a controller answers to noise goes with the noise: where the machine goes evenly, speed and
    effort change by nothing else, and what is left would depend on them. None where no reference
    is known, it has gaps, or the machine follows another motion.
    """
    reference = recording.channels.get("reference")
    if reference is None or len(reference) != len(form.position) or plant.servo:
        return None
    velocity = form.velocities(reference)
    missed = float(np.mean((velocity - form.velocity) ** 2))
    # Nor does NaN, of gaps, pass.
    if not missed <= MOST_MISSED**2 * float(np.mean(form.velocity**2)):
        return None
    acceleration = form.accelerations(reference)
    short = form.short(plant, position=reference, driven=False)
    return velocity, acceleration, form.own(plant).inertia * acceleration - short


def _load(plant: Plant, form: WeakForm, position: FloatArray) -> FloatArray:
    """What the gear transmits, else external effort and gravity; NaN where there is none."""
    if form.transmitted is not None:
        return form.mean(form.transmitted[1:])
    load = form.mean(form.load[1:])
    plant = form.own(plant)
    if plant.hangs:
        body = {name: parameter.value for name, parameter in plant.body.items()}
        angle = position - body.get("gravity_zero_rad", 0.0)
        return load - plant.gravity * np.sin(angle) - plant.weight
    return load if np.any(load) else np.full(len(form), np.nan)


def _last_change(values: FloatArray) -> np.ndarray:
    """Index at which each entry took its value."""
    turned = np.flatnonzero(np.diff(values)) + 1
    last = np.zeros(len(values), dtype=np.int64)
    last[turned] = turned
    return np.maximum.accumulate(last)


def _since(values: FloatArray, time: FloatArray) -> FloatArray:
    """Time since each entry took its value."""
    since: FloatArray = time - time[_last_change(values)]
    return since


def _carried(direction: FloatArray) -> FloatArray:
    """Directions with each 0 replaced by what was before it, at the start by what comes."""
    index = np.where(direction != 0.0, np.arange(len(direction)), 0)
    carried: FloatArray = direction[np.maximum.accumulate(index)]
    moving = carried[carried != 0.0]
    carried[carried == 0.0] = moving[0] if len(moving) else 1.0
    return carried
