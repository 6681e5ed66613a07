"""What to do about a cause, in words that fit the kind of machine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from ..catalogue import EffectRecord, effects
from ..plant import Plant

__all__ = ["experiment_words", "meaning_of"]

_Words = Mapping[str, tuple[str, str]]

LINEAR: Final[_Words] = {
    "direction_asymmetry": (
        "a compensation with one friction level for both directions is wrong in each",
        "give the compensation a level for each direction; look for a preload to one side, a wiper "
        "or seal lip, a cable chain, or a screw that drives one way more easily",
    ),
    "torque_bias": (
        "a constant force pulls one way, at rest too",
        "add it as a feed-forward; look for an axis that is not level, a weight or spring, a cable "
        "chain, the offset of an amplifier or current sensor",
    ),
    "torque_constant_ripple": (
        "the same current gives more force at some places than at others",
        "tabulate the gain over the position and divide the command by it; look for a wrong "
        "commutation, an offset in one phase current, or a magnet that is off",
    ),
}
"""Meaning and remedy where a machine does not turn."""
MOVED: Final[_Words] = {
    "direction_asymmetry": (
        "the force is higher in one direction: one level for both is wrong in each",
        "give the model a level for each direction; look for a valve or seal that acts one way, or "
        "for gas pressure",
    ),
    "torque_bias": (
        "a constant effort pulls one way, at rest too",
        "state it as an effect of the plant; look for the offset of the load cell, a weight that "
        "hangs on it, gas pressure or a spring",
    ),
    "viscous_quadratic": (
        "drag at high speed is more than proportional to it",
        "state the term; look for an orifice, turbulent flow or a fan",
    ),
    "stribeck": (
        "friction falls with speed at first",
        "state the fall in the law; look for the seals and their lubricant",
    ),
    "warm_up": (
        "what was measured cold does not hold warm",
        "warm the specimen up before measuring, or record its temperature",
    ),
    "run_in": (
        "the specimen eases with motion, not with time",
        "run it in before measuring: some full strokes after each long rest",
    ),
    "backlash": (
        "at each change of the effort's sign the grip is lost and caught again over a gap",
        "preload the fixture; look for a worn pin, a loose clevis or coupling",
    ),
    "cogging": (
        "an effort repeats with position, whatever the direction",
        "state it as an effect of the plant; look for what repeats over that distance: teeth, "
        "magnets, coils",
    ),
    "dwell_strengthening": (
        "the longer it has stood, the more it takes to start it",
        "state the growth in the law; look for grease that is squeezed out, for seals that stick, "
        "or for a contact that ages",
    ),
    "frictional_lag": (
        "friction is not a function of speed: it is higher while speeding up than while slowing "
        "down",
        "use a law with internal states",
    ),
    "gravity_unbalance": (
        "a weight off the axis pulls towards one angle",
        "balance the moving part, or state the gravity in the plant",
    ),
    "load_dependent_friction": (
        "friction grows with the load: what was measured at one load does not hold at another",
        "measure at the loads that matter, and record the load",
    ),
    "rate_dependent_breakaway": (
        "slow loading sticks harder than fast loading",
        "state it in the law, and measure at the rates that matter",
    ),
    "relaxation": (
        "a force set by motion fades while the motion is held",
        "wait until it has died out, or unload between tests; a law with creep (hsieh_pan) "
        "simulates it",
    ),
    "reverse_point_memory": (
        "near a reversal the contact yields like a spring: small moves come back, and small loops "
        "close",
        "use a law with memory of reverse points (maxwell_slip, hsieh_pan)",
    ),
    "shaft_compliance": (
        "the specimen does not follow the actuator at once: what holds it gives",
        "measure the motion at the specimen; look for a soft fixture or a loose joint",
    ),
    "temperature_dependent_friction": (
        "what was measured at one temperature does not hold at another",
        "bring the specimen to temperature first, and record it",
    ),
}
"""Meaning and remedy where a rig moves a specimen and measures the effort."""
RISING_LAG: Final = (
    "friction is not a function of speed: it rises with speed, and late, so that it is lower while "
    "speeding up than while slowing down"
)
"""What frictional_lag means where its excess is negative."""
FALLING_LAG: Final = (
    "friction that falls with speed makes slow motion jerk, and it falls late: it is higher while "
    "speeding up than while slowing down, which steadies stick-slip and fools a compensation by "
    "speed"
)
"""What it means where the fall itself comes with it..."""
MOVED_FALLING_LAG: Final = (
    "friction falls with speed, and late: it is higher while speeding up than while slowing down"
)
"""... and where a rig moves a specimen."""
MOTIONS: Final = {
    "ramps": "constant speeds over three decades, both ways, without rests",
    "turns": "slow full strokes or turns both ways, twice",
    "fast": "fast constant speed over the whole range, both ways",
    "sines": "sines over amplitude and frequency: the same speeds at different accelerations",
    "dwells": "rests of 0.1 to 5 s, each ended slowly and fast",
    "loops": "small loops nested in one another, and holds of 5 s and more",
    "rests": "5 s of rest and 5 s of constant speed",
    "cycle": "a short cycle from cold, again after minutes of rest, again after long fast motion",
    "tracking": "sines of many frequencies at once",
    "pulses": "quick moves with rests between them",
    "chirp": "sines of rising frequency at one amplitude of the motion",
}
"""What a rig that prescribes the motion does in place of each experiment of ``stiction plan``."""
GOALS: Final = {
    "pulses": "large and small steps, with and without a known load",
    "loops": "small moves nested in one another about a rest, and holds of 5 s and more",
    "chirp": "sines of rising frequency at one amplitude",
}
"""What the goals of a servo do in place of the experiments of ``stiction plan`` that it cannot
make: it is told where to go, not what to push with."""

OFFSETS: Final = "offset"
"""Family of effects that a machine which is turned round tells apart."""
REVERSED: Final = (
    "mount it the other way round and record the same again: an effort from outside turns over "
    "with the mount, friction does not"
)
"""In place of loops below break-away, of which a contact without a spring has none."""


def meaning_of(record: EffectRecord, plant: Plant) -> tuple[str, str]:
    """What an effect means, and what to do about it."""
    usual = record.means, record.remedy
    if plant.prescribed_motion:
        usual = MOVED.get(record.name, usual)
    elif plant.motion == "linear":
        usual = LINEAR.get(record.name, usual)
    effect = next((each for each in plant.effects if each.name == record.name), None)
    if record.name != "frictional_lag" or effect is None:
        return usual
    excess, fall = (effect.parameters.get(name) for name in ("excess", "fall"))
    if excess is not None and excess.value < 0.0:
        # What comes late is a rise of friction with speed, and its loop runs the other way round.
        return RISING_LAG, usual[1]
    if fall is None or fall.value == 0.0:
        return usual
    return MOVED_FALLING_LAG if plant.prescribed_motion else FALLING_LAG, usual[1]


def experiment_words(plan: str, what: str, plant: Plant, separates: Sequence[str] = ()) -> str:
    """An experiment in words: one of ``stiction plan``, or a motion where a rig prescribes it.

    A servo that cannot make it is sent goals of another kind. Where there is no pre-sliding no loop
    tells of it: what is of the machine is told from what is not by its mount, and "" of all else.
    """
    if plan == "loops" and not plant.friction.springy and not plant.prescribed_motion:
        families = {record.name: record.family for record in effects()}
        return REVERSED if any(families[name] == OFFSETS for name in separates) else ""
    if plant.servo and plan in GOALS:
        return f"send it goals: {GOALS[plan]}"
    return f"move it by {MOTIONS[plan]}" if plant.prescribed_motion else f"{plan}: {what}"
