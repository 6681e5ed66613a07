"""What a feed-forward of friction is worth: the loop with it and without, simulated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from . import closed_loop, given
from .begins import Begin, begin_of
from .errors import InputError
from .plant import Plant
from .recording import Recording
from .recording.names import names_of
from .trajectory import FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Compensated", "Compensation", "compensate", "feed_forward"]

SHARES: Final = (0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0)
"""Of the whole feed-forward, that are simulated."""
WHOLE: Final = SHARES.index(1.0)
POINTS: Final = 400
"""Speeds of each direction at which the curve of friction is known; lines between them."""


@dataclass(frozen=True)
class Compensated:
    """One recording, followed with shares of a feed-forward.

    Attributes
    ----------
    name : str
    time : numpy.ndarray, shape (n,)
        s.
    errors : numpy.ndarray, shape (shares, n)
        Reference less simulated position, rad or m; NaN where the loop ran away.
    unit : str
    """

    name: str
    time: FloatArray
    errors: FloatArray
    unit: str

    @property
    def rms(self) -> FloatArray:
        """Root mean square of the tracking error with each share; shape (shares,)."""
        found: FloatArray = np.sqrt(np.mean(self.errors**2, axis=1))
        return found

    def plot(self) -> Figure:
        """A figure of the tracking error without the feed-forward and with it."""
        from . import plot

        without, whole = self.errors[0], self.errors[WHOLE]
        return plot.tracking(self.time, without, whole, unit=self.unit, title=self.name)


@dataclass(frozen=True)
class Compensation:
    """What a feed-forward of friction and of efforts over the position is worth.

    Attributes
    ----------
    recordings : tuple of Compensated
    shares : tuple of float
        Of the feed-forward, that were simulated; 1 is the whole.
    """

    recordings: tuple[Compensated, ...]
    shares: tuple[float, ...] = SHARES

    @property
    def rms(self) -> FloatArray:
        """Tracking error over all samples with each share, rad or m; NaN where a loop ran away."""
        every = np.concatenate([each.errors for each in self.recordings], axis=1)
        found: FloatArray = np.sqrt(np.mean(every**2, axis=1))
        return found

    @property
    def best(self) -> float:
        """The share that leaves the least error."""
        return self.shares[int(np.nanargmin(self.rms))]

    @property
    def margin(self) -> float | None:
        """Least share, beyond the best, that is worse than none; None where none of those is."""
        rms = self.rms
        for share, error in zip(self.shares, rms, strict=True):
            if share > self.best and not error <= rms[0]:
                return share
        return None

    @property
    def message(self) -> str:
        """What came out, in words."""
        rms, unit = self.rms, self.recordings[0].unit
        before, after = float(rms[0]), float(rms[WHOLE])
        if not np.isfinite(after):
            return "With the whole feed-forward a loop runs away: it would hurt."
        change = 100.0 * (1.0 - after / before) if before > 0.0 else 0.0
        verb = "falls" if change >= 0.0 else "RISES"
        text = (
            f"The tracking error {verb} from {before:.3g} to {after:.3g} {unit} rms "
            f"({-change:+.0f} %), simulated."
        )
        if change < 0.0:
            text += f" It would hurt; {self.best:g} of it is best."
        elif self.margin is not None:
            text += f" {self.margin:g} times as much would be worse than none."
        return text

    def to_dict(self) -> dict[str, Any]:
        """The numbers, for JSON."""
        return {
            "schema": 1,
            "message": self.message,
            "unit": self.recordings[0].unit,
            "shares": list(self.shares),
            "rms": self.rms.tolist(),
            "best": self.best,
            "margin": self.margin,
            "recordings": [
                {"name": each.name, "rms": each.rms.tolist()} for each in self.recordings
            ],
        }

    def __repr__(self) -> str:
        return f"Compensation({self.message})"


def feed_forward(plant: Plant, reference: FloatArray, dt: float) -> FloatArray:
    """Input of the drive that friction and position will take along a reference.

    Parameters
    ----------
    plant : Plant
        With a gain.
    reference : numpy.ndarray, shape (n,)
        Positions, rad or m.
    dt : float
        s.

    Returns
    -------
    numpy.ndarray, shape (n,)
        Friction of steady motion at the speed of the coming sample, none where the reference rests,
        and the effort that the place asks for, in units of the input.
    """
    speeds = np.append(np.diff(reference), 0.0) / dt
    greatest = float(np.max(np.abs(speeds), initial=0.0))
    friction = np.zeros_like(speeds)
    if greatest > 0.0:
        known = greatest * np.geomspace(1e-5, 1.0, POINTS)
        for sign in (-1.0, 1.0):
            there = sign * speeds > 0.0
            curve = plant.friction_curve(sign * known)
            friction[there] = np.interp(np.abs(speeds[there]), known, curve)
    return (friction + plant.position_effort(reference)) / plant.gain


def compensate(
    plant: Plant,
    recordings: Sequence[Recording] | Recording,
    begins: Sequence[Begin | None] | None = None,
) -> Compensation:
    """Simulate a plant under its controller with shares of a feed-forward of its own friction.

    Parameters
    ----------
    plant : Plant
        With a controller; as a diagnosis extended it.
    recordings : sequence of Recording, or Recording
        With position and reference.
    begins : sequence, optional
        Contact, clock and path at the start of each, as begins.toml has them.

    Returns
    -------
    Compensation

    Raises
    ------
    InputError
        As ``closed_loop.replay``; a plant without a controller or with a servo, no recordings.
    """
    given.instance(plant, Plant, "compensate: plant", "a Plant")
    chosen = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if not chosen:
        raise InputError("compensate: there are no recordings; give at least one")
    known = [None] * len(chosen) if begins is None else list(begins)
    found = []
    for name, recording, begin in zip(names_of(chosen), chosen, known, strict=True):
        begun = begin_of(begin)
        errors: list[FloatArray] = []
        for share in SHARES:

            def ahead(reference: FloatArray, dt: float, share: float = share) -> FloatArray:
                return share * feed_forward(plant, reference, dt)

            try:
                run = closed_loop.replay(plant, recording, ahead=ahead, **begun)
            except InputError:
                if share == 0.0:
                    raise
                errors.append(np.full_like(errors[0], np.nan))
                continue
            errors.append(run.reference - run.simulated)
            time, unit = run.time, run.unit
        found.append(Compensated(name, time, np.array(errors), unit))
    return Compensation(tuple(found))
