"""Where a fit starts: what the plant states, and for the rest what the data say."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from ..errors import InputError
from ..parameter import Parameter
from ..plant import Plant
from ..trajectory import FloatArray
from ..weak_form import WeakForm
from .variables import records

__all__ = ["complete", "free_paths"]

REACHES: Final = (3e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2)
"""Pre-sliding reaches tried as shares of the range of motion, where no stiffness is stated."""
ABOVE_COULOMB: Final = 1.1
"""Break-away over Coulomb friction to start from."""


def complete(plant: Plant, forms: Sequence[WeakForm]) -> Plant:
    """The plant with every core parameter stated, from the data where the file is silent.

    A regression of the measured effort on acceleration, direction, speed and a constant gives
    inertia, Coulomb and viscous friction; a stiffness comes from the pre-sliding reach that
    leaves the least residual.

    Raises
    ------
    InputError
        The data do not move, so they say nothing of the machine.
    """
    inertia, coulomb, viscous = _regression(plant, forms)
    body = dict(plant.body)
    if "inertia" not in body and not plant.prescribed_motion:
        body["inertia"] = Parameter(inertia)
    stated = dict(plant.friction.parameters)
    core = {
        path.removeprefix("friction."): record
        for path, record in records(plant).items()
        if path.startswith("friction.") and not record.optional
    }
    from_data = {
        "coulomb": coulomb,
        "breakaway": ABOVE_COULOMB * coulomb,
        "viscous": max(viscous, 0.0),
    }
    silent = [name for name in core if name not in stated]
    for name in silent:
        low, high = core[name].bounds
        value = from_data.get(name, core[name].default)
        stated[name] = Parameter(float(np.clip(value, low, high)))
    if "breakaway" in stated and "coulomb" in stated:
        stated = _ordered(stated, silent)
    whole = replace(plant, body=body, friction=replace(plant.friction, parameters=stated))
    if "initial_stiffness" in silent:
        whole = _stiffness(whole, forms, coulomb, silent)
    return whole


def free_paths(plant: Plant) -> list[str]:
    """Paths of the parameters that a fit varies: the stated ones that are not fixed."""
    paths = []
    for path, parameter in plant.parameters.items():
        frozen = parameter.fixed or not np.isfinite(parameter.value)
        if not frozen and not (path == "body.inertia" and plant.prescribed_motion):
            paths.append(path)
    return paths


def _regression(plant: Plant, forms: Sequence[WeakForm]) -> tuple[float, float, float]:
    """Inertia, Coulomb and viscous friction that fit the measured effort best."""
    blocks, efforts = [], []
    for form in forms:
        speed = form.velocity
        scale = float(np.sqrt(np.mean(speed**2)))
        if scale == 0.0:
            continue
        direction = np.tanh(speed / (0.02 * scale))
        columns = [form.acceleration, direction, speed, np.ones_like(speed)]
        if "gravity_amplitude" in plant.body:
            angle = form.mean(form.position[1:])
            columns += [np.sin(angle), np.cos(angle)]
        blocks.append(np.column_stack(columns))
        efforts.append(form.measured(plant))
    if not blocks:
        raise InputError("nothing moves in the recordings to fit; record a motion")
    matrix, effort = np.vstack(blocks), np.concatenate(efforts)
    solved = np.linalg.lstsq(matrix, effort, rcond=None)[0]
    level = float(np.sqrt(np.mean(effort**2)))
    accelerating = float(np.sqrt(np.mean(matrix[:, 0] ** 2)))
    # A sign that no machine has means that the data do not tell: then a share of the effort.
    inertia = solved[0] if solved[0] > 0.0 else 0.1 * level / max(accelerating, 1e-300)
    coulomb = solved[1] if solved[1] > 0.0 else 0.1 * level
    return float(inertia), float(max(coulomb, 1e-9)), float(solved[2])


def _ordered(stated: dict[str, Parameter], silent: list[str]) -> dict[str, Parameter]:
    """Moves the silent one of break-away and Coulomb friction so that they are in order."""
    level, limit = stated["coulomb"].value, stated["breakaway"].value
    if level < limit:
        return stated
    if "coulomb" in silent:
        return {**stated, "coulomb": Parameter(limit / ABOVE_COULOMB)}
    if "breakaway" in silent:
        return {**stated, "breakaway": Parameter(ABOVE_COULOMB * level)}
    return stated


def _stiffness(plant: Plant, forms: Sequence[WeakForm], coulomb: float, silent: list[str]) -> Plant:
    """The plant with the pre-sliding reach that leaves the least residual."""
    span = max(float(np.ptp(form.position)) for form in forms)

    def tried(reach: float) -> Plant:
        values = {"initial_stiffness": coulomb / reach}
        if "final_stiffness" in silent:
            values["final_stiffness"] = 0.27 * values["initial_stiffness"]
        if "decay_distance" in silent:
            values["decay_distance"] = reach
        if "hardening_coefficient" in silent:
            values["hardening_coefficient"] = 0.1 * reach / coulomb**2
        if "damping" in silent:
            # Lightly damped: a tenth of critical.
            inertia = plant.inertia
            values["damping"] = 0.2 * float(np.sqrt(inertia * values["initial_stiffness"]))
        own = {f"friction.{name}": value for name, value in values.items()}
        return plant.with_values(own)

    plants = [tried(share * span) for share in REACHES]
    return min(plants, key=lambda p: sum(_power(form.efforts(p)) for form in forms))


def _power(efforts: tuple[FloatArray, FloatArray]) -> float:
    power = float(np.sum((efforts[0] - efforts[1]) ** 2))
    return power if np.isfinite(power) else float("inf")
