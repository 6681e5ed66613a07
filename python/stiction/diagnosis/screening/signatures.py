"""What candidates would change in the rows that may be looked at, and sums over these rows."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, Final

import numpy as np

from ..._support.arrays import FloatArray
from ...fitting.rows import Mask, Nuisances, Rows
from ...plant import Plant
from ...plant.stated import Effect
from ...residual.finite import finite
from ...residual.weak_form import Places
from ..data.evidence import Evidence
from .candidates import Candidate
from .model import with_effect

__all__ = ["Alike", "Block", "Signatures", "gain_at"]

FEW: Final = 32
"""Candidates of which columns of all rows are kept, should they be asked for again."""

BUDGET: Final = 96_000_000
"""Bytes of columns that are held as they are. Of longer sessions they are held in single precision:
rounding of 6·10⁻⁸ in each row by itself, of which sums over rows, which are formed in double
precision, keep next to nothing; far more is lost in what is chosen by them."""
MADE, WIDENED = 8_000_000, 8_000_000
"""Bytes of columns that are made, or widened, at once."""
OFTEN: Final = 8
"""Times that a recording is gone along for that."""

_Beside = Callable[[Sequence[int]], FloatArray]


@dataclass(frozen=True)
class Block:
    """Columns of some neighbouring gains over some of the fitted rows.

    Attributes
    ----------
    first : int
        The first of the gains.
    rows : slice
        Among the fitted rows.
    values : numpy.ndarray, shape (gains, rows)
        Weighted; each gain in one piece, in single precision where there are too many.
    """

    first: int
    rows: slice
    values: np.ndarray[Any, np.dtype[np.floating]]

    def parts(self) -> Iterator[tuple[slice, FloatArray]]:
        """Gains and their columns in double precision, some at a time."""
        number = len(self.values)
        if self.values.dtype != np.float32:
            yield slice(self.first, self.first + number), self.values.astype(np.float64, copy=False)
            return
        for some in _pieces(number, WIDENED // (8 * max(self.values.shape[1], 1))):
            at = slice(self.first + some.start, self.first + some.stop)
            yield at, self.values[some].astype(np.float64)

    def of(self, gains: slice) -> Block | None:
        """What it holds of these gains, None for nothing."""
        start = max(gains.start, self.first)
        stop = min(gains.stop, self.first + len(self.values))
        if start >= stop:
            return None
        return Block(start, self.rows, self.values[start - self.first : stop - self.first])

    def holds(self, gains: slice) -> bool:
        """Whether all of these gains are in it."""
        found = self.of(gains)
        return found is not None and len(found.values) == gains.stop - gains.start


@dataclass(frozen=True)
class Alike:
    """Candidates with the same number of gains, q, which are regressed on all at once.

    Attributes
    ----------
    places : numpy.ndarray of int, shape (m,)
        Among all candidates.
    own : numpy.ndarray of int, shape (m, q)
        Columns of each.
    normal : numpy.ndarray, shape (m, q, q)
        SᵀS of each over the fitted rows.
    low, high : numpy.ndarray, shape (m, q)
        Bounds of the gains: a delay is not negative.
    """

    places: np.ndarray
    own: np.ndarray
    normal: FloatArray
    low: FloatArray
    high: FloatArray

    @classmethod
    def of(cls, signatures: Signatures, number: int) -> Alike:
        """Those with so many gains."""
        slices = signatures.slices
        places = [k for k, own in enumerate(slices) if own.stop - own.start == number]
        normal = np.zeros((len(places), number, number))
        for block in signatures.blocks:
            for total, k in zip(normal, places, strict=True):
                if block.holds(slices[k]):
                    start = slices[k].start - block.first
                    part = block.values[start : start + number].astype(np.float64, copy=False)
                    total += part @ part.T
        bounds = np.array(
            [list(zip(*signatures.candidates[k].bounds, strict=True)) for k in places]
        )
        return cls(
            np.array(places),
            np.array([range(slices[k].start, slices[k].stop) for k in places]),
            normal,
            bounds[:, 0],
            bounds[:, 1],
        )


@dataclass(frozen=True)
class Signatures:
    """Derivatives of what the plant needs by the gains of candidates, at zero gain.

    The residual is what is measured less what is needed: a signature that resembles it is missing.
    There are hundreds of columns: of those only the fitted rows are held, once, recording by
    recording. The others are made again for the few candidates that are asked for.

    Attributes
    ----------
    candidates : tuple of Candidate
    slices : tuple of slice
        Columns of each candidate.
    blocks : tuple of Block
        All columns over the fitted rows.
    fitted : numpy.ndarray of bool, shape (n,)
        Which of the rows that may be looked at these are.
    beside : callable
        Columns of some candidates, by their places, which rise, over the other rows, weighted;
        shape (gains, n_other). Over all rows where those that are held are in single precision.
    known : dict of int to numpy.ndarray
        What was asked for last.
    """

    candidates: tuple[Candidate, ...]
    slices: tuple[slice, ...]
    blocks: tuple[Block, ...]
    fitted: Mask
    beside: _Beside
    known: dict[int, FloatArray] = field(default_factory=dict, compare=False, repr=False)

    @property
    def gains(self) -> int:
        """How many columns there are."""
        return max((own.stop for own in self.slices), default=0)

    @cached_property
    def alike(self) -> tuple[Alike, ...]:
        """The candidates by their number of gains."""
        numbers = {own.stop - own.start for own in self.slices}
        return tuple(Alike.of(self, number) for number in sorted(numbers))

    @classmethod
    def of(
        cls,
        evidence: Evidence,
        plant: Plant,
        nuisances: Nuisances,
        candidates: Sequence[Candidate],
    ) -> Signatures:
        """Signatures along the measured motion of every recording; what swings comes last."""
        swinging = [each for each in candidates if each.resonance > 0.0]
        sloping = [each for each in candidates if each.resonance == 0.0]
        candidates, fitted = (*sloping, *swinging), evidence.fitted
        slices = _slices(candidates)
        at = slices[len(sloping) - 1].stop if sloping else 0
        weights = tuple(rows.weight for rows in evidence.shown)
        seen = _Seen(evidence, plant, nuisances, weights)
        swung = seen.swing_columns(swinging)
        # Simulations cost more than to hold what they came to.
        bytes_of_all = 8 * slices[-1].stop * np.count_nonzero(fitted) if slices else 0
        single = not evidence.simulated and bytes_of_all > BUDGET
        others = np.ones_like(fitted) if single else ~fitted
        held = seen.slope_columns(sloping, others) if evidence.simulated else None
        blocks = seen.blocks(sloping, fitted, single=single)
        if swinging:
            blocks.append(Block(at, slice(0, int(fitted.sum())), swung[:, fitted]))
        swung = swung[:, others]

        def beside(places: Sequence[int]) -> FloatArray:
            wanted = [k for k in places if k < len(sloping)]
            if held is None:
                found = seen.slope_columns([candidates[k] for k in wanted], others)
            else:
                found = held[_columns(slices, wanted)]
            return np.concatenate([found, swung[[k - len(sloping) for k in places[len(wanted) :]]]])

        return cls(candidates, slices, tuple(blocks), fitted, beside)

    @classmethod
    def from_columns(
        cls, candidates: Sequence[Candidate], columns: FloatArray, fitted: Mask
    ) -> Signatures:
        """Of columns of all rows that are there already, shape (n, gains)."""
        slices = _slices(candidates)
        own, others = np.ascontiguousarray(columns[fitted].T), columns[~fitted].T
        block = Block(0, slice(0, own.shape[1]), own)
        return cls(
            tuple(candidates),
            slices,
            (block,),
            fitted,
            lambda places: others[_columns(slices, places)],
        )

    def second_of(self, effect: Effect) -> Signatures:
        """Second waves of an effect: at zero amplitude they look like first ones.

        Its own order is left out: two waves of one order are one wave, of no amplitude in
        particular.
        """
        own = [
            k
            for k, each in enumerate(self.candidates)
            if each.name == effect.name and not _same_order(each, effect)
        ]
        # Their columns lie side by side, apart from those of other effects.
        slices = [self.slices[k] for k in own]
        begin = min((each.start for each in slices), default=0)
        end = max((each.stop for each in slices), default=0)
        found = (block.of(slice(begin, end)) for block in self.blocks)
        return Signatures(
            tuple(replace(self.candidates[k], second=True) for k in own),
            tuple(slice(each.start - begin, each.stop - begin) for each in slices),
            tuple(replace(block, first=block.first - begin) for block in found if block),
            self.fitted,
            lambda places: self.beside([own[k] for k in places]),
        )

    @property
    def single(self) -> bool:
        """Whether columns are held in single precision."""
        return any(block.values.dtype == np.float32 for block in self.blocks)

    def ask(self, indices: Sequence[int]) -> None:
        """Makes what is not held of some candidates, all at once."""
        new = sorted(set(indices) - self.known.keys())
        if not new or (np.all(self.fitted) and not self.single):
            return
        if len(self.known) + len(new) > FEW:
            self.known.clear()
            new = sorted(set(indices))
        ends = np.cumsum([self.slices[k].stop - self.slices[k].start for k in new])
        self.known.update(zip(new, np.split(self.beside(new), ends[:-1]), strict=True))

    def columns_of_fit(self, index: int) -> FloatArray:
        """Columns of one candidate over the fitted rows; shape (n_fit, q)."""
        if self.single:
            self.ask([index])
            return self.known[index][:, self.fitted].T
        own = self.slices[index]
        found = np.zeros((own.stop - own.start, int(self.fitted.sum())))
        for block in self.blocks:
            part = block.of(own)
            if part is not None:
                start = part.first - own.start
                found[start : start + len(part.values), part.rows] = part.values
        return found.T

    def whole(self, index: int) -> FloatArray:
        """Columns of one candidate over all rows that may be looked at; shape (n, q)."""
        self.ask([index])
        if self.single:
            return self.known[index].T
        own = self.columns_of_fit(index)
        columns = np.empty((len(self.fitted), own.shape[1]))
        columns[self.fitted] = own
        if index in self.known:
            columns[~self.fitted] = self.known[index].T
        return columns

    def contribution(self, index: int, gains: FloatArray) -> FloatArray:
        """What gains of a candidate explain of all rows that may be looked at; shape (n,)."""
        found: FloatArray = self.whole(index) @ gains
        return found

    def products(self, vectors: FloatArray) -> FloatArray:
        """Sᵀ times columns of the fitted rows, shape (n_fit,) or (n_fit, k); shape (gains, …)."""
        found = np.zeros((self.gains, *vectors.shape[1:]))
        for block in self.blocks:
            for own, values in block.parts():
                found[own] += values @ vectors[block.rows]
        return found

    def products_by(self, vector: FloatArray, pieces: np.ndarray) -> FloatArray:
        """Sᵀ times a column of the fitted rows, each piece by itself; shape (gains, pieces).

        ``pieces`` tells of each fitted row to which of them it belongs; those of one are
        neighbours, but for where a recording ends.
        """
        found = np.zeros((self.gains, int(pieces.max()) + 1))
        for block in self.blocks:
            piece, within = pieces[block.rows], vector[block.rows]
            ends = [0, *(np.flatnonzero(np.diff(piece)) + 1).tolist(), len(piece)]
            for own, values in block.parts():
                for start, stop in pairwise(ends):
                    found[own, piece[start]] += values[:, start:stop] @ within[start:stop]
        return found


@dataclass(frozen=True)
class _Seen:
    """A plant along the recordings, and the weights of these."""

    evidence: Evidence
    plant: Plant
    nuisances: Nuisances
    weights: tuple[float, ...]

    def swing_columns(self, candidates: Sequence[Candidate]) -> FloatArray:
        """What swings, by all rows: what a little of it changes; shape (candidates, n)."""
        columns = np.empty((len(candidates), len(self.evidence.weights)))
        if candidates:
            still = finite(self.evidence.residual(self.plant, self.nuisances))
        for column, each in zip(columns, candidates, strict=True):
            size = gain_at(each, self.plant.inertia)
            with_it = with_effect(self.plant, each, [size])
            column[:] = (still - finite(self.evidence.residual(with_it, self.nuisances))) / size
        return finite(columns)

    def slope_columns(self, candidates: Sequence[Candidate], rows: Mask) -> FloatArray:
        """Columns over some of all rows, shape (n,); shape (gains, rows)."""
        number = _slices(candidates)[-1].stop if candidates else 0
        if number == 0 or not np.any(rows):
            return np.zeros((number, int(rows.sum())))
        found = np.empty((number, int(rows.sum())))
        for block in self.blocks(candidates, rows):
            found[block.first : block.first + len(block.values), block.rows] = block.values
        return found

    def blocks(
        self, candidates: Sequence[Candidate], rows: Mask, *, single: bool = False
    ) -> list[Block]:
        """The same a recording each, with their place among the rows that are wanted.

        ``single`` asks for columns in single precision, made a part of them at a time.
        """
        slices, shown = _slices(candidates), self.evidence.shown
        if not slices:
            return []
        ends = np.cumsum([0, *(np.count_nonzero(each.mask) for each in shown)]).tolist()
        places, at = [], 0
        for each, weight, within in zip(shown, self.weights, pairwise(ends), strict=True):
            kept = np.flatnonzero(each.mask)[rows[slice(*within)]]
            if len(kept):
                places.append((each, weight, kept, slice(at, at + len(kept))))
            at += len(kept)
        # In one piece: of many smaller ones freed memory does not find its way back.
        all_of = np.empty((slices[-1].stop if single else 0, at), dtype=np.float32)

        def at_once(rows: int) -> int:
            return max(MADE // (16 * rows), len(slices) // OFTEN) if single else len(slices)

        def seen(place: tuple[Rows, float, Places, slice]) -> Block:
            each, weight, kept, at = place
            start = self.nuisances.start(each.index)
            for piece in _pieces(len(slices), at_once(len(kept))):
                wanted = [(one.name, dict(one.shape)) for one in candidates[piece]]
                # Hundreds of columns: each is written once, in one piece.
                values = (
                    each.form.with_leader(self.nuisances.leader)
                    .signatures(self.plant, wanted, start, kept)
                    .T
                )
                values *= -weight
                values = finite(values)
                if single:
                    first, last = slices[piece][0].start, slices[piece][-1].stop
                    all_of[first:last, at] = values
            return Block(0, at, all_of[:, at] if single else values)

        return self.evidence.each(seen, places)


def _pieces(number: int, at_once: int) -> list[slice]:
    """So many, some at a time."""
    some = max(1, at_once)
    return [slice(k, min(k + some, number)) for k in range(0, number, some)]


def _slices(candidates: Sequence[Candidate]) -> tuple[slice, ...]:
    """Columns of each candidate, one after the other."""
    ends = np.cumsum([0, *(len(each.record.gains) for each in candidates)]).tolist()
    return tuple(slice(start, stop) for start, stop in pairwise(ends))


def _columns(slices: Sequence[slice], places: Sequence[int]) -> list[int]:
    """Columns of some of the candidates."""
    return [k for place in places for k in range(slices[place].start, slices[place].stop)]


def gain_at(candidate: Candidate, inertia: float) -> float:
    """The compliance at which a mass behind a shaft swings at the resonance of a candidate."""
    share = candidate.shape["inertia_share"]
    return 1.0 / ((2.0 * math.pi * candidate.resonance) ** 2 * share * (1.0 - share) * inertia)


def _same_order(candidate: Candidate, effect: Effect) -> bool:
    """Whether a refit of the candidate may come to the order that the effect has."""
    for name, value in candidate.shape.items():
        low, high = candidate.limits.get(name, (value, value))
        if not low <= effect.parameters[name].value <= high:
            return False
    return True
