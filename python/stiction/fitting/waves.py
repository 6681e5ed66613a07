"""Amplitude and phase of waves over position, which a fit holds as a cosine and a sine.

A part that happens to be small says nothing of the wave: its standard error may exceed it where
the amplitude is known to a percent.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Final

import numpy as np

from .._support.arrays import FloatArray

if TYPE_CHECKING:
    from .result import FitParameter

__all__ = ["amplitude_of", "as_waves", "parts_of", "phase_of", "shown_path", "waves_of"]

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


def shown_path(path: str) -> str:
    """Path by which a parameter is told: of a cosine the amplitude, of a sine the phase."""
    parts = parts_of(path)
    if parts is None:
        return path
    return amplitude_of(parts) if path == parts[0] else phase_of(parts)


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
    covariance = as_waves(parameters, covariance)
    found: dict[str, FitParameter] = {}
    for cosine_at, sine_at, parts in _pairs(parameters):
        cosine, sine = parameters[parts[0]], parameters[parts[1]]
        size, phase = math.hypot(cosine.value, sine.value), math.atan2(sine.value, cosine.value)
        kind, width = type(cosine), _width(cosine, sine)
        bound = cosine.at_bound or sine.at_bound
        error = math.sqrt(max(covariance[cosine_at, cosine_at], 0.0))
        found[amplitude_of(parts)] = kind(
            value=size,
            stderr=error,
            ci95=(max(size - width * error, 0.0), size + width * error),
            unit=cosine.unit,
            at_bound=bound,
            start=math.hypot(cosine.start, sine.start),
        )
        error = math.sqrt(max(covariance[sine_at, sine_at], 0.0))
        found[phase_of(parts)] = kind(
            value=phase,
            stderr=error,
            ci95=(phase - width * error, phase + width * error),
            unit="rad",
            at_bound=bound,
            start=math.atan2(sine.start, cosine.start),
        )
    return found


def as_waves(parameters: Mapping[str, FitParameter], covariance: FloatArray) -> FloatArray:
    """Covariance to first order of the amplitudes and phases in place of cosines and sines.

    Parameters
    ----------
    parameters : Mapping of str to FitParameter
        By path. A wave of which one part was fitted, or whose amplitude is 0, stays as it is.
    covariance : numpy.ndarray, shape (p, p)
        In their order.

    Returns
    -------
    numpy.ndarray, shape (p, p)
        In the same order.
    """
    covariance = np.array(covariance, dtype=float)
    for cosine_at, sine_at, parts in _pairs(parameters):
        ends = [cosine_at, sine_at]
        cosine, sine = parameters[parts[0]].value, parameters[parts[1]].value
        size = math.hypot(cosine, sine)
        turn = np.array([[cosine, sine], [-sine / size, cosine / size]]) / size
        with np.errstate(invalid="ignore"):  # of what nothing tells the covariance is infinite
            covariance[ends] = turn @ covariance[ends]
            covariance[:, ends] = covariance[:, ends] @ turn.T
    return covariance


def _pairs(parameters: Mapping[str, FitParameter]) -> Iterator[tuple[int, int, Parts]]:
    """Where the parts of each wave stand that is there and of which both were fitted."""
    order = {path: k for k, path in enumerate(parameters)}
    for path, at in order.items():
        parts = parts_of(path)
        if parts is None or path != parts[0] or parts[1] not in order:
            continue
        if parameters[path].value == 0.0 and parameters[parts[1]].value == 0.0:
            continue
        yield at, order[parts[1]], parts


def _width(*parts: FitParameter) -> float:
    """Standard errors on each side of a 95 % interval, as the fit has them."""
    for each in parts:
        if each.stderr > 0.0 and math.isfinite(each.stderr):
            return 0.5 * (each.ci95[1] - each.ci95[0]) / each.stderr
    return math.nan
