"""What a feed-forward of friction is worth: the loop with it and without, simulated."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from . import closed_loop
from ._support import given
from ._support.arrays import FloatArray
from ._support.frozen import path_of
from ._support.given import number
from .closed_loop import ClosedLoop
from .errors import InputError
from .intervals import draw_values, intervals_of
from .plant import Plant, steady
from .plant.begins import Begin, begin_of
from .recording import Recording
from .recording.names import names_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Compensated", "Compensation", "compensate", "feed_forward", "observer"]

SHARES: Final = (0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0)
"""Of the whole feed-forward, that are simulated."""
WHOLE: Final = SHARES.index(1.0)
LAG: Final = 0.02
"""Share of the error that more than the whole has to remove for what is left to be a lag."""
DRAWS: Final = 20
"""Machines within the intervals of the parameters, unless stated."""
REST_S: Final = 2.0
"""Rest of the reference after its end, in which a limit cycle shows, s."""
KICKED: Final = 2.0
"""Push at its start, in levels of break-away: what sticks is to move, or no cycle would begin."""
KICK_S: Final = 0.1
"""How long it pushes, s."""
TURNS: Final = 4
"""Reversals in the second half of it that make a cycle, and no drift or one overshoot."""
LASTS: Final = 0.5
"""Share of the motion of its third quarter that a cycle still has in the fourth: none fades."""
COUNTS: Final = 2.0
"""Counts of the encoder that a reading at rest may change by."""
SEEN: Final = 1e-6
"""Share of the range of the reference that counts as motion where there is no encoder."""
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
    by_observer : numpy.ndarray, shape (shares, n)
        As ``errors``, with shares of what the contact bears when it is stepped along the measured
        motion.
    cycles : tuple of bool
        Of each of those shares, whether the machine goes on to and fro where the reference rests.
    """

    name: str
    time: FloatArray
    errors: FloatArray
    unit: str
    stepped: FloatArray
    by_observer: FloatArray
    cycles: tuple[bool, ...]

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
    def observer_rms(self) -> FloatArray:
        """As ``rms``, with the contact stepped along the measured motion."""
        every = np.concatenate([each.by_observer for each in self.recordings], axis=1)
        found: FloatArray = np.sqrt(np.mean(every**2, axis=1))
        return found

    @property
    def cycles(self) -> tuple[bool, ...]:
        """Of shares of that, whether any recording ends in a limit cycle, or a loop runs away."""
        ends = zip(*(each.cycles for each in self.recordings), strict=True)
        away = np.isnan(self.observer_rms)
        return tuple(any(each) or bool(ran) for each, ran in zip(ends, away, strict=True))

    @property
    def observer_margin(self) -> float | None:
        """Least share of a compensation by the measured motion that makes a limit cycle.

        None where none of those simulated does, and 0 where the loop has one without any.
        """
        return next((s for s, cycle in zip(self.shares, self.cycles, strict=True) if cycle), None)

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
        said = (self._stated, self._with_states, self._by_observer, self._spread)
        return " ".join(filter(None, said))

    @property
    def _with_states(self) -> str:
        """What the contact's own states are worth beside its friction of steady motion."""
        if np.isnan(self.stepped):
            return "With the contact stepped along the reference a loop runs away."
        error, unit = self.stepped, self.recordings[0].unit
        return f"With the contact stepped along the reference it is {error:.3g} {unit} rms."

    @property
    def _by_observer(self) -> str:
        """What it is worth to step the contact along the measured motion, and how much hurts."""
        error, unit, margin = (
            self.observer_rms[WHOLE],
            self.recordings[0].unit,
            self.observer_margin,
        )
        text = (
            "With the contact stepped along the measured motion a loop runs away"
            if np.isnan(error)
            else f"Along the measured motion it is {error:.3g} {unit} rms"
        )
        if margin is None:
            return f"{text}, without a limit cycle up to {self.shares[-1]:g} times as much."
        if margin == 0.0:
            return f"{text}; the loop goes to and fro at rest without any compensation."
        # Margins in amplitude, as those of gains are.
        return f"{text}; {margin:g} times as much makes a limit cycle at rest."

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
        elif np.nanmin(rms) < (1.0 - LAG) * after:
            # The friction of the plant is known to the last digit here: more of it bears a lag.
            text += (
                f" What is left is no friction, but what the controller lags without it: "
                f"{self.best:g} times as much would leave {np.nanmin(rms):.3g} {unit}."
            )
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
            "observer": {
                "rms": self.observer_rms.tolist(),
                "cycles": list(self.cycles),
                "margin": self.observer_margin,
            },
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


