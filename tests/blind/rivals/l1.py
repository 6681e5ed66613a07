"""One penalty over the columns of all effects at once (Tibshirani, J. R. Stat. Soc. B 58 (1996)).

Its weight is that of the fewest columns within one standard error of the best of five folds of
neighbouring blocks; an effect is named if its columns together contribute what is worth a name.
"""

from __future__ import annotations

import numpy as np

from .library import MOST

FOLDS, WEIGHTS, SWEEPS = 5, 24, 60
LOWEST = 1e-3
"""Of the weights, share of the one at which nothing is left."""
COLUMNS = 600
"""Most columns: of an effect with more shapes the likeliest."""


def names(lib):
    own, columns = _columns(lib)
    if not own:
        return []
    fold = lib.block * FOLDS // (int(lib.block.max()) + 1)
    parts = [_products(columns, lib.residual, fold == k) for k in range(FOLDS)]
    whole = [sum(each) for each in zip(*parts, strict=True)]
    weights = np.abs(whole[1]).max() * np.geomspace(1.0, LOWEST, WEIGHTS)
    errors = np.array([_errors(whole, part, weights) for part in parts if part[2] > 0.0])
    mean = errors.mean(axis=0)
    spread = errors.std(axis=0, ddof=1) / np.sqrt(len(errors))
    best = int(np.argmin(mean))
    weight = weights[int(np.argmax(mean <= mean[best] + spread[best]))]
    (gains,) = _path(whole[0], whole[1], [weight])
    powers = {}
    for name in dict.fromkeys(own):
        some = np.array(own) == name
        power = float(np.sum((columns[:, some] @ gains[some]) ** 2))
        if power >= lib.least:
            powers[name] = power
    return sorted(powers, key=lambda name: -powers[name])[:MOST]


def _columns(lib):
    """Columns of length 1, the likeliest shapes of each effect, and the effect of each column."""
    ranked = {}
    for entry in lib.entries:
        ranked.setdefault(entry.name, []).append((-entry.fitted(lib.residual)[1], entry))
    share = max(1, COLUMNS // max(len(ranked), 1))
    own, found = [], []
    for name, some in ranked.items():
        for _, entry in sorted(some, key=lambda pair: pair[0])[:share]:
            own += [name] * entry.columns.shape[1]
            found.append(entry.columns / np.sqrt(np.sum(entry.columns**2, axis=0)))
    return own, np.concatenate(found, axis=1) if found else np.zeros((len(lib.residual), 0))


def _products(columns, residual, rows):
    some, left = columns[rows], residual[rows]
    return some.T @ some, some.T @ left, float(left @ left)


def _errors(whole, part, weights):
    """Held-out power by weight, fitted to all but one part."""
    fitted = [a - b for a, b in zip(whole, part, strict=True)]
    rows = fitted[2] / max(whole[2], 1e-300)
    return [
        part[2] - 2.0 * g @ part[1] + g @ part[0] @ g
        for g in _path(fitted[0], fitted[1], weights * rows)
    ]


def _path(normal, product, weights):
    """Coordinate descent, each weight from where the one before ended."""
    gains, slope = np.zeros(len(product)), np.maximum(np.diagonal(normal), 1e-12)
    left = product.copy()
    for weight in weights:
        for sweep in range(SWEEPS):
            most = 0.0
            # Those that are not zero are gone over more often than all.
            for j in range(len(gains)) if sweep % 10 == 0 else np.flatnonzero(gains):
                old = gains[j]
                pull = left[j] + slope[j] * old
                new = np.sign(pull) * max(abs(pull) - weight, 0.0) / slope[j]
                if new != old:
                    gains[j] = new
                    left -= normal[:, j] * (new - old)
                    most = max(most, abs(new - old) * np.sqrt(slope[j]))
            if most < 1e-4 * weight and sweep % 10:
                break
        yield gains.copy()
