"""A single event: what happens once, in rows of one role alone, cannot be fitted and judged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ...fitting.rows import Mask, Rows
from ...recording.split import BLOCK_S
from ..data.evidence import Evidence
from ..data.gain import HeldOut
from ..records import Advice
from ..screening.model import Model

__all__ = ["Lone", "lone_event"]

WINDOW_S: Final = 0.5
"""Length of the windows whose power is compared."""
TIMES: Final = 10.0
"""A window stands out where it holds so many times the power of the usual one."""
MOST_OF_IT: Final = 0.5
"""Share of the power above the usual one that a single event holds."""
OWN_ROLE: Final = 0.9
"""Share of an event in rows of one role from which on the others hold nothing of it."""
LONGEST_S: Final = 2.0 * BLOCK_S
"""What lasts longer reaches into blocks of several roles."""

_ROLES: Final = ("were fitted", "decide", "test")


@dataclass(frozen=True)
class Lone:
    """One event that holds most of what is left of a recording.

    Attributes
    ----------
    recording : str
    start, end : float
        s since the first row of the recording.
    role : str
        What the rows are for in which it lies: they "were fitted", "decide" or "test".
    begin : float
        Stamp of the first row of the recording, s.
    """

    recording: str
    start: float
    end: float
    role: str
    begin: float = 0.0

    @property
    def fitted(self) -> bool:
        """Whether it lies in rows that were fitted."""
        return self.role == _ROLES[0]

    def rows(self, rows: Sequence[Rows], names: Sequence[str]) -> Mask:
        """Which of the stacked rows lie in it; shape (n,)."""
        inside = []
        for each in rows:
            since = each.form.time[each.mask] - self.begin
            here = names[each.index] == self.recording
            inside.append((since >= self.start) & (since <= self.end) & here)
        return np.concatenate(inside)

    def words(self) -> str:
        """Why that cannot be tested, in a sentence."""
        return (
            f"These data cannot be tested: most of what is left comes from one event, "
            f"{self.start:.1f} to {self.end:.1f} s into {self.recording}, all of it in rows that "
            f"{self.role}; nothing else shows it, so record it several times."
        )

    def advice(self) -> Advice:
        """What to record."""
        return Advice(
            f"repeat what happens {self.start:.1f} s into {self.recording}, four times or more",
            "what happens once cannot be fitted and judged at the same time",
            (),
        )


def lone_event(
    evidence: Evidence, model: Model, test: HeldOut | None, place: int, least: float
) -> Lone | None:
    """The single event of a recording that is cut into blocks, None where there is none.

    Parameters
    ----------
    evidence : Evidence
    model : Model
        What it leaves is looked at.
    test : HeldOut or None
    place : int
        Of the model among those that were tested.
    least : float
        Weighted rms of a residual that matters.
    """
    for index, name in enumerate(evidence.names):
        roles = [
            _of(evidence.shown, model.residual, index, evidence.fitted),
            _of(evidence.shown, model.residual, index, ~evidence.fitted),
        ]
        if test is not None:
            everything = np.ones(len(test.weights), dtype=bool)
            roles.append(_of(test.rows, test.residuals[place], index, everything))
        if sum(len(time) > 0 for time, _ in roles) < 2:
            continue
        begin = float(evidence.recordings[index].time[0])
        found = _event(roles, begin, least)
        if found is not None:
            return Lone(name, found[0] - begin, found[1] - begin, _ROLES[found[2]], begin)
    return None


def _of(
    rows: Sequence[Rows], residual: FloatArray, index: int, chosen: np.ndarray
) -> tuple[FloatArray, FloatArray]:
    """Stamps and power of the chosen rows of one recording out of stacked ones."""
    first = 0
    for each in rows:
        time = each.form.time[each.mask]
        own = slice(first, first + len(time))
        first += len(time)
        if each.index == index:
            mask = chosen[own]
            return time[mask], residual[own][mask] ** 2
    return np.empty(0), np.empty(0)


def _event(
    roles: Sequence[tuple[FloatArray, FloatArray]], begin: float, least: float
) -> tuple[float, float, int] | None:
    """From when to when a single event lasts, and the role of its rows."""
    spans, powers, owners = [], [], []
    for role, (time, power) in enumerate(roles):
        window = np.floor((time - begin) / WINDOW_S).astype(np.int64)
        for each in np.unique(window):
            own = window == each
            spans.append((float(time[own][0]), float(time[own][-1])))
            powers.append((float(np.mean(power[own])), int(own.sum())))
            owners.append(role)
    mean, size = np.array(powers).T
    usual = float(np.median(mean))
    out = (mean > TIMES * usual) & (mean > least**2)
    beyond = np.maximum(mean - usual, 0.0) * size
    if not out.any() or float(beyond[out].sum()) < MOST_OF_IT * float(beyond.sum()):
        return None
    start = min(spans[k][0] for k in np.flatnonzero(out))
    end = max(spans[k][1] for k in np.flatnonzero(out))
    shares = np.bincount(np.array(owners)[out], beyond[out], minlength=len(roles))
    role = int(np.argmax(shares))
    if end - start > LONGEST_S or shares[role] < OWN_ROLE * shares.sum():
        return None
    return start, end, role
