"""What a diagnosis reports, as records: causes, candidates, laws, models, remainders, advice."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, Literal

from .._support.frozen import ByPath, Frozen, freeze
from ..catalogue import effects
from ..fitting.result import FitParameter

if TYPE_CHECKING:
    from ..plant import Plant
    from .data.gain import Gain
    from .findings.loop import Replay
    from .findings.reliability import Reliability

__all__ = [
    "Advice",
    "CandidateRow",
    "Cause",
    "LawRow",
    "ModelSummary",
    "Unexplained",
    "Verdict",
]

Verdict = Literal[
    "data_fault",
    "not_testable",
    "unexplained",
    "ambiguous",
    "missing_effect",
    "nothing_missing",
]

FEWEST_TOLD: Final = 10
"""Sessions from which on how often names were right in them is said in words."""


class _Gained:
    """What was measured on test rows, in the words of findings.json."""

    gain: Gain | None

    @property
    def heldout_gain(self) -> float | None:
        """Share of the residual's power that it removes, over test rows; None where unknown."""
        return None if self.gain is None else self.gain.value

    @property
    def heldout_gain_ci95(self) -> tuple[float, float] | None:
        """95 % interval of ``heldout_gain``."""
        return None if self.gain is None else self.gain.ci95


@dataclass(frozen=True)
class Cause(_Gained):
    """One effect that the plant lacks.

    Attributes
    ----------
    name, family : str
        Effect, and the class that it belongs to (``class`` in findings.json).
    decided : bool
        Whether the data tell it from its look-alikes, and nothing else leaves a doubt.
    look_alikes : tuple of str
        Effects that explain the same about as well.
    parameters : Mapping of str to FitParameter
        By path: what was fitted.
    gain : Gain or None
        Over the test rows, beside the model that holds the causes before it.
    what, means, try_ : str
        The finding in words.
    coordinate : str
        Coordinate in which the residual showed it.
    doubt : str
        Why it is undecided where no look-alike is, "" where there is no other reason.
    waves : Mapping of str to FitParameter
        By path: amplitude and phase of what was fitted as a cosine and a sine.
    chosen : Mapping of str to float
        By path: numbers of it that were not fitted, but taken from those that were tried, as the
        order of a wave is.
    size : float
        rms of the effort that it contributes, as a share of the friction's.
    reliability : Reliability or None
        What names that were told like this one came to where the truth was known.
    """

    name: str
    family: str
    decided: bool
    look_alikes: tuple[str, ...]
    parameters: Mapping[str, FitParameter]
    gain: Gain | None
    what: str
    means: str
    try_: str
    coordinate: str
    doubt: str = ""
    waves: Mapping[str, FitParameter] = field(default_factory=dict)
    chosen: Mapping[str, float] = field(default_factory=dict)
    size: float = 0.0
    reliability: Reliability | None = None

    def __post_init__(self) -> None:
        freeze(self, ByPath, "parameters", "waves", "chosen")

    @property
    def doubtful(self) -> bool:
        """Whether the interval of every number reaches 0 that says how strong it is.

        A speed, a time or an order is none: of nothing any may be known.
        """
        intervals = self._strengths
        return bool(intervals) and all(low <= 0.0 <= high for low, high in intervals)

    @property
    def determined(self) -> bool:
        """Whether the fit tells the numbers of its strength from all else that was fitted."""
        return all(math.isfinite(end) for interval in self._strengths for end in interval)

    @property
    def _strengths(self) -> list[tuple[float, float]]:
        """Intervals of the numbers that say how strong it is."""
        shapes = _shapes_of(self.name)
        return [
            parameter.ci95
            for path, parameter in self.parameters.items()
            if path.rsplit(".", 1)[-1] not in shapes
        ]

    def to_dict(self) -> dict[str, Any]:
        """As an entry of ``effects``."""
        return {
            "name": self.name,
            "class": self.family,
            "decided": self.decided,
            "look_alikes": list(self.look_alikes),
            "size": self.size,
            "parameters": {
                path: {"value": p.value, "ci95": list(p.ci95), "unit": p.unit}
                for path, p in self.parameters.items()
            },
            "waves": {
                path: {"value": p.value, "ci95": list(p.ci95), "unit": p.unit}
                for path, p in self.waves.items()
            },
            "heldout_gain": self.heldout_gain,
            "heldout_gain_ci95": None if self.gain is None else list(self.gain.ci95),
            **self._likely(),
        }

    @property
    def track_record(self) -> str:
        """What names told like this one came to, in words; "" where few were counted."""
        held = self.reliability
        if held is None or held.told < FEWEST_TOLD:
            return ""
        return held.words(several=bool(self.look_alikes))

    def _likely(self) -> dict[str, Any]:
        """How probable it is, and how its look-alikes are."""
        held = self.reliability
        if held is None:
            return {"probability": None, "alternatives": [], "reliability": None}
        # Nothing is known of one look-alike that is not known of the others.
        each = (held.coverage - held.probability) / max(len(self.look_alikes), 1)
        return {
            "probability": held.probability,
            "alternatives": [{"name": name, "probability": each} for name in self.look_alikes],
            "reliability": held.to_dict(),
        }


