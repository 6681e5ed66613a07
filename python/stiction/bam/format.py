"""What files of `better-actuator-models` (BAM) hold: names, bounds of its search, and its servos.

A file names a model of friction (M1 to M6), an actuator, and numbers by name. What the actuator is
told by its makers (gain, supply, limits) stands in BAM's code, and so do the bounds of its search:
both as of its release 1.0.2. A number that a file leaves out is BAM's start of the search.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, Literal

__all__ = [
    "ACTUATORS",
    "BESIDE",
    "GOAL",
    "LOAD",
    "MODELS",
    "RELEASE",
    "Actuator",
    "Searched",
    "own_of",
    "search_space",
]

RELEASE: Final = "1.0.2"
BESIDE: Final = ("kp", "vin", "mass", "length", "input")
"""Keys beside those of BAM, which passes over them: what its logs say of gain, supply and payload,
and, last, the input of a drive that is no servo."""
LOAD: Final = "load_dependent_friction"
GOAL: Final = "goal_rate_limit"
"""Effects of ours that BAM's models hold: what load friction of a gear grows with, and how fast its
firmware lets a goal go (``max_velocity``)."""


@dataclass(frozen=True)
class Searched:
    """Where BAM's search starts, and how far it goes."""

    start: float
    least: float
    most: float


@dataclass(frozen=True)
class Actuator:
    """What BAM's code says of an actuator.

    Attributes
    ----------
    kind : {"voltage", "current", "other"}
        Whether a P controller makes a voltage of the distance, a PD controller a current, or
        something that no drive here does.
    kp : float or None
        Gain of the firmware where no log states one, in units of its own.
    error_gain : float
        Duty (of current: A) per kp and rad.
    supply : float
        V.
    duty_limit, current_limit : float
        Of 1; A.
    damping : float
        Of a PD controller: A·s/rad is ``damping``·√kp.
    own : mapping of str to Searched
        Numbers of its motor.
    most_friction, most_load, most_viscous : float
        Upper bounds of the numbers of friction.
    """

    kind: Literal["voltage", "current", "other"]
    kp: float | None = None
    error_gain: float = 1.0
    supply: float = 0.0
    duty_limit: float = 1.0
    current_limit: float = math.inf
    damping: float = 0.0
    own: Mapping[str, Searched] = field(default_factory=dict)
    most_friction: float = 0.2
    most_load: float = 0.5
    most_viscous: float = 1.0


def _motor(kt: Searched, resistance: Searched, armature: Searched) -> dict[str, Searched]:
    return {"kt": kt, "R": resistance, "armature": armature}


_MX: Final = Actuator(
    "voltage",
    32.0,
    0.158,
    15.0,
    0.9625,
    own=_motor(Searched(1.6, 1.0, 3.0), Searched(2.0, 1.0, 5.0), Searched(0.005, 0.001, 0.05)),
)
_XL330_MOTOR: Final = _motor(
    Searched(1.6, 0.1, 3.0), Searched(2.6, 2.0, 5.0), Searched(0.005, 1e-4, 0.05)
)
_EROB_MOTOR: Final = _motor(
    Searched(1.6, 1.0, 15.0), Searched(2.0, 0.1, 3.5), Searched(0.005, 0.001, 2.0)
)
_STS3215_SPEED: Final = 3400.0 * 2.0 * math.pi / 4096.0
"""Counts a second of its firmware, in rad/s."""


def _erob(damping: float) -> Actuator:
    return Actuator(
        "current",
        supply=48.0,
        current_limit=12.0,
        damping=damping,
        own=_EROB_MOTOR,
        most_friction=10.0,
        most_load=1.0,
        most_viscous=30.0,
    )


