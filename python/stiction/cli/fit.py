"""``stiction fit``: parameters from recordings."""

from __future__ import annotations

import math
import os
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from .._support.atomic_files import write_text
from ..errors import InputError
from .answer import answer, folder, print_on_failure, protect_writes
from .given import Quiet, expand_patterns
from .interrupt import answer_on_interrupt, defer_interrupt
from .progress import progress

if TYPE_CHECKING:
    from ..fitting import FitResult
    from ..plant import Plant
    from .drafts import Opened

__all__ = ["fit"]


def fit(
    session: Path,
    *more: Path,
    columns: Annotated[str, Parameter(name=["--columns", "-c"])] = "",
    gain: float | None = None,
    law: str = "",
    joint: str = "",
    header: str = "",
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    json: Annotated[bool, Parameter(negative="")] = False,
    quiet: Quiet = False,
) -> None:
    """Fit the plant of a session to its recordings, or a law to a table of speed and friction.

    Writes the fitted plant.toml, begins.toml with the state at the start of each recording,
    fit.json and fit.html, and prints parameters with standard errors, the error where fitted and
    the error held out. Of recordings in place of a session file the session is drafted as stiction
    diagnose does it. A file with speed and friction and no time is a friction curve: the law is
    fitted to its points, and plant.toml and curve.json are written.

    Parameters
    ----------
    session
        Session file: names the plant, the columns and the recordings. Or a recording, a folder of
        them, or a table of speed and friction.
    more
        More recordings with the same columns.
    columns
        Of recordings: columns that are something else than guessed, with units in brackets:
        "input=vir [V], position=qm [mm]"; of a friction curve "velocity=w [rpm], effort=T [Nm]".
    gain
        Of recordings: effort per SI unit of the input.
    law
        Of recordings and friction curves: friction law, coulomb without it.
    joint
        Of recordings of several joints the one that is wanted.
    header
        Of recordings without names of columns: the names, as for stiction init.
    out
        Folder for the results, ./<session>-fit/ without it.
    json
        Print JSON.
    """
    from ..fitting import fit as run
    from .drafts import Stated, open_session
    from .sessions import name_file_in_errors, refuse_overwrite

    session, *others = expand_patterns([session, *more])
    if not others and _curve(session, columns, law, out, as_json=json):
        return
    with progress(quiet):
        at = open_session([session, *others], out, "fit", Stated(columns, gain, law, joint, header))
        recordings, plant, where = at.session, at.plant, at.where
        refuse_overwrite(plant, where)
        folder(where)
        with answer_on_interrupt(), name_file_in_errors(at.path, recordings, plant):
            result = run(plant, recordings)
            if not math.isfinite(result.train_rms):
                raise InputError(
                    "the effort residual is not a finite number; check units, and values far "
                    "beyond what the machine can do"
                )
    with defer_interrupt(struck=result.interrupted):
        _told(at, result, session.name, as_json=json)
    if result.interrupted:
        raise KeyboardInterrupt


def _curve(path: Path, columns: str, law: str, out: Path | None, *, as_json: bool) -> bool:
    """Fit a law to a friction curve and say so, where the file is one."""
    from .._support.file_kinds import refuse_findings
    from ..fitting.curve_file import curve_table, fit_curve_file
    from .columns import read_columns
    from .drafts import is_data

    if not is_data(path) or os.path.isdir(path):
        return False

    refuse_findings(path)
    stated = read_columns(columns) if columns else None
    table = curve_table(path, stated)
    if table is None:
        return False
    found, notes = fit_curve_file(path, law or "coulomb", stated, table)
    where = folder(Path(f"{path.stem}-fit") if out is None else out)
    text, data = "\n".join([str(found), *notes]), {**found.to_dict(), "assumed": list(notes)}
    with print_on_failure(text, data, as_json=as_json), protect_writes(where):
        files = found.save(where)
    wrote = "\n".join(f"wrote {file}" for file in files)
    answer(f"{text}\n\n{wrote}\n{_after_curve(files[0], found.plant)}", data, as_json=as_json)
    return True


def _after_curve(plant_file: Path, plant: Plant) -> str:
    """What a friction curve alone is good for, and what a simulation of its machine takes."""
    unit, drive = ("kg·m²", "torque_nm") if plant.motion == "rotary" else ("kg", "force_n")
    return (
        f"next: stiction export {shlex.quote(str(plant_file))} --to c writes this friction for a "
        f"controller; to simulate the machine, state [body] inertia ({unit}) there and [drive] "
        f"input = '{drive}' in place of kind = 'prescribed_motion'"
    )


def _told(at: Opened, result: FitResult, name: str, *, as_json: bool) -> None:
    """Write plant, numbers and page, and say what was fitted."""
    from ..plant.begins import FILE as BEGINS
    from ..plant.begins import save_begins
    from ..report.fit_page import fit_page
    from .sessions import repairs_of

    recordings, where = at.session, at.where
    files = [where / "plant.toml", where / BEGINS, where / "fit.json", where / "fit.html"]
    with print_on_failure(str(result), result.to_dict(), as_json=as_json), protect_writes(where):
        # The numbers first: no figure can cost them.
        result.plant.save(files[0])
        save_begins(where, result.begins)
        write_text(files[2], result.to_json() + "\n")
        write_text(files[3], fit_page(result, list(recordings), f"Fit of {name}"))
    wrote = "\n".join(f"wrote {file}" for file in files)
    repairs = repairs_of(recordings)
    told = "\n".join([*at.assumed, *repairs, str(result)])
    data = {**result.to_dict(), "repairs": repairs}
    if at.assumed:
        data["draft"] = {"assumed": list(at.assumed), "files": [str(f) for f in at.drafted]}
    answer(f"{told}\n\n{wrote}", data, as_json=as_json)
