"""Pushes from outside: rows in which something else than the drive moved the machine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from ..plant import Plant
from ..recording import Check, Part, Recording
from ..recording.motion import GAUSSIAN
from ..residual.weak_form import WeakForm
from .rows import Mask, Push, rows_of

__all__ = ["Watch", "omission_words", "push_checks"]

WINDOWS_S: Final = (0.1, 0.3, 0.8)
"""Lengths of the windows whose momentum is compared: what is shorter than the first is a spike, no
push, and a weak hand that stays shows in the last."""
TIMES: Final = 6.0
"""A window stands out where the effort that it lacks is so many times that of the usual one, in the
session and in its own recording..."""
LEAST_SHARE: Final = 2.5
LEAST_MOVING: Final = 0.5
LEAST_OF_EFFORT: Final = 0.1
"""... and these shares of the dry friction, which itself changes by twice its level behind a
reversal and is better known of a machine that moves on, and of the usual effort."""
TURNS_WITHIN: Final = 0.05
"""Share of the usual speed within which dry friction turns round, here."""
MOVES: Final = 0.1
"""Share of the usual speed of the session from which on a machine moves on..."""
SETTLES_S: Final = 0.1
"""... so long before and behind."""
LEVEL: Final = 0.75
"""A push lasts as long as windows beside it hold this share of what makes one."""
LASTS_S: Final = 0.15
"""A push lasts so long at least."""
TAILS: Final = 0.03
"""Share of what it lacks before and behind the times at which it begins and ends."""
MARGIN_S: Final = 0.2
"""Left out before and behind: a hand is there before it is seen."""
MOST_TIME: Final = 0.4
"""What takes a larger share of a recording is no push but how the machine is..."""
MOST_PUSHES: Final = 8
"""... and so is what comes more often."""
NEIGHBOURS: Final = 8
APART_S: Final = 1.0
"""Rows alike are looked for this far from the push: what is nearer may be a part of it."""
NEAR: Final = 0.5
"""Rows are alike whose position, speed, acceleration and effort differ by so much of their usual
sizes, taken together."""
ALIKE_SHARE: Final = 0.05
"""Share of the rows of a push that must have such rows elsewhere to be told from the machine..."""
OF_THOSE: Final = 0.6
"""... and share of these that must lack nothing there: otherwise it is what the machine does."""
BEYOND: Final = 1.2
"""What lacks so many times the greatest effort that the drive gave comes from outside, wherever the
machine was."""
LACKS: Final = 0.4
"""Of what a push lacks: less is nothing."""
LEFT_OUT: Final = (
    "these rows are left out, because the drive, as the plant has it, did not make that motion"
)
UNSURE: Final = "these rows are left out, because nothing shows that the drive made that motion"
"""The same where no rows alike lie elsewhere, which would show it."""
ROUNDS: Final = 30
TRIMS: Final = 8
OUTLYING: Final = 4.0
"""Robust standard deviations beyond which a row says nothing of the machine."""


def omission_words(push: Push) -> str:
    """Why rows of a push are left out, in words."""
    return LEFT_OUT if push.sure else UNSURE


def push_checks(pushes: Sequence[Push], names: Sequence[str]) -> list[tuple[str, Check]]:
    """The pushes as what was found in each recording, by its name."""
    return [
        (names[push.recording], Check("push", "note", push.words(), omission_words(push), ""))
        for push in pushes
    ]


class Watch:
    """What a machine usually needs, and when something else moved it.

    A regression that rows out of the ordinary have no say in tells what the effort depends on:
    acceleration, direction, speed and position. A push is a stretch of time that lacks effort of
    one sign, beyond what is usual in the session and in its own recording and beyond what friction
    may be, where rows alike elsewhere lack none: what a machine does, it does again.

    What the mean effort of a window lacks is the momentum that nobody accounts for. The longer the
    window, the less of it noise and effort that is late can make, so a weak hand shows in long
    ones.

    Parameters
    ----------
    plant : Plant
    forms : sequence of WeakForm
    recordings : sequence of Recording
    parts : sequence of Part
        Rows that may be looked at: what is usual is learnt from them.
    """

    def __init__(
        self,
        plant: Plant,
        forms: Sequence[WeakForm],
        recordings: Sequence[Recording],
        parts: Sequence[Part],
    ) -> None:
        self.plant, self.forms, self.recordings = plant, list(forms), list(recordings)
        seen = list(enumerate(self._masks(parts)))
        seen = [(k, mask) for k, mask in seen if mask.any()]
        # What a moved machine needs is measured, and a servo's effort is a guess of its own law.
        self._greatest = BEYOND * max(
            (float(np.max(np.abs(self._effort(self.forms[k], mask)[mask]))) for k, mask in seen),
            default=0.0,
        )
        self._able = bool(seen) and not plant.prescribed_motion and not plant.servo
        if not self._able:
            return
        columns = np.vstack([self._columns(self.forms[k], mask)[mask] for k, mask in seen])
        effort = np.concatenate([self._effort(self.forms[k], mask)[mask] for k, mask in seen])
        self._coefficients = _robust(columns, effort)
        self._dry = abs(float(self._coefficients[1]))
        speeds = np.concatenate([self.forms[k].velocity[mask] for k, mask in seen])
        self._speed = float(np.sqrt(np.mean(speeds**2)))
        lacks = [self._lacks(self.forms[k], mask)[:, mask] for k, mask in seen]
        self._lacked = np.abs(np.concatenate(lacks, axis=1))
        self._usual = np.median(self._lacked, axis=1)
        self._level = float(np.sqrt(np.mean(effort**2)))
        places = np.vstack([self._places(self.forms[k], mask)[mask] for k, mask in seen])
        self._sizes = np.maximum(np.sqrt(np.mean(places**2, axis=0)), 1e-300)
        self._known = places / self._sizes
        self._owner = np.concatenate([np.full(int(mask.sum()), k) for k, mask in seen])
        self._time = np.concatenate([self.forms[k].time[mask] for k, mask in seen])

    def look(self, parts: Sequence[Part]) -> list[Push]:
        """The pushes in some parts of the session, in their order."""
        if not self._able:
            return []
        found = []
        for index, mask in enumerate(self._masks(parts)):
            if mask.any():
                found += self._look(index, mask)
        return found

    def _look(self, index: int, mask: Mask) -> list[Push]:
        form = self.forms[index]
        lacks = self._lacks(form, mask)
        turns = self._turns(form)
        # What is lacked for longer than a push may last is how this recording is. Of rows in which
        # friction may be anything between its levels nothing is known.
        own = np.quantile(np.where(turns, 0.0, np.abs(lacks))[:, mask], 1.0 - MOST_TIME, axis=1)
        usual = np.maximum(self._usual, own)
        least = np.maximum(TIMES * usual[:, None], self._allowed(form, mask, turns))
        found, outside = [], []
        for window in range(len(WINDOWS_S)):
            share = np.where(mask, lacks[window] / np.maximum(least[window], 1e-300), 0.0)
            for first, last in _lasting(share, round(LASTS_S / (form.dt * form.stride))):
                rows = first + np.flatnonzero(np.abs(share[first:last]) > 1.0)
                sign = np.sign(share[rows[0]])
                begin, end = _narrowed(form, sign * lacks[0], least[window], window, first, last)
                found.append(self._push(index, begin, end))
                sure = self._from_outside(index, mask, window, np.abs(lacks[window]), rows)
                if sure is not False:
                    outside.append(replace(found[-1], sure=sure is True))
        pushes = _joined(outside)
        time = form.time[mask] - self.recordings[index].time[0]
        left = sum(int(((time >= push.start) & (time <= push.end)).sum()) for push in pushes)
        if len(_joined(found)) > MOST_PUSHES or left > MOST_TIME * len(time):
            return []
        return pushes

    def _push(self, index: int, first: int, last: int) -> Push:
        time = self.forms[index].time - self.recordings[index].time[0]
        start = max(float(time[first]) - MARGIN_S, 0.0)
        return Push(index, start, float(time[last - 1]) + MARGIN_S)

    def _lacks(self, form: WeakForm, mask: Mask) -> FloatArray:
        """What the mean effort of each window lacks; shape (windows, rows)."""
        lacks = form.measured_effort(self.plant) - self._terms(form) @ self._coefficients
        return np.stack([_mean(form, lacks, mask, length) for length in WINDOWS_S])

    def _turns(self, form: WeakForm) -> Mask:
        """Where the machine rests or turns round."""
        slow = np.abs(form.velocity) <= MOVES * self._speed
        turns: Mask = _mean(form, slow.astype(float), None, 2.0 * SETTLES_S) > 0.0
        return turns

    def _allowed(self, form: WeakForm, mask: Mask, turns: Mask) -> FloatArray:
        """What it may lack as friction and effort are not known better; shape (windows, rows)."""
        dry = np.where(turns, LEAST_SHARE, LEAST_MOVING) * self._dry
        windows = np.stack([_mean(form, dry, mask, length) for length in WINDOWS_S])
        return np.maximum(windows, LEAST_OF_EFFORT * self._level)

    def _masks(self, parts: Sequence[Part]) -> list[Mask]:
        return [
            rows_of(form, recording, k, parts)
            for k, (form, recording) in enumerate(zip(self.forms, self.recordings, strict=True))
        ]

    def _from_outside(
        self, index: int, mask: Mask, window: int, size: FloatArray, rows: np.ndarray
    ) -> bool | None:
        """Whether rows alike elsewhere lack nothing, or no drive could have done it.

        None where no row is like these: what happens once cannot be fitted and judged.
        """
        from scipy.spatial import cKDTree

        form = self.forms[index]
        if float(np.max(size[rows])) > self._greatest:
            return True
        first, last = form.time[rows[0]] - APART_S, form.time[rows[-1]] + APART_S
        elsewhere = (self._owner != index) | (self._time < first) | (self._time > last)
        if elsewhere.sum() < NEIGHBOURS:
            return None
        lacks = float(np.sqrt(np.mean(size[rows] ** 2)))
        near, which = cKDTree(self._known[elsewhere]).query(
            self._places(form, mask)[rows] / self._sizes, NEIGHBOURS, distance_upper_bound=NEAR
        )
        known = np.isfinite(near).all(axis=1)
        nothing = np.median(self._lacked[window, elsewhere][which[known]], axis=1) < LACKS * lacks
        if float(np.mean(known)) <= ALIKE_SHARE:
            return None
        return bool(nothing.sum() > OF_THOSE * known.sum())

    def _effort(self, form: WeakForm, mask: Mask) -> FloatArray:
        return _mean(form, form.measured_effort(self.plant), mask)

    def _columns(self, form: WeakForm, mask: Mask) -> FloatArray:
        return _mean(form, self._terms(form), mask)

    def _terms(self, form: WeakForm) -> FloatArray:
        """What the effort may depend on, in each row."""
        speed = form.velocity
        scale = max(float(np.sqrt(np.mean(speed**2))), 1e-300)
        columns = [
            form.acceleration,
            np.tanh(speed / (TURNS_WITHIN * scale)),
            speed,
            speed * np.abs(speed),
            np.ones_like(speed),
            *self._at(form),
        ]
        return np.column_stack(columns)

    def _places(self, form: WeakForm, mask: Mask) -> FloatArray:
        """Where the machine is in each row: position, speed and acceleration."""
        places = np.column_stack([*self._at(form), form.velocity, form.acceleration])
        return _mean(form, places, mask)

    def _at(self, form: WeakForm) -> list[FloatArray]:
        position = form.mean(form.position[1:])
        if self.plant.motion == "rotary":
            return [np.sin(position), np.cos(position)]
        return [position]


def _robust(columns: FloatArray, effort: FloatArray) -> FloatArray:
    """Least absolute values, then least squares over the rows that are near."""
    size = np.maximum(np.sqrt(np.mean(columns**2, axis=0)), 1e-300)
    scaled = columns / size
    weights = np.ones(len(effort))
    solved = np.zeros(columns.shape[1])
    for _ in range(ROUNDS):
        root = np.sqrt(weights)
        solved = np.linalg.lstsq(scaled * root[:, None], effort * root, rcond=1e-10)[0]
        left = np.abs(effort - scaled @ solved)
        weights = 1.0 / np.maximum(left, 1e-3 * float(np.median(left)) + 1e-300)
        weights /= float(np.max(weights))
    for _ in range(TRIMS):
        left = np.abs(effort - scaled @ solved)
        near = left <= OUTLYING * GAUSSIAN * float(np.median(left)) + 1e-300
        solved = np.linalg.lstsq(scaled[near], effort[near], rcond=1e-10)[0]
    found: FloatArray = solved / size
    return found


def _mean(
    form: WeakForm, values: FloatArray, mask: Mask | None, seconds: float = WINDOWS_S[0]
) -> FloatArray:
    """Mean over those rows of a window about each row that may be looked at."""
    length = min(max(1, round(seconds / (form.dt * form.stride))), len(values))
    rows = np.arange(len(values))
    first = np.maximum(rows - length // 2, 0)
    behind = np.minimum(rows + (length + 1) // 2, len(values))
    seen = np.ones(len(values)) if mask is None else mask.astype(float)
    seen = seen.reshape(-1, *[1] * (values.ndim - 1))

    def summed(each: FloatArray) -> FloatArray:
        total = np.concatenate([np.zeros_like(each[:1]), np.cumsum(each, axis=0)])
        found: FloatArray = total[behind] - total[first]
        return found

    return summed(values * seen) / np.maximum(summed(seen), 1.0)


def _joined(pushes: Sequence[Push]) -> list[Push]:
    """Pushes in their order; what overlaps is one, and sure where a part of it is."""
    joined: list[Push] = []
    for push in sorted(pushes, key=lambda push: push.start):
        if joined and push.start <= joined[-1].end:
            last = joined.pop()
            end, sure = max(last.end, push.end), last.sure or push.sure
            push = replace(last, end=end, sure=sure)
        joined.append(push)
    return joined


def _lasting(share: FloatArray, least: int) -> list[tuple[int, int]]:
    """Stretches of so many rows that lack effort of one sign.

    What is late lacks effort of one sign and then of the other, and each of them only for a moment.
    """
    return [
        (first, last)
        for sign in (1.0, -1.0)
        for first, last in _stretches(sign * share > LEVEL)
        if last - first >= least and float(np.max(sign * share[first:last])) > 1.0
    ]


def _narrowed(
    form: WeakForm, lack: FloatArray, least: FloatArray, window: int, first: int, last: int
) -> tuple[int, int]:
    """The part of a stretch, found through a window, that makes the mean so large."""
    half = round(0.5 * WINDOWS_S[window] / (form.dt * form.stride))
    first, last = max(first - half, 0), min(last + half, len(lack))
    beyond = np.cumsum(np.maximum(lack[first:last] - LEVEL * least[first:last], 0.0))
    if beyond[-1] <= 0.0:
        return first, last
    begin, end = np.searchsorted(beyond, (TAILS * beyond[-1], (1.0 - TAILS) * beyond[-1]))
    return first + int(begin), first + int(end) + 1


def _stretches(chosen: Mask) -> list[tuple[int, int]]:
    """First and behind the last of each stretch of chosen rows."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], chosen, [False]]).astype(int)))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
