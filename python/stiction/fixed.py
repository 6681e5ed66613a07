"""Dicts that say how what they show is changed, in place of taking a change that does nothing."""

from __future__ import annotations

from typing import Any, Never, TypeVar

from ._support.wording import commas, did_you_mean
from .errors import InputError, UnknownName

__all__ = ["Fixed"]

K = TypeVar("K", bound=str)
V = TypeVar("V")


class Fixed(dict[K, V]):
    """A dict that shows what something has: a change of it would change nothing, and is refused.

    ``{**shown, "name": 1.0}`` and ``dict(shown)`` are plain dicts.

    Parameters
    ----------
    items : dict
    remedy : str
        How the thing itself is changed, for the sentence that refuses.
    """

    __slots__ = ("_remedy",)

    def __init__(self, items: dict[K, V], remedy: str) -> None:
        super().__init__(items)
        self._remedy = remedy

    def _refuse(self, *given: Any, **named: Any) -> Never:
        name = f"{given[0]} " if given and isinstance(given[0], str) else ""
        raise InputError(f"{name}cannot be set in place: {self._remedy}")

    def __missing__(self, key: Any) -> Never:
        raise UnknownName(
            f"'{key}' is not there{did_you_mean(key, self)}; there are {commas(self)}"
        )

    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> tuple[Any, ...]:
        return dict, (dict(self),)
