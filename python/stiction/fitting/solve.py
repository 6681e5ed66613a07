"""The fit itself: weighted least squares on the weak-form effort residual."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from .._support.arrays import FloatArray
from .._support.given import instance, whole
from .._support.keywords import explain_keywords
from .._support.products import on_one_thread
from .._support.progress import phase, steps
from .._support.wording import plural
from .._support.workers import with_workers
from ..catalogue import effects
from ..errors import InputError
from ..plant import Plant
from ..plant.begins import begins
from ..plant.drive import assumed_gain
from ..recording import Recording
from ..recording.blocks import FEWEST_BLOCKS, SHORT_SHARE, Part
from ..recording.checks import without_failures
from ..recording.names import names_of
from ..recording.recording import recordings_of
from ..recording.session_clock import subset
from ..recording.split import BLOCK_S, split
from ..recording.usable import checks_of, usable
from ..session import Session, both_of
from .clock import bounded_plants, follows
from .first_pass import first_pass, fit_from_data, remaining_share
from .forms import KERNELS, Through, as_session, forms_of, restore_bounds
from .leading import refit_windows
from .minimise import (
    CONVERGED,
    MOST_EVALUATIONS,
    Solution,
    from_elsewhere,
    minimise,
    with_interruption,
)
from .pulls import pulls_of_readings, widen
from .pushes import Watch, push_checks
from .recording_starts import fit_starts, fit_turns
from .result import FitParameter, FitResult
from .rows import Nuisances, Rows, add_starts, count_by, require_motion, rows_of
from .sign import LEFT_WHERE_WRONG, sign_error
from .slopes import slopes
from .start import complete, free_paths
from .statistics import (
    correlations,
    covariance,
    echoes,
    interval_width,
    jackknife,
    undetermined_directions,
)
from .variables import RATIOS, Variables, states_bound, unit_of, with_effort_in
from .waves import amplitude_of, parts_of, waves_of

__all__ = ["evaluate", "fit", "reweight", "second_pass"]

_logger = logging.getLogger(__name__)

AT_BOUND: Final = 1e-6
"""A value that has come this much of the way to its bound stands at it."""
NEAR_BOUND: Final = 1e-3
"""And no value is at a bound that is further off than this share of the box."""
SELECT_IS_FITTED: Final = (
    "A fit decides nothing, so the rows of select are fitted as well; a diagnosis decides by them, "
    "fits those of train alone, and may end at values a little different."
)
"""The one thing in which a fit and the base of a diagnosis differ."""
AS_WELL: Final = 1.1
"""Times the power of a fit that one may leave which can be simulated with ease."""
USABLE: Final = 2.0
"""The same of a fit that cannot be simulated at all, which nobody can use."""
MOST_BOUNDED: Final = 3
"""So many numbers are tried for that."""
MOST_FOLLOWED: Final = {
    "friction.initial_stiffness": "the stiffest contact",
    "friction.damping": "the most damped contact",
}
"""What windows can follow up to an end that nobody stated."""
WEIGHT_FLOOR: Final = 0.1
"""A recording weighs at most this many times less residual than the worst one has."""


@dataclass(frozen=True)
class _Parts:
    train: tuple[Part, ...]
    test: tuple[Part, ...]
    described: str


class _Seen:
    """Recordings through kernels, and their rows that are fitted and held out."""

    def __init__(
        self,
        plant: Plant,
        recordings: Sequence[Recording],
        through: Through = KERNELS,
        watch: Watch | None = None,
    ) -> None:
        self.forms = forms_of(
            plant,
            recordings,
            lambda work, items: [work(item) for item in steps(items, "recording")],
            through,
        )
        self.parts = _deal(recordings, max(form.kernel.support for form in self.forms))
        fitted = {part.recording for part in self.parts.train}
        as_session(self.forms, recordings, set(range(len(self.forms))) - fitted)
        self.watch = watch or Watch(plant, self.forms, recordings, self.parts.train)
        self.pushes = sorted(
            (*self.watch.look(self.parts.train), *self.watch.look(self.parts.test)),
            key=lambda push: (push.recording, push.start),
        )
        self.train: list[Rows] = []
        self.held: list[Rows] = []
        for index, (form, recording) in enumerate(zip(self.forms, recordings, strict=True)):
            for chosen, own in ((self.train, self.parts.train), (self.held, self.parts.test)):
                mask = rows_of(form, recording, index, own, self.pushes)
                if mask.any():
                    chosen.append(Rows(plant, form, index, mask))
        require_motion(self.train, plant)


@on_one_thread
@explain_keywords
def fit(
    plant: Plant | Session | None, session: Any = None, *, max_evaluations: int = MOST_EVALUATIONS
) -> FitResult:
    """Fit a plant to the recordings of a session.

    Minimises Σ w²·r² over all rows but those that test (see ``Split``), r the measured effort
    minus what the plant needs along the measured motion, both through one kernel, with the exact
    Jacobian. Recordings are weighted by the residual that a first pass leaves in each. The state
    of friction at the first row of a recording and an offset of up to half a sample between input
    and position are fitted along as nuisances. Where the readings turn out too coarse to drive
    friction (see ``horizon_of``), the fit goes on from there with the plant simulated over short
    windows instead; where the inertia drowns in errors of the acceleration, through wider kernels
    (see ``wider_of``); a servo is simulated over whole recordings (see ``LoopForm``).

    Parameters
    ----------
    plant : Plant, or Session, or None
        A session alone, or None, takes the plant of the session. Stated numbers are starting
        values; what is not stated of the core of the law starts from the data. Fixed parameters,
        optional terms that are not stated, and everything in [drive], [sensor] and [controller]
        stay.
    session : Session, or sequence of Recording, or Recording
    max_evaluations : int
        Evaluations of the residual at most.

    Returns
    -------
    FitResult
        With ``success`` False and the best values so far after Ctrl-C or too many evaluations; a
        second Ctrl-C ends at once.

    Raises
    ------
    InputError
        Nothing to fit: no recordings, no motion, no free parameter, too few rows; a plant that
        runs away from every start.
    KeyboardInterrupt
        Ctrl-C before there is anything, or for the second time.
    """
    either, session = both_of(plant, session, "fit")
    machine = instance(either, Plant, "fit: plant", "a Plant, as Plant.load returns it")
    recordings = list(recordings_of(session, "fit"))
    if not recordings:
        raise InputError("there are no recordings to fit; give at least one")
    max_evaluations = whole(max_evaluations, "max_evaluations", least=0)
    with with_workers(None):
        found = _fitted(machine, recordings, max_evaluations)
        if not (found.success and found.train_relative > LEFT_WHERE_WRONG):
            return found
        hint = sign_error(machine, recordings, fit_remainder)
    return replace(found, split="\n".join(filter(None, (hint, found.split))))


def fit_remainder(plant: Plant, recordings: list[Recording]) -> float:
    """Share of the effort (2-norm) that a fit along the readings leaves, beside constants."""
    seen = _Seen(plant, recordings)
    _, found = fit_from_data(plant, seen.train, most=MOST_EVALUATIONS)
    return remaining_share(found, seen.train)


def _fitted(plant: Plant, recordings: list[Recording], max_evaluations: int) -> FitResult:
    recordings, faults = _without_faults(recordings)
    phase(_logger, "looking through %s", plural(len(recordings), "recording"))
    seen = _Seen(plant, recordings)
    if not free_paths(plant) and not free_paths(complete(plant, [r.form for r in seen.train])[0]):
        raise InputError(f"{plant.source}: every parameter is fixed; free at least one to fit")
    phase(_logger, "fitting %s", plant.friction.law)
    first = first_pass(
        plant,
        seen,
        lambda found, through, watch: _Seen(found, recordings, through, watch),
        most=max_evaluations,
    )
    seen, train = first.seen, first.seen.train
    begin, evaluations = first.solution.begin, first.solution.evaluations
    phase(_logger, "fitting it again, each recording with a weight of its own")
    solution = second_pass(first.solution, train, most=max_evaluations)
    if solution is not first.solution:
        evaluations += solution.evaluations
    names = names_of(recordings)
    pushed = [f"{name}: {c.what}; {c.means}." for name, c in push_checks(seen.pushes, names)]

    def said(found: Solution) -> FitResult:
        count_by(found.plant, seen.forms)
        told = evaluate(
            found,
            train,
            seen.held,
            given=plant,
            begin=begin,
            described="\n".join([*faults, *pushed, seen.parts.described]),
            evaluations=evaluations,
            names=names,
        )
        pulls = {} if found.interrupted else pulls_of_readings(found, train)
        return replace(told, parameters=widen(told.parameters, pulls))

    try:
        return said(solution)
    except KeyboardInterrupt:
        if solution.interrupted:
            raise
        return said(with_interruption(solution))


def _without_faults(recordings: list[Recording]) -> tuple[list[Recording], list[str]]:
    """The recordings that a diagnosis would use, and in words what is wrong with the others.

    Where too few are left, all of them: a fit says how well it does, whatever it is given.
    """
    kept, fault = usable(recordings, checks_of(recordings))
    if kept is None:
        told = fault.replace("cannot be used", "are fitted, though they have a fault")
        return without_failures(recordings), [told]
    return without_failures(subset(recordings, kept)), [fault] if fault else []


def second_pass(first: Solution, rows: Sequence[Rows], *, most: int) -> Solution:
    """The second pass, with recordings weighted by what the first left in each.

    A fit that was interrupted stays as it is. Fit and diagnosis both end here, so that the same
    rows give both the same machine.
    """
    if first.interrupted:
        return first
    try:
        known = fit_turns(first.plant, rows, first.nuisances)
        reweight(rows, first.plant, known)
        second = minimise(
            first.plant,
            first.variables.paths,
            rows,
            most=most,
            nuisances=add_starts(first.plant, rows, known),
        )
    except KeyboardInterrupt:
        # Before the second pass had anything to keep.
        return with_interruption(first)
    found = _followed(from_elsewhere(second, rows, most=most), rows, most=most)
    return refit_windows(found, rows, most=most, converged=CONVERGED)


def _followed(found: Solution, rows: Sequence[Rows], *, most: int) -> Solution:
    """The solution, or what leaves as little and its samples can follow (``bounded_plants``)."""
    if found.interrupted:
        return found
    others = []
    for plant in bounded_plants(found.plant, found.variables.paths, rows, found.nuisances)[
        :MOST_BOUNDED
    ]:
        try:
            other = minimise(
                plant, found.variables.paths, rows, most=most, nuisances=found.nuisances
            )
        except KeyboardInterrupt:
            return with_interruption(found)
        others.append(replace(other, begin=found.begin))
    best = min(others, key=lambda other: other.power, default=found)
    most_left = AS_WELL if follows(found.plant, rows, ease=1.0) else USABLE
    return best if best.power < most_left * found.power else found


def reweight(rows: Sequence[Rows], plant: Plant, nuisances: Nuisances) -> None:
    """Weights each recording by one over the residual that is left in it."""
    sizes = [_size(each.residual(plant, nuisances)[each.mask]) for each in rows]
    floor = WEIGHT_FLOOR * max(sizes)
    for each, size in zip(rows, sizes, strict=True):
        each.weight = 1.0 / max(size, floor, 1e-300)


def _size(residual: FloatArray) -> float:
    return float(np.sqrt(np.mean(residual**2)))


def _deal(recordings: Sequence[Recording], support: float) -> _Parts:
    """Which rows are fitted and which held out."""
    only = recordings[0]
    if len(recordings) == 1 and only.duration < FEWEST_BLOCKS * BLOCK_S * (1.0 - SHORT_SHARE):
        whole = Part(0, 0, len(only))
        described = (
            f"The recording lasts {only.duration:.3g} s: all of it is fitted, none held out."
        )
        return _Parts((whole,), (), described)
    dealt = split(recordings, edge_s=min(support, 0.25 * BLOCK_S), decides=False)
    described = dealt.describe().replace("select: nothing\n", "")
    if dealt.select:
        described += f"\n{SELECT_IS_FITTED}"
    return _Parts((*dealt.train, *dealt.select), dealt.test, described)


def evaluate(
    solution: Solution,
    train: Sequence[Rows],
    held: Sequence[Rows],
    *,
    given: Plant,
    begin: FloatArray,
    described: str,
    evaluations: int,
    names: Sequence[str],
) -> FitResult:
    """What a solution says: values, intervals, what was not determined, errors.

    Parameters
    ----------
    solution : Solution
    train, held : sequence of Rows
        Fitted and held-out rows.
    given : Plant
        What was asked for, with the bounds that were stated.
    begin : numpy.ndarray, shape (p,)
        Vector from which the first minimisation started.
    described : str
        The split in words.
    evaluations : int
    names : sequence of str
        Of the recordings.
    """
    plant, variables, nuisances = solution.plant, solution.variables, solution.nuisances
    paths = variables.paths
    jacobians = [slopes(each, plant, paths, nuisances) for each in train]
    residuals = [each.weight * each.residual(plant, nuisances)[each.mask] for each in train]
    matrix, pieces = covariance(jacobians, residuals, [each.per_block for each in train])
    matrix = matrix[: len(paths), : len(paths)]
    own = [j[:, : len(paths)] for j in jacobians]
    flat = undetermined_directions(own, paths)
    values, starts = variables.values(solution.vector), variables.values(begin)
    measured = [each.weight * each.form.measured_effort(plant)[each.mask] for each in train]
    pure = [unit_of(plant, path) == "1" for path in paths]
    found = echoes(own, measured, residuals, values, paths, pure)
    flat += [group for group in found if group not in flat]
    dead = {path for group in flat for path in group}
    errors = np.sqrt(np.maximum(np.diag(matrix), 0.0))
    sides = _sides(variables, solution.vector, begin, errors)
    width = interval_width(pieces)
    between = jackknife(jacobians, residuals)
    if between is not None:
        # Of the two ways to be wrong, the wider one, with the few degrees that recordings leave.
        wider = np.sqrt(np.diag(between)[: len(paths)]) * (interval_width(len(jacobians)) / width)
        errors = np.maximum(errors, wider)
    effort_unit = _effort_unit(plant, train)
    parameters = {}
    for k, path in enumerate(paths):
        error = float("inf") if path in dead else float(errors[k])
        value = float(values[k])
        parameters[path] = FitParameter(
            value=value,
            stderr=error,
            ci95=(value - width * error, value + width * error),
            unit=with_effort_in(effort_unit, plant, path),
            at_bound=sides[k],
            start=float(starts[k]),
        )
    fitted = _errors(plant, train, nuisances)
    trained = {each.index for each in train}
    others = [each for each in held if each.index not in trained]
    begun = fit_starts(plant, others, nuisances)
    heldout = _errors(plant, held, begun) if held else None
    stated = restore_bounds(plant, given)
    told = assumed_gain(given.drive, train[0].form.input_unit, given.si_effort_unit)
    return FitResult(
        plant=stated,
        parameters=parameters,
        covariance=matrix,
        correlations=correlations(matrix),
        bounds_hit=_bound_sentences(parameters, given, followed=stated != plant),
        undetermined=_undetermined_sentences(
            parameters, waves_of(parameters, matrix), flat, train, plant
        ),
        assumed=(told,) if told else (),
        r2=fitted[2],
        train_rms=fitted[0],
        train_relative=fitted[1],
        heldout_rms=heldout[0] if heldout else None,
        heldout_relative=heldout[1] if heldout else None,
        unit=effort_unit,
        stiffness=train[0].form.stiffness,
        split=described,
        success=solution.success,
        message=solution.message,
        interrupted=solution.interrupted,
        evaluations=evaluations,
        timing_offset=nuisances.timing,
        starts={names[index]: dict(start) for index, start in nuisances.starts.items()},
        begins=begins(names, [*train, *others], begun),
    )


def _effort_unit(plant: Plant, rows: Sequence[Rows]) -> str:
    """Unit of the efforts that were compared; that of a force where recordings differ in it."""
    seen = {each.form.effort_unit for each in rows}
    return seen.pop() if len(seen) == 1 else plant.effort_unit


def _sides(
    variables: Variables, vector: FloatArray, begin: FloatArray, errors: FloatArray
) -> list[str]:
    """Where each variable stands: "lower", "upper" or "" for inside its bounds."""
    lower, upper = variables.bounds()
    clamped = variables.bounds_hit(vector)
    sides: list[str] = []
    for value, start, low, high, error in zip(vector, begin, lower, upper, errors, strict=True):
        # Near means near compared with where the fit came from and with what the data tell:
        # boxes can be 1e15 wide.
        near = AT_BOUND * max(abs(start), error if np.isfinite(error) else 0.0)
        if np.isfinite(high - low):
            near = min(near, NEAR_BOUND * (high - low))
        if len(sides) in clamped:
            sides.append(clamped[len(sides)])
        elif np.isfinite(low) and value - low <= max(near, AT_BOUND * abs(low)):
            sides.append("lower")
        elif np.isfinite(high) and high - value <= near:
            sides.append("upper")
        else:
            sides.append("")
    return sides


def _errors(plant: Plant, rows: Sequence[Rows], nuisances: Nuisances) -> tuple[float, float, float]:
    """rms, relative 2-norm and r² over some rows."""
    whole, residual = [], []
    for each in rows:
        whole.append(each.form.whole(plant)[each.mask])
        residual.append(each.residual(plant, nuisances)[each.mask])
    u, r = np.concatenate(whole), np.concatenate(residual)
    power = float(r @ r)
    about_mean = float(np.sum((u - u.mean()) ** 2))
    norm = float(np.linalg.norm(u))
    return (
        float(np.sqrt(power / len(r))),
        float(np.sqrt(power)) / norm if norm > 0.0 else float("inf"),
        1.0 - power / about_mean if about_mean > 0.0 else float("nan"),
    )


def _bound_sentences(
    parameters: dict[str, FitParameter], given: Plant, *, followed: bool
) -> tuple[str, ...]:
    """What ended at a bound; ``followed``: a contact ends where windows stop following it.

    Only a bound that ``given`` states can be widened.
    """
    sentences = []
    for path, p in parameters.items():
        if not p.at_bound:
            continue
        value = f"{p.value:.6g}" + (f" {p.unit}" if p.unit != "1" else "")
        if path in MOST_FOLLOWED and p.at_bound == "upper" and followed:
            sentences.append(
                f"{path} ended at {value}, {MOST_FOLLOWED[path]} that can be simulated between "
                "these samples: record more often to tell it"
            )
        elif states_bound(given, path, p.at_bound):
            sentences.append(
                f"{path} ended at its {p.at_bound} bound, {value}: widen the bound, or the data "
                "pull it where it has no meaning"
            )
        elif (held := _held_beside(path, p.at_bound, parameters, given)) is not None:
            sentences.append(
                f"{path} ended at {value}, as near to {held} as a fit lets it come, which is held: "
                "these data show no difference of the two, or want the other order; free both"
            )
        elif p.at_bound == "lower" and p.value == 0.0:
            sentences.append(
                f"{path} ended at 0, below which it has no meaning: these data show nothing of it, "
                "or something that the model lacks pulls it down"
            )
        else:
            end = "least" if p.at_bound == "lower" else "greatest"
            sentences.append(
                f"{path} ended at {value}, the {end} that a fit lets it take: what pulls it there "
                "is something else that the model lacks, or data that do not tell it, so do not "
                "read the value as one of the machine; state it fixed where you know it"
            )
    return tuple(sentences)


def _held_beside(
    path: str, side: str, parameters: dict[str, FitParameter], given: Plant
) -> str | None:
    """The held one of an ordered pair against which the other one ended."""
    for lesser, greater in RATIOS.items():
        if (path, side) in ((lesser, "upper"), (greater, "lower")):
            other = greater if path == lesser else lesser
            if other not in parameters and other in given.parameters:
                return other
    return None


def _undetermined_sentences(
    parameters: dict[str, FitParameter],
    waves: dict[str, FitParameter],
    flat: Sequence[Sequence[str]],
    rows: Sequence[Rows],
    plant: Plant,
) -> tuple[str, ...]:
    unit = f"{plant.position_unit}/s"
    sentences = []
    for group in flat:
        if len(group) == 1:
            why = _why(group[0], rows, unit)
            sentences.append(f"{group[0]} is not determined by these data{why}")
        else:
            names = ", ".join(group)
            sentences.append(
                f"only a combination of {names} is determined by these data: fix one of them, or "
                "record what separates them"
            )
    told = {path for group in flat for path in group}
    # Of a wave the amplitude is asked: a small part of a large one is known as well as the other.
    whole = {
        path for path in parameters if (parts := parts_of(path)) and amplitude_of(parts) in waves
    }
    amplitudes = {path: p for path, p in waves.items() if "phase" not in path}
    for path, p in ({**parameters, **amplitudes}).items():
        if path not in told | whole and p.stderr > abs(p.value) and p.value != 0.0:
            sentences.append(
                f"{path} is not determined by these data: its standard error {p.stderr:.2g} "
                f"exceeds its value{_why(path, rows, unit)}"
            )
    return tuple(sentences)


def _why(path: str, rows: Sequence[Rows], unit: str) -> str:
    if path.startswith("effects.temperature") and all(r.form.temperature is None for r in rows):
        return ": no temperature was recorded"
    speeds = np.concatenate([np.abs(each.form.velocity[each.mask]) for each in rows])
    moving = speeds[speeds > 0.0]
    if len(moving) == 0:
        return ": nothing moves"
    falls = (word for each in effects() if each.falls for word in (each.name, *each.law_terms))
    if any(word in path for word in falls):
        low = float(np.quantile(moving, 0.05))
        return f": 95 % of the speeds recorded are above {low:.3g} {unit}"
    if path.endswith(("viscous", "quadratic")):
        return f": no speed above {float(moving.max()):.3g} {unit} was recorded"
    return ""
