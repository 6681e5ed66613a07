"""Where a fit starts: what the plant states, and for the rest what the data say."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from ..catalogue import effects
from ..errors import NotEnoughData
from ..plant import Plant
from ..plant.parameter import Parameter
from ..plant.stated import Effect
from ..residual.weak_form import WeakForm
from .likeliest import likeliest
from .rows import start_guess
from .variables import records

__all__ = ["complete", "free_paths", "with_light_friction", "yielding_starts"]

LARGEST: Final = 0.999
"""Quantile of the input in a recording that counts as its greatest: single samples do not."""
OFF_NEUTRAL: Final = 0.05
"""Share of its typical size from which the gain of a named effect starts that states no number."""
REACHES: Final = tuple(10.0 ** (-6.0 + 0.25 * k) for k in range(18))
"""Pre-sliding reaches tried as shares of the range of motion, where no stiffness is stated."""
TRIED: Final = 4
"""Reaches from which a fit starts."""
SLIDING_SHARE: Final = 0.1
"""Share of the rms speed above which a machine slides for sure."""
ABOVE_COULOMB: Final = 1.1
"""Break-away over Coulomb friction to start from."""
SOFTER: Final = 0.27
"""Final over initial stiffness to start from, as of the catalogue's defaults."""


REFERRED: Final = ("rate_and_state",)
"""Laws whose Coulomb friction is that at a reference speed, which no data tell."""
LENGTH: Final = "rad"
"""Unit of what a law measures distances in, on a rotary machine."""
HARDENED: Final = 1.0
"""Creep under a held Coulomb friction to start from, in reaches."""
HELD: Final = 0.1
"""Share of the usual effort that friction takes where nothing says more."""
YIELDS_OR_BREAKS_AWAY: Final = frozenset({"breakaway", "final_stiffness", "initial_stiffness"})
"""What a law has whose contact may as well yield for ever."""
OUT_OF_REACH: Final = 2.0
"""Break-away of a contact that never comes to it, over the greatest effort."""
FLAT: Final = 0.1
"""Share of Coulomb friction by which such a contact stiffens over the whole range of motion."""


