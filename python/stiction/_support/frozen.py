"""Mappings that stay as they are: what results and plants hold by name."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, TypeVar

from ..errors import InputError, UnknownName
from .given import brief, mapping
from .wording import commas, did_you_mean

__all__ = ["ByPath", "Frozen", "freeze", "path_of"]

K = TypeVar("K")
V = TypeVar("V")


class Frozen(Mapping[K, V]):
    """A mapping that cannot be changed, and that can be copied and pickled.

    ``types.MappingProxyType`` cannot, so nothing that holds one could be sent to another process.

    Parameters
    ----------
    given : Mapping or iterable of pairs
        Copied, where it could change.
    """

    __slots__ = ("_items",)

    _items: dict[K, V]

    def __init__(self, given: Mapping[K, V] | Iterable[tuple[K, V]] = ()) -> None:
        try:
            # What cannot change can be shared.
            items = given._items if isinstance(given, Frozen) else dict(given)
        except (TypeError, ValueError):
            raise InputError(f"{brief(given)} holds nothing by name; give a mapping") from None
        object.__setattr__(self, "_items", items)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"what is held by name here is frozen: {name} cannot be set")

    def __getitem__(self, name: K) -> V:
        return self._items[name]

    def __iter__(self) -> Iterator[K]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def __or__(self, other: Mapping[K, V]) -> dict[K, V]:
        return {**self._items, **other}

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._items,)

    def __repr__(self) -> str:
        return repr(self._items)


class ByPath(Frozen[str, V]):
    """A frozen mapping of parameter paths that also takes the bare last word of one.

    ``mapping["inertia"]`` is ``mapping["body.inertia"]`` where no other path ends so. Iteration,
    ``len`` and ``==`` know whole paths alone.
    """

    __slots__ = ()

    def __getitem__(self, name: str) -> V:
        items = self._items
        return items[name] if name in items else items[path_of(name, items)]


def freeze(owner: object, kind: type[Frozen[Any, Any]], *names: str) -> None:
    """Hold these mappings of a frozen dataclass as this kind; for its ``__post_init__``.

    Raises
    ------
    InputError
        One of them is no mapping.
    """
    where = type(owner).__name__
    for name in names:
        held = mapping(getattr(owner, name), f"{where}: {name}", "a mapping")
        object.__setattr__(owner, name, kind(held))


def path_of(name: str, paths: Iterable[str], where: str = "", lacking: str = "is unknown") -> str:
    """The whole path of a parameter that is named by it or by its bare last word.

    Parameters
    ----------
    name : str
    paths : iterable of str
        There are these.
    where : str
        What the error sentence begins with, such as ``"plant.toml: "``.
    lacking : str
        What is the matter with a name that is none of them.

    Raises
    ------
    UnknownName
        No such parameter, or several.
    """
    known = list(paths)
    if name in known:
        return name
    words = [path.rsplit(".", 1)[-1] for path in known]
    hits = [path for path, word in zip(known, words, strict=True) if word == name]
    if len(hits) == 1:
        return hits[0]
    if hits:
        raise UnknownName(f"{where}parameter '{name}' may be {commas(hits)}; give the whole path")
    near = did_you_mean(name, [*known, *words]) if isinstance(name, str) else ""
    raise UnknownName(f"{where}parameter {name!r} {lacking}{near}; known: {commas(known)}")
