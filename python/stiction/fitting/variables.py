"""What a fit varies: parameters within bounds, ordered pairs as ratios."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from .._support.arrays import FloatArray
from ..catalogue import ParameterRecord, effects
from ..plant import Plant

__all__ = [
    "RATIOS",
    "Variables",
    "bounds_of",
    "records",
    "states_bound",
    "unit_of",
    "with_effort_in",
]

Mask = np.ndarray[Any, np.dtype[np.bool_]]

RATIOS: Final = {
    "friction.final_stiffness": "friction.initial_stiffness",
    "friction.coulomb": "friction.breakaway",
}
"""The lesser of an ordered pair is varied as a share of the greater: box bounds cannot express
the order. Where one of the two is held, the other one is bounded by it."""
SHARES: Final = (1e-3, 1.0 - 1e-3)
LINEAR: Final = ("coulomb", "breakaway", "viscous", "order")
"""Positive parameters that are varied as they are: the residual is linear in them, or they may well
be 0. The others are varied by their logarithm: a stiffness or a rate is known to a factor."""
LEAST_SHARE: Final = 1e-6
"""A parameter varied by its logarithm stays above this share of where it starts, and below the
same multiple: beyond, a step of the optimiser only finds where numbers end."""

INPUT_UNITS: Final = {
    "current_a": "A",
    "voltage_v": "V",
    "torque_nm": "N·m",
    "force_n": "N",
    "goal_rad": "V",
    "goal_m": "V",
}
"""Unit of what is measured in the input of the drive; of a servo in its voltage."""

_BODY: Final = {
    "drive.gain": (-math.inf, math.inf, ("N·m per unit of input", "N per unit of input")),
    "drive.torque_constant": (1e-12, math.inf, ("N·m/A", "N/A")),
    "body.inertia": (1e-12, math.inf, ("kg·m²", "kg")),
    "body.gravity_amplitude": (-math.inf, math.inf, ("N·m", "N·m")),
    "body.gravity_zero_rad": (-math.inf, math.inf, ("rad", "rad")),
    "body.weight_n": (-math.inf, math.inf, ("N", "N")),
}


def records(plant: Plant) -> dict[str, ParameterRecord]:
    """The catalogue's record of every parameter of law and effects, by path."""
    found = {f"friction.{p.name}": p for p in plant.friction.record.parameters}
    by_name = {record.name: record for record in effects()}
    for effect in plant.effects:
        for p in by_name[effect.name].parameters:
            found[f"effects.{effect.name}.{p.name}"] = p
    return found


def unit_of(plant: Plant, path: str) -> str:
    """Unit of the parameter at a path."""
    linear = plant.motion == "linear"
    if path in _BODY:
        return _BODY[path][2][linear]
    record = records(plant)[path]
    if record.unit == "input":
        return INPUT_UNITS.get(str(plant.drive.get("input", "")), "1")
    return record.linear_unit if linear else record.unit


def with_effort_in(measured: str, plant: Plant, path: str) -> str:
    """Unit of the parameter at a path where efforts were measured in another unit than a force's.

    A stress, in Pa, a friction coefficient, which has no unit, or an input whose gain is not known
    takes the place of N (or N·m).
    """
    unit, own = unit_of(plant, path), plant.si_effort_unit
    if measured == own:
        return unit
    if path == "body.inertia":
        unit = f"{own}·s²/{plant.position_unit}"
    unit = unit.replace(f"({own})", own).replace(own, measured)
    if measured != "1":
        return unit
    for written, short in (("1·", ""), ("/1^n", ""), ("/1", "")):
        unit = unit.replace(written, short)
    return unit


def bounds_of(plant: Plant, path: str) -> tuple[float, float]:
    """What a parameter may be at all, whatever a plant states."""
    return _BODY[path][:2] if path in _BODY else records(plant)[path].bounds


def states_bound(plant: Plant, path: str, side: str) -> bool:
    """Whether a plant states the bound on a side, "lower" or "upper", that a parameter meets.

    False where it states none, or one beyond what the parameter may be at all.
    """
    stated = plant.parameters.get(path)
    if stated is None:
        return False
    low, high = bounds_of(plant, path)
    if side == "lower":
        return stated.min is not None and stated.min >= low
    return stated.max is not None and stated.max <= high


