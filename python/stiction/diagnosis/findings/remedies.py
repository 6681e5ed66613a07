"""What to do about a cause, in words that fit the kind of machine."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from ...catalogue import EffectRecord, effects
from ...plant import Plant
from .presentation import PRESENTATIONS, Words

__all__ = ["experiment_words", "meaning_of"]

RISING_LAG: Final = (
    "friction is not a function of speed: it rises with speed, and late, so that it is lower while "
    "speeding up than while slowing down"
)
"""What friction that lags means where its excess is negative."""
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


def meaning_of(record: EffectRecord, plant: Plant) -> Words:
    """What an effect means, and what to do about it."""
    usual = Words(record.means, record.remedy)
    shown = PRESENTATIONS.get(record.name)
    if shown is not None and plant.prescribed_motion:
        usual = shown.moved or usual
    elif shown is not None and plant.motion == "linear":
        usual = shown.linear or usual
    effect = next((each for each in plant.effects if each.name == record.name), None)
    if not record.friction_lags or effect is None:
        return usual
    excess, fall = (effect.parameters.get(name) for name in ("excess", "fall"))
    if excess is not None and excess.value < 0.0:
        # What comes late is a rise of friction with speed, and its loop runs the other way round.
        return Words(RISING_LAG, usual.remedy)
    if fall is None or fall.value == 0.0:
        return usual
    return Words(MOVED_FALLING_LAG if plant.prescribed_motion else FALLING_LAG, usual.remedy)


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
