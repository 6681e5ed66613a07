"""What a feed-forward of friction is worth: the loop with it and without, simulated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from . import closed_loop, given
from .begins import Begin, begin_of
from .closed_loop import ClosedLoop
from .errors import InputError
from .frozen import path_of
from .intervals import draw_values, intervals_of
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
DRAWS: Final = 20
"""Machines within the intervals of the parameters, unless stated."""
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
    stepped : numpy.ndarray, shape (n,)
        As ``errors``, with the contact stepped along the reference as feed-forward.
    """

    name: str
    time: FloatArray
    errors: FloatArray
    unit: str
    stepped: FloatArray

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
    machines : numpy.ndarray, shape (draws, 2)
        Tracking error over all samples, rad or m rms, of each machine drawn within the intervals of
        the parameters: without the feed-forward and with the whole, which is that of the plant as
        stated; NaN where the loop ran away. Empty where no intervals were given.
    """

    recordings: tuple[Compensated, ...]
    shares: tuple[float, ...] = SHARES
    machines: FloatArray = field(default_factory=lambda: np.empty((0, 2)))

    @property
    def rms(self) -> FloatArray:
        """Tracking error over all samples with each share, rad or m; NaN where a loop ran away."""
        every = np.concatenate([each.errors for each in self.recordings], axis=1)
        found: FloatArray = np.sqrt(np.mean(every**2, axis=1))
        return found

    @property
    def stepped(self) -> float:
        """Tracking error with the contact stepped along the reference; NaN where a loop ran off."""
        every = np.concatenate([each.stepped for each in self.recordings])
        return float(np.sqrt(np.mean(every**2)))

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
    def hurt(self) -> int:
        """Of the drawn machines, those that follow worse with the whole feed-forward."""
        # One that runs away either way is not hurt by it.
        ran = np.isnan(self.machines)
        worse = (self.machines[:, 1] > self.machines[:, 0]) | (ran[:, 1] & ~ran[:, 0])
        return int(np.sum(worse))

    @property
    def message(self) -> str:
        """What came out, in words."""
        return " ".join(filter(None, (self._stated, self._with_states, self._spread)))

    @property
    def _with_states(self) -> str:
        """What the contact's own states are worth beside its friction of steady motion."""
        if np.isnan(self.stepped):
            return "With the contact stepped along the reference a loop runs away."
        error, unit = self.stepped, self.recordings[0].unit
        return f"With the contact stepped along the reference it is {error:.3g} {unit} rms."

    @property
    def _spread(self) -> str:
        """What becomes of it over the intervals of the parameters; nothing where none are known."""
        if not len(self.machines):
            return ""
        unit, ran = self.recordings[0].unit, np.isnan(self.machines)
        ends = []
        for errors, away in zip(self.machines.T, ran.T, strict=True):
            kept = errors[~away]
            text = f"{kept.min():.3g} to {kept.max():.3g} {unit} rms" if len(kept) else "none"
            ends.append(text + (f" ({away.sum()} ran away)" if away.any() else ""))
        hurt = f"it would hurt {self.hurt}" if self.hurt else "it hurts none"
        return (
            f"Over {len(self.machines)} machines within the 95 % intervals of the parameters: "
            f"{ends[0]} without, {ends[1]} with the whole feed-forward; {hurt} of them."
        )

    @property
    def _stated(self) -> str:
        """What came out for the plant as it is stated."""
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
            "stepped": self.stepped,
            "machines": {
                "drawn": len(self.machines),
                "hurt": self.hurt,
                "without": self.machines[:, 0].tolist(),
                "whole": self.machines[:, 1].tolist(),
            },
            "recordings": [
                {"name": each.name, "rms": each.rms.tolist()} for each in self.recordings
            ],
        }

    def __repr__(self) -> str:
        return f"Compensation({self.message})"


