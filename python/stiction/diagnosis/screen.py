"""Efficient scores (Rao): what each effect would explain, without refitting anything."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Final

import numpy as np

from ..finite import finite
from ..fitting.rows import Nuisances, Rows
from ..plant import Plant
from ..recording.checks.signal import runs
from ..stated import Effect
from ..trajectory import FloatArray
from .candidates import Candidate
from .evidence import Evidence, Plan
from .influence import limited
from .model import with_effect
from .regression import bounded, project

__all__ = [
    "NULL_DEVIATIONS",
    "NULL_TIMES",
    "Problem",
    "Score",
    "Signatures",
    "likelier",
    "screen",
]

NULL_TIMES: Final = 1.3
"""A score counts above this many times the greatest one that the surrogates reach."""
NULL_DEVIATIONS: Final = 5.0
"""And above the surrogates' mean by this many standard deviations."""
FLIPS: Final = 7
"""Seed of the signs by which blocks are turned round: always the same."""
DEPENDENT: Final = 1e-12
"""Least eigenvalue of columns of size 1 below which they are taken as one and the same."""
IMITATED: Final = 1e-10
"""Share of a signature's power that must lie outside the base: less is what rounding leaves."""
SEEN_SIZE: Final = 0.02
"""An effect whose effort is this share of the friction must be seen, or it is not testable."""


