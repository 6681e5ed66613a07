"""Runs without end: chunks in, thinned rows out, a checkpoint on the way."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ._support import given
from ._support.arrays import FloatArray
from ._support.atomic_files import atomic_write
from ._support.given import number
from ._support.keywords import explain_keywords
from .errors import InputError
from .motor import Motor
from .trajectory import Trajectory

__all__ = ["stream"]

SCHEMA: Final = 1
PIECE: Final = 1 << 16
"""Samples simulated at once: a longer chunk is cut, so that memory does not grow with it."""


@explain_keywords
def stream(
    motor: Motor,
    currents: Iterable[npt.ArrayLike],
    dt: float,
    *,
    outputs: tuple[str, ...] = ("position", "velocity"),
    every: int = 1,
    checkpoint: str | Path | None = None,
    load: float = 0.0,
) -> Iterator[Trajectory]:
    """Simulate an input that comes in chunks, in constant memory.

    Parameters
    ----------
    motor : Motor
        Is moved on.
    currents : iterable of array_like of shape (n,)
        Chunks of any length, held over their samples; a generator may go on for ever.
    dt : float
        Duration of a sample in s.
    outputs : tuple of str
        Columns of a ``Trajectory``.
    every : int
        Keep every so many samples one row: the states after sample ``every``, 2·``every`` … of the
        whole run, wherever chunks end.
    checkpoint : path, optional
        Where the state is kept from chunk to chunk. Where the file is there already, the run goes
        on from it: chunks, given from the beginning again, are passed over until then. What follows
        is the same to the bit as without the interruption.
    load : float
        External effort, N·m or N, positive along +x.

    Yields
    ------
    Trajectory
        Rows of each chunk, stamped from the start of the whole run. A chunk is in the checkpoint
        only once the next one is asked for: what was not taken over is simulated again.

    Raises
    ------
    InputError
        A checkpoint of another motor, ``dt`` or ``every``, one that is damaged or that goes beyond
        the chunks, or one that cannot be written; a motion that runs away; what ``Motor.simulate``
        refuses.

    Examples
    --------
    >>> import numpy as np, stiction as st
    >>> motor = st.Motor(0.0076, friction=st.FrictionModel("hsieh_pan"))
    >>> chunks = (np.full(1000, 0.1) for _ in range(5))
    >>> rows = [part.position for part in st.stream(motor, chunks, 1e-4, every=100)]
    >>> len(np.concatenate(rows))
    50
    """
    given.instance(motor, Motor, "stream: motor", "a Motor")
    chunks = given.each_of(currents, "stream: currents", "chunks of inputs")
    every = given.whole(every, "every", least=1, most=given.MOST_WHOLE)
    dt, load = (_number(each, name) for each, name in ((dt, "dt"), (load, "load")))
    if checkpoint is not None:
        checkpoint = given.path(checkpoint, "checkpoint")
        if not _has_place(checkpoint):
            raise InputError(
                f"{checkpoint}: is no place for a checkpoint; name a file in a folder that is there"
            )
    names = given.names(outputs, "outputs")
    return _streamed(motor, chunks, dt, tuple(names), every, checkpoint, load)


def _has_place(file: Path) -> bool:
    """Whether a file may be at this path."""
    try:
        return file.parent.is_dir() and not file.is_dir()
    except OSError:  # a name that is too long
        return False


def _number(value: object, name: str) -> float:
    return number(value, f"stream: {name}")


def _streamed(
    motor: Motor,
    currents: Iterable[npt.ArrayLike],
    dt: float,
    outputs: tuple[str, ...],
    every: int,
    checkpoint: str | Path | None,
    load: float,
) -> Iterator[Trajectory]:
    path = None if checkpoint is None else Path(checkpoint)
    identity = _identity(motor, dt, every, load)
    start = motor.clock
    passed = 0
    if path is not None and path.exists():
        passed, start = _resume(motor, path, identity)
    done = 0
    for chunk in currents:
        inputs = np.ascontiguousarray(given.numbers(chunk, "stream: a chunk"))
        length = inputs.size
        if not length:
            raise InputError("stream: a chunk has no samples; leave it out")
        if done + length <= passed:
            done += length
            continue
        # A chunk that the checkpoint ends in is cut there.
        inputs = inputs[max(0, passed - done) :]
        done = max(done, passed)
        rows: dict[str, list[FloatArray]] = {name: [] for name in outputs}
        first = done // every
        for piece in (inputs[k : k + PIECE] for k in range(0, len(inputs), PIECE)):
            run = motor.simulate(piece, dt, load=load, outputs=outputs)
            if not run.success:
                raise InputError(
                    f"stream: the motion ran away within the {len(piece)} samples after the first "
                    f"{done}; check inputs, units and inertia; the motor stands before them"
                )
            for name in outputs:
                rows[name].append(run[name][(-done - 1) % every :: every].copy())
            done += len(piece)
        columns = {name: np.concatenate(parts) for name, parts in rows.items()}
        yield Trajectory(
            columns,
            dt * every,
            done // every - first,
            start + first * every * dt,
            motor.statistics,
        )
        if path is not None:
            _keep(motor, path, identity, done, start)
    if done < passed:
        raise InputError(
            f"{path}: is the checkpoint of a run of {passed} samples, and the chunks end after "
            f"{done}; give all of them from the beginning, or delete it"
        )


def _identity(motor: Motor, dt: float, every: int, load: float) -> str:
    """What a checkpoint belongs to, in words."""
    law, keywords = motor.friction_settings()
    return json.dumps(
        [SCHEMA, motor.settings(), law, keywords, float(dt), every, float(load)],
        sort_keys=True,
        default=str,
    )


def _keep(motor: Motor, path: Path, identity: str, done: int, start: float) -> None:
    """Keep the state; a kill leaves the old one or the new."""
    state = {f"state.{name}": np.asarray(value) for name, value in motor.state.items()}
    with given.explain_write_errors(path), atomic_write(path) as file:
        np.savez(file, identity=identity, done=done, start=start, **state)  # type: ignore[arg-type]


def _resume(motor: Motor, path: Path, identity: str) -> tuple[int, float]:
    """Sets the state that was kept; samples done until then, and when the run began."""
    try:
        belongs, done, start, state = _read(path)
    except InputError:
        raise
    # Whatever stands in a damaged file, a reader of zip archives and arrays may stumble over it.
    except Exception as error:
        raise _damaged(path, error) from None
    if belongs != identity:
        raise InputError(
            f"{path}: is the checkpoint of another motor, load, dt or every; delete it, or name "
            "another file"
        )
    try:
        motor.state = state
    except InputError as error:
        raise _damaged(path, error) from None
    return done, start


def _read(path: Path) -> tuple[str, int, float, dict[str, Any]]:
    """What a checkpoint belongs to, samples done, when the run began, and the state."""
    from .recording.formats.npz import check_room

    # Opened here, for numpy leaves a file open that it stumbles over.
    with path.open("rb") as opened:
        check_room(path, opened)
        opened.seek(0)
        with np.load(opened, allow_pickle=False) as file:
            kept = {name: file[name] for name in file.files}
    done, start = kept["done"], kept["start"]
    if done.shape or done.dtype.kind not in "iu" or done < 0:
        raise ValueError(f"done = {done}")
    if start.shape or start.dtype.kind != "f" or not np.isfinite(start):
        raise ValueError(f"start = {start}")
    state: dict[str, Any] = {}
    for name, value in kept.items():
        if name.startswith("state."):
            if value.dtype != np.float64:
                raise ValueError(f"{name} holds {value.dtype}")
            state[name.removeprefix("state.")] = float(value) if value.ndim == 0 else value
    return str(kept["identity"]), int(done), float(start), state


def _damaged(path: Path, error: Exception) -> InputError:
    why = " ".join(str(error).split()) or type(error).__name__
    return InputError(f"{path}: cannot be read as a checkpoint ({why}); delete it to start anew")
