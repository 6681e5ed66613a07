"""The same parameter from each recording: whether the intervals overlap, and why not."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any, Final

import numpy as np

from ..errors import InputError
from ..fitting import fit
from ..plant import Plant
from ..plant.parameter import Parameter
from ..recording import Recording
from ..recording.names import names_of
from ..session import Session

__all__ = ["Agreement", "OfRecording", "agreement_of"]

WARMER_K: Final = 3.0
"""By which the mean temperature of two recordings differs at least to be a reason."""
LATER_S: Final = 3600.0
"""After which a machine is taken for another day's."""
FASTER: Final = 1.5
"""Ratio of usual speeds: a law that does not hold at all speeds is fitted to others."""

_logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class OfRecording:
    """A parameter as one recording tells it."""

    recording: str
    value: float
    ci95: tuple[float, float]

    def to_dict(self) -> dict[str, Any]:
        """As in findings.json."""
        return {"recording": self.recording, "value": self.value, "ci95": list(self.ci95)}


@dataclass(frozen=True)
class Agreement:
    """A parameter of a joint as each recording tells it.

    Attributes
    ----------
    joint, parameter, unit : str
    values : tuple of OfRecording
    agrees : bool or None
        Whether all intervals overlap; None where fewer than two recordings tell.
    overlaps : float or None
        Share of pairs of recordings whose intervals do.
    reason : str
        What differs between those that are furthest apart, "" where nothing is known that does.
    """

    joint: str
    parameter: str
    unit: str
    values: tuple[OfRecording, ...]
    agrees: bool | None
    overlaps: float | None
    reason: str = ""

    def to_dict(self) -> dict[str, Any]:
        """As an entry of ``agreement``."""
        return {
            "joint": self.joint,
            "parameter": self.parameter,
            "unit": self.unit,
            "values": [value.to_dict() for value in self.values],
            "agrees": self.agrees,
            "overlaps": self.overlaps,
            "reason": self.reason or None,
        }


def agreement_of(
    joint: str, plant: Plant, session: Session, payloads: Sequence[float]
) -> list[Agreement]:
    """Fit the main numbers of a joint's friction to each recording alone.

    Parameters
    ----------
    joint : str
    plant : Plant
        As it was found of all recordings: everything else stays.
    session : Session
        Of the joint, with the efforts of the links as loads.
    payloads : sequence of float
        Of each recording, kg.
    """
    paths = _main(plant)
    alone = _only(plant, paths)
    names = names_of(list(session))
    told: dict[str, list[tuple[int, OfRecording, str]]] = {path: [] for path in paths}
    for index, recording in enumerate(session):
        try:
            found = fit(alone, Session([recording.with_role("train")]))
        except InputError as error:
            # Too short for a fit of its own: the others are compared.
            _logger.info("%s, %s: %s", joint, names[index], error)
            continue
        for path in paths:
            if path in found.parameters and np.all(np.isfinite(found.parameters[path].ci95)):
                own = found.parameters[path]
                told[path].append((index, OfRecording(names[index], own.value, own.ci95), own.unit))
    return [
        _compared(joint, path, values, session, payloads) for path, values in told.items() if values
    ]


def _main(plant: Plant) -> list[str]:
    """The level of friction, its viscous part and the offset."""
    wanted = (
        "friction.coulomb",
        "friction.breakaway",
        "friction.viscous",
        "effects.torque_bias.bias",
    )
    return [path for path in wanted if path in plant.parameters]


def _only(plant: Plant, free: Sequence[str]) -> Plant:
    """The plant with all else fixed."""

    def kept(prefix: str, own: Any) -> dict[str, Parameter]:
        return {
            name: replace(parameter, fixed=f"{prefix}.{name}" not in free)
            for name, parameter in own.items()
        }

    return replace(
        plant,
        body=kept("body", plant.body),
        friction=replace(plant.friction, parameters=kept("friction", plant.friction.parameters)),
        effects=tuple(
            replace(e, parameters=kept(f"effects.{e.name}", e.parameters)) for e in plant.effects
        ),
    )


def _compared(
    joint: str,
    path: str,
    values: Sequence[tuple[int, OfRecording, str]],
    session: Session,
    payloads: Sequence[float],
) -> Agreement:
    unit = values[0][2]
    told = tuple(value for _, value, _ in values)
    pairs = list(combinations(values, 2))
    if not pairs:
        return Agreement(joint, path, unit, told, None, None)
    apart = [(a, b) for a, b in pairs if _gap(a[1], b[1]) > 0.0]
    overlaps = 1.0 - len(apart) / len(pairs)
    if not apart:
        return Agreement(joint, path, unit, told, True, overlaps)
    a, b = max(apart, key=lambda pair: _gap(pair[0][1], pair[1][1]))
    return Agreement(
        joint, path, unit, told, False, overlaps, _reason(session, payloads, a[0], b[0])
    )


def _gap(one: OfRecording, other: OfRecording) -> float:
    """How far two intervals lie apart, below 0 where they overlap."""
    return max(one.ci95[0] - other.ci95[1], other.ci95[0] - one.ci95[1])


def _reason(session: Session, payloads: Sequence[float], one: int, other: int) -> str:
    """What differs between two recordings, "" where nothing that is known does."""
    a, b = session.recordings[one], session.recordings[other]
    found = []
    warm = [_mean(each, "temperature") for each in (a, b)]
    if warm[0] is not None and warm[1] is not None and abs(warm[0] - warm[1]) > WARMER_K:
        found.append(f"temperature {warm[0]:.3g} and {warm[1]:.3g} °C")
    if payloads[one] != payloads[other]:
        found.append(f"payload {payloads[one]:g} and {payloads[other]:g} kg")
    stated = a.start_s != 0.0 or b.start_s != 0.0
    if stated and abs(session.starts[one] - session.starts[other]) > LATER_S:
        hours = abs(session.starts[one] - session.starts[other]) / 3600.0
        found.append(f"{hours:.3g} h between them")
    speeds = [_speed(each) for each in (a, b)]
    if min(speeds) > 0.0 and max(speeds) / min(speeds) > FASTER:
        rate = "rad/s" if a.motion == "rotary" else "m/s"
        found.append(f"other speeds, {speeds[0]:.2g} and {speeds[1]:.2g} {rate} rms")
    return "; ".join(found)


def _mean(recording: Recording, channel: str) -> float | None:
    values = recording.channels.get(channel)
    return None if values is None else float(np.mean(values))


def _speed(recording: Recording) -> float:
    """Usual speed, from positions a tenth of a second apart: noise hardly counts."""
    assert recording.position is not None
    apart = max(1, round(0.1 / recording.dt))
    moved = recording.position[apart:] - recording.position[:-apart]
    return float(np.sqrt(np.mean(moved**2)) / (apart * recording.dt))
