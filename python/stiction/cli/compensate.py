"""``stiction compensate``: what a feed-forward of friction would be worth."""

from __future__ import annotations

import logging
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

from cyclopts import Parameter

from .._support.atomic_files import write_text
from .._support.json_text import json_of
from .._support.progress import phase
from .._support.wording import commas
from ..errors import InputError
from .answer import answer, folder, print_on_failure, protect_writes
from .given import Quiet
from .progress import progress

if TYPE_CHECKING:
    from ..compensation import Compensation
    from ..plant import Plant

__all__ = ["compensate"]

RESULTS: Final = ("findings.json", "fit.json")
"""Files that hold intervals of parameters."""
_logger = logging.getLogger(__name__)


def compensate(
    plant: Path,
    *,
    session: Path,
    intervals: Path | None = None,
    out: Annotated[Path, Parameter(name=["--out", "-o"])] = Path("stiction-compensation"),
    json: Annotated[bool, Parameter(negative="")] = False,
    quiet: Quiet = False,
) -> None:
    """Simulate the machine under its controller with a feed-forward of friction, and without.

    The plant, as a diagnosis extended it, follows the recorded references. A feed-forward adds what
    friction and place will take along the reference to the input; half of it, the whole and twice
    as much are simulated, and the contact itself stepped along the references, with the states of
    its law, and along the simulated readings, as an observer in a controller is. Of that one it is
    said how much of it makes a limit cycle. `stiction export --to c` or `--to table` write it for a
    controller.

    Parameters
    ----------
    plant
        Plant file with a [controller].
    session
        Session file; recordings that have a reference are followed.
    intervals
        findings.json or fit.json with the intervals of the parameters, within which machines are
        drawn. Default: the one beside the plant.
    out
        Folder for compensation.json and figures.
    json
        Print JSON.
    """
    import numpy as np

    from .. import session as sessions
    from ..compensation import compensate as simulated
    from ..plant import Plant
    from ..plant.begins import load_begins
    from ..recording.names import names_of
    from .recording_run import begin_for, stems_of
    from .sessions import refuse_other_than_session

    machine = Plant.load(plant)
    refuse_other_than_session(session)
    if machine.servo:
        raise InputError(
            f"{plant}: the drive of a servo takes a goal and nothing beside it, so that nothing "
            "can be added to its effort; state a drive and its controller"
        )
    told = load_begins(plant, machine)
    known, note = (intervals, "") if intervals is not None else _beside(plant, machine)
    with progress(quiet):
        every = list(sessions.load(session, plant=machine))
        chosen = [each for each in every if "reference" in each.channels]
        if not chosen:
            raise InputError(
                f"{session}: no recording has a reference that the controller could follow; name "
                "its column under [columns] as reference"
            )
        where = folder(out)
        phase(_logger, "simulating the loop")
        begins = [begin_for(told, name) for name in names_of(chosen)]
        with np.errstate(all="ignore"):
            found = simulated(machine, chosen, begins, intervals=known)
        text = "\n".join([found.message, *_table(found)])
        with print_on_failure(text, found.to_dict(), as_json=json), protect_writes(where):
            lines = _saved(found, where, stems_of(chosen))
    if note:
        lines.append(note)
    left = len(every) - len(chosen)
    if left:
        lines.append(f"{left} of {len(every)} recordings have no reference and were left out")
    answer("\n".join([text, *lines]), found.to_dict(), as_json=json)


def _beside(plant: Path, machine: Plant) -> tuple[dict[str, tuple[float, float]] | None, str]:
    """Intervals that a diagnosis or a fit wrote beside the plant; why there are none, in words."""
    from ..intervals import intervals_of

    path = next((path for name in RESULTS if (path := plant.parent / name).exists()), None)
    if path is None:
        return None, f"no interval: there is no {' or '.join(RESULTS)} beside {plant}"
    try:
        told = intervals_of(path)
    except InputError as error:
        return None, f"no interval: {error}"
    stated = machine.parameters
    # A plant that was changed by hand, or went on with another law, is another machine.
    foreign = [
        name
        for name, (low, high) in told.items()
        if name not in stated or not low <= stated[name].value <= high
    ]
    if foreign:
        return None, f"no interval: {path} tells of another plant in {commas(foreign)}"
    return told, ""


def _saved(found: Compensation, where: Path, stems: list[str]) -> list[str]:
    """Writes the numbers before anything is drawn; what could not be drawn, in words."""
    from ..plot import save_or_say

    write_text(where / "compensation.json", json_of(found.to_dict()) + "\n")
    said = [
        save_or_say(f"figure of {each.name}", each.plot, where / f"{stem}-tracking.svg")
        for each, stem in zip(found.recordings, stems, strict=True)
    ]
    return [*filter(None, said), f"files: {where}"]


def _table(found: Compensation) -> list[str]:
    unit = found.recordings[0].unit

    def told(error: float) -> str:
        return f"{error:.4g} {unit}" if math.isfinite(error) else "ran away"

    every = zip(found.shares, found.rms, found.observer_rms, found.cycles, strict=True)
    rows = [
        f"{share:>13g}  {told(ahead):<16}{told(observed)}{', limit cycle' if cycles else ''}"
        for share, ahead, observed, cycles in every
    ]
    head = f"{'share':>13}  {'feed-forward':<16}by the measured motion"
    return [
        "",
        "tracking error, rms",
        head,
        *rows,
        f"{'1, stepped':>13}  {told(found.stepped)}",
        "",
    ]
