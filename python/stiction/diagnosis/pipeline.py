"""The way of a diagnosis: checks, base, surrogates, selection, rest, gain, verdict."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from .. import __version__
from ..errors import InputError, NotEnoughData
from ..fitting.forms import told as residual_told
from ..fitting.pushes import told as pushes_told
from ..fitting.result import FitResult
from ..given import instance
from ..plant import Effect, Plant
from ..recording import Check, Recording
from ..recording.recording import recordings_of
from ..recording.split import name_of
from ..recording.usable import checks_of, usable
from ..session import Session
from ..trajectory import FloatArray
from .advice import advise
from .base import based
from .candidates import Scales, left_out, scales_of
from .ceiling import ceiling_of
from .confirm import confirmed, described, lost, lost_on_test
from .coordinates import Look, looks
from .evidence import Evidence
from .gain import HeldOut, gain_of, open_residuals
from .laws import THE_LAW, Rival, better_law, event_words, law_names, law_rows, rivals_of
from .listing import in_order
from .lone import lone_event
from .loop import borne_out, replayed
from .model import Model
from .noise import Noise
from .omnibus import Rest, rest
from .orders import open_orders
from .own import own_view
from .pictures import Pictures, Stretch
from .regression import refitted
from .remedies import meant
from .replay import centre, shared, surrogate_residuals
from .result import Cause, Diagnosis, ModelSummary, Unexplained
from .rounds import friction_of, search
from .selection import Search
from .verdict import relatives, unnamed, verdict_of
from .view import View
from .words import NO_COORDINATE, no_machine, push_words, sentence, what

__all__ = ["SURROGATES", "diagnose"]

SURROGATES: Final = 24
"""Replays of the base with noise; more make thresholds smoother and cost in proportion."""

TRAIN_IS_FITTED: Final = (
    "Parameters are fitted to the rows of train alone; stiction fit takes those of select as well "
    "and may end at values a little different."
)
"""Where a fit of the same session and the base differ; everything else they do alike."""

_logger = logging.getLogger(__name__)


def diagnose(
    plant: Plant | None,
    session: Session | Sequence[Recording] | Recording,
    *,
    without: Sequence[str] = (),
    laws: Sequence[str] = (),
    surrogates: int = SURROGATES,
    seed: int = 0,
    threads: int | None = None,
) -> Diagnosis:
    """Find out what a simulation of a machine is missing.

    The base is fitted to the rows of train, every effect of the catalogue is screened by its
    efficient score against surrogates of this very data set, the best are refitted and accepted on
    rows held out, until nothing passes. The gain is then measured once on rows that test.

    Parameters
    ----------
    plant : Plant or None
        Naming the law is enough; None takes that of the session.
    session : Session, sequence of Recording, or Recording
    without : sequence of str
        Effects that are not tried.
    laws : sequence of str
        Other laws to compare with the plant's, or ``("all",)``.
    surrogates : int
        Replays of the base with noise alone, from 4 on.
    seed : int
        Same data and seed, same findings, at any number of threads.
    threads : int, optional
        Recordings looked at side by side; as many as there are processors without it.

    Returns
    -------
    Diagnosis
        After Ctrl-C the best so far, with ``success`` False.

    Raises
    ------
    InputError
        An unknown effect or law, a number out of its bounds, no plant, no recordings, the same
        recording fitted and judged on.
    """
    began = time.perf_counter()
    whole = _session(session)
    machine = plant if plant is not None else whole.plant
    if machine is None:
        raise InputError('session: plant is missing; write plant = "plant.toml", or give one')
    instance(machine, Plant, "diagnose: plant", "a Plant, as Plant.load returns it")
    _check_numbers(surrogates, seed, threads)
    unwanted = left_out(without)
    others = law_names(laws, machine.friction.law)
    checks = checks_of(whole.recordings)
    data: dict[str, Any] = {
        "checks": [
            *({"recording": name, **c.to_dict()} for name, c in _repairs(whole)),
            *({"recording": name, **c.to_dict()} for name, c in checks),
        ],
        "split": None,
        "hashes": list(whole.hashes),
        "noise": [],
        "replicates": None,
        "residual": None,
    }
    found = Diagnosis(
        verdict="not_testable",
        sentence="",
        plant=machine,
        data=data,
        version=__version__,
        seed=seed,
    )
    usable, fault = _usable(checks, whole)
    if usable is None:
        found = replace(
            found, verdict="data_fault", sentence=fault, advice=advise((), (), (), checks, machine)
        )
    else:
        try:
            found = _testable(found, usable, unwanted, others, surrogates, threads, checks)
            found = replace(found, sentence=f"{found.sentence} {fault}".rstrip())
        except NotEnoughData as error:
            told = str(error)
            found = replace(found, sentence=f"These data cannot be tested: {told}.")
    return replace(found, seconds=time.perf_counter() - began)


def _session(session: Session | Sequence[Recording] | Recording) -> Session:
    if isinstance(session, Session):
        return session
    recordings = recordings_of(session, "diagnose")
    if not recordings:
        raise InputError("session: there are no recordings to diagnose; give at least one")
    return Session(recordings)


def _check_numbers(surrogates: int, seed: int, threads: int | None) -> None:
    for name, given, least in (
        ("surrogates", surrogates, 4),
        ("seed", seed, 0),
        ("threads", 1 if threads is None else threads, 1),
    ):
        if isinstance(given, bool) or not isinstance(given, int) or given < least:
            raise InputError(
                f"{name} = {given!r} is out of bounds: give a whole number from {least}"
            )


def _repairs(session: Session) -> list[tuple[str, Check]]:
    """What was mended on reading."""
    means = "these rows were filled in from their neighbours"
    return [
        (name_of(recording, index), Check("repair", "note", str(repair), means, ""))
        for index, recording in enumerate(session)
        for repair in recording.quality
    ]


def _usable(checks: Sequence[tuple[str, Check]], session: Session) -> tuple[Session | None, str]:
    """The recordings without a fault, None where too few are left, and in words what is wrong."""
    kept, told = usable(session.recordings, checks)
    if kept is None or len(kept) == len(session):
        return None if kept is None else session, told
    places = {k: j for j, k in enumerate(kept)}
    repeats = {
        places[k]: places[of]
        for k, of in session.replicates.items()
        if k in places and of in places
    }
    return Session([session.recordings[k] for k in kept], session.plant, repeats), told


def _testable(
    found: Diagnosis,
    session: Session,
    without: Sequence[str],
    others: Sequence[str],
    surrogates: int,
    threads: int | None,
    checks: Sequence[tuple[str, Check]],
) -> Diagnosis:
    """The diagnosis of data that can be used."""
    _logger.info("looking through %d recordings", len(session))
    _logger.info("fitting the base")
    evidence, base = based(found.plant, session.recordings, threads=threads)
    dealt = evidence.split.to_dict()
    told = [TRAIN_IS_FITTED] if evidence.split.select else []
    dealt["rules"] = [*dealt["rules"], *told]
    found = replace(found, split="\n".join([evidence.split.describe(), *told]))
    data = {
        **found.data,
        "split": dealt,
        "residual": residual_told([rows.form for rows in evidence.shown], base.plant),
    }
    _logger.info("replaying it with noise, %d times", surrogates)
    null, noises = _surrogates(evidence, base, surrogates, found.seed)
    data["noise"] = [_noise_entry(evidence, index, noise) for index, noise in noises.items()]
    _logger.info("screening the effects")
    selection = described(search(evidence, base, null, without=without), evidence, null)
    selection = borne_out(selection, evidence)
    rivals = [] if selection.interrupted else rivals_of(selection, others)
    # Every decision is taken: now, and once, the rows that test.
    _logger.info("opening the test rows")
    models = [*selection.models, *(rival.model for rival in rivals if rival.model is not None)]
    test = open_residuals(evidence, [(m.plant, m.nuisances) for m in models])
    first_rival = len(selection.models)
    selection = confirmed(selection, test, found.seed)
    final = selection.models[-1]
    clocks = session.starts
    scales = scales_of(evidence, base.plant)
    seen = looks(evidence, base.plant, clocks, scales.units["presliding"])
    bias, centred = centre(null)
    bias = shared(bias, base.residual, evidence.cells.recording)
    friction = friction_of(evidence, base)
    orders = scales.orders
    left = rest(evidence, seen, orders, final.residual - bias, centred, friction)
    before = left
    if final is not base:
        before = rest(evidence, seen, orders, base.residual - bias, centred, friction)
    causes = tuple(
        _own_views(
            evidence,
            seen,
            _effect(final.plant, choice.winner.name),
            [model.residual - bias for model in selection.models[k : k + 2]],
            centred,
            friction,
        )
        for k, choice in enumerate(selection.choices)
    )
    ends = (base.plant, base.nuisances), (final.plant, final.nuisances)
    ceiling = ceiling_of(evidence, session.replicates, ends)
    data["replicates"] = None if ceiling is None else ceiling.to_dict()
    found = _concluded(
        replace(found, data=data),
        evidence,
        selection,
        (before, left),
        causes,
        (first_rival, rivals),
        test,
        null,
        lambda: _surrogates(evidence, final, surrogates, found.seed)[0],
        checks,
    )
    found = _with_pushes(found, evidence)
    return replayed(replace(found, ceiling=ceiling), evidence, base, final)


def _surrogates(
    evidence: Evidence, model: Model, number: int, seed: int
) -> tuple[FloatArray, dict[int, Noise]]:
    """Residuals of a model that is right, shape (n, number), and the noise of each recording."""
    null, noises = surrogate_residuals(evidence, model.plant, model.nuisances, number, seed)
    # What a fit would have taken up is no sign of anything.
    return refitted(model.columns, null, evidence.fitted), noises


def _with_pushes(found: Diagnosis, evidence: Evidence) -> Diagnosis:
    """What was left out because something pushed the machine, in the sentence and the checks."""
    checks = pushes_told(evidence.pushes, evidence.names)
    if not checks:
        return found
    words = push_words(evidence.pushes, evidence.names)
    data = {
        **found.data,
        "checks": [
            *found.data["checks"],
            *({"recording": name, **c.to_dict()} for name, c in checks),
        ],
    }
    return replace(found, sentence=f"{found.sentence} {words}", data=data)


def _noise_entry(evidence: Evidence, index: int, noise: Noise) -> dict[str, Any]:
    return {
        "recording": evidence.names[index],
        "position": noise.position,
        "count": noise.count,
        "effort": noise.effort,
    }


def _concluded(
    found: Diagnosis,
    evidence: Evidence,
    selection: Search,
    rests: tuple[Rest, Rest],
    own: tuple[tuple[View, View], ...],
    compared: tuple[int, Sequence[Rival]],
    test: HeldOut | None,
    null: FloatArray,
    null_of_last: Callable[[], FloatArray],
    checks: Sequence[tuple[str, Check]],
) -> Diagnosis:
    """Verdict and words, from everything that was measured.

    ``compared`` holds the place of the first other law among the models that were tested, and the
    laws.
    """
    first_rival, rivals = compared
    base, final = selection.models[0], selection.models[-1]
    floor = _floor(evidence, null)
    scales = scales_of(evidence, base.plant)
    results = {id(m): _evaluated(m, scales) for m in (base, final)}
    baseline = _summary(evidence, base, results[id(base)], test, 0, floor)
    extended = _summary(evidence, final, results[id(final)], test, len(selection.choices), floor)
    better, own_law = better_law(rivals), base.plant.friction.law
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
            for path, p in results[id(final)].parameters.items()
            if path.startswith(f"effects.{record.name}.")
        }
        means, remedy = meant(record, final.plant)
        causes.append(
            Cause(
                name=record.name,
                family=record.family,
                decided=choice.decided and not others and better is None,
                look_alikes=(*rivals_left, *others),
                parameters=fitted_values,
                gain=None if test is None else gain_of(test, k, k + 1, found.seed),
                what=what(record, fitted_values, _effect(final.plant, record.name)),
                means=means,
                try_=remedy,
                coordinate=record.coordinate,
            )
        )
    gain = None
    if causes and test is not None:
        gain = gain_of(test, 0, len(causes), found.seed)
    unexplained = unnamed(evidence, selection, *rests, null, null_of_last)
    if better is not None and not causes and not unexplained:
        unexplained = (Unexplained(THE_LAW, better.beside),)
    left = lost(evidence, final, null)
    if left and not unexplained:
        unexplained = (Unexplained(NO_COORDINATE, left),)
    verdict = verdict_of(selection, unexplained, all(cause.decided for cause in causes))
    reason = "These data cannot be tested: the base imitates every effect, so none could be seen."
    event = None if causes else lone_event(evidence, final, test, 0)
    if event is not None and better is None:
        followed = event_words(rivals, base, event) if event.fitted else ""
        verdict, reason, unexplained = "not_testable", event.words() + followed, ()
    return replace(
        found,
        verdict=verdict,
        sentence=("" if better is None else f"{better.words(own_law, bool(causes))} ")
        + sentence(verdict, causes, gain, unexplained, reason)
        + no_machine(max(left, lost_on_test(test, len(causes), null)), bool(causes), verdict),
        plant=extended.plant,
        effects=tuple(causes),
        gain=gain,
        candidates=in_order(selection.rows.values(), selection.choices),
        laws=law_rows(
            rivals,
            first_rival,
            test,
            found.seed,
            beside=(base, event) if event is not None and event.fitted else None,
        ),
        baseline=baseline,
        extended=extended,
        unexplained=unexplained,
        advice=(
            *([] if better is None else [better.advice()]),
            *([] if event is None else [event.advice()]),
            *advise(causes, unexplained, selection.blind, checks, final.plant),
        ),
        success=not selection.interrupted,
        message=(
            "interrupted: this is the best so far"
            if selection.interrupted
            else "the diagnosis is complete"
        ),
        pictures=Pictures(
            stretches=_stretches(evidence, test, base, final),
            before=rests[0],
            after=rests[1],
            effort_unit=final.plant.effort_unit,
            position_unit=final.plant.position_unit,
            floor=floor,
            causes=own,
        ),
    )


def _own_views(
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


def _effect(plant: Plant, name: str) -> Effect:
    """The effect of a plant by its name."""
    return next(effect for effect in plant.effects if effect.name == name)


def _evaluated(model: Model, scales: Scales) -> FitResult:
    return replace(model.told, parameters=open_orders(model.told.parameters, scales))


def _summary(
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
    )


def _floor(evidence: Evidence, null: FloatArray) -> float:
    """rms of what noise and rounding leave over the rows fitted."""
    physical = (null / evidence.weights[:, None])[evidence.fitted]
    return float(np.sqrt(np.mean(physical**2)))


def _stretches(
    evidence: Evidence, test: HeldOut | None, base: Model, final: Model
) -> tuple[Stretch, ...]:
    """Held-out recordings with what both models leave; those of train where none tests."""
    rows = evidence.shown if test is None else test.rows
    stretches = []
    for each in rows:
        form, mask = each.form, each.mask
        both = [np.where(mask, each.residual(m.plant, m.nuisances), np.nan) for m in (base, final)]
        measured = np.where(mask, form.measured(base.plant), np.nan)
        started = evidence.recordings[each.index].time[0]
        stretches.append(
            Stretch(evidence.names[each.index], form.time - started, measured, both[0], both[1])
        )
    return tuple(
        sorted(stretches, key=lambda s: float(np.nansum(s.after**2) - np.nansum(s.before**2)))
    )
