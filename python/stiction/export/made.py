"""What an export comes to: files, and what the target cannot hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .. import given
from ..atomic_files import write_text

__all__ = ["Export"]


@dataclass(frozen=True)
class Export:
    """Files of one target, not written yet.

    Attributes
    ----------
    target : str
        Name of the target.
    files : mapping of str to str
        Text by the name of its file.
    held : tuple of str
        What of the plant the target holds, a sentence each.
    lost : tuple of str
        What it cannot hold, likewise.
    numbers : mapping of str to float
        What stands in the files, in SI.
    """

    target: str
    files: Mapping[str, str]
    held: tuple[str, ...] = ()
    lost: tuple[str, ...] = ()
    numbers: Mapping[str, float] = field(default_factory=dict)

    def save(self, folder: str | Path) -> list[Path]:
        """Write the files.

        Parameters
        ----------
        folder : str or Path
            Made where it is not there; files of the same names are replaced.

        Returns
        -------
        list of Path

        Raises
        ------
        InputError
            A folder that cannot be made, a file that cannot be written.
        """
        where = given.path(folder, "Export.save")
        with given.written(where):
            where.mkdir(parents=True, exist_ok=True)
            for name, text in self.files.items():
                write_text(where / name, text)
        return [where / name for name in self.files]

    def to_dict(self) -> dict[str, Any]:
        """What it holds and what not, as plain data."""
        return {
            "schema": 1,
            "target": self.target,
            "files": list(self.files),
            "held": list(self.held),
            "lost": list(self.lost),
            "numbers": dict(self.numbers),
        }

    def __str__(self) -> str:
        lines = [f"{self.target}: {', '.join(self.files)}"]
        lines += [f"  holds: {sentence}" for sentence in self.held]
        lines += [f"  cannot hold: {sentence}" for sentence in self.lost]
        return "\n".join(lines)
