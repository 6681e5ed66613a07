"""Every recording beside both models, row by row: what a page lets its reader walk through."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from ..._support.arrays import FloatArray
from ...errors import InputError
from ...fitting.rows import Nuisances, Rows
from ...plant import Plant
from ...residual.effort import free_run
from ..data.evidence import Evidence
from ..data.gain import HeldOut
from .pictures import ROLES, Trace

if TYPE_CHECKING:
    from ...closed_loop import ClosedLoop
    from ..selection.search import Search

__all__ = ["traces_of", "with_loops"]

MOST_REFUSED: Final = 8
"""Refused effects of which it is kept what they would explain: the likelier ones."""
AWAY: Final = 2.0
"""A simulated position stays within the measured range and so many times its width on either side:
of what has run away it does not matter by how far."""

_Begun = tuple[Plant, Nuisances]


def traces_of(evidence: Evidence, test: HeldOut | None, selection: Search) -> tuple[Trace, ...]:
    """All recordings of which rows are used, in their order.

    Parameters
    ----------
    evidence : Evidence
        Its rows that test are open, where there are any.
    test : HeldOut or None
        What the models of the selection leave there, in their order.
    selection : Search
    """
    models = [
        (model.plant, model.nuisances if test is None else test.nuisances[place])
        for place, model in enumerate(selection.models)
    ]
    causes = [choice.winner.name for choice in selection.choices]
    refused = _refused(selection, models[0], {*causes})
    rows = {each.index: each for each in (*evidence.shown, *(() if test is None else test.rows))}
    roles = _roles(evidence, test)

    def trace(index: int) -> Trace:
        own = rows[index]
        left = [own.residual(*each) for each in models]
        gone = {name: left[k] - left[k + 1] for k, name in enumerate(causes)}
        gone |= {name: left[0] - own.residual(*each) for name, each in refused.items()}
        found = _beside(evidence, own, models, left)
        return replace(found, role=roles[index], contributions=gone)

    return tuple(evidence.each(trace, sorted(rows)))


def with_loops(
    traces: tuple[Trace, ...],
    evidence: Evidence,
    before: Mapping[int, ClosedLoop | None],
    after: Mapping[int, ClosedLoop | None],
) -> tuple[Trace, ...]:
    """The same with positions under the controller, where both loops could be simulated."""
    found = []
    by_name = {name: index for index, name in enumerate(evidence.names)}
    for trace in traces:
        index = by_name[trace.name]
        one, two = before.get(index), after.get(index)
        if one is not None and two is not None and trace.simulated is None:
            started = evidence.recordings[index].time[0]
            both = [np.interp(trace.time + started, run.time, run.simulated) for run in (one, two)]
            first, second = (_kept(each, trace.position) for each in both)
            trace = replace(trace, simulated=(first, second), loop=True)
        found.append(trace)
    return tuple(found)


def _beside(evidence: Evidence, rows: Rows, models: list[_Begun], left: list[FloatArray]) -> Trace:
    """A recording and its models; what its rows are used for comes later."""
    form, started = rows.form, evidence.recordings[rows.index].time[0]
    base, final = models[0][0], models[-1][0]
    position = np.interp(form.time, form.stamps, form.readings)
    if form.stiffness is not None:
        simulated: tuple[FloatArray, FloatArray] | None = (
            _kept(position - left[0] / form.stiffness, position),
            _kept(position - left[-1] / form.stiffness, position),
        )
    else:
        simulated = _freely(evidence, rows, models[0], models[-1], position)
    return Trace(
        name=evidence.names[rows.index],
        time=form.time - started,
        position=position,
        velocity=form.velocity,
        effort=form.measured_effort(base),
        inertial=form.own(final).inertia * form.acceleration,
        before=left[0],
        after=left[-1],
        role=np.zeros(len(form.time), dtype=np.int8),
        simulated=simulated,
        loop=form.stiffness is not None,
        step=form.count or form.noise,
    )


def _freely(
    evidence: Evidence, rows: Rows, before: _Begun, after: _Begun, position: FloatArray
) -> tuple[FloatArray, FloatArray] | None:
    """Positions of both plants by the recorded input alone; None where that cannot be.

    Where a loop can be simulated that is what its owner simulates.
    """
    recording, form = evidence.recordings[rows.index], rows.form
    plant = before[0]
    controlled = bool(plant.controller) and "reference" in recording.channels
    if plant.prescribed_motion or recording.input is None or controlled:
        return None
    found = []
    for own, nuisances in (before, after):
        start = nuisances.start(rows.index)
        try:
            run = free_run(own, recording, start, clock=form.clock, path=form.path)
        except InputError:
            # Too stiff for its sample time: nobody can simulate it.
            return None
        found.append(_kept(np.interp(form.time, run.time, run.simulated), position))
    return found[0], found[1]


def _kept(simulated: FloatArray, measured: FloatArray) -> FloatArray:
    """A simulated position, no farther away than what can be drawn beside the measured one."""
    low, high = float(measured.min()), float(measured.max())
    room = AWAY * (high - low) or AWAY * abs(high) or 1.0
    finite = np.nan_to_num(simulated, nan=high + room, posinf=high + room, neginf=low - room)
    kept: FloatArray = np.clip(finite, low - room, high + room)
    return kept


def _roles(evidence: Evidence, test: HeldOut | None) -> dict[int, np.ndarray]:
    """What each row of each recording is used for."""
    roles: dict[int, np.ndarray] = {}
    begin = 0
    for rows in evidence.shown:
        own = roles.setdefault(rows.index, np.zeros(len(rows.mask), dtype=np.int8))
        end = begin + int(rows.mask.sum())
        fitted = evidence.fitted[begin:end]
        own[rows.mask] = np.where(fitted, ROLES.index("train"), ROLES.index("select"))
        begin = end
    for rows in () if test is None else test.rows:
        own = roles.setdefault(rows.index, np.zeros(len(rows.mask), dtype=np.int8))
        own[rows.mask] = ROLES.index("test")
    return roles


def _refused(selection: Search, base: _Begun, taken: set[str]) -> dict[str, _Begun]:
    """Models of the first round with an effect each that was not accepted."""
    plant, nuisances = base
    stated = {effect.name for effect in plant.effects}
    found: dict[str, _Begun] = {}
    for model in selection.tried:
        names = {effect.name for effect in model.plant.effects} - stated - taken
        if len(names) == 1 and model.plant.friction.law == plant.friction.law:
            # Where a recording that tests begins is as it is for the base.
            found.setdefault(names.pop(), (model.plant, model.nuisances.merge(nuisances)))
    return dict(list(found.items())[:MOST_REFUSED])
