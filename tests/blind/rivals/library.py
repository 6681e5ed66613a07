"""The columns of one session: the residual of its base, and what each effect would change."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

import stiction as st
from stiction.diagnosis.base import based
from stiction.diagnosis.decide import SMALLEST
from stiction.diagnosis.regression import bounded
from stiction.diagnosis.rounds import _candidates, friction_of
from stiction.diagnosis.selection import Search
from stiction.diagnosis.signatures import Signatures

ALPHA = 0.01
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
        (gains,) = bounded(normal[None], product[None], best[None], self.low[None], self.high[None])
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
    least : float
        Power below which an effect is not worth a name, as for the diagnosis.
    """

    residual: np.ndarray
    entries: list[Entry]
    block: np.ndarray
    base: int
    rows: float
    least: float

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
        return replace(self, residual=left, entries=others, base=self.base + q.shape[1])


def library(path):
    """The columns of a session file; None where the diagnosis would find no base.

    All rows that may be looked at before the last decision; those that test stay sealed.
    """
    session = st.load(path)
    try:
        evidence, base = based(session.plant, session.recordings)
        tried = _candidates(evidence, base, (), Search([base]))
    except st.InputError:
        return None
    signatures = Signatures.of(evidence, base.plant, base.nuisances, tried)
    left, sizes, _ = np.linalg.svd(base.columns / _norms(base.columns), full_matrices=False)
    q = left[:, sizes > 1e-8 * sizes[0]]
    entries = []
    for k, candidate in enumerate(signatures.candidates):
        whole = signatures.whole(k)
        own = whole - q @ (q.T @ whole)
        if np.all(np.sum(own**2, axis=0) > PARALLEL * np.sum(whole**2, axis=0)):
            low, high = np.array(candidate.bounds).T
            entries.append(Entry(candidate.name, own, low, high, candidate.parameters))
    residual = base.residual - q @ (q.T @ base.residual)
    n = len(residual)
    least = n * (SMALLEST * friction_of(evidence, base)) ** 2
    rows = n / max(evidence.overlap, 1.0)
    return Library(residual, entries, evidence.cells.block, q.shape[1], rows, least)


def forward(lib, accept):
    """Names in the order in which the best entry of all is accepted, one after the other."""
    names = []
    while len(names) < MOST:
        own = lib.best()
        chosen = accept(lib, own) if own else None
        if chosen is None:
            return names
        names.append(chosen)
        lib = lib.without(own[chosen][1])
    return names


def _norms(columns):
    size = np.sqrt(np.sum(columns**2, axis=0))
    return np.where(size > 0.0, size, 1.0)
