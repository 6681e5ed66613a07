"""More recordings of a machine that was recorded before, with signals that somebody planned."""

from __future__ import annotations

import zlib
from dataclasses import dataclass, replace

import numpy as np

from .excitation_reference import Excitation
from .plant_reference import simulate
from .session_reference import SAMPLE_TIME, Draft, _simulated, _take_paths, lanes_of


@dataclass
class Wanted:
    """A recording to be made: a torque or a reference (from the start position) a millisecond."""

    kind: str
    role: str
    start_s: float
    torque: np.ndarray | None = None
    reference: np.ndarray | None = None


def record_more(session, wanted, *, cold=False):
    """Recordings of the machine of a session, its clock and path going on, or `cold` from 0."""
    length = max(len(w.torque if w.reference is None else w.reference) for w in wanted)
    number = len(wanted)
    last = session.recordings[-1]
    had = {"load": last.load_nm, "temperature": last.temperature_c}
    spec = replace(
        session.spec,
        hidden=(),
        channels=tuple(name for name, values in had.items() if values is not None),
        kinds=("tracking",) * number,
        roles=("train",),
        seconds=number * length * SAMPLE_TIME,
    )
    draft = Draft(spec)
    rng = np.random.default_rng([spec.seed, zlib.crc32(b"more")])
    draft.order = [(w.kind, w.role) for w in wanted]
    draft.excitations = [_excitation(w, length) for w in wanted]
    draft.noise = rng.standard_normal(draft.noise.shape) * (spec.noise * draft.plant["coulomb"])
    if spec.flicker:
        draft.flicker = rng.standard_normal(draft.noise.shape) * (spec.flicker * spec.count)
    draft.start_s = np.array([w.start_s for w in wanted])
    draft.effects = [replace(effect, size=None) for effect in session.effects]
    warm = None if cold or last.temperature_c is None else float(last.temperature_c[-1])
    draft.channels = draft.draw_channels(warm)
    _take_paths(simulate(lanes_of([draft], without_effects=True)), [draft])
    if not cold:
        draft.start_path = draft.start_path + sum(
            float(np.sum(np.abs(np.diff(r.truth["position"])))) for r in session.recordings
        )
    (made,) = _simulated([draft])
    return [_cut(r, w) for r, w in zip(made.recordings, wanted, strict=True)]


def _excitation(wanted, length):
    if wanted.reference is None:
        torque = np.zeros(length)
        torque[: len(wanted.torque)] = wanted.torque
        return Excitation(torque, None)
    held = np.full(length, wanted.reference[-1])
    held[: len(wanted.reference)] = wanted.reference
    return Excitation(np.zeros(length), held)


def _cut(recording, wanted):
    """Without what was appended to make all of one length."""
    rows = len(wanted.torque if wanted.reference is None else wanted.reference)
    reference = recording.reference_rad
    channels = {
        name: values[:rows]
        for name in ("load_nm", "temperature_c")
        if (values := getattr(recording, name)) is not None
    }
    truth = {name: values[..., :rows] for name, values in recording.truth.items()}
    return replace(
        recording,
        time_s=recording.time_s[:rows],
        torque_nm=recording.torque_nm[:rows],
        position_rad=recording.position_rad[:rows],
        reference_rad=None if reference is None else reference[:rows],
        truth=truth,
        **channels,
    )
