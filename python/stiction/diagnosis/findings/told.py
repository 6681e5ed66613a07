"""Pieces of a diagnosis as they are told: causes, models in numbers, stretches to look at."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from ..._support.arrays import FloatArray
from ...fitting.pulls import widen
from ...fitting.result import FitResult
from ...plant import Plant
from ...plant.begins import begins
from ...plant.stated import Effect
from ..adequacy.coordinates import Look
from ..adequacy.view import View
from ..data.evidence import Evidence
from ..data.gain import HeldOut, gain_of
from ..records import Cause, ModelSummary
from ..screening.candidates import Scales
from ..screening.model import Model
from ..screening.orders import open_orders
from ..selection.search import Search
from .own import own_view
from .pictures import Stretch
from .remedies import meaning_of
from .verdict import relatives
from .words import what

__all__ = [
    "causes_of",
    "effect_of",
    "evaluate",
    "floor_of",
    "own_views",
    "stretches_of",
    "summary_of",
]


def causes_of(
    selection: Search, result: FitResult, test: HeldOut | None, seed: int, *, sole: bool
) -> list[Cause]:
    """What was accepted.

    ``result`` is that of the last model. ``sole``: no other law explains more; beside one that does
    nothing is decided.
    """
    final = selection.models[-1]
    causes = []
    taken = {choice.winner.name for choice in selection.choices}
    for k, choice in enumerate(selection.choices):
        record = choice.winner.candidate.record
        # A rival that became a cause of its own is told there.
        rivals_left = [each.name for each in choice.rivals if each.name not in taken]
        close = {each.name for each in choice.rivals}
        others = [name for name in relatives(selection, k) if name not in close]
        fitted_values = {
            path: p
            for path, p in result.parameters.items()
            if path.startswith(f"effects.{record.name}.")
        }
        waves = {
            path: p
            for path, p in result.waves.items()
            if path.startswith(f"effects.{record.name}.")
        }
        means, remedy = meaning_of(record, final.plant)
        effect = effect_of(final.plant, record.name)
        own = {f"effects.{record.name}.{name}": p.value for name, p in effect.parameters.items()}
        causes.append(
            Cause(
                name=record.name,
                family=record.family,
                decided=choice.decided and not others and sole,
                look_alikes=(*rivals_left, *others),
                parameters=fitted_values,
                gain=None if test is None else gain_of(test, k, k + 1, seed),
                what=what(record, result.parameters, effect, waves),
                means=means,
                try_=remedy,
                coordinate=record.coordinate,
                waves=waves,
                chosen={path: value for path, value in own.items() if path not in fitted_values},
                size=choice.winner.size,
            )
        )
    return causes


def own_views(
    evidence: Evidence,
    seen: Sequence[Look],
    effect: Effect,
    residuals: Sequence[FloatArray],
    null: FloatArray,
    friction: float,
) -> tuple[View, View]:
    """A cause in its own coordinate, before it is added and after."""
    before, after = (
        own_view(evidence, seen, effect, residual, null, friction) for residual in residuals
    )
    return before, after


def effect_of(plant: Plant, name: str) -> Effect:
    """The effect of a plant by its name."""
    return next(effect for effect in plant.effects if effect.name == name)


def evaluate(
    model: Model, scales: Scales, pulls: Mapping[str, float] = MappingProxyType({})
) -> FitResult:
    """What a fit says; intervals reach as far as the readings pull, and further for few periods."""
    told = widen(model.fit_result.parameters, pulls)
    return replace(model.fit_result, parameters=open_orders(told, scales))


def summary_of(
    evidence: Evidence,
    model: Model,
    result: FitResult,
    test: HeldOut | None,
    index: int,
    floor: float,
) -> ModelSummary:
    select = None
    if evidence.split.select:
        (plan,) = evidence.plans
        select = float(np.sqrt(np.mean((model.residual / evidence.weights)[plan.held] ** 2)))
    tested = {} if test is None else begins(evidence.names, test.rows, test.nuisances[index])
    return ModelSummary(
        plant=result.plant,
        parameters=result.parameters,
        unit=result.unit,
        train_rms=result.train_rms,
        select_rms=select,
        heldout_rms=None if test is None else test.rms(index),
        train_relative=result.train_relative,
        heldout_relative=None if test is None else test.relative(index),
        noise_floor_rms=floor,
        remarks=result.remarks,
        assumed=result.assumed,
        stiffness=result.stiffness,
        begins={**result.begins, **tested},
    )


def floor_of(evidence: Evidence, null: FloatArray) -> float:
    """rms of what noise and rounding leave over the rows fitted."""
    physical = (null / evidence.weights[:, None])[evidence.fitted]
    return float(np.sqrt(np.mean(physical**2)))


def stretches_of(
    evidence: Evidence, test: HeldOut | None, *models: tuple[Model, int]
) -> tuple[Stretch, ...]:
    """Held-out recordings with what both models leave; those of train where none tests.

    With each model its place among those that were tested.
    """
    rows = evidence.shown if test is None else test.rows
    base = models[0][0]
    begun = [
        (model.plant, model.nuisances if test is None else test.nuisances[place])
        for model, place in models
    ]
    stretches = []
    for each in rows:
        form, mask = each.form, each.mask
        both = [np.where(mask, each.residual(*own), np.nan) for own in begun]
        seen = form.measured_effort(base.plant) if form.stiffness is None else form.readings[1:]
        measured = np.where(mask, seen, np.nan)
        started = evidence.recordings[each.index].time[0]
        stretches.append(
            Stretch(evidence.names[each.index], form.time - started, measured, both[0], both[1])
        )
    return tuple(
        sorted(stretches, key=lambda s: float(np.nansum(s.after**2) - np.nansum(s.before**2)))
    )
