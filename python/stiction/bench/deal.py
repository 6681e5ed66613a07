"""Which sessions a bench holds: all of it dealt from one seed."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from .ordinary.draw import OWN_LAWS, RECORDINGS, Spec, size_of
from .ordinary.hidden import HIDDEN

__all__ = ["CASES", "SHORTEST", "Dealt", "deal"]

CASES: Final = {
    "null": "nothing is missing: the plant states the law that the machine has",
    "hidden": "one effect is missing from the plant, and its law is right",
    "law": "no effect is missing, but the plant states another law than the machine has",
    "untestable": "the data tell nothing: the machine never moves, or a channel is constant",
}
"""What a session may be, and what that means."""
SHORTEST: Final = 4.0
"""s: of a recording, so that 400 rows are in it at 10 ms."""
_FORMATS: Final = ("npz", "csv", "mat", "json")
"""Those that need no optional package."""
_FLAWS: Final = ("constant", "still")


@dataclass(frozen=True)
class Dealt:
    """A session to be drawn, and the case that it is."""

    case: str
    spec: Spec


def deal(
    number: int,
    seed: int,
    cases: Sequence[str],
    seconds: tuple[float, float],
    laws: Sequence[str],
) -> list[Dealt]:
    """The sessions of a bench: as many of each case, all else drawn anew for each.

    Dealt in turn, what is known of some sessions would tell of others.

    Parameters
    ----------
    number : int
    seed : int
    cases : sequence of str
        Of ``CASES``.
    seconds : tuple of float
        Least and most that a session lasts, s.
    laws : sequence of str
        Of the catalogue, for plants that state another one than the machine has.
    """
    rng = np.random.default_rng([seed, 0x62656E63])
    others = [law for law in laws if law not in OWN_LAWS.values()]
    dealt = []
    for k, place in enumerate(rng.permutation(number)):
        case = cases[place % len(cases)]
        contact = "dry" if case == "untestable" else str(rng.choice(("dry", "dry", "bristle")))
        length = float(rng.uniform(*seconds))
        fitting = [n for n in RECORDINGS if n * SHORTEST <= length] or [1]
        given: dict[str, Any] = {
            "law": str(rng.choice(others)) if case == "law" else OWN_LAWS[contact],
            "contact": contact,
            "seconds": length,
            "recordings": int(rng.choice(fitting)),
            "file_format": str(rng.choice(_FORMATS)),
        }
        if case == "hidden":
            given |= {"hidden": str(rng.choice(HIDDEN)), "size": size_of(rng)}
        if case == "untestable":
            given |= {"flaw": str(rng.choice(_FLAWS)), "loop": "open"}
        dealt.append(Dealt(case, Spec(_seed_of(seed, k), **given)))
    return dealt


def _seed_of(seed: int, k: int) -> int:
    """Of a session: who knows one knows neither the others nor that of the bench."""
    told = hashlib.sha256(f"session {k} of bench {seed}".encode()).digest()
    return int.from_bytes(told[:7], "big")
