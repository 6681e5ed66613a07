"""Other people's mechanisms that the paper duplicates in numbers: its Figs. 15g and i-k.

The paper takes measured loops of other authors and shows that its model makes the same ones. The
excerpt that is followed here says which property each of them shows, and none of their numbers:
paths and parameters are ours, of the size of such mechanisms. A law of the catalogue that was
written for a mechanism is shown beside the spring of ``hsieh_pan`` where it is there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from .. import catalogue
from .._native import FrictionModel
from .._support.arrays import FloatArray
from .paths import ForcePath
from .result import Number, Result, arcsec
from .rig import ARC_SECOND

__all__ = [
    "Curve",
    "LoopStudy",
    "ball_screw",
    "bearing_loops",
    "metal_contact",
    "nanometre_loops",
]

NANOMETRE: Final = 1e-9  # m
MICROMETRE: Final = 1e-6  # m
_LEG_SAMPLES: Final = 200


@dataclass(frozen=True, eq=False, repr=False)
class Curve:
    """One law along a path of force.

    Attributes
    ----------
    label : str
    effort, position : numpy.ndarray, shape (n,)
        N·m and rad, or N and m.
    settled : numpy.ndarray, shape (levels,)
        Position at each level.
    """

    label: str
    effort: FloatArray
    position: FloatArray
    settled: FloatArray


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class LoopStudy(Result):
    """Loops of one or more laws on the same path of force.

    Attributes
    ----------
    letters : tuple of str
        Names of the turning points.
    level : numpy.ndarray, shape (levels,)
        Force at them.
    curves : tuple of Curve
    unit : float
        What the figure counts positions in, rad or m.
    labels : tuple of str
        Of the axes.
    """

    letters: tuple[str, ...]
    level: FloatArray
    curves: tuple[Curve, ...]
    unit: float
    labels: tuple[str, str]


def metal_contact() -> LoopStudy:
    """Two metal surfaces, loaded and unloaded at rising force: Fig. 15g.

    The text counts Fig. 15g among those with hysteresis loops and compares its own tests with loops
    of metal-to-metal contacts (Fig. 5 of its reference 10, Figs. 7 and 9 of 15); which of them the
    figure duplicates it does not say. Ours: a contact that yields micrometres at newtons, with
    the plastic module on, unloaded to zero after each rise.

    Returns
    -------
    LoopStudy

    Source
    ------
    Hsieh, Pan, Wear 242 (2000), §2.1.2 and §2.2.4, Fig. 15g.

    Examples
    --------
    >>> loops = metal_contact()
    >>> loops.numbers["permanent displacement after point f"].value > 0.0
    True
    """
    law = FrictionModel(
        "hsieh_pan",
        initial_stiffness=20e6,
        final_stiffness=5e6,
        decay_distance=0.4 * MICROMETRE,
        hardening_coefficient=2e-9,
        hardening_exponent=2.0,
        creep_rate=2.0,
        damping=0.0,
    )
    levels = (3.0, 0.0, 3.0, 6.0, 0.0, 6.0, 9.0, 0.0, 9.0)
    letters = tuple("bcdefghij")
    curve, states = _driven("hsieh_pan", law, levels, ramp_rate=1.0, hold=4.0)
    at = dict(zip(letters, curve.settled, strict=True))
    numbers = {
        f"gap at {later}, where {point} is met again": Number(
            float(at[later] - at[point]) / NANOMETRE, "nm"
        )
        for point, later in (("b", "d"), ("e", "g"), ("h", "j"))
    }
    for point, plastic in zip("cf", states["plastic"][[1, 4]], strict=True):
        numbers[f"permanent displacement after point {point}"] = Number(
            float(plastic) / MICROMETRE, "µm"
        )
    return LoopStudy(
        title="Metal on metal, unloaded after each rise",
        source="Wear 242 (2000), Fig. 15g",
        shows="Each rise adds creep that stops and stays; unloading makes a loop that closes where "
        "it began.",
        numbers=numbers,
        letters=letters,
        level=np.array(levels),
        curves=(curve,),
        unit=MICROMETRE,
        labels=("displacement (µm)", "force (N)"),
    )


def nanometre_loops() -> LoopStudy:
    """Futami's linear stage on rolling balls: loops within loops, nanometres wide. Fig. 15i.

    S. Futami, A. Furutani, S. Yoshida, Nanotechnology 1 (1990) 31-37, found a linear spring up to
    100 nm and a nonlinear one from there to 100 µm. A spring whose slope falls over some
    micrometres is linear within 100 nm of every reverse point: the two regions are one curve.

    Returns
    -------
    LoopStudy

    Source
    ------
    Hsieh, Pan, Wear 242 (2000), §2.2.4 and §2.3, Fig. 15i.

    Examples
    --------
    >>> abs(nanometre_loops().numbers["gap at h, where d is met again"].value) < 1e-6
    True
    """
    spring = {"initial_stiffness": 20e6, "decay_distance": 2.8 * MICROMETRE}
    levels = (24.0, -12.0, 14.0, -4.0, 8.0, -4.0, 14.0, -12.0, 24.0, 30.0)
    letters = tuple("bcdefghijk")
    law = FrictionModel(
        "hsieh_pan", final_stiffness=1e6, hardening_coefficient=0.0, damping=0.0, **spring
    )
    curves = [_driven("hsieh_pan (spring)", law, levels)[0]]
    named = _known("futami", coulomb=33.0, initial_stiffness=20e6)
    if named is not None:
        curves.append(_driven("futami", named, levels)[0])
    at = dict(zip(letters, curves[0].settled, strict=True))
    numbers = {
        f"gap at {later}, where {point} is met again": Number(
            float(at[later] - at[point]) / NANOMETRE, "nm"
        )
        for point, later in (("e", "g"), ("d", "h"), ("c", "i"), ("b", "j"))
    }
    numbers["width of loop e-f-g"] = Number(float(at["f"] - at["e"]) / NANOMETRE, "nm")
    k_0, k_inf, d_0 = 20e6, 1e6, spring["decay_distance"]
    d = 100.0 * NANOMETRE
    mean = k_inf + (k_0 - k_inf) * d_0 / d * -math.expm1(-d / d_0)
    numbers["mean stiffness over 100 nm below that at the reverse point"] = Number(
        100.0 * (1.0 - mean / k_0), "%"
    )
    return LoopStudy(
        title="Rolling guide: nested loops of nanometres",
        source="Wear 242 (2000), Fig. 15i (Futami et al. 1990)",
        shows="Every reverse point is met again, however many lie within; within 100 nm of one the "
        "contact is a linear spring.",
        numbers=numbers,
        letters=letters,
        level=np.array(levels),
        curves=tuple(curves),
        unit=MICROMETRE,
        labels=("displacement (µm)", "force (N)"),
    )


def bearing_loops() -> LoopStudy:
    """Osborne and Rittenhouse's gimbal bearing: Dahl's curve with memory and without. Fig. 15j.

    N. A. Osborne and D. L. Rittenhouse found that Dahl's law misses the reverse points of measured
    loops and added "large amount of logic and memory" to it. Shown are the spring of ``hsieh_pan``,
    the laws ``dahl`` and ``dahl_with_memory``.

    Returns
    -------
    LoopStudy

    Source
    ------
    Hsieh, Pan, Wear 242 (2000), §2.3, Fig. 15j.

    Examples
    --------
    >>> gap = bearing_loops().numbers["hsieh_pan (spring): gap at f, where d is met again"]
    >>> abs(gap.value) < 1e-6
    True
    """
    levels = (0.30, -0.30, 0.20, -0.10, 0.20, 0.30, -0.30, 0.30)
    letters = tuple("bcdefghi")
    law = FrictionModel(
        "hsieh_pan",
        initial_stiffness=3000.0,
        final_stiffness=300.0,
        decay_distance=60.0 * ARC_SECOND,
        hardening_coefficient=0.0,
        damping=0.0,
    )
    curves = [_driven("hsieh_pan (spring)", law, levels)[0]]
    for name in ("dahl", "dahl_with_memory"):
        named = _known(name, coulomb=0.5, initial_stiffness=3000.0, exponent=1.0)
        if named is not None:
            curves.append(_driven(name, named, levels)[0])
    numbers = {}
    for curve in curves:
        at = dict(zip(letters, curve.settled, strict=True))
        for point, later in (("d", "f"), ("b", "g"), ("c", "h")):
            numbers[f"{curve.label}: gap at {later}, where {point} is met again"] = arcsec(
                at[later] - at[point]
            )
    return LoopStudy(
        title="Gimbal bearing: Dahl's curve with memory and without",
        source="Wear 242 (2000), Fig. 15j (Osborne, Rittenhouse)",
        shows="A law without memory of reverse points drifts with every inner loop; with it, or "
        "with the spring of the paper, the outer loop goes on as if there had been none.",
        numbers=numbers,
        letters=letters,
        level=np.array(levels),
        curves=tuple(curves),
        unit=ARC_SECOND,
        labels=("position (arc-seconds)", "torque (N·m)"),
    )


def ball_screw() -> LoopStudy:
    """A ball screw turned to and fro by growing angles: Fig. 15k.

    Returns
    -------
    LoopStudy

    Source
    ------
    Hsieh, Pan, Wear 242 (2000), §2.1.2 and §2.2.4, Fig. 15k (Fig. 15a of its reference 19, the
    ball screw of an x-y table). Path and parameters are ours.

    Examples
    --------
    >>> ball_screw().numbers["work lost in loop 3 over loop 1"].value > 1.0
    True
    """
    amplitudes = (0.05, 0.10, 0.15)
    levels = tuple(side * amplitude for amplitude in amplitudes for side in (1.0, -1.0, 1.0))
    letters = tuple("bcdefghij")
    law = FrictionModel(
        "hsieh_pan",
        initial_stiffness=1200.0,
        final_stiffness=150.0,
        decay_distance=80.0 * ARC_SECOND,
        hardening_coefficient=0.0,
        damping=0.0,
    )
    curve = _driven("hsieh_pan (spring)", law, levels)[0]
    at = dict(zip(letters, curve.settled, strict=True))
    numbers = {}
    for index, (start, end) in enumerate((("b", "d"), ("e", "g"), ("h", "j")), 1):
        numbers[f"gap at {end}, where {start} is met again"] = arcsec(at[end] - at[start])
        legs = slice((3 * index - 2) * _LEG_SAMPLES, 3 * index * _LEG_SAMPLES + 1)
        force, x = curve.effort[legs], curve.position[legs]
        work = float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(x)))
        numbers[f"work lost in loop {index}"] = Number(1e6 * work, "µJ")
    ratio = numbers["work lost in loop 3"].value / numbers["work lost in loop 1"].value
    numbers["work lost in loop 3 over loop 1"] = Number(ratio, "1")
    return LoopStudy(
        title="Ball screw turned to and fro by growing torque",
        source="Wear 242 (2000), Fig. 15k",
        shows="Loops of all sizes are branches of one curve; between their tips the torque follows "
        "the curve of a first loading, as if the smaller loops had not been.",
        numbers=numbers,
        letters=letters,
        level=np.array(levels),
        curves=(curve,),
        unit=ARC_SECOND,
        labels=("position (arc-seconds)", "torque (N·m)"),
    )


def _driven(
    label: str,
    law: FrictionModel,
    levels: Sequence[float],
    *,
    ramp_rate: float = math.inf,
    hold: float = 0.0,
) -> tuple[Curve, dict[str, FloatArray]]:
    """A law through levels of force, and its states at them."""
    efforts, positions, settled = [np.zeros(1)], [np.zeros(1)], []
    states: dict[str, list[float]] = {}
    force = 0.0
    at = 0.0
    for level in levels:
        # A spring knows no time: a leg then takes a second.
        duration = abs(level - force) / ramp_rate if math.isfinite(ramp_rate) else 1.0
        path = ForcePath(
            law,
            [level],
            start=force,
            ramp_rate=abs(level - force) / duration,
            hold=hold,
            step=duration / _LEG_SAMPLES,
        )
        record: dict[str, Any] = path.record(0.0)
        efforts.append(record["effort"])
        positions.append(at + record["position"])
        at, force = float(positions[-1][-1]), float(level)
        settled.append(at)
        for name, values in record["states"].items():
            states.setdefault(name, []).append(float(values[-1]))
    curve = Curve(label, np.concatenate(efforts), np.concatenate(positions), np.array(settled))
    return curve, {name: np.array(values) for name, values in states.items()}


def _known(name: str, **values: float) -> FrictionModel | None:
    """A law with those of these parameters that it has; None where the catalogue lacks it."""
    for record in catalogue.laws():
        if record.name == name:
            own = {p.name for p in record.parameters}
            return FrictionModel(name, **{k: v for k, v in values.items() if k in own})
    return None
