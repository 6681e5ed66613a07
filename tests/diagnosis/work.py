"""What a whole diagnosis costs, counted: `python -m tests.diagnosis.work` writes the counts anew.

Times tell little on a busy machine. Counted are calls of the core and the samples that it goes
through, times the columns that are asked for; numbers that decompositions go over; and calls that
Python makes. On one thread they are the same every time, but for the last bits of a processor's
products, which may end a fit a step sooner.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np

import stiction as st
from stiction.cli.sessions import load_session

KNOWN = Path(__file__).with_name("work.json")
DEMO = Path(st.__file__).parent / "demo_session" / "session.toml"
VALUES = ("follow", "follow_rows", "shoot", "shoot_response", "run")
"""Passes of the core over numbers; those below are over derivatives."""
DERIVATIVES = ("follow_columns", "shoot_sensitivity", "shoot_signatures", "sensitivity")
SIGNATURES = ("signatures", "signature_columns")
DECOMPOSED = ("svd", "lstsq", "qr", "eigh", "solve", "pinv")

_Counts = Counter[str]


def counts(session: Path = DEMO) -> dict[str, int]:
    """What the diagnosis of a session costs, on one thread.

    Parameters
    ----------
    session : Path
        Of its file.

    Returns
    -------
    dict of str to int
        By what was counted.
    """
    recordings, plant = load_session(session, keep_faulty=True)
    found: _Counts = Counter()
    with _watched(found):
        st.diagnose(plant, recordings, threads=1)
    return dict(sorted(found.items()))


@contextmanager
def _watched(found: _Counts) -> Iterator[None]:
    """Counts until the end what the core, decompositions and Python do."""
    places: list[tuple[object, str, Any]] = [
        *((st.Motor, name, _passing(name, found)) for name in (*VALUES, *DERIVATIVES, *SIGNATURES)),
        *((np.linalg, name, _decomposing(name, found)) for name in DECOMPOSED),
    ]
    before = [(place, name, getattr(place, name)) for place, name, _ in places]

    def called(frame: FrameType, event: str, argument: object) -> None:
        if event in ("call", "c_call"):
            found["Python: calls"] += 1

    for place, name, counted in places:
        setattr(place, name, counted)
    sys.setprofile(called)
    try:
        yield
    finally:
        sys.setprofile(None)
        for place, name, own in before:
            setattr(place, name, own)


def _passing(name: str, found: _Counts) -> Callable[..., Any]:
    """A method of a motor that is counted, with its samples times its columns."""
    own = getattr(st.Motor, name)

    def counted(motor: st.Motor, first: Any, *others: Any, **named: Any) -> Any:
        columns = 1
        if name in SIGNATURES:
            columns = len(others[0])
        elif name in DERIVATIVES:
            columns = len(next(each for each in others if isinstance(each, list)))
        found[f"core: calls of {name}"] += 1
        found[f"core: samples of {name}"] += len(first) * columns
        return own(motor, first, *others, **named)

    return counted


def _decomposing(name: str, found: _Counts) -> Callable[..., Any]:
    """A decomposition whose multiplications are counted, to a factor of its own."""
    own = getattr(np.linalg, name)

    def counted(matrix: Any, *others: Any, **named: Any) -> Any:
        shape = np.shape(matrix)
        found["linear algebra: rows times squared columns"] += int(
            np.prod(shape, dtype=np.int64) * min(shape[-2:])
        )
        return own(matrix, *others, **named)

    return counted


if __name__ == "__main__":
    made = json.dumps(counts(), indent=1)
    KNOWN.write_text(f"{made}\n", encoding="utf-8")
    print(made)
