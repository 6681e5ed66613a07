"""Lays a bench out: folders with sessions, and their truth in a folder of its own."""

from __future__ import annotations

import hashlib
import json
import logging
import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from .. import __version__
from .._support import given
from .._support.atomic_files import new_folder, subfolder, write_text
from .._support.json_text import json_of
from .._support.progress import phase, steps
from .._support.wording import commas
from ..catalogue import effects, laws
from ..errors import InputError
from .deal import CASES, SHORTEST, Dealt, deal
from .format import BENCH_FORMAT, SCHEMA_TEXT
from .ordinary.draw import OWN_LAWS, SECONDS, Ordinary, ordinary
from .ordinary.files import write
from .ordinary.machine import Effects
from .read import MANIFEST, TRUTH, json_file

__all__ = ["LONGEST", "MOST", "make", "seal_of", "session_name"]

_log = logging.getLogger(__name__)

MOST: Final = 9999
"""Sessions of a bench: their names have four digits."""
LONGEST: Final = 3600.0
"""s: of a session."""
_RECIPE: Final = "recipe.json"
_README: Final = """\
{number} sessions of a simulated machine, of {least:g} to {most:g} s each: recordings, the plant
file that somebody would state of the machine, and a session file that names the columns. What is
missing from the plant is for you to find out.

Write one JSON file for each session, session_0001.json and so on, as answer.schema.json says, into
a folder of yours. Whoever has the truth scores them: stiction bench score BENCH ANSWERS

The data are in the public domain (CC0 1.0, https://creativecommons.org/publicdomain/zero/1.0/).
Made by stiction {version}. bench.json holds the SHA-256 of every session and of the truth.
"""


def make(
    folder: Path | str,
    *,
    number: int = 24,
    seed: int = 0,
    seconds: tuple[float, float] = SECONDS,
    cases: Sequence[str] = ("null", "hidden"),
) -> Path:
    """Lay out sessions whose truth is hidden; goes on where an earlier call was interrupted.

    Parameters
    ----------
    folder : path
        For ``session_0001`` and so on, ``bench.json``, ``answer.schema.json`` and ``truth``.
    number : int
        Sessions.
    seed : int
        Of everything; the same one gives the same files. Whoever can guess it has the truth.
    seconds : tuple of float
        Least and most that a session lasts, s.
    cases : sequence of str
        What sessions may be, of ``stiction.bench.CASES``; each comes as often as another.

    Returns
    -------
    Path
        Of ``bench.json``, which is written last.

    Raises
    ------
    InputError
        A value out of bounds, an unknown case, or a folder that holds something else.
    OSError
        A file cannot be written.
    """
    where = given.path(folder, "bench: folder")
    least, most = _bounds(seconds)
    recipe: dict[str, Any] = {
        "format": BENCH_FORMAT,
        "version": __version__,
        "number": given.whole(number, "bench: number", least=1, most=MOST),
        "seed": given.whole(seed, "bench: seed", least=0),
        "seconds": [least, most],
        "cases": _known(given.names(cases, "bench: cases")),
    }
    _fresh(where, recipe)
    where.mkdir(parents=True, exist_ok=True)
    truth = subfolder(where, TRUTH)
    write_text(truth / _RECIPE, json_of(recipe) + "\n")
    names = [record.name for record in laws()]
    dealt = deal(recipe["number"], recipe["seed"], recipe["cases"], (least, most), names)
    phase(_log, "simulating sessions")
    for k, each in enumerate(steps(dealt, "session"), 1):
        if not (where / session_name(k)).is_dir():
            _laid(each, where / session_name(k), truth / f"{session_name(k)}.json")
    write_text(where / "answer.schema.json", SCHEMA_TEXT)
    told = _README.format(number=number, least=least, most=most, version=__version__)
    write_text(where / "README.txt", told)
    write_text(where / MANIFEST, json_of(_manifest(where, recipe)) + "\n")
    return where / MANIFEST


def session_name(k: int) -> str:
    """Of the k-th session, counted from 1."""
    return f"session_{k:04d}"


