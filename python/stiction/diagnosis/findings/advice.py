"""What to record next."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from ..._support.wording import join_words
from ...catalogue import EffectRecord, effects
from ...plant import Plant
from ...recording import Check
from ..adequacy.by_recording import GAIN, INERTIA
from ..adequacy.passing import MOMENTS
from ..records import Advice, Cause, Unexplained
from .remedies import experiment_words

__all__ = ["advise"]

_RAMPS: Final = ("ramps", "two-way ramps of constant speed over three decades, without rests")
_TURNS: Final = ("turns", "slow full turns (or full strokes) both ways, twice")
_FULL_TURNS: Final = ("turns", "slow full turns both ways, twice")
_CHIRP: Final = ("chirp", "a chirp of the input up to a tenth of the sampling rate")
_DWELLS: Final = ("dwells", "rests of 0.1 to 5 s, each followed by slow and by fast loading")
_CYCLE: Final = (
    "cycle",
    "once more from cold, added to this session with cold = true: a short cycle, again after "
    "minutes of rest, again after long fast motion",
)
BY_COORDINATE: Final = {
    MOMENTS.name: (
        "rests",
        "5 s of rest and 5 s of constant speed, with what runs nearby on and off",
    ),
    "velocity": _RAMPS,
    "speed": _RAMPS,
    "position": _TURNS,
    "position along the motion": _TURNS,
    "angle": _FULL_TURNS,
    "angle along the motion": _FULL_TURNS,
    "order over position": _TURNS,
    "order along the motion": _TURNS,
    "order over position, times acceleration": (
        "fast",
        "fast constant speed over many turns, and sines of high acceleration",
    ),
    "order over position, times squared speed": (
        "fast",
        "fast constant speed over many turns, both ways",
    ),
    "order over position, times effort": (
        "sines",
        "sines of high acceleration, and slow full turns (or full strokes) with loads either way",
    ),
    "response to the effort": _CHIRP,
    "frequency": (
        "rests",
        "5 s of rest and 5 s of constant speed, with what runs nearby on and off",
    ),
    "acceleration": (
        "sines",
        "sines of one speed at different frequencies, so that accelerations differ",
    ),
    "rest before the slide": _DWELLS,
    "loading before the slide": (
        "dwells",
        "equal rests, each followed by another rate of loading over two decades",
    ),
    "path along the motion": _CYCLE,
    "effort": (
        "pulses",
        "large efforts at low acceleration, and the same accelerations with a known load",
    ),
    "rate of the effort": _CHIRP,
    "distance since the reversal": ("loops", "small loops below break-away, nested, with holds"),
    "time since the reversal": _DWELLS,
    "load along the motion": (
        "ramps",
        "steps of a known load at constant speed, both ways",
    ),
    "temperature along the motion": (
        "cycle",
        "one short cycle repeated at several temperatures, heated by other means than by running",
    ),
    "session time": _CYCLE,
    "session time along the motion": _CYCLE,
}
"""An experiment of `stiction plan`, and what matters in it, that shows more of what depends on a
coordinate."""
APART: Final = {
    INERTIA.name: "say what was changed between the recordings: state payload_kg of each where "
    "something else hung on the machine, or diagnose those before and after apart",
    GAIN.name: "look for what scales the input in some recordings alone, as a supply, a setting of "
    "the drive or of the logger, or diagnose those before and after apart",
}
"""What to do where each recording by itself is explained, and no plant explains all of them."""


def advise(
    causes: Sequence[Cause],
    unexplained: Sequence[Unexplained],
    blind: Sequence[EffectRecord],
    checks: Sequence[tuple[str, Check]],
    plant: Plant,
    *,
    unseen: Sequence[str] = (),
) -> tuple[Advice, ...]:
    """Experiments, the most useful first.

    Parameters
    ----------
    causes : sequence of Cause
        Undecided ones are told apart by the experiments of their effects.
    unexplained : sequence of Unexplained
    blind : sequence of EffectRecord
        Effects that these data could not show before the causes were there.
    checks : sequence of (str, Check)
        Recording and what was found in it.
    plant : Plant
        Whether it is driven, or moved by a rig.
    unseen : sequence of str
        Effects of which what was fitted leaves no doubt, and which hardly act in what decides.
    """
    records = {record.name: record for record in effects()}
    advice: dict[str, Advice] = {}

    def add(plan: str, what: str, reason: str, separates: tuple[str, ...] = ()) -> None:
        # The first reason to record an experiment is the best one.
        if words := experiment_words(plan, what, plant, separates):
            advice.setdefault(plan, Advice(words, reason, separates))

    for cause in causes:
        names = (cause.name, *cause.look_alikes)
        for name in () if cause.decided or not cause.look_alikes else names:
            record = records[name]
            add(record.plan, record.experiment, f"it tells {join_words(names)} apart", names)
    for name in unseen:
        record = records[name]
        reason = f"recordings that decide cannot judge {name}, which shows in those that train"
        add(record.plan, record.experiment, reason, (name,))
    for left in unexplained[:2]:
        if left.coordinate in APART:
            reason = f"what is left goes with the {left.coordinate}"
            advice.setdefault(left.coordinate, Advice(APART[left.coordinate], reason, ()))
        if left.coordinate in BY_COORDINATE:
            reason = f"what is left depends on {left.coordinate}, and more of it shows how"
            add(*BY_COORDINATE[left.coordinate], reason)
    # A channel that nobody recorded, a load or a temperature, may well not be there: that is told
    # among the candidates, and is nothing to ask of everybody.
    told = {cause.name for cause in causes}
    for record in (each for each in blind if not each.channels and each.name not in told):
        reason = f"these data cannot show {record.name}"
        add(record.plan, record.experiment, reason, (record.name,))
    remedies = []
    for name, check in checks:
        if check.verdict == "fault" and check.try_:
            remedies.append(Advice(check.try_, f"{name}: {check.what}", ()))
    return (*advice.values(), *remedies)
