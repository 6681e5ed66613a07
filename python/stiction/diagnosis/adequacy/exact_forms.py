"""Names that leave no rest of one kind: one wave a turn, what a reading makes of it, a direction.

The form of an effect is its author's, and a machine's own leaves a rest of it. One wave is no
matter of form, so that a rest of it speaks against the name: a weight off the axis leaves nothing
over the angle, and a disc off centre nothing that repeats with position and grows with
acceleration. An inertia that changes with the angle looks much like such a disc, but what goes with
the squared speed is half as much.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from ...catalogue import EffectRecord, effects
from ..phrases import LEAVES_NOTHING
from ..records import Cause, Unexplained
from .coordinates import ANGLE
from .omnibus import Rest
from .periodic import WITH_ACCELERATION, WITH_SQUARED_SPEED

__all__ = ["doubt_geometry", "exact_in", "rests_of", "several"]

LEAST_REST: Final = 0.02
"""Share of what the names took from which on such a rest counts: a large wave, a little off, leaves
a little of everything."""


def several(record: EffectRecord) -> tuple[str, ...]:
    """Effects of several waves of which a single wave may be the first; empty for others."""
    if record.second:
        return ()
    return tuple(e.name for e in effects() if e.second and e.family == record.family)


def exact_in(name: str) -> tuple[str, ...]:
    """Coordinates in which an effect leaves nothing once it is named; none of most.

    Beside a wave, what repeats with position and grows with acceleration or squared speed is an
    inertia that changes, or an encoder that errs several times a turn. Beside another friction in
    either direction, what goes with the effort is a drive that gives more in one direction than in
    the other.
    """
    record = effects()[name]
    if record.second or record.misreads:
        return WITH_ACCELERATION.name, WITH_SQUARED_SPEED.name
    return ("effort",) if record.two_levels else ()


def doubt_geometry(
    cause: Cause, left: Sequence[Unexplained], rests: Sequence[Unexplained]
) -> Cause:
    """A cause; undecided where what is left depends on what its geometry leaves nothing of.

    Parameters
    ----------
    cause : Cause
    left : sequence of Unexplained
        What the last model leaves that noise does not explain.
    rests : sequence of Unexplained
        What it leaves where names leave nothing, as ``rests_of`` tells.
    """
    for each in rests:
        if each.coordinate in exact_in(cause.name):
            return replace(cause, decided=False, doubt=LEAVES_NOTHING.format(each.coordinate))
    record = next(each for each in effects() if each.name == cause.name)
    others = [name for name in several(record) if name not in cause.look_alikes]
    if not others or all(each.coordinate != ANGLE.name for each in left):
        return cause
    return replace(cause, decided=False, look_alikes=(*cause.look_alikes, *others))


def rests_of(causes: Sequence[Cause], left: Rest, beside: float) -> tuple[Unexplained, ...]:
    """What is left where named causes leave nothing, however little of it there is.

    Parameters
    ----------
    causes : sequence of Cause
    left : Rest
        What the last model leaves, in every coordinate.
    beside : float
        Power of all that is left over that of what the names took.
    """
    asked = {name for cause in causes for name in exact_in(cause.name)}
    return tuple(
        Unexplained(view.coordinate.name, view.share)
        for view in left.views
        if view.coordinate.name in asked and view.share > view.threshold
        if view.share * beside > LEAST_REST
    )
