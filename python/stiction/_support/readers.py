"""Classes that files are read into: a guess at what reads them is answered with the one name."""

from __future__ import annotations

from typing import Any, Final

from .wording import did_you_mean

__all__ = ["FromFile"]

_READS: Final = frozenset({"from", "load", "open", "parse", "read"})
"""What names of functions that read a file begin with elsewhere."""


class FromFile(type):
    """The class of such a class; an attribute that is there costs nothing more."""

    def __getattr__(cls, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(f"type object '{cls.__name__}' has no attribute '{name}'")
        known = [each for each in dir(cls) if not each.startswith("_")]
        hint = did_you_mean(name, known)
        if name.partition("_")[0] in _READS:
            hint = "; stiction.load(path) reads session, plant and recording files"
        raise AttributeError(f"type object '{cls.__name__}' has no attribute '{name}'{hint}")
