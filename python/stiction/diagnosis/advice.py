"""What to record next."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from ..catalogue import EffectRecord, effects
from ..recording import Check
from .result import Advice, Cause, Unexplained
from .words import joined

__all__ = ["NO_COORDINATE", "advise"]

BY_COORDINATE: Final = {
    "velocity": "two-way ramps of constant speed over three decades, without rests",
    "speed": "two-way ramps of constant speed over three decades, without rests",
    "position": "slow full turns (or full strokes) both ways, twice",
    "position along the motion": "slow full turns (or full strokes) both ways, twice",
    "angle": "slow full turns both ways, twice",
    "angle along the motion": "slow full turns both ways, twice",
    "order over position": "slow full turns (or full strokes) both ways, twice",
    "order along the motion": "slow full turns (or full strokes) both ways, twice",
    "order over position, times acceleration": "fast constant speed over many turns, and sines of "
    "high acceleration",
    "order over position, times effort": "slow full turns (or full strokes) with loads either way",
    "response to the effort": "a chirp of the input up to a tenth of the sampling rate",
    "frequency": "5 s of rest and 5 s of constant speed, with what runs nearby on and off",
    "acceleration": "sines of one speed at different frequencies, so that accelerations differ",
    "rest before the slide": "rests of 0.1 to 5 s, each followed by slow and by fast loading",
    "loading before the slide": "equal rests, each followed by another rate of loading over two "
    "decades",
    "path along the motion": "a short reference cycle at start, middle and end, and one long rest",
    "effort": "large efforts at low acceleration, and the same accelerations with a known load",
    "rate of the effort": "a chirp of the input up to a tenth of the sampling rate",
    "distance since the reversal": "small loops below break-away, nested, with holds",
    "time since the reversal": "rests of 0.1 to 5 s, each followed by slow and by fast loading",
    "session time": "a short reference cycle at start, middle and end, and one long rest",
    "session time along the motion": "a short reference cycle at start, middle and end, and one "
    "long rest",
}
"""An experiment that shows more of what depends on a coordinate."""
NO_COORDINATE: Final = "nothing that was looked at"
"""Where more is left than noise and it shows in no coordinate."""


def advise(
    causes: Sequence[Cause],
    unexplained: Sequence[Unexplained],
    blind: Sequence[EffectRecord],
    checks: Sequence[tuple[str, Check]],
) -> tuple[Advice, ...]:
    """Experiments, the most useful first.

    Parameters
    ----------
    causes : sequence of Cause
        Undecided ones are told apart by the experiments of their effects.
    unexplained : sequence of Unexplained
    blind : sequence of EffectRecord
        Effects that these data could not show.
    checks : sequence of (str, Check)
        Recording and what was found in it.
    """
    records = {record.name: record for record in effects()}
    advice: list[Advice] = []
    for cause in causes:
        if cause.decided:
            continue
        names = (cause.name, *cause.look_alikes)
        for name in names:
            experiment = records[name].experiment
            if all(experiment != given.experiment for given in advice):
                reason = f"it tells {joined(names)} apart"
                advice.append(Advice(experiment, reason, names))
    for left in unexplained[:2]:
        if left.coordinate == NO_COORDINATE:
            continue
        experiment = BY_COORDINATE[left.coordinate]
        if all(experiment != given.experiment for given in advice):
            reason = (
                f"what is left depends on {left.coordinate}, and more of it is needed to see how"
            )
            advice.append(Advice(experiment, reason, ()))
    for record in blind:
        reason = f"these data cannot show {record.name}"
        advice.append(Advice(record.experiment, reason, (record.name,)))
    for name, check in checks:
        if check.verdict == "fault" and check.try_:
            advice.append(Advice(check.try_, f"{name}: {check.what}", ()))
    return tuple(advice)
