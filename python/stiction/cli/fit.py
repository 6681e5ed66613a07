"""``stiction fit``: parameters from recordings."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from ..atomic_files import write_text
from ..begins import FILE as BEGINS
from ..begins import save_begins
from ..errors import InputError
from ..fitting import FitResult
from ..fitting import fit as run
from ..session import Session
from .answer import answer, folder, told_anyway, written
from .given import Quiet
from .interrupt import ending_soon, finished
from .progress import progress
from .sessions import loaded, mended, spared, spoken_of

__all__ = ["fit"]


def fit(
    session: Path,
    *,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    json: Annotated[bool, Parameter(negative="")] = False,
    quiet: Quiet = False,
) -> None:
    """Fit the plant of a session to its recordings.

    Writes the fitted plant.toml, begins.toml with the state at the start of each recording,
    fit.json and fit.html, and prints parameters with standard errors, the error where fitted and
    the error held out.

    Parameters
    ----------
    session
        Session file: names the plant, the columns and the recordings.
    out
        Folder for the results, ./<session>-fit/ without it.
    json
        Print JSON.
    """
    with progress(quiet):
        recordings, plant = loaded(session)
        where = Path(f"{session.stem}-fit") if out is None else out
        spared(plant, where)
        folder(where)
        with ending_soon(), spoken_of(session, recordings, plant):
            result = run(plant, recordings)
            if not math.isfinite(result.train_rms):
                raise InputError(
                    "the effort residual is not a finite number; check units, and values far "
                    "beyond what the machine can do"
                )
    with finished(struck=result.interrupted):
        _told(recordings, result, where, session.name, as_json=json)
    if result.interrupted:
        raise KeyboardInterrupt


def _told(recordings: Session, result: FitResult, where: Path, name: str, *, as_json: bool) -> None:
    """Write plant, numbers and page, and say what was fitted."""
    from ..report.fit_page import fit_page

    files = [where / "plant.toml", where / BEGINS, where / "fit.json", where / "fit.html"]
    with told_anyway(str(result), result.to_dict(), as_json=as_json), written(where):
        # The numbers first: no figure can cost them.
        result.plant.save(files[0])
        save_begins(where, result.begins)
        write_text(files[2], result.to_json() + "\n")
        write_text(files[3], fit_page(result, list(recordings), f"Fit of {name}"))
    wrote = "\n".join(f"wrote {file}" for file in files)
    repairs = mended(recordings)
    told = "\n".join([*repairs, str(result)])
    answer(f"{told}\n\n{wrote}", {**result.to_dict(), "repairs": repairs}, as_json=as_json)
