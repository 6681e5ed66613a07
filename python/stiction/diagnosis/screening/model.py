"""A plant fitted to the rows of train, what it leaves, and how its parameters change that."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np

from ..._support.arrays import FloatArray
from ...catalogue import effects
from ...fitting.angular import FLAT, Angular
from ...fitting.first_pass import Along
from ...fitting.leading import refit_windows
from ...fitting.levenberg import FIRST_DAMPING
from ...fitting.likeliest import likeliest
from ...fitting.minimise import Solution, minimise
from ...fitting.replay import NoReplayError, reread, simulate_alone
from ...fitting.result import FitResult
from ...fitting.rows import Nuisances, Rows, timing_is_free
from ...fitting.slopes import Block, places_of, slope_block, slopes
from ...fitting.solve import evaluate
from ...fitting.start import free_paths
from ...fitting.statistics import covariance, differ, jackknife
from ...plant import Plant
from ...plant.parameter import Parameter
from ...plant.stated import Effect
from ...residual.finite import finite
from ..data.evidence import Evidence, Plan
from ..data.influence import limit_influence
from .candidates import Candidate
from .folds import over_plans

__all__ = [
    "LEAST_GIVEN",
    "REFIT_CONVERGED",
    "Known",
    "Model",
    "fit_model",
    "likeliest_of",
    "step_beside",
    "with_effect",
    "with_last_free",
    "without_effect",
]

REFIT_EVALUATIONS: Final = 30
"""A refit starts from the base and an estimate of the gain: it needs few steps."""
REFIT_CONVERGED: Final = 1e-5
"""Of the power: a fifth of a standard error of any parameter."""
FARTHEST: Final = 7.0
"""Step of the logarithm of a parameter at most: of one that hardly tells, a step may be any."""
REPLAYS: Final = 8
"""Recordings in which a plant is right, to see what their noise gains."""
SEED: Final = 31
"""Of that noise: always the same."""
MOST_TAKEN: Final = 0.5
"""Effects that leave less than this share of the power that a drive gives are judged by what they
leave: what shrinks measured and needed effort alike explains nothing."""
LEAST_GIVEN: Final = 0.01
"""And what leaves less than this share explains nothing at all."""


class Known(NamedTuple):
    """A plant that was fitted, and what was fitted along, without the rows they were fitted to."""

    plant: Plant
    nuisances: Nuisances


@dataclass(frozen=True)
class Model:
    """A fitted plant and its residual.

    Attributes
    ----------
    evidence : Evidence
    solution : Solution
    known : Nuisances
        Where starts of recordings that decide are looked for from.
    along : Along or None
        Where the first pass of a base ended; None of what is no base, and where that was simulated.
    """

    evidence: Evidence
    solution: Solution
    known: Nuisances = field(default_factory=Nuisances)
    along: Along | None = None

    @property
    def plant(self) -> Plant:
        """The fitted plant."""
        return self.solution.plant

    @cached_property
    def nuisances(self) -> Nuisances:
        """The fitted nuisances, and the starts of recordings that decide."""
        return self.evidence.with_held_starts(self.plant, self.solution.nuisances, self.known)

    @cached_property
    def residual(self) -> FloatArray:
        """Weighted residual of the rows that may be looked at; shape (n,)."""
        return finite(self.evidence.residual(self.plant, self.nuisances))

    @cached_property
    def columns(self) -> Angular:
        """Derivatives of ``residual`` by what was fitted and does not stand at a bound."""
        return self._slopes(self.evidence.shown)

    def forget(self) -> None:
        """Lets go of the derivatives: they are found again where somebody asks."""
        self.__dict__.pop("columns", None)

    @cached_property
    def fitted_columns(self) -> Angular:
        """The same of the fitted rows alone."""
        if "columns" in self.__dict__:
            return self.columns.of_rows(self.evidence.fitted)
        if self.solution.slopes is None:
            return self._slopes(self.evidence.train)
        return self._angular(self.solution.slopes)

    def _slopes(self, rows: Sequence[Rows]) -> Angular:
        paths = self.solution.variables.paths
        # At the starts of all recordings, by those of the fitted ones.
        places, nuisances = places_of(self.solution.nuisances), self.nuisances
        return self._angular(
            self.evidence.each(lambda r: slope_block(r, self.plant, paths, nuisances, places), rows)
        )

    def _angular(self, blocks: Sequence[Block]) -> Angular:
        """Slopes of recordings as columns; that of a timing offset at its bound is 0."""
        shared = len(self.solution.variables.paths) + 1
        size = shared + len(places_of(self.solution.nuisances))
        columns = Angular.of_blocks(blocks, shared, size)
        free = timing_is_free(self.nuisances.timing, self.plant, self.evidence.train)
        return columns if free else columns.with_column(shared - 1, 0.0)

    @cached_property
    def fit_result(self) -> FitResult:
        """What the fit says: values and intervals."""
        return evaluate(
            self.solution,
            self.evidence.train,
            [],
            given=self.evidence.plant,
            begin=self.solution.begin,
            described=self.evidence.split.describe(),
            evaluations=self.solution.evaluations,
            names=self.evidence.names,
        )

    def knows(self, candidate: Candidate, *, whatever_shape: bool) -> bool:
        """Whether the gains of an effect, taken together, differ from 0 on both ways to be wrong.

        Over blocks of 1 s, and from one recording to the next. ``whatever_shape`` lets its shape be
        uncertain too; otherwise that is taken as it is, as in ``strength``.
        """
        paths = list(self.solution.variables.paths)
        own = [paths.index(f"effects.{candidate.name}.{name}") for name in candidate.gains]
        if not all(np.isfinite(self.fit_result.parameters[paths[k]].stderr) for k in own):
            return False
        train = self.evidence.train
        fitted_along = self.solution.nuisances
        jacobians = [slopes(each, self.plant, paths, fitted_along) for each in train]
        if not whatever_shape:
            for jacobian in jacobians:
                jacobian[:, self._shape_of(candidate)] = 0.0
        residuals = [
            each.weight * each.residual(self.plant, self.nuisances)[each.mask] for each in train
        ]
        ways = [covariance(jacobians, residuals, [each.per_block for each in train])]
        between = jackknife(jacobians, residuals)
        if between is not None:
            ways.append((between, len(train)))
        gains, part = self.gains(candidate), np.ix_(own, own)
        return all(differ(gains, matrix[part], pieces) for matrix, pieces in ways)

    def strength(self, candidate: Candidate) -> float:
        """Gains of an effect over their standard errors: √(γᵀC⁻¹γ), C over blocks of 1 s.

        Its shape is taken as it is: a gain and the time over which it comes are told apart by few
        recordings, and still there may be no doubt that something comes.
        """
        spread = self.gain_covariance(candidate)
        if spread is None:
            return 0.0
        # Gains of a slow machine differ by many powers of ten: each in units of its own error.
        errors = np.sqrt(np.maximum(np.diag(spread), 0.0))
        live = errors > 0.0
        gains = self.gains(candidate)[live] / errors[live]
        correlated = spread[np.ix_(live, live)] / np.outer(errors[live], errors[live])
        squared = float(gains @ np.linalg.pinv(correlated, hermitian=True) @ gains)
        return math.sqrt(max(squared, 0.0))

    def gain_covariance(self, candidate: Candidate) -> FloatArray | None:
        """Covariance of the gains of an effect over blocks of 1 s, its shape as it is.

        Shape (q, q); None where the rows that were fitted tell nothing of one of them.
        """
        paths = list(self.solution.variables.paths)
        own = [paths.index(f"effects.{candidate.name}.{name}") for name in candidate.gains]
        fit, block = self.evidence.fitted, self.evidence.cells.block
        columns, residual = self.fitted_columns, self.residual[fit]
        scale = columns.sizes
        scale[self._shape_of(candidate)] = 0.0
        live = np.flatnonzero(scale > 0.0)
        scaled = columns.scale(live, 1.0 / np.where(scale > 0.0, scale, 1.0))
        bread = np.linalg.pinv(scaled.normal(), rcond=FLAT, hermitian=True)
        _, index = np.unique(block[fit], return_inverse=True)
        power: FloatArray = np.bincount(index, residual**2).astype(np.float64)
        (kept,) = limit_influence(power)
        pushes = scaled.sums_by(index, residual)
        # A block in which the model has lost the machine would make every gain uncertain.
        pushes *= np.sqrt(kept / np.maximum(power, 1e-300))[:, None]
        spread = bread @ pushes.T @ pushes @ bread
        places = [int(np.flatnonzero(live == k)[0]) for k in own if k in live]
        if len(places) < len(own):
            return None
        found: FloatArray = spread[np.ix_(places, places)] / np.outer(scale[own], scale[own])
        return found

    def _shape_of(self, candidate: Candidate) -> list[int]:
        """Where what is fitted of an effect's shape stands among all that is fitted."""
        paths = list(self.solution.variables.paths)
        shapes = [f"effects.{candidate.name}.{candidate.own(name)}" for name in candidate.shape]
        return [paths.index(path) for path in shapes if path in paths]

    def gains(self, candidate: Candidate) -> FloatArray:
        """Fitted gains of an effect; shape (q,)."""
        effect = next(each for each in self.plant.effects if each.name == candidate.name)
        return np.array([effect.parameters[name].value for name in candidate.gains])

    def holdout_residuals(self, plans: Sequence[Plan]) -> list[FloatArray]:
        """Residual of the rows that each plan holds out, fitted on those that it fits.

        Where a plan fits all of train that is the residual itself; in a fold it is corrected by
        one Gauss-Newton step from the fit to all of train, less the step that all of train would
        take: a fit that stands at a bound stays there.
        """
        fitted, residual = self.evidence.fitted, self.residual
        folds = [plan for plan in plans if not np.array_equal(plan.fit, fitted)]
        if not folds:
            return [residual[plan.held] for plan in plans]
        everything = Plan(fitted, np.ones_like(fitted))
        whole, *others = (
            each.held[:, 0]
            for each in over_plans(self.columns, residual[:, None], [everything, *folds])
        )
        moved = iter(others)
        return [
            residual[plan.held]
            if np.array_equal(plan.fit, fitted)
            else next(moved) + residual[plan.held] - whole[plan.held]
            for plan in plans
        ]

    @cached_property
    def relative_input_power(self) -> float:
        """Power of what the drive gives, over that without effects; 1 where most of it is left.

        A dead band as wide as every input leaves no effort, and nothing to explain.
        """
        mapped = {record.name for record in effects() if "input map" in record.hooks}
        if mapped.isdisjoint(effect.name for effect in self.plant.effects):
            return 1.0
        bare = replace(self.plant, effects=())

        def power(plant: Plant) -> float:
            def driven(rows: Rows) -> FloatArray:
                start = self.nuisances.start(rows.index)
                return rows.form.mean(rows.form.along(plant, start)[0])

            return float(np.sum(finite(self.evidence.stack(driven)) ** 2))

        powers = power(self.plant), power(bare)
        left = powers[0] / powers[1] if powers[1] > 0.0 else 1.0
        return max(left, LEAST_GIVEN) if left < MOST_TAKEN else 1.0

    @cached_property
    def power(self) -> float:
        """Weighted power of the residual over the fitted rows, per that of what the drive gives."""
        own = self.residual[self.evidence.fitted]
        return float(own @ own) / self.relative_input_power

    @cached_property
    def replays(self) -> list[Model]:
        """The plant fitted to recordings that it made itself, each with noise of its own.

        Empty where none can be made (see ``reread``).

        Raises
        ------
        KeyboardInterrupt
        """
        found: list[Model] = []
        for number in range(REPLAYS):
            try:
                found.append(self._replay(number))
            except NoReplayError:
                return []
            if found[-1].solution.interrupted:
                raise KeyboardInterrupt
        return found

    def _replay(self, number: int) -> Model:
        plant, nuisances = self.plant, self.nuisances
        evidence = self.evidence.with_rows(
            lambda rows: reread(rows, plant, nuisances, [SEED, number, rows.index])
        )
        return fit_model(evidence, plant, nuisances)

    @cached_property
    def alone(self) -> Evidence | None:
        """The session as the plant would have made it by itself, read without noise.

        None where it cannot be made (see ``simulate_alone``).
        """
        plant, nuisances = self.plant, self.nuisances
        try:
            return self.evidence.with_rows(lambda rows: simulate_alone(rows, plant, nuisances))
        except NoReplayError:
            return None

    @cached_property
    def blocks(self) -> tuple[FloatArray, FloatArray]:
        """Power of the residual in each block of 1 s: fitted, and held out over all plans."""
        block = self.evidence.cells.block
        number = int(block.max()) + 1
        fit, held = self.evidence.fitted, np.zeros(number)
        train: FloatArray = np.zeros(number)
        train += np.bincount(block[fit], self.residual[fit] ** 2, number)
        plans = self.evidence.plans
        for plan, residual in zip(plans, self.holdout_residuals(plans), strict=True):
            held += np.bincount(block[plan.held], residual**2, number)
        return train / self.relative_input_power, held / self.relative_input_power


