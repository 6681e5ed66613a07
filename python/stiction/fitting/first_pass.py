"""The first pass of a fit: from starts that the data give, by the residual that they allow."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final, Generic, NamedTuple, Protocol, TypeVar

import numpy as np

from .._support.progress import phase
from ..errors import InputError
from ..plant import Plant
from ..recording.names import names_of
from ..residual.weak_form import WeakForm
from .forms import (
    ASTRAY,
    KERNELS,
    LEAST_LEFT,
    Through,
    astray,
    followable,
    horizon_of,
    restore_bounds,
    shows_its_ring,
    stiffen,
    wider_of,
    windows_of,
)
from .minimise import Solution, launch, or_from, with_interruption
from .pushes import Watch
from .readings import readings_mislead
from .rows import Nuisances, Rows, count_by
from .start import complete, free_paths, with_light_friction, yielding_starts

__all__ = [
    "WORTH_WIDER",
    "Along",
    "FirstPass",
    "Seen",
    "first_pass",
    "fit_from_data",
    "is_better_led",
    "remaining_share",
]

WORTH_CLINGING: Final = 0.9
"""Share of what else is left that a contact may leave at most which never breaks away."""

DROWNED: Final = 1.2
"""So many times the inertia must come out through wider kernels..."""
WORTH_WIDER: Final = 0.7
"""... and so much of the share that was left may be left by them: half of its power."""

STANDS: Final = 0.05
"""Share of the greatest speed up to which a machine does not move, here."""
QUICKER: Final = 1.5
"""Power left in the quicker half of the motion over that in the slower one, from which on it comes
from readings: a ripple of torque came to 0.8 to 1.0, angles read wrong to 1.7 and more."""

_logger = logging.getLogger(__name__)

PULLS: Final = (30.0, 60.0, 120.0, 240.0)
"""Rates, 1/s, at which the run of a plant is drawn to the readings: as over windows of 0.3 s, to as
over a kernel of 40 ms. The faster it is, the more counts shake it, and the less late it is by what
the plant lacks."""
LEADS_WELL: Final = 1.1
"""Share of the least that the fastest of them may leave, which is taken."""
LEADS: Final = 0.05
"""Share of the measured effort that it may leave there at most: the run of a plant that lacks more
is late by more than its pre-sliding, and leads itself astray."""

DILUTED: Final = 0.02
"""Share by which noise may pull down an inertia that is fitted along the run: with one that is too
low by more than a few hundredths the run is late, and a delay of the input makes up for it."""
INERTIA: Final = "body.inertia"


class Seen(Protocol):
    """Recordings through kernels."""

    @property
    def train(self) -> Sequence[Rows]:
        """Fitted rows."""

    @property
    def forms(self) -> Sequence[WeakForm]:
        """Of all recordings."""

    @property
    def watch(self) -> Watch:
        """Who looks out for pushes from outside."""


class Fitted(Protocol):
    """A plant that was fitted."""

    @property
    def plant(self) -> Plant:
        """With its values."""

    @property
    def nuisances(self) -> Nuisances:
        """What was fitted along."""


S = TypeVar("S", bound=Seen)


class Along(NamedTuple):
    """Where a first pass ended along the readings, through the kernels that it began with."""

    start: Plant
    """What the data gave to start from, before anything was fitted."""
    solution: Solution


@dataclass(frozen=True)
class FirstPass(Generic[S]):
    """Where the first pass ended.

    Attributes
    ----------
    seen : Seen
        Through the residual that was chosen.
    solution : Solution
        ``begin`` is where the first minimisation started, ``evaluations`` are all of this pass.
    start : Plant
        What the data gave to start from, before anything was fitted.
    """

    seen: S
    solution: Solution
    start: Plant


def first_pass(
    plant: Plant,
    seen: S,
    again: Callable[[Plant, Through, Watch], S],
    *,
    most: int,
    wide: bool = True,
    windows: bool | None = None,
    yielding: bool = False,
    along: Along | None = None,
) -> FirstPass[S]:
    """Fit a plant to rows of the weak form, and simulated where these do not do.

    Where readings turn out too coarse to drive friction (see ``horizon_of``), the fit goes on from
    there with the plant simulated over short windows. Of a servo it goes on with the simulated
    loop: what its law makes of the measured motion may never have been its effort. Where much is
    left and the inertia shows through wider kernels alone, it goes on with these (see
    ``wider_of``).

    Parameters
    ----------
    plant : Plant
    seen : Seen
        Recordings through the kernels of the weak form.
    again : callable
        The same recordings for a plant, what they are seen through, and the watch of ``seen``.
    most : int
        Evaluations of the residual at most, of each start.
    wide : bool
        Whether wider kernels may be tried.
    windows : bool, optional
        Whether readings mislead its friction, where that is known already: a rigid contact is to be
        simulated over windows then, and one that yields led by a motion of its own.
    yielding : bool
        Simulate one that yields over windows, too, where that is known.
    along : Along, optional
        Where a pass over the same rows ended that was not simulated: what it did is not done again.

    Raises
    ------
    InputError
        No start along which the plant gives numbers.
    """
    start, found = along or fit_from_data(plant, seen.train, most=most)
    known = FirstPass(seen, found, start)
    if found.interrupted:
        return known
    try:
        if along is None or windows:
            paths = found.variables.paths
            known = _simulated(
                plant, known, paths, again, most=most, windows=windows, yielding=yielding
            )
        if known.solution.interrupted or not wide:
            return known
        return _wider(plant, known, again, most=most)
    except KeyboardInterrupt:
        # Before what comes after had anything to keep.
        return replace(known, solution=with_interruption(known.solution))


def fit_from_data(
    plant: Plant,
    rows: Sequence[Rows],
    *,
    most: int,
    within: Callable[[Plant], Plant] = lambda start: start,
    hopeless: float = math.inf,
) -> tuple[Plant, Solution]:
    """Fit a plant to rows from what the data give to start from.

    Where much is left, a contact that never breaks away is tried too (``yielding_starts``). That
    comes after the others have ended, for it is slow to show where it leads. It must leave clearly
    less beside constants: such a contact keeps what it brought along for a whole recording, and
    so hides an offset that the other one leaves for all to see.

    Parameters
    ----------
    plant : Plant
    rows : sequence of Rows
    most : int
        Evaluations of the residual at most, of each start.
    within : callable
        What a start must be made to be followed.
    hopeless : float
        Where all starts leave more power than this after a few steps, that is the end.

    Returns
    -------
    Plant
        The likeliest start.
    Solution
    """
    forms = [each.form for each in rows]
    starts = complete(plant, forms)
    count_by(starts[0], forms)
    begun = [within(start) for start in starts]
    found = launch(begun, free_paths(begun[0]), rows, most=most, hopeless=hopeless)
    if found.interrupted or found.power > hopeless:
        return starts[0], found
    try:
        others = [within(start) for start in yielding_starts(plant, starts, forms)]
        if others:
            found = _or_clinging(others, found, rows, most=most)
    except KeyboardInterrupt:
        # Before there was anything to try.
        found = with_interruption(found)
    return starts[0], found


def _or_clinging(
    others: Sequence[Plant], found: Solution, rows: Sequence[Rows], *, most: int
) -> Solution:
    """The solution, or one with a contact that never breaks away where that leaves clearly less."""
    before = remaining_share(found, rows)
    if before < LEAST_LEFT:
        return found
    other = or_from(others, found, rows, most=most)
    if remaining_share(other, rows) < WORTH_CLINGING * before:
        return other
    kept = with_interruption(found) if other.interrupted else found
    return replace(kept, evaluations=other.evaluations)


def remaining_share(solution: Fitted, rows: Sequence[Rows]) -> float:
    """Share of the measured effort that is left beside a constant in each recording."""
    left, measured = 0.0, 0.0
    for each in rows:
        own = each.residual(solution.plant, solution.nuisances)[each.mask]
        left += each.weight**2 * float(np.sum((own - np.mean(own)) ** 2))
        effort = each.form.measured_effort(solution.plant)[each.mask]
        measured += each.weight**2 * float(effort @ effort)
    return float(np.sqrt(left / max(measured, 1e-300)))


def _simulated(
    plant: Plant,
    known: FirstPass[S],
    paths: Sequence[str],
    again: Callable[[Plant, Through, Watch], S],
    *,
    most: int,
    windows: bool | None,
    yielding: bool,
) -> FirstPass[S]:
    """What is known, fitted on by what is simulated where the weak form does not do."""
    seen, found, start = known.seen, known.solution, known.start
    servo = plant.servo
    tried = None
    if windows is not False:
        tried = windows_of(found.plant, seen.forms, seen.train, yielding=yielding)
    horizon = tried or horizon_of(found.plant, found.nuisances, seen.train, seen.forms)
    if horizon is not None or servo:
        phase(_logger, "fitting it again, simulated")
        other = again(found.plant, Through(horizon=horizon, loop=servo), seen.watch)
        # Along the measured motion a servo that is not yet understood may lead anywhere, and along
        # readings that mislead it a contact ends in a valley of these.
        begun = [found.plant, start] if servo or yielding else [found.plant]
        begun = [followable(each, other.forms) for each in begun]
        fitted = launch(begun, paths, other.train, most=most)
        if servo:
            light = with_light_friction(plant, start, [rows.form for rows in seen.train])
            fitted = or_from([light], fitted, other.train, most=most)
        better = (
            tried is None
            or windows
            or astray(
                found.plant,
                found.nuisances,
                seen.train,
                (fitted.plant, fitted.nuisances),
                other.train,
            )
        )
        fitted = _after(found, fitted)
        if servo or (
            better
            and shows_its_ring(fitted.plant, other.forms)
            and _lost(fitted, other.train) is None
        ):
            seen, found = other, fitted
            stiffen(seen.forms, found.plant)
        else:
            found = _kept(found, fitted)
    elif _may_be_misled(known, windows):
        seen, found = _led(known, paths, again, most=most, asks=not windows)
    lost = None if found.interrupted else _lost(found, seen.train)
    if lost is not None:
        named = names_of(seen.watch.recordings)[lost]
        raise InputError(
            f"{plant.source}: simulated with what was fitted, the plant runs away from every start "
            f"that the data give, in {named}; state starting values in [friction] "
            "nearer to the machine, or bounds for them"
        )
    return FirstPass(seen, found, start)


def _may_be_misled(known: FirstPass[S], windows: bool | None) -> bool:
    """Whether a contact that yields is to be tried along motions of its own."""
    found = known.solution
    if windows is False or found.interrupted or not found.plant.friction.springy:
        return False
    return bool(windows) or readings_mislead(found.plant, found.nuisances, known.seen.train)


def _led(
    known: FirstPass[S],
    paths: Sequence[str],
    again: Callable[[Plant, Through, Watch], S],
    *,
    most: int,
    asks: bool,
) -> tuple[S, Solution]:
    """What is known, fitted on along motions of its own where readings mislead its friction.

    ``asks`` is whether they do so is still to be asked. The plant that leads stays as windows have
    it: along its own motion a contact that yields may be as stiff as it likes, and a fit that was
    led by itself again and again would drift.
    """
    phase(_logger, "fitting it again, along motions of its own")
    seen, found = known.seen, known.solution
    over = _over_windows(known, paths, again, most=most)
    leader = found.plant if over is None else restore_bounds(over[1].plant, found.plant)
    other = again(found.plant, KERNELS, seen.watch)
    fits: list[tuple[float, float, Solution]] = []
    for pull in PULLS:
        for form in other.forms:
            form.lead(leader, pull)
        fitted = launch([leader], paths, other.train, most=most)
        fits.append((remaining_share(fitted, other.train), pull, fitted))
    least = min(share for share, _, _ in fits)
    share, pull, led = [each for each in fits if each[0] <= LEADS_WELL * least][-1]
    for form in other.forms:
        form.lead(leader, pull)
    if dilution(led, other.train) > DILUTED:
        # Over windows no acceleration is read.
        led_by = (found.plant, found.nuisances, seen.train)
        if over is not None and (
            not asks or astray(*led_by, (over[1].plant, over[1].nuisances), over[0].train)
        ):
            stiffen(over[0].forms, over[1].plant)
            return over[0], _after(found, over[1])
        return seen, _kept(found, led)
    if asks and not is_better_led(share, remaining_share(found, seen.train)):
        return seen, _kept(found, led)
    return other, _after(found, led)


def dilution(solution: Solution, rows: Sequence[Rows]) -> float:
    """Share by which noise of the readings pulls down an inertia that is fitted; 0 of a stated one.

    Accelerations are those of the readings, and what they hold of noise takes no effort (errors in
    variables): an inertia comes out too low by that share of what no other parameter explains.
    """
    paths = solution.variables.paths
    if INERTIA not in paths:
        return 0.0
    noise, sums = 0.0, np.zeros((len(paths), len(paths)))
    for each in rows:
        start = solution.nuisances.start(each.index)
        slopes = each.weight * each.form.jacobian(solution.plant, paths, start)[each.mask]
        sums += slopes.T @ slopes
        own = each.weight * each.form.noise * each.form.kernel.roughness
        noise += len(slopes) * own**2
    place = list(paths).index(INERTIA)
    others = [k for k in range(len(paths)) if k != place]
    beside = sums[np.ix_(others, [place])]
    explained, *_ = np.linalg.lstsq(sums[np.ix_(others, others)], beside, rcond=None)
    left = float(sums[place, place] - (beside.T @ explained).item())
    return noise / max(left, noise, 1e-300)


def is_better_led(led: float, along: float) -> bool:
    """Whether readings misled a contact, by the shares that it leaves led and along them."""
    return led < min(ASTRAY * along, LEADS)


def _over_windows(
    known: FirstPass[S],
    paths: Sequence[str],
    again: Callable[[Plant, Through, Watch], S],
    *,
    most: int,
) -> tuple[S, Solution] | None:
    """The session over windows and the plant that is fitted to these; None where there are none.

    Along readings that mislead it a fit ends in a valley of these.
    """
    plant, seen = known.solution.plant, known.seen
    horizon = windows_of(plant, seen.forms, seen.train, yielding=True)
    if horizon is None:
        return None
    other = again(plant, Through(horizon=horizon), seen.watch)
    begun = [followable(each, other.forms) for each in (plant, known.start)]
    fitted = launch(begun, paths, other.train, most=most)
    if not shows_its_ring(fitted.plant, other.forms) or _lost(fitted, other.train) is not None:
        return None
    return other, fitted


def _wider(
    plant: Plant, known: FirstPass[S], again: Callable[[Plant, Through, Watch], S], *, most: int
) -> FirstPass[S]:
    """What is known, fitted through wider kernels where these alone show the inertia.

    A quick torque that a law misses drowns the inertia too, and is averaged away with it: a
    diagnosis tries its causes first. What is as large in slow motion as in quick one, where errors
    of the readings grow with the speed, is left to be seen in any case.
    """
    seen, found = known.seen, known.solution
    support = wider_of(found.plant, found.nuisances, seen.train, seen.forms)
    if support is None or "body.inertia" not in found.variables.paths:
        return known
    phase(_logger, "fitting it again, through wider kernels")
    try:
        other = again(found.plant, Through(support=support), seen.watch)
        start, wide = fit_from_data(plant, other.train, most=most)
    except InputError:
        # Too little is left within wider edges, or it leads nowhere: what is known stands.
        return known
    wide = _after(found, wide)
    drowned = found.plant.inertia * DROWNED < wide.plant.inertia
    less = remaining_share(wide, other.train) < WORTH_WIDER * remaining_share(found, seen.train)
    if drowned and less and _grows(wide, seen.train) and _lost(wide, other.train) is None:
        return FirstPass(other, wide, start)
    return replace(known, solution=_kept(found, wide))


def _grows(solution: Solution, rows: Sequence[Rows]) -> bool:
    """Whether more is left in the quicker half of what moves."""
    left, speeds = [], []
    for each in rows:
        left.append(each.residual(solution.plant, solution.nuisances)[each.mask] ** 2)
        speeds.append(np.abs(each.form.velocity[each.mask]))
    power, speed = np.concatenate(left), np.concatenate(speeds)
    moves = speed > STANDS * float(np.max(speed))
    if not np.any(moves):
        return False
    quick = speed > float(np.median(speed[moves]))
    return float(np.mean(power[quick])) > QUICKER * float(np.mean(power[moves & ~quick]))


def _after(found: Solution, other: Solution) -> Solution:
    """The other one, with what was done before it."""
    evaluations = found.evaluations + other.evaluations
    return replace(other, begin=found.begin, evaluations=evaluations)


def _kept(found: Solution, other: Solution) -> Solution:
    """The one that was found, with what was done after it."""
    found = replace(found, evaluations=other.evaluations)
    return with_interruption(found) if other.interrupted else found


def _lost(solution: Solution, rows: Sequence[Rows]) -> int | None:
    """The first recording in which what is left are no numbers: a simulation may run away."""
    for each in rows:
        left = each.residual(solution.plant, solution.nuisances)[each.mask]
        if not np.all(np.isfinite(left)):
            return each.index
    return None
