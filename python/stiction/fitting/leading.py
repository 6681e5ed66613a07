"""Fits whose windows begin in the motion of the plant that is fitted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from .minimise import Solution, minimise, with_interruption
from .rows import Rows

__all__ = ["refit_windows"]

MOST_LED: Final = 2
"""Times that windows begin anew: what the plant before was late by has gone a hundredfold then."""
ENOUGH: Final = 0.05
"""Change of the power from which on they do once more: the next one is a hundredth of it."""


def refit_windows(
    found: Solution, rows: Sequence[Rows], *, most: int, converged: float
) -> Solution:
    """A solution, fitted on with windows that begin in the motion of its own plant.

    Windows of a rigid contact begin in a run that a plant makes near the measured motion, late by
    what this plant lacks (see ``ShootingForm``). Led by another one a plant that lacks nothing
    leaves what the other one lacks, and a fit is pulled towards it. So each is led by itself, in
    turn with the fit, until that changes little.

    Parameters
    ----------
    found : Solution
        Of a fit along any motion; what was interrupted stays as it is.
    rows : sequence of Rows
    most : int
        Evaluations of the residual at most, each time.
    converged : float
        Relative change of cost or parameters at which each of them ends.
    """
    if not any(each.form.leads for each in rows):
        return found
    for _ in range(MOST_LED):
        if found.interrupted:
            break
        led = replace(found.nuisances, leader=found.plant)
        try:
            further = minimise(
                found.plant,
                found.variables.paths,
                rows,
                most=most,
                nuisances=led,
                converged=converged,
                beyond_kinks=False,
            )
        except KeyboardInterrupt:
            # Before it had anything to keep.
            return with_interruption(found)
        settled = abs(further.power - found.power) <= ENOUGH * found.power
        evaluations = found.evaluations + further.evaluations
        found = replace(further, begin=found.begin, evaluations=evaluations)
        if settled:
            break
    return found