def fit_model(
    evidence: Evidence,
    plant: Plant,
    nuisances: Nuisances | None = None,
    *,
    only: str = "",
    most: int = REFIT_EVALUATIONS,
    converged: float = REFIT_CONVERGED,
) -> Model:
    """The plant fitted to the rows of train, with the weights these have.

    ``only`` names an effect whose parameters alone are varied, beside the nuisances.
    """
    paths = [p for p in free_paths(plant) if p.startswith(f"effects.{only}." if only else "")]

    solution = minimise(
        plant,
        paths,
        evidence.train,
        most=most,
        nuisances=None if nuisances is None else nuisances.of(evidence.training_recordings),
        converged=converged,
        # What is fitted here starts from a model that was fitted.
        beyond_kinks=False,
    )
    if not only:
        solution = refit_windows(solution, evidence.train, most=most, converged=converged)
    return Model(evidence, solution, nuisances or Nuisances())


def likeliest_of(evidence: Evidence, plants: Sequence[Plant], nuisances: Nuisances) -> Plant:
    """The plant that leaves the least weighted power in the rows of train."""

    def left(plant: Plant, rows: Rows) -> float:
        own = rows.weight * rows.residual(plant, nuisances)[rows.mask]
        return float(own @ own)

    return likeliest(plants, evidence.train, left)[0]


