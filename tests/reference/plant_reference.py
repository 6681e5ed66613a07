"""A plant that shares nothing with the product: many machines simulated in one time loop.

    J x'' = gain u(t) + load + noise + added efforts - L S(history of x) - (1 + share) F_v x'

A lane is one machine in one recording. The scheme is a leapfrog (kick-drift-kick, second order):
the contact is moved to the middle of each step, velocities live at the ends, viscous friction
is taken implicitly. The input is held over a sample, row k of a result is the state at
t = k sample_time and the input that holds from there on.

The hidden torque of an effect is the effort that the base plant would need in addition to
follow the *same measured motion*:

    J y'' = u + load + noise - F_base(history of y) + hidden,  y the position as the sensor reads.

It is stored as the mean over each sample. A dry contact at rest holds any effort: there the
hidden torque is 0.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .contact_reference import contact_of
from .effect_reference import Setting, Situation

TURN = 2.0 * np.pi


@dataclass
class EffectGroup:
    """One kind of effect on some lanes: parameters hold one number for each of these."""

    kind: type
    slot: int
    lanes: np.ndarray
    amplitude: np.ndarray
    shape: dict


@dataclass
class Lanes:
    """What is simulated side by side; matrices are (samples, lanes)."""

    base: str
    plants: list  # dictionaries of parameters
    torque: np.ndarray  # N m, open-loop part of the input
    reference: np.ndarray  # rad
    noise: np.ndarray  # N m, acts on the body and is not logged
    proportional: np.ndarray  # N m/rad, 0 in open loop
    derivative: np.ndarray  # N m s/rad
    integral: np.ndarray  # N m/(rad s)
    filter_time: np.ndarray  # s, of the controller's velocity
    start: np.ndarray  # rad
    start_s: np.ndarray  # s on the session clock
    start_path: np.ndarray  # rad travelled before
    groups: list = field(default_factory=list)
    count: float = TURN / 2**18  # rad of one encoder count; 0 reads exactly
    sample_time: float = 1e-3
    substeps: int = 10
    flicker: np.ndarray | None = None  # rad, of the reading before it is rounded
    load: np.ndarray | None = None  # N m, external, acts on the body
    temperature: np.ndarray | None = None  # °C


@dataclass
class Run:
    """Result: matrices (samples, lanes); `hidden` is (slots, samples, lanes)."""

    input: np.ndarray  # N m, commanded
    position: np.ndarray  # rad, as the encoder reads it
    true_position: np.ndarray
    velocity: np.ndarray
    friction: np.ndarray  # N m, mean over the sample
    hidden: np.ndarray  # N m, mean over the sample
    path: np.ndarray  # rad, travelled in each lane


def compact(lanes):
    """A slice where the lanes are neighbours, because slices are read without copying."""
    lanes = np.asarray(lanes)
    if lanes.size and np.array_equal(lanes, np.arange(lanes[0], lanes[0] + lanes.size)):
        return slice(int(lanes[0]), int(lanes[0]) + lanes.size)
    return lanes


class _Effects:
    """The groups of a batch, sorted once by where they enter."""

    def __init__(self, batch, step):
        hooks = ("share", "viscous_share", "effort", "slip", "shaft", "gap")
        self.by_hook = {h: [] for h in hooks}
        self.sensors = []
        self.inertia = np.array([p["inertia"] for p in batch.plants])
        self.near_inertia = self.inertia.copy()
        self.lead = np.zeros(len(batch.plants), dtype=int)
        # A gap parts what a shaft has left on the sensor's side.
        for group in sorted(batch.groups, key=lambda g: "gap" in g.kind.hooks):
            plants = [batch.plants[i] for i in group.lanes]
            lanes = compact(group.lanes)
            setting = Setting(
                lanes=lanes,
                step=step,
                coulomb=np.array([p["coulomb"] for p in plants]),
                presliding=np.array([p["presliding"] for p in plants]),
                inertia=self.near_inertia[lanes].copy(),
            )
            if batch.base not in group.kind.bases:
                able = " or ".join(group.kind.bases)
                raise ValueError(f"{group.kind.__name__} needs a contact of {able}")
            effect = group.kind(group.amplitude, group.shape, setting)
            effect.slot = group.slot
            effect.shadow = None
            if ("slip" in effect.hooks or "sensor" in effect.hooks) and batch.base != "coulomb":
                effect.shadow = contact_of(batch.base, plants, step)
            for hook in effect.hooks:
                if hook == "sensor":
                    self.sensors.append(effect)
                else:
                    self.by_hook[hook].append(effect)
            if "shaft" in effect.hooks or "gap" in effect.hooks:
                self.near_inertia[lanes] *= effect.near_share
            self.lead[lanes] = np.maximum(self.lead[lanes], getattr(effect, "lead", 0))
        self.slots = 1 + max((g.slot for g in batch.groups), default=-1)


class _Controller:
    """PD or PID on the encoder, with a first-order filter on its velocity."""

    def __init__(self, batch, lead):
        self.batch, self.lead = batch, lead
        self.closed = bool(np.any(batch.proportional))
        self.early = bool(lead.any())
        self.columns = np.arange(lead.size)
        self.blend = batch.sample_time / (batch.filter_time + batch.sample_time)
        self.velocity = np.zeros(lead.size)
        self.sum = np.zeros(lead.size)
        self.past = None
        slope = np.diff(batch.reference, axis=0, prepend=batch.reference[:1])
        self.slope = slope / batch.sample_time

    def act(self, k, position, log):
        """Write the input of sample k + lead into the log, from the reading at sample k."""
        b = self.batch
        if not self.closed:
            return
        if self.past is None:
            self.past = position.copy()
        self.velocity += self.blend * ((position - self.past) / b.sample_time - self.velocity)
        self.past = position
        error = b.reference[k] - position
        self.sum += error * b.sample_time
        feedback = (
            b.proportional * error
            + b.derivative * (self.slope[k] - self.velocity)
            + b.integral * self.sum
        )
        if not self.early:
            log[k] += feedback
            return
        row = k + self.lead
        inside = row < log.shape[0]
        log[row[inside], self.columns[inside]] += feedback[inside]


def simulate(batch):
    """Run all lanes of a batch and return a `Run`."""
    samples, lanes = batch.torque.shape
    h = batch.sample_time / batch.substeps
    effects = _Effects(batch, h)
    hooks = effects.by_hook
    contact = contact_of(batch.base, batch.plants, h)
    controller = _Controller(batch, effects.lead)
    dry = batch.base == "coulomb"
    inertia, near = effects.inertia, effects.near_inertia
    mass = near / h

    log = batch.torque.copy()
    read = np.empty((samples, lanes))
    true_x, true_v = np.empty((samples, lanes)), np.empty((samples, lanes))
    friction = np.zeros((samples, lanes))
    hidden = np.zeros((effects.slots, samples, lanes))
    parts = np.zeros((effects.slots, lanes))

    x = batch.start.astype(float).copy()  # at the middle of the step
    v, past_v = np.zeros(lanes), np.zeros(lanes)
    dx, travelled = np.zeros(lanes), np.zeros(lanes)
    level, damping = np.ones(lanes), contact.damping
    effort = np.empty(lanes)
    half = 0.5 * h

    s = Situation(step=h, sample_time=batch.sample_time, substeps=batch.substeps)
    s.history, s.x, s.dx, s.force = log, x, dx, contact.force
    s.acceleration = np.zeros(lanes)
    s.path = batch.start_path.astype(float).copy()
    active = bool(batch.groups)
    levelled = bool(hooks["share"] or hooks["viscous_share"])

    for k in range(samples):
        now = x + half * v
        true_x[k], true_v[k] = now, v
        reading = now
        for e in effects.sensors:
            reading[e.lanes] = e.reads(now[e.lanes])
        if batch.flicker is not None:
            reading = reading + batch.flicker[k]
        if batch.count:
            np.round(reading / batch.count, out=reading)
            reading *= batch.count
        read[k] = reading
        controller.act(k, reading, log)
        u = log[k]
        s.k, s.input = k, u
        held = u + batch.noise[k]
        if batch.load is not None:
            s.load = batch.load[k]
            held = held + s.load
        if batch.temperature is not None:
            s.temperature = batch.temperature[k]
        for i in range(batch.substeps):
            np.multiply(v, h, out=dx)
            x += dx
            moved = np.abs(dx)
            travelled += moved
            if hooks["slip"]:
                drive = dx.copy()
                for e in hooks["slip"]:
                    drive[e.lanes] -= e.slip(s)
                contact.advance(drive)
            else:
                contact.advance(dx)
            middle = 1.5 * v - 0.5 * past_v
            effort[:] = held
            if active:
                s.n = k * batch.substeps + i
                s.v = middle
                s.path += moved
                s.clock = batch.start_s + (s.n + 0.5) * h
                np.subtract(v, past_v, out=s.acceleration)
                s.acceleration /= h
                parts[:] = 0.0
                for e in hooks["effort"]:
                    part = e.effort(s)
                    effort[e.lanes] += part
                    parts[e.slot, e.lanes] += part
                for e in hooks["shaft"]:
                    e.load = e.torque(s)
                    effort[e.lanes] -= e.load
            damping = contact.damping
            if levelled:
                level[:] = 1.0
                for e in hooks["share"]:
                    e.part = e.share(s)
                    level[e.lanes] += e.part
                if hooks["viscous_share"]:
                    added = np.zeros(lanes)
                    for e in hooks["viscous_share"]:
                        e.viscous_part_now = e.viscous_share(s)
                        added[e.lanes] += e.viscous_part_now
                    damping = damping + contact.viscous_share(added)
            drag = 0.5 * damping
            momentum = (mass - drag) * v
            force = contact.settle(momentum, effort, level)
            past_v = v
            v = (momentum + effort - force) / (mass + drag)
            if hooks["gap"]:
                total = mass.copy()
                meeting = [e.meet(s, v, total, momentum) for e in hooks["gap"]]
                if any(meeting):
                    force = contact.settle(momentum, effort, level)
                    v = (momentum + effort - force) / (total + drag)
                for e in hooks["gap"]:
                    e.follow(s, v)
            mean_v = 0.5 * (v + past_v)
            friction[k] += force
            friction[k] += damping * mean_v
            if active:
                _book(parts, hooks, effects.sensors, contact, s, v, past_v, inertia, h)
                if dry:
                    parts *= v != 0.0
                hidden[:, k] += parts
    friction /= batch.substeps
    hidden /= batch.substeps
    return Run(log, read, true_x, true_v, friction, hidden, travelled)


def _book(parts, hooks, sensors, contact, s, v, past_v, inertia, h):
    """Hidden torques that are known only once the step has been made."""
    mean_v = 0.5 * (v + past_v)
    for e in hooks["share"]:
        parts[e.slot, e.lanes] -= e.part * contact.force[e.lanes]
    for e in hooks["viscous_share"]:
        share = np.zeros_like(v)
        share[e.lanes] = e.viscous_part_now
        parts[e.slot, e.lanes] -= (contact.viscous_share(share) * mean_v)[e.lanes]
    for e in hooks["shaft"] + hooks["gap"]:
        rate = (v[e.lanes] - past_v[e.lanes]) / h
        moving = e.near_share < 1.0
        parts[e.slot, e.lanes] += np.where(moving, e.far_inertia * rate - e.load, 0.0)
    for e in hooks["slip"]:
        e.shadow.advance(s.dx[e.lanes])
        parts[e.slot, e.lanes] += e.shadow.force - contact.force[e.lanes]
        looser = e.shadow.damping - contact.damping[e.lanes]
        parts[e.slot, e.lanes] += looser * mean_v[e.lanes]
    for e in sensors:
        at = e.lanes
        rate = (v[at] - past_v[at]) / h
        seen_v, seen_rate = e.rates(s.x[at], mean_v[at], rate)
        parts[e.slot, at] += inertia[at] * (seen_rate - rate)
        if e.shadow is not None:
            seen = e.reads(s.x[at])
            last = getattr(e, "seen", seen)
            e.seen = seen
            e.shadow.advance(seen - last)
            parts[e.slot, at] += e.shadow.force - contact.force[at]
            parts[e.slot, at] += e.shadow.damping * seen_v - contact.damping[at] * mean_v[at]
        else:
            parts[e.slot, at] += contact.damping[at] * (seen_v - mean_v[at])
