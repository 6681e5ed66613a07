"""What may be missing: effects of the catalogue, their shapes on a grid scaled from the data."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Final

import numpy as np

from ..._support.wording import commas, did_you_mean
from ...catalogue import EffectRecord, effects
from ...errors import InputError
from ...fitting.start import largest_command
from ...plant import Plant
from ...plant.overlap import terms_of
from ...plant.presliding import presliding
from ...plant.stated import Effect
from ..data.evidence import Evidence

__all__ = ["LOWEST", "Candidate", "Scales", "candidates", "excluded_names", "present", "scales_of"]

FEWEST_SPEEDS: Final = (0.02, 0.90)
"""Quantiles of the moving speeds that bound the grid of a speed."""
STILL: Final = 1e-3
"""Share of the greatest speed below which a machine counts as still."""
MOST_ORDERS: Final = 100
"""Orders tried at most."""
WIDER: Final = 1.5
"""A refit may leave the grid of a speed by this factor."""
MUCH_WIDER: Final = 4.0
"""And that of other sizes by this one."""
RESTING_SHARES: Final = (1e-3, 1e-4)
"""Of the range of motion: a rest of a contact without a spring, which has no length of its own."""
FEWEST_COUNTS: Final = 3.0
"""A rest is no shorter than this many counts of the sensor."""
RESONANCES: Final = (12.0, 17.0, 24.0, 34.0, 48.0, 68.0, 96.0)
"""Hz: of what swings at one of these a fit finds its own frequency; above them slopes tell."""
MOST_SHARES: Final = 2
"""Points of the grid of its shapes that are looked at at each of them."""
SAMPLED: Final = 0.3
"""Share of the rate of the samples up to which they show a resonance."""
FALL: Final = "fall"
"""Shape that says how much of a fall of friction with speed is meant: such a gain is positive, as
that of ``stribeck`` is, or a rise of friction from rest that no machine has would be found."""
RESTING: Final = "resting"
"""Scale of displacements within which a contact rests."""
ORDER_STEP: Final = 0.5
"""Spacing of orders where the machine does not turn fully, in periods over its range."""
LOWEST: Final = 0.5
"""Lowest order that a refit may go to, in units of the lowest one that is tried."""


@dataclass(frozen=True)
class Scales:
    """Sizes of a session in which shapes are measured.

    Attributes
    ----------
    speeds : tuple of float
        Lowest and highest usual speed, rad/s or m/s.
    orders : tuple of float
        Orders that the range of motion can show, 1/rad or 1/m.
    whole_turns : bool
        Orders are whole numbers: the machine turns at least once.
    units : dict of str to float
        What the scales ``presliding`` and ``resting`` (rad or m), ``loading`` (N·m/s or N/s),
        ``session`` (s) and ``path`` (rad or m) are measured in.
    finer : float
        Factor to a second, smaller pre-sliding length that is tried where the contact has none; 1
        where it has one.
    rate : float
        Samples a second.
    """

    speeds: tuple[float, float]
    orders: tuple[float, ...]
    whole_turns: bool
    units: dict[str, float]
    finer: float = 1.0
    rate: float = math.inf


@dataclass(frozen=True)
class Candidate:
    """An effect with values of its shape parameters.

    Attributes
    ----------
    record : EffectRecord
    shape : dict
        Value of every shape parameter.
    free : tuple of str
        Shape parameters that a refit varies.
    limits : dict
        Least and greatest value of those, where the data give one.
    second : bool
        It is a second wave of an effect that the plant has.
    resonance : float
        Hz at which what swings is looked at; 0 where a slope at no gain tells.
    """

    record: EffectRecord
    shape: dict[str, float]
    free: tuple[str, ...]
    limits: dict[str, tuple[float, float]] = field(default_factory=dict)
    second: bool = False
    resonance: float = 0.0

    @property
    def name(self) -> str:
        """Name of the effect."""
        return self.record.name

    @property
    def gains(self) -> tuple[str, ...]:
        """Its gains, by the names that they have in a plant."""
        return tuple(self.own(name) for name in self.record.gains)

    @property
    def form(self) -> str:
        """What is screened by itself: the effect, or one of two that go by the same name."""
        return f"{self.name} {self.shape[FALL]:g}" if FALL in self.shape else self.name

    @property
    def bounds(self) -> tuple[tuple[float, float], ...]:
        """Least and greatest value of each gain: with its fall, friction falls with speed."""
        known = {p.name: p.bounds for p in self.record.parameters}
        if self.shape.get(FALL, 0.0) > 0.0:
            return tuple((max(known[name][0], 0.0), known[name][1]) for name in self.gains)
        return tuple(known[name] for name in self.gains)

    def own(self, name: str) -> str:
        """The name that a gain or a shape parameter has in a plant."""
        if not self.second:
            return name
        first = (*self.record.gains, *(shape.parameter for shape in self.record.shapes))
        return self.record.second[first.index(name)]

    def has_shape_of(self, effect: Effect) -> bool:
        """Whether an effect has the shapes that a refit of this holds."""
        held = [name for name in self.shape if name not in self.free]
        values = effect.parameters
        return all(values[self.own(name)].value == self.shape[name] for name in held)

    @property
    def last_shapes(self) -> tuple[str, ...]:
        """Shapes that a refit varies once all else is fitted: far from there they lead astray."""
        own = {shape.parameter for shape in self.record.shapes if shape.scale == RESTING}
        return tuple(name for name in self.free if name in own)

    @property
    def parameters(self) -> int:
        """How many parameters it adds to a fit; those varied last only mend what is known."""
        return len(self.record.gains) + len(self.free) - len(self.last_shapes)


def scales_of(evidence: Evidence, plant: Plant) -> Scales:
    """Sizes of the motion in the rows that may be looked at, and of a fitted contact."""
    speeds = np.concatenate([np.abs(r.form.velocity[r.mask]) for r in evidence.shown])
    moving = speeds[speeds > STILL * float(np.max(speeds, initial=0.0))]
    low, high = np.quantile(moving, FEWEST_SPEEDS) if len(moving) else (1.0, 1.0)
    positions = [r.form.position for r in evidence.shown]
    least = min(float(p.min()) for p in positions)
    span = max(float(p.max()) for p in positions) - least
    whole = evidence.plant.motion == "rotary" and span >= 2.0 * math.pi
    if whole:
        orders = tuple(float(k) for k in range(1, MOST_ORDERS + 1))
    elif span > 0.0:
        step = ORDER_STEP * 2.0 * math.pi / span
        orders = tuple(step * k for k in range(1, MOST_ORDERS + 1))
    else:
        orders = (1.0,)
    usual = (float(low), float(max(high, low * 1.01)))
    units, finer = _units(evidence, plant, span)
    rate = 1.0 / max(rows.form.dt for rows in evidence.shown)
    return Scales(usual, orders, whole, units, finer, rate)


def _units(evidence: Evidence, plant: Plant, span: float) -> tuple[dict[str, float], float]:
    """What shapes are measured in that belong to the contact or to the session as a whole.

    And the factor from the pre-sliding length to a finer one.
    """
    values = plant.friction.model().parameters
    sliding = values.get("coulomb", math.inf)
    if not math.isfinite(sliding) or sliding <= 0.0:
        sliding = float(np.sqrt(np.mean([np.mean(r.form.effort**2) for r in evidence.shown])))
    stiffness = values.get("initial_stiffness", 0.0)
    forms = [rows.form for rows in evidence.shown]
    count = max(form.count for form in forms)
    least = max(FEWEST_COUNTS * count, 1e-12)
    # Without a spring there is no pre-sliding length; a rest is what the sensor takes for one.
    if stiffness > 0.0:
        length = finest = max(presliding(plant.friction, sliding), least)
    else:
        length, finest = (max(share * span, least) for share in RESTING_SHARES)
    ends = [form.clock + form.time[-1] - form.time[0] for form in forms]
    paths = [form.path + float(np.sum(np.abs(np.diff(form.position)))) for form in forms]
    units = {
        "presliding": length,
        RESTING: length,
        "loading": max(sliding, 1e-300),
        "input": max(1e-300, *(largest_command(form, plant) for form in forms)),
        "kernel": min(form.kernel.support for form in forms),
        "session": max(1e-3, *ends),
        "path": max(1e-9, *paths),
    }
    return units, finest / length


def excluded_names(without: Sequence[str]) -> tuple[str, ...]:
    """The names of effects that are not to be tried.

    Raises
    ------
    InputError
        A name that no effect has.
    """
    known = [record.name for record in effects()]
    for name in without:
        if name not in known:
            raise InputError(
                f"without: there is no effect {name}{did_you_mean(name, known)}; "
                f"there are {commas(known)}"
            )
    return tuple(without)


def candidates(record: EffectRecord, scales: Scales) -> list[Candidate]:
    """An effect at every point of the grid of its shapes."""
    found = list(_grid(record, scales))
    if record.swings:
        # Where its mass swings it resembles nothing that a slope at no gain shows.
        found += [
            replace(each, resonance=resonance)
            for resonance in RESONANCES
            if resonance < SAMPLED * scales.rate
            for each in found[:: max(len(found) // MOST_SHARES, 1)]
        ]
    # From a rest that is ten times as wide as the right one a fit does not find that.
    if scales.finer < 1.0 and any(shape.scale == RESTING for shape in record.shapes):
        finer = {name: scales.units[name] * scales.finer for name in ("presliding", RESTING)}
        found += _grid(record, replace(scales, units={**scales.units, **finer}))
    return found


def present(plant: Plant, record: EffectRecord) -> bool:
    """Whether the plant holds the effect already, as an effect or as a part of its law."""
    if any(effect.name == record.name for effect in plant.effects):
        return True
    return bool(terms_of(plant, record))


def _grid(record: EffectRecord, scales: Scales) -> Iterator[Candidate]:
    shapes = record.shapes
    axes = []
    free = []
    limits = {}
    for shape in shapes:
        values, fitted = _axis(shape.scale, shape.grid, scales)
        bounds = next(p.bounds for p in record.parameters if p.name == shape.parameter)
        axes.append(sorted({float(np.clip(v, *bounds)) for v in values}))
        if shape.fitted and fitted:
            free.append(shape.parameter)
            if shape.scale != "order":
                # Beyond its own grid a shape turns into another effect: a fall that takes all
                # speeds is curved viscous friction.
                wider = WIDER if shape.scale == "speed" else MUCH_WIDER
                low, high = min(axes[-1]) / wider, max(axes[-1]) * wider
                limits[shape.parameter] = (max(low, bounds[0]), min(high, bounds[1]))
    for point in product(*axes):
        own = dict(zip((s.parameter for s in shapes), point, strict=True))
        near = {
            s.parameter: _neighbours(own[s.parameter], scales)
            for s in shapes
            if s.scale == "order" and s.parameter in free
        }
        yield Candidate(record, own, tuple(free), {**limits, **near})


def _neighbours(order: float, scales: Scales) -> tuple[float, float]:
    """Orders that a refit may go to: halfway beyond the next ones, which are candidates themselves.

    Below half the lowest one a wave turns into an offset and a slope, of any size.
    """
    step = scales.orders[0]
    return max(LOWEST * step, order - 1.5 * step), order + 1.5 * step


def _axis(scale: str, grid: Sequence[float], scales: Scales) -> tuple[Sequence[float], bool]:
    """Values along one shape, and whether a refit may vary it."""
    if scale == "order":
        return scales.orders, not scales.whole_turns
    if scale == "speed":
        low, high = scales.speeds
        return [low * (high / low) ** share for share in grid], True
    if scale in scales.units:
        return [scales.units[scale] * share for share in grid], True
    return grid, True
