"""Effects of contacts that know more than their state of now: reverse points, heat, load, gaps.

They keep the conventions of `effect_reference`.
"""

from __future__ import annotations

import numpy as np

from .effect_reference import Effect, log_uniform

# Slip distances over l of elements of one force each.
LADDER = (0.125, 0.25, 0.5, 1.0)


def ladder_curve(ratio):
    """Virgin curve of a few elements."""
    return sum(np.minimum(ratio / slip, 1.0) for slip in LADDER) / len(LADDER)


def exponential_curve(bend):
    """Virgin curve with a constant of `bend` l."""
    return lambda ratio: np.expm1(-ratio / bend) / np.expm1(-1.0 / bend)


class ReversePoints:
    """A hysteresis operator in [-1, 1] that keeps the list of its reverse points (Masing 1926).

    From a reverse point (z, m) a branch follows m ± 2 f(|x - z| / 2), the virgin curve doubled;
    f(d) = curve(d / l) up to d = l and 1 beyond. A branch that comes to the reverse point before
    the last closes a loop: both are wiped out, and the branch that had been left there goes on.
    Sliding at ± 1 drags the origin of the virgin curve along.
    """

    DEPTH = 48  # a loop within as many loops is forgotten

    def __init__(self, length, curve, lanes):
        self.length, self.curve = length, curve
        self.columns = np.arange(lanes)
        self.places = np.zeros((self.DEPTH, lanes))
        self.values = np.zeros((self.DEPTH, lanes))
        self.depth = np.zeros(lanes, dtype=int)
        self.side = np.zeros(lanes)  # of the last move
        self.x, self.origin, self.value = np.zeros(lanes), np.zeros(lanes), np.zeros(lanes)

    def virgin(self, distance):
        return self.curve(np.minimum(distance / self.length, 1.0))

    def move(self, dx):
        """Value after a move."""
        if not dx.any():
            return self.value
        turned = dx * self.side < 0.0
        if turned.any():
            self._keep(np.flatnonzero(turned))
        self.side = np.where(dx != 0.0, np.sign(dx), self.side)
        self.x = self.x + dx
        self._wipe_out()
        beyond = np.maximum(np.abs(self.x - self.origin) - self.length, 0.0)
        self.origin += (self.depth == 0) * self.side * beyond
        away = self.x - self.origin
        start = np.sign(away) * self.virgin(np.abs(away))
        last = np.maximum(self.depth - 1, 0)
        branch = self.virgin(0.5 * np.abs(self.x - self.places[last, self.columns]))
        branch = self.values[last, self.columns] + 2.0 * self.side * branch
        self.value = np.where(self.depth == 0, start, branch)
        return self.value

    def _keep(self, lanes):
        self.depth[lanes[self.depth[lanes] == self.DEPTH]] -= 2
        self.places[self.depth[lanes], lanes] = self.x[lanes]
        self.values[self.depth[lanes], lanes] = self.value[lanes]
        self.depth[lanes] += 1

    def _wipe_out(self):
        while True:
            outer = self.places[np.maximum(self.depth - 2, 0), self.columns]
            # The branch of the first reverse point meets the virgin curve on the other side.
            end = np.where(self.depth > 1, outer, 2.0 * self.origin - self.places[0])
            closed = (self.depth > 0) & ((self.x - end) * self.side >= 0.0)
            if not closed.any():
                return
            self.depth -= closed * np.minimum(self.depth, 2)


class ReversePointMemory(Effect):
    """Dry friction (1 - a) law + a F_c m: part of it yields, and remembers where it turned.

    The virgin curve of m is that of four elements; foreign: an exponential.
    """

    forms = ("library", "foreign")
    hooks = ("share", "effort")
    # What yields has a law of its own already.
    bases = ("coulomb",)
    largest = 0.9

    @staticmethod
    def draw(rng, plant, form):
        shape = {"length": log_uniform(rng, 1e-3, 1e-2)}
        return shape | ({"bend": rng.uniform(0.25, 0.6)} if form == "foreign" else {})

    def prepare(self):
        curve = exponential_curve(self.bend) if hasattr(self, "bend") else ladder_curve
        self.memory = ReversePoints(self.length, curve, self.amplitude.size)

    def effort(self, s):
        return -self.amplitude * self.setting.coulomb * self.memory.move(s.dx[self.lanes])

    def share(self, s):
        return -self.amplitude


class Relaxation(Effect):
    """The contact creeps, without hardening: x_p' = a |F / F_c|^n sgn F while it holds."""

    hooks = ("slip",)
    bases = ("maxwell_slip", "hsieh_pan")

    @staticmethod
    def draw(rng, plant, form):
        return {"exponent": rng.uniform(1.0, 4.0)}

    @staticmethod
    def usual(plant):
        return 0.01 * plant["presliding"]

    def slip(self, s):
        ratio = s.force[self.lanes] / self.setting.coulomb
        size = np.abs(ratio)
        return (size < 0.98) * self.amplitude * s.step * np.copysign(size**self.exponent, ratio)


