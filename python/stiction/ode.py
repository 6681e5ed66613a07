"""Plants as differential equations for the solvers of SciPy, with stick as a mode of its own.

The equations of a few laws, written out over time: those that are one equation beside that of the
body, and dry friction with true stick. Every other law and effect is a step of the core, which
``stiction.control`` has as a discrete-time system.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ._support import given
from ._support.arrays import FloatArray
from ._support.wording import commas
from .errors import InputError
from .plant import Plant

__all__ = ["Equations", "Solution", "equations", "solve"]

LAWS: Final = ("bouc_wen", "coulomb", "dahl", "elasto_plastic", "lugre")
"""Whose equations stand here."""
STATES: Final = {
    "bouc_wen": "dry_friction",
    "dahl": "dry_friction",
    "elasto_plastic": "deflection",
    "lugre": "deflection",
}
"""What a law remembers, as a motor calls it."""
STUCK, MOST_SWITCHES = 0, 100_000
"""Mode of a contact that sticks; changes of the mode after which a run is given up."""
RTOL: Final = 1e-8
LOOKS: Final = 1000
"""Times in a run at least at which a contact that sticks looks at the effort."""

Signal = Callable[[float], float]
"""Of the time, s."""


def _bias(numbers: Mapping[str, float], position: float, velocity: float) -> Iterator[float]:
    yield numbers["bias"]


def _drag(numbers: Mapping[str, float], position: float, velocity: float) -> Iterator[float]:
    yield -numbers["quadratic"] * velocity * abs(velocity)


def _waves(numbers: Mapping[str, float], position: float, velocity: float) -> Iterator[float]:
    for tail in ("", "_2"):
        angle = numbers[f"order{tail}"] * position
        yield numbers[f"cosine{tail}"] * np.cos(angle)
        yield numbers[f"sine{tail}"] * np.sin(angle)


Formula = Callable[[Mapping[str, float], float, float], Iterator[float]]
"""Terms of an effort, from the effect's parameters, position and velocity."""
FORMULAS: Final[dict[str, Formula]] = {
    "torque_bias": _bias,
    "viscous_quadratic": _drag,
    "cogging": _waves,
}
"""Added efforts that are a formula of position and velocity."""


@dataclass(frozen=True)
class Solution:
    """What ``solve`` found.

    Attributes
    ----------
    time : numpy.ndarray, shape (n,)
        s.
    states : numpy.ndarray, shape (states, n)
        By ``names``.
    names : tuple of str
    friction : numpy.ndarray, shape (n,)
        N·m or N; what holds the machine where it sticks.
    mode : numpy.ndarray of int, shape (n,)
        0 where the contact sticks, 1 and -1 where it slides forwards and backwards; of a law
        without true stick the direction of motion.
    switches : tuple of (float, int)
        When the mode changed, s, and into which.
    evaluations : int
        Of the right-hand side.
    """

    time: FloatArray
    states: FloatArray
    names: tuple[str, ...]
    friction: FloatArray
    mode: np.ndarray[Any, np.dtype[np.int64]]
    switches: tuple[tuple[float, int], ...]
    evaluations: int

    @property
    def position(self) -> FloatArray:
        """rad or m."""
        found: FloatArray = self.states[0]
        return found

    @property
    def velocity(self) -> FloatArray:
        """rad/s or m/s."""
        found: FloatArray = self.states[1]
        return found


