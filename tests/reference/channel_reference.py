"""What a session may record besides input and position: an external load and a temperature.

Matrices are (samples, recordings). A sample's value holds until the next one, as the input does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .effect_reference import either_sign, log_uniform, stream
from .recording_reference import SAMPLE_TIME

CHANNELS = ("load", "temperature")
# Largest load over F_c: a controller holds against any, but without one a body that rests below
# break-away shall go on resting there, and loops below break-away shall stay below.
LARGEST_LOAD = 1.5
LARGEST_OPEN = {"presliding": 0.05, "dwell": 0.15, "pulses": 0.15}
# Of a temperature that a clock could stand for nothing would be learnt.
LIKE_THE_CLOCK = 0.5  # largest correlation
WARM = 35.0  # °C


@dataclass
class Channels:
    """Of one session, without the rows before a recording begins."""

    load: np.ndarray | None = None  # N m, effort on the body
    temperature: np.ndarray | None = None  # °C

    def of(self, index):
        """What one recording of the session has, by the names of `Recording`."""
        named = {"load_nm": self.load, "temperature_c": self.temperature}
        return {n: None if m is None else m[:, index].copy() for n, m in named.items()}


def draw_channels(draft, names, first=None):
    """Channels with these names for a session; its temperature goes on from `first`, if given."""
    if unknown := set(names) - {None, *CHANNELS}:
        raise ValueError(f"channels are {', '.join(CHANNELS)}, not {', '.join(sorted(unknown))}")
    spec, found = draft.spec, Channels()
    if "load" in names:
        found.load = draft.plant["coulomb"] * np.column_stack(
            [
                draw_load(
                    stream(spec.seed, "load", i, kind, role),
                    spec.samples,
                    LARGEST_LOAD if e.reference is not None else LARGEST_OPEN.get(kind, 0.15),
                )
                for i, ((kind, role), e) in enumerate(
                    zip(draft.order, draft.excitations, strict=True)
                )
            ]
        )
    if "temperature" in names:
        rng = stream(spec.seed, "temperature", len(draft.order))
        found.temperature = draw_temperature(rng, draft.start_s, spec.samples, first)
    return found


def side_by_side(drafts):
    """Channels of all drafts for their lanes, by name, with the rows before recordings begin."""
    lanes = {}
    for name, fill in (("load", 0.0), ("temperature", 25.0)):
        parts = [getattr(d.channels, name) for d in drafts]
        if all(part is None for part in parts):
            continue
        columns = []
        for draft, part in zip(drafts, parts, strict=True):
            shape = draft.spec.samples, len(draft.order)
            part = np.full(shape, fill) if part is None else part
            # There is no load yet, and the temperature is that of the beginning.
            lead = np.tile(part[:1], (draft.spec.lead_rows, 1))
            columns.append(np.concatenate([lead, part]))
        lanes[name] = np.concatenate(columns, axis=1)
    return lanes


def draw_load(rng, samples, largest):
    """Levels of both signs, reached by a step of some 10 ms or by a slow sweep; 0 at first."""
    times, levels, side = [0.0, 0.3], [0.0, 0.0], either_sign(rng)
    while times[-1] < samples * SAMPLE_TIME:
        edge = log_uniform(rng, 0.4, 1.6) if rng.random() < 0.5 else rng.uniform(5e-3, 2e-2)
        level = side * rng.uniform(0.2, 1.0) if rng.random() < 0.85 else 0.0
        times += [times[-1] + edge, times[-1] + edge + log_uniform(rng, 0.1, 0.8)]
        levels += [level, level]
        if rng.random() < 0.7:
            side = -side
    return largest * np.interp(np.arange(samples) * SAMPLE_TIME, times, levels)


def draw_temperature(rng, starts, samples, first=None):
    """Warming and cooling in turn, each recording with a target of its own; °C.

    A first-order lag follows the targets. It is drawn again where it would follow the clock.
    What is warm already cools at first.
    """
    t = np.asarray(starts)[None, :] + np.arange(samples)[:, None] * SAMPLE_TIME
    span, cold = rng.uniform(10.0, 25.0), rng.uniform(20.0, 30.0)
    first = cold if first is None else first
    way = 1.0 if first < WARM else -1.0
    span = min(span, first - 20.0) if way < 0.0 else span
    while True:
        rise = _follow(rng, t)
        like = len(starts) > 3 and abs(np.corrcoef(rise.ravel(), t.ravel())[0, 1])
        if like < LIKE_THE_CLOCK:
            return first + way * span * rise / np.ptp(rise)


def _follow(rng, t):
    """Distance from the first temperature; a target holds until the next recording begins."""
    recordings = t.shape[1]
    far = rng.permutation(np.arange(1, recordings + 1) % 2)
    targets = far * rng.uniform(0.7, 1.0, recordings)
    targets += (1 - far) * rng.uniform(0.0, 0.3, recordings)
    time = max(log_uniform(rng, 0.08, 0.25) * (t[-1, -1] - t[0, 0]), 1.0)
    rise, now = np.empty_like(t), 0.0
    for i, target in enumerate(targets):
        rise[:, i] = target + (now - target) * np.exp(-(t[:, i] - t[0, i]) / time)
        if i + 1 < recordings:
            now = target + (now - target) * np.exp(-(t[0, i + 1] - t[0, i]) / time)
    return rise
