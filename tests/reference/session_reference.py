"""Sessions of recordings from the reference plant, with their hidden truth.

    one = make_session(7, base="maxwell_slip", hidden=[("stribeck", 0.012)])
    many = make_sessions([{"seed": 7}, {"seed": 8, "hidden": [("cogging:foreign", 0.01)]}])
    one.write(folder)            # session.toml, plant.toml and one CSV for each recording

A hidden effect is (name, size) or (name, size, {shape parameter: value}); ":foreign" asks for
the form that is not the library's. The size is the RMS of the hidden torque over the whole
session as a share of F_c. It is reached by simulating with a usual amplitude, scaling, and
simulating again; of a drive's limit, beyond which everything is lost, the limit is moved instead.
`session.effects` states the amplitude and the size that was reached, and how much of it is left
behind a smooth kernel of 30 ms (`smoothed`: fast ringing is not). With None as the size the
amplitude is taken from the shape parameters and not changed.

The same seed gives the same machine, experiments and noise, whatever is hidden in it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .channel_reference import draw_channels, side_by_side
from .effect_catalogue import EFFECTS
from .effect_reference import stream
from .excitation_reference import KINDS, draw_controller, draw_plant, excite
from .plant_reference import EffectGroup, Lanes, simulate
from .recording_reference import (
    SAMPLE_TIME,
    HiddenEffect,
    Recording,
    Session,
    rms_behind_kernel,
)

ROLES = ("train", "select", "test")
SECONDS = 156.0  # of a session of all kinds and roles
# Sessions simulated side by side; more lanes fall out of the processor's cache.
SESSIONS_PER_BATCH = 16
# A size further from the one asked for than this is corrected, so many times at most.
SIZE_TOLERANCE = 0.03
CORRECTIONS = 3
# Further from its usual amplitude nothing is looked for: a size may be out of reach, as when a
# dry contact at rest hides everything. What was reached is stated.
LARGEST_FACTOR = 30.0


@dataclass(frozen=True)
class Spec:
    """What one session shall be.

    `seconds` is the total of all recordings (default: 8.67 s for each); `rate` that of the
    simulation, Hz; `counts_per_rev` 0 reads exactly; `noise` is the standard deviation of the
    torque noise that acts as a share of F_c, `log_noise` that of one that is logged and does not
    act, `flicker` that of a reading before it is rounded, in counts.
    `lead_in` seconds of decaying torque, not recorded, let each recording start with a contact that
    is not virgin. With `size_support` sizes are those of the hidden torque seen through a cubic
    B-spline of so many seconds, not of the raw one; a
    shaft is always sized so (20 ms), because its ringing is beyond what anybody would see.
    `elements` is the number of elasto-slide elements in the contact (default 14, hsieh_pan 28).
    `one_curve` gives maxwell_slip a smooth curve of one shape parameter (64 elements), which a
    continuous model can take up entirely: a control, in which no mismatch of the curve is left.
    `channels` are recorded too, "load" or "temperature"; what a hidden effect needs is always.
    """

    seed: int
    base: str = "maxwell_slip"
    hidden: tuple = ()
    roles: tuple = ROLES
    kinds: tuple = KINDS
    seconds: float | None = None
    rate: float = 1e4
    counts_per_rev: int = 2**18
    noise: float = 0.02
    log_noise: float = 0.0
    flicker: float = 0.0
    lead_in: float = 0.0
    size_support: float = 0.0
    elements: int | None = None
    one_curve: bool = False
    channels: tuple = ()

    @property
    def duration(self):
        """Seconds of one recording."""
        if self.seconds is None:
            return SECONDS / (len(KINDS) * len(ROLES))
        return self.seconds / (len(self.kinds) * len(self.roles))

    @property
    def samples(self):
        return round(self.duration / SAMPLE_TIME)

    def layout(self):
        """What sessions of one batch must have in common."""
        contact = self.base, self.elements, self.one_curve
        return *contact, self.samples, self.rate, self.counts_per_rev, self.lead_in, self.flicker

    @property
    def count(self):
        """Step of the readings, rad; 0 for exact ones."""
        return 2.0 * np.pi / self.counts_per_rev if self.counts_per_rev else 0.0

    @property
    def lead_rows(self):
        return round(self.lead_in / SAMPLE_TIME)


# --- drawing


def _order(spec):
    """(kind, role) in the order of recording: roles take turns, so all see early and late."""
    roles, kinds = spec.roles, spec.kinds
    return [
        (kind, roles[(i + j) % len(roles)])
        for j in range(len(roles))
        for i, kind in enumerate(kinds)
    ]


class Draft:
    """A session before it is simulated."""

    def __init__(self, spec):
        self.spec = spec
        seed = spec.seed
        self.plant = draw_plant(
            spec.base, stream(seed, "plant", spec.base), spec.elements, spec.one_curve
        )
        self.controller = draw_controller(self.plant, stream(seed, "controller"))
        self.order = _order(spec)
        self.excitations = [
            excite(kind, self.plant, spec.samples, SAMPLE_TIME, stream(seed, kind, role))
            for kind, role in self.order
        ]
        place = stream(seed, "place")
        self.start = place.uniform(-np.pi, np.pi, len(self.order))
        pauses = place.uniform(2.0, 6.0, len(self.order))
        pauses[len(self.order) // 2] += 40.0  # one long rest
        pauses[0] = 0.0
        self.start_s = np.round(np.cumsum(pauses) + spec.duration * np.arange(pauses.size), 3)
        self.start_path = np.zeros(len(self.order))
        # Input, N m, and velocity, rad/s, of the machine without hidden effects, where needed.
        self.free_motion = None
        rows = spec.lead_rows + spec.samples
        self.noise = np.column_stack(
            [stream(seed, "noise", k, r).standard_normal(rows) for k, r in self.order]
        ) * (spec.noise * self.plant["coulomb"])
        self.flicker = None
        if spec.flicker:
            drawn = [stream(seed, "flicker", k, r).standard_normal(rows) for k, r in self.order]
            self.flicker = np.column_stack(drawn) * (spec.flicker * spec.count)
        lead = np.arange(spec.lead_rows)[:, None] / max(spec.lead_rows, 1)
        turns, phase = place.uniform(2.0, 4.0, (2, len(self.order)))
        wave = np.sin(2.0 * np.pi * (turns * lead + phase)) * (1.0 - lead)
        self.lead_torque = 0.9 * self.plant["coulomb"] * wave
        self.effects = [self._effect(*entry) for entry in spec.hidden]
        self.channels = self.draw_channels()

    def draw_channels(self, temperature=None):
        """Channels of the present recordings; the temperature goes on from one if it is given."""
        own = {EFFECTS[e.name].channel for e in self.effects}
        return draw_channels(self, own.union(self.spec.channels), temperature)

    def _effect(self, name, size, given=None):
        name, _, form = name.partition(":")
        form = form or "library"
        if name not in EFFECTS:
            raise ValueError(f"no effect is called {name!r}; there are {', '.join(EFFECTS)}")
        kind = EFFECTS[name]
        if form not in kind.forms:
            raise ValueError(f"{name} has the forms {', '.join(kind.forms)}, not {form!r}")
        shape = kind.draw(stream(self.spec.seed, "effect", name), self.plant, form)
        given = dict(given or {})
        amplitude = given.pop("amplitude", 0.0)
        if unknown := given.keys() - shape.keys():
            raise ValueError(f"{name}:{form} has no {', '.join(sorted(unknown))}")
        shape |= given
        if size is None:
            return HiddenEffect(name, form, None, shape, float(amplitude))
        if size and kind.reached_by and kind.reached_by not in given:
            return HiddenEffect(name, form, float(size), shape, 1.0, aim=float(size))
        amplitude = kind.usual(self.plant) * size / 0.01 if size else 0.0
        return HiddenEffect(name, form, float(size), shape, min(amplitude, kind.largest))

    def logged(self, index):
        """Noise of a recording's log, N m."""
        kind, role = self.order[index]
        rows = self.spec.samples
        white = stream(self.spec.seed, "log", kind, role).standard_normal(rows)
        return white * (self.spec.log_noise * self.plant["coulomb"])

    def shape_to_size(self):
        """Give shapes the value with which effects have the size that is aimed at."""
        for effect in self.effects:
            if effect.aim is not None:
                kind, size = EFFECTS[effect.name], effect.aim * self.plant["coulomb"]
                value = kind.value_for(size, *self.free_motion, effect.shape)
                effect.shape[kind.reached_by] = value

    @property
    def needs_motion(self):
        return any(e.aim is not None for e in self.effects)

    @property
    def needs_path(self):
        return any(getattr(EFFECTS[e.name], "needs_path", False) for e in self.effects)


