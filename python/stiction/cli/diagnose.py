"""``stiction diagnose``: what a simulation of a machine is missing."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from ..diagnosis import SMALLEST, SURROGATES
from ..diagnosis import diagnose as run
from ..diagnosis.added import add as added
from ..diagnosis.result import Diagnosis
from ..robot.session import robot_of
from ..session import load_beside
from .answer import answer, folder, told_anyway, written
from .given import Whole
from .interrupt import ending_soon, finished
from .progress import progress
from .robot import diagnose_arm
from .sessions import loaded, mended, spared, spoken_of

__all__ = ["diagnose", "told"]


def diagnose(
    session: Path,
    *,
    without: tuple[str, ...] = (),
    laws: str = "",
    surrogates: Whole = SURROGATES,
    smallest: float = SMALLEST,
    seed: Whole = 0,
    threads: Whole | None = None,
    add: tuple[Path, ...] = (),
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Find out what a simulation of the machine is missing, add it and measure the gain.

    Writes report.html, findings.json, the extended plant.toml, begins.toml with the state at the
    start of each recording, and figures. Of a robot: its own page, robot.toml, and a folder with
    all of that for each joint.

    Parameters
    ----------
    session
        Session file: names the plant, the columns and the recordings.
    without
        Effect that is not tried; may be given several times.
    laws
        Other laws to compare with the plant's: "all", or names with commas between.
    surrogates
        Replays of the fitted plant with noise alone, which thresholds come from.
    smallest
        Share of the friction: what contributes less gets no name.
    seed
        Of everything random.
    threads
        Recordings looked at side by side; results do not depend on it.
    add
        New recording, held against the diagnosis that the folder for the results holds: nothing is
        fitted, and how sure the causes are is counted anew; may be given several times.
    out
        Folder for the results, ./<session>-diagnosis/ without it.
    json
        Print JSON.
    """
    names = [name.strip() for name in laws.split(",") if name.strip()]
    robot = robot_of(session)
    if robot is not None:
        asked = {
            "without": without,
            "laws": names,
            "surrogates": surrogates,
            "smallest": smallest,
            "seed": seed,
            "threads": threads,
        }
        diagnose_arm(session, robot, add, out, asked, as_json=json)
        return
    with progress():
        recordings, plant = loaded(session, keep_faulty=True)
        where = Path(f"{session.stem}-diagnosis") if out is None else out
        if add:
            with spoken_of(session, recordings, plant), written(where):
                found_anew = added(where, recordings, load_beside(session, add, plant))
            answer(str(found_anew), found_anew.findings, as_json=json)
            return
        spared(plant, where)
        folder(where)
        with ending_soon(), spoken_of(session, recordings, plant):
            found = run(
                plant,
                recordings,
                without=without,
                laws=names,
                surrogates=surrogates,
                smallest=smallest,
                seed=seed,
                threads=threads,
            )
    with finished(struck=not found.success):
        with told_anyway(str(found), found.to_dict(), as_json=json), progress(), written(where):
            report = found.save(where)
        # The sentence comes first, whatever was mended before it could be said.
        said = (str(found), "\n".join(mended(recordings)), told(found, report))
        answer("\n\n".join(filter(None, said)), found.to_dict(), as_json=json)
    if not found.success:
        raise KeyboardInterrupt


def told(found: Diagnosis, report: Path) -> str:
    """Where the answer is, in words."""
    return f"{found.split}\n\nreport: {report}" if found.split else f"report: {report}"
