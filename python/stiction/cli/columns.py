"""``--columns``: roles, names and units of columns on the command line."""

from __future__ import annotations

from typing import Any

from ..errors import InputError
from ..recording.columns import ROLES

__all__ = ["read_columns"]


def read_columns(text: str) -> dict[str, Any]:
    """Columns from "role=name [unit], role=name".

    Raises
    ------
    InputError
        An entry without "=", or one role twice.
    """
    columns: dict[str, Any] = {}
    for entry in text.split(","):
        role, equals, name = (part.strip() for part in entry.partition("="))
        if not equals or not role or not name:
            raise InputError(
                f"--columns: '{entry.strip()}' is not role=name; write for instance "
                '"time=t, input=u [V], position=x [mm]"'
            )
        if role in columns:
            raise InputError(f"--columns: {role} is there twice; drop one")
        if "=" in name:
            raise InputError(
                f"--columns: '{entry.strip()}' holds two columns; put a comma between them, as in "
                '"input=u [V], position=x [mm]"'
            )
        if name in ROLES and role not in ROLES:
            raise InputError(
                f"--columns: '{entry.strip()}' is the wrong way round; write {name}={role}"
            )
        # The last bracket, for a header has units of its own: input=Iq [A] [mA].
        bare, bracket, unit = name.rpartition("[")
        if _unquoted(name) != name:
            columns[role] = _unquoted(name)
        elif bracket and not unit.endswith("]"):
            raise InputError(f"--columns: '{name}' lacks a closing bracket")
        elif bracket and not unit[:-1].strip().isdigit():  # q[0] is a name
            columns[role] = {"name": _unquoted(bare), "unit": unit[:-1].strip()}
        else:
            columns[role] = name
    return columns


def _unquoted(name: str) -> str:
    """A name without the quotes that somebody put around it for its blanks."""
    bare = name.strip()
    if len(bare) > 2 and bare[0] == bare[-1] and bare[0] in "\"'":
        return bare[1:-1]
    return bare
