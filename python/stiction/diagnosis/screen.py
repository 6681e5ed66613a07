"""Efficient scores (Rao): what each effect would explain, without refitting anything."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np

from ..finite import finite
from ..fitting.rows import Nuisances, Rows
from ..plant import Effect, Plant
from ..trajectory import FloatArray
from .candidates import Candidate
from .evidence import Evidence, Plan
from .influence import limited
from .regression import project

__all__ = ["NULL_DEVIATIONS", "NULL_TIMES", "Problem", "Score", "Signatures", "screen"]

NULL_TIMES: Final = 1.3
"""A score counts above this many times the greatest one that the surrogates reach."""
NULL_DEVIATIONS: Final = 5.0
"""And above the surrogates' mean by this many standard deviations."""
FLIPS: Final = 7
"""Seed of the signs by which blocks are turned round: always the same."""
DEPENDENT: Final = 1e-12
"""Least eigenvalue of columns of size 1 below which they are taken as one and the same."""
SEEN_SIZE: Final = 0.02
"""An effect whose effort is this share of the friction must be seen, or it is not testable."""


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
    """

    candidates: tuple[Candidate, ...]
    columns: FloatArray
    slices: tuple[slice, ...]

    @classmethod
    def of(
        cls,
        evidence: Evidence,
        plant: Plant,
        nuisances: Nuisances,
        candidates: Sequence[Candidate],
    ) -> Signatures:
        """Signatures along the measured motion of every recording."""
        wanted = [(each.name, dict(each.shape)) for each in candidates]
        slices, at = [], 0
        for each in candidates:
            slices.append(slice(at, at + len(each.record.gains)))
            at += len(each.record.gains)
        # Hundreds of columns: each is written once, in one piece, and never copied whole.
        columns = np.empty((at, len(evidence.weights)))

        def fill(place: tuple[Rows, slice]) -> None:
            rows, own = place
            found = rows.form.signatures(plant, wanted, nuisances.start(rows.index))
            np.multiply(found.T[:, rows.mask], -rows.weight, out=columns[:, own])

        ends = np.cumsum([np.count_nonzero(rows.mask) for rows in evidence.shown]).tolist()
        places = [slice(*ends) for ends in pairwise([0, *ends])]
        evidence.each(fill, list(zip(evidence.shown, places, strict=True)))
        return cls(tuple(candidates), finite(columns).T, tuple(slices))

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
        return Signatures(
            tuple(replace(self.candidates[k], second=True) for k in own),
            self.columns,
            tuple(self.slices[k] for k in own),
        )


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


def screen(problem: Problem, signatures: Signatures, friction: float) -> list[Score]:
    """The score of every effect at its best shape, highest first.

    With S⊥ = S − QQᵀS (Q spans the base): η = (S⊥ᵀS⊥)⁻¹·S⊥ᵀr, ΔR² = ηᵀS⊥ᵀr/(r⊥ᵀr⊥). The same is
    computed for every surrogate, with its maximum over the grid: shapes mean nothing where the
    effect is absent (Davies, Biometrika 64 (1977)), so no table of chi-square applies.

    ``friction`` is the weighted rms of the friction, against which sizes are measured.
    """
    base = project(problem.base, Plan(problem.fitted, problem.fitted))
    fitted = problem.fitted
    residual, null = base.off(problem.residual[fitted]), base.off(problem.null[fitted])
    # Tens of megabytes: one copy, which is changed in its place.
    columns = np.compress(fitted, signatures.columns.T, axis=1).T
    base.take_off(columns)
    power = max(float(residual @ residual), 1e-300)
    scan = _Scan.of(columns, signatures)
    gains, explained = scan.regressed(columns.T @ residual)
    best: dict[str, int] = {}
    for index, candidate in enumerate(signatures.candidates):
        if candidate.name not in best or explained[index] > explained[best[candidate.name]]:
            best[candidate.name] = index
    heldout = _heldout(problem, signatures, list(best.values()))
    # What explains most and carries over: taken out for the thresholds of all others.
    carrying = [index for index in best.values() if heldout[index] > 0.0]
    strongest = max(carrying or best.values(), key=lambda index: explained[index])
    unexplained = residual - columns[:, signatures.slices[strongest]] @ gains[strongest]
    flips = _flipped(unexplained, problem.block[fitted], null.shape[1])
    null_power = np.maximum(np.sum(null**2, axis=0), 1e-300)
    # The columns are free of the base, so what of a residual lies in the base does not matter.
    noise = scan.explained(columns.T @ null) / null_power
    turned = scan.explained(columns.T @ flips) / power
    names = np.array([candidate.name for candidate in signatures.candidates])
    thresholds = {name: _threshold(noise[names == name], turned[names == name]) for name in best}
    scores = []
    for name, index in best.items():
        part = columns[:, signatures.slices[index]]
        whole = signatures.columns[:, signatures.slices[index]][fitted]
        total = float(np.sum(whole**2))
        left = float(np.sum(part**2)) / total if total > 0.0 else 0.0
        scores.append(
            Score(
                candidate=signatures.candidates[index],
                gains=gains[index],
                score=float(explained[index]) / power,
                threshold=thresholds[name],
                heldout=heldout[index],
                left=left,
                visible=left * len(residual) * (SEEN_SIZE * friction) ** 2 / power,
                signature=part @ gains[index],
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
    candidates : tuple of Candidate
    slices : tuple of slice
    normal : list of numpy.ndarray, shape (q, q)
        SᵀS of each candidate.
    inverse : list of numpy.ndarray or None, shape (q, q)
        None where its columns are not independent.
    """

    candidates: tuple[Candidate, ...]
    slices: tuple[slice, ...]
    normal: list[FloatArray]
    inverse: list[FloatArray | None]

    @classmethod
    def of(cls, columns: FloatArray, signatures: Signatures) -> _Scan:
        normal = [columns[:, own].T @ columns[:, own] for own in signatures.slices]
        inverse = [_inverse(matrix) for matrix in normal]
        return cls(signatures.candidates, signatures.slices, normal, inverse)

    def regressed(self, products: FloatArray) -> tuple[list[FloatArray], FloatArray]:
        """Gains of each candidate within their bounds, and the power that they take away.

        ``products`` is Sᵀr, shape (columns,).
        """
        gains, explained = [], np.zeros(len(self.candidates))
        for k, (candidate, own) in enumerate(zip(self.candidates, self.slices, strict=True)):
            inverse, product = self.inverse[k], products[own]
            if inverse is None:
                gains.append(np.zeros(len(product)))
                continue
            best = _bounded(candidate, inverse @ product)
            gains.append(best)
            explained[k] = 2.0 * float(best @ product) - float(best @ self.normal[k] @ best)
        return gains, explained

    def explained(self, products: FloatArray) -> FloatArray:
        """Power of each of many residuals that each candidate takes away, gains without bounds.

        Shapes (columns, residuals) and (candidates, residuals).
        """
        powers = np.zeros((len(self.candidates), products.shape[1]))
        for k, own in enumerate(self.slices):
            inverse = self.inverse[k]
            if inverse is not None:
                powers[k] = np.sum(products[own] * (inverse @ products[own]), axis=0)
        return powers


