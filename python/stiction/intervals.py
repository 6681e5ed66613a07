"""Intervals of parameters, as a fit or a diagnosis found them, and machines within them."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np

from ._support import given
from ._support.given import number
from .errors import InputError

__all__ = ["draw_values", "intervals_of"]

DRAWS: Final = 100
"""Times that values are drawn until a machine takes them: one level may not exceed another."""


def intervals_of(source: Any) -> dict[str, tuple[float, float]]:
    """95 % intervals of parameters by path.

    Parameters
    ----------
    source : Diagnosis, FitResult, path of findings.json or fit.json, or mapping
        A mapping has (low, high) by path.

    Returns
    -------
    dict of str to (float, float)
        Of a diagnosis those of the extended model, or of the plant as it was given where
        nothing was added. What the data do not determine has none.

    Raises
    ------
    InputError
        Nothing that has intervals, or one whose ends are in the wrong order.
    """
    where = "intervals"
    if isinstance(source, str | Path):
        where = str(source)
        source = _read(given.path(source, where))
    elif hasattr(model := _told(source, getattr), "parameters"):
        source = {path: each.ci95 for path, each in model.parameters.items()}
    found = {}
    for path, ends in given.mapping(source, where, "(low, high) by path").items():
        if not isinstance(ends, tuple | list) or len(ends) != 2:
            raise InputError(
                f"{where}: {path} = {given.brief(ends)} is no interval; give low, high"
            )
        if None in ends:
            continue
        low, high = (number(end, f"{where}: {path}") for end in ends)
        if not np.isfinite([low, high]).all():
            continue
        if low > high:
            raise InputError(f"{where}: {path} = {low:g} to {high:g} ends before it begins")
        found[path] = (low, high)
    return found


def _told(source: Any, get: Callable[[Any, str, None], Any]) -> Any:
    """The model whose plant is handed over: of a diagnosis the extended one, of a fit itself."""
    return get(source, "extended", None) or get(source, "baseline", None) or source


def _read(path: Path) -> dict[str, Any]:
    """Intervals of a file that a fit or a diagnosis wrote."""
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        model = _told(data, dict.get)
        return {name: each["ci95"] for name, each in model["parameters"].items()}
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(
            f"{path}: no intervals can be read ({error}); name findings.json or fit.json"
        ) from None


def draw_values(
    intervals: Mapping[str, tuple[float, float]],
    source: np.random.Generator,
    takes: Callable[[dict[str, float]], object],
) -> dict[str, float]:
    """Values within intervals, evenly and one by one, that a motor takes.

    Parameters
    ----------
    intervals : mapping of str to (float, float)
        As ``intervals_of`` returns them.
    source : numpy.random.Generator
    takes : callable
        Of the values; raises ``InputError`` where no machine has them together.

    Returns
    -------
    dict of str to float

    Raises
    ------
    InputError
        None of many draws is taken.
    """
    for _ in range(DRAWS if intervals else 1):
        values = {path: float(source.uniform(*ends)) for path, ends in intervals.items()}
        try:
            takes(values)
        except InputError as error:
            refused = error
        else:
            return values
    raise InputError(f"intervals: no values within them make a motor: {refused}")
