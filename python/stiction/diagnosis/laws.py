"""Other friction laws in place of the plant's: causes of their own, beside the effects."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from ..catalogue import effects
from ..catalogue import laws as all_laws
from ..errors import InputError
from ..fitting.minimise import MOST_EVALUATIONS, launch
from ..fitting.start import complete, free_paths
from ..parameter import Parameter
from ..plant import Friction
from ..wording import did_you_mean, listed
from .decide import DECIDED_Z, heldout_gain
from .gain import Gain, HeldOut, gain_of
from .model import Model
from .result import Advice, LawRow
from .selection import Search

__all__ = ["THE_LAW", "Rival", "better_law", "law_names", "law_rows", "rivals_of"]

THE_LAW: Final = "the friction law"
"""What is left depends on, where another law leaves less of it."""
YIELDING: Final = "maxwell_slip"
"""Law that is tried unasked beside names given to a plant whose law does not yield: a contact that
does imitates many effects then."""
WORTH_A_TERM: Final = 0.95
"""Share of the power that an optional term of a law may leave at most to stay in a comparison."""
WORTH_MORE: Final = 0.1
"""Share of what is left with all effects that another law alone must remove to be the likelier
cause."""

_logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Rival:
    """Another law, fitted to the same rows with nothing added.

    Attributes
    ----------
    law : str
    asked : bool
        Whether somebody wanted to see it.
    model : Model or None
        None where it could not be fitted.
    beside : float
        Share that it removes, on rows that decide, of what the plant leaves with all its effects.
    z : float
        That over its standard error.
    """

    law: str
    asked: bool
    model: Model | None
    beside: float = 0.0
    z: float = 0.0

    @property
    def better(self) -> bool:
        """Whether it explains clearly more than what was named."""
        return self.beside > WORTH_MORE and self.z > DECIDED_Z

    def words(self, own: str, named: bool) -> str:
        """What that means, in a sentence."""
        summary = next(record.summary for record in all_laws() if record.name == self.law)
        beside = ", whatever is added to it" if named else ""
        return (
            f"The friction law itself lacks something: {self.law} ({summary}) leaves "
            f"{100 * self.beside:.0f} % less than {own}{beside}."
        )

    def advice(self) -> Advice:
        """What to do about it."""
        return Advice(
            f'state law = "{self.law}" in the plant file and diagnose again',
            "effects beside a law that lacks something stand for that",
            (),
        )


def law_names(wanted: Sequence[str], own: str) -> list[str]:
    """Laws to compare with the plant's own."""
    known = [record.name for record in all_laws()]
    if list(wanted) == ["all"]:
        return [name for name in known if name != own]
    for name in wanted:
        if name not in known:
            raise InputError(
                f"laws: '{name}' is unknown{did_you_mean(name, known)}; known are all, "
                f"{listed(known)}"
            )
    return [name for name in dict.fromkeys(wanted) if name != own]


def rivals_of(selection: Search, wanted: Sequence[str]) -> list[Rival]:
    """The laws to compare, fitted.

    Parameters
    ----------
    selection : Search
    wanted : sequence of str
        Names of laws that were asked for.
    """
    base, final = selection.models[0], selection.models[-1]
    names = list(wanted)
    rigid = not base.plant.friction.springy
    if rigid and selection.choices and YIELDING not in names:
        names.append(YIELDING)
    rivals = []
    for law in names:
        model = _fitted(base, law)
        if model is not None and model.solution.interrupted:
            # Half a fit is no fair comparison: what is known of the effects stays.
            selection.interrupted = True
            break
        beside, z = (0.0, 0.0) if model is None else heldout_gain(final, model)
        rivals.append(Rival(law, law in wanted, model, beside, z))
    return rivals


def better_law(rivals: Sequence[Rival]) -> Rival | None:
    """The law that explains most beside what was named, None where none does clearly."""
    better = [rival for rival in rivals if rival.better]
    return max(better, key=lambda rival: rival.beside) if better else None


def _fitted(base: Model, law: str) -> Model | None:
    """The plant with another law, fitted with the same weights; None where it cannot be.

    Terms of the law that a fit leaves alone and no effect would offer, such as the compliance of a
    rig, are tried as well, and stay where they leave less.
    """
    _logger.info("fitting law %s", law)
    record = next(each for each in all_laws() if each.name == law)
    offered = {term for effect in effects() for term in effect.law_terms}
    more = {
        each.name: Parameter(each.typical)
        for each in record.parameters
        if each.optional and each.neutral == 0.0 and each.name not in offered
    }
    plain = _launched(base, Friction(law))
    if not more or plain is None or plain.solution.interrupted:
        return plain
    full = _launched(base, Friction(law, {**plain.plant.friction.parameters, **more}))
    if full is None:
        return plain
    return full if _fitted_power(full) < WORTH_A_TERM * _fitted_power(plain) else plain


def _launched(base: Model, friction: Friction) -> Model | None:
    evidence = base.evidence
    try:
        bare = replace(base.plant, friction=friction)
        starts = complete(bare, [rows.form for rows in evidence.train])
        paths = free_paths(starts[0])
        return Model(evidence, launch(starts, paths, evidence.train, most=MOST_EVALUATIONS))
    except InputError as error:
        _logger.info("%s: %s", friction.law, error)
        return None


def _fitted_power(model: Model) -> float:
    """Weighted power that is left in the rows that were fitted."""
    return float(np.sum(model.residual[model.evidence.fitted] ** 2))


def law_rows(
    rivals: Sequence[Rival],
    first: int,
    test: HeldOut | None,
    seed: int,
    *,
    beside: Model | None = None,
) -> tuple[LawRow, ...]:
    """Laws with what they gain over the plant's own, the best first.

    Parameters
    ----------
    rivals : sequence of Rival
    first : int
        Place of the first of them among the models that were tested.
    test : HeldOut or None
    seed : int
    beside : Model, optional
        The plant's own law, where what matters lies in rows that were fitted: then it is told what
        each law leaves there.
    """
    rows = []
    index = first
    for rival in rivals:
        if rival.model is None:
            if rival.asked:
                rows.append(LawRow(rival.law, None, "could not be fitted to these data"))
            continue
        gain: Gain | None = None if test is None else gain_of(test, 0, index, seed)
        index += 1
        if not (rival.asked or rival.better):
            continue
        if gain is None:
            reason = "fitted, and no rows were left to test on"
        elif gain.ci95[0] > 0.0:
            reason = f"explains {100 * gain.value:.1f} % of what the plant's law leaves"
        elif gain.ci95[1] < 0.0:
            reason = f"leaves {1.0 - gain.value:.3g} times the power that the plant's law leaves"
        else:
            reason = "explains about as much as the plant's law"
        if beside is not None:
            left = _fitted_power(rival.model) / max(_fitted_power(beside), 1e-300)
            reason += f"; where it was fitted it leaves {left:.3g} times the power"
        rows.append(LawRow(rival.law, gain, reason))
    return tuple(sorted(rows, key=lambda r: -(r.gain.value if r.gain else -1e300)))
