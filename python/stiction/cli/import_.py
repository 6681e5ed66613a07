"""``stiction import``: a plant from the parameters of another tool."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .._support.atomic_files import create_text
from .answer import answer, folder, protect_writes

__all__ = ["import_"]

_FILE = "plant.toml"


def import_(
    file: Path,
    *,
    kp: float | None = None,
    vin: float | None = None,
    out: Annotated[Path, Parameter(name=["--out", "-o"])] = Path(),
    json: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Make a plant.toml of parameters that another tool has found.

    The tool is better-actuator-models (BAM): a JSON file that names a model, M1 to M6, and an
    actuator. What the file leaves open and which numbers stand at a bound of BAM's search is told.
    A plant.toml that is there is not overwritten.

    Parameters
    ----------
    file
        JSON file of parameters.
    kp
        Gain of the firmware, in BAM's unit, where it is not the actuator's usual one.
    vin
        Supply in V, likewise.
    out
        Folder to write into, the present one without it.
    json
        Print JSON.
    """
    from .._support.given import vacant
    from ..bam import read_bam
    from ..plant.plant_file import render

    vacant(out, (_FILE,), "another folder with --out")
    found = read_bam(file, kp=kp, vin=vin)
    where = folder(out)
    with protect_writes(where):
        create_text(where / _FILE, render(found.plant.to_dict()))
    answer(f"{found}\nwrote {where / _FILE}", found.to_dict(), as_json=json)