def _stack(values):
    """Arrays of numbers; anything else stays a list."""
    if all(isinstance(v, (int, float)) for v in values):
        return np.array(values, dtype=float)
    return list(values)


def lanes_of(drafts, without_effects=False):
    """Put the recordings of all drafts side by side."""
    spec = drafts[0].spec
    per = [len(d.order) for d in drafts]
    first = np.concatenate([[0], np.cumsum(per)[:-1]])

    def spread(values):
        return np.repeat(np.asarray(values, dtype=float), per)

    closed = np.array([e.reference is not None for d in drafts for e in d.excitations])
    start = np.concatenate([d.start for d in drafts])
    excitations = [e for d in drafts for e in d.excitations]
    empty = np.zeros(spec.samples)
    torque = np.column_stack([e.torque for e in excitations])
    reference = np.column_stack(
        [empty if e.reference is None else e.reference for e in excitations]
    )
    lead = np.concatenate([d.lead_torque for d in drafts], axis=1)
    gains = {
        name: spread([d.controller[name] for d in drafts]) * closed
        for name in ("proportional", "derivative", "integral")
    }
    return Lanes(
        base=spec.base,
        plants=[d.plant for d, n in zip(drafts, per, strict=True) for _ in range(n)],
        torque=np.concatenate([lead, torque]),
        reference=np.concatenate([np.zeros_like(lead), reference]) + start,
        noise=np.concatenate([d.noise for d in drafts], axis=1),
        flicker=np.concatenate([d.flicker for d in drafts], axis=1) if spec.flicker else None,
        filter_time=spread([d.controller["filter_time"] for d in drafts]),
        start=start,
        start_s=np.concatenate([d.start_s for d in drafts]) - spec.lead_in,
        start_path=np.concatenate([d.start_path for d in drafts]),
        groups=[] if without_effects else _groups(drafts, first, per),
        count=spec.count,
        sample_time=SAMPLE_TIME,
        substeps=round(spec.rate * SAMPLE_TIME),
        **gains,
        **side_by_side(drafts),
    )


