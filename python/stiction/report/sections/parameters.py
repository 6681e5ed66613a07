"""Fitted parameters as rows of a table."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

from ..._support.frozen import Frozen
from ..._support.numbers import between, digits
from ...catalogue import effects, laws
from ...fitting.variables import with_effort_in

if TYPE_CHECKING:
    from ...catalogue import EffectRecord
    from ...fitting.result import FitParameter
    from ...plant import Plant
    from ...plant.stated import Effect

__all__ = ["meanings_of", "row", "rows_of_effect"]

NOTHING: Final[Mapping[str, FitParameter]] = Frozen()

BODY: Final = {
    "inertia": "moving inertia or mass",
    "gravity_amplitude": "greatest effort of the weight over a turn",
    "gravity_zero_rad": "position at which the weight pulls nowhere",
    "weight_n": "weight along the motion",
}


def row(
    path: str,
    parameter: FitParameter,
    meaning: str,
    beside: Mapping[str, FitParameter] = NOTHING,
) -> dict[str, Any]:
    """A parameter: name, meaning, value, interval, unit and what is odd about it.

    ``beside`` holds the parameters of the same model: a wave is there where either of its parts is.
    """
    value, interval = between(parameter.value, *parameter.ci95)
    notes = []
    if parameter.at_bound:
        notes.append(f"at its {parameter.at_bound} bound")
    if not math.isfinite(parameter.stderr):
        notes.append("not determined by these data")
    elif not _told(parameter) and not parameter.at_bound:
        partner = beside.get(_partner(path))
        if partner is None or not _told(partner):
            notes.append("not told from 0")
    return {
        "path": path,
        "name": path.rsplit(".", 1)[-1],
        "meaning": meaning,
        "value": value,
        "interval": interval,
        "unit": "" if parameter.unit == "1" else parameter.unit,
        "notes": notes,
    }


def rows_of_effect(
    effect: Effect,
    parameters: Mapping[str, FitParameter],
    waves: Mapping[str, FitParameter],
    record: EffectRecord,
    plant: Plant,
    measured: str,
) -> list[dict[str, Any]]:
    """All of an effect: amplitudes of its waves, what was fitted, and what was chosen or assumed.

    Parameters
    ----------
    effect : Effect
        Of the extended plant.
    parameters : Mapping of str to FitParameter
        What was fitted of it, by path.
    waves : Mapping of str to FitParameter
        Amplitudes and phases of its waves, by path.
    record : EffectRecord
        Of the catalogue.
    plant : Plant
        With the effect.
    measured : str
        Unit in which efforts were measured.
    """
    linear = plant.motion == "linear"
    shares = {p.name for p in record.parameters if p.unit == "1"}
    meanings = {p.name: p.meaning for p in record.parameters}
    by_name = {path.rsplit(".", 1)[-1]: p for path, p in parameters.items()}
    names = [*by_name, *(name for name in effect.parameters if name not in by_name)]
    rows = []
    for tail in ("", "_2"):
        told = {name: f"effects.{effect.name}.{name}{tail}" for name in ("amplitude", "phase")}
        whole = told["amplitude"] in waves
        if whole:
            cosine = f"cosine{tail}"
            share = cosine in shares
            rows.append(_amplitude(waves[told["amplitude"]], tail, meanings[cosine], share=share))
            rows.append(row(told["phase"], waves[told["phase"]], "at which the wave is highest"))
        for name in names:
            if name.endswith("_2") != bool(tail) or (whole and name.startswith(("cosine", "sine"))):
                continue
            path, meaning = f"effects.{effect.name}.{name}", meanings.get(name, "")
            if path in parameters:
                rows.append(row(path, parameters[path], meaning, beside=parameters))
            else:
                unit = with_effort_in(measured, plant, path)
                rows.append(_stated(path, effect.parameters[name].value, meaning, unit))
            if "order" in name:
                rows[-1]["unit"] = "per 2π m" if linear else "per turn"
                rows[-1]["meaning"] = f"periods of the {'second ' if tail else ''}wave"
    return rows


def _stated(path: str, value: float, meaning: str, unit: str) -> dict[str, Any]:
    """A parameter that no fit has moved: an order out of whole numbers, or a usual value."""
    name = path.rsplit(".", 1)[-1]
    chosen = "order" in name
    return {
        "path": path,
        "name": name,
        "meaning": meaning,
        "value": f"{value:g}" if chosen or value == round(value, 2) else digits(value),
        "interval": "–",
        "unit": "" if unit == "1" else unit,
        "notes": ["chosen, not fitted" if chosen else "assumed, not fitted"],
    }


def _amplitude(amplitude: FitParameter, tail: str, meaning: str, *, share: bool) -> dict[str, Any]:
    """The size of a wave; ``share``: of something else, in percent."""
    factor = 100.0 if share else 1.0
    value, interval = between(*(factor * each for each in (amplitude.value, *amplitude.ci95)))
    whole = meaning.replace("amplitude of the cosine part", "amplitude")
    return {
        "path": f"amplitude{tail}",
        "name": f"amplitude{tail}",
        "meaning": whole.replace("as a share of the", "of the").replace("as a share of", "of"),
        "value": value,
        "interval": interval,
        "unit": "%" if share else amplitude.unit.removeprefix("1"),
        "notes": [],
    }


def _told(parameter: FitParameter) -> bool:
    low, high = parameter.ci95
    return not low <= 0.0 <= high


def _partner(path: str) -> str:
    """The other part of a wave, "" for what is no part of one."""
    head, dot, name = path.rpartition(".")
    for own, other in (("cosine", "sine"), ("sine", "cosine")):
        if name in (own, f"{own}_2"):
            return f"{head}{dot}{name.replace(own, other)}"
    return ""


def meanings_of(plant: Plant) -> dict[str, str]:
    """What each parameter of a plant is, by path."""
    found = {f"body.{name}": meaning for name, meaning in BODY.items()}
    for law in laws():
        if law.name == plant.friction.law:
            found |= {f"friction.{p.name}": p.meaning for p in law.parameters}
    for effect in effects():
        found |= {f"effects.{effect.name}.{p.name}": p.meaning for p in effect.parameters}
    return found
