"""A fitted plant that its own samples can simulate."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from operator import itemgetter
from typing import Final

import numpy as np

from ..errors import InputError
from ..plant import Plant
from ..plant.parameter import Parameter
from .forms import followable
from .rows import Nuisances, Rows

__all__ = ["bounded_plants", "follows"]

EASE: Final = 100.0
"""How much longer a sample might be: a hundredth of the parts that are allowed, as many of them as
a run has samples, are simulated in seconds whatever the law."""
STEP: Final = 10.0
"""Factor from one value that is tried to the next: of what leads nowhere only the size is known."""
MOST_STEPS: Final = 18
"""From the least inertia that a plant may have to that of a large machine tool."""


def follows(plant: Plant, rows: Sequence[Rows], *, ease: float = EASE) -> bool:
    """Whether a simulation of the plant follows samples like those of these rows with ease.

    ``ease`` is how much longer they might be: with 1 it follows them at all.
    """
    if plant.prescribed_motion or plant.inertia == 0.0:
        return True
    dt = max(each.form.dt for each in rows)
    try:
        # Into how many parts a sample is divided goes with its length.
        plant.motor().simulate(np.zeros(1), ease * dt)
    except InputError:
        return False
    return True


def bounded_plants(
    plant: Plant, paths: Sequence[str], rows: Sequence[Rows], nuisances: Nuisances
) -> list[Plant]:
    """Plants with one number bounded each, of one that is too stiff for its own samples.

    Along a measured motion an inertia or a slip distance that the data do not show may go to
    nothing, and what is handed over could not be simulated at the clock of the recordings. Each
    number in turn takes the nearest value with which it can, and those of a contact together that
    is too stiff and too damped (``followable``).

    Parameters
    ----------
    plant : Plant
        Fitted.
    paths : sequence of str
        That were varied.
    rows : sequence of Rows
        That it was fitted to.
    nuisances : Nuisances

    Returns
    -------
    list of Plant
        Those that leave least first, before anything else is fitted to that; empty where the plant
        is simulated with ease, or nothing helps.
    """
    if follows(plant, rows):
        return []

    def left(other: Plant) -> float:
        own = [each.weight * each.residual(other, nuisances)[each.mask] for each in rows]
        power = sum(float(one @ one) for one in own)
        return power if np.isfinite(power) else np.inf

    found: list[tuple[float, Plant]] = []
    for path in paths:
        own = plant.parameters[path]
        for factor in (STEP, 1.0 / STEP):
            near = _nearest(plant, path, factor, lambda other: follows(other, rows))
            if near is not None:
                low, high = (near, own.max) if near > own.value else (own.min, near)
                within = replace(own, value=near, min=low, max=high)
                other = _with_parameter(plant, path, within)
                found.append((left(other), other))
    softer = followable(plant, [each.form for each in rows])
    if follows(softer, rows):
        found.append((left(softer), softer))
    return [other for power, other in sorted(found, key=itemgetter(0)) if np.isfinite(power)]


def _nearest(plant: Plant, path: str, factor: float, fits: Callable[[Plant], bool]) -> float | None:
    """The first multiple of a parameter with which a plant fits; None within its bounds."""
    value = plant.parameters[path].value
    for _ in range(MOST_STEPS if value > 0.0 else 0):
        value *= factor
        try:
            if fits(plant.with_values({path: value})):
                return value
        except InputError:
            return None
    return None


def _with_parameter(plant: Plant, path: str, parameter: Parameter) -> Plant:
    part, _, name = path.partition(".")
    if part == "body":
        return replace(plant, body={**plant.body, name: parameter})
    if part == "friction":
        known = {**plant.friction.parameters, name: parameter}
        return replace(plant, friction=replace(plant.friction, parameters=known))
    # Bounds of effects are those of the grid that they come from.
    return plant.with_values({path: parameter.value})
