"""Areas of closed loops of the spring, against the formula."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .._native import FrictionModel
from .._support.arrays import FloatArray
from ..errors import InputError
from .arguments import check_arguments
from .bench import above_0
from .result import Number, Result
from .rig import ARC_SECOND, RigLike, build_friction

__all__ = ["LoopAreas", "loop_areas"]

DISTANCES = tuple(np.array([10.0, 20.0, 40.0, 60.0, 80.0]) * ARC_SECOND)  # rad
_SAMPLES = 2000  # along a branch; the trapezoidal rule then errs by less than 1e-6
_DT = 1e-3  # s; nothing here depends on it


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class LoopAreas(Result):
    """Closed loops of the spring. One entry a loop.

    Attributes
    ----------
    distance : numpy.ndarray, shape (loops,)
        Between the two reverse points, rad.
    area, formula : numpy.ndarray, shape (loops,)
        Work lost in a loop by integration, and 2·∫₀ᴰG − D·G(D), J.
    loops : tuple of (numpy.ndarray, numpy.ndarray), each of shape (n,)
        Displacement from the lower reverse point (rad) and force (N·m) along each loop.
    """

    distance: FloatArray
    area: FloatArray
    formula: FloatArray
    loops: tuple[tuple[FloatArray, FloatArray], ...]


@check_arguments
def loop_areas(
    *,
    distances: Sequence[float] = DISTANCES,
    rig: RigLike = None,
) -> LoopAreas:
    """Move the spring back and forth over distances; the work lost is 2·∫₀ᴰG − D·G(D).

    All branches being the same curve G, turned and shifted, the area of a loop depends on the
    distance D of its two reverse points alone. The plastic module and the damper are off.

    Parameters
    ----------
    distances : sequence of float
        rad; ours.
    rig : mapping, FrictionModel or Motor, optional
        With the law ``hsieh_pan``.

    Returns
    -------
    LoopAreas

    Raises
    ------
    InputError
        A distance not above 0, or a law whose curve is not known here.

    Source
    ------
    Follows from property (i) of Hsieh, Pan, Wear 242 (2000), §2.2.4; the exponential form of G
    is a reconstruction.

    Examples
    --------
    >>> loop_areas().numbers["greatest relative difference from the formula"].value < 1e-5
    True
    """
    law = build_friction(rig, damping=0.0, hardening_coefficient=0.0)
    if law.law != "hsieh_pan":
        raise InputError(f"loop_areas: the curve of law '{law.law}' is not known here")
    if not distances:
        raise InputError("loop_areas: there are no distances; give at least one, in rad")
    for k, each in enumerate(distances):
        above_0(each, f"loop_areas: distances[{k}]", "rad")
    loops = tuple(_loop(law.copy(), distance) for distance in distances)
    area = np.array([float(np.sum(0.5 * (F[1:] + F[:-1]) * np.diff(x))) for x, F in loops])
    distance = np.array(distances, dtype=np.float64)
    formula = _area(law.parameters, distance)
    numbers = {
        f"work lost over {d / ARC_SECOND:g} arcsec": Number(float(a) * 1e6, "µJ")
        for d, a in zip(distance, area, strict=True)
    }
    error = float(np.max(np.abs(area / formula - 1.0)))
    numbers["greatest relative difference from the formula"] = Number(error, "1")
    return LoopAreas(
        title="Work lost in closed loops of the spring",
        source="from property (i) of Wear 242 (2000), §2.2.4",
        shows="All branches are one curve, turned and shifted: the work lost depends on the "
        "distance of the reverse points alone.",
        numbers=numbers,
        distance=distance,
        area=area,
        formula=formula,
        loops=loops,
    )


def _loop(law: FrictionModel, distance: float) -> tuple[FloatArray, FloatArray]:
    """Displacement from the lower reverse point and force, from the upper one round to itself."""
    speed = distance / _SAMPLES / _DT
    # The loop must not reach the mirror image of its upper point, where a wider one would close.
    law.simulate(np.full(_SAMPLES, speed), _DT)
    upper = law.state["spring_force"]
    force = law.simulate(np.repeat([-speed, speed], _SAMPLES), _DT)
    fall = np.linspace(distance, 0.0, _SAMPLES + 1)
    return np.concatenate([fall, fall[-2::-1]]), np.concatenate([[upper], force])


def _area(parameters: dict[str, float], distance: FloatArray) -> FloatArray:
    """2·∫₀ᴰG − D·G(D) of G(d) = k_inf·d + (k_0 − k_inf)·d_0·(1 − exp(−d/d_0))."""
    k_0, k_inf = parameters["initial_stiffness"], parameters["final_stiffness"]
    d_0 = parameters["decay_distance"]
    bent = (k_0 - k_inf) * d_0
    fallen = -np.expm1(-distance / d_0)
    integral = 0.5 * k_inf * distance**2 + bent * (distance - d_0 * fallen)
    return np.asarray(2.0 * integral - distance * (k_inf * distance + bent * fallen))
