"""The base: the plant as it is stated, fitted to the rows of train."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from ...errors import InputError, NotEnoughData
from ...fitting.first_pass import (
    WORTH_WIDER,
    Along,
    FirstPass,
    first_pass,
    is_better_led,
    remaining_share,
)
from ...fitting.forms import Through, astray, wider_of, windows_of
from ...fitting.minimise import MOST_EVALUATIONS
from ...fitting.pushes import Watch
from ...fitting.readings import readings_mislead
from ...fitting.rows import count_by
from ...fitting.sign import sign_error
from ...fitting.solve import fit_remainder, second_pass
from ...plant import Plant
from ...recording import Recording
from ..data.evidence import Evidence
from .model import Known, Model, fit_model

__all__ = [
    "fit_baseline",
    "fit_baseline_over_windows",
    "fit_joint_baseline",
    "fit_simulated_baseline",
    "fit_wider_baseline",
]

LOST: Final = 1e-3
"""An inertia that shrinks to this share of what the plant states, or of what the motion told at
first, is gone."""
SHOWS: Final = 0.3
"""Share of the residual that it would move, from which on it would have shown."""


def fit_baseline(
    plant: Plant,
    recordings: Sequence[Recording],
    *,
    wide: bool = False,
    joined: bool = False,
    windows: bool | None = None,
    yielding: bool = False,
    along: Model | None = None,
) -> tuple[Evidence, Model]:
    """A session and the base that is fitted to its rows of train.

    The way is that of `stiction.fit`: a first pass from starts that the data give, a second with
    recordings weighted by what the first left in each. Wider kernels (see ``wider_of``) are tried
    with ``wide`` alone: what a cause explains through narrow ones must not be averaged away.
    ``joined`` as in ``Evidence``, ``windows`` and ``yielding`` as in ``first_pass``; ``along`` is a
    base that was fitted along the readings before, of the same plant, its rows that test unopened.

    Returns
    -------
    Evidence
        Seen through the residual that was chosen.
    Model
        After Ctrl-C the best so far, and its solution is interrupted.

    Raises
    ------
    NotEnoughData
        As for ``Evidence``; a base that lost the inertia that the motion shows.
    """
    first = _first(
        plant,
        recordings,
        wide=wide,
        joined=joined,
        windows=windows,
        yielding=yielding,
        along=along,
    )
    return _second(plant, first)


def _first(
    plant: Plant,
    recordings: Sequence[Recording],
    *,
    wide: bool,
    joined: bool,
    windows: bool | None,
    along: Model | None,
    yielding: bool = False,
) -> FirstPass[Evidence]:
    """The first pass of a base."""

    def again(found: Plant, through: Through, watch: Watch) -> Evidence:
        return Evidence(found, recordings, through=through, watch=watch, joined=joined)

    return first_pass(
        plant,
        Evidence(plant, recordings, joined=joined) if along is None else along.evidence.anew(),
        again,
        most=MOST_EVALUATIONS,
        wide=wide,
        windows=windows,
        yielding=yielding,
        along=None if along is None else along.along,
    )


def _second(plant: Plant, first: FirstPass[Evidence]) -> tuple[Evidence, Model]:
    """The base after its second pass, as `fit_baseline` returns it."""
    evidence = first.seen
    solution = second_pass(first.solution, evidence.train, most=MOST_EVALUATIONS)
    count_by(solution.plant, evidence.forms)
    evidence.weigh()
    others = evidence.simulated or evidence.leads
    narrow = not (others or any(form.widened for form in evidence.forms))
    # Slopes of a first pass are those of other weights.
    ended = Along(first.start, replace(first.solution, slopes=None)) if narrow else None
    base = Model(evidence, solution, along=ended)
    if not solution.interrupted:
        _refuse_what_does_not_move(evidence, first.start, base, plant)
    return evidence, base


def fit_wider_baseline(
    plant: Plant,
    recordings: Sequence[Recording],
    narrow: Model,
    final: Model,
) -> tuple[Evidence, Model] | None:
    """The base through wider kernels, where these alone show the inertia; None elsewhere.

    Parameters
    ----------
    plant : Plant
        As it is stated.
    recordings : sequence of Recording
    narrow : Model
        The base through narrow kernels.
    final : Model
        With all causes that were found through these: where they explain what is left, nothing is
        to be averaged away.

    Returns
    -------
    (Evidence, Model) or None
        After Ctrl-C whatever is there, and its solution is interrupted.
    """
    evidence = narrow.evidence
    if wider_of(final.plant, final.nuisances, evidence.train, evidence.forms) is None:
        return None
    try:
        along = _along(narrow, plant)
        first = _first(plant, recordings, wide=True, joined=False, windows=None, along=along)
        widened = any(form.widened for form in first.seen.forms)
        if not (widened or first.solution.interrupted):
            return None
        other, base = _second(plant, first)
    except InputError:
        # What was found through narrow kernels stands.
        return None
    if base.solution.interrupted:
        return other, base
    left = remaining_share(final, evidence.train)
    return (other, base) if remaining_share(base, other.train) < WORTH_WIDER * left else None


def fit_simulated_baseline(
    plant: Plant,
    recordings: Sequence[Recording],
    base: Model,
    final: Model,
    followed: list[Model],
    tried: Sequence[Model] = (),
) -> tuple[Evidence, Model, list[Known]] | None:
    """The base simulated over windows, where a rigid contact was led astray; None elsewhere.

    What a cause leaves out hides what the readings do to friction that is led along them. Beside
    all causes that were found it is asked again, and beside each that was tried: along readings
    that lead astray another one may explain more.

    Parameters
    ----------
    plant : Plant
        As it is stated.
    recordings : sequence of Recording
    base : Model
        Of the weak form.
    final : Model
        With all causes that were found.
    followed : list of Model
        What readings were found not to lead astray: of those nobody asks again, and more are added.
    tried : sequence of Model
        The base with one cause each, whether it was accepted or not.

    Returns
    -------
    (Evidence, Model, list of Known) or None
        The last are the models above as a simulation has them, what leaves least first. After
        Ctrl-C whatever is there, and the solution of the base is interrupted.
    """
    evidence = base.evidence
    if plant.friction.springy:
        return _fit_led_baseline(plant, recordings, base, final)
    # Where the last cause makes the contact yield, the others tell nothing against that.
    horizon = windows_of(final.plant, evidence.forms, evidence.train)
    # The last model was tried as well, and fitted on to its end: that is the same one.
    others = [model for model in tried if _forms_of(model.plant) != _forms_of(final.plant)]
    begun = [
        model
        for model in (final, *others)
        if model.plant.effects != plant.effects
        and windows_of(model.plant, evidence.forms, evidence.train) is not None
    ]
    if horizon is None or not begun:
        return None
    if len(begun) == 1 and any(model is begun[0] for model in followed):
        return None
    try:
        led = _led_astray(recordings, evidence, begun, Through(horizon=horizon), followed)
        if led is None:
            return None
        return *fit_baseline(plant, recordings, windows=True, along=_along(base, plant)), led
    except InputError:
        # What was found along the readings stands.
        return None


def _fit_led_baseline(
    plant: Plant, recordings: Sequence[Recording], base: Model, final: Model
) -> tuple[Evidence, Model, list[Known]] | None:
    """The base of a contact that yields, along motions of its own; None where that changes little.

    Parameters and return value are those of ``fit_simulated_baseline``.
    """
    seen = base.evidence
    if seen.leads or seen.simulated:
        return None
    if final.plant.effects == plant.effects or not readings_mislead(
        final.plant, final.nuisances, seen.train
    ):
        return None
    try:
        evidence, led = fit_baseline(plant, recordings, windows=True, along=_along(base, plant))
        if led.solution.interrupted:
            return evidence, led, []
        if not evidence.leads:
            return None
        other = fit_model(evidence, final.plant, final.nuisances)
    except InputError:
        # What was found along the readings stands.
        return None
    left = remaining_share(other, evidence.train), remaining_share(final, seen.train)
    if not is_better_led(*left):
        return None
    return evidence, led, [Known(other.plant, other.nuisances)]


def _along(base: Model, plant: Plant) -> Model | None:
    """The base, where another one of a plant begins as it did."""
    evidence = base.evidence
    alike = evidence.plant is plant and not evidence.joined
    return base if alike and base.along is not None else None


def _forms_of(plant: Plant) -> list[tuple[str, tuple[str, ...]]]:
    """Effects of a plant and what they state."""
    return [(effect.name, tuple(effect.parameters)) for effect in plant.effects]


def _led_astray(
    recordings: Sequence[Recording],
    evidence: Evidence,
    begun: Sequence[Model],
    through: Through,
    followed: list[Model],
) -> list[Known] | None:
    """Models as a simulation has them, what leaves least first; None where none was led astray.

    The windows of this question are let go of: those that the base goes on with are others.
    """
    windows = Evidence(begun[0].plant, recordings, through=through, watch=evidence.watch)
    own = [(fit_model(windows, each.plant, each.nuisances), each) for each in begun]
    best, led = min(own, key=lambda pair: pair[0].power)
    if not best.solution.interrupted and not astray(
        led.plant,
        led.nuisances,
        evidence.train,
        (best.plant, best.solution.nuisances),
        windows.train,
    ):
        followed.append(led)
        return None
    models = sorted((each for each, _ in own), key=lambda model: model.power)
    return [Known(model.plant, model.nuisances) for model in models]


def fit_baseline_over_windows(
    plant: Plant, recordings: Sequence[Recording], base: Model, final: Model
) -> tuple[Evidence, Model] | None:
    """The base simulated over windows, whatever that leaves; None where it cannot be.

    Parameters
    ----------
    plant : Plant
        As it is stated.
    recordings : sequence of Recording
    base : Model
        Of the weak form.
    final : Model
        The same fitted along the readings, with all causes that were found.
    """
    evidence = base.evidence
    if windows_of(final.plant, evidence.forms, evidence.train, yielding=True) is None:
        return None
    try:
        simulated = fit_baseline(
            plant, recordings, windows=True, yielding=True, along=_along(base, plant)
        )
    except InputError:
        return None
    return simulated if simulated[0].simulated else None


def fit_joint_baseline(
    plant: Plant,
    recordings: Sequence[Recording],
    evidence: Evidence,
) -> tuple[Evidence, Model] | None:
    """The base that is fitted to the rows that decide as well; seen as before.

    None where these rows cannot be left out in turn, or no such base describes the machine. After
    Ctrl-C its solution is interrupted.
    """
    wide = any(form.widened for form in evidence.forms)
    windows = evidence.simulated or evidence.leads or None
    try:
        return fit_baseline(
            plant,
            recordings,
            wide=wide,
            joined=True,
            windows=windows,
            yielding=evidence.simulated,
        )
    except InputError:
        return None


def _refuse_what_does_not_move(
    evidence: Evidence, begin: Plant, base: Model, stated: Plant
) -> None:
    """Refuses a base that lost its inertia although the motion would show it.

    What is left then is no machine, and every effect that makes the input vanish helps.
    """
    if "body.inertia" not in base.solution.variables.paths:
        return
    known, found = begin.inertia, base.plant.inertia
    accelerations = evidence.stack(lambda rows: rows.form.accelerations(rows.form.readings))
    moved = known * float(np.sqrt(np.mean(accelerations**2)))
    left = float(np.sqrt(np.mean(base.residual**2)))
    if found < LOST * known and moved > SHOWS * left:
        hint = sign_error(stated, evidence.recordings, fit_remainder).rstrip(".")
        raise NotEnoughData(
            f"of an inertia of {known:.3g} the fit leaves {found:.2g}, though the accelerations "
            "would show it: input and motion do not belong together; check their columns, units, "
            "signs and clocks, or state [body] inertia as fixed" + (f". {hint}" if hint else "")
        )
