"""Keys and words of the files that users write."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from ..errors import InputError
from .given import brief
from .wording import commas, did_you_mean

__all__ = ["check_keys", "choice"]


def check_keys(table: Mapping[str, Any], allowed: Iterable[str], where: str) -> None:
    """Refuse keys that are not allowed."""
    allowed = list(allowed)
    for key in table:
        if key not in allowed:
            raise InputError(
                f"{where}: '{key}' is unknown{did_you_mean(key, allowed)}; "
                f"allowed are {commas(allowed)}"
            )


def choice(given: Any, allowed: Iterable[str], where: str) -> str:
    """Take one of the allowed words."""
    allowed = list(allowed)
    if not isinstance(given, str) or given not in allowed:
        near = did_you_mean(given, allowed) if isinstance(given, str) else ""
        raise InputError(
            f"{where} = {brief(given)} is unknown{near}; allowed are {commas(allowed)}"
        )
    return given