def step_beside(model: Model, explained: FloatArray) -> Plant:
    """The plant of a model, moved to where it is best once something else explains a part.

    One step over the fitted rows, in the variables of the fit and damped as the first one of a fit
    is: numbers that exchange for each other would go so far that no slope holds there. A refit that
    starts from here has little left to do. What the model leaves beside that part moves nothing: at
    a minimum with a kink slopes would lead far away from it.

    Parameters
    ----------
    model : Model
    explained : numpy.ndarray, shape (n,)
        Part of the residual that an effect takes over.
    """
    solution, fit = model.solution, model.evidence.fitted
    variables, number = solution.variables, len(solution.variables.paths)
    columns = model.columns.of_rows(fit)
    shared = columns.shared.copy()
    shared[:, :number] = variables.chain(shared[:, :number], solution.vector)
    columns = columns.with_common(shared)
    scale = columns.sizes
    scale[scale == 0.0] = 1.0
    columns = columns.scale(np.arange(columns.size), 1.0 / scale)
    normal = columns.normal() + FIRST_DAMPING * np.eye(len(scale))
    moved = np.linalg.solve(normal, columns.products(explained[fit])) / scale
    way = np.where(
        variables.logarithmic, np.clip(moved[:number], -FARTHEST, FARTHEST), moved[:number]
    )
    vector = np.clip(solution.vector + way, *variables.bounds())
    return variables.plant(model.plant, vector)


