"""Arguments are of the kinds that a signature states: looked at before a function begins."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import wraps
from inspect import Parameter, signature
from typing import Any, Final, ParamSpec, TypeVar

from .._support.given import MOST_WHOLE, brief, number, numbers, whole, word, yes_or_no
from ..errors import InputError

__all__ = ["check_arguments"]

P = ParamSpec("P")
R = TypeVar("R")


def check_arguments(function: Callable[P, R]) -> Callable[P, R]:
    """Refuse arguments that are not of the kind which the annotation of their parameter states.

    Looked at are ``float``, ``int``, ``str``, ``bool`` and ``Sequence[float]``, each also with
    ``| None`` and as the kind of each of ``*args``; all else is the function's own to look at.
    What is handed on is plain: a float for an array of no dimensions, a tuple for a sequence.

    Parameters
    ----------
    function : callable
        With annotations.

    Returns
    -------
    callable
        The same, which raises an ``InputError`` for anything else, and for numbers that are not
        finite.
    """
    parameters = signature(function).parameters
    kinds = {name: _kind_of(parameter) for name, parameter in parameters.items()}
    order = [p.name for p in parameters.values() if p.kind is not Parameter.KEYWORD_ONLY]

    @wraps(function)
    def call(*args: P.args, **keywords: P.kwargs) -> R:
        def plain(name: str, value: Any) -> Any:
            kind, optional = kinds.get(name, ("", False))
            if kind not in _READ or (value is None and optional):
                return value
            return _READ[kind](value, f"{function.__name__}: {name}")

        # Arguments that are too many are the function's to refuse, as any function does.
        named = [*order, *[""] * (len(args) - len(order))]
        values: list[Any] = [plain(name, value) for name, value in zip(named, args, strict=False)]
        more: dict[str, Any] = {name: plain(name, value) for name, value in keywords.items()}
        return function(*values, **more)

    return call


def _kind_of(parameter: Parameter) -> tuple[str, bool]:
    """Annotation, and whether it allows None."""
    said = str(parameter.annotation)
    return said.removesuffix(" | None"), said.endswith(" | None")


def _float(given: Any, where: str) -> float:
    # An array of no dimensions is a number, as numpy returns them.
    if getattr(given, "shape", None) == () and getattr(given.dtype, "kind", "") in "iuf":
        given = given.item()
    value = number(given, where)
    if not math.isfinite(value):
        raise InputError(f"{where} = {value} is not a finite number; give a finite one")
    return value


def _int(given: Any, where: str) -> int:
    return whole(given, where, least=-MOST_WHOLE, most=MOST_WHOLE)


def _floats(given: Any, where: str) -> tuple[float, ...]:
    row = numbers(given, where)
    if row.ndim != 1:
        raise InputError(f"{where} is {brief(given)}; give a sequence of numbers")
    return tuple(_float(value, f"{where}[{k}]") for k, value in enumerate(row.tolist()))


_READ: Final[dict[str, Callable[[Any, str], Any]]] = {
    "float": _float,
    "int": _int,
    "str": word,
    "bool": yes_or_no,
    "Sequence[float]": _floats,
}
