"""How large each effect has to be to make a given share of the dry friction."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from .machine import Effects, Machine
from .signals import FloatArray

__all__ = ["HIDDEN", "MOVED_HIDDEN", "Plain", "with_effect"]


def _either(rng: np.random.Generator) -> float:
    return 1.0 if rng.random() < 0.5 else -1.0


def _stribeck(size: float, machine: Machine, plain: Plain, rng: np.random.Generator) -> Any:
    speed = plain.speed * float(rng.uniform(0.05, 0.4))
    return {"fall": min(2.5 * size, 0.9), "fall_speed": speed}


def _quadratic(size: float, machine: Machine, plain: Plain, rng: np.random.Generator) -> Any:
    return {"quadratic": size * machine.coulomb / max(plain.speed, 1e-9) ** 2}


def _cogging(size: float, machine: Machine, plain: Plain, rng: np.random.Generator) -> Any:
    order = float(rng.choice([1, 2, 4, 6, 7, 12, 20]))
    height, phase = 1.4 * size * machine.coulomb, float(rng.uniform(0.0, 2.0 * math.pi))
    return {"waves": ((height, order, phase), (0.25 * height, 2.0 * order, 2.0 * phase))}


def _asymmetry(size: float, machine: Machine, plain: Plain, rng: np.random.Generator) -> Any:
    return {"asymmetry": _either(rng) * size}


def _bias(size: float, machine: Machine, plain: Plain, rng: np.random.Generator) -> Any:
    return {"bias": _either(rng) * size * machine.coulomb}


def _late(size: float, machine: Machine, plain: Plain) -> float:
    """s by which efforts would have to come later to be wrong by the size."""
    rate = np.diff(plain.effort) / plain.dt
    # A step is late by its whole height: what counts is how it goes otherwise.
    usual = float(np.sqrt(np.mean(np.clip(rate, *np.quantile(rate, [0.02, 0.98])) ** 2)))
    return min(max(size * machine.coulomb / max(usual, 1e-12), 0.3 * plain.dt), 8.0 * plain.dt)


def _delay(size: float, machine: Machine, plain: Plain, rng: np.random.Generator) -> Any:
    return {"delay": _late(size, machine, plain)}


def _lag(size: float, machine: Machine, plain: Plain, rng: np.random.Generator) -> Any:
    return {"lag": max(_late(size, machine, plain), 5e-4)}


def _dead(size: float, machine: Machine, plain: Plain, rng: np.random.Generator) -> Any:
    return {"dead": size * machine.coulomb}


def _largest(size: float, machine: Machine, plain: Plain, rng: np.random.Generator) -> Any:
    asked = np.abs(plain.effort)
    low, high = 0.0, float(asked.max())
    for _ in range(40):
        limit = 0.5 * (low + high)
        cut = float(np.sqrt(np.mean(np.maximum(asked - limit, 0.0) ** 2)))
        low, high = (limit, high) if cut > size * machine.coulomb else (low, limit)
    return {"largest": max(high, 1.1 * machine.coulomb)}


def _shaft(size: float, machine: Machine, plain: Plain, rng: np.random.Generator) -> Any:
    return _far_end(rng, 10.0 + 2.0 / size, 0.03)


def _gap(size: float, machine: Machine, plain: Plain, rng: np.random.Generator) -> Any:
    return _far_end(rng, 150.0, 0.15) | {"gap": 0.1 * size * max(plain.range, 1e-3)}


def _far_end(rng: np.random.Generator, hertz: float, damping: float) -> dict[str, float]:
    """Share, and stiffness and damping an inertia of 1."""
    share = float(rng.uniform(0.1, 0.5))
    omega = 2.0 * math.pi * hertz
    near = share * (1.0 - share)
    return {
        "shaft_share": share,
        "shaft_stiffness": near * omega**2,
        "shaft_damping": 2.0 * damping * near * omega,
    }


_PARTS: dict[str, Callable[..., dict[str, Any]]] = {
    "stribeck": _stribeck,
    "viscous_quadratic": _quadratic,
    "cogging": _cogging,
    "direction_asymmetry": _asymmetry,
    "torque_bias": _bias,
    "input_delay": _delay,
    "current_loop_lag": _lag,
    "drive_deadband": _dead,
    "drive_saturation": _largest,
    "shaft_compliance": _shaft,
    "backlash": _gap,
}
HIDDEN = tuple(_PARTS)
"""Effects that may be hidden, by the names that they have in the catalogue."""
MOVED_HIDDEN = tuple(
    name for name, part in _PARTS.items() if part in (_stribeck, _quadratic, _asymmetry, _bias)
)
"""What can be hidden in a machine that is moved."""


class Plain:
    """How the machine goes with nothing hidden: speed (rms), range, and the effort asked for."""

    def __init__(self, effort: FloatArray, velocity: FloatArray, travel: float, dt: float) -> None:
        self.effort = effort
        self.speed = float(np.sqrt(np.mean(velocity**2)))
        self.range = travel
        self.dt = dt


def with_effect(
    machine: Machine, name: str, size: float, plain: Plain, rng: np.random.Generator
) -> Machine:
    """The machine with an effect of about this size, share of its dry friction."""
    parts = _PARTS[name](size, machine, plain, rng)
    for scaled in ("shaft_stiffness", "shaft_damping"):
        if scaled in parts:
            parts[scaled] *= machine.inertia
    return replace(machine, effects=Effects(**parts))