def observer(plant: Plant, share: float = 1.0) -> closed_loop.Fed:
    """A compensation by the measured motion: a contact that is stepped along the readings.

    Its states follow the machine's own as those of an observer do whose model is right. Where it
    bears more than the machine has, the machine cannot stick: it makes a limit cycle.

    Parameters
    ----------
    plant : Plant
        With a gain.
    share : float
        Of what the contact bears, that is added to the input.

    Returns
    -------
    callable
        For ``closed_loop.replay(..., fed=...)``: of the reading, rad or m, and the sample time, s,
        the input that is added. It remembers: make a new one for each run.

    Raises
    ------
    InputError
        No plant, or a share that is no number.
    """
    given.instance(plant, Plant, "observer: plant", "a Plant")
    share = number(share, "observer: share")
    contact = plant.friction_model()
    zero = plant.body.get("gravity_zero_rad")
    hangs, weight = plant.gravity, plant.weight
    hung_at = 0.0 if zero is None else zero.value
    before: float | None = None

    def fed(reading: float, dt: float) -> float:
        nonlocal before
        if before is None:
            contact.reset(reading)
            before = reading
        borne = contact.step((reading - before) / dt, dt)
        before = reading
        borne += weight + hangs * math.sin(reading - hung_at)
        return share * borne / plant.gain

    return fed


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
        observed, cycles = _follow_with_observer(plant, recording, begin, len(time))
        found.append(Compensated(name, time, np.array(errors), unit, stepped, observed, cycles))
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


def _follow_with_observer(
    plant: Plant, recording: Recording, begin: Begin | None, rows: int
) -> tuple[FloatArray, tuple[bool, ...]]:
    """Tracking errors with shares of a compensation by the measured motion, and whether it cycles.

    The reference rests after its end, where a machine is pushed out of its place. Of friction that
    is borne by more than there is the push does not die away.
    """
    longer = _resting(recording, KICKED * steady.static_level(plant))
    errors, cycles = np.full((len(SHARES), rows), np.nan), []
    for k, share in enumerate(SHARES):
        try:
            run = closed_loop.replay(plant, longer, fed=observer(plant, share), **begin_of(begin))
        except InputError:
            cycles.append(False)
            continue
        errors[k] = (run.reference - run.simulated)[:rows]
        cycles.append(_cycles(run.simulated[rows:], plant.count, np.ptp(run.reference)))
    return errors, tuple(cycles)


def _resting(recording: Recording, push: float) -> Recording:
    """A recording whose last row goes on for a while, a load pushing at first."""
    time = np.asarray(recording.time)
    dt = float(time[-1] - time[0]) / (len(time) - 1)
    more = round(REST_S / dt)

    def longer(values: FloatArray) -> FloatArray:
        return np.concatenate([values, np.full(more, values[-1])])

    channels: dict[str, Any] = {k: longer(values) for k, values in recording.channels.items()}
    load = channels.setdefault("load", np.zeros(len(time) + more))
    load[len(time) : len(time) + round(KICK_S / dt)] += push
    stamps = np.concatenate([time, time[-1] + dt * np.arange(1, more + 1)])
    parts = [None if p is None else longer(p) for p in (recording.input, recording.position)]
    return Recording(stamps, *parts, settings=recording.settings, **channels)


def _cycles(position: FloatArray, count: float, reach: float) -> bool:
    """Whether a machine goes to and fro for good, by its positions while the reference rests."""
    third, fourth = np.array_split(position, 4)[2:]
    steps = np.diff(np.concatenate([third, fourth]))
    steps = steps[steps != 0.0]
    turns = int(np.sum(np.sign(steps[1:]) != np.sign(steps[:-1])))
    least = COUNTS * count if count else SEEN * reach
    return turns >= TURNS and bool(np.ptp(fourth) > max(least, LASTS * np.ptp(third)))


def _rms(runs: Sequence[ClosedLoop | None]) -> float:
    """Tracking error over all samples; NaN where one of the loops ran away."""
    errors = [run.reference - run.simulated for run in runs if run is not None]
    if len(errors) < len(runs):
        return np.nan
    return float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))
