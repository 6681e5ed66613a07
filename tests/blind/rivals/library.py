"""The columns of one session: the residual of its base, and what each effect would change."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

import stiction as st
from stiction.diagnosis.defaults import SMALLEST
from stiction.diagnosis.screening.base import fit_baseline
from stiction.diagnosis.screening.model import fit_model, likeliest_of, step_beside, with_effect
from stiction.diagnosis.screening.regression import bounded_gains
from stiction.diagnosis.screening.signatures import Signatures
from stiction.diagnosis.selection.eligible import eligible_candidates
from stiction.diagnosis.selection.rounds import friction_of
from stiction.diagnosis.selection.search import Search

ALPHA = 0.01
SHARES = (1.0, 0.3, 0.1)
"""Of what slopes say, at which a refit may begin."""
FLAT = 1e-8
"""Directions of the base with less than this share of the strongest one are dropped."""
MOST = 3
"""Names at most: as many causes as a machine is asked for at once."""
PARALLEL = 1e-8
"""Share of a column's power outside the base below which the base imitates it."""


@dataclass(frozen=True)
class Entry:
    """An effect with values of its shapes: its columns, the base projected off."""

    name: str
    columns: np.ndarray  # (n, q)
    low: np.ndarray
    high: np.ndarray
    parameters: int

    def fitted(self, residual):
        """Gains within their bounds, and the power that they take away."""
        normal, product = self.columns.T @ self.columns, self.columns.T @ residual
        best = np.linalg.lstsq(normal, product, rcond=1e-10)[0]
        (gains,) = bounded_gains(
            normal[None], product[None], best[None], self.low[None], self.high[None]
        )
        return gains, float(2.0 * gains @ product - gains @ normal @ gains)


@dataclass(frozen=True)
class Library:
    """Everything that a rival may look at.

    Attributes
    ----------
    residual : numpy.ndarray, shape (n,)
        Weighted, the base projected off.
    entries : list of Entry
    block : numpy.ndarray of int, shape (n,)
        Block of 1 s of each row, in the order of time.
    base : int
        How many directions the base has.
    rows : float
        Independent rows: those that do not lie under one kernel.
    again : callable, optional
        The same beside the base with an entry, refitted; None where the fit fails. Without it, and
        there, the entry is projected off.
    least : float
        Power below which an effect is not worth a name, as for the diagnosis.
    """

    residual: np.ndarray
    entries: list[Entry]
    block: np.ndarray
    base: int
    rows: float
    least: float
    again: Callable[[Entry, np.ndarray], Library | None] | None = None

    @property
    def share(self):
        """Independent rows for each row."""
        return self.rows / len(self.residual)

    def best(self):
        """Of every effect the entry that takes most: name to (power, entry, gains)."""
        found = {}
        for entry in self.entries:
            gains, power = entry.fitted(self.residual)
            if entry.name not in found or power > found[entry.name][0]:
                found[entry.name] = (power, entry, gains)
        return {name: one for name, one in found.items() if one[0] >= self.least}

    def without(self, chosen):
        """The same with one entry taken into the base, and its effect asked no more."""
        q, _ = np.linalg.qr(chosen.columns)
        others = [
            replace(entry, columns=entry.columns - q @ (q.T @ entry.columns))
            for entry in self.entries
            if entry.name != chosen.name
        ]
        left = self.residual - q @ (q.T @ self.residual)
        base = self.base + q.shape[1]
        # What was projected off stands in no model, so that nothing can be refitted beside it.
        return replace(self, residual=left, entries=others, base=base, again=None)


def library(path):
    """The columns of a session file; None where the diagnosis would find no base.

    All rows that may be looked at before the last decision; those that test stay sealed.
    """
    session = st.load(path)
    try:
        evidence, base = fit_baseline(session.plant, session.recordings)
        tried = eligible_candidates(evidence, base, (), Search([base]))
    except st.InputError:
        return None
    return _seen(evidence, base, tried)


def _seen(evidence, model, tried):
    """What the effects would change beside a model."""
    signatures = Signatures.of(evidence, model.plant, model.nuisances, tried)
    columns = model.columns.matrix()
    left, sizes, _ = np.linalg.svd(columns / _norms(columns), full_matrices=False)
    q = left[:, sizes > FLAT * sizes[0]]
    entries, places = [], {}
    for k, candidate in enumerate(signatures.candidates):
        whole = signatures.whole(k)
        own = whole - q @ (q.T @ whole)
        if np.all(np.sum(own**2, axis=0) > PARALLEL * np.sum(whole**2, axis=0)):
            low, high = np.array(candidate.bounds).T
            places[len(entries)] = k
            entries.append(Entry(candidate.name, own, low, high, candidate.parameters))
    n = len(model.residual)

    def again(entry, gains):
        k = next(places[j] for j, each in enumerate(entries) if each is entry)
        return _refitted(evidence, model, tried, signatures, k, gains)

    return Library(
        residual=model.residual - q @ (q.T @ model.residual),
        entries=entries,
        block=evidence.cells.block,
        base=q.shape[1],
        rows=n / max(evidence.overlap, 1.0),
        least=n * (SMALLEST * friction_of(evidence, model)) ** 2,
        again=again,
    )


def _refitted(evidence, model, tried, signatures, k, gains):
    """The columns beside the model with one more effect, all of it fitted; None where that fails.

    Slopes at no gain tell little of what a whole gain does: it begins at what they say, or less.
    """
    candidate = signatures.candidates[k]
    begun = [
        with_effect(
            step_beside(model, share * signatures.contribution(k, gains)), candidate, share * gains
        )
        for share in SHARES
    ]
    start = likeliest_of(evidence, begun, model.nuisances)
    more = fit_model(evidence, start, model.nuisances)
    if not more.power < model.power:
        return None
    return _seen(evidence, more, [each for each in tried if each.name != candidate.name])


def forward(lib, accept):
    """Names in the order in which the best entry of all is accepted, one after the other."""
    names = []
    while len(names) < MOST:
        own = lib.best()
        chosen = accept(lib, own) if own else None
        if chosen is None:
            return names
        names.append(chosen)
        _, entry, gains = own[chosen]
        lib = (lib.again and lib.again(entry, gains)) or lib.without(entry)
    return names


def _norms(columns):
    size = np.sqrt(np.sum(columns**2, axis=0))
    return np.where(size > 0.0, size, 1.0)
