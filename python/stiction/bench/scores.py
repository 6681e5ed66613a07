"""Compares answers with the truth of a bench, and counts."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

from .._support import given
from .._support.json_text import json_of
from .._support.wording import plural
from ..catalogue import effects
from ..errors import InputError
from .layout import seal_of
from .rates import Calibration, Rate, calibration, rate
from .read import TRUTH, Answer, answer_file, json_file, manifest_of

__all__ = ["Judged", "Scores", "score"]

_SIZES: Final = (0.0, 0.03, 0.1, math.inf)
"""Edges of sizes, share of the dry friction."""
_SESSION: Final = re.compile(r"session_\d{4}\.json")


@dataclass(frozen=True)
class Judged:
    """One session: what is true of it, and what was answered.

    Attributes
    ----------
    session, case : str
    hidden, family : str
        Name and class of the effect that the plant lacks, "" for none.
    same_as : frozenset of str
        Names that no recording can tell from it: as right as its own.
    size : float
        rms of its effort, share of the dry friction; 0 for none.
    answer : Answer or None
        None where there is none.
    """

    session: str
    case: str
    hidden: str
    family: str
    same_as: frozenset[str]
    size: float
    answer: Answer | None

    @property
    def verdict(self) -> str:
        """Of the answer, "no answer" where there is none."""
        return "no answer" if self.answer is None else self.answer.verdict

    @property
    def right(self) -> frozenset[str]:
        """Names that are right."""
        return self.same_as | {self.hidden} if self.hidden else frozenset()

    @property
    def all_names(self) -> frozenset[str]:
        """Names told with or without reserve, and look-alikes."""
        named = () if self.answer is None else self.answer.effects
        return frozenset().union(*(each.names for each in named))

    @property
    def sure(self) -> frozenset[str]:
        """Names told without reserve; who calls a session unexplained stands by none."""
        if self.answer is None or self.answer.verdict == "unexplained":
            return frozenset()
        return frozenset(each.name for each in self.answer.effects if each.decided)

    @property
    def named(self) -> bool:
        """Whether what is missing is named without reserve."""
        return bool(self.right & self.sure)

    @property
    def listed(self) -> bool:
        """Whether what is missing is among the names and look-alikes."""
        return bool(self.right & self.all_names)

    @property
    def sure_and_wrong(self) -> bool:
        """Whether a name was told without reserve that is not missing."""
        return bool(self.sure - self.right)

    def in_class(self, families: dict[str, str]) -> bool:
        """Whether an effect and all of its look-alikes are of the class of what is missing."""
        if self.answer is None or self.answer.verdict == "unexplained" or not self.hidden:
            return False
        right = {**families, **dict.fromkeys(self.right, self.family)}
        found = [{right.get(n, n) for n in each.names} for each in self.answer.effects]
        return {self.family} in found

    def to_dict(self) -> dict[str, Any]:
        """Truth, answer and comparison, as an entry of scores.json."""
        return {
            "session": self.session,
            "case": self.case,
            "hidden": self.hidden or None,
            "same_as": sorted(self.same_as),
            "size": self.size,
            "verdict": self.verdict,
            "sure": sorted(self.sure),
            "told": sorted(self.all_names),
            "named": self.named,
            "sure_and_wrong": self.sure_and_wrong,
        }


@dataclass(frozen=True)
class Scores:
    """How answers compare with the truth.

    Attributes
    ----------
    sessions : tuple of Judged
    parts : tuple of (str, tuple of Rate)
        Titles, and what was counted under each.
    by_effect : tuple of Rate
        How many were named of each effect.
    told : float
        Names and look-alikes in an answer that has any, in the mean.
    calibration : Calibration or None
        Of probabilities; None where no answer has one.
    """

    sessions: tuple[Judged, ...]
    parts: tuple[tuple[str, tuple[Rate, ...]], ...]
    by_effect: tuple[Rate, ...]
    told: float
    calibration: Calibration | None

    def __str__(self) -> str:
        return "\n\n".join(
            f"{title}\n" + "\n".join(f"  {what:<44}  {value}" for what, value in lines)
            for title, lines in self._tables()
        )

    def to_markdown(self) -> str:
        """The tables for a page."""
        parts = []
        for title, lines in self._tables():
            rows = "\n".join(f"| {what} | {value} |" for what, value in lines)
            parts.append(f"**{title}**\n\n| what | measured (95 % interval) |\n|---|---|\n{rows}")
        return "\n\n".join(parts) + "\n"

    def to_dict(self) -> dict[str, Any]:
        """The content of scores.json."""
        held = self.calibration
        return {
            "format": "stiction-bench-scores 1",
            "rates": {title: [each.to_dict() for each in rates] for title, rates in self.parts},
            "by_effect": [each.to_dict() for each in self.by_effect],
            "names_told_mean": self.told,
            "calibration": None if held is None else held.to_dict(),
            "sessions": [each.to_dict() for each in self.sessions],
        }

    def to_json(self) -> str:
        """scores.json as text."""
        return json_of(self.to_dict())

    def _tables(self) -> list[tuple[str, list[tuple[str, str]]]]:
        tables = [
            (title, [(f"{r.what}{_MARKS[r.aim]}", str(r)) for r in rates if r.number])
            for title, rates in self.parts
        ]
        if self.by_effect:
            tables.append(("Named, by effect", [(r.what, str(r)) for r in self.by_effect]))
        if self.told:
            tables[0][1].append(("names and look-alikes told, mean", f"{self.told:.2f}"))
        if self.calibration is not None:
            held = self.calibration
            lines = [
                ("names with a probability", str(held.number)),
                ("Brier score (of the mean share alone)",
                 f"{held.brier:.3f} ({held.base_rate_brier:.3f})"),
                ("calibration error", f"{held.error:.3f}"),
            ]  # fmt: skip
            lines += [
                (f"{low:g} to {high:g} (mean {mean:.2f}): right", str(right))
                for low, high, mean, right in held.bins
            ]
            tables.append(("Probabilities", lines))
        return [(title, lines) for title, lines in tables if lines]


_MARKS: Final = {"low": " (low is good)", "high": " (high is good)", "": ""}


def score(folder: Path | str, answers: Path | str) -> Scores:
    """Compare answers with the truth of a bench.

    Parameters
    ----------
    folder : path
        Of the bench, with its truth.
    answers : path
        Folder with ``session_0001.json`` and so on, each in the form of ``SCHEMA`` or a
        findings.json. A session without a file counts as not answered.

    Raises
    ------
    InputError
        The folder is no bench, its truth is absent or was changed; an answer is no answer, or of no
        session; there is none at all.
    """
    where, told = given.path(folder, "bench: folder"), given.path(answers, "bench: answers")
    truth = _truth(where)
    found = _answers(told, list(truth))
    sessions = tuple(_judged(name, each, found.get(name)) for name, each in truth.items())
    return _counted(sessions)


def _truth(where: Path) -> dict[str, dict[str, Any]]:
    manifest = manifest_of(where)
    folder = where / TRUTH
    if not os.path.isdir(folder):
        raise InputError(
            f"{folder}: the truth is not there; who laid the bench out has it: put it there, or "
            "send the answers"
        )
    try:
        seal = seal_of(folder)
    except OSError as error:
        raise InputError(f"{folder}: cannot be read ({error.strerror}); check it") from None
    if seal != manifest.get("truth_sha256"):
        raise InputError(
            f"{folder}: is not the truth that the bench was laid out with: truth_sha256 of "
            "bench.json is another; put that one there"
        )
    return {name: json_file(folder / f"{name}.json") for name in manifest["sessions_sha256"]}


def _answers(folder: Path, names: Sequence[str]) -> dict[str, Answer]:
    try:
        files = sorted(path for path in folder.iterdir() if _SESSION.fullmatch(path.name))
    except OSError as error:
        raise InputError(f"{folder}: no folder with answers ({error.strerror}); give one") from None
    for path in files:
        if path.stem not in names:
            raise InputError(
                f"{path}: the bench has no such session; it has {names[0]} to {names[-1]}"
            )
    if not files:
        raise InputError(f"{folder}: holds no answer; write {names[0]}.json and so on into it")
    return {path.stem: answer_file(path) for path in files}


def _judged(name: str, truth: dict[str, Any], answer: Answer | None) -> Judged:
    hidden = truth["hidden"] or {"name": "", "class": "", "same_as": [], "size": 0.0}
    return Judged(
        name,
        truth["case"],
        hidden["name"],
        hidden["class"],
        frozenset(hidden["same_as"]),
        hidden["size"],
        answer,
    )


def _counted(sessions: tuple[Judged, ...]) -> Scores:
    cases = {
        case: [each for each in sessions if each.case == case]
        for case in ("null", "hidden", "law", "untestable")
    }
    hidden = cases["hidden"]
    parts = [
        (f"All {plural(len(sessions), 'session')}", _everywhere(sessions)),
        ("Nothing is missing", _null(cases["null"])),
        ("One effect is missing", _hidden(hidden)),
    ]
    for low, high in pairwise(_SIZES):
        some = [each for each in hidden if low <= each.size < high]
        ends = (
            f"{100 * low:g} to {100 * high:g} %" if high < math.inf else f"{100 * low:g} % or more"
        )
        parts.append((f"The same, {ends} of the dry friction", _hidden(some)))
    parts += [
        ("Another law is stated", _null(cases["law"])),
        ("The data tell nothing", _untestable(cases["untestable"])),
    ]
    names = dict.fromkeys(sorted(each.hidden for each in hidden))
    named = [
        rate(name, [each for each in hidden if each.hidden == name], lambda e: e.named, "high")
        for name in names
    ]
    lengths = [len(each.all_names) for each in sessions if each.all_names]
    told = [
        (one.probability, one.name in each.right)
        for each in sessions
        if each.answer is not None
        for one in each.answer.effects
        if one.probability is not None
    ]
    return Scores(
        sessions,
        tuple(parts),
        tuple(named),
        sum(lengths) / len(lengths) if lengths else 0.0,
        calibration(told),
    )


def _is(verdict: str) -> Callable[[Judged], bool]:
    return lambda each: each.verdict == verdict


def _everywhere(some: Sequence[Judged]) -> tuple[Rate, ...]:
    return (
        rate("no answer", some, _is("no answer"), "low"),
        rate("a sure and wrong name", some, lambda e: e.sure_and_wrong, "low"),
    )


def _null(some: Sequence[Judged]) -> tuple[Rate, ...]:
    return (
        rate("a name", some, lambda e: e.all_names, "low"),
        rate("a sure name", some, lambda e: e.sure, "low"),
        rate("unexplained", some, _is("unexplained"), "low"),
        rate("not testable", some, _is("not_testable"), "low"),
        rate("silence: nothing is missing", some, _is("nothing_missing"), "high"),
    )


def _hidden(some: Sequence[Judged]) -> tuple[Rate, ...]:
    families = {record.name: record.family for record in effects()}
    return (
        rate("named", some, lambda e: e.named, "high"),
        rate("its class", some, lambda e: e.in_class(families), "high"),
        rate("among names and look-alikes", some, lambda e: e.listed, "high"),
        rate("a sure and wrong name", some, lambda e: e.sure_and_wrong, "low"),
        rate("ambiguous", some, _is("ambiguous")),
        rate("unexplained", some, _is("unexplained")),
        rate("silence: nothing is missing", some, _is("nothing_missing"), "low"),
        rate("not testable", some, _is("not_testable")),
    )


def _untestable(some: Sequence[Judged]) -> tuple[Rate, ...]:
    return (
        rate("not testable", some, _is("not_testable"), "high"),
        rate("a name", some, lambda e: e.all_names, "low"),
        rate("silence: nothing is missing", some, _is("nothing_missing"), "low"),
    )
