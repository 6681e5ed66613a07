"""``stiction export``: a plant for other tools."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from ..errors import InputError
from ..export import targets
from ..plant import Plant
from .answer import answer, folder, written

__all__ = ["export"]


def export(
    plant: Path | None = None,
    *,
    to: tuple[str, ...] = (),
    speed: float = 10.0,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    list: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Write a plant for a simulator, a controller or firmware, and say what is lost on the way.

    Parameters
    ----------
    plant
        Plant file.
    to
        Target; may be given several times.
    speed
        Greatest speed at which friction matters, rad/s or m/s.
    out
        Folder for the files, ./<plant>-export/ without it; each target has its own in there.
    list
        Print the targets.
    json
        Print JSON.
    """
    known = targets()
    if list:
        text = "\n".join(f"{each.name:<8} {each.summary}" for each in known.values())
        answer(text, {each.name: each.summary for each in known.values()}, as_json=json)
        return
    if plant is None:
        raise InputError("stiction export: no plant file is given; name one, or ask with --list")
    if not to:
        raise InputError(f"stiction export: no target is given; write --to {next(iter(known))}")
    read = Plant.load(plant)
    made = [read.export(name, speed=speed) for name in to]
    where = folder(Path(f"{plant.stem}-export") if out is None else out)
    texts = []
    with written(where):
        for each in made:
            each.save(where / each.target)
            texts.append(f"{each}\n  folder: {where / each.target}")
    answer("\n".join(texts), [each.to_dict() for each in made], as_json=json)
