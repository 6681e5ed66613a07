"""Simulations and their exact derivatives, backwards: what frameworks of gradients ask for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

import numpy as np

from ._native import FrictionModel, Motion
from ._support import given
from ._support.arrays import FloatArray
from ._support.frozen import path_of
from ._support.given import number
from ._support.keys import choice
from .catalogue import laws
from .errors import InputError
from .motor import Motor
from .plant import Plant
from .residual.effort import NO_TIME

__all__ = ["Simulation", "over_batch"]

KEYWORDS: Final = {
    "drive.gain": "torque_constant",
    "body.inertia": "inertia",
    "body.gravity_amplitude": "gravity_amplitude",
    "body.gravity_zero_rad": "gravity_zero",
    "body.weight_n": "weight",
}
"""What a motor is made with, by the path of its parameter."""
BODY: Final = ("position", "velocity")
"""What a run starts from beside what its contact brings along."""


class Simulation:
    """A motor, the parameters by which it is differentiated, and its sample time.

    What a plant leaves open and follows one of these by default moves with it, as it does where
    the plant states another value. Of a motor every other parameter stays, as in an ``Ensemble``.
    Each run starts from the state of the motor.

    Parameters
    ----------
    machine : Plant or Motor
    parameters : sequence of str
        Paths, or bare last words where they are unique.
    dt : float
        s.
    start : sequence of str, optional
        What a run starts from in place of the state of the motor: "position", "velocity", start
        values of the law. Where one of the law is among them, those that are not are 0.

    Attributes
    ----------
    paths : tuple of str
        Of the parameters, and then ``start.position`` and so on: by these it is differentiated.

    Raises
    ------
    InputError
        No machine, an unknown path, one twice, a plant that is no motor; a law that has no such
        start value.
    """

    def __init__(
        self,
        machine: Plant | Motor,
        parameters: Sequence[str],
        dt: float,
        start: Sequence[str] = (),
    ) -> None:
        given.instance(machine, Plant | Motor, "simulate: machine", "a Plant or a Motor")
        plant = machine if isinstance(machine, Plant) else None
        self._motor = machine.motor() if isinstance(machine, Plant) else machine.copy()
        self._dt = number(dt, "simulate: dt")
        names = given.names(parameters, "simulate: parameters")
        known = self._motor.parameters
        self._own = tuple(path_of(name, known, "simulate: parameters: ") for name in names)
        if len(set(self._own)) < len(self._own):
            raise InputError("simulate: parameters: one is named twice; drop one of its names")
        self._following = _following(plant, self._own)
        law = laws()[self._motor.friction_settings()[0]]
        there = (*BODY, *(each.name for each in law.start))
        self._start = tuple(choice(name, there, "simulate: start") for name in start)
        self.paths = (*self._own, *(f"start.{name}" for name in self._start))

    def run(
        self, values: FloatArray, current: FloatArray, load: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Position and velocity after each sample, as ``Motor.simulate`` has them.

        Parameters
        ----------
        values : numpy.ndarray, shape (paths,)
            SI; of the parameters, and then of the start.
        current, load : numpy.ndarray, shape (n,)

        Returns
        -------
        (numpy.ndarray, numpy.ndarray), shape (n,) each
        """
        found = self._with(values).simulate(
            current, self._dt, load=load, outputs=["position", "velocity"]
        )
        return found.position, found.velocity

    def backwards(
        self,
        by_input: bool,
        values: FloatArray,
        current: FloatArray,
        load: FloatArray,
        position: FloatArray,
        velocity: FloatArray,
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Derivatives of Σ position·x + velocity·v by parameters and start, input and load.

        Parameters
        ----------
        by_input : bool
            False where those by input and load are asked for by nobody: they are 0 then.
        values, current, load, position, velocity
            As for ``by_parameters``.

        Raises
        ------
        InputError
            As for ``Motor.gradient``.
        """
        of_values = self.by_parameters(values, current, load, position, velocity)
        if not by_input:
            return of_values, np.zeros_like(current), np.zeros_like(load)
        motor = self._with(values)
        weights = (current, self._dt, position, velocity)
        of_input = motor.gradient(*weights, load=load)
        return of_values, of_input, motor.gradient(*weights, load=load, by="load")

    def by_parameters(
        self,
        values: FloatArray,
        current: FloatArray,
        load: FloatArray,
        position: FloatArray,
        velocity: FloatArray,
    ) -> FloatArray:
        """Derivatives of Σ position·x + velocity·v by the parameters and by the start.

        Parameters
        ----------
        values, current, load
            As for ``run``.
        position, velocity : numpy.ndarray, shape (n,)
            Weights of what came out.

        Returns
        -------
        numpy.ndarray, shape (paths,)
        """
        if not self.paths:
            return np.zeros(0)
        every = [*self.paths, *(path for path, _, _ in self._following)]
        moved, turned = self._with(values).sensitivity(
            current, self._dt, every, load=load, start=self._contact(self._begun(values))
        )
        each = moved @ position + turned @ velocity
        found: FloatArray = each[: len(self.paths)]
        for own, (_, place, factor) in zip(each[len(self.paths) :], self._following, strict=True):
            found[place] += factor * own
        return found

    def _with(self, values: FloatArray) -> Motor:
        """The motor with these values, in its state."""
        settings = self._motor.settings()
        law, keywords = self._motor.friction_settings()
        effects = {name: dict(each) for name, each in settings["effects"].items()}
        numbers = np.asarray(values, dtype=np.float64).tolist()
        given_values = dict(zip(self._own, numbers, strict=False))
        for path, place, factor in self._following:
            given_values[path] = factor * numbers[place]
        for path, value in given_values.items():
            part, _, name = path.partition(".")
            if part == "friction":
                keywords = {**keywords, name: value}
            elif part == "effects":
                effect, _, own = name.partition(".")
                effects[effect][own] = value
            else:
                settings[KEYWORDS[path]] = value
        friction = FrictionModel(law, **keywords)
        motor = Motor(friction=friction, **{**settings, "effects": effects})
        state = self._motor.state
        if motor.parameters != self._motor.parameters:
            # What acts where it stands, efforts over the place among it, goes with the parameters.
            motor.reset(
                state["position"], state["velocity"], time=state["time"], path=state["path"]
            )
            state["ambient"] = motor.state["ambient"]
        motor.state = state
        begun = self._begun(values)
        if begun:
            self._begin(motor, begun)
        return motor

    def _begun(self, values: FloatArray) -> dict[str, float]:
        """Values of the start, by name."""
        numbers = np.asarray(values, dtype=np.float64).tolist()
        return dict(zip(self._start, numbers[len(self._own) :], strict=True))

    @staticmethod
    def _contact(begun: Mapping[str, float]) -> dict[str, float] | None:
        """What the contact brings along; None where it keeps its own state."""
        return {name: value for name, value in begun.items() if name not in BODY} or None

    def _begin(self, motor: Motor, begun: Mapping[str, float]) -> None:
        """Puts a motor where a run starts, its second mass with it; all else stays as it is."""
        state = motor.state
        clock = {"time": state["time"], "path": state["path"]}
        motor.reset(state["position"], state["velocity"], **clock)
        ambient = motor.state["ambient"]
        position, velocity = (begun.get(name, state[name]) for name in BODY)
        motor.reset(position, velocity, **clock)
        moved = {
            "position": position,
            "velocity": velocity,
            "second_position": state["second_position"] + (position - state["position"]),
            "second_velocity": state["second_velocity"] + (velocity - state["velocity"]),
            "ambient": state["ambient"] + (motor.state["ambient"] - ambient),
        }
        contact = self._contact(begun)
        if contact is not None:
            still = Motion([position] * 2, [0.0], NO_TIME)
            motor.follow(still, start=contact, strict=False)
            moved |= motor.friction_state()
        motor.state = {**state, **moved}


def _following(plant: Plant | None, paths: Sequence[str]) -> list[tuple[str, int, float]]:
    """What a plant leaves open and one of its named parameters moves: path, place, factor."""
    if plant is None:
        return []
    open_to = {f"friction.{r.name}": r.follows for r in plant.friction.record.parameters}
    return [
        (path, paths.index(f"friction.{follows[0]}"), follows[1])
        for path, follows in open_to.items()
        if follows is not None
        and path not in paths
        and path.partition(".")[2] not in plant.friction.parameters
        and f"friction.{follows[0]}" in paths
    ]


def over_batch(
    work: Callable[..., tuple[FloatArray, ...]], outputs: int, *arrays: Any
) -> tuple[FloatArray, ...]:
    """Work on one row after the other, whatever axes stand before the last.

    Parameters
    ----------
    work : callable
        Of one row of each array.
    outputs : int
        How many rows it returns.
    arrays : array_like, shape (..., n)

    Returns
    -------
    tuple of numpy.ndarray, shape (..., m)
    """
    rows = [np.asarray(each, dtype=np.float64) for each in arrays]
    before = np.broadcast_shapes(*(each.shape[:-1] for each in rows))
    # Counted, for of rows of no length nobody can tell how many there are.
    number = int(np.prod(before, dtype=np.int64))
    flat = [np.broadcast_to(r, (*before, r.shape[-1])).reshape(number, r.shape[-1]) for r in rows]
    found = [work(*(np.ascontiguousarray(each[k]) for each in flat)) for k in range(number)]
    return tuple(np.stack([each[k] for each in found]).reshape(*before, -1) for k in range(outputs))
