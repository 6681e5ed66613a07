"""Efficient scores (Rao): what each effect would explain, without refitting anything."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Final

import numpy as np

from ..._support.arrays import FloatArray
from ...fitting.angular import Angular
from ..data.evidence import Plan
from ..data.influence import limit_influence
from ..defaults import ALPHA
from .candidates import Candidate
from .folds import over_plans
from .regression import bounded_gains, project
from .signatures import Alike, Signatures

__all__ = [
    "NULL_TIMES",
    "Problem",
    "Score",
    "likelier",
    "screen",
]

NULL_TIMES: Final = 1.3
"""A score counts above this many times the greatest one that the surrogates reach."""
FORMS: Final = 11.0
"""Independent forms as which the 25 or so that are screened count: what their contributions have in
common leaves 11 to 14 (effective number of tests; Li and Ji, Heredity 95 (2005))."""
EULER: Final = 0.5772156649015329
"""Mean of Gumbel's distribution of scale 1."""
FLIPS: Final = 7
"""Seed of the signs by which blocks are turned round: always the same."""
DEPENDENT: Final = 1e-12
"""Least eigenvalue of columns of size 1 below which they are taken as one and the same."""
IMITATED: Final = 1e-10
"""Share of a signature's power that must lie outside the base: less is what rounding leaves."""
SEEN_SIZE: Final = 0.02
"""An effect whose effort is this share of the friction must be seen, or it is not testable."""


@dataclass(frozen=True)
class Problem:
    """What is to be explained, and by what it is explained already.

    Attributes
    ----------
    residual : numpy.ndarray, shape (n,)
        Weighted, less the bias that the surrogates show.
    base : Angular
        Derivatives by the parameters of the base and by nuisances.
    null : numpy.ndarray, shape (n_fit, surrogates)
        Residuals of the fitted rows in which nothing is to be found.
    block : numpy.ndarray of int, shape (n,)
        Block of 1 s of each row.
    fitted : numpy.ndarray of bool, shape (n,)
    plans : sequence of Plan
    """

    residual: FloatArray
    base: Angular
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
    signature : numpy.ndarray of float32, shape (n_fit,)
        What the effect contributes, base projected off: for angles between effects alone.
    """

    candidate: Candidate
    gains: FloatArray
    score: float
    threshold: float
    heldout: float
    left: float
    visible: float
    signature: np.ndarray[Any, np.dtype[np.float32]]

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


def screen(
    problem: Problem, signatures: Signatures, friction: float, alpha: float = ALPHA
) -> list[Score]:
    """The score of every form of every effect at its best shape, highest first.

    With S⊥ = S − QQᵀS (Q spans the base): η = (S⊥ᵀS⊥)⁻¹·S⊥ᵀr, ΔR² = ηᵀS⊥ᵀr/(r⊥ᵀr⊥). The same is
    computed for every surrogate, with its maximum over the grid: shapes mean nothing where the
    effect is absent (Davies, Biometrika 64 (1977)), so no table of chi-square applies.

    ``friction`` is the weighted rms of the friction, against which sizes are measured, and
    ``alpha`` the probability that any form passes in a session in which nothing is missing.
    """
    base = project(problem.base, Plan(problem.fitted, problem.fitted))
    fitted = problem.fitted
    # What is free of the base has the same products with columns as with what is left of them.
    residual, null = base.off(problem.residual[fitted]), base.off(problem.null)
    power = max(float(residual @ residual), 1e-300)
    # All at once: columns are gone through no more often than has to be.
    directions = base.directions
    products = signatures.products(np.column_stack([residual, directions.matrix(), null]))
    count = 1 + directions.size
    within, of_null = products[:, 1:count].T, products[:, count:]
    scan = _Scan.of(signatures, within)
    gains, explained = scan.regress(products[:, 0])
    forms = [candidate.form for candidate in signatures.candidates]
    best: dict[str, int] = {}
    for index, form in enumerate(forms):
        if form not in best or explained[index] > explained[best[form]]:
            best[form] = index
    chosen = list(best.values())
    signatures.ask(chosen)
    if signatures.single:
        # They chose; what counts of what was chosen is measured again.
        for index in chosen:
            part = base.off(signatures.columns_of_fit(index))
            gains[index], explained[index] = _measured(part, residual, signatures.candidates[index])
    heldout = _heldout(problem, signatures, chosen)
    # What explains most and carries over: taken out for the thresholds of all others.
    carrying = [index for index in best.values() if heldout[index] > 0.0]
    strongest = max(carrying or best.values(), key=lambda index: explained[index])
    unexplained = residual - base.off(signatures.columns_of_fit(strongest)) @ gains[strongest]
    null_power = np.maximum(np.sum(null**2, axis=0), 1e-300)
    noise = scan.explained_power(of_null) / null_power
    turn = _Turned(signatures, directions, within, problem.block[fitted], null.shape[1])
    turned = scan.explained_power(turn.products(unexplained)) / power
    own = {form: np.array(forms) == form for form in best}
    thresholds = {form: _threshold(noise[rows], turned[rows], alpha) for form, rows in own.items()}
    most = max(best.values(), key=lambda index: explained[index])
    if most != strongest:
        # What acts in a few seconds explains them whichever way they are turned: for it alone what
        # is left of it is turned, whether or not it carries over.
        rest = residual - base.off(signatures.columns_of_fit(most)) @ gains[most]
        rows = own[forms[most]]
        again = scan.explained_power(turn.products(rest))[rows] / power
        thresholds[forms[most]] = min(
            thresholds[forms[most]], _threshold(noise[rows], again, alpha)
        )
    scores = []
    for form, index in best.items():
        column = signatures.columns_of_fit(index)
        total = float(np.sum(column**2))
        part = base.off(column)
        left = float(np.sum(part**2)) / total if total > 0.0 else 0.0
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
                signature=(part @ gains[index]).astype(np.float32),
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
    alike : tuple of Alike
    normal : list of numpy.ndarray, shape (m, q, q)
        S⊥ᵀS⊥ of the candidates of each of them.
    inverse : list of numpy.ndarray, shape (m, q, q)
        0 where columns are not independent, or where the base imitates one of them.
    """

    alike: tuple[Alike, ...]
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

    def regress(self, products: FloatArray) -> tuple[list[FloatArray], FloatArray]:
        """Gains of each candidate within their bounds, and the power that they take away.

        ``products`` is Sᵀr, shape (columns,).
        """
        number = sum(len(some.places) for some in self.alike)
        gains, explained = [np.zeros(0)] * number, np.zeros(number)
        for some, normal, inverse in zip(self.alike, self.normal, self.inverse, strict=True):
            product = products[some.own]
            best = np.einsum("kij,kj->ki", inverse, product)
            best = bounded_gains(normal, product, best, some.low, some.high)
            taken = 2.0 * np.sum(best * product, axis=1)
            explained[some.places] = taken - np.einsum("ki,kij,kj->k", best, normal, best)
            for place, own in zip(some.places.tolist(), best, strict=True):
                gains[place] = own
        return gains, explained

    def explained_power(self, products: FloatArray) -> FloatArray:
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


