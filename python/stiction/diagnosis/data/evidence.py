"""The rows of a session by what they may be used for; those that test stay sealed until the end."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, TypeVar

import numpy as np

from ..._support.arrays import FloatArray
from ..._support.progress import steps
from ..._support.workers import side_by_side
from ...errors import NotEnoughData
from ...fitting.forms import KERNELS, Through, as_session, forms_of
from ...fitting.pushes import Watch
from ...fitting.recording_starts import fit_starts
from ...fitting.rows import Mask, Nuisances, Rows, require_motion, rows_of
from ...plant import Plant
from ...recording import Part, Recording
from ...recording.names import names_of, places_in_session
from ...recording.split import BLOCK_S, Split, split
from ...residual.weak_form import WeakForm

__all__ = ["Cells", "Evidence", "Plan", "SealedError"]

BLOCK: Final = 1.0
"""Length of the blocks over which residuals are taken as correlated, s."""

_Item = TypeVar("_Item")
_Result = TypeVar("_Result")


class SealedError(RuntimeError):
    """The rows that test were asked for before the last decision, or twice."""


@dataclass(frozen=True)
class Plan:
    """One way to decide: fitted on some of the stacked rows, judged on others.

    Attributes
    ----------
    fit, held : numpy.ndarray of bool, shape (n,)
    whole : numpy.ndarray of bool, shape (n,), optional
        Rows of which a fold fits a part; None where ``fit`` is all that is ever fitted.
    """

    fit: Mask
    held: Mask
    whole: Mask | None = None


@dataclass(frozen=True)
class Cells:
    """Where each stacked row comes from.

    Attributes
    ----------
    block : numpy.ndarray of int, shape (n,)
        Blocks of 1 s of one recording, numbered from 0.
    recording : numpy.ndarray of int, shape (n,)
    kind : numpy.ndarray of int, shape (n,)
        Index into ``kinds``.
    kinds : tuple of str
    """

    block: np.ndarray
    recording: np.ndarray
    kind: np.ndarray
    kinds: tuple[str, ...]

    def of(self, mask: Mask) -> Cells:
        """The same of some of the rows."""
        return Cells(self.block[mask], self.recording[mask], self.kind[mask], self.kinds)


class Evidence:
    """A session seen through kernels, and who may look at which rows.

    Parameters
    ----------
    plant : Plant
        For its kind of motion, drive and sensor.
    recordings : sequence of Recording
    through : Through, optional
    watch : Watch, optional
        Who looks out for pushes from outside; without it a new one learns from the rows that may
        be looked at.
    joined : bool
        The rows that decide are fitted as well, and folds over all of them decide.

    Attributes
    ----------
    through : Through
    loop, joined : bool
    watch : Watch
    pushes : list of Push
        Times that no drive made: their rows are left out. Those among rows that test are added when
        these are opened.
    train : list of Rows
        Fitted on.
    overlap : float
        Rows under one kernel.
    split : Split
    names : list of str
        As in the session that the recordings belong to.
    places : numpy.ndarray of int, shape (recordings,)
        There, from 0.
    shown : list of Rows
        Fitted on or decided on: all that may be looked at before the last decision.
    fitted : numpy.ndarray of bool, shape (n,)
        Which of the stacked rows of ``shown`` are fitted on.
    weights : numpy.ndarray, shape (n,)
        Of the stacked rows.
    plans : list of Plan
    cells : Cells
    floor : float
        Weighted power that readings alone leave in the fitted rows; 0 until replays have told.

    Raises
    ------
    NotEnoughData
        A recording too short for its kernel, nothing to train on or to decide on.
    """

    def __init__(
        self,
        plant: Plant,
        recordings: Sequence[Recording],
        *,
        through: Through = KERNELS,
        watch: Watch | None = None,
        joined: bool = False,
    ) -> None:
        self.plant = plant
        self.through = through
        self.loop = through.loop
        self.recordings = list(recordings)
        self.names = names_of(self.recordings)
        self.places = np.array(places_in_session(self.recordings))
        self.forms = forms_of(plant, self.recordings, self.each, through)
        self.support = max(form.kernel.support for form in self.forms)
        self.overlap = max(f.kernel.support / (f.dt * f.stride) for f in self.forms)
        self.joined = joined
        edge_s = min(self.support, 0.25 * BLOCK_S)
        self.split: Split = split(self.recordings, edge_s=edge_s, joined=joined)
        seen = {part.recording for part in (*self.split.train, *self.split.select)}
        as_session(self.forms, self.recordings, set(range(len(self.forms))) - seen)
        shown_parts = (*self.split.train, *self.split.select)
        self.watch = watch or Watch(plant, self.forms, self.recordings, shown_parts)
        self.pushes = self.watch.look(shown_parts)
        self.train = self._rows(plant, self.split.train)
        require_motion(self.train, plant)
        self._select = self._masks(self.split.select)
        self._sealed = True
        # What may be looked at before the last decision: train and select, one under the other.
        shown = self._masks(shown_parts)
        self.shown = [Rows(plant, f, k, m) for k, (f, m) in enumerate(shown) if m.any()]
        self.cells = self._cells(self.shown)
        self.fitted = self._stacked(self._masks(self.split.train))
        self.plans = self._plans()
        self._weights = [1.0] * len(self.recordings)
        self.weights = np.ones(len(self.fitted))
        self.floor = 0.0

    def with_rows(self, again: Callable[[Rows], Rows]) -> Evidence:
        """The same session with other rows in the place of those that may be looked at."""
        other = copy(self)
        new = dict(zip((r.index for r in self.shown), self.each(again, self.shown), strict=True))
        other.shown = list(new.values())
        other.train = [new[rows.index].of(rows.mask) for rows in self.train]
        return other

    def anew(self) -> Evidence:
        """The same session before anything was fitted to it: all rows weigh alike."""
        other = copy(self)
        other.train = [rows.of(rows.mask) for rows in self.train]
        other.shown = [rows.of(rows.mask) for rows in self.shown]
        for rows in (*other.train, *other.shown):
            rows.weight = 1.0
        other._weights = [1.0] * len(self.recordings)
        other.weights = np.ones(len(self.fitted))
        other.floor = 0.0
        return other

    @property
    def simulated(self) -> bool:
        """Whether rows are those of simulations, not of efforts along the measured motion."""
        return any(form.simulated for form in self.forms)

    @property
    def leads(self) -> bool:
        """Whether friction is driven by motions that a plant makes near the measured ones.

        Of simulations they are where a window begins, and no more.
        """
        return any(form.leads and not form.simulated for form in self.forms)

    def each(self, work: Callable[[_Item], _Result], items: Sequence[_Item]) -> list[_Result]:
        """Results of some work on each item, in their order, on as many threads as allowed."""
        return list(steps(side_by_side(work, items), "recording", len(items)))

    def residual(
        self, plant: Plant, nuisances: Nuisances, some: Sequence[Rows] | None = None
    ) -> FloatArray:
        """Weighted residual of all rows that may be looked at, or of ``some``; shape (n,)."""
        return self.stack(lambda rows: rows.residual(plant, nuisances), some)

    def stack(
        self, work: Callable[[Rows], FloatArray], some: Sequence[Rows] | None = None
    ) -> FloatArray:
        """Weighted columns of all rows that may be looked at, one recording under the other.

        Or of ``some`` of them (see ``rows_with``).
        """

        def columns(rows: Rows) -> FloatArray:
            found: FloatArray = rows.weight * work(rows)[rows.mask]
            return found

        return np.concatenate(self.each(columns, self.shown if some is None else some))

    def rows_with(self, chosen: Mask) -> list[Rows]:
        """The recordings that have some of the stacked rows, each with these alone."""
        found = []
        ends = np.cumsum([int(rows.mask.sum()) for rows in self.shown])
        for rows, own in zip(self.shown, np.split(chosen, ends[:-1]), strict=True):
            if own.any():
                mask = rows.mask.copy()
                mask[rows.mask] = own
                found.append(rows.of(mask))
        return found

    def weigh(self) -> None:
        """Carries the weights of train over to all other rows, by recording or by kind."""
        own = {rows.index: rows.weight for rows in self.train}
        by_kind: dict[str, list[float]] = {}
        for index, weight in own.items():
            by_kind.setdefault(self.recordings[index].kind, []).append(weight)
        usual = float(np.median(list(own.values())))
        self._weights = []
        for index, recording in enumerate(self.recordings):
            same = by_kind.get(recording.kind)
            kind = float(np.median(same)) if same else usual
            self._weights.append(own.get(index, kind))
        for rows in self.shown:
            rows.weight = self._weights[rows.index]
        self.weights = np.concatenate([np.full(int(r.mask.sum()), r.weight) for r in self.shown])

    @cached_property
    def training_recordings(self) -> frozenset[int]:
        """Recordings of which rows are fitted."""
        return frozenset(rows.index for rows in self.train)

    def with_held_starts(self, plant: Plant, nuisances: Nuisances, known: Nuisances) -> Nuisances:
        """Nuisances with the starts of recordings that decide and are not fitted.

        Parameters
        ----------
        plant : Plant
        nuisances : Nuisances
            Fitted.
        known : Nuisances
            Where those starts are looked for from, as far as they are in there.
        """
        others = [rows for rows in self.shown if rows.index not in self.training_recordings]
        near = known.of({rows.index for rows in others})
        return self.with_starts(plant, replace(nuisances, starts=near.starts), others).merge(
            nuisances
        )

    def with_starts(self, plant: Plant, nuisances: Nuisances, rows: Sequence[Rows]) -> Nuisances:
        """Nuisances with a start of each of these recordings; see `fit_starts` of the fit."""
        own = self.each(lambda each: fit_starts(plant, [each], nuisances), rows)
        for each, found in zip(rows, own, strict=True):
            nuisances = found.of({each.index}).merge(nuisances)
        return nuisances

    def sealed_copy(self) -> Evidence:
        """The same session for a question of its own to the rows that test: here they stay shut."""
        return copy(self)

    @property
    def sealed(self) -> bool:
        """Whether the rows that test are still unseen."""
        return self._sealed

    def open_test(self) -> list[Rows]:
        """The rows that test: once, after the last decision.

        Raises
        ------
        SealedError
            The second time.
        """
        if not self._sealed:
            raise SealedError("the test rows were opened already")
        known = self.pushes
        try:
            self.pushes = [*known, *self.watch.look(self.split.test)]
            rows = self._rows(self.plant, self.split.test)
            for each in rows:
                each.weight = self._weights[each.index]
        except KeyboardInterrupt:
            # Nobody has seen them: they may be opened when what is known is concluded.
            self.pushes = known
            raise
        self._sealed = False
        return rows

    def cells_of(self, rows: Sequence[Rows]) -> Cells:
        """Where the rows that count come from."""
        return self._cells(rows)

    def _rows(self, plant: Plant, parts: Sequence[Part]) -> list[Rows]:
        masks = self._masks(parts)
        return [Rows(plant, form, k, mask) for k, (form, mask) in enumerate(masks) if mask.any()]

    def _masks(self, parts: Sequence[Part]) -> list[tuple[WeakForm, Mask]]:
        return [
            (form, rows_of(form, recording, k, parts, self.pushes))
            for k, (form, recording) in enumerate(zip(self.forms, self.recordings, strict=True))
        ]

    def _stacked(self, masks: Sequence[tuple[WeakForm, Mask]]) -> Mask:
        stacked: Mask = np.concatenate([masks[rows.index][1][rows.mask] for rows in self.shown])
        return stacked

    def _plans(self) -> list[Plan]:
        if self.split.select:
            return [Plan(self.fitted, self._stacked(self._select))]
        plans = []
        for fold in self.split.folds:
            fit, held = self._stacked(self._masks(fold.fit)), self._stacked(self._masks(fold.held))
            if fit.any() and held.any():
                plans.append(Plan(fit, held, self.fitted))
        if not plans:
            raise NotEnoughData(
                "session: nothing is left to decide on besides what is fitted; add a recording "
                'with role = "select", or longer ones'
            )
        return plans

    def _cells(self, rows: Sequence[Rows]) -> Cells:
        kinds = tuple(dict.fromkeys(recording.kind for recording in self.recordings))
        block, recording, kind = [], [], []
        offset = 0
        for each in rows:
            time = each.form.time[each.mask]
            own = np.floor((time - time[0]) / BLOCK).astype(np.int64)
            _, own = np.unique(own, return_inverse=True)
            block.append(own + offset)
            offset += int(own.max()) + 1
            recording.append(np.full(len(time), each.index))
            name = self.recordings[each.index].kind
            kind.append(np.full(len(time), kinds.index(name)))
        return Cells(np.concatenate(block), np.concatenate(recording), np.concatenate(kind), kinds)
