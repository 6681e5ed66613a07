"""The rig on which the experiments run unless another is given.

Hsieh and Pan print no parameter values in the part of the paper that is followed here. The rig
is therefore illustrative: a direct-drive motor of the size of theirs, with numbers chosen so that
every experiment shows what the paper's figures show. They are not the authors' numbers.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, TypeAlias

from .._native import FrictionModel
from .._support.frozen import Frozen
from ..errors import InputError
from ..motor import Motor

__all__ = [
    "ARC_SECOND",
    "COARSE_COUNT",
    "FINE_COUNT",
    "ILLUSTRATIVE_RIG",
    "RigLike",
    "illustrative_friction",
    "illustrative_motor",
]

ARC_SECOND = math.pi / 648_000.0
"""One arc-second in rad."""

FINE_COUNT = 0.8 * ARC_SECOND
"""Count of the fine encoder (1 620 000 counts a revolution), rad; stated in the paper."""

COARSE_COUNT = 15.0 * ARC_SECOND
"""Count of the coarse encoder (86 400 counts a revolution), rad; stated in the paper."""

ILLUSTRATIVE_RIG: Mapping[str, float] = Frozen(
    {
        "inertia": 0.0076,
        "initial_stiffness": 3000.0,
        "final_stiffness": 800.0,
        "decay_distance": 60.0 * ARC_SECOND,
        "hardening_coefficient": 1.6e-3,
        "hardening_exponent": 2.0,
        "creep_rate": 2.0,
        "damping": 0.45,
    }
)
"""Inertia (kg·m²) and the parameters of the law ``hsieh_pan``; illustrative, not the authors'."""

RigLike: TypeAlias = Mapping[str, float | str] | FrictionModel | Motor | None
"""What the keyword ``rig`` of an experiment takes.

None: the illustrative rig. A mapping: the illustrative rig with these values (``inertia`` or any
parameter or option of ``hsieh_pan``) in place of its own. A FrictionModel: the illustrative
inertia with this law. A Motor: its settings and law, starting at rest in the virgin state.
"""


def illustrative_friction(**overrides: float | str) -> FrictionModel:
    """The friction of the illustrative rig, with overrides by the law's keywords."""
    own = {name: value for name, value in ILLUSTRATIVE_RIG.items() if name != "inertia"}
    return FrictionModel("hsieh_pan", **{**own, **overrides})


def illustrative_motor(*, integrator: str = "reference", **overrides: float | str) -> Motor:
    """The illustrative rig as a motor driven by torque.

    Parameters
    ----------
    integrator : {"reference", "fast"}
        As in :class:`stiction.Motor`.
    **overrides : float or str
        ``inertia`` in kg·m², or any parameter or option of ``hsieh_pan``.

    Examples
    --------
    >>> illustrative_motor(creep_rate=1.0).parameters["friction.creep_rate"]
    1.0
    """
    inertia, law = _split(overrides)
    return Motor(inertia=inertia, friction=illustrative_friction(**law), integrator=integrator)


def build_motor(rig: RigLike, integrator: str) -> Motor:
    """The motor that an experiment drives: at rest, virgin, with this integrator."""
    if rig is None:
        return illustrative_motor(integrator=integrator)
    if isinstance(rig, FrictionModel):
        inertia = ILLUSTRATIVE_RIG["inertia"]
        return Motor(inertia=inertia, friction=_virgin(rig), integrator=integrator)
    if isinstance(rig, Motor):
        settings: dict[str, Any] = {**rig.settings(), "integrator": integrator}
        return Motor(friction=build_friction(rig), **settings)
    return illustrative_motor(integrator=integrator, **_mapping(rig))


def build_friction(rig: RigLike, **fixed: float) -> FrictionModel:
    """The virgin friction law of a rig; `fixed` holds where the law has such a parameter."""
    if isinstance(rig, Motor):
        law, settings = rig.friction_settings()
        model = FrictionModel(law, **settings)
    elif isinstance(rig, FrictionModel):
        model = _virgin(rig)
    else:
        model = illustrative_friction(**_split(_mapping({} if rig is None else rig))[1])
    keywords: dict[str, float | str] = {**model.parameters, **model.options}
    keywords |= {name: value for name, value in fixed.items() if name in model.parameters}
    return FrictionModel(model.law, **keywords)


def is_illustrative(rig: RigLike) -> bool:
    """Whether the rig is the illustrative one, unchanged."""
    return rig is None or (isinstance(rig, Mapping) and not rig)


def _virgin(law: FrictionModel) -> FrictionModel:
    model = law.copy()
    model.reset()
    return model


def _mapping(rig: object) -> dict[str, float | str]:
    if not isinstance(rig, Mapping):
        raise InputError(
            f"rig = {rig!r} is no rig; give a mapping of parameters, a FrictionModel or a Motor"
        )
    return dict(rig)


def _split(values: Mapping[str, float | str]) -> tuple[float, dict[str, float | str]]:
    """Inertia, and the keywords of the law."""
    law = dict(values)
    inertia = law.pop("inertia", ILLUSTRATIVE_RIG["inertia"])
    if isinstance(inertia, str):
        raise InputError(f"rig: inertia = '{inertia}' is a word; give a number in kg·m²")
    return inertia, law