class Equations:
    """A plant as y' = f(t, y, mode), as ``scipy.integrate.solve_ivp`` takes it.

    Made by ``equations``. With ``args=(mode,)`` ``rhs`` and ``events`` go to ``solve_ivp``: in one
    mode they are smooth, and the terminal event ends it. ``solve`` goes on from there.

    Attributes
    ----------
    names : tuple of str
        Of the states: position, velocity, and what the law remembers.
    sticks : bool
        Whether the contact has true stick, and modes.
    """

    def __init__(self, plant: Plant, input: Signal, load: Signal | None = None) -> None:
        law = plant.friction.law
        self.names = ("position", "velocity", *([STATES[law]] if law in STATES else []))
        self.sticks = law == "coulomb"
        self._plant, self._input, self._load = plant, input, load
        self._law, self._numbers = law, plant.friction.model().parameters
        self._inertia, self._gain = plant.inertia, plant.gain
        self._limit = float(plant.drive.get("limit", np.inf))
        zero = plant.body.get("gravity_zero_rad")
        self._zero = 0.0 if zero is None else zero.value
        motor = plant.motor()
        self._added = {
            effect.name: {
                name.rpartition(".")[2]: value
                for name, value in motor.parameters.items()
                if name.startswith(f"effects.{effect.name}.")
            }
            for effect in plant.effects
        }

    def effort(self, time: float, position: float, velocity: float) -> float:
        """What acts beside friction, N·m or N: drive, load, gravity, added efforts."""
        plant = self._plant
        driven = self._gain * float(np.clip(self._input(time), -self._limit, self._limit))
        found = driven if self._load is None else driven + self._load(time)
        found -= plant.gravity * np.sin(position - self._zero) + plant.weight
        for name, added in FORMULAS.items():
            if numbers := self._added.get(name):
                for part in added(numbers, position, velocity):
                    found += part
        return float(found)

    def friction(self, time: float, state: FloatArray, mode: int = STUCK) -> float:
        """Effort of friction, N·m or N, positive where it resists motion along +x.

        ``mode`` counts where the contact has true stick: 0 holds what acts.
        """
        position, velocity = float(state[0]), float(state[1])
        p = self._numbers
        if self.sticks:
            if mode == STUCK:
                return self.effort(time, position, velocity)
            return mode * self._level(velocity) + p["viscous"] * velocity
        if self._law in ("dahl", "bouc_wen"):
            return float(state[2]) + p["viscous"] * velocity
        damper = p["damping"] * float(np.exp(-((velocity / p["damping_velocity"]) ** 2)))
        bent = p["initial_stiffness"] * float(state[2])
        return bent + damper * self._pace(float(state[2]), velocity) + p["viscous"] * velocity

    def rhs(self, time: float, state: FloatArray, mode: int = STUCK) -> FloatArray:
        """Derivatives of the states by the time; shape (states,)."""
        velocity = float(state[1])
        if self.sticks and mode == STUCK:
            return np.zeros(2)
        left = self.effort(time, float(state[0]), velocity) - self.friction(time, state, mode)
        found = [velocity, left / self._inertia]
        if not self.sticks:
            found.append(self._pace(float(state[2]), velocity))
        return np.array(found)

    @property
    def events(self) -> tuple[Callable[[float, FloatArray, int], float], ...]:
        """What ends a mode, for ``solve_ivp``: none where the law has no true stick."""
        if not self.sticks:
            return ()

        def ends(time: float, state: FloatArray, mode: int) -> float:
            """Falls through 0 where a slide stops, or a contact breaks away."""
            if mode != STUCK:
                return mode * float(state[1])
            return self._numbers["breakaway"] - abs(self.effort(time, float(state[0]), 0.0))

        ends.terminal = True  # type: ignore[attr-defined]
        ends.direction = -1.0  # type: ignore[attr-defined]
        return (ends,)

    def mode_at(self, time: float, state: FloatArray) -> int:
        """The mode of a contact that may stick where it neither moved nor was held before."""
        velocity = float(state[1])
        if velocity != 0.0 or not self.sticks:
            return int(np.sign(velocity))
        acts = self.effort(time, float(state[0]), 0.0)
        return int(np.sign(acts)) if abs(acts) > self._numbers["breakaway"] else STUCK

    def _level(self, velocity: float) -> float:
        """g(v) = F_c + (F_s − F_c)·exp(−|v/v_s|^δ)."""
        p = self._numbers
        fall = np.exp(-(abs(velocity / p["stribeck_velocity"]) ** p["stribeck_exponent"]))
        return float(p["coulomb"] + (p["breakaway"] - p["coulomb"]) * fall)

    def _pace(self, z: float, velocity: float) -> float:
        """z' of the law."""
        p, way = self._numbers, float(np.sign(velocity))
        if self._law == "dahl":
            left = 1.0 - z / p["coulomb"] * way
            slope = abs(left) ** p["exponent"] * np.sign(left)
            return float(p["initial_stiffness"] * slope * velocity)
        if self._law == "bouc_wen":
            b = p["unloading_share"]
            share = b * np.sign(z * velocity) + 1.0 - b
            left = 1.0 - share * abs(z / p["coulomb"]) ** p["exponent"]
            return float(p["initial_stiffness"] * left * velocity)
        level, along = self._level(velocity), p["initial_stiffness"] * z * way
        slips = along / level
        if self._law == "elasto_plastic":
            elastic = p["elastic_share"] * p["coulomb"]
            if along <= elastic:
                slips = 0.0
            elif along < level:
                middle = np.pi * (along - 0.5 * (level + elastic)) / (level - elastic)
                slips *= 0.5 * (1.0 + float(np.sin(middle)))
        return velocity * (1.0 - slips)


