"""Noise of position and effort, from stretches in which nothing else should change."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ..motion import count_of
from ..recording import Recording
from .finding import Check
from .signal import channels_of, without_spikes

_FEWEST_ROWS: Final = 20
_EFFORTS: Final = ("input", "effort")


@dataclass(frozen=True)
class Stretches:
    """Noise over the stretches of one kind.

    Attributes
    ----------
    seconds : float
        How much of them there is.
    noise : dict of str to float
        By channel, SI units: median over the stretches of the standard deviation about a slow
        curve.
    """

    seconds: float
    noise: dict[str, float]


def noise_levels(
    recording: Recording,
    *,
    window_s: float = 0.5,
    still_share: float = 1e-3,
    moving_share: float = 0.02,
    even_share: float = 0.02,
) -> dict[str, Stretches]:
    """Noise at standstill and at constant speed.

    Parameters
    ----------
    recording : Recording
    window_s : float
        Length of a stretch: long enough for 20 rows or more and short for a machine.
    still_share : float
        At standstill the position changes by less than this share of its range, or 2 counts.
    moving_share, even_share : float
        At constant speed it changes by more than this share of its range, and its path bends and
        scatters by less than this share of the change.

    Returns
    -------
    dict of str to Stretches
        Under ``"standstill"`` and ``"constant speed"``, where there is such a stretch.
    """
    channels = {
        name: without_spikes(values)
        for name, values in channels_of(recording)
        if name in ("position", *_EFFORTS)
    }
    position = channels.get("position")
    if position is None or np.ptp(position) == 0.0:
        return {}
    rows = max(_FEWEST_ROWS, round(window_s / recording.dt))
    span = float(np.ptp(position))
    count = count_of(position)
    found: dict[str, list[dict[str, float]]] = {"standstill": [], "constant speed": []}
    for start in range(0, len(position) - rows + 1, rows):
        part = slice(start, start + rows)
        change, bend, scatter = _path(position[part])
        if abs(change) + abs(bend) <= max(still_share * span, 2.0 * count):
            kind = "standstill"
        elif abs(change) > moving_share * span and abs(bend) + scatter < even_share * abs(change):
            kind = "constant speed"
        else:
            continue
        scatters = {"position": scatter}
        for name in _EFFORTS:
            if name in channels:
                scatters[name] = _path(channels[name][part])[2]
        found[kind].append(scatters)
    return {
        kind: Stretches(
            len(stretches) * rows * recording.dt,
            {n: float(np.median([s[n] for s in stretches])) for n in stretches[0]},
        )
        for kind, stretches in found.items()
        if stretches
    }


def noise(recording: Recording) -> list[Check]:
    """The noise levels in words, and which stretches there are none of."""
    if recording.position is None:
        return [Check("noise", "fine", "there is no position to tell stretches by")]
    levels = noise_levels(recording)
    checks = []
    for kind in ("standstill", "constant speed"):
        if kind not in levels:
            checks.append(
                Check(
                    f"noise at {kind}",
                    "note",
                    f"there is no stretch of 0.5 s at {kind}",
                    "the noise there is not measured, and is taken from the residual instead",
                    f"add 5 s at {kind} to the next recording",
                )
            )
            continue
        found = levels[kind]
        words = ", ".join(
            f"{name} {size:.3g} {recording.units[name]}".rstrip()
            for name, size in found.noise.items()
        )
        checks.append(
            Check(f"noise at {kind}", "fine", f"over {found.seconds:.3g} s at {kind}: {words}")
        )
    return checks


def _path(values: FloatArray) -> tuple[float, float, float]:
    """Change over a stretch, bend of its path, and scatter about the parabola."""
    basis, inverse = _parabolas(len(values))
    fitted = inverse @ values
    scatter = float(np.std(values - basis @ fitted))
    return 2.0 * float(fitted[1]), 1.5 * float(fitted[2]), scatter


@lru_cache(maxsize=16)
def _parabolas(rows: int) -> tuple[FloatArray, FloatArray]:
    """Legendre polynomials over so many rows, and their pseudoinverse."""
    at = np.linspace(-1.0, 1.0, rows)
    # They are orthogonal here to within a part in the number of rows.
    basis = np.stack([np.ones_like(at), at, 1.5 * at**2 - 0.5], axis=1)
    return basis, np.asarray(np.linalg.pinv(basis), dtype=np.float64)
