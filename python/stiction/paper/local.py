"""Properties P1 and P2 of the paper: friction varies from place to place, and is itself in each."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from .._native import FrictionModel
from .._support.arrays import FloatArray
from ..errors import InputError
from ..motor import Motor
from .arguments import check_arguments
from .result import Number, Result, arcsec
from .rig import ARC_SECOND, illustrative_motor
from .stick_slip import SLIDING

__all__ = ["LocalVariation", "local_variation"]

MOST_PLACES: Final = 1000
MOST_SHARE: Final = 0.6
_DT: Final = 5e-4  # s
_RAMP_RATE: Final = 0.25  # N·m/s, that of experiment 1
_LONGEST: Final = 4.0  # s
_LEVEL: Final = 0.15  # N·m, at which the displacement is read
_BESIDE: Final = 10.0 * ARC_SECOND
"""A place within the pre-sliding range of another."""
_TRIES: Final = 3


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class LocalVariation(Result):
    """Ramps of torque at places round the shaft. One row a place.

    Attributes
    ----------
    place : numpy.ndarray, shape (n,)
        rad.
    breakaway : numpy.ndarray, shape (n, tries)
        Torque at which the hook broke away, N·m.
    displacement : numpy.ndarray, shape (n, tries)
        Displacement under 0.15 N·m on the way, rad.
    torque, path : tuple of numpy.ndarray
        Torque and displacement of the first ramp at each place, up to its break-away.
    """

    place: FloatArray
    breakaway: FloatArray
    displacement: FloatArray
    torque: tuple[FloatArray, ...]
    path: tuple[FloatArray, ...]


@check_arguments
def local_variation(*, places: int = 12, share: float = 0.5, periods: int = 2) -> LocalVariation:
    """Ramp the torque at places round the shaft, several times at each.

    The paper states that static friction varies with time and position, break-away by several
    times from one point to another (P1), and that it is nevertheless the same as long as one
    stays in the pre-sliding range of a point (P2). Here the level of friction repeats with
    position, by the effect ``position_dependent_friction``; amplitude and periods are ours.

    Parameters
    ----------
    places : int
        Evenly round the shaft.
    share : float
        Amplitude of the wave, as a share of friction; below 0.6.
    periods : int
        Of the wave, a turn.

    Returns
    -------
    LocalVariation

    Raises
    ------
    InputError
        Places, a share or periods out of these bounds.

    Source
    ------
    Hsieh, Pan, Wear 242 (2000), §2.2.1, P1 and P2.

    Examples
    --------
    >>> run = local_variation(places=4)
    >>> run.numbers["greatest break-away over the least"].value > 2.0
    True
    """
    if not 1 <= places <= MOST_PLACES:
        raise InputError(f"local_variation: places = {places}; give 1 to {MOST_PLACES}")
    if not 0.0 <= share < MOST_SHARE:
        raise InputError(
            f"local_variation: share = {share:g}; give 0 to less than {MOST_SHARE:g}: beyond, the "
            "ramps do not break every place away, or have nothing to break"
        )
    wave = {"position_dependent_friction": {"cosine": share, "order": float(periods)}}
    base = illustrative_motor(integrator="fast", **SLIDING)
    law, keywords = base.friction_settings()
    motor = Motor(friction=FrictionModel(law, **keywords), **{**base.settings(), "effects": wave})
    at = 2.0 * math.pi * np.arange(places) / places
    ramps = [[_ramp(motor, float(place)) for _ in range(_TRIES)] for place in at]
    breakaway = np.array([[torque[-1] for torque, _ in tries] for tries in ramps])
    read = np.array(
        [[float(np.interp(_LEVEL, torque, path)) for torque, path in tries] for tries in ramps]
    )
    beside = [_ramp(motor, float(place) + _BESIDE) for place in at]
    nearby = max(
        abs(float(torque[-1]) - float(own[0]))
        for (torque, _), own in zip(beside, breakaway, strict=True)
    )
    numbers = {
        "greatest break-away": Number(float(breakaway.max()), "N·m"),
        "least break-away": Number(float(breakaway.min()), "N·m"),
        "greatest break-away over the least": Number(float(breakaway.max() / breakaway.min()), "1"),
        "change of break-away when repeated in place": Number(
            float(np.max(np.ptp(breakaway, axis=1))), "N·m"
        ),
        "change of break-away 10 arcsec beside": Number(nearby, "N·m"),
        "greatest displacement under 0.15 N·m": arcsec(float(read.max())),
        "least displacement under 0.15 N·m": arcsec(float(read.min())),
    }
    return LocalVariation(
        title="Break-away round the shaft, and again in each place",
        source="Wear 242 (2000), §2.2.1, P1 and P2",
        shows="Friction differs from place to place and repeats in each: a controller may take it "
        "as constant as long as it stays near one.",
        numbers=numbers,
        place=np.asarray(at),
        breakaway=breakaway,
        displacement=read,
        torque=tuple(tries[0][0] for tries in ramps),
        path=tuple(tries[0][1] for tries in ramps),
    )


def _ramp(motor: Motor, place: float) -> tuple[FloatArray, FloatArray]:
    """Torque and displacement from rest at a place up to where the hook breaks away."""
    torque = _RAMP_RATE * _DT * np.arange(1, round(_LONGEST / _DT) + 1)
    motor.reset(position=place)
    run = motor.simulate(torque, _DT, outputs=("position", "mode"))
    slid = int(np.argmax(run["mode"] != 0.0))
    return np.asarray(torque[: slid + 1]), np.asarray(run["position"][: slid + 1] - place)
