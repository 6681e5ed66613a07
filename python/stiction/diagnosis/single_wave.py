"""A weight off the axis makes one wave a turn: what leaves more of a turn is another thing.

The form of an effect is its author's, and a machine's own leaves a rest of it. One wave is no
matter of form, so that a rest of it speaks against the name.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ..catalogue import EffectRecord, effects
from .coordinates import ANGLE
from .result import Cause, Unexplained

__all__ = ["doubted", "several"]


def several(record: EffectRecord) -> tuple[str, ...]:
    """Effects of several waves of which a single wave may be the first; empty for others."""
    if record.second:
        return ()
    return tuple(e.name for e in effects() if e.second and e.family == record.family)


def doubted(cause: Cause, left: Sequence[Unexplained]) -> Cause:
    """A cause; a single wave is undecided where what is left depends on the angle in the turn.

    Parameters
    ----------
    cause : Cause
    left : sequence of Unexplained
        What the last model leaves that noise does not explain.
    """
    record = next(each for each in effects() if each.name == cause.name)
    others = [name for name in several(record) if name not in cause.look_alikes]
    if not others or all(each.coordinate != ANGLE.name for each in left):
        return cause
    return replace(cause, decided=False, look_alikes=(*cause.look_alikes, *others))