def seal_of(truth: Path) -> str:
    """SHA-256 of a folder with a truth, the seed among it: nobody can try what it may be."""
    return _digest(truth)


def _bounds(seconds: Any) -> tuple[float, float]:
    try:
        least, most = (float(each) for each in seconds)
    except (TypeError, ValueError):
        least = most = math.nan
    if not SHORTEST <= least <= most <= LONGEST:
        raise InputError(
            f"bench: seconds = {given.brief(seconds)} is out of bounds: give the least and the "
            f"most that a session lasts, from {SHORTEST:g} to {LONGEST:g} s, such as 20,40"
        )
    return least, most


def _known(cases: list[str]) -> list[str]:
    for case in cases:
        if case not in CASES:
            raise InputError(f"bench: there is no case '{case}'; there are {commas(CASES)}")
    if not cases or len(set(cases)) < len(cases):
        raise InputError(
            f"bench: cases = {given.brief(cases)}: give each case once, of {commas(CASES)}"
        )
    return cases


def _fresh(where: Path, recipe: dict[str, Any]) -> None:
    """Refuse a folder that holds anything but the beginning of this very bench."""
    if (where / TRUTH / _RECIPE).is_file():
        if json_file(where / TRUTH / _RECIPE) == json.loads(json_of(recipe)):
            return
        raise InputError(
            f"{where}: another bench is there, of another seed, number, cases, seconds or version; "
            "give another folder"
        )
    try:
        other = next(iter(sorted(os.listdir(where))), "") if os.path.lexists(where) else ""
    except OSError as error:
        raise InputError(
            f"{where}: cannot be made a folder ({error.strerror}); give another one"
        ) from None
    if other:
        raise InputError(f"{where}: {other} is there and no bench; give an empty folder")


def _laid(each: Dealt, folder: Path, truth: Path) -> None:
    made = ordinary(each.spec)
    # The truth first: no session is there without its own.
    write_text(truth, json_of(_truth(each.case, made)) + "\n")
    with new_folder(folder) as draft:
        write(made, draft)


def _truth(case: str, made: Ordinary) -> dict[str, Any]:
    spec, machine = made.spec, made.machine
    families = {record.name: record.family for record in effects()}
    # At a dry contact effort c more one way and less the other is a constant effort c.
    one = [record.name for record in effects() if record.constant or record.two_levels]
    usual = vars(Effects())
    twins = one if spec.contact == "dry" and spec.hidden in one else []
    hidden = {
        "name": spec.hidden,
        "class": families.get(spec.hidden, ""),
        "same_as": [name for name in twins if name != spec.hidden],
        "size": made.relative_rms,
        "size_asked": spec.size,
        "effect": {k: v for k, v in vars(machine.effects).items() if v != usual[k]},
    }
    return {
        "case": case,
        "hidden": hidden if spec.hidden else None,
        "own_law": OWN_LAWS[spec.contact],
        "machine": {
            "inertia": machine.inertia,
            "coulomb": machine.coulomb,
            "viscous": machine.viscous,
            "counter": machine.counter,
            "gain": machine.gain,
            "bristle": machine.bristle,
        },
        "spec": vars(spec),
    }


def _manifest(where: Path, recipe: dict[str, Any]) -> dict[str, Any]:
    names = [session_name(k) for k in range(1, recipe["number"] + 1)]
    return {
        "format": BENCH_FORMAT,
        "version": recipe["version"],
        "licence": "CC0-1.0",
        "number": recipe["number"],
        "seconds": recipe["seconds"],
        "cases": {case: CASES[case] for case in recipe["cases"]},
        "answers": "answer.schema.json",
        "truth_sha256": seal_of(where / TRUTH),
        "sessions_sha256": {name: _digest(where / name) for name in names},
    }


def _digest(folder: Path) -> str:
    """Of names and contents of all files, in the order of their names."""
    told = hashlib.sha256()
    for path in sorted(folder.iterdir()):
        if not path.name.startswith("."):
            content = path.read_bytes()
            told.update(f"{path.name} {len(content)}\n".encode())
            told.update(content)
    return told.hexdigest()
