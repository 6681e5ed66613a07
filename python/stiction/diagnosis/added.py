"""One more recording: what it says of a diagnosis that is there, without another one."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from .. import given
from ..atomic_files import write_text
from ..errors import InputError, NotEnoughData
from ..fitting.forms import Through, stiffen
from ..fitting.rows import Nuisances
from ..json_text import json_of
from ..plant import Plant
from ..recording import Recording
from ..session import Session
from .bets import Bet, Bets, bets_of
from .evidence import Evidence
from .gain import residuals_of
from .result import SCHEMA
from .words import joined

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
            them = joined(self.names)
            gain = bet.gain
            if gain is None or gain <= 0.0:
                told = (
                    f"{bet.recording} speaks against {them}: adding makes it no better ({change}); "
                    "diagnose again with it in the session"
                )
            else:
                told = (
                    f"{bet.recording}: adding {them} removes {100.0 * gain:.1f} % of the power of "
                    f"what was not explained ({change})"
                )
        if self.held_out is not None and bet.after > BEYOND * self.held_out:
            told += (
                f"; that is {bet.after / self.held_out:.3g} times what was left on rows held out: "
                "something more is missing here, and the recording belongs into the session"
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
    known = {*found["data"]["hashes"], *(each["hash"] for each in found.get("added", ()))}
    for recording in recordings:
        if recording.hash in known:
            raise InputError(
                f"{recording.path}: is part of this diagnosis already; add a recording that is new"
            )
        known.add(recording.hash)
    through = dict(found["data"]["through"])
    timing = through.pop("timing_s")
    plants = [Plant.load(folder / name) for name in ("base.toml", "plant.toml")]
    known_ones = [each.with_role("train") for each in session.recordings]
    whole = [*known_ones, *(each.with_role("test") for each in recordings)]
    try:
        evidence = Evidence(plants[0], whole, through=Through(**through))
    except NotEnoughData as error:
        raise InputError(str(error)) from None
    stiffen(evidence.forms, plants[0])
    opened = evidence.open_test()
    models = [(plant, Nuisances(own)) for plant, own in zip(plants, timing, strict=True)]
    test = residuals_of(evidence, opened, models)
    if test is None:
        raise InputError(f"{recordings[0].path}: none of its rows can be used; add a longer one")
    new = bets_of(test, 1, evidence.names, added=True)
    before = [_bet(each) for each in (found["evidence"] or {}).get("recordings", ())]
    bets = Bets((*before, *new.each))
    names = tuple(cause["name"] for cause in found["effects"])
    found["evidence"] = bets.to_dict()
    found["added"] = [
        *found.get("added", ()),
        *({"recording": str(each.path), "hash": each.hash} for each in recordings),
    ]
    write_text(folder / FINDINGS, json_of(found) + "\n")
    extended = found["extended"]
    return Added(new.each, bets, names, extended["heldout_rms"], extended["unit"], found)


def _findings(folder: Path, session: Session) -> dict[str, Any]:
    """findings.json of a folder, which has to be a diagnosis of this session."""
    file = folder / FINDINGS
    try:
        given.regular(file)
        found = json.loads(file.read_text(encoding="utf-8"))
        fits = found["schema"] == SCHEMA and isinstance(found["data"]["hashes"], list)
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        why = "" if isinstance(error, FileNotFoundError) else f" ({error})"
        raise InputError(
            f"{file}: there is no diagnosis{why}; run stiction diagnose without --add first"
        ) from None
    if not fits:
        raise InputError(f"{file}: is no diagnosis of this version; run stiction diagnose again")
    if list(session.hashes) != found["data"]["hashes"]:
        raise InputError(
            f"{file}: is the diagnosis of another session, or its recordings have changed; run "
            "stiction diagnose again"
        )
    if found.get("extended") is None or "through" not in found["data"]:
        raise InputError(f"{file}: holds no fitted plant; run stiction diagnose again")
    return dict(found)


def _bet(entry: dict[str, Any]) -> Bet:
    return Bet(entry["recording"], entry["before_rms"], entry["after_rms"], entry["added"])
