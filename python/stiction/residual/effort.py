"""What a simulation gets wrong: the effort residual along the measured motion, and the free run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from .._native import Motion
from .._support.arrays import FloatArray
from .._support.given import instance, number
from .._support.keywords import explain_keywords
from .._support.wording import NO_POSITION
from ..errors import InputError
from ..recording.checks import without_failures, without_spikes
from ..recording.motion import count_of
from ..trajectory import Trajectory
from .weak_form import Start, WeakForm

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..motor import Motor
    from ..plant import Plant
    from ..recording import Recording

__all__ = [
    "EffortResidual",
    "FreeRun",
    "effort_residual",
    "free_run",
    "input_run",
    "started",
    "starting_velocity",
]

STARTING_S: Final = 0.010
"""Stretch at the start of a recording that tells the starting velocity."""
NO_TIME: Final = 1e-9
"""Duration of the motionless sample that puts friction into its start state, s."""


@dataclass(frozen=True)
class EffortResidual:
    """Measured effort minus what the model needs for the measured motion.

    Both went through the same kernel: residual = K∗(drive + load + gravity + added efforts) −
    J·K''∗x − K∗F, with friction F driven by the measured position.

    Attributes
    ----------
    time : numpy.ndarray, shape (n,)
        Centre of the kernel, s.
    effort, model, residual : numpy.ndarray, shape (n,)
        N·m or N.
    support : float
        Width of the kernel in s.
    unit : str
    """

    time: FloatArray
    effort: FloatArray
    model: FloatArray
    support: float
    unit: str

    @property
    def success(self) -> bool:
        """Whether both efforts are finite."""
        return bool(np.isfinite(self.effort).all() and np.isfinite(self.model).all())

    @property
    def message(self) -> str:
        """What came out, in words."""
        if not self.success:
            return "some efforts are not finite; check units, and cells beyond what is possible"
        if self.relative == float("inf"):
            return f"effort error {self.rms:.4g} {self.unit} rms; the measured effort is 0"
        return (
            f"effort error {100 * self.relative:.3f} % of the measured effort, "
            f"{self.rms:.4g} {self.unit} rms"
        )

    @property
    def residual(self) -> FloatArray:
        """Measured minus model."""
        return self.effort - self.model

    @property
    def rms(self) -> float:
        """Root mean square of the residual."""
        return float(np.sqrt(np.mean(self.residual**2)))

    @property
    def relative(self) -> float:
        """2-norm of the residual over that of the measured effort; inf where that is 0."""
        scale = float(np.linalg.norm(self.effort))
        return float(np.linalg.norm(self.residual)) / scale if scale > 0.0 else float("inf")

    def __repr__(self) -> str:
        share = f"{100 * self.relative:.3f} % of the measured effort, "
        share = share if np.isfinite(self.relative) else ""
        return (
            f"EffortResidual({share}{self.rms:.4g} {self.unit} rms, "
            f"kernel {1e3 * self.support:.0f} ms)"
        )

    def _repr_html_(self) -> str:
        return f"<p>{self!r}</p>"

    def to_dict(self) -> dict[str, Any]:
        """The numbers, for JSON; ``relative`` is None where the measured effort is 0."""
        return {
            "relative": self.relative if np.isfinite(self.relative) else None,
            "rms": self.rms,
            "unit": self.unit,
            "kernel_support_s": self.support,
        }

    def plot(self) -> Figure:
        """A figure of both efforts and of the residual."""
        from .. import plot

        return plot.residual(self.time, self.effort, self.model, unit=self.unit)


@dataclass(frozen=True)
class FreeRun:
    """The simulation started once and left alone, beside the measured motion.

    Attributes
    ----------
    time : numpy.ndarray, shape (n,)
        Stamps of the recording from the second row on, s.
    measured, simulated : numpy.ndarray, shape (n,)
        Position, rad or m.
    trajectory : Trajectory
    unit : str
    """

    time: FloatArray
    measured: FloatArray
    simulated: FloatArray
    trajectory: Trajectory
    unit: str

    @property
    def success(self) -> bool:
        """Whether the simulation stayed finite."""
        return self.trajectory.success and bool(np.isfinite(self.measured).all())

    @property
    def message(self) -> str:
        """What came out, in words."""
        if not self.trajectory.success:
            return self.trajectory.message
        if not self.success:
            return "some measured positions are not finite; leave these rows out"
        return (
            f"position error {self.rms:.4g} {self.unit} rms, greatest {self.greatest:.4g} "
            f"{self.unit}"
        )

    @property
    def rms(self) -> float:
        """Root mean square of measured minus simulated position."""
        return float(np.sqrt(np.mean((self.measured - self.simulated) ** 2)))

    @property
    def mean_absolute(self) -> float:
        """Mean magnitude of measured minus simulated position."""
        return float(np.mean(np.abs(self.measured - self.simulated)))

    @property
    def greatest(self) -> float:
        """Greatest magnitude of measured minus simulated position."""
        return float(np.max(np.abs(self.measured - self.simulated)))

    def __repr__(self) -> str:
        return f"FreeRun({self.rms:.4g} {self.unit} rms, greatest {self.greatest:.4g} {self.unit})"

    def _repr_html_(self) -> str:
        return f"<p>{self!r}</p>"

    def to_dict(self) -> dict[str, Any]:
        """The numbers, for JSON."""
        return {
            "rms": self.rms,
            "mean_absolute": self.mean_absolute,
            "greatest": self.greatest,
            "unit": self.unit,
        }

    def plot(self) -> Figure:
        """A figure of both motions and of their difference."""
        from .. import plot

        return plot.overlay(self.time, self.measured, self.simulated, unit=self.unit)


@explain_keywords
def effort_residual(
    plant: Plant,
    recording: Recording,
    start: Start = None,
    *,
    support: float | None = None,
    clock: float = 0.0,
    path: float = 0.0,
) -> EffortResidual:
    """The effort that the model leaves unexplained along the measured motion.

    Parameters
    ----------
    plant : Plant
    recording : Recording
        With position, and input or (for prescribed motion) effort.
    support : float, optional
        Width of the kernel in s. Without it the narrowest one from 30 ms on that keeps the
        position noise in the inertia term below 2 % of the effort.
    start, clock, path
        As for ``free_run``.

    Raises
    ------
    InputError
        No position, no input, or too short for the kernel; an argument that cannot be used.
    """
    _check(plant, recording, start, clock, path)
    if support is not None and not 0.0 < number(support, "support") < np.inf:
        raise InputError(f"support = {support:g}; give the width of the kernel in s, above 0")
    (recording,) = without_failures([recording])
    form = WeakForm(plant, recording, support=support)
    form.clock, form.path = clock, path
    measured, model = form.efforts(plant, start)
    return EffortResidual(form.time, measured, model, form.kernel.support, form.effort_unit)


@explain_keywords
def free_run(
    plant: Plant,
    recording: Recording,
    start: Start = None,
    *,
    clock: float = 0.0,
    path: float = 0.0,
) -> FreeRun:
    """Simulate the recorded input from the measured start and compare the motion.

    The starting velocity is the slope of a parabola through the first rows. The input of a servo is
    its goal: then the loop is closed by the servo itself. Spikes of a single sample in what was
    measured are replaced by the mean of their neighbours, as in fits.

    Parameters
    ----------
    plant : Plant
    recording : Recording
        With position and input.
    start : dict, optional
        Friction state at the first row (see ``LawRecord.start``); without it the friction was
        never moved.
    clock, path : float, optional
        Session clock in s and path travelled in rad or m at the first row, of a machine that has
        been running; without them it is cold and new.

    Raises
    ------
    InputError
        No position or no input; a plant without inertia or of prescribed motion; an argument that
        cannot be used.
    """
    _check(plant, recording, start, clock, path)
    position = _position(recording)
    (recording,) = without_failures([recording])
    # A reading that failed for a sample is no motion that a simulation could miss.
    position = without_spikes(position)
    plant = _driven(plant, recording)
    velocity = starting_velocity(recording.time, position, plant.count or count_of(position))
    motor = started(plant, float(position[0]), velocity, start, clock=clock, path=path)
    trajectory = _simulated(motor, recording)
    return FreeRun(
        recording.time[1:],
        position[1:],
        trajectory.position,
        trajectory,
        plant.position_unit,
    )


def input_run(plant: Plant, recording: Recording) -> Trajectory:
    """Simulate the recorded input from rest, of a recording whose motion nobody measured.

    What acted beside the input, and what was set for the recording, counts as in ``free_run``.

    Parameters
    ----------
    plant : Plant
    recording : Recording
        With input.

    Returns
    -------
    Trajectory
        Row k is the state at the stamp of row k + 1.

    Raises
    ------
    InputError
        No input; a plant without inertia or of prescribed motion.
    """
    _check(plant, recording)
    return _simulated(_driven(plant, recording).motor(), recording)


def _check(
    plant: Plant, recording: Recording, start: Start = None, clock: float = 0.0, path: float = 0.0
) -> None:
    """Refuse what is none of these."""
    # As late as it is needed: both are made of what this room stands beside.
    from ..plant import Plant
    from ..recording import Recording

    instance(plant, Plant, "plant", "a Plant, as Plant.load returns it")
    instance(recording, Recording, "recording", "a Recording, as Recording.load returns it")
    if start is not None:
        for name, value in instance(start, dict, "start", "a dict of numbers by name").items():
            number(value, f"start[{name!r}]")
    for name, value in (("clock", clock), ("path", path)):
        if not np.isfinite(number(value, name)):
            raise InputError(f"{name} = {value}; give a finite number")


def _driven(plant: Plant, recording: Recording) -> Plant:
    """The plant as it was set for a recording, of which both have an input."""
    if recording.input is None:
        raise InputError(f"{_source(recording)}: there is no input, so nothing can run freely")
    if plant.prescribed_motion:
        raise InputError(
            f"{plant.source}: [drive] kind = 'prescribed_motion' has no input to simulate; use "
            "Motor.follow or a drive with an input"
        )
    return plant.under(recording.settings)


def _simulated(motor: Motor, recording: Recording) -> Trajectory:
    """The motor under all that acted on the recorded machine."""
    assert recording.input is not None
    names = ("load", "temperature", "enabled", "transmitted")
    load, temperature, enabled, transmitted = (
        None if values is None else values[:-1] for values in map(recording.channels.get, names)
    )
    return motor.simulate(
        recording.input[:-1],
        np.diff(recording.time),
        load=load,
        temperature=temperature,
        enabled=enabled,
        transmitted=transmitted,
    )


def started(
    plant: Plant,
    position: float,
    velocity: float,
    start: Start,
    *,
    clock: float = 0.0,
    path: float = 0.0,
) -> Motor:
    """The plant's motor at its starting position and velocity, with this friction state.

    ``clock`` and ``path`` are those of the session, s and rad or m.
    """
    motor = plant.motor()
    motor.reset(position, velocity, time=clock, path=path)
    if start:
        state = motor.state
        motor.follow(Motion([position] * 2, [0.0], NO_TIME), start=start, strict=False)
        kept = ("velocity", "second_velocity", "time")
        motor.state = {**motor.state, **{name: state[name] for name in kept}}
    return motor


def starting_velocity(time: FloatArray, position: FloatArray, count: float) -> float:
    """Slope of a parabola at the first row, 0 where the first rows stay within two counts.

    Parameters
    ----------
    time, position : numpy.ndarray, shape (n,)
        s, and rad or m.
    count : float
        Size of a sensor count, 0 for none.
    """
    rows = max(5, round(STARTING_S / float(np.median(np.diff(time)))))
    t, x = time[:rows] - time[0], position[:rows]
    if np.ptp(x) <= 2.0 * count:
        return 0.0
    return float(np.polynomial.Polynomial.fit(t, x, 2).deriv()(0.0))


def _position(recording: Recording) -> FloatArray:
    if recording.position is None:
        raise InputError(f"{_source(recording)}: {NO_POSITION}")
    return recording.position


def _source(recording: Recording) -> str:
    return str(recording.path) if recording.path is not None else "recording"