def equations(plant: Plant, input: Signal, load: Signal | None = None) -> Equations:
    """A plant under an input as differential equations.

    Parameters
    ----------
    plant : Plant
        With a law of ``LAWS`` (bouc_wen, coulomb, dahl, elasto_plastic, lugre) and no effects but
        cogging, torque_bias and viscous_quadratic, no servo and no prescribed motion.
    input : callable
        Input of the drive at a time in s.
    load : callable, optional
        External effort at a time, N·m or N, positive along +x; 0 without it.

    Returns
    -------
    Equations

    Raises
    ------
    InputError
        A law or an effect whose equations do not stand here, a servo, a plant that is no motor.
    """
    given.instance(plant, Plant, "equations: plant", "a Plant")
    for name, signal in (("input", input), ("load", load)):
        if not callable(signal) and not (name == "load" and signal is None):
            raise InputError(
                f"equations: {name} = {given.brief(signal)} is no function of the time"
            )
    if plant.servo or plant.prescribed_motion:
        kind = "a servo" if plant.servo else "prescribed motion"
        raise InputError(f"{plant.source}: {kind} is no differential equation of a held input")
    other = "stiction.control has every law as a discrete-time system"
    if plant.friction.law not in LAWS:
        raise InputError(
            f"{plant.source}: the equations of {plant.friction.law} do not stand here, those of "
            f"{commas(LAWS)} do; {other}"
        )
    foreign = [effect.name for effect in plant.effects if effect.name not in FORMULAS]
    if foreign:
        raise InputError(
            f"{plant.source}: {commas(foreign)} cannot be held, {commas(sorted(FORMULAS))} can; "
            f"{other}"
        )
    return Equations(plant, input, load)


def solve(
    plant: Plant,
    input: Signal,
    times: npt.ArrayLike,
    *,
    load: Signal | None = None,
    breaks: Sequence[float] = (),
    start: Sequence[float] | None = None,
    method: str | None = None,
    rtol: float = RTOL,
    atol: float | None = None,
    max_step: float | None = None,
) -> Solution:
    """Solve the equations of a plant with ``scipy.integrate.solve_ivp``, mode by mode.

    A slide ends where the velocity comes to 0: located, not stepped over. There the contact sticks
    if it can hold what acts, and the velocity is 0 and the position the same to the bit until more
    acts than it holds. No velocity window, no regularised sign.

    Parameters
    ----------
    plant, input, load
        As for ``equations``.
    times : array_like, shape (n,)
        At which the states are wanted, rising, s; it starts at the first one.
    breaks : sequence of float, optional
        Times at which input or load jump: a solver takes them for smooth in between.
    start : sequence of float, optional
        States at the first time; without it at rest at 0, with a contact that was never moved.
    method : str, optional
        Of ``solve_ivp``; "LSODA" for laws whose contact yields, "DOP853" for one that sticks.
    rtol : float
        Relative tolerance.
    atol : float or array_like, optional
        Absolute tolerance of the states; a millionth of what the contact yields, and of as much a
        second, without it.
    max_step : float, optional
        Longest step, s; while the contact sticks nothing else makes the solver look at the effort.
        A thousandth of the run without it.

    Returns
    -------
    Solution

    Raises
    ------
    InputError
        As for ``equations``; times that do not rise, a start of another shape, a solver that gives
        up, a mode that changes without end.
    """
    from scipy.integrate import solve_ivp

    equations(plant, input, load)
    until = _Until()
    made = Equations(
        plant, until.end_from_below(input), None if load is None else until.end_from_below(load)
    )
    wanted = given.numbers(times, "solve: times")
    if wanted.ndim != 1 or len(wanted) < 2 or not np.all(np.diff(wanted) > 0.0):
        raise InputError("solve: times do not rise; give two or more, in s")
    state = np.zeros(len(made.names)) if start is None else given.numbers(start, "solve: start")
    if state.shape != (len(made.names),):
        raise InputError(f"solve: start has shape {state.shape}; give {', '.join(made.names)}")
    span = float(wanted[-1] - wanted[0])
    options = {
        "method": method or ("DOP853" if made.sticks else "LSODA"),
        "rtol": rtol,
        "atol": _tolerance(made) if atol is None else atol,
        "max_step": span / LOOKS if max_step is None else max_step,
    }
    inside = sorted({float(t) for t in breaks if wanted[0] < t < wanted[-1]})
    ends = [*inside, float(wanted[-1])]
    until.end = ends[0]
    now, mode = float(wanted[0]), made.mode_at(float(wanted[0]), state)
    run, switches = _Rows(made, wanted), []
    run.put(np.array([now]), state[:, None], mode)
    while ends:
        if now >= ends[0]:
            run.put(np.array([ends.pop(0)]), state[:, None], mode)
            until.end = ends[0] if ends else np.inf
            continue
        part = solve_ivp(
            made.rhs, (now, ends[0]), state, t_eval=run.within(now, ends[0]), args=(mode,),
            events=made.events or None, **options,
        )  # fmt: skip
        if part.status < 0:
            raise InputError(f"solve: the solver gives up at {now:g} s: {part.message}")
        run.evaluations += int(part.nfev)
        run.put(part.t, part.y, mode)
        if part.status == 0:
            now, state = ends.pop(0), run.last(part, state)
            until.end = ends[0] if ends else np.inf
        else:
            now, state = float(part.t_events[0][-1]), np.array(part.y_events[0][-1])
        if not made.sticks:
            continue
        if part.status == 1 and mode != STUCK:
            state[1] = 0.0
        changed = made.mode_at(now, state)
        if part.status == 1 and mode == STUCK:
            now, changed = _broken_away(made, now, state, ends[0])
        if changed != mode:
            mode = changed
            switches.append((now, mode))
        if len(switches) > MOST_SWITCHES:
            raise InputError(f"solve: the contact changes its mode without end at {now:g} s")
    return run.solution(tuple(switches))