def _shapes_of(name: str) -> set[str]:
    """Numbers of an effect that say how it goes, and not how strong it is."""
    return {
        own
        for record in effects()
        if record.name == name
        for own in (
            *(shape.parameter for shape in record.shapes),
            *record.second[len(record.gains) :],
        )
    }


@dataclass(frozen=True)
class CandidateRow:
    """One effect that was tried.

    Attributes
    ----------
    name : str
    score, threshold : float or None
        Share of the residual that it would explain, and what noise alone may reach.
    select_gain : float or None
        Gain on the rows that decide.
    reason : str
        Why it was accepted or refused.
    """

    name: str
    score: float | None
    threshold: float | None
    select_gain: float | None
    reason: str

    def to_dict(self) -> dict[str, Any]:
        """As an entry of ``candidates``."""
        return {
            "name": self.name,
            "score": self.score,
            "threshold": self.threshold,
            "select_gain": self.select_gain,
            "reason": self.reason,
        }


@dataclass(frozen=True)
class LawRow(_Gained):
    """Another law in place of the plant's.

    Attributes
    ----------
    law : str
        Its name.
    gain : Gain or None
        Of the held-out squared error against the plant's law; None where it was not fitted.
    reason : str
        What was decided of it and why, in words.
    """

    law: str
    gain: Gain | None
    reason: str

    def to_dict(self) -> dict[str, Any]:
        """As an entry of ``laws``."""
        return {
            "law": self.law,
            "heldout_gain": self.heldout_gain,
            "heldout_gain_ci95": None if self.gain is None else list(self.gain.ci95),
            "reason": self.reason,
        }


@dataclass(frozen=True)
class ModelSummary:
    """A fitted model: parameters and errors, in units of effort.

    Attributes
    ----------
    plant : Plant
    parameters : Mapping of str to FitParameter
    unit : str
    train_rms, select_rms, heldout_rms : float or None
        Residual; None where there are no such rows.
    train_relative, heldout_relative : float or None
        2-norm of the residual over that of the measured effort; of a servo over its motion's.
    noise_floor_rms : float
        Residual that noise and rounding alone would leave.
    remarks : tuple of str
        Bounds that were hit, parameters that the data do not determine, loops that ran away, and
        what is assumed.
    replay : Replay or None
        Position error in closed loop; None where controller or reference are not known.
    assumed : tuple of str
        What the plant leaves open and every value hangs on, in sentences.
    stiffness : float or None
        Of a servo: effort per position by which errors of its simulated loop count as a residual.
    begins : Mapping of str to Mapping
        Where each recording begins for this model (see ``FitResult.begins``).
    """

    plant: Plant
    parameters: Mapping[str, FitParameter]
    unit: str
    train_rms: float
    select_rms: float | None
    heldout_rms: float | None
    train_relative: float
    heldout_relative: float | None
    noise_floor_rms: float
    remarks: tuple[str, ...]
    replay: Replay | None = None
    assumed: tuple[str, ...] = ()
    stiffness: float | None = None
    begins: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        freeze(self, ByPath, "parameters")
        begins = {name: Frozen(begin) for name, begin in self.begins.items()}
        object.__setattr__(self, "begins", Frozen(begins))

    @property
    def law(self) -> str:
        """The friction law."""
        return self.plant.friction.law

    @property
    def effects(self) -> tuple[str, ...]:
        """The names of its effects."""
        return tuple(effect.name for effect in self.plant.effects)

    def to_dict(self) -> dict[str, Any]:
        """As ``baseline`` and ``extended``."""
        return {
            "law": self.law,
            "effects": list(self.effects),
            "parameters": {
                path: {
                    "value": p.value,
                    "ci95": list(p.ci95),
                    "unit": p.unit,
                    "at_bound": p.at_bound,
                }
                for path, p in self.parameters.items()
            },
            "unit": self.unit,
            "train_rms": self.train_rms,
            "select_rms": self.select_rms,
            "heldout_rms": self.heldout_rms,
            "noise_floor_rms": self.noise_floor_rms,
            "replay": None if self.replay is None else self.replay.to_dict(),
            "begins": {name: dict(begin) for name, begin in self.begins.items()},
        }


@dataclass(frozen=True)
class Unexplained:
    """Something that is left and has no name.

    Attributes
    ----------
    coordinate : str
        Over what it shows.
    share : float
        Of what the extended model leaves, from 0 to 1.
    """

    coordinate: str
    share: float

    def to_dict(self) -> dict[str, Any]:
        """As an entry of ``unexplained``."""
        return {"coordinate": self.coordinate, "share": self.share}


@dataclass(frozen=True)
class Advice:
    """An experiment worth recording next.

    Attributes
    ----------
    experiment, reason : str
        What to record and why, in words.
    separates : tuple of str
        Effects that it tells apart.
    """

    experiment: str
    reason: str
    separates: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """As an entry of ``advice``."""
        return {
            "experiment": self.experiment,
            "reason": self.reason,
            "separates": list(self.separates),
        }
