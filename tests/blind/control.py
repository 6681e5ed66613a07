"""Ways to break a diagnosis or its scoring on purpose: what guards them must then fail."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np


def uncalibrated(replace: Callable[[str, Any], None]) -> None:
    """Switches off what is taken from surrogates and turned blocks: bias and thresholds.

    ``replace`` puts an object in the place of the one at a dotted path, such as
    ``monkeypatch.setattr``. The other gates stay: held-out gain, blocks, strength.
    """

    def unbiased(null: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.zeros(len(null)), null

    replace("stiction.diagnosis.screening.screen._threshold", lambda *_: 0.0)
    replace("stiction.diagnosis.selection.rounds.centre", unbiased)


def shuffled(rows: list[dict[str, Any]], seed: int = 0) -> list[dict[str, Any]]:
    """Results with the truth of another session each."""
    order = np.random.default_rng(seed).permutation(len(rows))
    truth = ("names", "classes", "hidden", "clair")
    return [
        row | {part: rows[other][part] for part in truth if part in row}
        for row, other in zip(rows, order, strict=True)
    ]
