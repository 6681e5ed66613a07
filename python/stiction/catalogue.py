"""The catalogue of laws and effects as records."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Final, TypeVar

from . import _native
from ._support.wording import commas, did_you_mean
from .errors import UnknownName

__all__ = [
    "Catalogue",
    "EffectRecord",
    "LawRecord",
    "OptionRecord",
    "ParameterRecord",
    "ShapeRecord",
    "effects",
    "laws",
]


_AT_CONTACT: Final = frozenset({"friction level", "added effort", "state relaxation"})
"""Hooks of effects that a contact alone can have."""


@dataclass(frozen=True)
class ParameterRecord:
    """One parameter of a law or an effect.

    Attributes
    ----------
    name : str
        In Python and in plant files.
    symbol : str or None
        Of the literature, which is answered with the name.
    meaning : str
        In words.
    unit, linear_unit : str
        Of a machine that turns, and of one that slides.
    default : float
        Without a statement, in these units.
    follows : tuple of (str, float), or None
        Another parameter and a factor: where that one is stated and this one is not, this one is
        the factor times it.
    neutral : float or None
        Value at which the parameter does nothing, where there is one.
    typical : float
        A value at which it does something.
    bounds : tuple of (float, float)
        Least and greatest value that is taken.
    optional : bool
        A fit leaves it alone unless a plant states it.
    """

    name: str
    symbol: str | None
    meaning: str
    unit: str
    linear_unit: str
    default: float
    follows: tuple[str, float] | None
    neutral: float | None
    typical: float
    bounds: tuple[float, float]
    optional: bool

    @property
    def default_rule(self) -> str | None:
        """Where the default follows another parameter, in words."""
        if self.follows is None:
            return None
        other, factor = self.follows
        return f"{factor:g}·{other} where {other} is stated"


@dataclass(frozen=True)
class OptionRecord:
    """A choice between named behaviours.

    Attributes
    ----------
    name, meaning : str
        The keyword, and what is chosen by it.
    choices : tuple of (str, str)
        Word and meaning of each; the first is the default.
    """

    name: str
    meaning: str
    choices: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class LawRecord:
    """A friction law.

    Attributes
    ----------
    name, summary : str
        Its name, and a line on it.
    source : str
        Publication that the equations are of.
    parameters : tuple of ParameterRecord
    start : tuple of ParameterRecord
        What a contact may bring along from before a recording, see ``Motor.follow``; at 0 it was
        never moved.
    remembers : bool
        It knows where it turned round (nonlocal memory): minor loops close.
    options : tuple of OptionRecord
    outputs : tuple of str
        States that a trajectory shows beside position, velocity and friction.
    """

    name: str
    summary: str
    source: str
    parameters: tuple[ParameterRecord, ...]
    start: tuple[ParameterRecord, ...]
    remembers: bool
    options: tuple[OptionRecord, ...]
    outputs: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """The record as plain dicts and lists."""
        return asdict(self)

    def _repr_html_(self) -> str:
        from .notebook import record

        return record(self)


@dataclass(frozen=True)
class ShapeRecord:
    """A parameter in which an effect is not linear, and where a diagnosis looks for it.

    Attributes
    ----------
    parameter : str
        Its name.
    scale : str
        What ``grid`` is measured in: "one", the values themselves; "speed", the way from the lowest
        usual speed of a session (0) to the highest (1), logarithmically; "order", what the range of
        motion can show.
    grid : tuple of float
        Values that are screened.
    fitted : bool
        Whether a refit varies it.
    """

    parameter: str
    scale: str
    grid: tuple[float, ...]
    fitted: bool


@dataclass(frozen=True)
class EffectRecord:
    """An effect that a plant may have beside its law.

    Attributes
    ----------
    name, summary : str
        Its name, and a line on it.
    means, remedy : str
        What it is in the machine, and what to try against it.
    family : str
        Effects of one family are told apart least easily.
    coordinate : str
        Over what the residual shows it.
    channels : tuple of str
        Columns that a recording needs for it beside input and position.
    look_alikes : tuple of str
        Other effects that a recording may not tell from it.
    experiment, plan : str
        What tells it from these, in words and as an experiment of ``stiction plan``.
    gains : tuple of str
        Parameters in which the effort is linear.
    shapes : tuple of ShapeRecord
        Those in which it is not.
    second : tuple of str
        Parameters of a second wave, in the order of gains and shapes: what repeats with position is
        seldom a sine.
    law_terms : tuple of str
        Parameters of laws (``body.`` before them: of the body; ``law.remembers``: that the law
        remembers reverse points) that are this effect: where a plant states one of them, it has the
        effect already.
    rotary_only : bool
        It needs a machine that turns.
    hooks : tuple of str
        Where it enters the equations.
    parameters : tuple of ParameterRecord
    """

    name: str
    summary: str
    means: str
    remedy: str
    family: str
    coordinate: str
    channels: tuple[str, ...]
    look_alikes: tuple[str, ...]
    experiment: str
    plan: str
    gains: tuple[str, ...]
    shapes: tuple[ShapeRecord, ...]
    second: tuple[str, ...]
    law_terms: tuple[str, ...]
    rotary_only: bool
    hooks: tuple[str, ...]
    parameters: tuple[ParameterRecord, ...]

    @property
    def at_contact(self) -> bool:
        """Whether it acts at the contact or adds an effort: a ``FrictionModel`` can have it."""
        return frozenset(self.hooks) <= _AT_CONTACT

    @property
    def before_drive(self) -> bool:
        """Whether it changes when and how fast an input comes to the drive."""
        return not {"input delay", "input rate", "input lag"}.isdisjoint(self.hooks)

    @property
    def shifts_mass(self) -> bool:
        """Whether the centre of mass is elsewhere than where the sensor reads it."""
        return not {"sensor map", "second mass"}.isdisjoint(self.hooks)

    @property
    def late(self) -> bool:
        """Whether it lets the effort follow the input late."""
        return not {"input delay", "input lag"}.isdisjoint(self.hooks)

    @property
    def swings(self) -> bool:
        """Whether a mass swings behind it at a frequency that its gain sets.

        The slope at no gain, where nothing swings, tells how stiff it is and no more.
        """
        return "second mass" in self.hooks and "inertia_share" not in self.gains

    @property
    def limits(self) -> bool:
        """Whether it acts beyond a limit alone: moved, that has another signature."""
        return any(shape.parameter == "limit" for shape in self.shapes)

    @property
    def constant(self) -> bool:
        """Whether it is one effort everywhere, at rest too."""
        return self.family == "offset" and "added effort" in self.hooks

    @property
    def two_levels(self) -> bool:
        """Whether it gives friction a level for each direction."""
        return self.family == "offset" and "friction level" in self.hooks

    @property
    def falls(self) -> bool:
        """Whether it is the fall of friction with speed that laws state (Stribeck effect)."""
        return "stribeck_velocity" in self.law_terms

    @property
    def friction_lags(self) -> bool:
        """Whether friction follows the speed late by it."""
        late = any(shape.scale == "kernel" for shape in self.shapes)
        return late and "friction level" in self.hooks

    @property
    def over_speed(self) -> bool:
        """Whether it is a part of the curve of friction over speed, and of nothing else."""
        return self.falls or self.gains == ("quadratic",)

    @property
    def by_motor(self) -> bool:
        """Whether friction grows with the effort of the motor, for which no load is recorded."""
        return self.family == "load" and not self.channels

    @property
    def weighs(self) -> bool:
        """Whether it is a weight off the axis, which a body or links of a robot hold as well."""
        return "body.gravity_amplitude" in self.law_terms

    @property
    def misreads(self) -> bool:
        """Whether it is an error of the position that is read."""
        return "sensor map" in self.hooks

    def slope_misleads(self, *, loop: bool) -> bool:
        """Whether the slope at no gain does not tell how much a whole gain explains.

        So it is of what is late, whose slope tells no delay, and of what stands before the drive of
        a simulated loop, which follows it far.
        """
        return self.late or (loop and self.before_drive)

    def impossible(self, motion: str, *, servo: bool) -> str:
        """Why such a machine cannot have it, "" where it can.

        Parameters
        ----------
        motion : str
            ``"rotary"`` or ``"linear"``.
        servo : bool
            Whether its drive is told where to go.
        """
        if self.rotary_only and motion != "rotary":
            return "only a machine that turns can have it"
        if "input rate" in self.hooks and not servo:
            return "only a servo has a goal"
        return ""

    def to_dict(self) -> dict[str, Any]:
        """The record as plain dicts and lists."""
        return asdict(self)

    def _repr_html_(self) -> str:
        from .notebook import record

        return record(self)


Record = TypeVar("Record", LawRecord, EffectRecord)


def _parameters(entries: list[dict[str, Any]]) -> tuple[ParameterRecord, ...]:
    return tuple(ParameterRecord(**entry) for entry in entries)


def _laws() -> Iterator[LawRecord]:
    for entry in _native.laws():
        options = tuple(
            OptionRecord(o["name"], o["meaning"], tuple(tuple(c) for c in o["choices"]))
            for o in entry["options"]
        )
        yield LawRecord(
            name=entry["name"],
            summary=entry["summary"],
            source=entry["source"],
            parameters=_parameters(entry["parameters"]),
            start=_parameters(entry["start"]),
            remembers=entry["remembers"],
            options=options,
            outputs=tuple(entry["outputs"]),
        )


class Catalogue(tuple[Record, ...]):
    """Records in their order; one of them by its name, ``laws()["lugre"]``.

    ``"lugre" in laws()`` asks for a name, iteration gives records.
    """

    __slots__ = ()

    def __getitem__(self, key: Any) -> Any:
        """A record by name or place, or several by a slice.

        Raises
        ------
        UnknownName
            An ``InputError`` and a ``KeyError``: the catalogue has no such name.
        """
        if not isinstance(key, str):
            return super().__getitem__(key)
        for record in self:
            if record.name == key:
                return record
        names, what = self.names, "law" if isinstance(self[0], LawRecord) else "effect"
        others: tuple[LawRecord | EffectRecord, ...] = effects() if what == "law" else laws()
        other = next((each.name for each in others if each.name == key.casefold()), "")
        near = did_you_mean(key, names)
        if other:
            near = f" ('{other}' is {'a law' if what == 'effect' else 'an effect'})"
        raise UnknownName(f"there is no {what} '{key}'{near}; there are {commas(names)}")

    if not TYPE_CHECKING:  # for whom any name would then be there

        def __getattr__(self, name: str) -> Any:
            call = "laws" if self and isinstance(self[0], LawRecord) else "effects"
            meant = f"; write {call}()['{name}']" if name in self.names else ""
            raise AttributeError(f"the catalogue has no attribute '{name}'{meant}")

    def __contains__(self, key: object) -> bool:
        return key in self.names if isinstance(key, str) else super().__contains__(key)

    @property
    def names(self) -> tuple[str, ...]:
        """Names in order."""
        return tuple(record.name for record in self)

    def __repr__(self) -> str:
        wide = max(map(len, self.names), default=0)
        return "\n".join(f"{record.name:<{wide}}  {record.summary}" for record in self)

    def _repr_html_(self) -> str:
        from .notebook import table

        return table(("name", "what it is"), [(one.name, one.summary) for one in self])

    def __reduce__(self) -> tuple[Any, ...]:
        return Catalogue, (tuple(self),)


@cache
def laws() -> Catalogue[LawRecord]:
    """Every friction law of the catalogue; ``laws()["lugre"]`` is one of them."""
    return Catalogue(_laws())


@cache
def effects() -> Catalogue[EffectRecord]:
    """Every effect of the catalogue; ``effects()["cogging"]`` is one of them."""
    return Catalogue(
        EffectRecord(
            name=entry["name"],
            summary=entry["summary"],
            means=entry["means"],
            remedy=entry["remedy"],
            family=entry["family"],
            coordinate=entry["coordinate"],
            channels=tuple(entry["channels"]),
            look_alikes=tuple(entry["look_alikes"]),
            experiment=entry["experiment"],
            plan=entry["plan"],
            gains=tuple(entry["gains"]),
            shapes=tuple(
                ShapeRecord(s["parameter"], s["scale"], tuple(s["grid"]), s["fitted"])
                for s in entry["shapes"]
            ),
            second=tuple(entry["second"]),
            law_terms=tuple(entry["law_terms"]),
            rotary_only=entry["rotary_only"],
            hooks=tuple(entry["hooks"]),
            parameters=_parameters(entry["parameters"]),
        )
        for entry in _native.effects()
    )
