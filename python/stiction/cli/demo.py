"""``stiction demo``: a diagnosis of the session that ships with the package."""

from __future__ import annotations

from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from .._support.wording import plural
from .answer import answer, folder, print_on_failure, protect_writes
from .diagnose import summarise
from .given import Quiet
from .interrupt import answer_on_interrupt, defer_interrupt
from .progress import progress

if TYPE_CHECKING:
    from ..diagnosis import Diagnosis
    from ..session import Session

__all__ = ["demo"]


def demo(
    *,
    out: Annotated[Path, Parameter(name=["--out", "-o"])] = Path("stiction-demo"),
    copy: Path | None = None,
    json: Annotated[bool, Parameter(negative="")] = False,
    quiet: Quiet = False,
) -> None:
    """Diagnose recordings of a simulated motor in which one physical effect is hidden.

    They ship with the package. Writes report.html, findings.json, the extended plant.toml and
    figures.

    Parameters
    ----------
    out
        Folder for the results.
    copy
        Folder to lay the recordings and their session file out in, to be edited; nothing is
        diagnosed then.
    json
        Print JSON.
    """
    from .. import demo_session
    from ..diagnosis import diagnose as run

    if copy is not None:
        _copied(copy, as_json=json)
        return
    where = folder(out)
    with progress(quiet):
        session = demo_session.load()
        with answer_on_interrupt():
            found = run(None, session)
    with defer_interrupt(struck=not found.success):
        _told(session, found, where, as_json=json, quiet=quiet)
    if not found.success:
        raise KeyboardInterrupt


def _told(session: Session, found: Diagnosis, where: Path, *, as_json: bool, quiet: bool) -> None:
    """Write the report and say what was found, and what was hidden."""
    from .. import demo_session

    with (
        print_on_failure(str(found), found.to_dict(), as_json=as_json),
        progress(quiet),
        protect_writes(where),
    ):
        report = found.save(where)
    seconds = sum(recording.duration for recording in session)
    text = (
        f"{plural(len(session), 'recording')} ({seconds:.0f} s) of a simulated motor. Its plant "
        "file names a friction law and no effect;\none physical effect is hidden in the "
        f"recordings.\n\n{found}\n\nwhat was hidden: {demo_session.hidden()}\n\n"
        f"{summarise(found, report)}\n"
        "next: stiction demo --copy my-motor lays the recordings out as files, for you to change"
    )
    answer(text, found.to_dict(), as_json=as_json)


def _copied(where: Path, *, as_json: bool) -> None:
    """Lay the session out and say what comes next."""
    from .. import demo_session

    with protect_writes(where):
        files = demo_session.copy(where)
    recordings = [file for file in files if file.suffix == ".csv"]
    texts = [file for file in files if file.suffix != ".csv"]
    command = f"stiction diagnose {quote(str(files[0]))}"
    lines = [f"wrote {file}" for file in texts]
    lines += [f"wrote {plural(len(recordings), 'recording')} as CSV into {recordings[0].parent}"]
    lines += [f"next: {command}"]
    data = {"files": [str(file) for file in files], "next": command}
    answer("\n".join(lines), data, as_json=as_json)
