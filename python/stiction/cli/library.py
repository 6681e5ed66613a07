"""``stiction library``: machines whose friction is known, and a unit of one's own beside them."""

from __future__ import annotations

from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Annotated, Final

from cyclopts import Parameter

from .._support.atomic_files import write_text
from .._support.json_text import json_of
from ..errors import InputError
from .answer import answer, folder, print_on_failure, protect_writes
from .given import Quiet
from .interrupt import answer_on_interrupt, defer_interrupt
from .progress import progress

if TYPE_CHECKING:
    from ..library import Entry, UnitComparison
    from ..session import Session

__all__ = ["library"]

WIDTH: Final = 100
"""Of a terminal, in characters."""


def library(
    name: str | None = None,
    *,
    session: Path | None = None,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    json: Annotated[bool, Parameter(negative="")] = False,
    quiet: Quiet = False,
) -> None:
    """List machines whose friction is known, show one, or compare a unit of yours with it.

    With --session a fit starts at the entry, from a minute of recordings or less, and each number
    stands beside the library's, its interval and what differs from unit to unit.

    Parameters
    ----------
    name
        Entry to show, or the folder of a stiction fit: has this machine changed since?
    session
        Session file with recordings of your unit. Its plant, where it names one, says how yours is
        driven and what it carries; law and effects are those of the entry.
    out
        Folder for plant.toml: of the entry, or as fitted to your unit, with comparison.json.
    json
        Print JSON.
    """
    from ..library import entries, entry, entry_of_fit

    if name is None:
        if session is not None:
            raise InputError("stiction library: no entry is given; name one to compare with")
        _listed(out, as_json=json)
        return
    own = name not in {each.name for each in entries()} and Path(name).exists()
    found = entry_of_fit(Path(name)) if own else entry(name)
    if session is None:
        text = str(found)
        if out is not None:
            where = folder(out)
            with protect_writes(where):
                found.plant.save(where / "plant.toml")
            text = f"{text}\n\nwrote {where / 'plant.toml'}"
        answer(text, found.to_dict(), as_json=json)
        return
    _compared(found, session, out, as_json=json, quiet=quiet)


def _listed(out: Path | None, *, as_json: bool) -> None:
    from ..library import entries

    every = entries()
    text = "\n".join(line for each in every for line in _lines(each))
    data = [each.to_dict() for each in every]
    if out is not None:
        where = folder(out)
        with protect_writes(where):
            write_text(where / "library.json", json_of(data) + "\n")
    answer(text, data, as_json=as_json)


def _lines(each: Entry) -> list[str]:
    """An entry in lines that fit a terminal: name and machine, law and effects, source."""
    law = " + ".join((each.plant.friction.law, *each.effects))
    indent = 18 * " "
    source = wrap(
        f"{each.kind}: {each.source['text']}",
        WIDTH,
        initial_indent=indent,
        subsequent_indent=indent,
    )
    return [f"{each.name:<16}  {each.machine}", f"{indent}{law}", *source]


def _compared(found: Entry, path: Path, out: Path | None, *, as_json: bool, quiet: bool) -> None:
    from .. import session as sessions
    from ..library import compare
    from ..plant.plant_file import read_toml
    from .sessions import name_file_in_errors

    with progress(quiet):
        # A session need not name a plant: that of the entry then says how it is driven.
        own = None if "plant" in read_toml(path) else found.plant
        recordings = sessions.load(path, plant=own)
        beside = Path(found.name).name or "fit"
        where = folder(Path(f"{path.stem}-beside-{beside}") if out is None else out)
        plant = recordings.plant or found.plant
        with answer_on_interrupt(), name_file_in_errors(path, recordings, plant):
            comparison = compare(found, recordings)
    with defer_interrupt(struck=comparison.result.interrupted):
        _told(recordings, comparison, where, as_json=as_json)
    if comparison.result.interrupted:
        raise KeyboardInterrupt


def _told(recordings: Session, found: UnitComparison, where: Path, *, as_json: bool) -> None:
    from .sessions import repairs_of

    files = [where / "plant.toml", where / "comparison.json"]
    with print_on_failure(str(found), found.to_dict(), as_json=as_json), protect_writes(where):
        found.result.plant.save(files[0])
        write_text(files[1], found.to_json() + "\n")
    wrote = "\n".join(f"wrote {file}" for file in files)
    text = "\n".join([*repairs_of(recordings), str(found)])
    answer(f"{text}\n\n{wrote}", found.to_dict(), as_json=as_json)
