"""One more recording: what it says of a diagnosis that is there, without another one."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, NamedTuple

from ..._support import given
from ..._support.atomic_files import write_text
from ..._support.json_text import json_of
from ..._support.wording import join_words
from ...errors import InputError, NotEnoughData
from ...fitting.forms import Through, stiffen
from ...fitting.rows import Nuisances
from ...plant import Plant
from ...recording import Recording
from ...session import Session
from ..data.evidence import Evidence
from ..data.gain import residuals_of
from .bets import Bet, Bets, bets_of
from .result import SCHEMA

__all__ = ["Added", "add"]

FINDINGS: Final = "findings.json"
BEYOND: Final = 1.5
"""So many times the error that the extended plant had on rows held out is another one: machine,
load or day differ, or what is missing does not show in the session."""


@dataclass(frozen=True)
class Added:
    """What recordings say that were made after a diagnosis.

    Attributes
    ----------
    new : tuple of Bet
        Of the recordings that were added now.
    bets : Bets
        Of all that were held out, these among them.
    names : tuple of str
        Of the causes; none where nothing was named.
    held_out : float or None
        Error of the extended plant on the rows that tested, rms.
    unit : str
        Of the errors.
    findings : dict
        What is in findings.json now.
    """

    new: tuple[Bet, ...]
    bets: Bets
    names: tuple[str, ...]
    held_out: float | None
    unit: str
    findings: dict[str, Any]

    def __str__(self) -> str:
        lines = [self._one(bet) for bet in self.new]
        if self.names:
            lines.append(self.bets.words)
        return "\n".join(lines)

    def _one(self, bet: Bet) -> str:
        if not self.names:
            told = f"{bet.recording}: the plant leaves {bet.after:.3g} {self.unit} rms"
        else:
            change = f"{bet.before:.3g} → {bet.after:.3g} {self.unit} rms"
            them = join_words(self.names)
            gain = bet.gain
            if gain is None or gain <= 0.0:
                told = (
                    f"{bet.recording} speaks against {them}: adding {them} makes nothing better "
                    f"({change}); diagnose again with this recording in the session"
                )
            else:
                told = (
                    f"{bet.recording}: adding {them} removes {100.0 * gain:.1f} % of the power of "
                    f"what was not explained ({change})"
                )
        if self.held_out is not None and bet.after > BEYOND * self.held_out:
            told += (
                f"; that is {bet.after / self.held_out:.3g} times what was left on rows held out: "
                "something more is missing here; diagnose again with this recording in the session"
            )
        return told


def add(folder: Path, session: Session, recordings: Sequence[Recording]) -> Added:
    """Hold recordings out that nobody has seen against the plants of a diagnosis.

    Nothing is fitted but how their contacts begin. findings.json is written anew with what they
    say under ``evidence``; verdict, plants and page stay.

    Parameters
    ----------
    folder : Path
        With findings.json, base.toml and plant.toml, as ``stiction diagnose`` writes them.
    session : Session
        That was diagnosed.
    recordings : sequence of Recording
        Of the same machine, in the same columns.

    Raises
    ------
    InputError
        No diagnosis there, one of another session or without a fitted plant, a recording that is
        known already, or too short.
    """
    found = _findings(folder, session)
    before = found.bets
    known = set(found.hashes)
    for recording in recordings:
        if recording.hash in known:
            raise InputError(
                f"{recording.path}: is part of this diagnosis already; add a recording that is new"
            )
        known.add(recording.hash)
    plants = [Plant.load(folder / name) for name in ("base.toml", "plant.toml")]
    known_ones = [each.with_role("train") for each in session.recordings]
    whole = [*known_ones, *(each.with_role("test") for each in recordings)]
    try:
        evidence = Evidence(plants[0], whole, through=found.through)
    except NotEnoughData as error:
        raise InputError(str(error)) from None
    stiffen(evidence.forms, plants[0])
    opened = evidence.open_test()
    models = [
        (plant, Nuisances(own, leader=plant))
        for plant, own in zip(plants, found.timing, strict=True)
    ]
    test = residuals_of(evidence, opened, models)
    if test is None:
        raise InputError(f"{recordings[0].path}: none of its rows can be used; add a longer one")
    new = bets_of(test, 1, evidence.names, added=True)
    bets = Bets((*before, *new.each))
    content = {
        **found.content,
        "evidence": bets.to_dict(),
        "added": [
            *found.content.get("added", ()),
            *({"recording": str(each.path), "hash": each.hash} for each in recordings),
        ],
    }
    write_text(folder / FINDINGS, json_of(content) + "\n")
    return Added(new.each, bets, found.names, found.held_out, found.unit, content)


class _Found(NamedTuple):
    """What is asked of a findings.json."""

    content: dict[str, Any]
    hashes: tuple[str, ...]
    through: Through
    timing: tuple[float, float]
    bets: tuple[Bet, ...]
    names: tuple[str, ...]
    held_out: float | None
    unit: str


def _findings(folder: Path, session: Session) -> _Found:
    """findings.json of a folder, which has to be a diagnosis of this session."""
    file = folder / FINDINGS
    try:
        given.regular(file)
        content = json.loads(file.read_text(encoding="utf-8"))
        known, version = list(content["data"]["hashes"]), content["schema"]
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        why = "" if isinstance(error, FileNotFoundError) else f" ({error})"
        raise InputError(
            f"{file}: there is no diagnosis{why}; run stiction diagnose without --add first"
        ) from None
    if list(session.hashes) != known:
        raise InputError(
            f"{file}: is the diagnosis of another session, or its recordings have changed; run "
            "stiction diagnose again"
        )
    try:
        if version != SCHEMA or content["extended"] is None:
            raise ValueError("it holds no fitted plant")
        return _asked(content)
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(
            f"{file}: nothing can be added to it ({error}); run stiction diagnose again"
        ) from None


def _asked(content: dict[str, Any]) -> _Found:
    data, extended = content["data"], content["extended"]
    through = dict(data["through"])
    one, two = map(float, through.pop("timing_s"))
    held_out = extended["heldout_rms"]
    return _Found(
        content,
        (*data["hashes"], *(each["hash"] for each in content.get("added", ()))),
        Through(**through),
        (one, two),
        tuple(
            Bet(
                str(each["recording"]),
                float(each["before_rms"]),
                float(each["after_rms"]),
                bool(each["added"]),
            )
            for each in (content["evidence"] or {}).get("recordings", ())
        ),
        tuple(str(cause["name"]) for cause in content["effects"]),
        None if held_out is None else float(held_out),
        str(extended["unit"]),
    )
