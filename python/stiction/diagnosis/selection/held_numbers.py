"""Numbers of the body that a plant file holds fixed, and whether the data agree with them."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

from ..._support.progress import phase
from ..._support.wording import join_words
from ...errors import InputError
from ...fitting.variables import unit_of
from ...recording import Check
from ..records import Advice, Unexplained
from ..screening.block_gains import heldout_gain
from ..screening.model import Model, without_effect
from .decide import LEAST_GAIN, LEAST_STRENGTH, LEAST_Z
from .search import Search
from .trials import whole_fit

__all__ = ["HELD", "Held", "fixed_parameters", "fixed_words"]

HELD: Final = {
    "inertia": "the inertia that is held fixed",
    "gravity_amplitude": "the gravity that is held fixed",
    "gravity_zero_rad": "the direction of gravity that is held fixed",
    "weight_n": "the weight that is held fixed",
}
"""Numbers of the body that may be measured wrong, and what is left by them is called."""
FILE: Final = "plant file"
"""Stands for the recording in a data check of the plant."""

_logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Held:
    """A number that is held, and what the data say of it.

    Attributes
    ----------
    name : str
        In the body of the plant.
    stated, found : float
        SI.
    ci95 : tuple of float
        Of the one that is found.
    unit : str
    share : float
        Of what is left on the rows that decide that goes once it is free.
    instead : tuple of str
        Causes in whose place it was free; none where it was beside all of them.
    """

    name: str
    stated: float
    found: float
    ci95: tuple[float, float]
    unit: str
    share: float
    instead: tuple[str, ...] = ()

    @property
    def remainders(self) -> tuple[Unexplained, ...]:
        """What is left because of it; nothing where a cause stands for it."""
        return () if self.instead else (Unexplained(HELD[self.name], self.share),)

    @property
    def what(self) -> str:
        """What was found."""
        low, high = self.ci95
        unit = f" {self.unit}" if self.unit else ""
        does = (
            f"explains as much as {join_words(self.instead)} {'do' if self.instead[1:] else 'does'}"
            if self.instead
            else f"takes {100 * self.share:.0f} % off what is left on rows held out"
        )
        return (
            f"{self.name} is held at {self.stated:.4g}{unit}; left free it comes to "
            f"{self.found:.4g}{unit} ({low:.4g} to {high:.4g}) and {does}"
        )

    @property
    def check(self) -> tuple[str, Check]:
        """The same among the data checks."""
        return FILE, Check(
            "held number",
            "note",
            self.what,
            "causes may stand for a number that is wrong, or the number for causes without a name",
            f"let it be fitted, {self.name} = {{ value = {self.stated:.4g} }}, and diagnose again; "
            "where it is known for sure, check scale and units of the effort",
        )

    @property
    def advice(self) -> Advice:
        """What to do about it."""
        return Advice(self.check[1].try_, f"in the plant file {self.what}", ())


def fixed_parameters(selection: Search) -> list[Held]:
    """Numbers held fixed of which the data tell another value, each once.

    A fit that may not move a number bends causes towards it. It is free beside everything that was
    named, and in the place of each name: what a cause explains, a number that is wrong explains as
    well. Simulated rows are not asked, for there every number bends the motion.

    Parameters
    ----------
    selection : Search

    Raises
    ------
    KeyboardInterrupt
    """
    model = selection.models[-1]
    body = model.plant.body
    if model.evidence.simulated:
        return []
    asked = [name for name in HELD if name in body and body[name].fixed]
    causes = [choice.winner.name for choice in selection.choices]
    found = (_first(model, name, causes) for name in asked)
    return [each for each in found if each is not None]


def _first(model: Model, name: str, causes: Sequence[str]) -> Held | None:
    """The number in the place of all causes, of the latest that it does as well as, or beside."""
    if name == "inertia" and model.plant.prescribed_motion:
        return None
    phase(_logger, "asking whether %s fits", name)
    places = dict.fromkeys([tuple(causes), *((each,) for each in reversed(causes)), ()])
    return next(filter(None, (_asked(model, name, place) for place in places)), None)


def _asked(model: Model, name: str, instead: tuple[str, ...]) -> Held | None:
    """The number in the place of causes; None where it does not do as well, or stays what it is."""
    plant = model.plant
    for cause in instead:
        plant = without_effect(plant, cause)
    own = plant.body[name]
    free = replace(plant, body={**plant.body, name: replace(own, fixed=False)})
    try:
        freed = whole_fit(model.evidence, free, model.nuisances)
    except InputError:
        # Bounds that hold nothing but the number itself.
        return None
    share, z = heldout_gain(model, freed)
    told = freed.fit_result.parameters[f"body.{name}"]
    if not abs(told.value - own.value) > LEAST_STRENGTH * told.stderr:
        return None
    if share <= 0.0 if instead else (share <= LEAST_GAIN or z <= LEAST_Z):
        return None
    unit = unit_of(plant, f"body.{name}")
    return Held(name, own.value, told.value, told.ci95, unit, share, instead)


def fixed_words(held: Sequence[Held]) -> str:
    """All of them in words, "" without any."""
    return " ".join(f"In the plant file {each.what}." for each in held)