def _groups(drafts, first, per):
    found = {}
    for draft, begin, count in zip(drafts, first, per, strict=True):
        for slot, effect in enumerate(draft.effects):
            key = effect.name, effect.form, slot
            found.setdefault(key, []).append((effect, np.arange(begin, begin + count)))
    groups = []
    for (name, _, slot), members in found.items():
        lanes = np.concatenate([at for _, at in members])
        counts = [at.size for _, at in members]
        shape = {}
        for parameter in members[0][0].shape:
            values = [e.shape[parameter] for e, n in _for_each_lane(members, counts)]
            shape[parameter] = _stack(values)
        amplitude = np.repeat([e.amplitude for e, _ in members], counts)
        groups.append(EffectGroup(EFFECTS[name], slot, lanes, amplitude, shape))
    return groups


def _for_each_lane(members, counts):
    """Each effect once for each of its lanes."""
    return [(e, n) for (e, _), n in zip(members, counts, strict=True) for _ in range(n)]


# --- simulating


def _pieces(run, drafts):
    """(draft, its columns of the run)."""
    begin = 0
    for draft in drafts:
        end = begin + len(draft.order)
        yield draft, slice(begin, end)
        begin = end


def _take_paths(run, drafts):
    """Path travelled before each recording, from a run that was made."""
    for draft, at in _pieces(run, drafts):
        draft.start_path = np.concatenate([[0.0], np.cumsum(run.path[at])[:-1]])


def _take_motion(run, drafts):
    """Motion of the machine without hidden effects, and the shapes that it asks for."""
    for draft, at in _pieces(run, drafts):
        rows = slice(draft.spec.lead_rows, None)
        draft.free_motion = run.input[rows, at].ravel(), run.velocity[rows, at].ravel()
        draft.shape_to_size()


def _reach(run, drafts):
    """Note the sizes that a run has reached."""
    for draft, at in _pieces(run, drafts):
        for slot, effect in enumerate(draft.effects):
            hidden = run.hidden[slot][draft.spec.lead_rows :, at]
            support = draft.spec.size_support or EFFECTS[effect.name].size_support
            coulomb = draft.plant["coulomb"]
            effect.raw = rms_behind_kernel(hidden, 0.0) / coulomb
            effect.smoothed = rms_behind_kernel(hidden, 0.03) / coulomb
            effect.reached = rms_behind_kernel(hidden, support) / coulomb


