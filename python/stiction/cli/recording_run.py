"""What ``stiction simulate`` answers for one recording: its files, its lines and its numbers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import closed_loop
from ..errors import InputError
from ..plant import Plant
from ..plant.assumed import assumptions
from ..plant.begins import FILE, Begin, begin_of
from ..plot import save_or_say
from ..recording import Recording
from ..recording.checks import check, impulse_checks
from ..recording.names import names_of
from ..residual import effort as residual
from .trajectory_csv import save_trajectory

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..trajectory import Trajectory

__all__ = ["begin_for", "run_recording", "stems_of"]


def stems_of(recordings: Sequence[Recording]) -> list[str]:
    """What the files of each recording begin with: its own name, and no other one's.

    Parameters
    ----------
    recordings : sequence of Recording

    Returns
    -------
    list of str
        Names of files without an ending.
    """
    names = [PurePath(name) for name in names_of(recordings)]
    bare = [_flat(name.with_suffix("")) for name in names]
    # Beside run.csv there may be run.npz; not every disk tells Run from run.
    counts = Counter(stem.casefold() for stem in bare)
    ended = [
        f"{stem}{name.suffix.replace('.', '-')}" for stem, name in zip(bare, names, strict=True)
    ]
    stems = [
        long if counts[short.casefold()] > 1 else short
        for short, long in zip(bare, ended, strict=True)
    ]
    counts = Counter(stem.casefold() for stem in stems)
    return [
        f"{stem}-{k}" if counts[stem.casefold()] > 1 else stem for k, stem in enumerate(stems, 1)
    ]


def _flat(name: PurePath) -> str:
    """Folders and file in one word."""
    return name.as_posix().lstrip("/").replace("/", "-").replace(":", "")


def begin_for(told: Mapping[str, Begin], name: str) -> Begin | None:
    """Where a recording begins: of its name, or of the only one of its file's name."""
    if name in told:
        return told[name]
    alike = [begin for other, begin in told.items() if PurePath(other).name == PurePath(name).name]
    return alike[0] if len(alike) == 1 else None


def run_recording(
    plant: Plant, recording: Recording, stem: Path, support: float | None, begin: Begin | None
) -> dict[str, Any]:
    """The answer for one recording.

    Parameters
    ----------
    plant : Plant
    recording : Recording
    stem : Path
        Folder of its files, and what their names begin with.
    support : float or None
        Width of the smoothing kernel, s.
    begin : Begin or None
        Where the recording begins; None where no file tells of it.

    Returns
    -------
    dict
        Its numbers, and under "text" what is printed.

    Raises
    ------
    InputError
        A refusal that names its file.
    """
    try:
        # Absurd numbers are refused below, in words.
        with np.errstate(all="ignore"):
            return _one(plant, recording, stem, support, begin)
    except InputError as error:
        file = str(recording.path)
        raise InputError(str(error) if file in str(error) else f"{file}: {error}") from None


def _one(
    plant: Plant, recording: Recording, stem: Path, support: float | None, begin: Begin | None
) -> dict[str, Any]:
    """The answer for one recording, whose files begin with ``stem``."""
    checks = [*check(recording), *(own for _, own in impulse_checks([recording]))]
    remarks = [each.what for each in checks if each.verdict != "fine"]
    # What was mended stands in the notes already.
    told = dict.fromkeys((*recording.notes, *remarks))
    lines = [f"{stem.name}: {len(recording)} rows over {recording.duration:.6g} s"]
    lines += [f"  {sentence}" for sentence in told]
    result: dict[str, Any] = {
        "recording": stem.name,
        "remarks": remarks,
        "rows": len(recording),
        "duration_s": recording.duration,
        "notes": list(recording.notes),
        "assumed": list(assumptions(plant, recording.units.get("input", ""))),
    }
    drawn = _Drawn(stem)
    if recording.position is not None:
        lines += _beside_the_motion(plant, recording, support, drawn, result, begin_of(begin))
        if begin is not None:
            lines.append(f"begins as {FILE} beside the plant says")
    elif recording.input is not None:
        trajectory = residual.input_run(plant, recording)
        drawn.trajectory(plant, recording, trajectory)
        lines.append(f"simulated: {trajectory.message}")
    else:
        raise InputError(
            "there is no position, and the velocity alone does not tell where friction turns "
            "round; name the column of the position, as in --columns "
            '"position=x" or under [columns] of a session, or call it position_rad or '
            "position_m"
        )
    lines += drawn.failures
    lines += [f"wrote {file}" for file in drawn.files]
    result["files"] = [str(file) for file in drawn.files]
    result["not_drawn"] = drawn.failures
    return {"text": "\n".join(lines), **result}


