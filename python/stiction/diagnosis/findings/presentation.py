"""How an effect is shown: its name in the field, its picture, and its words on other machines.

One entry for each effect of the catalogue: whatever a report says of an effect beyond the facts of
its record stands here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from ..._support.arrays import FloatArray
from ..adequacy.coordinates import Look

__all__ = ["PRESENTATIONS", "SLIDING", "Presentation", "Wave", "Words", "contact_slides"]

SLIDING: Final = "where the contact slides"


@dataclass(frozen=True)
class Wave:
    """The period of an effect that repeats with position, at the order that was found.

    Attributes
    ----------
    odd : bool
        The residual is counted along the motion.
    factor : callable, optional
        From a ``Look`` to what the residual grows with.
    upright : str
        What the vertical axis says then.
    where : callable, optional
        From a ``Look`` to the rows that count; all of them without it.
    rows : str
        Those in words.
    """

    odd: bool = False
    factor: Callable[[Look], FloatArray] | None = None
    upright: str = ""
    where: Callable[[Look], np.ndarray] | None = None
    rows: str = ""


class Words(NamedTuple):
    """What an effect means, and what to do about it."""

    means: str
    remedy: str


@dataclass(frozen=True)
class Presentation:
    """What a report shows of an effect.

    Attributes
    ----------
    over : str or Wave
        Where it shows: a coordinate by its name, or its own period.
    title : str
        What an engineer calls it; "" where that is its name in words.
    linear, moved : Words, optional
        Words in place of those of the catalogue, which speak of a machine that turns: for one that
        does not, and for a rig that moves a specimen and measures the effort.
    """

    over: str | Wave
    title: str = ""
    linear: Words | None = None
    moved: Words | None = None


def contact_slides(look: Look) -> np.ndarray:
    """Where the contact slides: at rest its friction is what pulls at it, whatever its level."""
    return np.asarray(look.slides.slid > 0.0)


def _turns_evenly(look: Look) -> np.ndarray:
    """Where an error of the reading shows by the square of speed, and less by acceleration."""
    return np.asarray(look.velocity**2 > np.abs(look.acceleration))


PRESENTATIONS: Final[dict[str, Presentation]] = {
    "back_emf": Presentation(title="back-EMF", over="velocity, by what the effort gives"),
    "backlash": Presentation(
        over="time since the acceleration turned round",
        moved=Words(
            "at each change of the effort's sign the grip is lost and caught again over a gap",
            "preload the fixture; look for a worn pin, a loose clevis or coupling",
        ),
    ),
    "cogging": Presentation(
        over=Wave(),
        moved=Words(
            "an effort repeats with position, whatever the direction",
            "state it as an effect of the plant; look for what repeats over that distance: teeth, "
            "magnets, coils",
        ),
    ),
    "creep_hardening": Presentation(title="creep with hardening", over="time since the reversal"),
    "current_loop_lag": Presentation(title="lag of the current loop", over="rate of the effort"),
    "direction_asymmetry": Presentation(
        title="friction that differs by direction",
        over="velocity",
        linear=Words(
            "a compensation with one friction level for both directions is wrong in each",
            "give the compensation a level for each direction; look for a preload to one side, a "
            "wiper or seal lip, a cable chain, or a screw that drives one way more easily",
        ),
        moved=Words(
            "the force is higher in one direction: one level for both is wrong in each",
            "give the model a level for each direction; look for a valve or seal that acts one "
            "way, or for gas pressure",
        ),
    ),
    "drive_deadband": Presentation(title="dead band of the drive", over="effort along the motion"),
    "drive_saturation": Presentation(title="saturation of the drive", over="effort"),
    "dwell_strengthening": Presentation(
        title="strengthening at rest",
        over="rest before the slide",
        moved=Words(
            "the longer it has stood, the more it takes to start it",
            "state the growth in the law; look for grease that is squeezed out, for seals that "
            "stick, or for a contact that ages",
        ),
    ),
    "effort_dependent_friction": Presentation(
        title="effort-dependent friction",
        over="effort along the motion",
        moved=Words(
            "friction grows with the effort that moves the contact",
            "measure at the efforts that matter, and record them",
        ),
    ),
    "encoder_eccentricity": Presentation(
        title="eccentric encoder",
        over=Wave(
            factor=lambda look: look.velocity**2,
            upright="residual over speed², {f}·s²/{x}²",
            where=_turns_evenly,
            rows="where the squared speed is larger than the acceleration",
        ),
    ),
    "frictional_lag": Presentation(
        over="speed, speeding up or slowing down",
        moved=Words(
            "friction is not a function of speed: it is higher while speeding up than while "
            "slowing down",
            "use a law with internal states",
        ),
    ),
    "goal_rate_limit": Presentation(title="rate limit of the setpoint", over="effort"),
    "gravity_unbalance": Presentation(
        over=Wave(),
        moved=Words(
            "a weight off the axis pulls towards one angle",
            "balance the moving part, or state the gravity in the plant",
        ),
    ),
    "input_delay": Presentation(over="rate of the effort"),
    "load_dependent_friction": Presentation(
        title="load-dependent friction",
        over="load along the motion",
        moved=Words(
            "friction grows with the load: what was measured at one load does not hold at another",
            "measure at the loads that matter, and record the load",
        ),
    ),
    "position_dependent_friction": Presentation(
        title="position-dependent friction", over=Wave(odd=True, where=contact_slides, rows=SLIDING)
    ),
    "rate_dependent_breakaway": Presentation(
        title="rate-dependent break-away",
        over="loading before the slide",
        moved=Words(
            "slow loading sticks harder than fast loading",
            "state it in the law, and measure at the rates that matter",
        ),
    ),
    "relaxation": Presentation(
        over="time since the reversal",
        moved=Words(
            "a force set by motion fades while the motion is held",
            "wait until it has died out, or unload between tests; a law with creep (hsieh_pan) "
            "simulates it",
        ),
    ),
    "reverse_point_memory": Presentation(
        title="reversal-point memory",
        over="distance since the reversal",
        moved=Words(
            "near a reversal the contact yields like a spring: small moves come back, and small "
            "loops close",
            "use a law with memory of reverse points (maxwell_slip, hsieh_pan)",
        ),
    ),
    "run_in": Presentation(
        title="running-in",
        over="path, in slides",
        moved=Words(
            "the specimen eases with motion, not with time",
            "run it in before measuring: some full strokes after each long rest",
        ),
    ),
    "shaft_compliance": Presentation(
        title="compliant shaft",
        over="fourth derivative of the position",
        moved=Words(
            "the specimen does not follow the actuator at once: what holds it gives",
            "measure the motion at the specimen; look for a soft fixture or a loose joint",
        ),
    ),
    "stribeck": Presentation(
        title="Stribeck friction",
        over="speed",
        moved=Words(
            "friction falls with speed at first",
            "state the fall in the law; look for the seals and their lubricant",
        ),
    ),
    "temperature_dependent_friction": Presentation(
        title="temperature-dependent friction",
        over="temperature along the motion",
        moved=Words(
            "what was measured at one temperature does not hold at another",
            "bring the specimen to temperature first, and record it",
        ),
    ),
    "torque_bias": Presentation(
        title="constant offset of the effort",
        over="velocity",
        linear=Words(
            "a constant force pulls one way, at rest too",
            "add it as a feed-forward; look for an axis that is not level, a weight or spring, a "
            "cable chain, the offset of an amplifier or current sensor",
        ),
        moved=Words(
            "a constant effort pulls one way, at rest too",
            "state it as an effect of the plant; look for the offset of the load cell, a weight "
            "that hangs on it, gas pressure or a spring",
        ),
    ),
    "torque_constant_ripple": Presentation(
        title="torque ripple",
        over=Wave(factor=lambda look: look.effort, upright="residual over effort, %"),
        linear=Words(
            "the same current gives more force at some places than at others",
            "tabulate the gain over the position and divide the command by it; look for a wrong "
            "commutation, an offset in one phase current, or a magnet that is off",
        ),
    ),
    "torque_constant_saturation": Presentation(
        title="saturation of the torque constant", over="effort"
    ),
    "viscous_quadratic": Presentation(
        title="quadratic viscous friction",
        over="high speed",
        moved=Words(
            "drag at high speed is more than proportional to it",
            "state the term; look for an orifice, turbulent flow or a fan",
        ),
    ),
    "voltage_limit": Presentation(title="voltage limit", over="velocity, by what the effort gives"),
    "warm_up": Presentation(
        title="warming up",
        over="time switched on, in slides",
        moved=Words(
            "what was measured cold does not hold warm",
            "warm the specimen up before measuring, or record its temperature",
        ),
    ),
}
"""By the name of the effect; a test asks for an entry of each effect of the catalogue."""
