"""Pushes from outside: rows in which something else than the drive moved the machine."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from ..plant import Plant
from ..recording import Check, Part, Recording
from ..trajectory import FloatArray
from ..weak_form import WeakForm
from .rows import Mask, Push, rows_of

__all__ = ["LEFT_OUT", "Watch", "told"]

WINDOW_S: Final = 0.1
"""Length of the windows whose power is compared: what is shorter is a spike, no push."""
TIMES: Final = 6.0
"""A window stands out where the effort that it lacks is so many times that of the usual one..."""
LEAST_SHARE: Final = 2.5
LEAST_OF_EFFORT: Final = 0.1
"""... and these shares of the dry friction, which itself changes by twice its level behind a
reversal, and of the usual effort."""
TURNS_WITHIN: Final = 0.05
"""Share of the usual speed within which dry friction turns round, here."""
LEVEL: Final = 0.75
"""A push lasts as long as windows beside it hold this share of what makes one."""
LASTS_S: Final = 0.15
"""A push lasts so long at least."""
GAP_S: Final = 0.25
"""Shorter pauses between pushes belong to one."""
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
LEFT_OUT: Final = "these rows are left out, because the drive did not make that motion"
ROUNDS: Final = 30
TRIMS: Final = 8
OUTLYING: Final = 4.0
"""Robust standard deviations beyond which a row says nothing of the machine."""


def told(pushes: Sequence[Push], names: Sequence[str]) -> list[tuple[str, Check]]:
    """The pushes as what was found in each recording, by its name."""
    return [
        (names[push.recording], Check("push", "note", push.words(), LEFT_OUT, ""))
        for push in pushes
    ]


class Watch:
    """What a machine usually needs, and when something else moved it.

    A regression that rows out of the ordinary have no say in tells what the effort depends on:
    acceleration, direction, speed and position. A push is a stretch of time that lacks much effort
    where rows alike elsewhere lack none: what a machine does, it does again.

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
        self.usual = self.least = 0.0
        seen = list(enumerate(self._masks(parts)))
        seen = [(k, mask) for k, mask in seen if mask.any()]
        # What a moved machine needs is measured, and a servo's effort is a guess of its own law.
        self._greatest = BEYOND * max(
            (float(np.max(np.abs(self._effort(self.forms[k])[mask]))) for k, mask in seen),
            default=0.0,
        )
        self._able = bool(seen) and not plant.prescribed_motion and not plant.servo
        if not self._able:
            return
        columns = np.vstack([self._columns(self.forms[k])[mask] for k, mask in seen])
        effort = np.concatenate([self._effort(self.forms[k])[mask] for k, mask in seen])
        self._coefficients = _robust(columns, effort)
        self._lacked = np.abs(effort - columns @ self._coefficients)
        self.usual = float(np.median(self._lacked))
        dry = abs(float(self._coefficients[1]))
        level = float(np.sqrt(np.mean(effort**2)))
        self.least = max(TIMES * self.usual, LEAST_SHARE * dry, LEAST_OF_EFFORT * level)
        places = np.vstack([self._places(self.forms[k])[mask] for k, mask in seen])
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
        form, begin = self.forms[index], float(self.recordings[index].time[0])
        lacks = self._effort(form) - self._columns(form) @ self._coefficients
        size = np.where(mask, np.abs(lacks), 0.0)
        spacing = form.dt * form.stride
        out = size > self.least
        found = [
            (first, last)
            for first, last in _stretches(size > LEVEL * self.least, round(GAP_S / spacing))
            if out[first:last].any() and mask[first:last].sum() * spacing >= LASTS_S
        ]
        lasting = sum(int(mask[first:last].sum()) for first, last in found)
        if len(found) > MOST_PUSHES or lasting > MOST_TIME * mask.sum():
            return []
        pushes = []
        for first, last in found:
            outside = self._from_outside(index, size, first + np.flatnonzero(out[first:last]))
            if outside is not False:
                start = max(float(form.time[first] - begin) - MARGIN_S, 0.0)
                end = float(form.time[last - 1] - begin) + MARGIN_S
                pushes.append(Push(index, start, end, sure=outside is True))
        return pushes

    def _masks(self, parts: Sequence[Part]) -> list[Mask]:
        return [
            rows_of(form, recording, k, parts)
            for k, (form, recording) in enumerate(zip(self.forms, self.recordings, strict=True))
        ]

    def _from_outside(self, index: int, size: FloatArray, rows: np.ndarray) -> bool | None:
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
            self._places(form)[rows] / self._sizes, NEIGHBOURS, distance_upper_bound=NEAR
        )
        known = np.isfinite(near).all(axis=1)
        nothing = np.median(self._lacked[elsewhere][which[known]], axis=1) < LACKS * lacks
        if float(np.mean(known)) <= ALIKE_SHARE:
            return None
        return bool(nothing.sum() > OF_THOSE * known.sum())

    def _effort(self, form: WeakForm) -> FloatArray:
        return _mean(form, form.measured(self.plant))

    def _columns(self, form: WeakForm) -> FloatArray:
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
        return _mean(form, np.column_stack(columns))

    def _places(self, form: WeakForm) -> FloatArray:
        """Where the machine is in each row: position, speed and acceleration."""
        return _mean(form, np.column_stack([*self._at(form), form.velocity, form.acceleration]))

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
        near = left <= OUTLYING * 1.4826 * float(np.median(left)) + 1e-300
        solved = np.linalg.lstsq(scaled[near], effort[near], rcond=1e-10)[0]
    found: FloatArray = solved / size
    return found


def _mean(form: WeakForm, values: FloatArray) -> FloatArray:
    """Mean over a window about each row: a hand pushes one way for a while, noise does not."""
    length = min(max(1, round(WINDOW_S / (form.dt * form.stride))), len(values))
    kernel = np.ones(length) / length
    found: FloatArray = np.apply_along_axis(np.convolve, 0, values, kernel, "same")
    return found


def _stretches(chosen: Mask, gap: int) -> list[tuple[int, int]]:
    """First and behind the last of each stretch of chosen rows, short gaps bridged."""
    places = np.flatnonzero(chosen)
    if len(places) == 0:
        return []
    breaks = np.flatnonzero(np.diff(places) > gap)
    firsts = np.concatenate([places[:1], places[breaks + 1]])
    lasts = np.concatenate([places[breaks], places[-1:]]) + 1
    return list(zip(firsts.tolist(), lasts.tolist(), strict=True))
