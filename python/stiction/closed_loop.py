"""Closed-loop replay: the plant under its controller, beside what was measured.

An open-loop simulation wanders off from the machine whatever it gets right: friction errors add up
in the position. Under the machine's own controller they show as what they cost, a tracking error.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from ._support.arrays import FloatArray
from ._support.wording import NO_POSITION
from .errors import InputError
from .recording.checks import without_failures, without_spikes
from .recording.motion import count_of, evenly, zero_order_hold
from .residual.effort import FreeRun, free_run, started, starting_velocity
from .residual.weak_form import Start

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .motor import Motor
    from .plant import Plant
    from .recording import Recording

__all__ = ["ClosedLoop", "Controller", "replay"]

TWO_SAMPLE_MEAN: Final = "backward_of_two_sample_mean"
INTEGRAL_S: Final = 1.0
"""Stretch at the start of a recording that tells what the integral held before."""
FAR: Final = 100.0
"""A simulated loop that is away by this many times the range of motion has run away."""

Act = Callable[[int, float, float], float]
"""Input of the drive, from the number of the sample, the reading and the measured velocity."""
Ahead = Callable[[FloatArray, float], FloatArray]
"""Input of each sample, shape (n,), from the reference, shape (n,), and the sample time."""
Fed = Callable[[float, float], float]
"""Input of a sample, from the reading at its start and the sample time."""


@dataclass(frozen=True)
class Controller:
    """A sampled controller: u = proportional·e + derivative·(w − v) + integral·Σe·dt.

    e is reference less reading, v the velocity as the rule has it, w the slope of the reference,
    or 0. Every kind of a plant file has this form.

    Attributes
    ----------
    proportional, derivative, integral : float
        Input of the drive per rad (m), per rad/s (m/s) and per rad·s (m·s).
    slope : bool
        Whether the slope of the reference acts on the velocity too.
    rule : {"backward", "backward_of_two_sample_mean", "measured"}
        How the controller comes by its velocity.
    filter_s : float
        Time constant of a first-order filter on that velocity, s; 0 for none.
    limit : float
        Greatest magnitude of u.
    """

    proportional: float
    derivative: float = 0.0
    integral: float = 0.0
    slope: bool = True
    rule: str = "backward"
    filter_s: float = 0.0
    limit: float = float("inf")

    @classmethod
    def of(cls, plant: Plant) -> Controller:
        """The controller of a plant.

        Raises
        ------
        InputError
            The plant states none.
        """
        stated = plant.controller
        if not stated:
            raise InputError(
                f"{plant.source}: [controller] is missing; state its kind and gains to simulate "
                "the loop"
            )
        common = {name: stated[name] for name in ("filter_s", "limit") if name in stated}
        rule = stated.get("derivative", "backward")
        if stated["kind"] == "position_velocity":
            kv = stated["kv"]
            return cls(kv * stated["kp"], kv, slope=False, rule=rule, **common)
        integral = stated["ki"] if stated["kind"] == "pid" else 0.0
        return cls(stated["kp"], stated.get("kd", 0.0), integral, rule=rule, **common)

    def acting(
        self,
        reference: FloatArray,
        dt: float,
        *,
        reading: float,
        velocity: float = 0.0,
        total: float = 0.0,
    ) -> Act:
        """A function to be called once for each sample, in their order.

        Parameters
        ----------
        reference : numpy.ndarray, shape (n,)
            rad or m.
        dt : float
            Sample time, s.
        reading, velocity : float
            At the first sample: the readings before it lie on a line of this slope.
        total : float
            What the sum of e·dt holds before the first sample.
        """
        goals: list[float] = reference.tolist()
        slopes: list[float] = self._slopes(reference, dt).tolist()
        proportional, derivative, integral = self.proportional, self.derivative, self.integral
        two, own, limit = self.rule == TWO_SAMPLE_MEAN, self.rule == "measured", self.limit
        span = 2.0 * dt if two else dt
        blend = dt / (self.filter_s + dt)
        past, last, filtered = reading - span * velocity, reading - dt * velocity, velocity

        def act(k: int, reading: float, speed: float) -> float:
            nonlocal past, last, filtered, total
            if not own:
                speed = (reading - past) / span
                past, last = (last if two else reading), reading
            filtered += blend * (speed - filtered)
            error = goals[k] - reading
            total += error * dt
            wanted = proportional * error + derivative * (slopes[k] - filtered) + integral * total
            return wanted if -limit <= wanted <= limit else min(max(wanted, -limit), limit)

        return act

    def _slopes(self, reference: FloatArray, dt: float) -> FloatArray:
        """Slope of the reference by the rule, continued before the first sample; shape (n,)."""
        slopes = np.zeros_like(reference)
        if self.slope and len(reference) > 1:
            slopes[1:] = np.diff(reference) / dt
            slopes[0] = slopes[1]
            if self.rule == TWO_SAMPLE_MEAN:
                slopes[1:] = 0.5 * (slopes[1:] + slopes[:-1])
        return slopes


@dataclass(frozen=True)
class ClosedLoop:
    """A recording beside the plant that simulates it under its controller, started once.

    Attributes
    ----------
    time : numpy.ndarray, shape (n,)
        s. Evenly spaced from the start on; of a servo the recorded stamps after the first row.
    reference, measured, simulated : numpy.ndarray, shape (n,)
        Positions, rad or m.
    input : numpy.ndarray, shape (n,)
        What the simulated controller commands, in units of the drive's input.
    unit : str
        Of the positions.
    controller_error : float or None
        How far the controller, fed with the measured motion, misses the recorded input: 2-norm of
        the difference over that of the input. Beyond some per cent the stated controller is not
        the one that was recorded. None where the input, or the measured velocity that the
        controller needs, was not recorded.
    """

    time: FloatArray
    reference: FloatArray
    measured: FloatArray
    simulated: FloatArray
    input: FloatArray
    unit: str
    controller_error: float | None

    @property
    def success(self) -> bool:
        """Whether all positions and inputs are finite."""
        shown = (self.reference, self.measured, self.simulated, self.input)
        return all(bool(np.isfinite(values).all()) for values in shown)

    @property
    def message(self) -> str:
        """What came out, in words."""
        if not self.success:
            return "some values of the loop are not finite; check units and gains"
        return (
            f"position error {self.rms:.4g} {self.unit} rms, greatest {self.greatest:.4g} "
            f"{self.unit}"
        )

    @property
    def error(self) -> FloatArray:
        """Measured less simulated position, shape (n,)."""
        return self.measured - self.simulated

    @property
    def rms(self) -> float:
        """Root mean square of ``error``."""
        return float(np.sqrt(np.mean(self.error**2)))

    @property
    def greatest(self) -> float:
        """Greatest magnitude of ``error``."""
        return float(np.max(np.abs(self.error)))

    def __repr__(self) -> str:
        return (
            f"ClosedLoop({self.rms:.4g} {self.unit} rms, greatest {self.greatest:.4g} {self.unit})"
        )

    def _repr_html_(self) -> str:
        return f"<p>{self!r}</p>"

    def to_dict(self) -> dict[str, Any]:
        """The numbers, for JSON."""
        return {
            "rms": self.rms,
            "greatest": self.greatest,
            "unit": self.unit,
            "controller_error": self.controller_error,
        }

    def plot(self) -> Figure:
        """A figure of both positions less the reference, and of their difference."""
        from . import plot

        return plot.overlay(
            self.time,
            self.measured - self.reference,
            self.simulated - self.reference,
            unit=self.unit,
            quantity="position − reference",
        )


def replay(
    plant: Plant,
    recording: Recording,
    start: Start = None,
    *,
    clock: float = 0.0,
    path: float = 0.0,
    ahead: Ahead | None = None,
    fed: Fed | None = None,
) -> ClosedLoop:
    """Simulate the loop of controller, drive and machine from the measured start.

    The controller reads the simulated position, rounded to counts where the plant states a sensor,
    and its input is held until the next sample. The starting velocity is that of ``free_run``. What
    the integral holds at the start is told by the recorded input.

    Parameters
    ----------
    plant : Plant
        With a controller, or with a servo, whose input is the reference.
    recording : Recording
        With position and reference.
    start : dict, optional
        Friction state at the first row (see ``LawRecord.start``); without it the friction was
        never moved.
    clock, path : float, optional
        Session clock in s and path travelled in rad or m at the first row, as for ``free_run``.
    ahead : callable, optional
        What is added to the controller's input: of the reference, shape (n,), and the sample time,
        the input of each sample, shape (n,). A feed-forward is one.
    fed : callable, optional
        What is added to it besides: of the reading at the start of a sample, rad or m, and the
        sample time, the input of that sample; called once for each, in their order. A compensation
        by the measured motion is one.

    Returns
    -------
    ClosedLoop

    Raises
    ------
    InputError
        No controller, no reference, no position; a plant of prescribed motion or without inertia;
        a loop that runs away.
    """
    (recording,) = without_failures([recording])
    if plant.servo:
        if ahead is not None or fed is not None:
            raise InputError(
                f"{plant.source}: the drive of a servo takes a goal and nothing beside it"
            )
        return _servo(free_run(plant, recording, start, clock=clock, path=path), recording)
    source = str(recording.path) if recording.path is not None else "recording"
    controller = Controller.of(plant)
    plant = plant.under(recording.settings)
    if plant.prescribed_motion:
        raise InputError(
            f"{plant.source}: [drive] kind = 'prescribed_motion' has no input that a controller "
            "could act on; drop [controller], or state a drive with an input"
        )
    if "reference" not in recording.channels:
        raise InputError(
            f"{source}: there is no reference that the controller could follow; name its column "
            "under [columns] as reference"
        )
    if recording.position is None:
        raise InputError(f"{source}: {NO_POSITION}")
    stamps, time, dt = evenly(recording.time)
    measured = np.interp(time, stamps, without_spikes(recording.position))
    reference = zero_order_hold(time, stamps, recording.channels["reference"])
    velocity = starting_velocity(time, measured, plant.count or count_of(measured))
    begin = {"reading": float(measured[0]), "velocity": velocity}
    needed = _along(controller, recording, reference, measured, dt, begin)
    missed, total = (None, 0.0) if needed is None else _compared(controller, plant, *needed, dt)
    load = recording.channels.get("load")
    loads = [0.0] * len(time) if load is None else zero_order_hold(time, stamps, load).tolist()
    warmth = recording.channels.get("temperature")
    warmths = (
        [None] * len(time) if warmth is None else zero_order_hold(time, stamps, warmth).tolist()
    )
    on = recording.channels.get("enabled")
    switched = (
        [True] * len(time) if on is None else (zero_order_hold(time, stamps, on) != 0.0).tolist()
    )
    motor = started(plant, begin["reading"], begin["velocity"], start, clock=clock, path=path)
    act = controller.acting(reference, dt, **begin, total=total)
    if ahead is not None:
        act = _beside(act, ahead(reference, dt).tolist(), controller.limit)
    if fed is not None:
        act = _after(act, fed, dt, controller.limit)
    bounds = _bounds(reference, measured)
    try:
        simulated, inputs = _simulated(
            motor, act, begin, dt, (loads, warmths, switched), plant.count, bounds
        )
    except InputError as error:
        raise InputError(f"{source}: the loop cannot be simulated: {error}") from None
    if len(simulated) < len(time):
        raise InputError(
            f"{source}: the simulated loop runs away {dt * len(simulated):.3g} s after its start; "
            f"check signs and sizes of the gains in [controller] and [drive] of {plant.source}"
        )
    return ClosedLoop(
        time,
        reference,
        measured,
        np.array(simulated),
        np.array(inputs),
        plant.position_unit,
        missed,
    )


def _servo(run: FreeRun, recording: Recording) -> ClosedLoop:
    """The loop of a servo, which its own drive closes."""
    assert recording.input is not None
    goal = recording.input[:-1]
    return ClosedLoop(run.time, goal, run.measured, run.simulated, goal, run.unit, None)


def _simulated(
    motor: Motor,
    act: Act,
    begin: dict[str, float],
    dt: float,
    around: tuple[list[float], list[float | None], list[bool]],
    count: float,
    bounds: tuple[float, float],
) -> tuple[list[float], list[float]]:
    """Positions and inputs at the samples, as far as the loop stays within the bounds."""
    low, high = bounds
    step, x, v = motor.step, begin["reading"], begin["velocity"]
    positions, inputs = [], []
    for k, (load, warmth, on) in enumerate(zip(*around, strict=True)):
        positions.append(x)
        u = act(k, round(x / count) * count if count else x, v)
        inputs.append(u)
        x, v = step(u, dt, load=load, temperature=warmth, enabled=on)
        if not low < x < high:
            break
    return positions, inputs


def _beside(act: Act, own: list[float], limit: float) -> Act:
    """A controller with an input added to its own, within its limit."""

    def both(k: int, reading: float, speed: float) -> float:
        return min(max(act(k, reading, speed) + own[k], -limit), limit)

    return both


def _after(act: Act, fed: Fed, dt: float, limit: float) -> Act:
    """A controller with an input added that goes by the reading, within its limit."""

    def both(k: int, reading: float, speed: float) -> float:
        return min(max(act(k, reading, speed) + fed(reading, dt), -limit), limit)

    return both


def _bounds(reference: FloatArray, measured: FloatArray) -> tuple[float, float]:
    """Beyond these a simulated position has run away."""
    low, high = min(reference.min(), measured.min()), max(reference.max(), measured.max())
    span = FAR * float(high - low or 1.0)
    return float(low) - span, float(high) + span


def _along(
    controller: Controller,
    recording: Recording,
    reference: FloatArray,
    measured: FloatArray,
    dt: float,
    begin: dict[str, float],
) -> tuple[FloatArray, FloatArray] | None:
    """Recorded input, and that of the controller along the measured motion; shape (n,) each."""
    speeds = recording.channels.get("velocity")
    if recording.input is None or (controller.rule == "measured" and speeds is None):
        return None
    stamps, time, _ = evenly(recording.time)
    moving = np.zeros_like(measured)
    if speeds is not None:
        moving = np.interp(time, stamps, speeds)
    act = controller.acting(reference, dt, **begin)
    pairs = zip(measured.tolist(), moving.tolist(), strict=True)
    own = [act(k, reading, speed) for k, (reading, speed) in enumerate(pairs)]
    return zero_order_hold(time, stamps, recording.input), np.array(own)


def _compared(
    controller: Controller, plant: Plant, recorded: FloatArray, own: FloatArray, dt: float
) -> tuple[float | None, float]:
    """Relative error of the controller's own input, and what its sum held before the start."""
    total = 0.0
    if controller.integral:
        first = max(1, round(INTEGRAL_S / dt))
        before = float(np.median((recorded - own)[:first]))
        own = own + before
        total = before / controller.integral
    limit = min(controller.limit, float(plant.drive.get("limit", np.inf)))
    recorded, own = np.clip(recorded, -limit, limit), np.clip(own, -limit, limit)
    with np.errstate(all="ignore"):  # absurd gains lead beyond the floats
        scale, left = float(np.linalg.norm(recorded)), float(np.linalg.norm(recorded - own))
    return left / scale if scale > 0.0 else None, total
