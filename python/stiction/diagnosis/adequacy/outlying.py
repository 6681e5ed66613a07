"""Single recordings in which much is left, where the model is right in all others."""

from __future__ import annotations

from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ...recording import Check
from ..data.evidence import Cells, Evidence
from ..data.gain import HeldOut
from ..phrases import ALONE
from ..records import Unexplained
from ..screening.model import Model

__all__ = ["MOST_TIMES", "outlying_recordings", "outlying_test_recordings"]

MOST_TIMES: Final = 8.0
"""Power left over what noise leaves from which on a recording stands out, in its median block.

Where nothing of the kind was hidden it came to 1.6 in 10 sessions of contacts that yield, and to
4.1 in 9 of a dry one.
"""
FEWEST: Final = 3
"""Recordings that are needed to call one of them another thing than the rest."""
DIFFERENT: Final = (
    "something is different in it, as a load, a mounting or a clock; it tests alone, so that no "
    "verdict rests on it"
)
AGAIN: Final = "give it another role, or record it once more"
MOST_TIMES_A_BLOCK: Final = 6.0
"""Power of a block that tests over the largest one of those that train and decide, from which on it
stands out: where nothing was hidden it came to 2.8 at most, and to 9.8 and 58 where a drive was at
its limit for a fifth of a second."""
OF_ITS_POWER: Final = 0.08
"""Share of all that is left in rows that test which such a block holds."""
WHOLE: Final = 0.5
"""Of the rows of a full one, from which on a block is compared."""


def outlying_recordings(
    evidence: Evidence, model: Model, null: FloatArray, least: float
) -> tuple[Unexplained, ...]:
    """Recordings in which far more is left than in all others, largest share first.

    A mean over recordings hides the one in which a load, a mounting or a clock was another one, and
    so does a median. Where the model has lost a machine for a moment, as where a contact breaks
    away late, a single block is far off; here it is the middle one.

    Parameters
    ----------
    evidence : Evidence
    model : Model
        The last one.
    null : numpy.ndarray, shape (n, surrogates)
        Residuals of the surrogates.
    least : float
        Weighted rms of a residual that matters.

    Returns
    -------
    tuple of Unexplained
        Each with its share of all that is left. Empty where the model misses most recordings by
        so much, too: then none of them stands out, and the coordinates tell what is missing.
    """
    block, recording = evidence.cells.block, evidence.cells.recording
    number = int(block.max()) + 1
    power = np.bincount(block, model.residual**2, number)
    noise = np.bincount(block, np.mean(null**2, axis=1), number)
    rows = np.maximum(np.bincount(block, minlength=number), 1)
    of_block = np.zeros(number, dtype=np.int64)
    of_block[block] = recording
    there = noise > 0.0
    asked = np.unique(of_block[there])
    if len(asked) < FEWEST:
        return ()
    middle = np.zeros(len(asked))
    beyond = np.zeros(len(asked))
    for place, index in enumerate(asked):
        own = there & (of_block == index)
        if float(np.median(power[own] / rows[own])) > least**2:
            middle[place] = np.median(power[own]) / np.median(noise[own])
        beyond[place] = max(float(power[own].sum() - noise[own].sum()), 0.0)
    usual = float(np.median(middle))
    if usual >= MOST_TIMES:
        return ()
    out = np.flatnonzero(middle > MOST_TIMES * max(usual, 1.0))
    shares = beyond / float(power.sum())
    return tuple(
        Unexplained(f"{evidence.names[asked[k]]}{ALONE}", float(shares[k]))
        for k in sorted(out, key=lambda k: -shares[k])
    )


def outlying_test_recordings(
    evidence: Evidence, model: Model, test: HeldOut | None, index: int, least: float
) -> list[tuple[str, Check]]:
    """Recordings that test in which far more is left than in those that train and decide.

    In their median block, or in one.

    No verdict rests on what was looked at last; it is told all the same, for its owner would see
    it at once. Residuals are compared as they are weighted, by recording or kind.

    Parameters
    ----------
    evidence : Evidence
    model : Model
        The last one.
    test : HeldOut, optional
    index : int
        Of the last model there.
    least : float
        Weighted rms of a residual that matters.

    Returns
    -------
    list of (str, Check)
        By the name of the recording.
    """
    if test is None:
        return []
    shown = _middles(evidence.cells, model.residual)
    if len(shown) < FEWEST:
        return []
    usual = float(np.median(list(shown.values())))
    moments = _moments(evidence, model, test, index, least)
    told = []
    for recording, middle in _middles(test.cells, test.residuals[index]).items():
        if usual > 0.0 and middle > max(MOST_TIMES * usual, least**2):
            what = (
                f"leaves {middle / usual:.0f} times the power that those leave which train and "
                "decide"
            )
        elif recording in moments:
            what = moments[recording]
        else:
            continue
        told.append((evidence.names[recording], Check("alone", "note", what, DIFFERENT, AGAIN)))
    return told


def _moments(
    evidence: Evidence, model: Model, test: HeldOut, index: int, least: float
) -> dict[int, str]:
    """By recording that tests: the second in which it leaves far more than any that was looked at.

    A cause that acts for a moment, and by chance in none of the rows that train and decide, is one
    that nothing else can tell of.
    """
    most = float(np.max(_densities(evidence.cells, model.residual)))
    residual, block = test.residuals[index], test.cells.block
    density, total = _densities(test.cells, residual), float(residual @ residual)
    time = np.concatenate([rows.form.time[rows.mask] for rows in test.rows])
    told: dict[int, str] = {}
    for each in np.argsort(-density):
        own = np.flatnonzero(block == each)
        if density[each] <= max(MOST_TIMES_A_BLOCK * most, least**2):
            break
        if float(np.sum(residual[own] ** 2)) < OF_ITS_POWER * total:
            continue
        recording = int(test.cells.recording[own[0]])
        since = float(time[own[0]] - evidence.recordings[recording].time[0])
        told.setdefault(
            recording,
            f"leaves {density[each] / max(most, 1e-300):.0f} times the power, in one second "
            f"{since:.1f} s after its beginning, that any second leaves which trains or decides",
        )
    return told


def _densities(cells: Cells, residual: FloatArray) -> FloatArray:
    """Mean power of each block; 0 of those of which little is left."""
    rows = np.bincount(cells.block)
    density = np.bincount(cells.block, residual**2) / np.maximum(rows, 1)
    of_block = np.zeros(len(rows), dtype=np.int64)
    of_block[cells.block] = cells.recording
    # Of its own recording: others may have been sampled more often.
    full = np.zeros(int(of_block.max()) + 1)
    np.maximum.at(full, of_block, rows)
    return np.where(rows > WHOLE * full[of_block], density, 0.0)


def _middles(cells: Cells, residual: FloatArray) -> dict[int, float]:
    """Power in the middle block of each recording."""
    power = np.bincount(cells.block, residual**2)
    rows = np.bincount(cells.block)
    of_block = np.zeros(len(power), dtype=np.int64)
    of_block[cells.block] = cells.recording
    there = rows > 0
    return {
        int(k): float(np.median(power[there & (of_block == k)] / rows[there & (of_block == k)]))
        for k in np.unique(cells.recording)
    }