@dataclass(frozen=True)
class _Turned:
    """Products of what is left of columns with a residual whose blocks are turned round at random.

    Surrogates hold noise alone. What a law's own curve misses is no noise: it lasts longer and
    resembles more. Turned round block by block it keeps that, and explains nothing as a whole
    (wild bootstrap over blocks, Wu, Ann. Statist. 14 (1986)). Products of each block are all that
    is asked of the rows.

    Attributes
    ----------
    signatures : Signatures
    directions : Angular
        Of the base, Q.
    within : numpy.ndarray, shape (p, columns)
        QᵀS.
    block : numpy.ndarray of int, shape (n_fit,)
    number : int
        How often signs are drawn.
    """

    signatures: Signatures
    directions: Angular
    within: FloatArray
    block: np.ndarray
    number: int

    def products(self, residual: FloatArray) -> FloatArray:
        """Shape (columns, number)."""
        source = np.random.default_rng(FLIPS)
        blocks = int(self.block.max()) + 1
        signs = source.choice([-1.0, 1.0], (blocks, self.number))
        own = self.signatures.products_by(residual, self.block) @ signs
        base = self.directions.sums_by(self.block, residual)
        found: FloatArray = own - self.within.T @ (base.T @ signs)
        return found


def _threshold(noise: FloatArray, turned: FloatArray, alpha: float) -> float:
    """What neither surrogates nor turned blocks reach over the grid; shapes (grid, residuals).

    Noise passes in any form with a probability of ``alpha``, as far as the greatest of a grid are
    Gumbel's, taken by moments (the limit of a maximum of chi-squares; Davies, Biometrika 74 (1987),
    bounds it alike). Mean and spread of few are uncertain: a margin over the greatest of them all
    is asked for as well.
    """
    null, flips = np.max(noise, axis=0), np.max(turned, axis=0)
    spread = float(np.std(null, ddof=1)) if len(null) > 1 else 0.0
    rare = -math.log(-math.log1p(-alpha / FORMS))
    return max(
        NULL_TIMES * float(np.max(null)),
        float(np.mean(null)) + math.sqrt(6.0) / math.pi * spread * (rare - EULER),
        NULL_TIMES * float(np.max(flips)),
    )


def _measured(
    part: FloatArray, residual: FloatArray, candidate: Candidate
) -> tuple[FloatArray, float]:
    """Gains of one candidate within its bounds, and the power that they take away.

    Shapes (n_fit, q) and (n_fit,), the base taken off both.
    """
    normal, product = part.T @ part, part.T @ residual
    (inverse,) = _inverses(normal[None])
    low, high = np.array(candidate.bounds).T
    best = (inverse @ product)[None]
    (gains,) = bounded_gains(normal[None], product[None], best, low[None], high[None])
    return gains, float(2.0 * gains @ product - gains @ normal @ gains)


def _heldout(problem: Problem, signatures: Signatures, chosen: Sequence[int]) -> dict[int, float]:
    """Share of the held-out power that each chosen candidate removes, over all plans."""
    number = int(problem.block.max()) + 1
    before = np.zeros(number)
    after = {index: np.zeros(number) for index in chosen}
    whole = [signatures.whole(index) for index in chosen]
    ends = np.cumsum([1, *(each.shape[1] for each in whole)])
    places = [slice(*within) for within in pairwise(ends.tolist())]
    targets = np.hstack([problem.residual[:, None], *whole])
    for plan, part in zip(
        problem.plans, over_plans(problem.base, targets, problem.plans), strict=True
    ):
        block, own = problem.block[plan.held], part.held[:, 0]
        before += np.bincount(block, own**2, number)
        for index, place in zip(chosen, places, strict=True):
            gains, _ = _measured(part.fit[:, place], part.fit[:, 0], signatures.candidates[index])
            left = own - part.held[:, place] @ gains
            after[index] += np.bincount(block, left**2, number)
    shares = {}
    for index in chosen:
        one, two = limit_influence(before, after[index])
        shares[index] = 1.0 - float(two.sum() / one.sum()) if one.sum() > 0.0 else 0.0
    return shares
