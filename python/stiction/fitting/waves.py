"""Amplitude and phase of waves over position, which a fit holds as a cosine and a sine.

A part that happens to be small says nothing of the wave: its standard error may exceed it where
the amplitude is known to a percent.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

from .._support.arrays import FloatArray

if TYPE_CHECKING:
    from .result import FitParameter

__all__ = ["amplitude_of", "parts_of", "phase_of", "waves_of"]

_TAILS: Final = ("", "_2")


Parts = tuple[str, str]
"""Paths of the cosine and of the sine."""


def parts_of(path: str) -> Parts | None:
    """The cosine and the sine of the wave that a parameter is a part of; None of any other one.

    Parameters
    ----------
    path : str
        Such as ``effects.cogging.sine_2``.
    """
    head, dot, name = path.rpartition(".")
    for tail in _TAILS:
        if name in (f"cosine{tail}", f"sine{tail}"):
            return f"{head}{dot}cosine{tail}", f"{head}{dot}sine{tail}"
    return None


def amplitude_of(parts: Parts) -> str:
    """Path of the amplitude of a wave."""
    return "amplitude".join(parts[0].rsplit("cosine", 1))


def phase_of(parts: Parts) -> str:
    """Path of its phase."""
    return "phase".join(parts[0].rsplit("cosine", 1))


def waves_of(
    parameters: Mapping[str, FitParameter], covariance: FloatArray
) -> dict[str, FitParameter]:
    """Amplitude a and phase φ of every wave a·cos(n·q − φ) of which both parts were fitted.

    Their errors are those of the parts to first order, so that an interval is that of a wave which
    is clearly there; an amplitude below its error is none.

    Parameters
    ----------
    parameters : Mapping of str to FitParameter
        By path.
    covariance : numpy.ndarray, shape (p, p)
        In their order.

    Returns
    -------
    dict of str to FitParameter
        By path, such as ``effects.cogging.amplitude`` and ``effects.cogging.phase`` in rad.
    """
    order = {path: k for k, path in enumerate(parameters)}
    found: dict[str, FitParameter] = {}
    for path in parameters:
        parts = parts_of(path)
        if parts is None or path != parts[0] or parts[1] not in parameters:
            continue
        cosine, sine = parameters[parts[0]], parameters[parts[1]]
        size = math.hypot(cosine.value, sine.value)
        if size == 0.0:
            continue
        ends = [order[part] for part in parts]
        a, b = cosine.value / size, sine.value / size
        spread = covariance[ends][:, ends]
        along = a * a * spread[0, 0] + 2.0 * a * b * spread[0, 1] + b * b * spread[1, 1]
        across = b * b * spread[0, 0] - 2.0 * a * b * spread[0, 1] + a * a * spread[1, 1]
        kind, width = type(cosine), _width(cosine, sine)
        bound = cosine.at_bound or sine.at_bound
        error = math.sqrt(max(along, 0.0))
        found[amplitude_of(parts)] = kind(
            value=size,
            stderr=error,
            ci95=(max(size - width * error, 0.0), size + width * error),
            unit=cosine.unit,
            at_bound=bound,
            start=math.hypot(cosine.start, sine.start),
        )
        phase, error = math.atan2(b, a), math.sqrt(max(across, 0.0)) / size
        found[phase_of(parts)] = kind(
            value=phase,
            stderr=error,
            ci95=(phase - width * error, phase + width * error),
            unit="rad",
            at_bound=bound,
            start=math.atan2(sine.start, cosine.start),
        )
    return found


def _width(*parts: FitParameter) -> float:
    """Standard errors on each side of a 95 % interval, as the fit has them."""
    for each in parts:
        if each.stderr > 0.0 and math.isfinite(each.stderr):
            return 0.5 * (each.ci95[1] - each.ci95[0]) / each.stderr
    return math.nan