def _inverse(normal: FloatArray) -> FloatArray | None:
    """Inverse of a normal matrix, None where its columns are not independent."""
    size = np.sqrt(np.diag(normal))
    if not np.all(size > 0.0):
        return None
    scaled = normal / np.outer(size, size)
    if len(size) > 1 and float(np.linalg.eigvalsh(scaled)[0]) < DEPENDENT:
        return None
    inverse: FloatArray = np.linalg.inv(scaled) / np.outer(size, size)
    return inverse


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


def _bounded(candidate: Candidate, gains: FloatArray) -> FloatArray:
    """Gains within their bounds: a delay is not negative."""
    bounds: Mapping[str, tuple[float, float]] = {
        p.name: p.bounds for p in candidate.record.parameters
    }
    low, high = np.array([bounds[name] for name in candidate.gains]).T
    clipped: FloatArray = np.clip(gains, low, high)
    return clipped


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
            inverse = _inverse(part.fit.T @ part.fit)
            gains = np.zeros(part.fit.shape[1])
            if inverse is not None:
                candidate = signatures.candidates[index]
                gains = _bounded(candidate, inverse @ (part.fit.T @ residual.fit))
            left = residual.held - part.held @ gains
            after[index] += np.bincount(block, left**2, number)
    shares = {}
    for index in chosen:
        one, two = limited(before, after[index])
        shares[index] = 1.0 - float(two.sum() / one.sum()) if one.sum() > 0.0 else 0.0
    return shares
