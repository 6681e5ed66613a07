"""Effects with a memory: delays, contact age, slow changes, second masses, creep.

They keep the conventions of `effect_reference`.
"""

from __future__ import annotations

import numpy as np

from .effect_reference import Effect, log_uniform


class InputDelay(Effect):
    """The input acts late by a seconds, exact to any fraction of the simulation's step.

    A negative delay, an input that acts before its stamp, needs a controller that is ready
    early: it computes each input `LEAD` samples ahead. Longer negative delays are cut there.
    """

    LEAD = 3
    hooks = ("effort",)

    @staticmethod
    def draw(rng, plant, form):
        return {"sign": float(rng.choice([-1.0, 1.0], p=[0.25, 0.75]))}

    @staticmethod
    def usual(plant):
        return 1e-3

    def prepare(self):
        self.lead = np.where(np.asarray(self.sign) < 0.0, self.LEAD, 0)
        if isinstance(self.lanes, slice):
            self.columns = np.arange(self.lanes.start, self.lanes.stop)
        else:
            self.columns = self.lanes
        self._steps = None

    def effort(self, s):
        if self._steps is None:
            late = np.maximum(self.amplitude, -self.LEAD * s.sample_time) / s.step
            whole = np.floor(late)
            self._part = late - whole
            self._steps = whole.astype(int)
        row = (s.n - self._steps) // s.substeps
        before = (s.n - self._steps - 1) // s.substeps
        acting = (1.0 - self._part) * self._held(s, row) + self._part * self._held(s, before)
        return acting - s.input[self.lanes]

    def _held(self, s, row):
        last = s.history.shape[0] - 1
        held = s.history[np.clip(row, 0, last), self.columns]
        return np.where(row < 0, 0.0, held)


class ContactAge:
    """Rest and slide told apart by a window of displacement, which ringing does not leave.

    The anchor follows the body with a play of ± window. While it stands the contact rests;
    what it moves is distance slid.
    """

    def __init__(self, window, lanes):
        self.window, self.lanes, self.anchor = window, lanes, None

    def slid(self, s):
        """Distance slid in this step, rad."""
        x = s.x[self.lanes]
        if self.anchor is None:
            self.anchor = x.copy()
        moved = np.minimum(np.maximum(self.anchor, x - self.window), x + self.window)
        distance = np.abs(moved - self.anchor)
        self.anchor = moved
        return distance


class DwellStrengthening(Effect):
    """Level 1 + a q, q' = (1 - q) / T at rest, dq/dx = -q / l while sliding.

    After a full slide q = 1 - exp(-dwell / T). Foreign: the level is 1 + a (age / 1 s)^p or
    1 + a ln(1 + age / t_0), with the age of the contact wiped out over the same distance.
    """

    forms = ("library", "foreign")
    hooks = ("share",)

    @staticmethod
    def draw(rng, plant, form):
        length = plant["presliding"]
        shape = {
            "window": length,
            "distance": length * log_uniform(rng, 2.0, 10.0),
            "time": log_uniform(rng, 0.4, 2.5),
        }
        if form == "foreign":
            shape["logarithmic"] = float(rng.choice([0.0, 1.0]))
            shape["power"] = rng.uniform(0.15, 0.35)
            shape["onset"] = log_uniform(rng, 0.02, 0.2)
        return shape

    @staticmethod
    def usual(plant):
        return 0.04

    def prepare(self):
        self.contact = ContactAge(self.window, self.lanes)
        self.age = np.zeros_like(self.amplitude)

    def share(self, s):
        slid = self.contact.slid(s)
        resting = slid == 0.0
        if hasattr(self, "power"):
            self.age += resting * s.step
            self.age *= np.exp(-slid / self.distance)
            log = np.log1p(self.age / self.onset)
            return self.amplitude * np.where(self.logarithmic, log, self.age**self.power)
        self.age += resting * (1.0 - self.age) * (s.step / self.time)
        self.age *= np.exp(-slid / self.distance)
        return self.amplitude * self.age


class RateDependentBreakaway(Effect):
    """Level 1 + a b; at rest b follows exp(-r / r_0), r = |F - q| / tau, q' = (F - q) / tau.

    The body's first slide takes b along; it is then wiped out over a distance.
    """

    hooks = ("share",)
    FOLLOWING = 0.02  # s, in which b takes its value again after a stop

    @staticmethod
    def draw(rng, plant, form):
        return {
            "window": plant["presliding"],
            "distance": plant["presliding"] * log_uniform(rng, 2.0, 10.0),
            "rate": plant["coulomb"] * log_uniform(rng, 1.0, 6.0),
            "filter": 0.1,
        }

    @staticmethod
    def usual(plant):
        return 0.03

    def prepare(self):
        self.contact = ContactAge(self.window, self.lanes)
        self.filtered = np.zeros_like(self.amplitude)
        self.strength = np.ones_like(self.amplitude)

    def share(self, s):
        slid = self.contact.slid(s)
        lag = (s.force[self.lanes] - self.filtered) / self.filter
        self.filtered += lag * s.step
        target = np.exp(-np.abs(lag) / self.rate)
        resting = slid == 0.0
        self.strength += resting * (target - self.strength) * (s.step / self.FOLLOWING)
        self.strength *= np.exp(-slid / self.distance)
        return self.amplitude * self.strength


