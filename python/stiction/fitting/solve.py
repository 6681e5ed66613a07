"""The fit itself: weighted least squares on the weak-form effort residual."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from ..errors import InputError
from ..plant import Plant
from ..recording import Recording
from ..recording.blocks import FEWEST_BLOCKS, SHORT_SHARE, Part
from ..recording.split import BLOCK_S, split
from ..trajectory import FloatArray
from ..weak_form import WeakForm
from .result import FitParameter, FitResult
from .start import complete, free_paths
from .statistics import (
    CORRELATED_S,
    correlations,
    covariance,
    interval_width,
    undetermined_directions,
)
from .variables import Variables, unit_of

__all__ = ["fit"]

EVERY_S: Final = 0.005
"""Spacing of the residual: the kernel leaves nothing between."""
WARM_UP_S: Final = 0.2
"""Left out at the start of a recording: the friction starts from a state that nobody measured."""
MOST_EVALUATIONS: Final = 60
CONVERGED: Final = 1e-8
"""Change of cost, or of parameters, below which nothing more is gained: samples at rest go over
from stick to slip one by one, so the cost has tiny steps."""
AT_BOUND: Final = 1e-6
"""A value that has come this much of the way to its bound stands at it."""

_logger = logging.getLogger(__name__)


class _Block:
    """The rows of one recording that are fitted, and those that are held out."""

    def __init__(self, form: WeakForm, recording: Recording, index: int, parts: _Parts) -> None:
        self.form = form
        self.weight = 1.0
        warm = form.time >= recording.time[0] + WARM_UP_S
        self.train = warm & _rows(form, recording, index, parts.train)
        self.test = warm & _rows(form, recording, index, parts.test)
        spacing = form.dt * form.stride
        self.rows = max(1, round(CORRELATED_S / spacing))

    def residual(self, plant: Plant) -> FloatArray:
        measured, model = self.form.efforts(plant)
        return measured - model


@dataclass(frozen=True)
class _Parts:
    train: tuple[Part, ...]
    test: tuple[Part, ...]
    described: str


def fit(plant: Plant, session: Any, *, max_evaluations: int = MOST_EVALUATIONS) -> FitResult:
    """Fit a plant to the recordings of a session.

    Minimises Σ w²·r² over all rows but those that test (see ``Split``), r the measured effort
    minus what the plant needs along the measured motion, both through one kernel, with the exact
    Jacobian. Recordings are weighted by the residual that a first pass leaves in each.

    Parameters
    ----------
    plant : Plant
        Stated numbers are starting values; what is not stated of the core of the law starts from
        the data. Fixed parameters, optional terms that are not stated, and everything in [drive],
        [sensor] and [controller] stay.
    session : Session, or sequence of Recording, or Recording
    max_evaluations : int
        Evaluations of the residual at most.

    Returns
    -------
    FitResult
        With ``success`` False and the best values so far after Ctrl-C or too many evaluations.

    Raises
    ------
    InputError
        Nothing to fit: no recordings, no motion, no free parameter, too few rows.
    """
    recordings = [session] if isinstance(session, Recording) else list(session)
    if not recordings:
        raise InputError("there are no recordings to fit; give at least one")
    forms = [WeakForm(plant, recording, every=EVERY_S) for recording in recordings]
    parts = _deal(recordings, max(form.kernel.support for form in forms))
    blocks = [
        _Block(form, recording, index, parts)
        for index, (form, recording) in enumerate(zip(forms, recordings, strict=True))
    ]
    fitted = [block for block in blocks if block.train.any()]
    if not fitted:
        raise InputError("no rows are left to fit after the warm-up; give longer recordings")
    start = complete(plant, [block.form for block in fitted])
    paths = free_paths(start)
    if not paths:
        raise InputError(f"{plant.source}: every parameter is fixed; free at least one to fit")
    variables = Variables.of(start, paths)
    begin = variables.vector(np.array([start.parameters[path].value for path in paths]))
    optimiser = _Optimiser(start, variables, fitted, max_evaluations)
    vector = optimiser.run(begin)
    if len(fitted) > 1 and not optimiser.interrupted:
        optimiser.reweight(vector)
        vector = optimiser.run(vector)
    return _result(start, variables, vector, begin, blocks, optimiser, parts.described)


def _deal(recordings: Sequence[Recording], support: float) -> _Parts:
    """Which rows are fitted and which held out."""
    only = recordings[0]
    if len(recordings) == 1 and only.duration < FEWEST_BLOCKS * BLOCK_S * (1.0 - SHORT_SHARE):
        whole = Part(0, 0, len(only))
        told = f"The recording lasts {only.duration:.3g} s: all of it is fitted, none held out."
        return _Parts((whole,), (), told)
    dealt = split(recordings, edge_s=min(support, 0.25 * BLOCK_S))
    # Only a diagnosis needs rows to decide on: a fit uses them to fit.
    return _Parts((*dealt.train, *dealt.select), dealt.test, dealt.describe())


def _rows(
    form: WeakForm, recording: Recording, index: int, parts: Sequence[Part]
) -> np.ndarray[Any, np.dtype[np.bool_]]:
    chosen = np.zeros(len(form), dtype=bool)
    for part in parts:
        if part.recording == index:
            first, last = recording.time[part.start], recording.time[part.stop - 1]
            chosen |= (form.time >= first) & (form.time <= last)
    return chosen


class _Optimiser:
    """Trust-region least squares that remembers the best vector it saw."""

    def __init__(
        self, plant: Plant, variables: Variables, blocks: Sequence[_Block], most: int
    ) -> None:
        self.plant, self.variables, self.blocks, self.most = plant, variables, blocks, most
        self.evaluations = 0
        self.interrupted = False
        self.message = ""
        self.success = False
        self._best: tuple[float, FloatArray] | None = None

    def run(self, begin: FloatArray) -> FloatArray:
        from scipy.optimize import least_squares

        self._best = None
        size = np.maximum(np.abs(begin), 1e-3 * np.max(np.abs(begin)) * (begin == 0.0))
        try:
            found = least_squares(
                self.residual,
                begin,
                jac=self.jacobian,
                bounds=self.variables.bounds(),
                x_scale=np.where(size > 0.0, size, 1.0),
                max_nfev=self.most,
                ftol=CONVERGED,
                xtol=CONVERGED,
                gtol=1e-14,
            )
        except KeyboardInterrupt:
            if self._best is None:
                raise
            self.interrupted, self.success = True, False
            self.message = "interrupted: these are the best values so far"
            return self._best[1]
        self.success = bool(found.status > 0)
        self.message = (
            "the fit has converged"
            if self.success
            else f"stopped after {self.most} evaluations: these are the best values so far"
        )
        return np.asarray(found.x)

    def residual(self, vector: FloatArray) -> FloatArray:
        plant = self.variables.plant(self.plant, vector)
        rows = [b.weight * b.residual(plant)[b.train] for b in self.blocks]
        # A runaway trial must look bad, not break the optimiser.
        residual: FloatArray = np.nan_to_num(np.concatenate(rows), nan=1e6, posinf=1e6, neginf=-1e6)
        self.evaluations += 1
        power = float(residual @ residual)
        if self._best is None or power < self._best[0]:
            self._best = (power, np.array(vector))
        _logger.debug("evaluation %d: %g", self.evaluations, power)
        return residual

    def jacobian(self, vector: FloatArray) -> FloatArray:
        plant = self.variables.plant(self.plant, vector)
        rows = [b.weight * self.columns(plant, b) for b in self.blocks]
        columns: FloatArray = np.nan_to_num(self.variables.chain(np.vstack(rows), vector))
        return columns

    def columns(self, plant: Plant, block: _Block) -> FloatArray:
        columns: FloatArray = block.form.jacobian(plant, self.variables.paths)[block.train]
        return columns

    def reweight(self, vector: FloatArray) -> None:
        plant = self.variables.plant(self.plant, vector)
        sizes = [float(np.sqrt(np.mean(b.residual(plant)[b.train] ** 2))) for b in self.blocks]
        floor = 0.1 * max(sizes)
        for block, size in zip(self.blocks, sizes, strict=True):
            block.weight = 1.0 / max(size, floor, 1e-300)


def _result(
    start: Plant,
    variables: Variables,
    vector: FloatArray,
    begin: FloatArray,
    blocks: Sequence[_Block],
    optimiser: _Optimiser,
    described: str,
) -> FitResult:
    plant = variables.plant(start, vector)
    fitted = optimiser.blocks
    jacobians = [block.weight * optimiser.columns(plant, block) for block in fitted]
    residuals = [block.weight * block.residual(plant)[block.train] for block in fitted]
    matrix, pieces = covariance(jacobians, residuals, [block.rows for block in fitted])
    flat = undetermined_directions(jacobians, variables.paths)
    dead = {path for group in flat for path in group}
    values, starts = variables.values(vector), variables.values(begin)
    errors = np.sqrt(np.maximum(np.diag(matrix), 0.0))
    sides = _sides(variables, vector, begin, errors)
    width = interval_width(pieces)
    parameters = {}
    for k, path in enumerate(variables.paths):
        error = float("inf") if path in dead else float(np.sqrt(max(matrix[k, k], 0.0)))
        value = float(values[k])
        parameters[path] = FitParameter(
            value=value,
            stderr=error,
            ci95=(value - width * error, value + width * error),
            unit=unit_of(plant, path),
            at_bound=sides[k],
            start=float(starts[k]),
        )
    train = _errors(plant, [(block, block.train) for block in fitted])
    held = [(block, block.test) for block in blocks if block.test.any()]
    heldout = _errors(plant, held) if held else None
    return FitResult(
        plant=plant,
        parameters=parameters,
        covariance=matrix,
        correlations=correlations(matrix),
        bounds_hit=_bound_sentences(parameters),
        undetermined=_undetermined_sentences(parameters, flat, blocks),
        r2=train[2],
        train_rms=train[0],
        train_relative=train[1],
        heldout_rms=heldout[0] if heldout else None,
        heldout_relative=heldout[1] if heldout else None,
        unit=plant.effort_unit,
        split=described,
        success=optimiser.success,
        message=optimiser.message,
        evaluations=optimiser.evaluations,
    )


def _sides(
    variables: Variables, vector: FloatArray, begin: FloatArray, errors: FloatArray
) -> list[str]:
    """Where each variable stands: "lower", "upper" or "" for inside its bounds."""
    lower, upper = variables.bounds()
    sides = []
    for value, start, low, high, error in zip(vector, begin, lower, upper, errors, strict=True):
        # Near means near compared with where the fit came from and with what the data tell:
        # boxes can be 1e15 wide.
        near = AT_BOUND * max(abs(start), error if np.isfinite(error) else 0.0)
        if np.isfinite(low) and value - low <= max(near, AT_BOUND * abs(low)):
            sides.append("lower")
        elif np.isfinite(high) and high - value <= near:
            sides.append("upper")
        else:
            sides.append("")
    return sides


def _errors(
    plant: Plant, rows: Sequence[tuple[_Block, np.ndarray[Any, np.dtype[np.bool_]]]]
) -> tuple[float, float, float]:
    """rms, relative 2-norm and r² over some rows."""
    measured, residual = [], []
    for block, chosen in rows:
        effort, model = block.form.efforts(plant)
        measured.append(effort[chosen])
        residual.append((effort - model)[chosen])
    u, r = np.concatenate(measured), np.concatenate(residual)
    power = float(r @ r)
    about_mean = float(np.sum((u - u.mean()) ** 2))
    norm = float(np.linalg.norm(u))
    return (
        float(np.sqrt(power / len(r))),
        float(np.sqrt(power)) / norm if norm > 0.0 else float("inf"),
        1.0 - power / about_mean if about_mean > 0.0 else float("nan"),
    )


def _bound_sentences(parameters: dict[str, FitParameter]) -> tuple[str, ...]:
    return tuple(
        f"{path} ended at its {p.at_bound} bound, {p.value:.6g} {p.unit}: widen the bound, or the "
        "data pull it where it has no meaning"
        for path, p in parameters.items()
        if p.at_bound
    )


def _undetermined_sentences(
    parameters: dict[str, FitParameter],
    flat: Sequence[Sequence[str]],
    blocks: Sequence[_Block],
) -> tuple[str, ...]:
    sentences = []
    for group in flat:
        if len(group) == 1:
            sentences.append(f"{group[0]} is not determined by these data{_why(group[0], blocks)}")
        else:
            names = ", ".join(group)
            sentences.append(
                f"only a combination of {names} is determined by these data: fix one of them, or "
                "record what separates them"
            )
    told = {path for group in flat for path in group}
    for path, p in parameters.items():
        if path not in told and p.stderr > abs(p.value) and p.value != 0.0:
            sentences.append(
                f"{path} is not determined by these data: its standard error {p.stderr:.2g} "
                f"exceeds its value{_why(path, blocks)}"
            )
    return tuple(sentences)


def _why(path: str, blocks: Sequence[_Block]) -> str:
    speeds = np.concatenate([np.abs(block.form.velocity[block.train]) for block in blocks])
    moving = speeds[speeds > 0.0]
    if len(moving) == 0:
        return ": nothing moves"
    if "stribeck" in path:
        low = float(np.quantile(moving, 0.05))
        return f": 95 % of the speeds recorded are above {low:.3g}"
    if path.endswith(("viscous", "quadratic")):
        return f": no speed above {float(moving.max()):.3g} was recorded"
    return ""
