"""The paper's static tests (section 2.1.2), and what they show about memory and hardening.

The paper states that every level of torque is held for 2 s and that the position is recorded at
the end. It steps from level to level, and so do the tests here with ``driven="staircase"``; but
each step overshoots by nearly its own height. The overshoot hardens the junctions a little beyond
the level and leaves the spring on another branch, farther along. ``driven="ramp"`` approaches the
levels slowly, and ``driven="force"`` leaves inertia and damper out, so that the friction itself
passes exactly through the levels.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import catalogue
from .._native import FrictionModel
from .._support.arrays import FloatArray
from ..errors import InputError
from .arguments import check_arguments
from .bench import fits
from .dynamic import STEP
from .paths import FORCE_STEP, RAMP_RATE, ForcePath, motor_path
from .result import Known, MotionResult, Number, Result, arcsec, enumerate_values
from .rig import RigLike, build_friction, is_illustrative

__all__ = [
    "STATIC_CASES",
    "DahlTest",
    "HardeningCycles",
    "NestedLoops",
    "StaticCase",
    "StaticTest",
    "dahl_on_static_1",
    "hardening_cycles",
    "nested_loops",
    "static_test",
]

HOLD = 2.0  # s, stated


@dataclass(frozen=True)
class StaticCase:
    """Levels of torque of a static test, N·m, and the letters of its points.

    The rotor starts at point a without torque; one letter a level.
    """

    source: str
    shows: str
    letters: tuple[str, ...]
    levels: tuple[float, ...]
    positions: tuple[float, ...] = ()
    """What the prototype read at the levels, force-driven, arc-seconds; empty where it did not."""


STATIC_CASES = {
    1: StaticCase(
        "Figs. 5 and 15d",
        "Loops that follow each other at rising torque close where they began; creep adds to them.",
        tuple("bcdefghijk"),
        (0.16, 0.02, 0.16, 0.26, 0.06, 0.26, 0.36, 0.10, 0.36, 0.40),
        (21.14, 10.91, 21.18, 45.19, 30.17, 45.25, 78.23, 58.14, 78.32, 94.10),
    ),
    2: StaticCase(
        "Figs. 6 and 15e",
        "A loop within a loop: closed, it is forgotten, and the curve goes on along the older "
        "branch.",
        tuple("bcdefgh"),
        (0.34, -0.20, 0.22, -0.08, 0.22, 0.34, 0.40),
    ),
    3: StaticCase(
        "Figs. 7 and 15f",
        "Every branch is the same curve, turned and shifted, whatever the torque at its reverse "
        "point.",
        tuple("bcdefgh"),
        (0.36, -0.30, 0.24, -0.18, 0.12, -0.06, 0.0),
    ),
}
"""The three static tests by number; :func:`static_test` says what of them the paper states."""


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class StaticTest(MotionResult):
    """A static test. One entry a level.

    Attributes
    ----------
    case : int or None
        1, 2 or 3; None where the levels were given.
    driven : {"force", "ramp", "staircase"}
        How each level was reached.
    letters : tuple of str
        Names of the points.
    level : numpy.ndarray, shape (levels,)
        N·m.
    settled_at : numpy.ndarray of int, shape (levels,)
        Entry of the record at the end of each hold.
    settled : numpy.ndarray, shape (levels,)
        Position read there, rad.
    """

    case: int | None
    driven: str
    letters: tuple[str, ...]
    level: FloatArray
    settled_at: np.ndarray[Any, np.dtype[np.int64]]
    settled: FloatArray


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class HardeningCycles(MotionResult):
    """Alternating torque on a force-driven path. One entry a half cycle.

    Attributes
    ----------
    amplitude : float
        N·m.
    settled_at : numpy.ndarray of int, shape (half cycles,)
        Entry of the record at the end of each half cycle.
    permanent : numpy.ndarray, shape (half cycles,)
        Permanent displacement that the half cycle added, rad.
    """

    amplitude: float
    settled_at: np.ndarray[Any, np.dtype[np.int64]]
    permanent: FloatArray


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class NestedLoops(MotionResult):
    """Loops within loops of the spring alone. One entry a level.

    Attributes
    ----------
    letters : tuple of str
        Names of the points.
    level : numpy.ndarray, shape (levels,)
        N·m.
    settled_at : numpy.ndarray of int, shape (levels,)
        Entry of the record at which each level is reached.
    settled : numpy.ndarray, shape (levels,)
        Displacement of the spring there, rad.
    reverse_points : numpy.ndarray of int, shape (n,)
        Reverse points that the memory holds after each sample of the record.
    """

    letters: tuple[str, ...]
    level: FloatArray
    settled_at: np.ndarray[Any, np.dtype[np.int64]]
    settled: FloatArray
    reverse_points: np.ndarray[Any, np.dtype[np.int64]]


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class DahlTest(Result):
    """Static test 1 of Dahl's law.

    Attributes
    ----------
    letters : tuple of str
        Names of the points.
    level, settled : numpy.ndarray, shape (levels,)
        N·m and rad, one entry a level.
    effort, position : numpy.ndarray, shape (n,)
        The path through them, N·m and rad.
    """

    letters: tuple[str, ...]
    level: FloatArray
    settled: FloatArray
    effort: FloatArray
    position: FloatArray


@check_arguments
def static_test(
    case: int = 1,
    *,
    driven: str = "force",
    levels: Sequence[float] | None = None,
    ramp_rate: float = RAMP_RATE,
    hold: float = HOLD,
    rig: RigLike = None,
    integrator: str = "reference",
    dt: float | None = None,
    encoder_count: float = 0.0,
) -> StaticTest:
    """One of the paper's three static tests: levels of torque, each held for 2 s.

    What is stated, and what is ours. The excerpt of the paper gives no levels: all of them are
    ours, and so are point a (no torque) and the last point, beyond the last loop. Stated are the
    order of the points and what they do:

    * Case 1 (Fig. 5): loops b-c-d, e-f-g and h-i-j, one after the other at rising levels; b, e
      and h are recovered by d, g and j.
    * Case 2 (Fig. 6): loop d-e-f inside loop b-c-g; f recovers d, and curve fg follows cd
      instead of ef.
    * Case 3 (Fig. 7): only that every branch is the same curve, shifted or turned by half a
      turn. The text does not count it among the figures with closed loops; torque of both
      directions that dies away, so that no reverse point is met again, is our reading.

    Parameters
    ----------
    case : {1, 2, 3}
        Which of the paper's three sequences of levels.
    driven : {"force", "ramp", "staircase"}
        How a level is reached. "force": the friction follows a ramp exactly, without inertia and
        damper, as an implicit host would use the law (``FrictionModel.trial`` and ``commit``
        with Newton's method on the velocity). "ramp": the motor, driven by the same ramps.
        "staircase": the motor, driven by steps, as in the paper; every step overshoots.
    levels : sequence of float, optional
        Levels in place of those of the case, N·m.
    ramp_rate : float
        N·m/s; ours. Without meaning for "staircase".
    hold : float
        Time for which a level is held once it is reached, s; 2 s in the paper.
    rig : mapping, FrictionModel or Motor, optional
        What is tested; the illustrative rig, or overrides of its parameters.
    integrator : {"reference", "fast"}
        Without meaning for "force".
    dt : float, optional
        Duration of a sample, s; 5e-5 for the motor and 2e-3 for "force".
    encoder_count : float
        Count of the encoder that the experimenter reads, rad; 0 for the position itself.

    Returns
    -------
    StaticTest

    Raises
    ------
    InputError
        An unknown case or way of driving, or a level at which the friction slips.

    Source
    ------
    Hsieh, Pan, Wear 242 (2000), §2.1.2 and §2.2.4, Figs. 5-7 and 15d-f.

    Examples
    --------
    >>> test = static_test(1)
    >>> round(test.numbers["position b"].value, 2)
    21.14
    """
    if case not in STATIC_CASES:
        raise InputError(f"static_test: case {case!r} is not known; give 1, 2 or 3")
    if driven not in ("force", "ramp", "staircase"):
        raise InputError(
            f"static_test: driven = {driven!r} is not known; give 'force', 'ramp' or 'staircase'"
        )
    chosen = STATIC_CASES[case]
    letters, source = chosen.letters, f"Wear 242 (2000), {chosen.source}"
    own_levels = levels is not None
    if levels is None:
        levels = chosen.levels
    elif not levels:
        raise InputError("static_test: there are no levels; give at least one, in N·m")
    else:
        letters = tuple(_letter(index) for index in range(len(levels)))
    if driven == "force":
        path = ForcePath(
            build_friction(rig, damping=0.0),
            levels,
            ramp_rate=ramp_rate,
            hold=hold,
            step=FORCE_STEP if dt is None else dt,
        )
        record, settled_at = path.record(encoder_count), path.reached
    else:
        rate = ramp_rate if driven == "ramp" else math.inf
        step = STEP if dt is None else dt
        record, settled_at = motor_path(rig, integrator, step, encoder_count, levels, rate, hold)
    settled = record["measured"][settled_at]
    standard = (
        is_illustrative(rig)
        and not own_levels
        and driven == "force"
        and (ramp_rate, hold, encoder_count) == (RAMP_RATE, HOLD, 0.0)
    )
    figures: Sequence[Known] = chosen.positions if standard else ()
    numbers = {
        f"position {letter}": arcsec(position, figures[index] if figures else None)
        for index, (letter, position) in enumerate(zip(letters, settled, strict=True))
    }
    words = {
        "force": "force-driven",
        "ramp": "slow ramps with inertia",
        "staircase": "steps with inertia",
    }
    name = "levels of your own" if own_levels else f"case {case}"
    return StaticTest(
        title=f"Static test, {name} ({words[driven]})",
        source=source,
        shows="" if own_levels else chosen.shows,
        numbers=numbers,
        case=None if own_levels else case,
        driven=driven,
        letters=letters,
        level=np.array(levels, dtype=np.float64),
        settled_at=settled_at,
        settled=settled,
        **record,
    )


@check_arguments
def hardening_cycles(
    *,
    amplitude: float = 0.3,
    half_cycles: int = 5,
    ramp_rate: float = RAMP_RATE,
    hold: float = HOLD,
    rig: RigLike = None,
    dt: float = FORCE_STEP,
    encoder_count: float = 0.0,
) -> HardeningCycles:
    """Torque of alternating sign: hardening of one direction counts for the other.

    The first direction takes all the permanent displacement; what hardened then does not yield
    again when the torque is turned round. That is the isotropic law of the paper, as its
    Fig. 15h shows. Force-driven, with the ramps and holds of :func:`static_test`.

    Parameters
    ----------
    amplitude : float
        N·m; ours.
    half_cycles : int
        How many times the torque is applied, +, −, +, …
    ramp_rate, hold, rig, encoder_count
        As in :func:`static_test`.
    dt : float
        Duration of a sample, s.

    Returns
    -------
    HardeningCycles

    Raises
    ------
    InputError
        A law without a plastic module, or an amplitude at which it slips.

    Source
    ------
    Hsieh, Pan, Wear 242 (2000), §2.2.3, Fig. 15h.

    Examples
    --------
    >>> cycles = hardening_cycles()
    >>> round(cycles.numbers["permanent displacement, half cycle 1"].value, 2)
    29.63
    """
    law = build_friction(rig, damping=0.0)
    if "plastic" not in law.state:
        raise InputError(
            f"hardening_cycles: law '{law.law}' has no plastic module; give 'hsieh_pan'"
        )
    fits(half_cycles, "hardening_cycles")
    if half_cycles < 1:
        raise InputError(f"hardening_cycles: {half_cycles} half cycles; give at least one")
    levels = [amplitude * (-1.0) ** index for index in range(half_cycles)]
    path = ForcePath(law, levels, ramp_rate=ramp_rate, hold=hold, step=dt)
    record = path.record(encoder_count)
    permanent = np.diff(record["states"]["plastic"][path.reached], prepend=0.0)
    standard = is_illustrative(rig) and (amplitude, ramp_rate, hold) == (0.3, RAMP_RATE, HOLD)
    return HardeningCycles(
        title=f"Hardening under torque of ±{amplitude:g} N·m",
        source="Wear 242 (2000), Fig. 15h",
        shows="Hardening is isotropic: the first direction takes all the permanent displacement, "
        "what follows in either direction next to none.",
        numbers=enumerate_values(
            "permanent displacement, half cycle",
            map(arcsec, permanent.tolist()),
            (29.63, -0.07, *[0.0] * half_cycles) if standard else (),
        ),
        amplitude=amplitude,
        settled_at=path.reached,
        permanent=permanent,
        **record,
    )


@check_arguments
def nested_loops(*, rig: RigLike = None, dt: float = FORCE_STEP) -> NestedLoops:
    """Loops within loops of the spring alone: every reverse point is met again and forgotten.

    The plastic module is switched off, so that what is left is the spring. The torque turns round
    at b, c, d, e, f and g, each inside the last two, and then rises: at f′, d′ and b′ it passes
    the levels of f, d and b, closes a loop, and goes on along the older branch. Point h lies on
    the curve of a first loading, as if there had been no loops. Levels are ours.

    Parameters
    ----------
    rig : mapping, FrictionModel or Motor, optional
        As in :func:`static_test`.
    dt : float
        Duration of a sample, s.

    Returns
    -------
    NestedLoops

    Raises
    ------
    InputError
        A law without a spring with memory.

    Source
    ------
    Hsieh, Pan, Wear 242 (2000), §2.2.4, properties (i) and (ii), Figs. 6 and 15i, j.

    Examples
    --------
    >>> loops = nested_loops()
    >>> loops.numbers["reverse points kept at the end"].value
    0.0
    """
    law = build_friction(rig, damping=0.0, hardening_coefficient=0.0)
    if "reverse_points" not in law.state:
        raise InputError(f"nested_loops: law '{law.law}' keeps no reverse points")
    letters = ("b", "c", "d", "e", "f", "g", "f′", "d′", "b′", "h")
    levels = (0.40, -0.32, 0.30, -0.22, 0.20, -0.12, 0.20, 0.30, 0.40, 0.46)
    path = ForcePath(law.copy(), levels, step=dt)
    direct = ForcePath(law.copy(), levels[-1:], step=dt)
    record = path.record(0.0)
    settled = record["position"][path.reached]
    at = dict(zip(letters, settled, strict=True))
    numbers = {
        f"gap at {point} met again": Number(abs(at[f"{point}′"] - at[point]), "rad", (0.0, 1e-14))
        for point in ("f", "d", "b")
    }
    numbers["gap at h from a first loading"] = Number(
        abs(at["h"] - direct.record(0.0)["position"][-1]), "rad", (0.0, 1e-14)
    )
    kept = np.array(path.reverse_points, dtype=np.int64)
    numbers["reverse points kept at most"] = Number(float(kept.max()), "1")
    numbers["reverse points kept at the end"] = Number(float(kept[-1]), "1")
    return NestedLoops(
        title="Nested loops of the spring: met again, then forgotten",
        source="Wear 242 (2000), Figs. 6 and 15i, j",
        shows="Reverse points are met again and loops that close are forgotten.",
        numbers=numbers,
        letters=letters,
        level=np.array(levels),
        settled_at=path.reached,
        settled=settled,
        reverse_points=kept,
        **record,
    )


@check_arguments
def dahl_on_static_1(*, stiffness: float = 2063.0, coulomb: float = 0.5) -> DahlTest:
    """Dahl's law on static test 1: loops that never close.

    dF/dx = γ·(1 − s·F/F_c)² in direction s, the case i = 2 of eq. (1), which integrates to
    x = s·(F_c/γ)/(1 − s·F/F_c) between two forces. Without memory of reverse points the loop
    b-c-d drifts by more than ten arc-seconds. Where the catalogue has the law ``dahl`` it goes the
    same path, and its distance from the closed form is one of the numbers.

    Parameters
    ----------
    stiffness : float
        γ, N·m/rad; stated under Fig. 8.
    coulomb : float
        F_c, N·m; stated under Fig. 8.

    Returns
    -------
    DahlTest

    Raises
    ------
    InputError
        `coulomb` not above the highest level of the test, or `stiffness` not above 0.

    Source
    ------
    Hsieh, Pan, Wear 242 (2000), §2.3, eq. (1), Fig. 8.

    Examples
    --------
    >>> round(dahl_on_static_1().numbers["drift of loop b-c-d"].value, 1)
    11.2
    """
    case = STATIC_CASES[1]
    if coulomb <= max(case.levels) or stiffness <= 0.0:
        raise InputError(
            f"dahl_on_static_1: coulomb = {coulomb}, stiffness = {stiffness}; give a coulomb "
            f"above {max(case.levels)} and a stiffness above 0"
        )
    start, force = 0.0, 0.0
    efforts, positions, settled = [np.zeros(1)], [np.zeros(1)], []
    for level in case.levels:
        s = math.copysign(1.0, level - force)
        path = np.linspace(force, level, 100)[1:]
        travel = s * coulomb / stiffness * (1.0 / (1.0 - s * path / coulomb))
        travel -= s * coulomb / stiffness * (1.0 / (1.0 - s * force / coulomb))
        efforts.append(path)
        positions.append(start + travel)
        start, force = float(positions[-1][-1]), level
        settled.append(start)
    at = dict(zip(case.letters, settled, strict=True))
    standard = (stiffness, coulomb) == (2063.0, 0.5)
    numbers = {
        "drift of loop b-c-d": arcsec(at["d"] - at["b"], 11.2 if standard else None),
        "drift of loop e-f-g": arcsec(at["g"] - at["e"]),
        "drift of loop h-i-j": arcsec(at["j"] - at["h"]),
    }
    if any(record.name == "dahl" for record in catalogue.laws()):
        law = FrictionModel("dahl", initial_stiffness=stiffness, coulomb=coulomb, exponent=2.0)
        driven = ForcePath(law, case.levels)
        by_law = driven.record(0.0)["position"][driven.reached]
        numbers["greatest distance of the law dahl from the closed form"] = arcsec(
            float(np.max(np.abs(by_law - np.array(settled))))
        )
    return DahlTest(
        title="Dahl's law on static test 1",
        source="Wear 242 (2000), Fig. 8",
        shows="A law without memory of reverse points never closes a loop.",
        numbers=numbers,
        letters=case.letters,
        level=np.array(case.levels),
        settled=np.array(settled),
        effort=np.concatenate(efforts),
        position=np.concatenate(positions),
    )


def _letter(index: int) -> str:
    """b, c, … z, then b2, c2, …; a is where the rotor starts."""
    round_, place = divmod(index, 25)
    return chr(ord("b") + place) + (str(round_ + 1) if round_ else "")