@dataclass(frozen=True)
class Variables:
    """The vector that an optimiser sees, and its way to the parameters of a plant.

    Attributes
    ----------
    paths : tuple of str
        Parameters, in the order of the vector.
    lower, upper : numpy.ndarray, shape (p,)
        Bounds of the parameters themselves.
    ratio_of : Mapping of int to int
        Index of a parameter that is varied as a share of another one.
    logarithmic : numpy.ndarray of bool, shape (p,)
        Which are varied by their logarithm.
    """

    paths: tuple[str, ...]
    lower: FloatArray
    upper: FloatArray
    ratio_of: Mapping[int, int]
    logarithmic: Mask

    @classmethod
    def of(cls, plant: Plant, paths: Sequence[str]) -> Variables:
        """The variables of the parameters at these paths."""
        least, most = [], []
        for path in paths:
            low, high = bounds_of(plant, path)
            stated = plant.parameters[path]
            low, high = _beside_held(plant, path, paths, low, high)
            least.append(low if stated.min is None else max(low, stated.min))
            most.append(high if stated.max is None else min(high, stated.max))
        ratios = {
            index: paths.index(RATIOS[path])
            for index, path in enumerate(paths)
            if path in RATIOS and RATIOS[path] in paths
        }
        begin = np.array([plant.parameters[path].value for path in paths])
        lower, upper = np.array(least), np.array(most)
        for child, parent in ratios.items():
            # A stated least value of the lesser one is one of the greater one.
            lower[parent] = max(lower[parent], lower[child] / SHARES[1])
        positive = (lower >= 0.0) & (begin > 0.0)
        chosen = [
            not path.startswith(("body.", "drive.")) and path.rsplit(".", 1)[-1] not in LINEAR
            for path in paths
        ]
        logarithmic = positive & np.array(chosen, dtype=bool)
        logarithmic[list(ratios)] = False
        lower = np.where(logarithmic, np.maximum(lower, LEAST_SHARE * begin), lower)
        upper = np.where(logarithmic, np.minimum(upper, begin / LEAST_SHARE), upper)
        return cls(tuple(paths), lower, upper, ratios, logarithmic)

    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Bounds of the vector."""
        lower, upper = self.lower.copy(), self.upper.copy()
        lower[self.logarithmic] = np.log(lower[self.logarithmic])
        upper[self.logarithmic] = np.log(upper[self.logarithmic])
        for child in self.ratio_of:
            lower[child], upper[child] = SHARES
        return lower, upper

    def vector(self, values: FloatArray) -> FloatArray:
        """The vector for these parameter values, moved inside the bounds."""
        vector = np.array(values, dtype=np.float64)
        for child, parent in self.ratio_of.items():
            lesser, greater = float(values[child]), float(values[parent])
            # Where both are 0 (or both without end) one is no share of the other: they are equal.
            told = greater > 0.0 and not math.isinf(lesser)
            vector[child] = lesser / greater if told else SHARES[1]
        own = np.maximum(vector[self.logarithmic], self.lower[self.logarithmic])
        vector[self.logarithmic] = np.log(own)
        return np.asarray(np.clip(vector, *self.bounds()))

    def values(self, vector: FloatArray) -> FloatArray:
        """Parameter values of a vector."""
        values = np.array(vector, dtype=np.float64)
        values[self.logarithmic] = np.exp(vector[self.logarithmic])
        for child, parent in self.ratio_of.items():
            values[child] = vector[child] * values[parent]
        return np.asarray(np.clip(values, self.lower, self.upper))

    def bounds_hit(self, vector: FloatArray) -> dict[int, str]:
        """Which shares would lead past a bound of their parameter, and past which: it stays there.

        Returns
        -------
        dict of int to str
            "lower" or "upper" by the parameter's index.
        """
        values = self.values(vector)
        found = {}
        for child, parent in self.ratio_of.items():
            own = vector[child] * values[parent]
            if own <= self.lower[child]:
                found[child] = "lower"
            elif own >= self.upper[child]:
                found[child] = "upper"
        return found

    def chain(self, jacobian: FloatArray, vector: FloatArray) -> FloatArray:
        """Derivatives by the vector from derivatives by the parameters."""
        columns = jacobian.copy()
        values = self.values(vector)
        clamped = self.bounds_hit(vector)
        for child, parent in self.ratio_of.items():
            if child in clamped:
                columns[:, child] = 0.0
                continue
            columns[:, parent] += jacobian[:, child] * vector[child]
            columns[:, child] = jacobian[:, child] * values[parent]
        columns[:, self.logarithmic] *= values[self.logarithmic]
        return columns

    def plant(self, plant: Plant, vector: FloatArray) -> Plant:
        """The plant with the values of a vector."""
        values = self.values(vector)
        return plant.with_values(dict(zip(self.paths, values.tolist(), strict=True)))


def _beside_held(
    plant: Plant, path: str, varied: Sequence[str], low: float, high: float
) -> tuple[float, float]:
    """Bounds of a parameter of an ordered pair of which the other one is stated and held."""
    for lesser, greater in RATIOS.items():
        other = {lesser: greater, greater: lesser}.get(path)
        held = None if other is None or other in varied else plant.parameters.get(other)
        if held is None or not math.isfinite(held.value):
            continue
        if path == lesser:
            high = min(high, SHARES[1] * held.value)
        else:
            low = max(low, held.value / SHARES[1])
    return low, high
