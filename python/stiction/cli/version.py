"""``stiction --version``: which build this is, and what it finds to work with."""

from __future__ import annotations

import os
import platform
import re
from importlib.metadata import PackageNotFoundError, requires
from importlib.metadata import version as version_of
from typing import Final

__all__ = ["version"]

_EXTRA: Final = re.compile(r"^([\w.-]+).*;.*extra\s*==\s*['\"]([\w-]+)['\"]")
_OF_DEVELOPERS: Final = "dev"


def version() -> str:
    """Version, build profile, threads, what it stands on and which extras are installed."""
    from .. import _native

    processors = (
        len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    )
    stands_on = ", ".join(f"{name} {_there(name) or 'missing'}" for name in ("numpy", "scipy"))
    lines = [
        f"stiction {_native.__version__}",
        f"build: {_native.__profile__}, {platform.machine()} {platform.system()}",
        f"threads: {processors}",
        f"python {platform.python_version()}, {stands_on}",
    ]
    extras = _extras()
    for word, there in (("extras", True), ("not installed", False)):
        names = sorted(name for name, complete in extras.items() if complete is there)
        if names:
            lines.append(f"{word}: {', '.join(names)}")
    return "\n".join(lines)


def _extras() -> dict[str, bool]:
    """Extras of the package, and whether all that each needs is installed."""
    try:
        needed = requires("stiction") or []
    except PackageNotFoundError:
        return {}
    found: dict[str, bool] = {}
    for line in needed:
        if (match := _EXTRA.match(line)) and match[2] != _OF_DEVELOPERS:
            found[match[2]] = found.get(match[2], True) and bool(_there(match[1]))
    return found


def _there(name: str) -> str:
    try:
        return version_of(name)
    except PackageNotFoundError:
        return ""
