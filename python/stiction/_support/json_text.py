"""JSON text of plain data; JSON has numbers, and neither infinities nor NaN."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

__all__ = ["infinities_as_words", "json_of"]


def json_of(data: Any) -> str:
    """The data as JSON text; a number that is not finite becomes null: not known, or open."""
    return json.dumps(_plain(data), indent=2, ensure_ascii=False, allow_nan=False)


def infinities_as_words(data: Any) -> Any:
    """The data with the words "inf" and "-inf" for infinities.

    In the catalogue they are values of their own: a break-away that is never reached.
    """
    if isinstance(data, dict):
        return {key: infinities_as_words(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [infinities_as_words(value) for value in data]
    if isinstance(data, float) and math.isinf(data):
        return str(data)
    return data


def _plain(data: Any) -> Any:
    if isinstance(data, dict):
        return {str(key): _plain(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_plain(value) for value in data]
    if isinstance(data, Path):
        return str(data)
    if isinstance(data, float) and not math.isfinite(data):
        return None
    return data
