"""Reads a bench and answers to it: what strangers wrote, checked before anything is counted."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from .._support.given import brief, regular
from .._support.wording import commas, did_you_mean
from ..errors import InputError
from .format import BENCH_FORMAT, SCHEMA, VERDICTS

__all__ = ["MANIFEST", "TRUTH", "Answer", "Named", "answer_file", "json_file", "manifest_of"]

MANIFEST: Final = "bench.json"
TRUTH: Final = "truth"
_MOST_BYTES: Final = 64 << 20
"""Of one file; findings.json has some hundred kilobytes."""
_LONGEST_NAME: Final = 100
_OF_ANSWER: Final = SCHEMA["properties"]
_OF_EFFECT: Final = _OF_ANSWER["effects"]["items"]["properties"]
_FINDINGS: Final = 1
"""Value of ``schema`` in a findings.json."""


@dataclass(frozen=True)
class Named:
    """An effect that an answer names.

    Attributes
    ----------
    name : str
    decided : bool
        Whether it is told without reserve.
    probability : float or None
    look_alikes : tuple of str
    """

    name: str
    decided: bool
    probability: float | None = None
    look_alikes: tuple[str, ...] = ()

    @property
    def names(self) -> frozenset[str]:
        """Its own, and those of its look-alikes."""
        return frozenset((self.name, *self.look_alikes))


@dataclass(frozen=True)
class Answer:
    """An answer to a session: one of ``VERDICTS``, and the effects that it names."""

    verdict: str
    effects: tuple[Named, ...] = ()


def manifest_of(folder: Path) -> dict[str, Any]:
    """What bench.json of a bench says.

    Raises
    ------
    InputError
        It is not there, or no manifest.
    """
    path = folder / MANIFEST
    if not os.path.isfile(path):
        raise InputError(
            f"{folder}: {MANIFEST} is not there; name a folder that stiction bench make has laid "
            "out to its end"
        )
    found = json_file(path)
    if not isinstance(found, dict) or found.get("format") != BENCH_FORMAT:
        told = brief(found.get("format")) if isinstance(found, dict) else brief(found)
        raise InputError(
            f"{path}: format is {told} and not '{BENCH_FORMAT}'; use the version of stiction that "
            "laid it out"
        )
    if not isinstance(found.get("sessions_sha256"), dict):
        raise InputError(f"{path}: sessions_sha256 is no table; lay the bench out again")
    return found


def json_file(path: Path) -> Any:
    """Strict JSON from a file.

    Raises
    ------
    InputError
        It cannot be read, is too large, or is no JSON; a name stands twice in an object.
    """
    try:
        size = regular(path).st_size
        if size > _MOST_BYTES:
            raise InputError(f"{path}: has {size} bytes; {_MOST_BYTES} are allowed")
        text = path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: is no text in UTF-8; write JSON in UTF-8") from None
    try:
        return json.loads(text, parse_constant=_no_number, object_pairs_hook=_once)
    except RecursionError:
        raise InputError(f"{path}: is nested too deep; write the form of an answer") from None
    except ValueError as error:
        raise InputError(f"{path}: is no JSON ({error}); write the form of an answer") from None


def _no_number(word: str) -> float:
    raise ValueError(f"{word} is no number of JSON")


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"{twice!r} stands twice in one object")
    return found


def answer_file(path: Path) -> Answer:
    """An answer: in the form of ``SCHEMA``, or a findings.json.

    Raises
    ------
    InputError
        It is neither: in one sentence, with the field and the remedy.
    """
    found = json_file(path)
    where = f"{path}"
    if not isinstance(found, dict):
        raise InputError(f"{where}: is {brief(found)}; write an object with verdict and effects")
    ours = "schema" in found
    if ours and found["schema"] != _FINDINGS:
        raise InputError(
            f"{where}: schema = {brief(found['schema'])} is no findings.json of this version; "
            f"leave the key out, or write {_FINDINGS}"
        )
    _keys(found, _OF_ANSWER, ("verdict", "effects"), where, only=not ours)
    verdict = found["verdict"]
    if ours and verdict == "data_fault":
        verdict = "not_testable"
    if not isinstance(verdict, str) or verdict not in VERDICTS:
        near = did_you_mean(verdict, VERDICTS) if isinstance(verdict, str) else ""
        raise InputError(
            f"{where}: verdict = {brief(verdict)} is unknown{near}; write one of {commas(VERDICTS)}"
        )
    if not isinstance(found["effects"], list):
        raise InputError(f"{where}: effects = {brief(found['effects'])} is no list; write one")
    named = tuple(
        _named(each, f"{where}: effects[{k}]", only=not ours)
        for k, each in enumerate(found["effects"])
    )
    names = [each.name for each in named]
    if twice := [name for name in names if names.count(name) > 1]:
        raise InputError(f"{where}: effects names {twice[0]} twice; name it once")
    if not ours:
        seconds = found.get("seconds", 0.0)
        if not _number(seconds) or seconds < 0.0:
            raise InputError(f"{where}: seconds = {brief(seconds)}; write a number from 0 on")
        _agrees(verdict, named, where)
    return Answer(verdict, named)


def _agrees(verdict: str, named: tuple[Named, ...], where: str) -> None:
    """Whether verdict and effects say the same."""
    decided = [each.decided for each in named]
    if verdict in ("nothing_missing", "not_testable") and named:
        remedy = "leave effects empty, or write missing_effect or ambiguous"
    elif verdict == "missing_effect" and not (decided and all(decided)):
        remedy = "name an effect, and have all decided, or write ambiguous"
    elif verdict == "ambiguous" and (not decided or all(decided)):
        remedy = "have one effect at least with decided = false, or write missing_effect"
    else:
        return
    said = commas([f"{each.name} (decided = {str(each.decided).lower()})" for each in named])
    raise InputError(
        f"{where}: verdict {verdict} does not go with effects {said or 'none'}; {remedy}"
    )


def _named(each: Any, where: str, *, only: bool) -> Named:
    if not isinstance(each, dict):
        raise InputError(f"{where} is {brief(each)}; write an object with name and decided")
    _keys(each, _OF_EFFECT, ("name", "decided"), where, only=only)
    if not isinstance(each["decided"], bool):
        raise InputError(f"{where}.decided = {brief(each['decided'])}; write true or false")
    probability = each.get("probability")
    if probability is not None and not (_number(probability) and 0.0 <= probability <= 1.0):
        raise InputError(
            f"{where}.probability = {brief(probability)} is out of bounds; write a number from "
            "0 to 1"
        )
    alike = each.get("look_alikes", [])
    if not isinstance(alike, list):
        raise InputError(f"{where}.look_alikes = {brief(alike)} is no list; write one of names")
    if only:
        _parameters(each.get("parameters", {}), f"{where}.parameters")
    return Named(
        _name(each["name"], f"{where}.name"),
        each["decided"],
        None if probability is None else float(probability),
        tuple(_name(name, f"{where}.look_alikes[{k}]") for k, name in enumerate(alike)),
    )


def _parameters(found: Any, where: str) -> None:
    if not isinstance(found, dict):
        raise InputError(f"{where} = {brief(found)} is no object; write numbers by name")
    for name, value in found.items():
        if not _number(value):
            raise InputError(f"{where}.{name} = {brief(value)} is no number; write one")


def _keys(
    found: dict[str, Any], known: Iterable[str], needed: Iterable[str], where: str, *, only: bool
) -> None:
    for name in needed:
        if name not in found:
            raise InputError(f"{where}: {name} is missing; write it")
    for name in found if only else ():
        if name not in known:
            near = did_you_mean(name, known)
            raise InputError(
                f"{where}: key {brief(name)} is unknown{near}; there are {commas(known)}"
            )


def _name(given: Any, where: str) -> str:
    if not isinstance(given, str) or not 0 < len(given) <= _LONGEST_NAME:
        raise InputError(f"{where} = {brief(given)} is no name of an effect; write one")
    return given


def _number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
