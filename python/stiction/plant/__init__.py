"""Plants: drive, body, friction, effects, sensor and controller, and the files that state them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .._support.lazy import lazy

if TYPE_CHECKING:
    from .parameter import Parameter
    from .plant import Plant
    from .stated import Effect, Friction

__all__ = ["Effect", "Friction", "Parameter", "Plant"]

__getattr__, __dir__ = lazy(
    __name__,
    {"Effect": "stated", "Friction": "stated", "Parameter": "parameter", "Plant": "plant"},
)
