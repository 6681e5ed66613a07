"""Keys and words of the files that users write."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from .errors import InputError
from .given import shown
from .wording import did_you_mean, listed

__all__ = ["choice", "known"]


def known(table: Mapping[str, Any], allowed: Iterable[str], where: str) -> None:
    """Refuse keys that are not allowed."""
    allowed = list(allowed)
    for key in table:
        if key not in allowed:
            raise InputError(
                f"{where}: '{key}' is unknown{did_you_mean(key, allowed)}; "
                f"allowed are {listed(allowed)}"
            )


def choice(given: Any, allowed: Iterable[str], where: str) -> str:
    """Take one of the allowed words."""
    allowed = list(allowed)
    if not isinstance(given, str) or given not in allowed:
        near = did_you_mean(given, allowed) if isinstance(given, str) else ""
        raise InputError(
            f"{where} = {shown(given)} is unknown{near}; allowed are {listed(allowed)}"
        )
    return given
