"""Makes a plan: every experiment as large as the limits allow, checked by simulation."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from typing import Final

import numpy as np

from .._native import Motion
from .._support.arrays import FloatArray
from .._support.given import instance, names, number, whole
from .._support.progress import phase
from .._support.wording import commas, did_you_mean
from ..errors import InputError
from ..plant import Plant
from ..plant.assumed import unstated_levels
from ..plant.drive import GOALS
from ..recording.recording import SPLIT_ROLES
from .experiments import EXPERIMENTS, Experiment
from .limits import Limits, Sizes, sizes_of, with_inertia
from .moves import LONGEST_S, MOST_SAMPLES, TooLongError
from .result import Plan, Signal

__all__ = ["plan"]

RATES: Final = (50.0, 1e5)
SMALLER: Final = 0.75
TRIES: Final = 16
"""Shares by which a signal is made smaller until it stays within the limits."""
ROUNDED: Final = 1.02
"""Of a limit: rounding to samples is no fault."""
ROWS: Final = 512
"""Samples after each of which a simulation is looked at."""
_logger = logging.getLogger(__name__)


def plan(
    plant: Plant,
    *,
    position: float | None = None,
    speed: float | None = None,
    effort: float | None = None,
    rate: float = 1000.0,
    only: Sequence[str] = (),
    seed: int = 0,
) -> Plan:
    """Signals with which to record a machine, sized by its plant.

    Each experiment comes in three realisations, one for each role. References are for a machine
    under its controller, inputs for its drive alone. All stay 15 % below the limits: references by
    the effort that following them takes, inputs by simulation of the plant.

    Parameters
    ----------
    plant : Plant
        As far as it is known: what its file leaves out takes the catalogue's defaults, and an
        inertia that it does not state is assumed, which a note says.
    position, speed, effort : float, optional
        Limits, see `Limits`.
    rate : float
        Samples a second.
    only : sequence of str
        Names of experiments; all without it.
    seed : int
        Of everything random.

    Raises
    ------
    InputError
        No plant; a limit that is no number above 0, or within which the machine cannot be moved; a
        rate or seed out of bounds; an unknown experiment.
    """
    instance(plant, Plant, "plan: plant", "a Plant, as Plant.load returns it")
    rate = number(rate, "plan: rate")
    only = names(only, "plan: only")
    if not RATES[0] <= rate <= RATES[1]:
        raise InputError(
            f"rate = {rate:g} is out of bounds: allowed is {RATES[0]:g} to {RATES[1]:g} samples/s"
        )
    seed = whole(seed, "seed", least=0)
    known = [experiment.name for experiment in EXPERIMENTS]
    for name in only:
        if name not in known:
            raise InputError(
                f"only: there is no experiment '{name}'{did_you_mean(name, known)}; there are "
                f"{commas(known)}"
            )
    limits = Limits(position, speed, effort)
    stated = plant
    plant, assumed = with_inertia(plant, limits)
    sizes = sizes_of(plant, limits)
    signals, notes = [], [*([assumed] if assumed else []), *_guessed(plant)]
    if plant.servo or assumed:
        inputs = [e.name for e in EXPERIMENTS if e.kind == "input" and e.name in (only or known)]
        if inputs:
            why = (
                "a servo is told where to go, not what to push with"
                if plant.servo
                else "how far the drive alone moves a machine hangs on its inertia"
            )
            notes.append(f"{commas(inputs)} are left out: {why}")
    for experiment in EXPERIMENTS:
        if only and experiment.name not in only:
            continue
        if (plant.servo or assumed) and experiment.kind == "input":
            continue
        if experiment.name == "loops" and sizes.presliding == 0.0:
            notes.append(
                "loops are left out: the law of this plant does not yield before it slides"
            )
            continue
        phase(_logger, "planning %s", experiment.name)
        made = []
        why = "nothing of it stays within the limits"
        try:
            for k, role in enumerate(SPLIT_ROLES):
                drawn = [seed, k, known.index(experiment.name)]
                signal = _signal(plant, experiment, (sizes, limits), 1.0 / rate, role, drawn)
                if signal is None:
                    break
                made.append(signal)
        except TooLongError:
            why = f"it would take more than {LONGEST_S:g} s, or {MOST_SAMPLES:g} samples"
        if len(made) == len(SPLIT_ROLES):
            signals += made
        else:
            notes.append(f"{experiment.name} is left out: {why}")
    if not signals:
        raise InputError(f"{plant.source}: no signal stays within these limits; widen one of them")
    return Plan(stated, tuple(signals), tuple(notes), True, f"{len(signals)} signals")


def _guessed(plant: Plant) -> list[str]:
    """What the plant does not say of the sizes that signals are made by."""
    silent = unstated_levels(plant)
    if not silent:
        return []
    return [
        f"{plant.source} states no level of friction: signals are sized by the catalogue's "
        f"{commas(silent)}; fit the plant to any recording first"
    ]


def _signal(
    plant: Plant,
    experiment: Experiment,
    within: tuple[Sizes, Limits],
    dt: float,
    role: str,
    seed: Sequence[int],
) -> Signal | None:
    """The signal, made smaller until it stays within the limits; None where nothing is left."""
    sizes, limits = within
    share = 1.0
    for _ in range(TRIES):
        values = experiment.build(plant, sizes, dt, np.random.default_rng(seed), share)
        if plant.servo:
            path = _reached(plant, values, dt, sizes)
            effort = _needed(plant, path, dt)
        elif experiment.kind == "reference":
            path, effort = values, _needed(plant, values, dt)
        else:
            path, effort = _reached(plant, values / plant.gain, dt, sizes), values
        speeds = np.diff(path, prepend=path[0]) / dt
        greatest = {
            "distance": float(np.max(np.abs(path))),
            "speed": float(np.max(np.abs(speeds))),
            "effort": float(np.max(np.abs(effort))),
        }
        allowed = {"distance": sizes.reach, "speed": sizes.speed, "effort": sizes.effort}
        if plant.servo:
            # How hard it pushes is decided by the servo itself, and limited by its drive.
            greatest["distance"] = max(greatest["distance"], float(np.max(np.abs(values))))
            allowed["effort"] = np.inf if limits.effort is None else limits.effort
        if all(greatest[name] <= ROUNDED * allowed[name] for name in allowed):
            gain = 1.0 if experiment.kind == "reference" else plant.gain
            reference = "reference_rad" if plant.motion == "rotary" else "reference_m"
            if plant.servo:
                reference = GOALS[plant.motion]
            return Signal(
                experiment.name,
                experiment.kind,
                experiment.purpose,
                role,
                np.asarray(np.arange(len(values)) * dt, dtype=np.float64),
                values / gain,
                reference if experiment.kind == "reference" else _input_of(plant),
                path,
                greatest,
            )
        share *= SMALLER
    return None


def _input_of(plant: Plant) -> str:
    usual = "torque_nm" if plant.motion == "rotary" else "force_n"
    return str(plant.drive.get("input", usual))


def _needed(plant: Plant, path: FloatArray, dt: float) -> FloatArray:
    """Effort that following a path takes: inertia, friction, gravity; shape (n,)."""
    motor = plant.follower()
    motor.reset(float(path[0]), 0.0)
    _, ambient, friction, _ = motor.follow(Motion(path, np.zeros(len(path) - 1), dt), strict=False)
    bend = np.diff(path, 2, prepend=path[0], append=path[-1]) / dt**2
    needed = plant.inertia * bend
    needed[1:] += friction - ambient
    return np.asarray(needed)


def _reached(plant: Plant, given: FloatArray, dt: float, sizes: Sizes) -> FloatArray:
    """Position that the plant comes to with samples of its input, from rest at 0; shape (n,).

    It ends where the machine is beyond what is allowed, so that a signal that cannot be used costs
    no more than its beginning.
    """
    motor = plant.motor()
    motor.reset(0.0, 0.0)
    path = np.zeros(1)
    for begin in range(0, len(given) - 1, ROWS):
        run = motor.simulate(
            given[begin : min(begin + ROWS, len(given) - 1)], dt, outputs=["position"]
        )
        if not run.success:
            return np.full(len(given), np.inf)
        begun = path[-1:]
        path = np.concatenate([path, run.position])
        speeds = np.diff(run.position, prepend=begun) / dt
        if (
            np.max(np.abs(run.position)) > ROUNDED * sizes.reach
            or np.max(np.abs(speeds)) > ROUNDED * sizes.speed
        ):
            break
    return path
