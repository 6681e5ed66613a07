"""What is compared: a law with parameters, and its scales as an experimenter would find them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from .._native import FrictionModel
from .._support.arrays import FloatArray
from ..catalogue import LawRecord
from ..errors import InputError
from .host import Host

__all__ = ["RIGID_SPAN", "SPEEDS", "Scale", "Subject", "variants"]

_SPEED: Final = 1e-3
"""Speed of the slow ramp, rad/s or m/s: far below where friction of sliding usually falls."""
_SHORTEST, _LONGEST, _PER_DECADE = 1e-10, 1.0, 40
"""Displacements of the slow ramp, rad or m, each a share longer than the last."""
_FIRST: Final = 0.1
"""Share of the level at which the first stiffness is read."""
_LEVELS_OFF: Final = 0.05
"""A force that rises by less than this share over the last factor of 10 has levelled off."""
_SETTLES: Final = 1e-5
"""Time in which the host's damper lets a contact at its first stiffness follow a force, s."""
SPEEDS: Final[tuple[float, ...]] = tuple(np.geomspace(1e-5, 3.0, 23).tolist())
"""At which friction of steady sliding is measured, rad/s or m/s."""
_STEADY: Final = 300.0
"""Way before a slide counts as steady, in lengths."""
RIGID_SPAN: Final = 1e-4
"""Length in place of the pre-sliding distance where there is none, rad or m."""
_FINEST: Final = 1e-9
"""A displacement before sliding below this, rad or m, is none."""


@dataclass(frozen=True)
class Scale:
    """Scales of a law, from a slow ramp of displacement.

    Attributes
    ----------
    level : float
        Force of slow sliding, N·m or N. For a law that never slides the force at which its
        stiffness has fallen halfway from its first to its last value.
    peak : float
        Greatest force on the way.
    span : float
        Pre-sliding distance: that in which the contact would reach ``level`` at its first
        stiffness, rad or m; 0 where it is rigid.
    slides : bool
        Whether the force levelled off.
    """

    level: float
    peak: float
    span: float
    slides: bool


@dataclass(frozen=True)
class Subject:
    """A law of the catalogue with some of its keywords given.

    Attributes
    ----------
    law : str
    label : str
        Which case of the law this is: "defaults", "typical values", or an option.
    keywords : Mapping
        Of :class:`stiction.FrictionModel`.
    """

    law: str
    label: str
    keywords: Mapping[str, float | str]

    def model(self) -> FrictionModel:
        """The law in the state of a contact that was never moved."""
        return FrictionModel(self.law, **self.keywords)

    @cached_property
    def scale(self) -> Scale:
        """Level, peak and span, by experiment."""
        return _scale(self.model())

    @cached_property
    def steady(self) -> tuple[float, ...]:
        """Friction of steady sliding at each of :data:`SPEEDS`."""
        return tuple(self._steady(speed) for speed in SPEEDS)

    @property
    def coulomb(self) -> float:
        """F_c, the least friction of steady sliding; the level where nothing slides."""
        return min(self.steady) if self.scale.slides else self.scale.level

    @cached_property
    def scatter(self) -> float:
        """How far friction wanders in a slow even slide, as a share of the level: 0 but for chance.

        What one slide of a law with random contacts shows may be this far off.
        """
        if not self.scale.slides:
            return 0.0
        samples, travel = 1200, 2.0 * _STEADY * self.length
        velocity = np.full(samples, _SPEED)
        force = self.model().simulate(velocity, travel / samples / _SPEED)[samples // 2 :]
        line = np.polynomial.Polynomial.fit(np.arange(len(force)), force, 1)
        return float(np.std(force - line(np.arange(len(force)))) / self.scale.level)

    @property
    def rigid(self) -> bool:
        """Whether nothing yields before it slides."""
        return self.scale.span == 0.0

    @property
    def length(self) -> float:
        """The span, or a length in its place where the contact is rigid; rad or m."""
        return self.scale.span or RIGID_SPAN

    @property
    def stiffness(self) -> float:
        """Level over length."""
        return self.scale.level / self.length

    def _steady(self, speed: float) -> float:
        travel, samples = _STEADY * self.length, 600
        velocity = np.full(samples, speed)
        return float(self.model().simulate(velocity, travel / samples / speed)[-1])

    def host(self) -> Host:
        """A fresh contact to be driven by force."""
        return Host(self.model(), self.scale.level, _SETTLES * self.stiffness)


def variants(record: LawRecord) -> Iterator[Subject]:
    """A law by its defaults, by typical values of all its terms, and with each of its options."""
    yield Subject(record.name, "defaults", {})
    typical = {p.name: p.typical for p in record.parameters}
    if any(p.typical != p.default for p in record.parameters):
        yield from _buildable(Subject(record.name, "typical values", typical))
    for option in record.options:
        for word, _ in option.choices[1:]:
            yield from _buildable(
                Subject(record.name, f"{option.name} = {word}", {option.name: word})
            )


def _buildable(subject: Subject) -> Iterator[Subject]:
    try:
        subject.model()
    except InputError:
        return
    yield subject


def _scale(law: FrictionModel) -> Scale:
    decades = round(math.log10(_LONGEST / _SHORTEST))
    at = np.geomspace(_SHORTEST, _LONGEST, decades * _PER_DECADE + 1)
    moved = np.diff(at, prepend=0.0)
    force = np.array([law.step(_SPEED, float(step) / _SPEED) for step in moved])
    last = float(force[-1])
    slides = bool(last - force[-1 - _PER_DECADE] <= _LEVELS_OFF * abs(last))
    level = last if slides else _bent(at, force)
    peak = float(np.max(force)) if slides else level
    early = int(np.argmax(force >= _FIRST * level))
    span = float(at[early] * level / force[early])
    return Scale(level, peak, span if span > _FINEST else 0.0, slides)


def _bent(at: FloatArray, force: FloatArray) -> float:
    """Force at which the stiffness is halfway between its first and its last value."""
    stiffness = np.diff(force) / np.diff(at)
    first, final = float(np.median(stiffness[:_PER_DECADE])), float(stiffness[-1])
    half = int(np.argmax(stiffness <= 0.5 * (first + final)))
    return float(force[half]) if half > 0 else 0.35
