"""Plants for python-control: the whole state of a machine as a vector, one step a sample."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from ._support import given
from ._support.arrays import FloatArray
from ._support.given import number
from .errors import InputError
from .motor import Motor
from .plant import Plant

__all__ = ["start", "system"]

OUTPUTS: Final = ("position", "velocity", "friction")
ROOM: Final = 64
"""Rows that a vector has for what a contact remembers: a ring-down nests some fifty."""


class _Vector:
    """How a state of a motor stands in a vector of fixed length.

    First position, velocity and friction, then every other number by its name. Of an array, such as
    the points at which a contact turned round, first the number of its rows and then room for them.
    """

    def __init__(self, motor: Motor, room: int) -> None:
        state = motor.state
        self._numbers = [*OUTPUTS, *(n for n, v in state.items() if _plain(v) and n not in OUTPUTS)]
        self._arrays = {
            name: (max(room, len(value)), *np.shape(value)[1:])
            for name, value in state.items()
            if not _plain(value)
        }
        self.names = list(self._numbers)
        for name, shape in self._arrays.items():
            places = np.ndindex(*shape)
            self.names += [f"{name}.rows", *(f"{name}{list(place)}" for place in places)]

    def pack(self, state: dict[str, Any]) -> FloatArray:
        """The vector of a state."""
        parts = [np.array([float(state[name]) for name in self._numbers])]
        for name, shape in self._arrays.items():
            rows = np.asarray(state[name], dtype=np.float64)
            if len(rows) > shape[0]:
                raise InputError(
                    f"stiction.control: {name} has {len(rows)} rows and the state vector room for "
                    f"{shape[0]}; give the system more with room={2 * len(rows)}"
                )
            held = np.zeros(shape)
            held[: len(rows)] = rows
            parts += [np.array([float(len(rows))]), held.ravel()]
        return np.concatenate(parts)

    def state(self, vector: FloatArray) -> dict[str, Any]:
        """The state that a vector stands for."""
        found: dict[str, Any] = dict(zip(self._numbers, vector.tolist(), strict=False))
        place = len(self._numbers)
        for name, shape in self._arrays.items():
            size = int(np.prod(shape))
            rows = round(float(vector[place]))
            if not 0 <= rows <= shape[0]:
                raise InputError(
                    f"stiction.control: {name}.rows = {vector[place]:g} is out of bounds: allowed "
                    f"is 0 to {shape[0]}; begin with stiction.control.start"
                )
            held = np.array(vector[place + 1 : place + 1 + size]).reshape(shape)
            found[name] = held[:rows]
            place += 1 + size
        return found


def system(plant: Plant, dt: float, *, room: int = ROOM) -> Any:
    """A plant as a discrete-time system of python-control.

    Its state is the whole state of the machine, what the contact remembers included, so that it
    goes on from any state of it, and each sample is one ``Motor.step``: ``input_output_response``
    gives the numbers of ``Motor.simulate`` to the bit, with every law and effect. Its outputs are
    those of the present state: row k + 1 of a response is row k of a trajectory.

    Parameters
    ----------
    plant : Plant
        Of a servo the input is its goal.
    dt : float
        Sample time, s.
    room : int, optional
        Rows that the state vector has for each thing that a contact remembers as a list.

    Returns
    -------
    control.NonlinearIOSystem
        Discrete, with inputs ``input`` (of the drive) and ``load`` (N·m or N), outputs
        ``position``, ``velocity`` and ``friction``, and a state for ``start``.

    Raises
    ------
    InputError
        A plant that is no motor, a sample time that is not above 0; python-control is missing.
    """
    control = _control()
    motor, vector, step = _parts(plant, dt, room)

    def update(_: float, state: FloatArray, inputs: FloatArray, __: Any) -> FloatArray:
        motor.state = vector.state(state)
        motor.step(float(inputs[0]), step, load=float(inputs[1]))
        return vector.pack(motor.state)

    def output(_: float, state: FloatArray, __: FloatArray, ___: Any) -> FloatArray:
        return np.array(state[: len(OUTPUTS)])

    return control.NonlinearIOSystem(
        update,
        output,
        inputs=["input", "load"],
        outputs=list(OUTPUTS),
        states=vector.names,
        dt=step,
        name=plant.friction.law,
    )


def start(
    plant: Plant, dt: float, *, position: float = 0.0, velocity: float = 0.0, room: int = ROOM
) -> FloatArray:
    """State vector of a machine whose contact was never moved, for a ``system`` of this plant.

    Parameters
    ----------
    plant, dt, room
        As for ``system``.
    position, velocity : float, optional
        rad and rad/s, or m and m/s.

    Returns
    -------
    numpy.ndarray, shape (states,)

    Raises
    ------
    InputError
        As for ``system`` and ``Motor.reset``.
    """
    motor, vector, _ = _parts(plant, dt, room)
    motor.reset(position, velocity)
    return vector.pack(motor.state)


def _parts(plant: Plant, dt: float, room: int) -> tuple[Motor, _Vector, float]:
    given.instance(plant, Plant, "stiction.control: plant", "a Plant")
    room = given.whole(room, "stiction.control: room", least=1)
    step = number(dt, "stiction.control: dt")
    if plant.prescribed_motion:
        raise InputError(
            f"{plant.source}: [drive] kind = 'prescribed_motion' has no input to simulate"
        )
    motor = plant.motor()
    # Inputs on their way through a delay are a list that is as long as the delay: full by then.
    probe = motor.copy()
    longest = {name: len(v) for name, v in motor.state.items() if not _plain(v)}
    for _ in range(room if longest else 1):
        probe.step(0.0, step)
    waiting = max((len(v) for v in probe.state.values() if not _plain(v)), default=0)
    return motor, _Vector(motor, max(room, waiting + 1)), step


def _plain(value: Any) -> bool:
    return np.ndim(value) == 0


def _control() -> Any:
    try:
        import control
    except ImportError:
        raise InputError(
            "stiction.control: python-control is missing; install it: pip install control"
        ) from None
    return control
