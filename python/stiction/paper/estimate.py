"""Parameters of ``hsieh_pan`` from the paper's experiments (its section 4), with intervals.

First each parameter is read off where it shows most (:mod:`stiction.paper.graphical`), then all are
fitted together: the recordings are simulated from their torque, and what the simulated positions
miss is made least. The steps start the fit and stand beside it; the fit gives the values.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from .._native import FrictionModel
from .._support.arrays import FloatArray
from .._support.frozen import Frozen, freeze
from .._support.given import mapping, names, number
from ..errors import InputError
from ..motor import Motor
from .cautions import assumptions_of, stairs
from .graphical import Recorded, Steps, branch_curve, read_off
from .readings import Evidence, count_of, evidence, noise_of
from .result import MotionResult, Number, Result
from .rig import ARC_SECOND, ILLUSTRATIVE_RIG

__all__ = ["Estimate", "Estimated", "Recorded", "estimate"]

NAMES: Final = (
    "initial_stiffness",
    "final_stiffness",
    "decay_distance",
    "hardening_coefficient",
    "hardening_exponent",
    "creep_rate",
    "damping",
    "inertia",
)
UNITS: Final = ("N·m/rad", "N·m/rad", "rad", "rad/(N·m)^n", "1", "1/s", "N·m·s/rad", "kg·m²")
_PATHS: Final = tuple("body.inertia" if name == "inertia" else f"friction.{name}" for name in NAMES)
EXPERIMENTS: Final[Mapping[str, str]] = Frozen(
    {
        "initial_stiffness": "loops of torque below a level that was held before",
        "final_stiffness": "loops of torque over a long way, below a level that was held before",
        "decay_distance": "loops of torque over a long way, below a level that was held before",
        "hardening_coefficient": "a torque held until the creep has stopped",
        "hardening_exponent": "torques of three or more levels, each held until the creep has "
        "stopped",
        "creep_rate": "a torque held for some seconds, as in experiment 2",
        "damping": "a ring after a torque is cut, as in experiment 1",
        "inertia": "a ring after a torque is cut, as in experiment 1",
    }
)
"""What to record so that a parameter is determined."""

_PRIOR: Final = 1.5
"""Width of what is assumed of a parameter before: a factor of e^1.5 either way is one deviation."""
_DETERMINED: Final = 0.35
"""A parameter whose logarithm is known to no better than this is not determined: ±70 % or more."""
_QUANTILE: Final = 1.96
_BLOCK: Final = 0.1  # s; residuals within a block may be correlated as they like
_ITERATIONS: Final = 40
_LEAST: Final = 1e-7  # fall of the cost of a reading that is worth another step
_ROUNDS: Final = 20  # of noise and fit in turn
_SETTLED: Final = 0.003  # change of the noise that is none
_ROUGH: Final = 0.45  # counts; rounding is then noise like any other
_QUIET: Final = 0.25  # counts; least squares see little of less noise
_ALIKE: Final = 0.1  # of the cost: what lies as near as this the readings do not tell apart
_CURVE: Final = np.linspace(2.0, 40.0, 39) * ARC_SECOND


@dataclass(frozen=True)
class Estimated:
    """A parameter.

    Attributes
    ----------
    value : float
    ci95 : tuple of float
        Interval that holds the truth 19 times in 20, were the model right.
    unit : str
    determined : bool
        Whether the recordings say anything of use about it.
    """

    value: float
    ci95: tuple[float, float]
    unit: str
    determined: bool


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Estimate(Result):
    """Parameters with intervals, the branch curve, and what was not determined.

    Attributes
    ----------
    parameters : Mapping of str to Estimated
        ``inertia`` and the parameters of ``hsieh_pan``.
    steps : Steps
        What was read off before the joint fit.
    distance, branch, branch_low, branch_high : numpy.ndarray, shape (n,)
        G over the distance from a reverse point (rad, N·m), with its 95 % interval: the curve is
        determined better than its parameters.
    undetermined : tuple of str
        One sentence for each parameter that these experiments leave open: what to record.
    cautions : tuple of str
        Parameters whose value rests on the form of the model alone, since no recording shows them
        by themselves, and readings so quiet that rounding shows. No interval tells of either.
    rms : tuple of float
        What the fit leaves of each recording, rad.
    ended : bool
        Whether the fit came to an end.
    ending : str
        How, in words.
    """

    parameters: Mapping[str, Estimated]
    steps: Steps
    distance: FloatArray
    branch: FloatArray
    branch_low: FloatArray
    branch_high: FloatArray
    undetermined: tuple[str, ...]
    cautions: tuple[str, ...]
    rms: tuple[float, ...]
    ended: bool
    ending: str
    correlations: FloatArray = field(default_factory=lambda: np.empty((0, 0)))

    def __post_init__(self) -> None:
        super().__post_init__()
        freeze(self, Frozen, "parameters")

    @property
    def success(self) -> bool:
        """Whether the fit came to an end."""
        return self.ended

    @property
    def message(self) -> str:
        """How the fit ended, in words."""
        return self.ending

    def motor(self) -> Motor:
        """The machine with the estimated parameters."""
        return _motor({name: p.value for name, p in self.parameters.items()})

    def __repr__(self) -> str:
        said = (*self.undetermined, *self.cautions)
        return "\n".join([super().__repr__(), *(f"  {text}" for text in said)])


def estimate(
    *records: MotionResult | Recorded,
    start: Mapping[str, float] | None = None,
    fixed: Iterable[str] = (),
) -> Estimate:
    """Estimate the parameters of ``hsieh_pan`` from recordings of the paper's experiments.

    Every recording starts at rest, at position 0, with junctions that were never moved. Wanted
    are: loops of torque below a level that was held before (G), holds at three or more levels (f),
    a hold of some seconds as in experiment 2 (α), and the ring after a cut as in experiment 1
    (inertia and damper). One recording may hold several of them; what is missing is said in
    ``undetermined``.

    Parameters
    ----------
    *records : MotionResult or Recorded
        Results of :mod:`stiction.paper`, or recordings of a machine of yours, evenly sampled.
    start : mapping, optional
        Values that are assumed where the recordings say nothing, or to start from; the
        illustrative rig's without.
    fixed : iterable of str
        Parameters that keep their value of `start`, such as an inertia that was measured apart.

    Returns
    -------
    Estimate

    Raises
    ------
    InputError
        No recording, one that is empty or not finite, or an unknown parameter.

    Notes
    -----
    Maximum likelihood of the positions with exact derivatives, by the logarithms of the parameters,
    k_inf as a share of k_0, and f at the middle of the torques in place of c. A weak prior (a
    factor of 4.5 either way) keeps undetermined parameters where they are; where recordings
    determine a parameter it has no weight. Intervals allow for residuals that are correlated
    within 0.1 s.

    Where there is less noise than half a count, readings are taken as intervals: the position, with
    the noise before rounding, lay within half a count of each; that noise is estimated along.

    k_0, k_inf and d_0 trade against each other: look at the curve, not at them. The ring's
    decrement overstates C_s, the simulation does not.

    Source
    ------
    Hsieh, Pan, Wear 242 (2000), section 4 by its title only; the steps are ours.

    Examples
    --------
    >>> from stiction import paper
    >>> ring = paper.experiment_1(duration=1.2, dt=2.5e-4, encoder_count=paper.FINE_COUNT)
    >>> [text.split(":")[0] for text in estimate(ring).cautions if "exponent" in text]
    ['hardening_exponent rests on the form of the model alone']
    """
    recorded = [_recorded(record) for record in records]
    if not recorded:
        raise InputError("estimate: no recording; give at least one")
    start = mapping(start, "estimate: start", "numbers by name")
    fixed = tuple(names(fixed, "estimate: fixed"))
    for name in (*start, *fixed):
        if name not in NAMES:
            raise InputError(f"estimate: '{name}' is no parameter; known are {', '.join(NAMES)}")
    steps = read_off(recorded)
    guess = _guess(steps, start, fixed)
    fit = _Fit(recorded, guess, fixed)
    return fit.run(steps)


class _Fit:
    """The joint fit by Gauss and Newton with Marquardt's damping."""

    def __init__(
        self, records: list[Recorded], guess: dict[str, float], fixed: tuple[str, ...]
    ) -> None:
        self._records = records
        efforts = np.concatenate([record.effort for record in records])
        # Torque at which f is a variable in place of c: n and f then hardly trade.
        self._middle = float(np.sqrt(np.mean(efforts**2))) or 1.0
        self._guess = guess
        self._fixed = fixed
        self._free = np.array([name not in fixed for name in NAMES])
        self._prior = self._variables(guess)
        spread = np.concatenate([np.diff(record.position) for record in records])
        self._noise = float(np.std(spread) / math.sqrt(2.0)) or 1.0
        self._counts = np.concatenate(
            [np.full(len(record.position), count_of(record.position)) for record in records]
        )

    def run(self, steps: Steps) -> Estimate:
        """Iterate to the end and sum up."""
        rounded, self._counts = self._counts, np.zeros(len(self._counts))
        x, message, success = self._lessened(self._prior.copy())
        count = float(np.max(rounded))
        # Least squares come near enough to tell how much noise there is before rounding.
        noise = noise_of(self._missed(x), rounded)
        if noise < _ROUGH * count:
            self._counts = rounded
            x, message, success = self._within_counts(x, noise, count)
        return self._summed_up(x, steps, message, success)

    def _within_counts(
        self, x: FloatArray, noise: float, count: float
    ) -> tuple[FloatArray, str, bool]:
        """Variables and noise at which readings are likeliest that are intervals of a count."""
        if noise < _QUIET * count:
            # Stairs taken for motion may have led far away: begin again, with more noise than that.
            self._noise = _QUIET * count
            again = self._lessened(self._prior.copy())[0]
            x = min(again, self._lessened(x)[0], key=self._tried)
        message, success = "", False
        for _ in range(_ROUNDS):
            before = self._noise
            self._noise = noise_of(self._missed(x), self._counts)
            settled = abs(self._noise / before - 1.0) < _SETTLED
            was = self._tried(x)
            x, message, success = self._lessened(x)
            if settled and was - self._tried(x) < _ALIKE:
                break
        return x, message, success

    def _lessened(self, x: FloatArray) -> tuple[FloatArray, str, bool]:
        """Variables at which the cost is least, from these on; how that ended."""
        damping, message, success = 1e-3, "no end within the iterations", False
        said, jacobian = self._linearised(x)
        cost = self._cost(x, said)
        for _ in range(_ITERATIONS):
            normal, gradient = self._normal(x, said, jacobian)
            step = -np.linalg.solve(normal + damping * np.diag(np.diag(normal)), gradient)
            trial = x.copy()
            trial[self._free] += np.clip(step, -1.0, 1.0)
            tried = self._tried(trial)
            if not tried < cost:
                damping *= 8.0
                if damping > 1e9:
                    return x, "no step lessens the residual any more", True
                continue
            x, damping, less = trial, max(damping / 8.0, 1e-9), cost - tried
            said, jacobian = self._linearised(x)
            cost = tried
            if less < _LEAST * len(said.pull):
                return x, "the residual does not fall any more", True
        return x, message, success

    def _variables(self, values: Mapping[str, float]) -> FloatArray:
        share = values["final_stiffness"] / values["initial_stiffness"]
        n = values["hardening_exponent"]
        return np.array(
            [
                math.log(values["initial_stiffness"]),
                math.log(share / (1.0 - share)),
                math.log(values["decay_distance"]),
                math.log(values["hardening_coefficient"]) + n * math.log(self._middle),
                math.log(n - 1.0),
                math.log(values["creep_rate"]),
                math.log(values["damping"]),
                math.log(values["inertia"]),
            ]
        )

    def _values(self, x: FloatArray) -> dict[str, float]:
        k_0, share = math.exp(x[0]), 1.0 / (1.0 + math.exp(-x[1]))
        n = 1.0 + math.exp(x[4])
        c = math.exp(x[3] - n * math.log(self._middle))
        own = (k_0, share * k_0, math.exp(x[2]), c, n, *np.exp(x[5:]).tolist())
        return {name: float(value) for name, value in zip(NAMES, own, strict=True)}

    def _chain(self, x: FloatArray) -> FloatArray:
        """Derivatives of the parameters (rows) by the variables (columns)."""
        values = self._values(x)
        chain = np.diag([values[name] for name in NAMES])
        share = 1.0 / (1.0 + math.exp(-x[1]))
        chain[1, 0] = values["final_stiffness"]
        chain[1, 1] = values["final_stiffness"] * (1.0 - share)
        chain[4, 4] = math.exp(x[4])
        chain[3, 4] = -values["hardening_coefficient"] * math.exp(x[4]) * math.log(self._middle)
        return chain

    def _missed(self, x: FloatArray) -> FloatArray:
        """Simulated less recorded position."""
        motor = _motor(self._values(x))
        pieces = []
        for record in self._records:
            run = motor.copy().simulate(record.effort, record.dt, outputs=("position",))
            pieces.append(run.position - record.position)
        return np.concatenate(pieces)

    def _linearised(self, x: FloatArray) -> tuple[Evidence, FloatArray]:
        """What the readings say, and the weighted derivatives of positions by free variables."""
        motor = _motor(self._values(x))
        slopes = [
            motor.copy().sensitivity(record.effort, record.dt, _PATHS, strict=False)[0].T
            for record in self._records
        ]
        said = evidence(self._missed(x), self._counts, self._noise)
        by_variable = (np.concatenate(slopes) @ self._chain(x))[:, self._free]
        return said, by_variable * said.root_weight[:, None]

    def _tried(self, x: FloatArray) -> float:
        """The cost of a trial; infinite where the law refuses it or the motion escapes."""
        try:
            missed = self._missed(x)
        except (InputError, OverflowError):
            return math.inf
        if not np.isfinite(missed).all():
            return math.inf
        return self._cost(x, evidence(missed, self._counts, self._noise))

    def _cost(self, x: FloatArray, said: Evidence) -> float:
        return said.cost + float(np.sum(((x - self._prior) / _PRIOR) ** 2))

    def _normal(
        self, x: FloatArray, said: Evidence, jacobian: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        pull = ((x - self._prior) / _PRIOR**2)[self._free]
        normal = jacobian.T @ jacobian + np.eye(int(self._free.sum())) / _PRIOR**2
        return normal, jacobian.T @ said.pull + pull

    def _covariance(self, said: Evidence, jacobian: FloatArray) -> FloatArray:
        """Of the free variables: the greater of what white and what correlated residuals give."""
        power = float(np.sum((said.pull * said.root_weight) ** 2) / np.sum(said.root_weight**2))
        bread = np.linalg.inv(jacobian.T @ jacobian / power + np.eye(jacobian.shape[1]) / _PRIOR**2)
        meat = np.zeros_like(bread)
        at = 0
        for record in self._records:
            block = max(1, round(_BLOCK / record.dt))
            end = at + len(record.effort)
            for first in range(at, end, block):
                last = min(first + block, end)
                score = jacobian[first:last].T @ said.pull[first:last] / power
                meat += np.outer(score, score)
            at = end
        meat += np.eye(jacobian.shape[1]) / _PRIOR**2
        blocked = bread @ meat @ bread
        wider = np.sqrt(np.maximum(np.diag(blocked) / np.diag(bread), 1.0))
        return np.asarray(bread * np.outer(wider, wider))

    def _summed_up(
        self,
        x: FloatArray,
        steps: Steps,
        message: str,
        success: bool,
    ) -> Estimate:
        said, jacobian = self._linearised(x)
        free = np.flatnonzero(self._free)
        covariance = np.zeros((len(NAMES), len(NAMES)))
        covariance[np.ix_(free, free)] = self._covariance(said, jacobian)
        values, chain = self._values(x), self._chain(x)
        scale = np.array([values[name] for name in NAMES])
        # Of the logarithms of the parameters: intervals that stay positive.
        relative = chain / scale[:, None]
        spread = np.sqrt(np.maximum(np.diag(relative @ covariance @ relative.T), 0.0))
        parameters = {}
        for index, name in enumerate(NAMES):
            half = _QUANTILE * float(spread[index])
            value = values[name]
            low, high = value * math.exp(-min(half, 50.0)), value * math.exp(min(half, 50.0))
            fine = bool(spread[index] < _DETERMINED)
            parameters[name] = Estimated(value, (low, high), UNITS[index], fine)
        undetermined = tuple(
            f"{name} is not determined by these recordings: record {EXPERIMENTS[name]}"
            for name, each in parameters.items()
            if not each.determined
        )
        branch, branch_low, branch_high = _branch_interval(values, chain, covariance)
        deviation = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
        return Estimate(
            title="Parameters from the paper's experiments",
            source="Wear 242 (2000), section 4",
            shows="Loops give the spring, holds the hardening, creep its rate, the ring inertia "
            "and damper; all of them together the values.",
            numbers={
                name: Number(each.value, each.unit)
                for name, each in parameters.items()
                if each.determined
            },
            parameters=parameters,
            steps=steps,
            distance=_CURVE,
            branch=branch,
            branch_low=branch_low,
            branch_high=branch_high,
            undetermined=undetermined,
            cautions=(
                *(
                    f"{name} rests on the form of the model alone: {why}; record "
                    f"{EXPERIMENTS[name]}"
                    for name, why in assumptions_of(steps, NAMES[:3]).items()
                    if parameters[name].determined and name not in self._fixed
                ),
                *stairs(self._records),
            ),
            rms=self._left(self._missed(x)),
            ended=success,
            ending=message,
            correlations=covariance / np.outer(deviation, deviation),
        )

    def _left(self, missed: FloatArray) -> tuple[float, ...]:
        ends = np.cumsum([len(record.effort) for record in self._records])[:-1]
        pieces = np.split(missed, ends)
        return tuple(float(np.sqrt(np.mean(piece**2))) for piece in pieces)


def _branch_interval(
    values: Mapping[str, float], chain: FloatArray, covariance: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """G and its interval, from the covariance of what it depends on."""
    k_0, k_inf, d_0 = (values[name] for name in NAMES[:3])
    left = np.exp(-_CURVE / d_0)
    slopes = np.zeros((len(_CURVE), len(NAMES)))
    slopes[:, 0] = d_0 * (1.0 - left)
    slopes[:, 1] = _CURVE - d_0 * (1.0 - left)
    slopes[:, 2] = (k_0 - k_inf) * (1.0 - left * (1.0 + _CURVE / d_0))
    by_variable = slopes @ chain
    spread = np.sqrt(np.einsum("ij,jk,ik->i", by_variable, covariance, by_variable))
    curve = branch_curve(_CURVE, k_0, k_inf, d_0)
    return curve, curve - _QUANTILE * spread, curve + _QUANTILE * spread


def _guess(steps: Steps, start: Mapping[str, float], fixed: tuple[str, ...]) -> dict[str, float]:
    """Where the fit starts: what was read off, then what was given, then the illustrative rig."""
    guess = {name: float(ILLUSTRATIVE_RIG[name]) for name in NAMES}
    guess |= {name: number(value, f"estimate: start: {name}") for name, value in start.items()}
    read: dict[str, float] = {}
    if steps.branch is not None:
        read |= dict(zip(NAMES[:3], steps.branch, strict=True))
    if steps.hardening is not None:
        read |= dict(zip(NAMES[3:5], steps.hardening, strict=True))
    if steps.creep_rate is not None:
        read["creep_rate"] = steps.creep_rate
    if steps.ring is not None:
        read |= {"inertia": steps.ring[0], "damping": steps.ring[1]}
    guess |= {name: value for name, value in read.items() if name not in fixed}
    guess["final_stiffness"] = min(guess["final_stiffness"], 0.9 * guess["initial_stiffness"])
    guess["hardening_exponent"] = min(max(guess["hardening_exponent"], 1.1), 5.0)
    return guess


def _motor(values: Mapping[str, float]) -> Motor:
    law = {name: value for name, value in values.items() if name != "inertia"}
    friction = FrictionModel("hsieh_pan", **law)
    return Motor(inertia=values["inertia"], friction=friction, integrator="reference")


def _recorded(record: MotionResult | Recorded) -> Recorded:
    if isinstance(record, MotionResult):
        time, effort, position = record.time, record.effort, record.measured
        dt = float(time[-1] / len(time)) if len(time) else 0.0
    else:
        dt = record.dt
        effort = np.asarray(record.effort, dtype=np.float64)
        position = np.asarray(record.position, dtype=np.float64)
    if effort.shape != position.shape or effort.ndim != 1 or effort.size < 50:
        raise InputError(
            f"estimate: a recording has effort of shape {effort.shape} and position of shape "
            f"{position.shape}; give at least 50 samples of both"
        )
    if not (math.isfinite(dt) and dt > 0.0 and np.isfinite(effort).all()):
        raise InputError("estimate: a recording has a dt or an effort that is not a finite number")
    if not np.isfinite(position).all():
        raise InputError("estimate: a recording has a position that is not a finite number")
    return Recorded(dt, effort, position)