class _Until:
    """Signals as they are before a jump, up to where it is: a solver also looks at the end."""

    def __init__(self) -> None:
        self.end = np.inf

    def end_from_below(self, signal: Signal) -> Signal:
        """The signal, and at the end its value from the left."""
        return lambda time: signal(min(time, float(np.nextafter(self.end, -np.inf))))


def _tolerance(made: Equations) -> float:
    """What a solver may leave out, beside which a contact yields a million times more."""
    stiffness = made._numbers.get("initial_stiffness")
    if stiffness is None:
        return 1e-12
    return 1e-6 * made._numbers["coulomb"] / max(stiffness, 1.0)


def _broken_away(made: Equations, time: float, state: FloatArray, end: float) -> tuple[float, int]:
    """When more acts than the contact holds, at the end of the bracket of the event, and its way.

    A root is found to within some units in the last place, and may lie before it.
    """
    step = 4.0 * np.finfo(float).eps * max(abs(time), abs(end))
    while time < end and made.mode_at(time, state) == STUCK:
        time, step = min(time + step, end), 2.0 * step
    return time, made.mode_at(time, state)


class _Rows:
    """States at the times that are wanted, as runs in one mode fill them."""

    def __init__(self, made: Equations, wanted: FloatArray) -> None:
        self._made, self._wanted = made, wanted
        self._states = np.full((len(made.names), len(wanted)), np.nan)
        self._mode = np.zeros(len(wanted), dtype=np.int64)
        self._friction = np.zeros(len(wanted))
        self.evaluations = 0

    def within(self, first: float, last: float) -> FloatArray:
        """Times after one and up to another; the last is always among them."""
        found = self._wanted[(self._wanted > first) & (self._wanted <= last)]
        return found if len(found) and found[-1] == last else np.append(found, last)

    @staticmethod
    def last(part: Any, state: FloatArray) -> FloatArray:
        """State at the end of a run that came there."""
        return np.array(part.y[:, -1]) if part.y.size else state

    def put(self, times: FloatArray, states: FloatArray, mode: int) -> None:
        """Fills in what is wanted of a run."""
        # Where nothing was wanted before an event, SciPy has empty lists.
        for time, state in zip(np.asarray(times).tolist(), np.asarray(states).T, strict=True):
            place = int(np.searchsorted(self._wanted, time))
            if place < len(self._wanted) and self._wanted[place] == time:
                self._states[:, place] = state
                own = mode if self._made.sticks else int(np.sign(state[1]))
                self._mode[place] = own
                self._friction[place] = self._made.friction(time, state, own)

    def solution(self, switches: tuple[tuple[float, int], ...]) -> Solution:
        """The whole."""
        return Solution(
            self._wanted,
            self._states,
            self._made.names,
            self._friction,
            self._mode,
            switches,
            self.evaluations,
        )