class _Drawn:
    """Files of one recording, and their writing.

    Attributes
    ----------
    files : list of Path
        That were written, in their order.
    failures : list of str
        Why a figure was not, a sentence each.
    """

    def __init__(self, stem: Path) -> None:
        self._stem = stem
        self.files: list[Path] = []
        self.failures: list[str] = []

    def trajectory(self, plant: Plant, recording: Recording, trajectory: Trajectory) -> None:
        """Write what was simulated."""
        path = self._named("trajectory.csv")
        self.files.append(save_trajectory(path, plant, recording, trajectory))

    def figure(self, make: Callable[[], Figure], name: str) -> None:
        """Write a figure in both formats, or note why it cannot be drawn."""
        paths = [self._named(f"{name}{ending}") for ending in (".svg", ".png")]
        # Of one recording among many: which one is told as well.
        failure = save_or_say(f"the figure {self._stem.name}-{name}", make, *paths)
        if failure:
            self.failures.append(failure)
        else:
            self.files += paths

    def _named(self, name: str) -> Path:
        return self._stem.with_name(f"{self._stem.name}-{name}")


def _beside_the_motion(
    plant: Plant,
    recording: Recording,
    support: float | None,
    drawn: _Drawn,
    result: dict[str, Any],
    begin: dict[str, Any],
) -> list[str]:
    """Lines on what a simulation misses of a measured motion; the numbers go into ``result``."""
    lines = []
    if not plant.prescribed_motion and recording.input is not None:
        run = residual.free_run(plant, recording, **begin)
        drawn.trajectory(plant, recording, run.trajectory)
        drawn.figure(run.plot, "free-run")
        lines.append(
            f"free run: position error {run.rms:.4g} {run.unit} rms, "
            f"{run.mean_absolute:.4g} {run.unit} mean, greatest {run.greatest:.4g} {run.unit}"
        )
        result["free_run"] = run.to_dict()
    if plant.controller and "reference" in recording.channels:
        try:
            loop = closed_loop.replay(plant, recording, **begin)
        except InputError as error:
            lines.append(f"closed loop: {error}")
            result["closed_loop"] = {"error": str(error)}
        else:
            drawn.figure(loop.plot, "closed-loop")
            lines += _loop_lines(loop)
            result["closed_loop"] = loop.to_dict()
    effort = residual.effort_residual(plant, recording, support=support, **begin)
    if not effort.success:
        raise InputError(
            "the effort residual is not a finite number; check units, and cells far beyond what "
            "the machine can do"
        )
    drawn.figure(effort.plot, "effort-residual")
    size = (
        f"error {100 * effort.relative:.3f} % (relative 2-norm), {effort.rms:.4g} {effort.unit} rms"
        if np.isfinite(effort.relative)
        # Of nothing there is no share: the whole input may lie within a dead zone.
        else f"error {effort.rms:.4g} {effort.unit} rms, and the measured effort is 0"
    )
    kernel = f"B-spline kernel of {1e3 * effort.support:.0f} ms on all terms"
    lines.append(f"effort along the measured motion: {size}, {kernel}")
    result["effort_residual"] = effort.to_dict()
    return lines


def _loop_lines(loop: closed_loop.ClosedLoop) -> list[str]:
    lines = [
        f"closed loop: position error {loop.rms:.4g} {loop.unit} rms, "
        f"greatest {loop.greatest:.4g} {loop.unit}"
    ]
    if loop.controller_error is not None:
        lines.append(
            "controller along the measured motion: error "
            f"{100 * loop.controller_error:.3f} % of the recorded input (relative 2-norm)"
        )
    return lines