def _rescale(draft):
    """Scale amplitudes; the second time by the power law that two points give."""
    for effect in draft.effects:
        if not (effect.size and effect.reached):
            continue
        aimed = effect.aim is not None
        now, power = (effect.aim if aimed else effect.amplitude, effect.reached), 1.0
        if effect.last:
            growth = np.log(now[1] / effect.last[1])
            stretch = np.log(now[0] / effect.last[0])
            if abs(stretch) > 1e-3:
                power = float(np.clip(growth / stretch, 0.5, 4.0))
        effect.last = now
        factor = (effect.size / effect.reached) ** (1.0 / power)
        if aimed:
            effect.aim *= factor
            continue
        kind = EFFECTS[effect.name]
        bound = LARGEST_FACTOR * kind.usual(draft.plant) * effect.size / 0.01
        effect.amplitude = min(effect.amplitude * factor, bound, kind.largest)
    draft.shape_to_size()


def _misses(draft):
    return any(e.size and abs(e.reached / e.size - 1.0) > SIZE_TOLERANCE for e in draft.effects)


def _session(run, draft, at):
    spec = draft.spec
    time = np.round(np.arange(spec.samples) * SAMPLE_TIME, 9)
    slots, rows = len(draft.effects), slice(spec.lead_rows, None)
    recordings = []
    for i, (kind, role) in enumerate(draft.order):
        lane = at.start + i
        parts = run.hidden[:slots, rows, lane].copy()
        reference = draft.excitations[i].reference
        truth = {
            "hidden": parts.sum(axis=0),
            "parts": parts,
            "position": run.true_position[rows, lane].copy(),
            "velocity": run.velocity[rows, lane].copy(),
            "friction": run.friction[rows, lane].copy(),
        }
        recordings.append(
            Recording(
                kind=kind,
                role=role,
                start_s=float(draft.start_s[i]),
                time_s=time,
                torque_nm=run.input[rows, lane] + draft.logged(i),
                position_rad=run.position[rows, lane].copy(),
                reference_rad=None if reference is None else reference + draft.start[i],
                truth=truth,
                **draft.channels.of(i),
            )
        )
    return Session(spec, draft.plant, draft.controller, recordings, draft.effects)


def _make_batch(drafts):
    """Sessions of drafts that have a layout in common."""
    need = [d for d in drafts if d.needs_path]
    if need:
        _take_paths(simulate(lanes_of(need, without_effects=True)), need)
    need = [d for d in drafts if d.needs_motion]
    if need:
        _take_motion(simulate(lanes_of(need, without_effects=True)), need)
    unscaled = [d for d in drafts if any(e.size for e in d.effects)]
    if unscaled:
        _simulated(unscaled)
        for draft in unscaled:
            _rescale(draft)
    sessions = _simulated(drafts)
    for _ in range(CORRECTIONS):
        poor = [i for i, d in enumerate(drafts) if _misses(d)]
        if not poor:
            break
        for i in poor:
            _rescale(drafts[i])
        again = _simulated([drafts[i] for i in poor])
        for i, session in zip(poor, again, strict=True):
            sessions[i] = session
    return sessions


def _simulated(drafts):
    """Sessions of drafts at their present amplitudes; notes the sizes reached."""
    run = simulate(lanes_of(drafts))
    _reach(run, drafts)
    return [_session(run, draft, at) for draft, at in _pieces(run, drafts)]


def _as_spec(given):
    if isinstance(given, Spec):
        return given
    given = dict(given)
    given["hidden"] = tuple(tuple(entry) for entry in given.get("hidden") or ())
    for name in ("roles", "kinds", "channels"):
        if name in given:
            given[name] = tuple(given[name])
    return Spec(**given)


def make_sessions(specs):
    """Sessions for a list of `Spec` or of dictionaries, in the same order.

    Sessions that have base, duration, rate and sensor in common are simulated side by side.
    """
    specs = [_as_spec(s) for s in specs]
    alike = {}
    for i, spec in enumerate(specs):
        alike.setdefault(spec.layout(), []).append(i)
    sessions = [None] * len(specs)
    for indices in alike.values():
        for begin in range(0, len(indices), SESSIONS_PER_BATCH):
            some = indices[begin : begin + SESSIONS_PER_BATCH]
            made = _make_batch([Draft(specs[i]) for i in some])
            for i, session in zip(some, made, strict=True):
                sessions[i] = session
    return sessions


def make_session(seed, **options):
    """One session; the options are the fields of `Spec`."""
    return make_sessions([{"seed": seed, **options}])[0]
