"""Keys and words of the files that users write."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any, Final

from ..errors import InputError
from .given import brief
from .wording import commas, did_you_mean

__all__ = ["check_keys", "choice"]


NONE: Final[Mapping[str, str]] = MappingProxyType({})
"""No other names."""


def check_keys(
    table: Mapping[str, Any],
    allowed: Iterable[str],
    where: str,
    others: Mapping[str, str] = NONE,
) -> None:
    """Refuse keys that are not allowed; ``others`` are names that people have for one that is."""
    allowed = list(allowed)
    for key in table:
        if key not in allowed:
            raise InputError(
                f"{where}: '{key}' is unknown{_meant(key, allowed, others)}; "
                f"allowed are {commas(allowed)}"
            )


def choice(given: Any, allowed: Iterable[str], where: str, others: Mapping[str, str] = NONE) -> str:
    """Take one of the allowed words; ``others`` are names that people have for one of them."""
    allowed = list(allowed)
    if not isinstance(given, str) or given not in allowed:
        near = _meant(given, allowed, others) if isinstance(given, str) else ""
        raise InputError(
            f"{where} = {brief(given)} is unknown{near}; allowed are {commas(allowed)}"
        )
    return given


def _meant(word: str, allowed: list[str], others: Mapping[str, str]) -> str:
    """ " (did you mean 'x'?)", or nothing."""
    known = others.get(word, others.get(word.casefold()))
    return f" (did you mean '{known}'?)" if known in allowed else did_you_mean(word, allowed)