def feed_forward(
    plant: Plant, reference: FloatArray, dt: float, *, stepped: bool = False
) -> FloatArray:
    """Input of the drive that friction and position will take along a reference.

    Parameters
    ----------
    plant : Plant
        With a gain.
    reference : numpy.ndarray, shape (n,)
        Positions, rad or m.
    dt : float
        s.
    stepped : bool
        Whether the contact itself is stepped along the reference, from one that never moved. Its
        states follow the reference as those of an observer without feedback do: where the
        reference turns round, a contact that yields builds its force up over a way. Without it
        friction is that of steady motion at the speed of the coming sample, and none where the
        reference rests.

    Returns
    -------
    numpy.ndarray, shape (n,)
        Friction and the effort that the place asks for, in units of the input.
    """
    speeds = np.append(np.diff(reference), 0.0) / dt
    if stepped:
        contact = plant.friction_model()
        contact.reset(float(reference[0]))
        # What effects ask for at a place is an effort of the contact; gravity is none. A step tells
        # of the end of a sample.
        ends = np.append(reference[1:], reference[-1])
        weight = replace(plant, effects=()).position_effort(ends)
        return (contact.simulate(speeds, dt) + weight) / plant.gain
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
    *,
    intervals: Any = None,
    draws: int = DRAWS,
    seed: int = 0,
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
    intervals : Diagnosis, FitResult, path of findings.json or fit.json, or mapping, optional
        As for ``intervals_of``. Machines are drawn within them, evenly and one parameter by one,
        and follow with the feed-forward of the plant as it is stated. Parameters of a fit go
        together, so that machines drawn so are spread wider than those the data allow.
    draws : int
        Machines that are drawn, at least 1.
    seed : int
        Of the draws.

    Returns
    -------
    Compensation

    Raises
    ------
    InputError
        As ``closed_loop.replay`` and ``intervals_of``; a plant without a controller or with a
        servo, no recordings, intervals of what the plant does not state.
    """
    given.instance(plant, Plant, "compensate: plant", "a Plant")
    draws = given.whole(draws, "compensate: draws", least=1)
    seed = given.whole(seed, "compensate: seed", least=0)
    chosen = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if not chosen:
        raise InputError("compensate: there are no recordings; give at least one")
    told = {} if intervals is None else intervals_of(intervals)
    where = f"{plant.source}: intervals: "
    within = {path_of(path, plant.parameters, where, "is not stated"): told[path] for path in told}
    known = [None] * len(chosen) if begins is None else list(begins)
    found = []
    for name, recording, begin in zip(names_of(chosen), chosen, known, strict=True):
        errors: list[FloatArray] = []
        for share in SHARES:
            run = _followed(plant, plant, recording, begin, share)
            if run is None:
                errors.append(np.full_like(errors[0], np.nan))
                continue
            errors.append(run.reference - run.simulated)
            time, unit = run.time, run.unit
        run = _followed(plant, plant, recording, begin, 1.0, stepped=True)
        stepped = np.full_like(errors[0], np.nan) if run is None else run.reference - run.simulated
        found.append(Compensated(name, time, np.array(errors), unit, stepped))
    machines = np.empty((draws if within else 0, 2))
    source = np.random.default_rng(seed)
    for row in machines:
        own = plant.with_values(
            draw_values(within, source, lambda values: plant.with_values(values).motor())
        )
        for k, share in enumerate((0.0, 1.0)):
            runs = [
                _followed(own, plant, *each, share, spared=True)
                for each in zip(chosen, known, strict=True)
            ]
            row[k] = _rms(runs)
    return Compensation(tuple(found), machines=machines)


def _followed(
    machine: Plant,
    known: Plant,
    recording: Recording,
    begin: Begin | None,
    share: float,
    *,
    stepped: bool = False,
    spared: bool = False,
) -> ClosedLoop | None:
    """The loop of a machine with a share of what is known of it; None where it runs away.

    Without a feed-forward a loop that cannot be run is refused in words, unless it is spared that.
    """

    def ahead(reference: FloatArray, dt: float) -> FloatArray:
        return share * feed_forward(known, reference, dt, stepped=stepped)

    try:
        return closed_loop.replay(machine, recording, ahead=ahead, **begin_of(begin))
    except InputError:
        if share == 0.0 and not spared:
            raise
        return None


def _rms(runs: Sequence[ClosedLoop | None]) -> float:
    """Tracking error over all samples; NaN where one of the loops ran away."""
    errors = [run.reference - run.simulated for run in runs if run is not None]
    if len(errors) < len(runs):
        return np.nan
    return float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))
