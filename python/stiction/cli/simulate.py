"""``stiction simulate``: a plant driven by a recording, beside what was measured."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import numpy as np
from cyclopts import Parameter

from .. import closed_loop, residual, session
from ..errors import InputError
from ..plant import Plant
from ..recording import Recording
from ..recording.checks import check, impulse_checks
from .answer import answer, folder, written

__all__ = ["simulate"]


def simulate(
    plant: Path,
    recording: Path,
    *,
    columns: Annotated[str | None, Parameter(name=["--columns", "-c"])] = None,
    support: float | None = None,
    out: Annotated[Path, Parameter(name=["--out", "-o"])] = Path("stiction-simulation"),
    json: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Simulate the recorded input; where the motion was measured too, show what is wrong.

    With the input alone the trajectory is written. With measured motion two errors are printed:
    the free run (started once, left alone) and the effort residual along the measured motion.
    Where the plant states its controller and the recording has a reference, the loop of both is
    simulated as well.

    Parameters
    ----------
    plant
        Plant file.
    recording
        CSV or MAT file, or a session file that lists recordings and their columns.
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
    machine = Plant.load(plant)
    if recording.suffix.lower() == ".toml":
        if columns is not None:
            raise InputError("--columns belongs to a single file; the session states its own")
        recordings = list(session.load(recording, plant=machine))
    else:
        mapped = None if columns is None else read_columns(columns)
        recordings = [session.load_recording(recording, machine, mapped, where="--columns")]
    where = folder(out)
    with written(where):
        results = [_named(machine, each, where, support) for each in recordings]
    text = "\n\n".join(result.pop("text") for result in results)
    answer(text, results[0] if len(results) == 1 else results, as_json=json)


def read_columns(text: str) -> dict[str, Any]:
    """Columns from "role=name [unit], role=name".

    Raises
    ------
    InputError
        An entry without "=", or one role twice.
    """
    columns: dict[str, Any] = {}
    for entry in text.split(","):
        role, equals, name = (part.strip() for part in entry.partition("="))
        if not equals or not role or not name:
            raise InputError(
                f"--columns: '{entry.strip()}' is not role=name; write for instance "
                '"time=t, input=u [V], position=x [mm]"'
            )
        if role in columns:
            raise InputError(f"--columns: {role} is there twice; drop one")
        bare, bracket, unit = name.partition("[")
        if bracket:
            if not unit.endswith("]"):
                raise InputError(f"--columns: '{name}' lacks a closing bracket")
            columns[role] = {"name": bare.strip(), "unit": unit[:-1].strip()}
        else:
            columns[role] = name
    return columns


def _named(
    plant: Plant, recording: Recording, where: Path, support: float | None
) -> dict[str, Any]:
    """The answer for one recording, or a refusal that names its file."""
    try:
        # Absurd numbers are refused below, in words.
        with np.errstate(all="ignore"):
            return _one(plant, recording, where, support)
    except InputError as error:
        file = str(recording.path)
        raise InputError(str(error) if file in str(error) else f"{file}: {error}") from None


def _one(plant: Plant, recording: Recording, where: Path, support: float | None) -> dict[str, Any]:
    stem = recording.path.stem if recording.path is not None else "recording"
    lines = [f"{stem}: {len(recording)} rows over {recording.duration:.6g} s"]
    lines += [f"  {note}" for note in recording.notes]
    checks = [*check(recording), *(own for _, own in impulse_checks([recording]))]
    remarks = [each.what for each in checks if each.verdict != "fine"]
    lines += [f"  {remark}" for remark in remarks]
    result: dict[str, Any] = {
        "recording": stem,
        "remarks": remarks,
        "rows": len(recording),
        "duration_s": recording.duration,
        "notes": list(recording.notes),
    }
    files: list[Path] = []
    if recording.position is None:
        if recording.input is None:
            raise InputError(f"{stem}: there is neither input nor motion to work with")
        trajectory = residual.input_run(plant, recording)
        files.append(trajectory.save(where / f"{stem}-trajectory.csv"))
        lines.append(f"simulated: {trajectory.message}")
    else:
        if not plant.prescribed_motion and recording.input is not None:
            run = residual.free_run(plant, recording)
            files.append(run.trajectory.save(where / f"{stem}-trajectory.csv"))
            files += _figures(run.plot(), where / f"{stem}-free-run")
            lines.append(
                f"free run: position error {run.rms:.4g} {run.unit} rms, "
                f"{run.mean_absolute:.4g} {run.unit} mean, greatest {run.greatest:.4g} {run.unit}"
            )
            result["free_run"] = run.to_dict()
        if plant.controller and "reference" in recording.channels:
            try:
                loop = closed_loop.replay(plant, recording)
            except InputError as error:
                lines.append(f"closed loop: {error}")
            else:
                files += _figures(loop.plot(), where / f"{stem}-closed-loop")
                lines += _loop_lines(loop)
                result["closed_loop"] = loop.to_dict()
        effort = residual.effort_residual(plant, recording, support=support)
        if not np.isfinite(effort.relative):
            raise InputError(
                "the effort residual is not a finite number; check units, and cells far beyond "
                "what the machine can do"
            )
        files += _figures(effort.plot(), where / f"{stem}-effort-residual")
        lines.append(
            f"effort along the measured motion: error {100 * effort.relative:.3f} % "
            f"(relative 2-norm), {effort.rms:.4g} {effort.unit} rms, "
            f"B-spline kernel of {1e3 * effort.support:.0f} ms on all terms"
        )
        result["effort_residual"] = effort.to_dict()
    lines += [f"wrote {file}" for file in files]
    result["files"] = [str(file) for file in files]
    return {"text": "\n".join(lines), **result}


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


def _figures(figure: Any, stem: Path) -> list[Path]:
    from ..plot import save

    paths = [stem.with_name(stem.name + ending) for ending in (".svg", ".png")]
    for path in paths:
        save(figure, path)
    return paths
