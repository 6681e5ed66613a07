"""Effects of the reference plant: the library's functional forms, and foreign forms of some.

An effect serves a group of lanes at once. Its `amplitude` (one number per lane) is linear in
strength; amplitude 0 changes no bit. What it does is one or more of

* `share(s)`: share of the friction level, F = (1 + share) force;
* `viscous_share(s)`: share of viscous friction;
* `effort(s)`: effort along +x, N m;
* `slip(s)`: displacement taken out of the contact in this step, rad;
* `torque(s)` (shaft) or `meet` and `follow` (gap): a second mass behind the first;
* `reads(x)`: what the sensor reads at position x, rad.

Times are on the session clock, so slow effects run on across recordings.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass, field

import numpy as np


@dataclass
class Situation:
    """Where the lanes are in the present step; arrays have one number per lane."""

    step: float  # s
    sample_time: float  # s
    substeps: int
    n: int = 0  # step
    k: int = 0  # sample
    clock: np.ndarray = None  # s, session clock
    x: np.ndarray = None  # rad, middle of the step
    v: np.ndarray = None  # rad/s, middle of the step
    dx: np.ndarray = None  # rad, move of the contact in this step
    acceleration: np.ndarray = None  # rad/s², of the step before
    path: np.ndarray = None  # rad, travelled since the session began
    input: np.ndarray = None  # N m, commanded, of this sample
    force: np.ndarray = None  # N m, contact at level 1
    history: np.ndarray = None  # N m, commanded input of all samples, (samples, lanes)
    load: np.ndarray = None  # N m, external, of this sample
    temperature: np.ndarray = None  # °C, of this sample


@dataclass
class Setting:
    """What an effect may know of its lanes: arrays with one number per lane."""

    lanes: np.ndarray
    step: float
    coulomb: np.ndarray
    presliding: np.ndarray  # rad, pre-sliding length
    inertia: np.ndarray  # of what is left on the sensor's side
    extra: dict = field(default_factory=dict)


class Effect:
    """One kind of effect on a group of lanes."""

    forms = ("library",)
    hooks = ()
    bases = ("coulomb", "maxwell_slip", "hsieh_pan")  # contacts that can have it
    size_support = 0.0  # s, kernel through which the size is measured; 0: none
    largest = np.inf  # amplitude that physics allows
    channel = None  # what has to be recorded for it: "load" or "temperature"
    # Shape parameter that brings it to size instead of the amplitude, which is 1 then; told by
    # value_for(size, inputs, velocities, shape), of the machine without hidden effects.
    reached_by = None

    def __init__(self, amplitude, shape, setting):
        self.lanes = setting.lanes
        self.setting = setting
        self.amplitude = np.asarray(amplitude, dtype=float) * shape.get("sign", 1.0)
        for name, value in shape.items():
            setattr(self, name, value)
        self.prepare()

    def prepare(self):
        """States at the start of the recordings."""

    @staticmethod
    def draw(rng, plant, form):
        """Shape parameters of one session, by name."""
        return {}

    @staticmethod
    def usual(plant):
        """Amplitude that brings about 1 % of F_c; where calibration starts."""
        return 0.02


def log_uniform(rng, low, high):
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def stream(seed, *words):
    """A random stream of its own for each purpose, so that one draw cannot move another."""
    return np.random.default_rng([seed, *(zlib.crc32(str(w).encode()) for w in words)])


def either_sign(rng):
    return float(rng.choice([-1.0, 1.0]))


def harmonic(rng, form, highest):
    """Order and phase, and for the foreign form a second harmonic."""
    shape = {"order": float(rng.integers(1, highest + 1)), "phase": rng.uniform(0, 2 * np.pi)}
    if form == "foreign":
        shape["second"] = rng.uniform(0.5, 0.9)
        shape["second_order"] = shape["order"] * float(rng.integers(2, 4))
        shape["second_phase"] = rng.uniform(0, 2 * np.pi)
    return shape


def wave(effect, x):
    """cos(N x - phase), plus the second harmonic if there is one."""
    value = np.cos(effect.order * x - effect.phase)
    if hasattr(effect, "second"):
        value += effect.second * np.cos(effect.second_order * x - effect.second_phase)
    return value


class Stribeck(Effect):
    """Level 1 + a exp(-|v/v_s|^2); foreign: exponent 1."""

    forms = ("library", "foreign")
    hooks = ("share",)

    @staticmethod
    def draw(rng, plant, form):
        return {
            "velocity": log_uniform(rng, 0.03, 0.6),
            "exponent": 2.0 if form == "library" else 1.0,
        }

    def share(self, s):
        ratio = np.abs(s.v[self.lanes] / self.velocity)
        return self.amplitude * np.exp(-(ratio**self.exponent))


class ViscousQuadratic(Effect):
    """Effort -a (v/v_r)|v/v_r|; foreign: -a (v/v_r)^3."""

    forms = ("library", "foreign")
    hooks = ("effort",)

    @staticmethod
    def draw(rng, plant, form):
        return {"velocity": 5.0, "cubic": float(form == "foreign")}

    @staticmethod
    def usual(plant):
        return 0.02 * plant["coulomb"]

    def effort(self, s):
        ratio = s.v[self.lanes] / self.velocity
        size = np.abs(ratio)
        return -self.amplitude * ratio * np.where(self.cubic, size * size, size)


class DirectionAsymmetry(Effect):
    """Levels 1 + a d(v) of dry and 1 + a b d(v) of viscous friction, d = v / sqrt(v² + v_0²)."""

    hooks = ("share", "viscous_share")

    @staticmethod
    def draw(rng, plant, form):
        return {
            "sign": either_sign(rng),
            "velocity": log_uniform(rng, 0.005, 0.02),
            "viscous_part": float(rng.choice([0.0, 1.0])),
        }

    def share(self, s):
        v = s.v[self.lanes]
        self._direction = self.amplitude * v / np.sqrt(v * v + self.velocity**2)
        return self._direction

    def viscous_share(self, s):
        return self.viscous_part * self._direction


class TorqueBias(Effect):
    """Effort a."""

    hooks = ("effort",)

    @staticmethod
    def draw(rng, plant, form):
        return {"sign": either_sign(rng)}

    @staticmethod
    def usual(plant):
        return 0.01 * plant["coulomb"]

    def effort(self, s):
        return self.amplitude


class PositionDependentFriction(Effect):
    """Level 1 + a cos(N x - phase); foreign: with a second harmonic."""

    forms = ("library", "foreign")
    hooks = ("share",)

    @staticmethod
    def draw(rng, plant, form):
        return harmonic(rng, form, 20)

    def share(self, s):
        return self.amplitude * wave(self, s.x[self.lanes])


class Cogging(Effect):
    """Effort a cos(N x - phase); foreign: triangular or rectified, mean removed."""

    forms = ("library", "foreign")
    hooks = ("effort",)

    @staticmethod
    def draw(rng, plant, form):
        shape = harmonic(rng, "library", 40)
        if form == "foreign":
            shape["rectified"] = float(rng.choice([0.0, 1.0]))
        return shape

    @staticmethod
    def usual(plant):
        return 0.014 * plant["coulomb"]

    def effort(self, s):
        value = np.cos(self.order * s.x[self.lanes] - self.phase)
        if hasattr(self, "rectified"):
            triangle = 1.0 - 2.0 / np.pi * np.arccos(np.clip(value, -1.0, 1.0))
            value = np.where(self.rectified, 2.0 * (np.abs(value) - 2.0 / np.pi), triangle)
        return self.amplitude * value


class TorqueConstantRipple(Effect):
    """Gain 1 + a cos(N x - phase); foreign: with a second harmonic."""

    forms = ("library", "foreign")
    hooks = ("effort",)

    @staticmethod
    def draw(rng, plant, form):
        return harmonic(rng, form, 40)

    def effort(self, s):
        return self.amplitude * wave(self, s.x[self.lanes]) * s.input[self.lanes]


class DriveDeadband(Effect):
    """The drive gives nothing up to an input of size a, and less by a beyond it."""

    hooks = ("effort",)

    @staticmethod
    def usual(plant):
        return 0.01 * plant["coulomb"]

    def effort(self, s):
        u = s.input[self.lanes]
        return -np.minimum(np.maximum(u, -self.amplitude), self.amplitude)
