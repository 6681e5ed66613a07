"""What a plant file states of its contact: a law, and effects beside it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from .._native import FrictionModel
from .._support.frozen import Frozen, freeze
from .._support.given import instance, mapping, word
from .._support.wording import commas, did_you_mean
from ..catalogue import EffectRecord, LawRecord, effects, laws
from ..errors import UnknownName
from .parameter import Parameter

__all__ = ["Effect", "Friction", "check_parameters"]


def check_parameters(given: Mapping[str, Parameter], where: str) -> None:
    """Refuse what is put together by hand and holds something else than parameters.

    Raises
    ------
    InputError
    """
    for name, value in mapping(given, where, "Parameters by name").items():
        instance(value, Parameter, f"{where} {name}", "a Parameter of stiction.plant")


def check_name(name: str, records: Iterable[LawRecord | EffectRecord], where: str) -> None:
    """Refuse what is no name of the catalogue.

    Raises
    ------
    InputError
        No word.
    UnknownName
    """
    names = [record.name for record in records]
    if word(name, where) not in names:
        near = did_you_mean(name, names)
        raise UnknownName(f"{where} '{name}' is unknown{near}; known: {commas(names)}")


@dataclass(frozen=True)
class Friction:
    """A law with the parameters and options that the file states.

    Attributes
    ----------
    law : str
        A name of ``stiction.laws()``.
    parameters : Mapping of str to Parameter
        What is stated; the rest takes the catalogue's defaults.
    options : Mapping of str to str
        Words that the law's record lists.

    Raises
    ------
    InputError
        An unknown law, or parameters that are none.
    """

    law: str
    parameters: Mapping[str, Parameter] = field(default_factory=dict)
    options: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_name(self.law, laws(), "friction: law")
        freeze(self, Frozen, "parameters", "options")
        check_parameters(self.parameters, "friction:")

    def model(self) -> FrictionModel:
        """The friction model; what is not stated takes the catalogue's default."""
        values = {name: parameter.value for name, parameter in self.parameters.items()}
        return FrictionModel(self.law, **values, **self.options)

    @property
    def record(self) -> LawRecord:
        """The catalogue's record of the law."""
        return next(record for record in laws() if record.name == self.law)

    @property
    def springy(self) -> bool:
        """Whether the contact yields before it slides, so that displacements count as they are."""
        return any(parameter.name == "initial_stiffness" for parameter in self.record.parameters)

    @property
    def sticks(self) -> bool:
        """Whether the contact rests rigidly, in a mode of its own, until it breaks away."""
        return "mode" in self.record.outputs and not self.springy

    @property
    def random(self) -> bool:
        """Whether places of its contact are drawn: what it does next hangs on the last digits."""
        return any(parameter.name == "seed" for parameter in self.record.parameters)


@dataclass(frozen=True)
class Effect:
    """An effect with the parameters that the file states.

    Attributes
    ----------
    name : str
        A name of ``stiction.effects()``.
    parameters : Mapping of str to Parameter
        What is stated; the rest takes the catalogue's defaults.

    Raises
    ------
    InputError
        An unknown effect, or parameters that are none.
    """

    name: str
    parameters: Mapping[str, Parameter] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_name(self.name, effects(), "effect: name")
        freeze(self, Frozen, "parameters")
        check_parameters(self.parameters, f"effect {self.name}:")

    @property
    def record(self) -> EffectRecord:
        """The catalogue's record of the effect."""
        return next(record for record in effects() if record.name == self.name)
