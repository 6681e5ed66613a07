"""Packages whose names are imported on first use, so that what needs one of them is light."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any

from .wording import did_you_mean

__all__ = ["lazy"]


def lazy(
    package: str, modules: Mapping[str, str]
) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """What a package has as ``__getattr__`` and ``__dir__``.

    Parameters
    ----------
    package : str
        Its ``__name__``.
    modules : mapping of str to str
        The module of the package, by the public name that is in it.

    Returns
    -------
    tuple of two functions
    """

    def get(name: str) -> Any:
        if name not in modules:
            near = "" if name.startswith("_") else did_you_mean(name, modules)
            raise AttributeError(f"module {package!r} has no attribute {name!r}{near}")
        value = getattr(import_module(f".{modules[name]}", package), name)
        # Here, and not left to the import: a module of the same name would stand in its place.
        setattr(sys.modules[package], name, value)
        return value

    def names() -> list[str]:
        dunders = (name for name in vars(sys.modules[package]) if name.startswith("__"))
        return sorted({*dunders, *modules})

    return get, names