def without_effect(plant: Plant, name: str) -> Plant:
    """The plant without an effect."""
    return replace(plant, effects=tuple(each for each in plant.effects if each.name != name))


def with_effect(plant: Plant, candidate: Candidate, gains: Sequence[float]) -> Plant:
    """The plant with one more effect, or a second wave of one, which starts from these gains.

    What lies beyond the bounds of the catalogue starts at its bound: a multiple of an estimated
    gain, or an estimate for a second wave, which may be less large than a first one.
    """
    bounds = {p.name: p.bounds for p in candidate.record.parameters}
    parameters = {}
    for name, value, reach in zip(candidate.gains, gains, candidate.bounds, strict=True):
        narrower = reach if reach != bounds[name] else (None, None)
        parameters[name] = Parameter(float(np.clip(np.nan_to_num(value), *reach)), *narrower)
    for name, value in candidate.shape.items():
        low, high = candidate.limits.get(name, (None, None))
        fixed = name not in candidate.free or name in candidate.last_shapes
        own = candidate.own(name)
        parameters[own] = Parameter(float(np.clip(value, *bounds[own])), low, high, fixed=fixed)
    kept = []
    for effect in plant.effects:
        if candidate.second and effect.name == candidate.name:
            parameters = {**effect.parameters, **parameters}
        else:
            kept.append(effect)
    return replace(plant, effects=(*kept, Effect(candidate.name, parameters)))


def with_last_free(plant: Plant, candidate: Candidate) -> Plant:
    """The plant with the shapes free that a candidate varies last."""
    effect = next(each for each in plant.effects if each.name == candidate.name)
    free = {name: replace(effect.parameters[name], fixed=False) for name in candidate.last_shapes}
    freed = Effect(effect.name, {**effect.parameters, **free})
    effects = tuple(freed if each is effect else each for each in plant.effects)
    return replace(plant, effects=effects)