@dataclass(frozen=True)
class _Alike:
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
        Bounds of the gains.
    """

    places: np.ndarray
    own: np.ndarray
    normal: FloatArray
    low: FloatArray
    high: FloatArray

    @classmethod
    def of(cls, signatures: Signatures, number: int) -> _Alike:
        """Those with so many gains."""
        slices = signatures.slices
        places = [k for k, own in enumerate(slices) if own.stop - own.start == number]
        parts = [signatures.over_fitted[:, slices[k]] for k in places]
        bounds = np.array([_bounds(signatures.candidates[k]) for k in places])
        return cls(
            np.array(places),
            np.array([range(slices[k].start, slices[k].stop) for k in places]),
            np.array([part.T @ part for part in parts]),
            bounds[:, 0],
            bounds[:, 1],
        )


@dataclass(frozen=True)
class Signatures:
    """Derivatives of what the plant needs by the gains of candidates, at zero gain.

    The residual is what is measured less what is needed: a signature that resembles it is missing.

    Attributes
    ----------
    candidates : tuple of Candidate
    columns : numpy.ndarray, shape (n, gains)
        Weighted, of the rows that may be looked at; each in one piece.
    slices : tuple of slice
        Columns of each candidate.
    over_fitted : numpy.ndarray, shape (n_fit, gains)
        The same of the fitted rows alone: tens of megabytes, which every round reads.
    """

    candidates: tuple[Candidate, ...]
    columns: FloatArray
    slices: tuple[slice, ...]
    over_fitted: FloatArray

    @cached_property
    def alike(self) -> tuple[_Alike, ...]:
        """The candidates by their number of gains."""
        numbers = {own.stop - own.start for own in self.slices}
        return tuple(_Alike.of(self, number) for number in sorted(numbers))

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
        candidates = [*sloping, *swinging]
        wanted = [(each.name, dict(each.shape)) for each in sloping]
        slices, at = [], 0
        for each in candidates:
            slices.append(slice(at, at + len(each.record.gains)))
            at += len(each.record.gains)
        at_most = sum(len(each.record.gains) for each in sloping)
        # Hundreds of columns: each is written once, in one piece, and never copied whole.
        columns = np.empty((at, len(evidence.weights)))
        if swinging:
            still = finite(evidence.residual(plant, nuisances))
        for place, each in enumerate(swinging, at_most):
            size = _gain_at(each, plant.inertia)
            swung = finite(evidence.residual(with_effect(plant, each, [size]), nuisances))
            columns[place] = (still - swung) / size

        def fill(place: tuple[Rows, slice]) -> None:
            rows, own = place
            found = rows.form.signatures(plant, wanted, nuisances.start(rows.index))
            at = own.start
            sloped = columns[:at_most, :]
            for first, last in runs(rows.mask):
                end = at + last - first
                np.multiply(found.T[:, first:last], -rows.weight, out=sloped[:, at:end])
                at = end

        ends = np.cumsum([np.count_nonzero(rows.mask) for rows in evidence.shown]).tolist()
        places = [slice(*ends) for ends in pairwise([0, *ends])]
        evidence.each(fill, list(zip(evidence.shown, places, strict=True)))
        columns = finite(columns)
        over_fitted = columns
        if not np.all(evidence.fitted):
            parts = [columns[:, i:j] for i, j in runs(evidence.fitted)]
            over_fitted = np.concatenate(parts, axis=1)
        return cls(tuple(candidates), columns.T, tuple(slices), over_fitted.T)

    @classmethod
    def single(cls, evidence: Evidence, candidate: Candidate, column: FloatArray) -> Signatures:
        """What a candidate of one gain explains by a column of its own, shape (n,)."""
        columns = column[:, None]
        return cls((candidate,), columns, (slice(0, 1),), columns[evidence.fitted])

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
        first = min((each.start for each in slices), default=0)
        end = max((each.stop for each in slices), default=0)
        return Signatures(
            tuple(replace(self.candidates[k], second=True) for k in own),
            self.columns[:, first:end],
            tuple(slice(each.start - first, each.stop - first) for each in slices),
            self.over_fitted[:, first:end],
        )


def _gain_at(candidate: Candidate, inertia: float) -> float:
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


@dataclass(frozen=True)
class Problem:
    """What is to be explained, and by what it is explained already.

    Attributes
    ----------
    residual : numpy.ndarray, shape (n,)
        Weighted, less the bias that the surrogates show.
    base : numpy.ndarray, shape (n, p)
        Derivatives by the parameters of the base and by nuisances.
    null : numpy.ndarray, shape (n, surrogates)
        Residuals in which nothing is to be found.
    block : numpy.ndarray of int, shape (n,)
        Block of 1 s of each row.
    fitted : numpy.ndarray of bool, shape (n,)
    plans : sequence of Plan
    """

    residual: FloatArray
    base: FloatArray
    null: FloatArray
    block: np.ndarray
    fitted: np.ndarray
    plans: Sequence[Plan]


@dataclass(frozen=True)
class Score:
    """How much of the residual one effect would explain, at the best point of its grid.

    Attributes
    ----------
    candidate : Candidate
    gains : numpy.ndarray, shape (q,)
        Estimated gains.
    score : float
        ΔR²: share of the residual's power over the fitted rows.
    threshold : float
        What the score must exceed: from the surrogates of this data set.
    heldout : float
        Share of the power over the rows held out, with the gains of the fitted ones.
    left : float
        Share of the signature's power that the base cannot imitate.
    visible : float
        Score that the effect would have if its effort were 2 % of the friction.
    signature : numpy.ndarray, shape (n_fit,)
        What the effect contributes, base projected off.
    """

    candidate: Candidate
    gains: FloatArray
    score: float
    threshold: float
    heldout: float
    left: float
    visible: float
    signature: FloatArray

    @property
    def testable(self) -> bool:
        """Whether these data could show the effect at all."""
        return max(self.score, self.visible) > self.threshold


def likelier(scores: Sequence[Score]) -> list[Score]:
    """The score of every effect in its likelier form, highest first.

    Of two forms one that can be tested, that beats noise, that explains more.
    """
    best: dict[str, Score] = {}
    for score in scores:
        other = best.get(score.candidate.name)
        if other is None or _stands(score) > _stands(other):
            best[score.candidate.name] = score
    return sorted(best.values(), key=lambda s: -s.score)


def _stands(score: Score) -> tuple[bool, bool, float]:
    return score.testable, score.score > score.threshold, score.score


def screen(problem: Problem, signatures: Signatures, friction: float) -> list[Score]:
    """The score of every form of every effect at its best shape, highest first.

    With S⊥ = S − QQᵀS (Q spans the base): η = (S⊥ᵀS⊥)⁻¹·S⊥ᵀr, ΔR² = ηᵀS⊥ᵀr/(r⊥ᵀr⊥). The same is
    computed for every surrogate, with its maximum over the grid: shapes mean nothing where the
    effect is absent (Davies, Biometrika 64 (1977)), so no table of chi-square applies.

    ``friction`` is the weighted rms of the friction, against which sizes are measured.
    """
    base = project(problem.base, Plan(problem.fitted, problem.fitted))
    fitted, columns = problem.fitted, signatures.over_fitted
    # What is free of the base has the same products with columns as with what is left of them.
    residual, null = base.off(problem.residual[fitted]), base.off(problem.null[fitted])
    power = max(float(residual @ residual), 1e-300)
    scan = _Scan.of(signatures, base.share(columns))
    gains, explained = scan.regressed(columns.T @ residual)
    forms = [candidate.form for candidate in signatures.candidates]
    best: dict[str, int] = {}
    for index, form in enumerate(forms):
        if form not in best or explained[index] > explained[best[form]]:
            best[form] = index
    heldout = _heldout(problem, signatures, list(best.values()))
    # What explains most and carries over: taken out for the thresholds of all others.
    carrying = [index for index in best.values() if heldout[index] > 0.0]
    strongest = max(carrying or best.values(), key=lambda index: explained[index])
    parts = {index: base.off(columns[:, signatures.slices[index]]) for index in best.values()}
    unexplained = residual - parts[strongest] @ gains[strongest]
    flips = _flipped(unexplained, problem.block[fitted], null.shape[1])
    null_power = np.maximum(np.sum(null**2, axis=0), 1e-300)
    noise = scan.explained(columns.T @ null) / null_power
    turned = scan.explained(columns.T @ base.off(flips)) / power
    own = {form: np.array(forms) == form for form in best}
    thresholds = {form: _threshold(noise[rows], turned[rows]) for form, rows in own.items()}
    most = max(best.values(), key=lambda index: explained[index])
    if most != strongest:
        # What acts in a few seconds explains them whichever way they are turned: for it alone what
        # is left of it is turned, whether or not it carries over.
        rest = _flipped(residual - parts[most] @ gains[most], problem.block[fitted], null.shape[1])
        rows = own[forms[most]]
        again = scan.explained(columns.T @ base.off(rest))[rows] / power
        thresholds[forms[most]] = min(thresholds[forms[most]], _threshold(noise[rows], again))
    scores = []
    for form, index in best.items():
        total = float(np.sum(columns[:, signatures.slices[index]] ** 2))
        left = float(np.sum(parts[index] ** 2)) / total if total > 0.0 else 0.0
        left = left if left > IMITATED else 0.0
        scores.append(
            Score(
                candidate=signatures.candidates[index],
                gains=gains[index],
                score=float(explained[index]) / power,
                threshold=thresholds[form],
                heldout=heldout[index],
                left=left,
                visible=left * len(residual) * (SEEN_SIZE * friction) ** 2 / power,
                signature=parts[index] @ gains[index],
            )
        )
    return sorted(scores, key=lambda s: -s.score)


@dataclass(frozen=True)
class _Scan:
    """The regression on every candidate by itself, from products of columns alone.

    A candidate has a few columns and there are hundreds of them: what is summed over rows is summed
    for all of them at once.

    Attributes
    ----------
    alike : tuple of _Alike
    normal : list of numpy.ndarray, shape (m, q, q)
        S⊥ᵀS⊥ of the candidates of each of them.
    inverse : list of numpy.ndarray, shape (m, q, q)
        0 where columns are not independent, or where the base imitates one of them.
    """

    alike: tuple[_Alike, ...]
    normal: list[FloatArray]
    inverse: list[FloatArray]

    @classmethod
    def of(cls, signatures: Signatures, within: FloatArray) -> _Scan:
        """Of columns that lie within the base by these shares, shape (p, columns)."""
        normal, inverse = [], []
        for some in signatures.alike:
            inside = within[:, some.own].transpose(1, 2, 0)
            left = some.normal - inside @ inside.transpose(0, 2, 1)
            shown = _diagonals(left) > IMITATED * _diagonals(some.normal)
            normal.append(left)
            inverse.append(np.where(np.all(shown, axis=1)[:, None, None], _inverses(left), 0.0))
        return cls(signatures.alike, normal, inverse)

    def regressed(self, products: FloatArray) -> tuple[list[FloatArray], FloatArray]:
        """Gains of each candidate within their bounds, and the power that they take away.

        ``products`` is Sᵀr, shape (columns,).
        """
        number = sum(len(some.places) for some in self.alike)
        gains, explained = [np.zeros(0)] * number, np.zeros(number)
        for some, normal, inverse in zip(self.alike, self.normal, self.inverse, strict=True):
            product = products[some.own]
            best = np.einsum("kij,kj->ki", inverse, product)
            best = bounded(normal, product, best, some.low, some.high)
            taken = 2.0 * np.sum(best * product, axis=1)
            explained[some.places] = taken - np.einsum("ki,kij,kj->k", best, normal, best)
            for place, own in zip(some.places.tolist(), best, strict=True):
                gains[place] = own
        return gains, explained

    def explained(self, products: FloatArray) -> FloatArray:
        """Power of each of many residuals that each candidate takes away, gains without bounds.

        Shapes (columns, residuals) and (candidates, residuals).
        """
        number = sum(len(some.places) for some in self.alike)
        powers = np.zeros((number, products.shape[1]))
        for some, inverse in zip(self.alike, self.inverse, strict=True):
            product = products[some.own]
            powers[some.places] = np.sum(product * (inverse @ product), axis=1)
        return powers


def _diagonals(matrices: FloatArray) -> FloatArray:
    """Shapes (m, q, q) and (m, q)."""
    found: FloatArray = np.diagonal(matrices, axis1=1, axis2=2)
    return found


def _inverses(normal: FloatArray) -> FloatArray:
    """Inverses of normal matrices, 0 where columns are not independent; shape (m, q, q)."""
    size = np.sqrt(np.maximum(_diagonals(normal), 0.0))
    sized = np.all(size > 0.0, axis=1)
    size = np.where(sized[:, None], size, 1.0)
    both = size[:, :, None] * size[:, None, :]
    scaled = np.where(sized[:, None, None], normal / both, np.eye(size.shape[1]))
    single = size.shape[1] == 1
    told = sized if single else sized & (np.linalg.eigvalsh(scaled)[:, 0] >= DEPENDENT)
    scaled = np.where(told[:, None, None], scaled, np.eye(size.shape[1]))
    return np.where(told[:, None, None], np.linalg.inv(scaled) / both, 0.0)


def _flipped(residual: FloatArray, block: np.ndarray, number: int) -> FloatArray:
    """The residual with the sign of each block drawn anew, a number of times.

    Surrogates hold noise alone. What a law's own curve misses is no noise: it lasts longer and
    resembles more. Turned round block by block it keeps that, and explains nothing as a whole
    (wild bootstrap over blocks, Wu, Ann. Statist. 14 (1986)).
    """
    source = np.random.default_rng(FLIPS)
    signs = source.choice([-1.0, 1.0], (int(block.max()) + 1, number))
    flipped: FloatArray = residual[:, None] * signs[block]
    return flipped


def _threshold(noise: FloatArray, turned: FloatArray) -> float:
    """What neither surrogates nor turned blocks reach, over the whole grid, with a margin.

    Shapes (grid, residuals).
    """
    null, flips = np.max(noise, axis=0), np.max(turned, axis=0)
    spread = float(np.std(null, ddof=1)) if len(null) > 1 else 0.0
    return max(
        NULL_TIMES * float(np.max(null)),
        float(np.mean(null)) + NULL_DEVIATIONS * spread,
        NULL_TIMES * float(np.max(flips)),
    )


def _bounds(candidate: Candidate) -> tuple[list[float], list[float]]:
    """Bounds of the gains: a delay is not negative."""
    low, high = zip(*candidate.bounds, strict=True)
    return list(low), list(high)


def _heldout(problem: Problem, signatures: Signatures, chosen: Sequence[int]) -> dict[int, float]:
    """Share of the held-out power that each chosen candidate removes, over all plans."""
    number = int(problem.block.max()) + 1
    before = np.zeros(number)
    after = {index: np.zeros(number) for index in chosen}
    for plan in problem.plans:
        base = project(problem.base, plan)
        residual = base.project(problem.residual)
        block = problem.block[plan.held]
        before += np.bincount(block, residual.held**2, number)
        for index in chosen:
            part = base.project(signatures.columns[:, signatures.slices[index]])
            normal, product = part.fit.T @ part.fit, part.fit.T @ residual.fit
            (inverse,) = _inverses(normal[None])
            low, high = map(np.array, _bounds(signatures.candidates[index]))
            (gains,) = bounded(
                normal[None], product[None], (inverse @ product)[None], low[None], high[None]
            )
            left = residual.held - part.held @ gains
            after[index] += np.bincount(block, left**2, number)
    shares = {}
    for index in chosen:
        one, two = limited(before, after[index])
        shares[index] = 1.0 - float(two.sum() / one.sum()) if one.sum() > 0.0 else 0.0
    return shares
