"""What an export comes to: files, and what the target cannot hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .._support import given
from .._support.atomic_files import atomic_write, write_text
from ..errors import InputError

if TYPE_CHECKING:
    from ..plant import Plant
    from .fidelity import Fidelity

__all__ = ["Export"]


@dataclass(frozen=True)
class Export:
    """Files of one target, not written yet.

    Attributes
    ----------
    target : str
        Name of the target.
    files : mapping of str to str or bytes
        Text, or what an archive holds, by the name of its file.
    held : tuple of str
        What of the plant the target holds, a sentence each.
    lost : tuple of str
        What it cannot hold, likewise.
    numbers : mapping of str to float
        What stands in the files, in SI.
    plant : Plant or None
        That it was made of.
    speed : float or None
        Greatest speed that it was made for, rad/s or m/s.
    assumed : tuple of str
        What nobody stated of the plant and was taken for granted, a sentence each.
    """

    target: str
    files: Mapping[str, str | bytes]
    held: tuple[str, ...] = ()
    lost: tuple[str, ...] = ()
    numbers: Mapping[str, float] = field(default_factory=dict)
    plant: Plant | None = field(default=None, repr=False)
    speed: float | None = field(default=None, repr=False)
    assumed: tuple[str, ...] = ()

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
        with given.explain_write_errors(where):
            where.mkdir(parents=True, exist_ok=True)
            for name, content in self.files.items():
                if isinstance(content, bytes):
                    with atomic_write(where / name) as file:
                        file.write(content)
                else:
                    write_text(where / name, content)
        return [where / name for name in self.files]

    def check(self, session: Any) -> Fidelity:
        """Run the target on the held-out recordings of a session, beside the plant.

        Three errors are compared over the same rows: of the target as it was written, of the whole
        plant as stiction simulates it, and of the plant without its effects, its law fitted again
        to the rows that train. A target that moves is started from the measured state and runs for
        0.3 s at a time, a servo from the start of a recording to its end, by the goal alone; of one
        that is a curve, the effort along the measured motion is compared, where the machine moves.

        Parameters
        ----------
        session : Session, or sequence of Recording, or Recording
            Roles as for a fit: what tests is held out.

        Returns
        -------
        Fidelity

        Raises
        ------
        InputError
            A target that cannot be run, here or on these recordings; nothing that is held out; an
            export that was put together by hand.
        """
        from .fidelity import Bench

        if self.plant is None:
            raise InputError(
                f"{self.target}: this export knows no plant; make it with Plant.export to check it"
            )
        return Bench(self.plant, session).fidelity(self)

    def to_dict(self) -> dict[str, Any]:
        """What it holds and what not, as plain data."""
        return {
            "schema": 1,
            "target": self.target,
            "files": list(self.files),
            "held": list(self.held),
            "lost": list(self.lost),
            "assumed": list(self.assumed),
            "numbers": dict(self.numbers),
        }

    def __str__(self) -> str:
        lines = [f"{self.target}: {', '.join(self.files)}"]
        lines += [f"  taken for granted: {sentence}" for sentence in self.assumed]
        lines += [f"  holds: {sentence}" for sentence in self.held]
        lines += [f"  cannot hold: {sentence}" for sentence in self.lost]
        return "\n".join(lines)
