"""Weighted least squares over rows: parameters of the plant and nuisances of the recordings."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, TypeVar

import numpy as np

from .._support.arrays import FloatArray
from .._support.progress import steps
from .._support.workers import side_by_side
from ..plant import Plant
from ..residual.finite import finite
from .levenberg import FIRST_DAMPING, Minimum, Pull, Slopes, descend, escape, normal_matrix
from .rows import Nuisances, Rows, Start, add_starts, numbers, start_quantities, timing_bound
from .slopes import Block, places_of, slope_block
from .variables import Variables, records

__all__ = [
    "CONVERGED",
    "MOST_EVALUATIONS",
    "Solution",
    "alone",
    "from_elsewhere",
    "launch",
    "minimise",
    "or_from",
    "with_interruption",
]

MOST_EVALUATIONS: Final = 60
CONVERGED: Final = 1e-8
"""Change of cost, or of parameters, below which nothing more is gained: samples at rest go over
from stick to slip one by one, so the cost has tiny steps."""
FIRST_EVALUATIONS: Final = 5
LAUNCHED: Final = 1e-5
"""Change of the cost at which a launch along a measured motion ends: what is left there weights
recordings, and a second pass with these weights goes on to the end."""
BOLD: Final = 0.01
"""First damping where rows are simulated: a bold step leaves the valley of another cause. With ten
times as much a goal that was held back stayed a limit of voltage."""
LEFT: Final = 2
"""After so many steps these go on of several starts."""
FEW_EVALUATIONS: Final = 14
"""After so many it shows which of several starts leads on."""
EXPLORED: Final = 1e-3
"""Change of the cost below which another start has come to its valley; most end in one that is
known."""
MOST_ESCAPES: Final = 4
"""Starts from beyond a kink, for laws that stick without a spring."""
HARDENING: Final = "friction.hardening_coefficient"
LONGER: Final = 4.0
"""Times the way over which a contact hardens that is tried as well."""
SHRINKING: Final = 10.0
"""Rows that a factor e of a shape parameter away from its neutral value weighs as much as, or a
start of the usual size: about a single independent piece of evidence, for neighbouring rows share
a kernel."""
START_CONVERGED: Final = 1e-4
"""Of the power that it leaves: neighbouring rows share a kernel, so far less than they know."""
START_TIMES: Final = 2.0
"""A force at the start is at most this many times the greatest effort that was measured."""
ROUNDED: Final = 64.0 * float(np.finfo(float).eps)
"""Share of an effort that rounding may leave of it, over all that a law sums up: of data simulated
without noise it left a quarter of this."""
RUNAWAY: Final = 1e6
LONG: Final = 8_000
"""Samples of a recording from which on recordings are looked at side by side."""
INTERRUPTED: Final = "interrupted: these are the best values so far"

_logger = logging.getLogger(__name__)

Result = TypeVar("Result")


@dataclass(frozen=True)
class Solution:
    """Where a minimisation ended.

    Attributes
    ----------
    plant : Plant
    variables : Variables
    vector, begin : numpy.ndarray, shape (p,)
        Of the variables, at the end and at the start.
    nuisances : Nuisances
    success, interrupted : bool
    message : str
    evaluations : int
    power : float
        Σ w²·r² at the end.
    slopes : sequence of Block or None
        Derivatives of the fitted rows at the end, by recording, where they are at hand.
    """

    plant: Plant
    variables: Variables
    vector: FloatArray
    begin: FloatArray
    nuisances: Nuisances
    success: bool
    interrupted: bool
    message: str
    evaluations: int
    power: float
    slopes: Sequence[Block] | None = None


def minimise(
    plant: Plant,
    paths: Sequence[str],
    rows: Sequence[Rows],
    *,
    most: int = MOST_EVALUATIONS,
    nuisances: Nuisances | None = None,
    converged: float = CONVERGED,
    beyond_kinks: bool = True,
) -> Solution:
    """Minimise Σ w²·r² over the rows by parameters of the plant and by nuisances.

    Parameters
    ----------
    plant : Plant
        States every path; its values are the start.
    paths : sequence of str
    rows : sequence of Rows
        With their weights.
    most : int
        Evaluations of the residual at most.
    nuisances : Nuisances, optional
        Where the nuisances start, and which starts are fitted; without it those are fitted that the
        rows tell of.
    converged : float
        Relative change of cost or parameters at which it ends.
    beyond_kinks : bool
        Whether starts from beyond a kink are tried where the law sticks without a spring: from a
        minimum that has been through that before, they cost more than the fit and lead nowhere.

    Returns
    -------
    Solution
        The best so far after Ctrl-C or too many evaluations, and ``success`` False.
    """
    escapes = MOST_ESCAPES if beyond_kinks and not start_quantities(plant) else 0
    return _Minimiser(plant, paths, rows, most, nuisances, converged).run(escapes)


def alone(plant: Plant, rows: Rows, nuisances: Nuisances, *, most: int) -> Solution:
    """The start of one recording, fitted to its own rows; plant and timing stay.

    Parameters
    ----------
    plant : Plant
    rows : Rows
    nuisances : Nuisances
        With the start of this recording, from which it is looked for, and no other.
    most : int
        Evaluations of the residual at most.

    Raises
    ------
    KeyboardInterrupt
    """
    own = _Minimiser(plant, [], [rows], most, nuisances, START_CONVERGED, timed=False)
    solution = own.run(0)
    if solution.interrupted:
        raise KeyboardInterrupt
    return solution


def launch(
    plants: Sequence[Plant],
    paths: Sequence[str],
    rows: Sequence[Rows],
    *,
    most: int,
    hopeless: float = math.inf,
) -> Solution:
    """Minimise from each of several starts for a while, then on from the best of them.

    After a few steps the better half of them goes on; none does where all are above ``hopeless``,
    a power.
    """
    first = []
    for plant in plants:
        most_at_first = FIRST_EVALUATIONS if len(plants) > LEFT else FEW_EVALUATIONS
        try:
            first.append(minimise(plant, paths, rows, most=min(most_at_first, most)))
        except KeyboardInterrupt:
            # Before that start had anything to keep.
            if not first:
                raise
            first[-1] = with_interruption(first[-1])
        if first[-1].interrupted:
            break
    spent = sum(solution.evaluations for solution in first)
    best = min(first, key=lambda solution: solution.power)
    if best.power > hopeless:
        return replace(best, evaluations=spent)
    if len(first) > LEFT and not any(solution.interrupted for solution in first):
        first = sorted(first, key=lambda solution: solution.power)[:LEFT]
        for k, solution in enumerate(first):
            if not solution.success:
                first[k] = _further(solution, rows, min(FEW_EVALUATIONS - FIRST_EVALUATIONS, most))
                spent += first[k].evaluations
            if first[k].interrupted:
                break
    best = min(first, key=lambda solution: solution.power)
    if any(solution.interrupted for solution in first):
        return with_interruption(replace(best, evaluations=spent))
    if best.success:
        return replace(best, evaluations=spent)
    known = add_starts(best.plant, rows, best.nuisances)
    converged = CONVERGED if rows[0].form.simulated else LAUNCHED
    whole = _further(best, rows, most, nuisances=known, converged=converged)
    return replace(whole, evaluations=whole.evaluations + spent)


def with_interruption(best: Solution) -> Solution:
    """The best so far of a fit that was interrupted in another part."""
    return replace(best, success=False, interrupted=True, message=INTERRUPTED)


def _further(
    solution: Solution,
    rows: Sequence[Rows],
    most: int,
    *,
    nuisances: Nuisances | None = None,
    converged: float = CONVERGED,
) -> Solution:
    """The same fit, gone on with."""
    paths = solution.variables.paths
    known = solution.nuisances if nuisances is None else nuisances
    try:
        further = minimise(
            solution.plant, paths, rows, most=most, nuisances=known, converged=converged
        )
    except KeyboardInterrupt:
        # Before it had anything to keep.
        return replace(with_interruption(solution), evaluations=0)
    return replace(further, begin=solution.begin)


def from_elsewhere(
    solution: Solution, rows: Sequence[Rows], *, most: int = MOST_EVALUATIONS
) -> Solution:
    """The better of a solution and short fits from starts that it may not have seen.

    With each exponent at its usual value: one far from that makes up for the number that it belongs
    to, in a valley that no small step leaves. And with a contact that hardens over a longer way:
    one that hardens too soon breaks away here and there, and each time is a kink from which slopes
    lead back. Where the law has neither, or the fit was interrupted, the solution. ``most``: of
    evaluations of each start, at most.
    """
    return or_from(_elsewhere(solution), solution, rows, most=most)


def or_from(
    starts: Sequence[Plant], solution: Solution, rows: Sequence[Rows], *, most: int
) -> Solution:
    """The better of a solution and short fits from other starts; to its end, where one is better.

    Parameters
    ----------
    starts : sequence of Plant
        Where to fit from as well.
    solution : Solution
        What is known; it comes back as it is where it was interrupted.
    rows : sequence of Rows
    most : int
        Evaluations of each start at most.
    """
    better, spent = solution, solution.evaluations
    paths = solution.variables.paths
    few = min(FEW_EVALUATIONS, most)
    for start in () if solution.interrupted else starts:
        try:
            known = better.nuisances
            again = minimise(start, paths, rows, most=few, nuisances=known, converged=EXPLORED)
            spent += again.evaluations
            if again.power < better.power and not again.interrupted:
                again = minimise(again.plant, paths, rows, most=most, nuisances=again.nuisances)
                spent += again.evaluations
        except KeyboardInterrupt:
            # Before that start had anything to keep.
            better = with_interruption(better)
            break
        if again.power < better.power:
            better = again
        if again.interrupted:
            better = with_interruption(better)
            break
    return replace(better, evaluations=spent, begin=solution.begin)


def _elsewhere(solution: Solution) -> list[Plant]:
    """Starts apart from a solution."""
    plant, known = solution.plant, records(solution.plant)
    paths = solution.variables.paths
    usual = {
        path: known[path].default
        for path in paths
        if path.startswith("friction.") and path.endswith("exponent") and not known[path].optional
    }
    starts = [usual] if usual else []
    if HARDENING in paths:
        longer = LONGER * plant.parameters[HARDENING].value
        index = paths.index(HARDENING)
        starts.append({HARDENING: float(min(longer, solution.variables.upper[index]))})
    return [plant.with_values(start) for start in starts]


class _Minimiser:
    """Least squares that remembers the best vector it saw."""

    def __init__(
        self,
        plant: Plant,
        paths: Sequence[str],
        rows: Sequence[Rows],
        most: int,
        nuisances: Nuisances | None,
        converged: float,
        *,
        timed: bool = True,
    ) -> None:
        self.plant, self.rows, self.most, self.converged = plant, rows, most, converged
        self.timed = timed
        self.variables = Variables.of(plant, paths)
        self.begin = self.variables.vector(np.array([plant.parameters[p].value for p in paths]))
        given = add_starts(plant, rows) if nuisances is None else nuisances
        self.starts, self.leader = places_of(given), given.leader
        self.evaluations = 0
        self._slopes: list[Block] | None = None
        self._last: tuple[FloatArray, list[FloatArray]] | None = None
        self._best: tuple[float, FloatArray] | None = None
        known = records(plant)
        neutral = [known[path].neutral if path in known else None for path in paths]
        # A shape that the data do not tell stays where it changes nothing, not at a bound.
        self.shrunk = np.array(
            [
                k
                for k, value in enumerate(neutral)
                if value is not None
                and np.isfinite(value)
                and value > 0.0
                and self.variables.logarithmic[k]
            ],
            dtype=np.int64,
        )
        centres = np.log([float(neutral[k] or 1.0) for k in self.shrunk])
        self.pulls: list[Pull] = []
        before = [(given.start(index) or {}).get(name, 0.0) for index, name in self.starts]
        self.full = np.concatenate([self.begin, [given.timing], before])
        self.usual = np.array([self._usual(name) for _, name in self.starts])
        # A start that few rows tell of stays near 0, too.
        self.shrunk = np.append(self.shrunk, len(self.begin) + 1 + np.arange(len(self.starts)))
        self.centres = np.append(centres, np.zeros(len(self.starts)))
        self.widths = np.append(np.ones(len(centres)), self.usual)

    def _usual(self, name: str) -> float:
        """Usual size of a start quantity: that of efforts, or what they bend the contact by."""
        effort = max(float(np.sqrt(np.mean(each.form.effort**2))) for each in self.rows)
        if name == "force":
            return max(effort, 1e-300)
        if name in (known := numbers(self.plant)):
            return known[name].typical
        stiffness = self.plant.friction.parameters.get("initial_stiffness")
        return 1e-4 if stiffness is None else max(effort / stiffness.value, 1e-300)

    def run(self, escapes: int) -> Solution:
        lower, upper = self.variables.bounds()
        late = timing_bound(self.plant, self.rows)
        timing = float(self.full[len(self.begin)])
        earliest, latest = (-late, late) if self.timed else (timing, timing)
        most = START_TIMES * max(float(np.max(np.abs(each.form.effort))) for each in self.rows)
        span = max(float(np.ptp(each.form.position)) for each in self.rows)
        reach = {"force": (-most, most), "hardening": (0.0, span)}
        reach |= {name: own.bounds for name, own in numbers(self.plant).items()}
        low = [reach[name][0] for _, name in self.starts]
        high = [reach[name][1] for _, name in self.starts]
        bounds = (
            np.concatenate([lower, [earliest], low]),
            np.concatenate([upper, [latest], high]),
        )
        begin = np.clip(self.full, *bounds)
        own = np.abs(begin[: len(self.begin)])
        # Where everything is 0, as a bend that is the one free number, nothing tells a size.
        size = np.where(own > 0.0, own, 1e-3 * (float(np.max(own, initial=0.0)) or 1.0))
        size[self.variables.logarithmic] = 1.0
        scale = np.concatenate([np.where(size > 0.0, size, 1.0), [late], self.usual])
        interrupted = False
        if len(self.shrunk):
            left = self.residual(begin)
            rows = sum(map(len, left)) + len(self.shrunk)
            pull = math.sqrt(SHRINKING * sum(float(own @ own) for own in left) / rows)
            held = zip(self.shrunk.tolist(), self.centres.tolist(), self.widths, strict=True)
            self.pulls = [(place, centre, pull / float(width)) for place, centre, width in held]
            self._best = None
        try:
            found = self.descend(begin, bounds, scale)
            for _ in range(escapes):
                normal = normal_matrix(self.slopes(found.x), self.pulls, len(found.x))
                beyond = escape(self.power, normal, found, bounds)
                if beyond is None:
                    break
                found = self.descend(beyond, bounds, scale)
            full, success = found.x, found.converged
            message = (
                "the fit has converged"
                if success
                else f"stopped after {self.most} evaluations: these are the best values so far"
            )
        except KeyboardInterrupt:
            if self._best is None:
                raise
            full, success, interrupted = self._best[1], False, True
            message = INTERRUPTED
        plant, nuisances = self.split(full)
        return Solution(
            plant,
            self.variables,
            full[: len(self.begin)],
            self.begin,
            nuisances,
            success,
            interrupted,
            message,
            self.evaluations,
            self._best[0] if self._best is not None else float("inf"),
            None if interrupted or not found.fresh else self._slopes,
        )

    def descend(
        self, begin: FloatArray, bounds: tuple[FloatArray, FloatArray], scale: FloatArray
    ) -> Minimum:
        """Follows the slopes from one point."""
        return descend(
            self.residual,
            self.slopes,
            begin,
            bounds,
            np.where(scale > 0.0, scale, 1.0),
            pulls=self.pulls,
            most=self.most,
            tolerance=self.converged,
            nothing=self.rounding,
            straight=not self.variables.paths,
            damping=BOLD if self.rows[0].form.simulated else FIRST_DAMPING,
        )

    @cached_property
    def rounding(self) -> float:
        """Σ w²·r² of residuals that are rounding alone."""
        efforts = [each.weight * each.form.whole(self.plant)[each.mask] for each in self.rows]
        return ROUNDED**2 * sum(float(own @ own) for own in efforts)

    def split(self, full: FloatArray) -> tuple[Plant, Nuisances]:
        """Plant and nuisances of a full vector."""
        count = len(self.begin)
        starts: dict[int, Start] = {}
        for (index, name), value in zip(self.starts, full[count + 1 :].tolist(), strict=True):
            starts.setdefault(index, {})[name] = value
        plant = self.variables.plant(self.plant, full[:count])
        return plant, Nuisances(float(full[count]), starts, self.leader)

    def residual(self, full: FloatArray) -> list[FloatArray]:
        """What is left of the rows of each recording."""
        self.power(full)
        return self._left(full)

    def power(self, full: FloatArray) -> float:
        """Sum of squares, that of the pulls among it; remembers the best vector."""
        power = sum(float(own @ own) for own in self._left(full))
        power += sum((weight * (full[place] - centre)) ** 2 for place, centre, weight in self.pulls)
        self.evaluations += 1
        if self._best is None or power < self._best[0]:
            self._best = (float(power), np.array(full))
        _logger.debug("evaluation %d: %g", self.evaluations, power)
        return float(power)

    def each(self, work: Callable[[Rows], Result]) -> list[Result]:
        """Some work on every recording, side by side where it takes longer than handing it over."""
        done = side_by_side(work, self.rows) if self.long else map(work, self.rows)
        return list(steps(done, "recording", len(self.rows)))

    @cached_property
    def long(self) -> bool:
        """Whether a residual of a recording takes much longer than what Python does about it."""
        samples = np.mean([len(each.form.position) for each in self.rows])
        return self.rows[0].form.simulated or bool(samples > LONG)

    def _left(self, full: FloatArray) -> list[FloatArray]:
        """What is left of the rows; kept, for a descent asks for its start once more."""
        if self._last is None or not np.array_equal(self._last[0], full):
            plant, nuisances = self.split(full)

            def left(rows: Rows) -> FloatArray:
                own = rows.residual(plant, nuisances)[rows.mask]
                own *= rows.weight
                # A runaway trial must look bad, not break the optimiser.
                return finite(own, RUNAWAY)

            self._last = np.array(full), self.each(left)
        return self._last[1]

    def slopes(self, full: FloatArray) -> Slopes:
        """Slopes of each recording by the parameters, and of these by the vector."""
        plant, nuisances = self.split(full)
        count, paths = len(self.begin), self.variables.paths
        self._slopes = self.each(lambda rows: slope_block(rows, plant, paths, nuisances))
        chain = np.eye(len(full))
        chain[:count, :count] = self.variables.chain(chain[:count, :count], full[:count])
        return self._slopes, chain
