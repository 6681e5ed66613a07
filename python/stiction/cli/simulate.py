"""``stiction simulate``: a plant driven by a recording, beside what was measured."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from .._support.progress import phase, steps
from ..errors import InputError
from .answer import answer, folder, protect_writes
from .given import Quiet
from .progress import progress

__all__ = ["simulate"]

_logger = logging.getLogger(__name__)


def simulate(
    plant: Path,
    recording: Path,
    *,
    columns: Annotated[str | None, Parameter(name=["--columns", "-c"])] = None,
    support: float | None = None,
    out: Annotated[Path, Parameter(name=["--out", "-o"])] = Path("stiction-simulation"),
    json: Annotated[bool, Parameter(negative="")] = False,
    quiet: Quiet = False,
) -> None:
    """Simulate the recorded input; where the motion was measured too, show what is wrong.

    The trajectory is written, as a CSV file that can be read as a recording. With measured motion
    two errors are printed: the free run (started once, left alone) and the effort residual along
    the measured motion. Where the plant states its controller and the recording has a reference,
    the loop of both is simulated as well. A recording of a fit or a diagnosis begins with the
    contact, the clock and the path that begins.toml in the folder of the plant tells of it.

    Parameters
    ----------
    plant
        Plant file.
    recording
        CSV, MAT, NPZ, JSON or Parquet file, or a session file that lists recordings and their
        columns.
    columns
        Columns of a recording whose names are not the canonical ones, with units in brackets:
        "time=t, input=vir [V], position=qm [m]".
    support
        Width of the smoothing kernel in seconds.
    out
        Folder for trajectory and figures.
    json
        Print JSON.
    """
    from .. import session
    from ..plant import Plant
    from ..plant.begins import load_begins
    from ..recording.names import names_of
    from .columns import read_columns
    from .recording_run import begin_for, run_recording, stems_of

    machine = Plant.load(plant)
    told = load_begins(plant, machine)
    with progress(quiet):
        if recording.suffix.lower() == ".toml":
            if columns is not None:
                raise InputError("--columns belongs to a single file; the session states its own")
            recordings = list(session.load(recording, plant=machine))
        else:
            mapped = None if columns is None else read_columns(columns)
            recordings = [session.load_recording(recording, machine, mapped, where="--columns")]
        where = folder(out)
        stems = [where / stem for stem in stems_of(recordings)]
        phase(_logger, "simulating")
        known = [begin_for(told, name) for name in names_of(recordings)]
        each_with_its_begin = list(zip(recordings, stems, known, strict=True))
        results: list[dict[str, Any]] = []
        try:
            for each, stem, begin in steps(each_with_its_begin, "recording"):
                # Ctrl-C ends after the files of one recording, and what is done by then is told.
                with protect_writes(where):
                    results.append(run_recording(machine, each, stem, support, begin))
        except KeyboardInterrupt:
            if results:
                _tell(results, as_json=json)
            raise
    _tell(results, as_json=json)


def _tell(results: list[dict[str, Any]], *, as_json: bool) -> None:
    """Prints the answers for some recordings."""
    # Once for all recordings.
    assumed = dict.fromkeys(sentence for result in results for sentence in result["assumed"])
    text = "\n\n".join(result.pop("text") for result in results)
    text = "".join(f"{sentence}\n" for sentence in assumed) + text
    answer(text, results[0] if len(results) == 1 else results, as_json=as_json)
