"""A motor (or any single-axis machine) with friction."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from typing import Any, Final, Self

import numpy as np
import numpy.typing as npt

from . import _native
from ._native import FrictionModel
from ._support import given
from ._support.arrays import FloatArray
from ._support.keywords import explain_constructor, explain_keywords
from .errors import InputError
from .trajectory import Trajectory

__all__ = ["Motor"]

_logger = logging.getLogger(__name__)

TENTH_OF_AN_ARC_SECOND: Final = 0.1 * np.pi / 648000
"""rad."""


MANY: Final = 1 << 20
"""Samples from which on memory is asked for beforehand."""


@explain_constructor
class Motor(_native.Motor):
    """A body driven by an input and resisted by friction: J·x'' = k·u + load − F.

    Parameters
    ----------
    inertia : float
        kg·m² (rotary) or kg (linear).
    torque_constant : float
        Effort per unit of input (current, voltage, effort), N·m/A and so on; with a servo per
        ampere.
    friction : FrictionModel
        Copied with its state; the motor owns the copy. Effects of the model become effects of the
        motor, which goes on from what they remember, at rest where the contact is.
    effects : dict of str to dict of str to float, optional
        Effects by name with their parameters, see ``stiction.effects()``.
    gravity_amplitude, gravity_zero : float
        Pendulum torque ``gravity_amplitude * sin(x - gravity_zero)`` that pulls back to
        ``gravity_zero``; N·m and rad.
    weight : float
        Constant force against positive motion, N.
    input_limit : float
        Greatest magnitude of the input that gets through, in its unit.
    servo : dict of str to float, optional
        Makes the input a goal, rad or m, and the effort that of a position servo: any of
        ``proportional``, ``integral`` and ``derivative`` (duty per rad, per rad·s and per rad/s, or
        the same with m), ``duty_limit``, ``supply`` (V), ``resistance`` (Ω), ``current_limit`` (A).
    count : float
        Size of a sensor count for the output ``measured``, rad or m; 0 for none.
    integrator : {"fast", "reference"}
        Velocity Verlet with one evaluation of friction a step, or Runge-Kutta of fourth order.
        Both divide a sample that is too long for the stiffness of the machine.

    Raises
    ------
    InputError
        A value out of bounds, an unknown effect or integrator, an unknown parameter of an effect or
        of the servo, an effect that is stated twice, a missing friction.
    """

    @explain_keywords
    def simulate(
        self,
        current: npt.ArrayLike,
        dt: npt.ArrayLike,
        *,
        load: npt.ArrayLike | None = None,
        temperature: npt.ArrayLike | None = None,
        enabled: npt.ArrayLike | None = None,
        transmitted: npt.ArrayLike | None = None,
        outputs: Sequence[str] | None = None,
        out: dict[str, FloatArray] | None = None,
    ) -> Trajectory:
        """Simulate samples of held input.

        Parameters
        ----------
        current : array_like, shape (n,)
            Input of each sample, held over it: A, V, N·m or N, of a servo its goal, rad or m.
        dt : float or array_like, shape (n,)
            Duration of a sample in s, or of each.
        load : float or array_like, shape (n,), optional
            External effort, N·m or N, positive along +x; 0 without it.
        temperature : float or array_like, shape (n,), optional
            In degC, for what depends on it; without it nobody knows it.
        enabled : bool or array_like, shape (n,), optional
            False or 0 where the drive is off; without it the drive is on.
        transmitted : float or array_like, shape (n,), optional
            Effort that the gear transmits, N·m or N, positive along +x like a load: what friction
            that grows with the load sees. Without it that is the load and gravity, and nothing of
            what accelerates the inertia behind the gear.
        outputs : sequence of str, optional
            Which columns to compute; all of ``output_names`` without it.
        out : dict of str to numpy.ndarray, optional
            Arrays to fill again: C-contiguous float64 of shape (n,). Where ``outputs`` is not
            given, its keys say which columns to compute.

        Returns
        -------
        Trajectory
            Entry k is the state after input k, as the k-th ``step`` returns it.

        Raises
        ------
        InputError
            Wrong shapes, values that are not finite or masked, unknown outputs or one of them
            twice, a ``dt`` that is not above 0 and at most 1e6 s or too long for this machine, more
            inner steps than 1000 a sample in the mean after the first 10 million, more rows than
            there is memory for.
        """
        # A call that other work has pushed out of the cache takes as long as what it looks up: no
        # keywords, and nothing is asked that only matters for arrays that are not there yet.
        names = None if outputs is None else given.names(outputs, "outputs")
        if out is None:
            _room_for(self, current, names)
        columns, length, start, statistics = self.run(
            current, dt, load, temperature, enabled, names, out, transmitted
        )
        steps = dt if type(dt) is float else _steps(dt)
        return Trajectory(columns, steps, length, start, statistics)

    @explain_keywords
    def simulate_segments(
        self,
        durations: npt.ArrayLike,
        current: npt.ArrayLike,
        *,
        tolerance: float = TENTH_OF_AN_ARC_SECOND,
        times: npt.ArrayLike | None = None,
        load: npt.ArrayLike | None = None,
        temperature: npt.ArrayLike | None = None,
        enabled: npt.ArrayLike | None = None,
        outputs: Sequence[str] | None = None,
    ) -> Trajectory:
        """Simulate inputs that are held long, at a cost of events and not of time.

        Steps are as long as the tolerance allows; once a ring has died out, a rest of any length is
        one evaluation.

        Parameters
        ----------
        durations : array_like, shape (n,)
            How long each input is held, s.
        current : array_like, shape (n,)
            Input of each segment, as in ``simulate``.
        tolerance : float
            Error of the position that is aimed at, rad (m); a tenth of an arc-second without it.
        times : array_like, shape (m,), optional
            Times from the start, s, at which rows are wanted beside the ends of the segments,
            rising.
        load, temperature, enabled : float or array_like, shape (n,), optional
            As for ``simulate``, for each segment.
        outputs : sequence of str, optional
            As for ``simulate``.

        Returns
        -------
        Trajectory
            A row at each time asked for and at the end of each segment. Its ``statistics`` count
            ``evaluations`` of the law, ``steps``, ``refused`` steps and ``rests`` of this run too.

        Raises
        ------
        InputError
            Wrong shapes, durations or a tolerance that are not positive, times that do not rise or
            lie outside the run, unknown outputs; more work than 10 million plain steps.

        Examples
        --------
        >>> import stiction as st
        >>> motor = st.Motor(0.0076, friction=st.FrictionModel("hsieh_pan"))
        >>> run = motor.simulate_segments([0.02, 86400.0], [0.2, 0.0])
        >>> len(run), run.statistics["evaluations"] < 500
        (2, True)
        """
        names = None if outputs is None else given.names(outputs, "outputs")
        start = self.clock
        rows, columns, cost = self.run_segments(
            durations, current, tolerance=tolerance, times=times, load=load,
            temperature=temperature, enabled=enabled, outputs=names,
        )  # fmt: skip
        steps = np.diff(rows, prepend=0.0)
        statistics = {**self.statistics, **cost}
        return Trajectory(columns, steps, len(rows), start, statistics)

    @property
    def friction(self) -> FrictionModel:
        """A copy of the friction law in its present state, without any effect.

        ``friction_model()`` is the friction with the effects that act at the contact.
        """
        law, keywords = self.friction_settings()
        model = FrictionModel(law, **keywords)
        model.state = self.friction_state()
        return model

    def friction_model(self, *, strict: bool = False) -> FrictionModel:
        """The friction with the effects that act at the contact, in its present state.

        Law, effects on the friction level, added efforts and creep, with the position, the clock,
        the path and what effects remember. Effects of the drive and of the sensor, and second
        masses, are no part of it: they are left out, and a warning of this module's logger names
        them. Weight and gravity of the motor are no friction.

        Parameters
        ----------
        strict : bool
            Whether effects that no friction model can have are refused, not left out.

        Returns
        -------
        FrictionModel
            An independent one. Its ``effects`` say what it has.

        Raises
        ------
        InputError
            With ``strict``: this motor has effects that no friction model can have.
        """
        strict = given.yes_or_no(strict, "friction_model: strict")
        model, left_out = self.contact()
        if left_out:
            names = ", ".join(left_out)
            said = f"effects of the machine and not of its contact: {names}"
            if strict:
                raise InputError(f"{said}; leave them out of the motor, or give strict=False")
            _logger.warning("left out of the friction model are %s", said)
        return model

    def copy(self) -> Self:
        """An independent copy, state included."""
        law, keywords = self.friction_settings()
        other = type(self)(friction=FrictionModel(law, **keywords), **self.settings())
        other.adopt(self)
        return other

    def __copy__(self) -> Self:
        return self.copy()

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        from ._rebuild import motor

        return motor, (self.settings(), *self.friction_settings(), self.state)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Motor):
            return NotImplemented
        return (
            self.settings() == other.settings()
            and self.friction_settings() == other.friction_settings()
            and _same_state(self.state, other.state)
        )

    __hash__ = None  # type: ignore[assignment]

    def _repr_html_(self) -> str:
        from .notebook import motor

        return motor(self)

    def __repr__(self) -> str:
        neutral = {
            "effects": {},
            "gravity_amplitude": 0.0,
            "gravity_zero": 0.0,
            "weight": 0.0,
            "input_limit": float("inf"),
            "servo": None,
            "count": 0.0,
            "integrator": "fast",
        }
        shown = ", ".join(
            f"{name}={value!r}"
            for name, value in self.settings().items()
            if name not in neutral or value != neutral[name]
        )
        law, keywords = self.friction_settings()
        return f"Motor({shown}, friction={FrictionModel(law, **keywords)!r})"


def _room_for(motor: Motor, current: npt.ArrayLike, names: list[str] | None) -> None:
    """Refuse fresh columns for which there is no memory."""
    size = getattr(current, "size", 0)
    if size > MANY:
        kept = len(motor.output_names if names is None else names)
        given.memory_for(8.0 * size * kept, f"{size} rows of {kept} outputs; give fewer")


def _steps(dt: npt.ArrayLike) -> float | FloatArray:
    """A sample time that is no plain float, s: of all samples, or of each."""
    return float(np.asarray(dt)) if np.ndim(dt) == 0 else np.array(dt, dtype=np.float64)


def _same_state(one: dict[str, Any], other: dict[str, Any]) -> bool:
    return one.keys() == other.keys() and all(
        np.array_equal(one[name], other[name]) for name in one
    )
