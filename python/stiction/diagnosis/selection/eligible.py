"""Which effects can be asked of a machine at all, and why the others cannot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from ...catalogue import EffectRecord, effects
from ...fitting.noise import input_noise
from ...plant import Plant
from ..data.evidence import Evidence
from ..records import CandidateRow
from ..screening.candidates import FALL, Candidate, candidates, present, scales_of
from ..screening.model import Model
from .decide import SWINGS
from .fewer import FALLS
from .search import Search

__all__ = ["eligible_candidates"]

AT_THE_DRIVE: Final = frozenset({"input map", "input delay", "input lag"})
"""Hooks of effects that a machine without a drive cannot have."""
MUCH_NOISE: Final = 0.3
"""Noise of a logged effort over what is left from which on it looks like friction by it."""


def eligible_candidates(
    evidence: Evidence, base: Model, without: Sequence[str], found: Search
) -> list[Candidate]:
    """Candidates that can be asked of a machine.

    Parameters
    ----------
    evidence : Evidence
    base : Model
    without : sequence of str
        Effects that are not tried.
    found : Search
        Gets a row for each effect that is not tried, and those that these data cannot show.

    Returns
    -------
    list of Candidate
    """
    scales = scales_of(evidence, base.plant)
    channels = set.intersection(*(set(r.channels) for r in evidence.recordings))
    if all(form.own(base.plant).hangs for form in evidence.forms):
        channels.add("load")
    # A fall that the plant states and one that comes with its lag would exchange for each other.
    falls = any(each.falls and present(base.plant, each) for each in effects())
    tried: list[Candidate] = []
    for record in effects():
        if record.name in without:
            continue
        reason = _refused(evidence, base.plant, record)
        missing = [name for name in record.channels if name not in channels]
        if not reason and missing:
            reason = f"not testable: no channel {missing[0]} was recorded"
            found.blind.append(record)
        if not reason and record.by_motor and "load" in channels:
            # The motor bears the load first of all: beside that both would be one.
            reason = "not tried: the load is known, and friction that grows with it is tried"
        if not reason and record.by_motor and _is_noisy(evidence, base):
            reason = "not testable: the effort that friction would grow with has noise in its log"
        if reason:
            found.rows[record.name] = CandidateRow(record.name, None, None, None, reason)
        else:
            found_at = candidates(record, scales)
            if falls or not set(without).isdisjoint(FALLS):
                found_at = [each for each in found_at if not each.shape.get(FALL)]
            swings = base.plant.inertia > 0.0
            tried += [each for each in found_at if swings or not each.resonance]
    return tried


def _is_noisy(evidence: Evidence, base: Model) -> bool:
    """Whether noise of the logged effort is much of what is left along the measured motion.

    It would be in the residual and in the friction by that effort alike, and explain itself.
    """
    if evidence.simulated:
        return False
    left, noise = [], []
    for rows in evidence.train:
        own = rows.residual(base.plant, base.nuisances)[rows.mask]
        left.append(float(np.sqrt(np.mean(own**2))))
        noise.append(input_noise(rows, base.plant, base.nuisances))
    return float(np.median(noise)) > MUCH_NOISE * float(np.median(left))


def _refused(evidence: Evidence, plant: Plant, record: EffectRecord) -> str:
    """Why an effect is not tried on such a machine, "" where it is."""
    if present(plant, record):
        return _where(plant, record)
    if reason := record.impossible(plant.motion, servo=plant.servo):
        return reason
    if evidence.loop and SWINGS in record.hooks:
        return "not testable: what swings between samples shows in no loop that is simulated"
    if plant.prescribed_motion and (record.by_motor or not AT_THE_DRIVE.isdisjoint(record.hooks)):
        return "there is no drive where the motion is prescribed"
    return ""


def _where(plant: Plant, record: EffectRecord) -> str:
    """Where a plant holds an effect already."""
    if any(effect.name == record.name for effect in plant.effects):
        return "part of the plant"
    body = any(term.startswith("body.") for term in record.law_terms)
    return "part of the body" if body else "part of the law"