def complete(plant: Plant, forms: Sequence[WeakForm]) -> list[Plant]:
    """Plants with every core parameter stated, from the data where the file is silent.

    Several where a stiffness had to be guessed, the likeliest first: a fit may get caught from one
    of them and not from another.

    A regression of the measured effort on acceleration, direction, speed and a constant gives
    inertia, Coulomb and viscous friction; a stiffness comes from the pre-sliding reach that
    leaves the least residual.

    Raises
    ------
    NotEnoughData
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
    if plant.friction.law in REFERRED and "reference_velocity" not in stated:
        # Any speed would do; that of the data makes Coulomb friction what it is there.
        stated["reference_velocity"] = Parameter(_usual_speed(forms), fixed=True)
    silent = [name for name in core if name not in stated]
    for name in silent:
        low, high = core[name].bounds
        value = from_data.get(name, core[name].default)
        stated[name] = Parameter(float(np.clip(value, low, high)))
    if "breakaway" in stated and "coulomb" in stated:
        stated = _ordered(stated, silent)
    if "final_stiffness" in silent and "initial_stiffness" not in silent:
        softer = SOFTER * stated["initial_stiffness"].value
        stated["final_stiffness"] = Parameter(softer)
    whole = replace(
        plant,
        body=body,
        friction=replace(plant.friction, parameters=stated),
        effects=tuple(_begun(effect, plant, forms) for effect in plant.effects),
    )
    if "initial_stiffness" in silent:
        return _stiffness(whole, forms, coulomb, silent)
    lengths = [f"friction.{name}" for name in silent if core[name].unit == LENGTH]
    if lengths:
        # Lengths over which a law hardens or forgets: no bound but the range of motion is known.
        span = max(float(np.ptp(form.position)) for form in forms)
        tried = [dict.fromkeys(lengths, share * span) for share in REACHES]
        return _likeliest([whole.with_values(values) for values in tried], forms)
    return [whole]


def yielding_starts(
    plant: Plant, starts: Sequence[Plant], forms: Sequence[WeakForm]
) -> list[Plant]:
    """A start whose contact yields up to Coulomb friction instead of breaking away there.

    Break-away is a kink: from a contact that breaks away at every reversal no slope leads to one
    whose spring bends until it holds no more. What the file states stays.

    Parameters
    ----------
    plant : Plant
        As the file states it.
    starts : sequence of Plant
        What ``complete`` made of it.
    forms : sequence of WeakForm

    Returns
    -------
    list of Plant
        None of a law that has no such contact, where the file states how it breaks away or how
        stiff it is, and of a servo, whose effort nobody measured.
    """
    stated = plant.friction.parameters
    silent = starts[0].friction.parameters.keys() - stated.keys()
    if plant.servo or not silent >= YIELDS_OR_BREAKS_AWAY:
        return []
    span = max(float(np.ptp(form.position)) for form in forms)
    most = max(float(np.max(np.abs(form.measured_effort(plant)))) for form in forms)
    coulomb = _regression(plant, forms)[1]

    def clings(start: Plant) -> Plant:
        known = {name: each.value for name, each in start.friction.parameters.items()}
        bounds = records(start)
        reach = coulomb / known["initial_stiffness"]
        values = {
            "breakaway": OUT_OF_REACH * most,
            "final_stiffness": FLAT * coulomb / span,
            # From one reversal to the next the force goes twice as far as from rest.
            "decay_distance": 2.0 * reach,
            # Nothing else of it depends on speed.
            "damping": max(known.get("damping", 0.0), known.get("viscous", 0.0)),
            # What hardens within a reach has crept once and for all at the first turn, and no later
            # row tells of it: it begins to creep as fast, and goes on for as long as it is moved.
            "hardening_coefficient": HARDENED * span / coulomb**2,
            "creep_rate": known.get("creep_rate", 0.0) * reach / span,
        }
        return start.with_values(
            {
                f"friction.{name}": float(np.clip(value, *bounds[f"friction.{name}"].bounds))
                for name, value in values.items()
                if name in silent
            }
        )

    return _likeliest([clings(start) for start in starts], forms, 1)


def with_light_friction(plant: Plant, whole: Plant, forms: Sequence[WeakForm]) -> Plant:
    """A completed plant with dry and viscous friction of a tenth of the usual effort each.

    For machines whose effort is not measured: what a regression takes for their friction may be
    none at all. What the file states stays.

    Parameters
    ----------
    plant, whole : Plant
        As the file states it, and with what ``complete`` added.
    forms : sequence of WeakForm
    """
    effort = np.concatenate([form.measured_effort(whole) for form in forms])
    speed = np.concatenate([form.velocity for form in forms])
    dry = HELD * float(np.sqrt(np.mean(effort**2)))
    levels = {
        "coulomb": dry,
        "breakaway": ABOVE_COULOMB * dry,
        "viscous": dry / max(float(np.sqrt(np.mean(speed**2))), 1e-300),
    }
    stated, known = plant.friction.parameters, records(whole)
    return whole.with_values(
        {
            f"friction.{name}": float(np.clip(level, *known[f"friction.{name}"].bounds))
            for name, level in levels.items()
            if name in whole.friction.parameters and name not in stated
        }
    )


def _usual_speed(forms: Sequence[WeakForm]) -> float:
    """Median speed of sliding, to one digit."""
    speeds = np.abs(np.concatenate([form.velocity for form in forms]))
    usual = float(np.median(speeds[speeds > SLIDING_SHARE * float(np.sqrt(np.mean(speeds**2)))]))
    return float(f"{usual:.0e}")


def largest_command(form: WeakForm, plant: Plant) -> float:
    """Greatest command that the drive saw: input, or voltage of a servo."""
    if plant.servo:
        drive = form.own(plant).drive
        return float(drive["supply_v"] * drive.get("duty_limit", 1.0))
    return float(np.quantile(np.abs(form.input), LARGEST))


def _begun(effect: Effect, plant: Plant, forms: Sequence[WeakForm]) -> Effect:
    """An effect with its gains stated, a little off the neutral point, where its file is silent.

    At the neutral point itself no shape has a slope, nor has a limit that no command reaches or
    that nearly all exceed: one of a command begins within those of the data. Of an effect that
    states any number the rest stays as it is.
    """
    if effect.parameters:
        return effect
    record = next(each for each in effects() if each.name == effect.name)
    fitted = {shape.parameter for shape in record.shapes if shape.fitted}
    own = {
        p.name: Parameter(OFF_NEUTRAL * p.typical if p.name in record.gains else p.default)
        for p in record.parameters
        if p.name in record.gains or p.name in fitted
    }
    command = max(largest_command(form, plant) for form in forms)
    for shape in record.shapes:
        if shape.scale == "input" and shape.parameter in own and command > 0.0:
            own[shape.parameter] = Parameter(float(np.median(shape.grid)) * command)
    return replace(effect, parameters=own)


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
    # One scale for all: a recording of small loops slides nowhere, however fast it turns.
    scale = max(float(np.sqrt(np.mean(form.velocity**2))) for form in forms)
    if scale == 0.0:
        raise NotEnoughData("nothing moves in the recordings to fit; record a motion")
    for form in forms:
        speed = form.velocity
        # At rest and around it friction is whatever holds: rows that slide tell its level.
        sliding = np.abs(speed) > SLIDING_SHARE * scale
        columns = [
            form.acceleration,
            np.sign(speed),
            speed,
            np.ones_like(speed),
            form.late(plant),
        ]
        angle = form.mean(form.position[1:])
        if "gravity_amplitude" in plant.body:
            columns += [np.sin(angle), np.cos(angle)]
        blocks.append(np.column_stack(columns)[sliding])
        # What a payload needs is known.
        mass, weight = form.own(plant).payload
        zero = plant.body["gravity_zero_rad"].value if "gravity_zero_rad" in plant.body else 0.0
        known = mass * form.acceleration + weight * np.sin(angle - zero)
        efforts.append((form.measured_effort(plant) - known)[sliding])
    matrix, effort = np.vstack(blocks), np.concatenate(efforts)
    if np.ptp(matrix[:, 1]) == 0.0:
        # Moved in one direction alone: a constant would take half of the friction.
        matrix[:, 3] = 0.0
    scales = np.maximum(np.sqrt(np.mean(matrix**2, axis=0)), 1e-300)
    solved = np.linalg.lstsq(matrix / scales, effort, rcond=None)[0] / scales
    level = float(np.sqrt(np.mean(effort**2)))
    accelerating = float(np.sqrt(np.mean(matrix[:, 0] ** 2)))
    # A sign that no machine has means that the data do not tell: then a share of the effort.
    inertia = solved[0] if solved[0] > 0.0 else HELD * level / max(accelerating, 1e-300)
    coulomb = solved[1] if solved[1] > 0.0 else HELD * level
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


def _stiffness(
    plant: Plant, forms: Sequence[WeakForm], coulomb: float, silent: list[str]
) -> list[Plant]:
    """The plants with the pre-sliding reaches that leave the least residual."""
    span = max(float(np.ptp(form.position)) for form in forms)
    stated = plant.friction.parameters
    recorded = {path.removeprefix("friction."): each for path, each in records(plant).items()}

    def tried(reach: float) -> Plant:
        values = {"initial_stiffness": coulomb / reach}
        if "final_stiffness" in silent:
            values["final_stiffness"] = SOFTER * values["initial_stiffness"]
        elif "final_stiffness" in stated:
            least = stated["final_stiffness"].value / SOFTER
            values["initial_stiffness"] = max(least, values["initial_stiffness"])
        values |= {name: reach for name in silent if recorded[name].unit == LENGTH}
        if "hardening_coefficient" in silent:
            values["hardening_coefficient"] = HARDENED * reach / coulomb**2
        if "damping" in silent:
            # Lightly damped: a tenth of critical.
            inertia = plant.inertia
            values["damping"] = 0.2 * float(np.sqrt(inertia * values["initial_stiffness"]))
        bounds = {path: record.bounds for path, record in records(plant).items()}
        own = {f"friction.{name}": value for name, value in values.items()}
        return plant.with_values(
            {path: float(np.clip(value, *bounds[path])) for path, value in own.items()}
        )

    return _likeliest([tried(share * span) for share in REACHES], forms)


def _likeliest(
    plants: Sequence[Plant], forms: Sequence[WeakForm], number: int = TRIED
) -> list[Plant]:
    """Those that leave the least residual, the best first."""

    def left(plant: Plant, form: WeakForm) -> float:
        seen = form.for_plant(plant)
        return float(np.sum(seen.residual(plant, start_guess(plant, seen)) ** 2))

    return likeliest(plants, forms, left, number)
