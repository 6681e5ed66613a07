"""JSON text of plain data, with words for the numbers that JSON lacks."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

__all__ = ["json_of"]


def json_of(data: Any) -> str:
    """The data as JSON text; what JSON has no number for becomes a word."""
    return json.dumps(_plain(data), indent=2, ensure_ascii=False)


def _plain(data: Any) -> Any:
    """JSON has no infinity: it becomes the word."""
    if isinstance(data, dict):
        return {str(key): _plain(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_plain(value) for value in data]
    if isinstance(data, Path):
        return str(data)
    if isinstance(data, float) and not math.isfinite(data):
        return str(data)
    return data
