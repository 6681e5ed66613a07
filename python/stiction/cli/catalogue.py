"""``stiction laws`` and ``stiction effects``."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any, TypeVar

from cyclopts import Parameter

from .. import catalogue
from .._support.atomic_files import write_text
from .._support.json_text import infinities_as_words
from .._support.wording import commas, did_you_mean
from ..catalogue import EffectRecord, LawRecord, ParameterRecord
from ..errors import InputError
from .answer import answer, folder, json_of, protect_writes

__all__ = ["effects", "laws"]

_Record = TypeVar("_Record", LawRecord, EffectRecord)


def laws(
    name: str | None = None,
    *,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """List the friction laws, or show one with its parameters and options.

    Parameters
    ----------
    name
        Law to show.
    out
        Folder to write laws.json into as well.
    json
        Print JSON.
    """
    records = catalogue.laws()
    _write(out, "laws", records)
    if name is None:
        answer(_table(records), _data(records), as_json=json)
        return
    record = _find(name, records, "law", catalogue.effects(), "effect")
    lines = [
        f"{record.name}: {record.summary}",
        f"source: {record.source}",
        "",
        *_parameters(record.parameters),
    ]
    if record.start:
        lines += ["", "what a contact may bring along:", *_parameters(record.start)]
    for option in record.options:
        lines += ["", f"option {option.name}: {option.meaning}"]
        for index, (word, meaning) in enumerate(option.choices):
            lines.append(f"  {word:<10} {meaning}{' (default)' if index == 0 else ''}")
    lines += ["", f"states a trajectory shows: {commas(record.outputs)}"]
    answer("\n".join(lines), infinities_as_words(record.to_dict()), as_json=json)


def effects(
    name: str | None = None,
    *,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """List the effects, or show one with its parameters, look-alikes and separating experiment.

    Parameters
    ----------
    name
        Effect to show.
    out
        Folder to write effects.json into as well.
    json
        Print JSON.
    """
    records = catalogue.effects()
    _write(out, "effects", records)
    if name is None:
        answer(_table(records), _data(records), as_json=json)
        return
    record = _find(name, records, "effect", catalogue.laws(), "law")
    lines = [
        f"{record.name}: {record.summary}",
        f"means: {record.means}",
        f"try: {record.remedy}",
        f"enters at: {commas(record.hooks)}",
        f"shows in: {record.coordinate}",
        f"looks like: {commas(record.look_alikes)}",
        f"told apart by: {record.experiment} (stiction plan: {record.plan})",
        f"channels needed: {commas(record.channels) if record.channels else 'input and position'}",
        "",
        *_parameters(record.parameters),
    ]
    answer("\n".join(lines), infinities_as_words(record.to_dict()), as_json=json)


def _write(out: Path | None, name: str, records: Iterable[LawRecord | EffectRecord]) -> None:
    if out is not None:
        text = json_of(_data(records))
        with protect_writes(folder(out)):
            write_text(out / f"{name}.json", text + "\n")


def _data(records: Iterable[LawRecord | EffectRecord]) -> list[Any]:
    return [infinities_as_words(record.to_dict()) for record in records]


def _table(records: Iterable[LawRecord | EffectRecord]) -> str:
    records = list(records)
    width = max(len(record.name) for record in records)
    return "\n".join(f"{record.name:<{width}}  {record.summary}" for record in records)


def _find(
    name: str,
    records: Sequence[_Record],
    what: str,
    others: Sequence[LawRecord | EffectRecord],
    other: str,
) -> _Record:
    """The record of a name; where it is one of the other list, that is said."""
    for record in records:
        if record.name == name:
            return record
    names = [record.name for record in records]
    if name in (record.name for record in others):
        raise InputError(
            f"{what} '{name}' is unknown; the name is that of one {other}, see stiction "
            f"{other}s {name}"
        )
    raise InputError(
        f"{what} '{name}' is unknown{did_you_mean(name, names)}; known are {commas(names)}"
    )


def _parameters(parameters: Iterable[ParameterRecord]) -> list[str]:
    rows = [("parameter", "default", "unit (rotary; linear)", "bounds", "meaning")]
    for p in parameters:
        default = f"{p.default:g}" + (f" ({p.default_rule})" if p.default_rule else "")
        unit = p.unit if p.unit == p.linear_unit else f"{p.unit}; {p.linear_unit}"
        rows.append((p.name, default, unit, f"{p.bounds[0]:g} … {p.bounds[1]:g}", p.meaning))
    widths = [max(len(row[k]) for row in rows) for k in range(4)]
    return ["  ".join([*(f"{row[k]:<{widths[k]}}" for k in range(4)), row[4]]) for row in rows]
