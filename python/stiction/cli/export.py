"""``stiction export``: a plant for other tools."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from .._support.progress import phase
from .._support.wording import commas
from ..errors import InputError
from .answer import answer, folder, protect_writes
from .given import Quiet, separate
from .progress import progress

if TYPE_CHECKING:
    from ..export import Export
    from ..plant import Plant
    from ..session import Session

__all__ = ["export"]

_logger = logging.getLogger(__name__)


def export(
    plant: Path | None = None,
    *,
    to: tuple[str, ...] = (),
    speed: float | None = None,
    check: Path | None = None,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    list: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
    quiet: Quiet = False,
) -> None:
    """Write a plant for a simulator, a controller or firmware, and say what is lost on the way.

    Parameters
    ----------
    plant
        Plant file, or that of a robot: each of its joints is written.
    to
        Target, or several with commas between.
    speed
        Greatest speed at which friction matters, rad/s or m/s; without it the greatest one of the
        session, or what is usual: 10 rad/s or 0.2 m/s.
    check
        Session file: each target is run on the recordings that are held out, and one line says what
        it keeps of what the effects of the plant are worth.
    out
        Folder for the files, ./<plant>-export/ without it; each target has its own in there.
    list
        Print the targets.
    json
        Print JSON.
    """
    from .. import session as sessions
    from ..export import targets
    from ..export.speeds import recorded_speed
    from ..plant import Plant
    from ..robot.robot import describes_robot
    from .robot import export_arm
    from .sessions import refuse_other_than_session

    known = targets()
    if list:
        text = "\n".join(f"{each.name:<8} {each.summary}" for each in known.values())
        answer(text, {each.name: each.summary for each in known.values()}, as_json=json)
        return
    if plant is None:
        raise InputError("stiction export: no plant file is given; name one, or ask with --list")
    to = tuple(name for word in to for name in separate(word))
    if not to:
        raise InputError(
            f"stiction export: no target is given; write --to and one of {commas(known)}"
        )
    if describes_robot(plant):
        where = Path(f"{plant.stem}-export") if out is None else out
        export_arm(plant, to, speed, check, where, as_json=json)
        return
    read = Plant.load(plant)
    if check is not None:
        refuse_other_than_session(check)
    loaded = None if check is None else sessions.load(check, plant=read)
    if speed is None and loaded is not None:
        speed = recorded_speed(loaded.recordings)
    made, refused = _written(read, to, speed)
    where = folder(Path(f"{plant.stem}-export") if out is None else out)
    replaced = [_files_there(each, where / each.target) for each in made]
    with protect_writes(where):
        for each in made:
            each.save(where / each.target)
    texts = [
        f"{each}\n  folder: {where / each.target}{old}"
        for each, old in zip(made, replaced, strict=True)
    ]
    data = [each.to_dict() for each in made]
    if check is not None and loaded is not None:
        with progress(quiet):
            found = _checked(read, made, check, loaded)
        texts += [text for text, _ in found]
        data = [{**own, "check": told} for own, (_, told) in zip(data, found, strict=True)]
    texts += [f"{name}: not written: {told}" for name, told in refused.items()]
    data += [{"target": name, "error": told} for name, told in refused.items()]
    answer("\n".join(texts), data, as_json=json)


def _files_there(made: Export, where: Path) -> str:
    """Which files of an export stand in a folder already, in words."""
    old = [name for name in made.files if (where / name).exists()]
    return f" (in place of what was there: {commas(old)})" if old else ""


def _written(
    plant: Plant, to: tuple[str, ...], speed: float | None
) -> tuple[list[Export], dict[str, str]]:
    """What could be written, and why the rest could not: refused where that is all of it."""
    from ..export import targets

    made, refused = [], {}
    for name in to:
        try:
            made.append(plant.export(name, speed=speed))
        except InputError as error:
            if len(to) == 1 or name not in targets():
                raise
            refused[name] = str(error)
    if not made:
        raise InputError("; ".join(refused.values()))
    return made, refused


def _checked(
    plant: Plant, made: list[Export], session: Path, loaded: Session
) -> list[tuple[str, dict[str, Any]]]:
    """What each target keeps, as text and as data: one that cannot be run says why."""
    from ..export.fidelity import Bench
    from .sessions import name_file_in_errors

    found: list[tuple[str, dict[str, Any]]] = []
    with name_file_in_errors(session, loaded, plant):
        bench = Bench(plant, loaded)
        for each in made:
            phase(_logger, "running %s", each.target)
            try:
                fidelity = bench.fidelity(each)
            except InputError as error:
                found.append((f"{each.target}: not checked: {error}", {"error": str(error)}))
            else:
                found.append((str(fidelity), fidelity.to_dict()))
    return found