class TemperatureDependentFriction(Effect):
    """Levels 1 - a (T - 25 °C) of dry and 1 - a b (T - 25 °C) of viscous friction.

    Foreign: both fall as a viscosity does, exponentially in the inverse of the absolute
    temperature, with the slope -a at 25 °C.
    """

    forms = ("library", "foreign")
    hooks = ("share", "viscous_share")
    channel = "temperature"
    MIDDLE = 25.0  # °C
    ZERO = 273.15  # K, of 0 °C
    largest = 0.02

    @staticmethod
    def draw(rng, plant, form):
        shape = {"viscous_part": rng.uniform(0.5, 2.5)}
        if form == "foreign":
            shape["activation"] = rng.uniform(3000.0, 7000.0)  # K
        return shape

    @staticmethod
    def usual(plant):
        return 1.2e-3

    def share(self, s):
        t = s.temperature[self.lanes]
        rise = t - self.MIDDLE
        if hasattr(self, "activation"):
            middle = self.MIDDLE + self.ZERO
            fall = np.expm1(self.activation * (1.0 / (t + self.ZERO) - 1.0 / middle))
            rise = -fall * middle**2 / self.activation
        self._rise = -self.amplitude * rise
        return self._rise

    def viscous_share(self, s):
        return self.viscous_part * self._rise


class LoadDependentFriction(Effect):
    """Dry friction + a c |Q|, c = 1 where the machine drives against the load Q, else `back`.

    Foreign: Q²/F_c in place of |Q|. Around rest the two go over into each other within v_0.
    """

    forms = ("library", "foreign")
    hooks = ("share",)
    channel = "load"

    @staticmethod
    def draw(rng, plant, form):
        return {
            "back": rng.uniform(0.2, 1.6),
            "velocity": log_uniform(rng, 0.005, 0.02),
            "quadratic": float(form == "foreign"),
        }

    @staticmethod
    def usual(plant):
        return 0.015

    def share(self, s):
        load, v = s.load[self.lanes] / self.setting.coulomb, s.v[self.lanes]
        size = np.abs(load)
        against = -np.sign(load) * v / np.sqrt(v * v + self.velocity**2)
        part = 0.5 * (1.0 + self.back + (1.0 - self.back) * against)
        return self.amplitude * part * np.where(self.quadratic, size * size, size)


class Backlash(Effect):
    """The share a of the inertia sits behind a gap, free within it; contact is inelastic.

    Foreign: the contact is elastic and pushes with k y (1 + c y') where it is pressed in by y
    (Hunt and Crossley 1975). The sensor and the friction are on the motor's side.
    """

    forms = ("library", "foreign")
    hooks = ("gap",)
    size_support = 0.02
    largest = 0.9

    @staticmethod
    def draw(rng, plant, form):
        shape = {"gap": log_uniform(rng, 1e-3, 1e-2)}
        if form == "foreign":
            shape["frequency"] = rng.uniform(60.0, 150.0)  # Hz
            shape["damping"] = rng.uniform(1.0, 6.0)  # s/rad
        return shape

    @staticmethod
    def usual(plant):
        return 0.1

    def prepare(self):
        share, inertia = self.amplitude, self.setting.inertia
        self.loose = share > 0.0
        self.far_inertia = share * inertia
        self.near_share = 1.0 - share
        self.edge = 0.5 * self.gap
        self.far_x = None
        if hasattr(self, "frequency"):
            self.hooks = ("shaft",)
            reduced = share * (1.0 - share) * inertia
            self.stiffness = reduced * (2.0 * np.pi * self.frequency) ** 2

    def _begin(self, x):
        self.far_x, self.far_v = x.copy(), np.zeros_like(x)
        self._past = self.far_v

    def meet(self, s, v, mass, momentum):
        """Add the far mass and its momentum (N m) where the gap would be left with the speed v."""
        x, v = s.x[self.lanes], v[self.lanes]
        if self.far_x is None:
            self._begin(x)
        self.far_x = self.far_x + s.step * self.far_v
        apart = x - self.far_x
        after = apart + s.step * (v - self.far_v)
        self._touching = self.loose & (np.abs(after) > self.edge)
        # A difference of speeds that leads to the edge of the gap: what is left of it ends with
        # the next step, so that an impact within a step costs no accuracy.
        self._closing = (np.copysign(self.edge, after) - apart) / s.step
        far = self._touching * self.far_inertia / s.step
        mass[self.lanes] += far
        momentum[self.lanes] += far * (self._closing + self.far_v)
        return self._touching.any()

    def follow(self, s, v):
        """Move the far mass on by one step, to the speed v of the motor where they touch."""
        far_v = np.where(self._touching, v[self.lanes] - self._closing, self.far_v)
        self.load = self.far_inertia * (far_v - self.far_v) / s.step
        self.far_v = far_v

    def torque(self, s):
        """What an elastic contact takes from the near mass, N m; moves the far mass on."""
        x, v = s.x[self.lanes], s.v[self.lanes]
        if self.far_x is None:
            self._begin(x)
        self.far_x = self.far_x + s.step * self.far_v
        apart = x - self.far_x
        far_v = 1.5 * self.far_v - 0.5 * self._past
        side = np.sign(apart)
        pressed = np.maximum(np.abs(apart) - self.edge, 0.0)
        lossy = np.maximum(1.0 + self.damping * side * (v - far_v), 0.0)
        torque = side * self.stiffness * pressed * lossy
        self._past = self.far_v
        far = np.where(self.loose, self.far_inertia, 1.0)
        self.far_v = self.far_v + s.step * torque / far
        return torque
