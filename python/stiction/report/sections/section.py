"""What a builder hands to its template."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

__all__ = ["Section"]


@dataclass(frozen=True)
class Section:
    """A part of the page.

    Attributes
    ----------
    name : str
        Of its template, and its anchor in the page.
    title : str
    content : Mapping of str to Any
        What the template shows.
    """

    name: str
    title: str
    content: Mapping[str, Any] = field(default_factory=dict)
