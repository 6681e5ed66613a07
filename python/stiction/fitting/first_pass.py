"""The first pass of a fit: from starts that the data give, by the residual that they allow."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Generic, Protocol, TypeVar

import numpy as np

from ..errors import InputError
from ..plant import Plant
from ..weak_form import WeakForm
from .forms import followable, horizon_of, shows_its_ring, stiffen
from .minimise import Solution, launch, or_from, stopped
from .pushes import Watch
from .rows import Rows
from .start import complete, free_paths, lightly_held

__all__ = ["FirstPass", "Seen", "first_pass"]

_logger = logging.getLogger(__name__)


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


S = TypeVar("S", bound=Seen)


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
    simulated: Callable[[Plant, float | None, bool, Watch], S],
    *,
    most: int,
) -> FirstPass[S]:
    """Fit a plant to rows of the weak form, and simulated where these do not do.

    Where readings turn out too coarse to drive friction (see ``horizon_of``), the fit goes on from
    there with the plant simulated over short windows. Of a servo it goes on with the simulated
    loop: what its law makes of the measured motion may never have been its effort.

    Parameters
    ----------
    plant : Plant
    seen : Seen
        Recordings through the kernels of the weak form.
    simulated : callable
        The same recordings for a plant, a length of windows in s (None without windows), whether
        the loop of a servo is simulated, and the watch of ``seen``.
    most : int
        Evaluations of the residual at most, of each start.

    Raises
    ------
    InputError
        No start along which the plant gives numbers.
    """
    starts = complete(plant, [each.form for each in seen.train])
    paths = free_paths(starts[0])
    found = launch(starts, paths, seen.train, most=most)
    known = FirstPass(seen, found, starts[0])
    if found.interrupted:
        return known
    try:
        return _simulated(plant, known, paths, simulated, most=most)
    except KeyboardInterrupt:
        # Before what is simulated had anything to keep.
        return replace(known, solution=stopped(found))


def _simulated(
    plant: Plant,
    known: FirstPass[S],
    paths: Sequence[str],
    simulated: Callable[[Plant, float | None, bool, Watch], S],
    *,
    most: int,
) -> FirstPass[S]:
    """What is known, fitted on by what is simulated where the weak form does not do."""
    seen, found, start = known.seen, known.solution, known.start
    horizon = horizon_of(found.plant, found.nuisances, seen.train, seen.forms)
    servo = plant.servo
    if horizon is not None or servo:
        _logger.info("fitting it again, simulated")
        other = simulated(found.plant, horizon, servo, seen.watch)
        # Along the measured motion a servo that is not yet understood may lead anywhere.
        begun = [found.plant, start] if servo else [found.plant]
        begun = [followable(each, other.forms) for each in begun]
        again = launch(begun, paths, other.train, most=most)
        if servo:
            light = lightly_held(plant, start, [rows.form for rows in seen.train])
            again = or_from([light], again, other.train, most=most)
        again = replace(again, begin=found.begin, evaluations=found.evaluations + again.evaluations)
        if servo or (
            shows_its_ring(again.plant, other.forms) and _lost(again, other.train) is None
        ):
            seen, found = other, again
            stiffen(seen.forms, found.plant)
        else:
            found = replace(found, evaluations=again.evaluations)
            if again.interrupted:
                found = stopped(found)
    lost = None if found.interrupted else _lost(found, seen.train)
    if lost is not None:
        raise InputError(
            f"{plant.source}: simulated with what was fitted, the plant runs away from every start "
            f"that the data give, in recording {lost + 1}; state starting values in [friction] "
            "nearer to the machine, or bounds for them"
        )
    return FirstPass(seen, found, start)


def _lost(solution: Solution, rows: Sequence[Rows]) -> int | None:
    """The first recording in which what is left are no numbers: a simulation may run away."""
    for each in rows:
        left = each.residual(solution.plant, solution.nuisances)[each.mask]
        if not np.all(np.isfinite(left)):
            return each.index
    return None
