"""Passivity: whether a contact ever gives back more than it took."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from ..defaults import PASSIVE_STEPS
from ..measured import Measured, Property
from ..subject import Subject

__all__ = ["PASSIVE", "passive"]

_EPISODE: Final = 400  # steps
_LEAST: Final = 0.02
_SHORT: Final = 1e-6
_FINER: Final = 16


def passive(subject: Subject, steps: int = PASSIVE_STEPS) -> Measured:
    """Random motion of a contact that was never moved; the work it took must not fall below 0.

    A quarter of the episodes repeat a random cycle, so that a law that gains a little in each
    cycle gains much. Steps are short beside the pre-sliding distance, speeds span ten decades.
    """
    rng = np.random.default_rng(1)
    worst, done, given_back = 0.0, 0, 0
    episodes = max(2, steps // _EPISODE)
    for episode in range(episodes):
        moves, speeds = _motion(rng, subject.length, episode % 4)
        least, most = _work(subject, moves, speeds)
        done += len(moves)
        unit = subject.scale.level * subject.length
        if _gives_back(least, most, unit):
            # A quadrature that errs does so less with finer steps; a law that gives back goes on.
            least, most = _work(subject, moves, speeds, parts=_FINER)
            if _gives_back(least, most, unit):
                given_back += 1
                worst = min(worst, float(least / unit))
    return Measured(
        given_back == 0,
        {"random steps": float(done),
         "episodes that gave back more than they took, share": given_back / episodes,
         "greatest energy given, levels times spans": abs(worst)},
    )  # fmt: skip


def _gives_back(least: float, most: float, unit: float) -> bool:
    return least < -_LEAST * most - _SHORT * unit


def _motion(rng: np.random.Generator, length: float, kind: int) -> tuple[list[float], list[float]]:
    """Displacements and speeds of the steps of one episode.

    Kinds 0 and 2 wander, 1 repeats a random cycle, 3 goes one way, slowly and fast in turn: what
    a slow slide has wound up is where a fast one may take more than it gave.
    """
    moves: list[float] = []
    speeds: list[float] = []
    slowest = length * 10.0 ** rng.uniform(-2.0, 3.0)
    reach = length * 10.0 ** rng.uniform(-1.5, 1.5)

    def leg(way: float, speed: float) -> None:
        parts = min(40, max(4, math.ceil(abs(way) / (0.05 * length))))
        moves.extend([way / parts] * parts)
        speeds.extend([speed] * parts)

    if kind == 3:
        faster = 10.0 ** rng.uniform(1.0, 6.0)
        while len(moves) < _EPISODE:
            leg(length * rng.uniform(1.0, 4.0), slowest)
            leg(length * rng.uniform(0.3, 3.0), slowest * faster)
        return moves, speeds
    legs = int(rng.integers(2, 7)) if kind == 1 else _EPISODE
    while len(moves) < _EPISODE and legs > 0:
        legs -= 1
        leg(
            reach * rng.uniform(0.1, 1.0) * rng.choice((-1.0, 1.0)),
            slowest * 10.0 ** rng.uniform(0.0, 5.0),
        )
    if kind == 1:
        leg(-math.fsum(moves), slowest)
        repeats = max(2, _EPISODE // len(moves))
        moves, speeds = moves * repeats, speeds * repeats
    return moves, speeds


def _work(
    subject: Subject, moves: list[float], speeds: list[float], parts: int = 1
) -> tuple[float, float]:
    """Least and greatest work that a fresh contact has taken on the way."""
    law = subject.model()
    step, trial = law.step, law.trial
    work = least = most = 0.0
    for move, speed in zip(moves, speeds, strict=True):
        if move == 0.0:
            continue
        velocity = math.copysign(min(speed, 1e5), move)
        part = move / parts
        dt = part / velocity
        # Friction right behind the change of speed, then at the end: the trapezoidal rule.
        last = trial(velocity, 1e-9 * dt)[0]
        for _ in range(parts):
            force = step(velocity, dt)
            work += 0.5 * (last + force) * part
            last = force
        least, most = min(least, work), max(most, work)
    return least, most


PASSIVE: Final = Property(
    "passive",
    "passive",
    "Does it never give back more energy than it took?",
    f"The work that a fresh contact took never falls below −{_LEAST:.0%} of the most that it had "
    "taken (the error of the quadrature), on random motions and repeated random cycles, over the "
    "cases of the law and over parameters drawn up to 10 times smaller and larger. A "
    "random search finds what violates it; that nothing was found is no proof.",
    passive,
    drawn_over=True,
)
