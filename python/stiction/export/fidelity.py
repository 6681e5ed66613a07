"""What a target keeps of a plant: both run on recordings that nothing was fitted to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from .._native import played
from .._support.arrays import FloatArray
from ..errors import InputError
from ..fitting import fit
from ..fitting.forms import HORIZONS_S, KERNELS, Through, as_session, can_be_shot, forms_of
from ..fitting.recording_starts import fit_starts
from ..fitting.rows import Mask, Nuisances, Rows, rows_of
from ..plant.presliding import presliding
from ..plant.steady import static_level
from ..recording import Part
from ..recording.blocks import FEWEST_BLOCKS
from ..recording.checks import without_failures
from ..recording.recording import recordings_of
from ..recording.session_clock import subset
from ..recording.split import BLOCK_S, split
from ..recording.usable import checks_of, usable
from .registry import Target, targets
from .runs import EffortRun, Led, MotionRun, StepRun, Windows
from .speeds import greatest_speed

if TYPE_CHECKING:
    from ..plant import Plant
    from ..residual.loop_form import LoopForm
    from ..residual.shooting import ShootingForm
    from ..residual.weak_form import Start, WeakForm
    from .made import Export

__all__ = ["Bench", "Fidelity", "Kept"]

HORIZON_S: Final = HORIZONS_S[1]
"""Over which a target is simulated: a run over a whole recording diverges for other reasons."""
LEAST_GAIN: Final = 0.01
"""Share of the power of the error that effects must remove for shares of it to mean anything."""
MOVES_TIMES: Final = 2.0
"""Counts, or four times as many standard deviations of the white noise, within a kernel, from which
on a machine moves: a curve over the speed says nothing of one at rest."""

FINER: Final = 8
"""Steps of a sample in which a target steps a contact."""


@dataclass(frozen=True)
class Kept:
    """One way in which a target was run.

    Attributes
    ----------
    name : str
        "" for the plain one.
    error : float
        Root mean square.
    share : float or None
        Of what the effects of the plant remove from the power of the error, that is left; None
        where they remove nothing.
    """

    name: str
    error: float
    share: float | None


@dataclass(frozen=True)
class Fidelity:
    """What a target keeps of a plant, over rows of recordings that test.

    Attributes
    ----------
    target : str
    of : str
        What is compared, in words.
    unit : str
        Of the errors.
    rows : int
        That are compared.
    whole : float
        Error of the whole plant, simulated by stiction; root mean square.
    without : float or None
        Error of the plant without its effects, fitted again to the rows that train; None where it
        has none.
    runs : tuple of Kept
    """

    target: str
    of: str
    unit: str
    rows: int
    whole: float
    without: float | None
    runs: tuple[Kept, ...]

    @property
    def message(self) -> str:
        """What came out, in a line."""
        if all(run.share is not None for run in self.runs):
            words = [f"{run.name} {_percent(run.share)}".strip() for run in self.runs]
            return f"{self.target} keeps {words[0]} of the gain" + "".join(
                f"; {word}" for word in words[1:]
            )
        errors = ", ".join(f"{run.error:.3g} {run.name}".rstrip() for run in self.runs)
        why = "" if self.without is None else "; its effects gain nothing on these rows"
        return (
            f"{self.target}: error {errors} {self.unit} where the plant has {self.whole:.3g}{why}"
        )

    def __str__(self) -> str:
        found = [(self.target, self.runs[0]), *((run.name, run) for run in self.runs[1:])]
        errors = [f"{name} {run.error:.4g}" for name, run in found]
        errors.append(f"the whole plant {self.whole:.4g}")
        if self.without is not None:
            errors.append(f"without its effects {self.without:.4g}")
        return f"{self.message}\n  {self.of}, {self.unit} rms held out: {', '.join(errors)}"

    def to_dict(self) -> dict[str, Any]:
        """The numbers, for JSON."""
        return {
            "target": self.target,
            "message": self.message,
            "of": self.of,
            "unit": self.unit,
            "rows": self.rows,
            "whole": self.whole,
            "without": self.without,
            "runs": [{"name": r.name, "error": r.error, "share": r.share} for r in self.runs],
        }


def _percent(share: float | None) -> str:
    return "nothing" if share is None else f"{100.0 * share:.3g} %"


class Bench:
    """A session on which exports of one plant are run.

    The plant is compared as it is; without its effects its law is fitted once more to the rows that
    are not held out, as a simulation without them would be.

    Parameters
    ----------
    plant : Plant
    session : Session, or sequence of Recording, or Recording

    Raises
    ------
    InputError
        No recordings, or none that is held out.
    """

    def __init__(self, plant: Plant, session: Any) -> None:
        recordings = list(recordings_of(session, "check"))
        kept, fault = usable(recordings, checks_of(recordings))
        if kept is None:
            raise InputError(fault)
        self._plant = plant
        self._recordings = without_failures(subset(recordings, kept))
        if not self._recordings:
            raise InputError("check: there are no recordings; give a session that has some")
        only = self._recordings[0]
        if len(self._recordings) == 1 and only.duration < FEWEST_BLOCKS * BLOCK_S:
            raise InputError(
                f"check: the only recording lasts {only.duration:.3g} s, and nothing of it is held "
                "out; give several, or a longer one"
            )

    def fidelity(self, made: Export) -> Fidelity:
        """Runs an export of the plant; see ``Export.check``.

        Parameters
        ----------
        made : Export

        Raises
        ------
        InputError
            A target, a recording or a plant that cannot be run, a package that is missing.
        """
        target = targets().get(made.target)
        if target is None or target.runs is None:
            raise InputError(f"{made.target}: there is nothing that could be run; read its files")
        runs = target.runs(made, self._plant)
        moving = [run for run in runs if isinstance(run, MotionRun)]
        if self._plant.servo:
            if not moving:
                raise InputError(
                    f"{made.target} is not run for a servo: it says which effort a motion takes, "
                    "and nobody measured that of a servo; along the measured motion what its loop "
                    "does, late or limited, would be taken for friction. fmu and mujoco move, and "
                    "are run"
                )
            return self._by_loop(made, target, moving)
        if moving:
            return self._by_motion(made.target, moving)
        along = [run for run in runs if isinstance(run, EffortRun | StepRun)]
        return self._by_effort(made.target, along)

    def _by_loop(self, made: Export, target: Target, runs: Sequence[MotionRun]) -> Fidelity:
        """Whole recordings of a servo from its goal alone, as a fit and a diagnosis see them."""
        errors: list[list[FloatArray]] = [[] for _ in range(1 + len(runs))]
        without = []
        for form, mask in self._looped:
            # Gains and payload may be those of the recording.
            own = form.own(self._plant)
            there = made if own == self._plant else target.write(own, _speed(made))
            assert target.runs is not None
            moved = [run for run in target.runs(there, own) if isinstance(run, MotionRun)]
            windows = Windows(
                form.dt,
                form.readings,
                form.input,
                form.load[:-1],
                np.zeros(1, dtype=np.intp),
                len(form.input),
                form.clock,
                form.path,
                steps=None if isinstance(form.steps, float) else form.steps,
                enabled=None if form.enabled is None else form.enabled[:-1] != 0.0,
                pace=form.velocity_at_start,
            )
            reached = [form.reaches(self._plant), *(run.positions(windows)[0] for run in moved)]
            for found, position in zip(errors, reached, strict=True):
                found.append((form.readings[1:] - position)[mask])
            if self._plant.effects:
                without.append((form.readings[1:] - form.reaches(self._bare))[mask])
        together = [np.concatenate(own) for own in errors]
        of = "position over whole recordings, by the goal alone"
        unit = self._plant.position_unit
        return self._told(made.target, of, runs, together, without, unit=unit)

    def _by_motion(self, target: str, runs: Sequence[MotionRun]) -> Fidelity:
        if not can_be_shot(self._plant, [row.form for row, _ in self._along]):
            raise InputError(
                f"{target} cannot be run on these recordings: that takes a plant with an inertia "
                f"that its own input moves, and at least {4.0 * HORIZON_S:g} s of each"
            )
        left = [self._moved(form, mask, start, runs) for form, mask, start in self._shot]
        errors = [np.concatenate([own[k] for own in left]) for k in range(1 + len(runs))]
        without = (
            [
                form.residual(self._bare, start)[mask]
                for (form, mask, _), start in zip(self._shot, self._bare_starts, strict=True)
            ]
            if self._plant.effects
            else []
        )
        of = f"motion over {HORIZON_S:g} s, counted as an effort"
        return self._told(target, of, runs, errors, without)

    def _moved(
        self, form: ShootingForm, mask: Mask, start: Start, runs: Sequence[MotionRun]
    ) -> list[FloatArray]:
        """What whole plant and runs miss of the motion in the windows that test."""
        weights = form.kernel.second
        chosen = np.flatnonzero(mask)
        windows = Windows(
            form.dt,
            form.position,
            form.input,
            form.load[:-1],
            form.stride * chosen,
            len(weights),
            form.clock,
            form.path,
            start,
        )
        found = [form.residual(self._plant, start)[mask]]
        for run in runs:
            gone = run.positions(windows) - form.position[windows.starts, None]
            found.append(form.unit * (gone @ weights - form.acceleration[mask]))
        return found

    def _by_effort(self, target: str, runs: Sequence[EffortRun | StepRun]) -> Fidelity:
        errors: list[list[FloatArray]] = [[] for _ in range(1 + len(runs))]
        without = []
        bare = self._bare_starts if self._plant.effects else [None] * len(self._along)
        for (row, start), bare_start in zip(self._along, bare, strict=True):
            form, mask = row.form, row.mask & _moves(row.form, self._plant)
            errors[0].append(form.residual(self._plant, start)[mask])
            known = (
                form.measured_effort(self._plant)
                - form.own(self._plant).inertia * form.acceleration
            )
            for found, run in zip(errors[1:], runs, strict=True):
                found.append((known - self._needed(form, start, run))[mask])
            if self._plant.effects:
                without.append(form.residual(self._bare, bare_start)[mask])
        together = [np.concatenate(own) for own in errors]
        return self._told(target, "effort along the measured motion", runs, together, without)

    def _needed(self, form: WeakForm, start: Start, run: EffortRun | StepRun) -> FloatArray:
        """Effort that a run takes for the measured motion beside that of the inertia."""
        if isinstance(run, EffortRun):
            velocity = np.diff(form.position) / form.dt
            place = 0.5 * (form.position[1:] + form.position[:-1])
            return form.applied_effort(run.effort(velocity, place), np.zeros_like(place))
        temperature = form.around["temperature"]
        drive = form.along(self._plant, start)[0]
        led = Led(form.dt, form.position, drive, form.load[:-1], temperature)
        steps = run.effort(_finer(led)).reshape(len(drive), FINER)
        if form.springy:
            return form.needed_effort(self._plant, steps[:, -1])
        # Of a rigid contact it is that of the whole sample, as a held input is.
        return form.applied_effort(np.mean(steps, axis=1), np.zeros_like(drive))

    def _told(
        self,
        target: str,
        of: str,
        runs: Sequence[MotionRun | EffortRun | StepRun],
        errors: Sequence[FloatArray],
        without: Sequence[FloatArray],
        *,
        unit: str = "",
    ) -> Fidelity:
        if not len(errors[0]):
            raise InputError(
                f"{target}: nothing slides in the rows that are held out, and of a contact that "
                "rests or yields a curve says nothing; give recordings with slides"
            )
        whole, *own = (float(np.mean(left**2)) for left in errors)
        before = float(np.mean(np.concatenate(without) ** 2)) if without else None
        if not np.isfinite([whole, *own, 0.0 if before is None else before]).all():
            raise InputError(
                f"{target}: a run left the numbers that there are; the contact may be too stiff "
                "for the sample time"
            )
        gained = before is not None and before - whole > LEAST_GAIN * before
        kept = tuple(
            Kept(run.name, float(np.sqrt(power)), _share(before, power, whole) if gained else None)
            for run, power in zip(runs, own, strict=True)
        )
        return Fidelity(
            target,
            of,
            unit or self._plant.effort_unit,
            len(errors[0]),
            float(np.sqrt(whole)),
            None if before is None else float(np.sqrt(before)),
            kept,
        )

    @cached_property
    def _test(self) -> tuple[Part, ...]:
        edge_s = min(HORIZON_S, 0.25 * BLOCK_S)
        return split(self._recordings, edge_s=edge_s, decides=False).test

    def _seen(self, through: Through) -> list[WeakForm]:
        """All recordings, as a fit sees them."""
        forms = forms_of(
            self._plant, self._recordings, lambda work, items: list(map(work, items)), through
        )
        as_session(forms, self._recordings)
        return forms

    @cached_property
    def _along(self) -> list[tuple[Rows, Start]]:
        """Rows that test, seen through kernels, and where the contact of the plant begins."""
        found = []
        for index, form in enumerate(self._seen(KERNELS)):
            mask = rows_of(form, self._recordings[index], index, self._test)
            if mask.any():
                row = Rows(self._plant, form, index, mask)
                found.append((row, self._begun(self._plant, row)))
        return found

    def _begun(self, plant: Plant, row: Rows) -> Start:
        """What the contact brings along, which is no part of a plant: the whole recording tells."""
        every = [Part(row.index, 0, len(self._recordings[row.index]))]
        mask = rows_of(row.form, self._recordings[row.index], row.index, every)
        return fit_starts(plant, [row.of(mask)], Nuisances()).start(row.index)

    @cached_property
    def _shot(self) -> list[tuple[ShootingForm, Mask, Start]]:
        """The same, simulated over windows."""
        starts = {row.index: start for row, start in self._along}
        found = []
        for index, form in enumerate(self._seen(Through(horizon=HORIZON_S))):
            mask = rows_of(form, self._recordings[index], index, self._test)
            if index in starts:
                found.append((form, mask, starts[index]))
        return found  # type: ignore[return-value]  # a horizon makes them simulated ones

    @cached_property
    def _looped(self) -> list[tuple[LoopForm, Mask]]:
        """All of a servo, simulated as a whole, and the rows that test."""
        found = []
        for index, form in enumerate(self._seen(Through(loop=True))):
            mask = rows_of(form, self._recordings[index], index, self._test)
            if mask.any():
                found.append((form, mask))
        return found  # type: ignore[return-value]  # a loop makes them such

    @cached_property
    def _bare(self) -> Plant:
        """The plant without its effects, fitted to the rows that train."""
        return fit(replace(self._plant, effects=()), self._recordings).plant

    @cached_property
    def _bare_starts(self) -> list[Start]:
        return [self._begun(self._bare, row) for row, _ in self._along]


def _finer(led: Led) -> Led:
    """The same motion with parts of samples between, smooth through all of them.

    What a contact takes goes with velocity and position at a stamp, and a step holds what leads up
    to it.
    """
    samples = len(led.drive)
    rows = np.arange(samples + 1)
    between = CubicHermiteSpline(rows, led.position, np.gradient(led.position))
    temperature = None if led.temperature is None else np.repeat(led.temperature, FINER)
    return Led(
        led.dt / FINER,
        between(np.arange(FINER * samples + 1) / FINER),
        np.repeat(led.drive, FINER),
        np.repeat(led.load, FINER),
        temperature,
    )


def _speed(made: Export) -> float:
    """That an export was made for; one that was put together by hand has none of its own."""
    assert made.plant is not None
    return greatest_speed(made.plant, made.speed)


def _share(before: float | None, power: float, whole: float) -> float | None:
    """Of what the effects remove."""
    return None if before is None else (before - power) / (before - whole)


def _moves(form: WeakForm, plant: Plant) -> Mask:
    """Rows in which the machine was seen to move, and its contact slides in all of their samples.

    A contact that rests, or yields since it turned round, holds whatever acts on it, of which a
    curve over the speed says nothing.
    """
    white = float(np.sqrt(max(form.noise**2 - form.count**2 / 12.0, 0.0)))
    least = MOVES_TIMES * max(form.count, 4.0 * white)
    moves: Mask = np.abs(form.velocity) * form.kernel.support > least
    if form.springy:
        return moves & _slides(form, plant)
    slides: Mask = moves & (form.mean(1.0 * (np.diff(form.position) == 0.0)) == 0.0)
    return slides


def _slides(form: WeakForm, plant: Plant) -> Mask:
    """Rows through whose kernel a contact that yields is further from its last turn than it yields.

    Turns of less than the readings tell are none.
    """
    # Loaded the one way it has to be unloaded first.
    reach = 2.0 * presliding(plant.friction, static_level(plant))
    within = played(form.position, max(form.count, form.noise))
    way = np.sign(np.diff(within))
    moving = np.flatnonzero(way)
    if not len(moving):
        return np.zeros(len(form), dtype=bool)
    # The way of the last move, and how far it has gone on so.
    last = moving[np.maximum(np.searchsorted(moving, np.arange(len(way)), "right") - 1, 0)]
    turned = np.flatnonzero(np.diff(way[last]) != 0.0) + 1
    begun = np.concatenate([[0], turned])
    place = begun[np.searchsorted(begun, np.arange(len(way)), "right") - 1]
    since = np.abs(form.position[1:] - form.position[place])
    slides: Mask = form.mean(1.0 * (since < reach)) == 0.0
    return slides
