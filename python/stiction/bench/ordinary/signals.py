"""What ordinary sessions drive a machine with: sums of sines, ramps, steps, chirps."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
import numpy.typing as npt

__all__ = ["KINDS", "FloatArray", "signal"]

FloatArray = npt.NDArray[np.float64]

KINDS = ("sines", "ramps", "steps", "chirps")


def signal(kind: str, samples: int, dt: float, rng: np.random.Generator) -> FloatArray:
    """A signal of this kind within ±1, which it comes near to.

    Parameters
    ----------
    kind : str
        One of ``KINDS``.
    samples : int
    dt : float
        s.
    rng : Generator
    """
    t = (np.arange(samples) * dt).astype(np.float64)
    wave = _SIGNALS[kind](t, t[-1] + dt, rng)
    return wave / max(float(np.abs(wave).max()), 1e-12)


def _sines(t: FloatArray, span: float, rng: np.random.Generator) -> FloatArray:
    """Three to eight sines of .1 to 5 Hz, the slow ones larger."""
    number = int(rng.integers(3, 9))
    f = np.exp(rng.uniform(np.log(max(0.1, 1.0 / span)), np.log(5.0), number))
    wave = np.zeros_like(t)
    for w in f:
        wave += w**-0.5 * np.sin(2 * np.pi * (w * t + rng.uniform()))
    return wave


def _ramps(t: FloatArray, span: float, rng: np.random.Generator) -> FloatArray:
    """Straight lines to levels of either side, a few of them held."""
    times, levels, side = [0.0], [0.0], 1.0
    while times[-1] < span:
        times.append(times[-1] + float(rng.uniform(0.3, 2.5)))
        levels.append(side * float(rng.uniform(0.3, 1.0)))
        if rng.random() < 0.3:
            times.append(times[-1] + float(rng.uniform(0.2, 1.0)))
            levels.append(levels[-1])
        side = -side
    return np.interp(t, times, levels)


def _steps(t: FloatArray, span: float, rng: np.random.Generator) -> FloatArray:
    """Levels held for .1 to 1.5 s, 0 among them."""
    wave, now, side = np.zeros_like(t), 0.0, 1.0
    while now < span:
        length = float(rng.uniform(0.1, 1.5))
        level = 0.0 if rng.random() < 0.15 else side * float(rng.uniform(0.3, 1.0))
        wave[(t >= now) & (t < now + length)] = level
        now, side = now + length, side if rng.random() < 0.2 else -side
    return wave


def _chirps(t: FloatArray, span: float, rng: np.random.Generator) -> FloatArray:
    """One sine whose frequency goes from some tenths of a hertz to some hertz."""
    low, high = float(rng.uniform(0.1, 0.4)), float(rng.uniform(2.0, 6.0))
    rate = np.log(high / low) / span
    wave = np.sin(2 * np.pi * low * np.expm1(rate * t) / rate) * np.linspace(1.0, 0.7, len(t))
    return np.asarray(wave, dtype=np.float64)


_SIGNALS: Final[dict[str, Callable[[FloatArray, float, np.random.Generator], FloatArray]]] = {
    "sines": _sines,
    "ramps": _ramps,
    "steps": _steps,
    "chirps": _chirps,
}
