"""Closed-loop replay of a diagnosis: position error before and after, where the loop is known."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from ... import closed_loop
from ..._support.arrays import FloatArray
from ..._support.wording import plural
from ...closed_loop import ClosedLoop
from ...errors import InputError
from ...fitting.rows import Mask
from ...plant import Plant
from ...recording import Part, Recording
from ..data.evidence import Evidence, SealedError
from .pictures import Pictures, Tracking
from .traces import with_loops
from .words import WORSE, worse_loop_words

if TYPE_CHECKING:
    from ..screening.model import Model
    from ..selection.search import Search
    from .result import Diagnosis

__all__ = ["Replay", "borne_out", "with_loop_replay"]

LOOP_AGAINST: Final = "passes, but the simulated loop does worse with it"

_logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Replay:
    """Position error of a plant under its own controller, beside the measured motion.

    Attributes
    ----------
    unit : str
        rad or m.
    train_rms, heldout_rms : float or None
        Over the rows that train and that test; None where none has a reference, or where a
        simulated loop ran away.
    controller_error : float or None
        How far the stated controller misses the recorded input along the measured motion, as a
        share of it; of the recording that it misses most.
    """

    unit: str
    train_rms: float | None
    heldout_rms: float | None
    controller_error: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """As ``replay`` of a model in findings.json."""
        return {
            "unit": self.unit,
            "train_rms": self.train_rms,
            "heldout_rms": self.heldout_rms,
        }


Runs = dict[int, ClosedLoop | None]
"""Loops by recording, None for one that could not be simulated."""


def with_loop_replay(found: Diagnosis, evidence: Evidence, base: Model, final: Model) -> Diagnosis:
    """A diagnosis with the loop of both models replayed; as it was where nothing can be.

    Raises
    ------
    SealedError
        The rows that test are not open yet.
    """
    if evidence.sealed:
        raise SealedError("the test rows are compared with a replay after the last decision")
    split = evidence.split
    wanted = sorted({part.recording for part in (*split.train, *split.test)})
    plant = base.plant
    wanted = [index for index in wanted if _has_loop(plant, evidence.recordings[index])]
    if not _is_controlled(plant) or not wanted:
        return found
    before, told = _runs(evidence, base, wanted)
    after, told_after = (before, told) if final is base else _runs(evidence, final, wanted)
    assert found.baseline is not None
    assert found.extended is not None
    found = replace(
        found,
        baseline=replace(
            found.baseline,
            replay=_errors(evidence, base, before),
            remarks=(*found.baseline.remarks, *told),
        ),
        extended=replace(
            found.extended,
            replay=_errors(evidence, final, after),
            remarks=(*found.extended.remarks, *told_after),
        ),
        pictures=_pictured(found.pictures, evidence, before, after),
    )
    return replace(found, sentence=found.sentence + worse_loop_words(found))


def borne_out(selection: Search, evidence: Evidence) -> Search:
    """The selection without the last causes with which the simulated loop does clearly worse.

    Effort along a measured motion errs with the readings, and that of a servo with its stated law:
    what explains it better and leads the simulated loop astray is no cause. Judged on the rows that
    fit and decide; on those that test once they are open: they choose nothing, and may take a name
    away.

    Parameters
    ----------
    selection : Search
    evidence : Evidence
    """
    if not (_is_controlled(evidence.plant) and selection.choices):
        return selection
    split = evidence.split
    parts = (*split.train, *split.select) if evidence.sealed else split.test
    wanted = sorted({part.recording for part in parts})
    wanted = [k for k in wanted if _has_loop(evidence.plant, evidence.recordings[k])]
    if not wanted:
        return selection
    errors = [
        _rms(evidence, _runs(evidence, model, wanted)[0], parts) for model in selection.models
    ]
    return drop_harmful(selection, errors)


def drop_harmful(selection: Search, errors: Sequence[float | None]) -> Search:
    """The selection without the last causes with which a loop errs clearly more.

    Parameters
    ----------
    selection : Search
    errors : sequence of float or None
        Of the loop of each of its models; None where it could not be simulated.
    """
    while selection.choices:
        after = errors[len(selection.choices)]
        before = [error for error in errors[: len(selection.choices)] if error is not None]
        if not before or (after is not None and after <= WORSE * min(before)):
            break
        selection = selection.without_last(LOOP_AGAINST)
    return selection


def _is_controlled(plant: Plant) -> bool:
    return bool(plant.controller or plant.servo) and not plant.prescribed_motion


def _has_loop(plant: Plant, recording: Recording) -> bool:
    known = plant.servo or "reference" in recording.channels
    return known and recording.position is not None


def _runs(evidence: Evidence, model: Model, wanted: Sequence[int]) -> tuple[Runs, list[str]]:
    """The loop of each recording, and in words why one could not be simulated."""
    runs: Runs = {}
    failed = []
    for index in wanted:
        recording, start = evidence.recordings[index], model.nuisances.start(index)
        try:
            form = evidence.forms[index]
            run = closed_loop.replay(
                model.plant, recording, start, clock=form.clock, path=form.path
            )
            runs[index] = _later(run, model.nuisances.timing) if model.plant.servo else run
        except InputError as error:
            runs[index] = None
            why = str(error).removeprefix(f"{recording.path or 'recording'}: ")
            failed.append(f"{evidence.names[index]} is not replayed in closed loop: {why}")
            _logger.info("%s", failed[-1])
    if len(failed) > 1:
        failed[0] += f" (and {plural(len(failed) - 1, 'other recording')} likewise)"
    return runs, failed[:1]


def _later(run: ClosedLoop, offset: float) -> ClosedLoop:
    """The loop of a goal that comes later than it is stamped, as it was fitted."""
    return replace(run, simulated=np.interp(run.time - offset, run.time, run.simulated))


def _errors(evidence: Evidence, model: Model, runs: Runs) -> Replay:
    missed = [run.controller_error for run in runs.values() if run is not None]
    known = [share for share in missed if share is not None]
    return Replay(
        model.plant.position_unit,
        _rms(evidence, runs, evidence.split.train),
        _rms(evidence, runs, evidence.split.test),
        max(known, default=None),
    )


def _rms(evidence: Evidence, runs: Runs, parts: Sequence[Part]) -> float | None:
    """Root mean square over these parts, each sample counted once."""
    errors = []
    for index, run in runs.items():
        if not any(part.recording == index for part in parts):
            continue
        if run is None:
            return None
        errors.append(run.error[_inside(evidence, index, run, parts)])
    return float(np.sqrt(np.mean(np.concatenate(errors) ** 2))) if errors else None


def _inside(evidence: Evidence, index: int, run: ClosedLoop, parts: Sequence[Part]) -> Mask:
    """Samples of a replay that lie in these parts of its recording."""
    stamps = evidence.recordings[index].time
    half = 0.5 * evidence.recordings[index].dt
    chosen = np.zeros(len(run.time), dtype=bool)
    for part in parts:
        if part.recording == index:
            first, last = stamps[part.start] - half, stamps[part.stop - 1] + half
            chosen |= (run.time >= first) & (run.time <= last)
    return chosen


def _pictured(
    pictures: Pictures | None, evidence: Evidence, before: Runs, after: Runs
) -> Pictures | None:
    """With the loop of the recording that gains most; of train where none tests."""
    if pictures is None:
        return None
    pictures = replace(pictures, traces=with_loops(pictures.traces, evidence, before, after))
    drawn = []
    for parts in (evidence.split.test, evidence.split.train):
        for index, run in before.items():
            other = after[index]
            if run is None or other is None or not any(p.recording == index for p in parts):
                continue
            drawn.append(_tracking(evidence, index, (run, other), parts))
        if drawn:
            gained = [
                float(np.nansum(t.error_after**2) - np.nansum(t.error_before**2)) for t in drawn
            ]
            return replace(pictures, tracking=drawn[int(np.argmin(gained))])
    return pictures


def _tracking(
    evidence: Evidence, index: int, loops: tuple[ClosedLoop, ClosedLoop], parts: Sequence[Part]
) -> Tracking:
    one, two = loops
    inside = _inside(evidence, index, one, parts)

    def shown(position: FloatArray) -> FloatArray:
        return np.where(inside, position - one.reference, np.nan)

    return Tracking(
        evidence.names[index],
        one.time - one.time[0],
        shown(one.measured),
        shown(one.simulated),
        shown(two.simulated),
    )
