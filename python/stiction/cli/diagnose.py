"""``stiction diagnose``: what a simulation of a machine is missing."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from ..diagnosis import ALPHA, SMALLEST, SURROGATES
from .answer import answer, folder, print_on_failure, protect_writes
from .given import Quiet, Whole, separate
from .interrupt import answer_on_interrupt, defer_interrupt
from .progress import progress

if TYPE_CHECKING:
    from ..diagnosis import Diagnosis
    from .drafts import Opened

__all__ = ["diagnose", "summarise"]


def diagnose(
    session: Path,
    *more: Path,
    columns: Annotated[str, Parameter(name=["--columns", "-c"])] = "",
    gain: float | None = None,
    law: str = "",
    joint: str = "",
    header: str = "",
    without: Annotated[tuple[str, ...], Parameter(negative="")] = (),
    laws: str = "",
    surrogates: Whole = SURROGATES,
    smallest: float = SMALLEST,
    alpha: float = ALPHA,
    seed: Whole = 0,
    threads: Whole | None = None,
    add: Annotated[tuple[Path, ...], Parameter(negative="")] = (),
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    json: Annotated[bool, Parameter(negative="")] = False,
    quiet: Quiet = False,
) -> None:
    """Find out what a simulation of the machine is missing, add it and measure the gain.

    Writes report.html, findings.json, the extended plant.toml, begins.toml with the state at the
    start of each recording, and figures. Of recordings in place of a session file the session is
    drafted as stiction init does it: what was assumed is said, and kept in draft/ to go on from. Of
    a robot: its own page, robot.toml, and a folder with all of that for each joint.

    Parameters
    ----------
    session
        Session file, which names plant, columns and recordings; or a recording, or a folder of
        them.
    more
        More recordings with the same columns.
    columns
        Of recordings: columns that are something else than guessed, with units in brackets:
        "input=vir [V], position=qm [mm]".
    gain
        Of recordings: effort per SI unit of the input, in N·m/A and the like. Without it every
        effort is in the unit of the input.
    law
        Of recordings: friction law of the plant, coulomb without it.
    joint
        Of recordings of several joints the one that is wanted.
    header
        Of recordings without names of columns: the names, as for stiction init.
    without
        Effect that is not tried; may be given several times, or names with commas between.
    laws
        Other laws to compare with the plant's: "all", or names with commas between.
    surrogates
        Replays of the fitted plant with noise alone, which thresholds come from.
    smallest
        Share of the friction: what contributes less gets no name.
    alpha
        Level of the screening: the probability that noise passes it in a session that lacks
        nothing.
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
    from ..diagnosis import diagnose as run
    from ..diagnosis.findings.added import add as added
    from ..robot.session import robot_of
    from ..session import load_beside
    from .drafts import Stated, is_data, open_session
    from .robot import diagnose_arm
    from .sessions import name_file_in_errors, refuse_overwrite, repairs_of

    names = separate(laws)
    left_out = [name for each in without for name in separate(each)]
    robot = None if is_data(session) else robot_of(session)
    if robot is not None:
        asked = {
            "without": left_out,
            "laws": names,
            "surrogates": surrogates,
            "smallest": smallest,
            "alpha": alpha,
            "seed": seed,
            "threads": threads,
        }
        diagnose_arm(session, robot, add, out, asked, as_json=json, quiet=quiet)
        return
    told_of = Stated(columns, gain, law, joint, header)
    with progress(quiet):
        at = open_session([session, *more], out, "diagnosis", told_of, keep_faulty=True)
        recordings, plant, where = at.session, at.plant, at.where
        if add:
            with name_file_in_errors(at.path, recordings, plant), protect_writes(where):
                found_anew = added(where, recordings, load_beside(at.path, add, plant))
            answer(str(found_anew), found_anew.findings, as_json=json)
            return
        refuse_overwrite(plant, where)
        folder(where)
        with answer_on_interrupt(), name_file_in_errors(at.path, recordings, plant):
            found = run(
                plant,
                recordings,
                without=left_out,
                laws=names,
                surrogates=surrogates,
                smallest=smallest,
                alpha=alpha,
                seed=seed,
                threads=threads,
            )
    content = found.to_dict()
    if at.assumed:
        content["draft"] = {"assumed": list(at.assumed), "files": [str(f) for f in at.drafted]}
    with defer_interrupt(struck=not found.success):
        with (
            print_on_failure(str(found), content, as_json=json),
            progress(quiet),
            protect_writes(where),
        ):
            report = found.save(where)
        # The sentence comes first, whatever was mended before it could be said.
        mends = "\n".join(repairs_of(recordings))
        said = ("\n".join(at.assumed), str(found), mends, summarise(found, report), _onward(at))
        answer("\n\n".join(filter(None, said)), content, as_json=json)
    if not found.success:
        raise KeyboardInterrupt


def _onward(at: Opened) -> str:
    """Where what was assumed can be corrected, in words."""
    if not at.drafted:
        return ""
    return f"go on: correct {at.drafted[0]} and {at.path.name}, then stiction diagnose {at.path}"


def summarise(found: Diagnosis, report: Path) -> str:
    """Where the answer is, in words."""
    return f"{found.split}\n\nreport: {report}" if found.split else f"report: {report}"