class WarmUp(Effect):
    """Levels of dry and viscous friction 1 - a (1 - exp(-t/T)); foreign: two time constants."""

    forms = ("library", "foreign")
    hooks = ("share", "viscous_share")

    @staticmethod
    def draw(rng, plant, form):
        shape = {"time": log_uniform(rng, 30.0, 150.0), "viscous_part": rng.uniform(0.5, 1.5)}
        if form == "foreign":
            shape["slow_time"] = 6.0 * shape["time"]
            shape["slow_part"] = rng.uniform(0.8, 1.5)
        return shape

    def share(self, s):
        t = s.clock[self.lanes]
        fall = -np.expm1(-t / self.time)
        if hasattr(self, "slow_part"):
            fall -= self.slow_part * np.expm1(-t / self.slow_time)
        self._fall = -self.amplitude * fall
        return self._fall

    def viscous_share(self, s):
        return self.viscous_part * self._fall


class RunIn(Effect):
    """Level 1 - a (1 - exp(-path / P)); foreign: 1 - a path / (path + P)."""

    forms = ("library", "foreign")
    hooks = ("share",)
    needs_path = True

    @staticmethod
    def draw(rng, plant, form):
        return {"distance": log_uniform(rng, 40.0, 200.0), "rational": float(form == "foreign")}

    def share(self, s):
        ratio = s.path[self.lanes] / self.distance
        fall = np.where(self.rational, ratio / (1.0 + ratio), -np.expm1(-ratio))
        return -self.amplitude * fall


class ShaftCompliance(Effect):
    """A share of the inertia behind a shaft of compliance a, rad/(N m). 0 is rigid."""

    hooks = ("shaft",)
    size_support = 0.02
    # The explicit scheme wants omega step < 2; stiffer shafts than this are cut, rad/s.
    FASTEST = 8000.0

    @staticmethod
    def draw(rng, plant, form):
        return {"inertia_share": rng.uniform(0.3, 0.6), "damping_ratio": rng.uniform(0.02, 0.06)}

    @staticmethod
    def usual(plant):
        return 1.0 / (plant["inertia"] * 0.25 * (2 * np.pi * 120.0) ** 2)

    def prepare(self):
        share, inertia = self.inertia_share, self.setting.inertia
        self.far_inertia = share * inertia
        reduced = share * (1.0 - share) * inertia
        self.flexible = self.amplitude > 0.0
        compliance = np.where(self.flexible, self.amplitude, 1.0)
        self.stiffness = np.minimum(1.0 / compliance, reduced * self.FASTEST**2) * self.flexible
        self.damping = 2.0 * self.damping_ratio * np.sqrt(self.stiffness * reduced)
        self.near_share = np.where(self.flexible, 1.0 - share, 1.0)
        self.far_x = self.far_v = None

    def torque(self, s):
        """What the shaft takes from the near mass, N m; moves the far mass on by one step."""
        x, v = s.x[self.lanes], s.v[self.lanes]
        if self.far_x is None:
            self.far_x, self.far_v = x.copy(), np.zeros_like(x)
            self._past = self.far_v.copy()
        self.far_x += s.step * self.far_v
        far_v = self.far_v + 0.5 * (self.far_v - self._past)
        torque = self.stiffness * (x - self.far_x) + self.damping * (v - far_v)
        self._past = self.far_v
        self.far_v = self.far_v + s.step * torque / self.far_inertia
        return torque


class EncoderEccentricity(Effect):
    """The sensor reads x + a (cos(x - phase) - cos(phase))."""

    hooks = ("sensor",)

    @staticmethod
    def draw(rng, plant, form):
        return {"phase": rng.uniform(0, 2 * np.pi)}

    @staticmethod
    def usual(plant):
        return 2e-3

    def reads(self, x):
        return x + self.amplitude * (np.cos(x - self.phase) - np.cos(self.phase))

    def rates(self, x, v, acceleration):
        """Velocity and acceleration of the reading."""
        angle = x - self.phase
        slope = 1.0 - self.amplitude * np.sin(angle)
        bend = self.amplitude * np.cos(angle)
        return slope * v, slope * acceleration - bend * v * v


class CreepHardening(Effect):
    """A plastic module in series with the law: h' = |x_p'| = alpha (a |F / F_c|^n - h)+.

    Sliding breaks the hardened junctions: at 98 % of F_c the module rests and h is 0.
    """

    hooks = ("slip",)
    # A rigid contact has no displacement that could creep.
    bases = ("maxwell_slip", "hsieh_pan")

    @staticmethod
    def draw(rng, plant, form):
        return {"exponent": rng.uniform(1.6, 2.6), "rate": log_uniform(rng, 0.7, 4.0)}

    @staticmethod
    def usual(plant):
        return 0.1 * plant["presliding"]

    def prepare(self):
        self.hardening = np.zeros_like(self.amplitude)

    def slip(self, s):
        ratio = s.force[self.lanes] / self.setting.coulomb
        size = np.abs(ratio)
        holding = size < 0.98
        excess = np.maximum(self.amplitude * size**self.exponent - self.hardening, 0.0)
        creep = self.rate * s.step * excess * holding
        self.hardening = (self.hardening + creep) * holding
        return np.copysign(creep, ratio)