ACTUATORS: Final[Mapping[str, Actuator]] = {
    "xl330": Actuator(
        "voltage",
        400.0,
        4096.0 / (2.0 * math.pi) / (256.0 * 885.0),
        7.5,
        current_limit=1.75,
        own=_XL330_MOTOR,
    ),
    "xl320": Actuator(
        "voltage",
        32.0,
        0.05048199,
        7.5,
        own=_motor(
            Searched(0.7, 0.25, 1.5), Searched(5.0, 3.0, 40.0), Searched(0.0005, 1e-4, 0.01)
        ),
        most_load=1.0,
    ),
    "mx64": _MX,
    "mx106": _MX,
    "sts3215": Actuator(
        "voltage",
        32.0,
        0.166,
        7.4,
        0.97,
        own={
            **_motor(
                Searched(0.784532, 0.05, 2.5), Searched(2.0, 0.1, 10.0), Searched(1e-4, 1e-5, 0.04)
            ),
            "error_gain_ratio": Searched(1.0, 0.1, 10.0),
            "max_velocity": Searched(_STS3215_SPEED, 0.1 * _STS3215_SPEED, 10.0 * _STS3215_SPEED),
        },
    ),
    "erob80_100": _erob(2.0),
    "erob80_50": _erob(1.0),
    "xl330i": Actuator(
        "other", own={**_XL330_MOTOR, "current_limit": Searched(1.5, 1.0, 3.0)}, supply=7.5
    ),
    "unitree_go1": Actuator(
        "other",
        own={
            "ratio": Searched(1.0, 0.5, 2.0),
            "max_torque": Searched(23.7, 20.0, 30.0),
            "armature": Searched(0.005, 1e-5, 2.0),
        },
        most_friction=5.0,
        most_load=2.0,
    ),
}
"""Actuators of the release; others, of people's own, have names of their own."""
_STRIBECK: Final = ("friction_stribeck", "dtheta_stribeck", "alpha")
_DIRECTIONAL: Final = (
    "load_friction_motor",
    "load_friction_external",
    "load_friction_motor_stribeck",
    "load_friction_external_stribeck",
)
MODELS: Final[Mapping[str, tuple[str, ...]]] = {
    "m1": (),
    "m2": _STRIBECK,
    "m3": ("load_friction_base",),
    "m4": ("load_friction_base", "load_friction_stribeck", *_STRIBECK),
    "m5": (*_DIRECTIONAL, *_STRIBECK),
    "m6": (
        *_DIRECTIONAL,
        "load_friction_motor_quad",
        "load_friction_external_quad",
        *_STRIBECK,
    ),
}
"""Numbers of friction of each model beside ``friction_base`` and ``friction_viscous``."""


def own_of(actuator: str) -> Mapping[str, Searched]:
    """Numbers of the motor of an actuator; of one that BAM does not have, kt, R and armature."""
    if actuator in ACTUATORS:
        return ACTUATORS[actuator].own
    free = Searched(math.nan, 0.0, math.inf)
    return _motor(free, free, free)


def search_space(model: str, actuator: str) -> dict[str, Searched]:
    """Every number that BAM's search finds for a model and an actuator."""
    of = ACTUATORS.get(actuator, Actuator("other"))
    load = Searched(0.05, 0.0, of.most_load)
    steep, quadratic = Searched(0.05, 0.0, 1.0), Searched(0.0, 0.0, 0.01)
    offset = Searched(0.0, -0.1, 0.1)
    every = {
        "q_offset": offset,
        "friction_base": Searched(0.05, 0.0, of.most_friction),
        "friction_viscous": Searched(0.1, 0.0, of.most_viscous),
        "friction_stribeck": Searched(0.05, 0.0, of.most_friction),
        "load_friction_base": load,
        "load_friction_motor": load,
        "load_friction_external": load,
        "load_friction_stribeck": steep,
        "load_friction_motor_stribeck": steep,
        "load_friction_external_stribeck": steep,
        "load_friction_motor_quad": quadratic,
        "load_friction_external_quad": quadratic,
        "dtheta_stribeck": Searched(0.2, 0.01, 5.0),
        "alpha": Searched(1.35, 0.5, 10.0),
    }
    names = ("q_offset", "friction_base", "friction_viscous", *MODELS[model])
    return {**own_of(actuator), **{name: every[name] for name in names}}
