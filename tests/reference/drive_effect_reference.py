"""Effects of an unbalanced rotor and of drives: what acts is not what was commanded.

They keep the conventions of `effect_reference`. The input is held over a sample, so what depends
on it alone is worked out once for each sample.
"""

from __future__ import annotations

import numpy as np

from .effect_reference import Effect, log_uniform

# rad/s²: up to where the usual sines fade in, whatever the machine.
QUICKEST = 240.0


def largest_input(plant):
    """N m, of the usual experiments."""
    return plant["coulomb"] + plant["inertia"] * QUICKEST


def quick_input(plant):
    """N m, of the quick sines and speed reversals, which a light or a heavy machine has alike."""
    return min(largest_input(plant), 7.0 * plant["coulomb"])


class DriveLoss(Effect):
    """Effort -a loss(u), which is 0 where there is no input."""

    hooks = ("effort",)

    def effort(self, s):
        if s.n % s.substeps == 0:
            self._now = -self.amplitude * self.loss(s.input[self.lanes])
        return self._now


class GravityUnbalance(Effect):
    """Effort a cos(x - phase): an unbalanced rotor about a horizontal axis."""

    hooks = ("effort",)

    @staticmethod
    def draw(rng, plant, form):
        return {"phase": rng.uniform(0, 2 * np.pi)}

    @staticmethod
    def usual(plant):
        return 0.014 * plant["coulomb"]

    def effort(self, s):
        return self.amplitude * np.cos(s.x[self.lanes] - self.phase)


class TorqueConstantSaturation(DriveLoss):
    """Gain 1 - a (u/U)², U the largest usual input; foreign: slope 1 - a beyond a soft knee."""

    forms = ("library", "foreign")
    # Up to a third the torque still grows with the input as far as U.
    largest = 1.0 / 3.0

    @staticmethod
    def draw(rng, plant, form):
        if form == "library":
            return {"reference": largest_input(plant) * rng.uniform(0.8, 1.2)}
        knee = 0.5 * quick_input(plant) * rng.uniform(0.8, 1.2)
        return {"knee": knee, "width": knee * rng.uniform(0.1, 0.3)}

    def loss(self, u):
        if hasattr(self, "reference"):
            return u * (u / self.reference) ** 2
        # The integral of a slope that rises by a tanh from 0 to 1 at the knee, odd in u.
        w, knee = self.width, self.knee
        return u + 0.5 * w * (_log_cosh((u - knee) / w) - _log_cosh((u + knee) / w))


def _log_cosh(z):
    return np.logaddexp(z, -z) - np.log(2.0)


class DriveSaturation(DriveLoss):
    """Nothing of what the input has beyond L gets through: a = 1.

    A part that is lost beyond some input is a torque constant that falls. So a size is reached by
    the limit, unless that is given, however few samples it acts in then. Foreign: the clip rounds
    off, L + w tanh((|u| - L) / w).
    """

    forms = ("library", "foreign")
    largest = 1.0
    reached_by = "limit"

    @staticmethod
    def draw(rng, plant, form):
        # Out of the way of break-away, which takes up to 1.35 F_c.
        low = max(0.5 * quick_input(plant), 1.5 * plant["coulomb"])
        shape = {"limit": low * rng.uniform(1.0, 1.4)}
        if form == "foreign":
            shape["softness"] = rng.uniform(0.2, 0.4)
        return shape

    @staticmethod
    def usual(plant):
        return 0.05

    @staticmethod
    def value_for(size, inputs, velocities, shape):
        """The limit beyond which inputs have an rms of `size`, N m."""
        inputs = np.abs(inputs)

        def lost(limit):
            return _beyond(inputs, limit, shape.get("softness"))

        return _limit_losing(size, lost, float(inputs.max()))

    def loss(self, u):
        return np.copysign(_beyond(np.abs(u), self.limit, getattr(self, "softness", None)), u)


def _limit_losing(size, lost, highest):
    """The limit at which what is lost has an rms of `size`, N m; that falls with the limit."""
    low, high = 0.0, highest
    for _ in range(60):
        limit = 0.5 * (low + high)
        if np.sqrt(np.mean(lost(limit) ** 2)) > size:
            low = limit
        else:
            high = limit
    return high


def _beyond(size, limit, softness):
    """What a clip takes of an input of this size; it rounds off over softness times the limit."""
    beyond = np.maximum(size - limit, 0.0)
    if softness is None:
        return beyond
    width = softness * limit
    return beyond - width * np.tanh(beyond / np.maximum(width, 1e-300))


class BackEmf(Effect):
    """Effort -a |u| v: a bridge that coasts in its off-time, 1/a is the no-load speed.

    Foreign: from an input K on the current does not die out in the off-time any more, and what is
    lost grows no further with the input, -a K v.
    """

    forms = ("library", "foreign")
    hooks = ("effort",)
    FASTEST = 15.0  # rad/s
    largest = 1.0 / FASTEST

    @staticmethod
    def draw(rng, plant, form):
        if form == "library":
            return {}
        return {"knee": 0.4 * quick_input(plant) * rng.uniform(0.8, 1.2)}

    @staticmethod
    def usual(plant):
        return 2e-3

    def effort(self, s):
        size, v = np.abs(s.input[self.lanes]), s.v[self.lanes]
        if hasattr(self, "knee"):
            size = np.minimum(size, self.knee)
        return -self.amplitude * size * v


class VoltageLimit(Effect):
    """A current loop reaches u only as far as L (1 - sgn(u) v / v_0); nothing beyond gets through.

    As of a limit at any speed, a size is reached by L, unless that is given. Foreign: the corner
    rounds off, R + w tanh((|u| - R) / w) with R what is reached.
    """

    forms = ("library", "foreign")
    hooks = ("effort",)
    largest = 1.0
    reached_by = "limit"

    @staticmethod
    def draw(rng, plant, form):
        shape = {
            "limit": plant["coulomb"] * rng.uniform(2.0, 3.5),
            "no_load": rng.uniform(1.0, 1.3) * BackEmf.FASTEST,
        }
        if form == "foreign":
            shape["width"] = shape["limit"] * rng.uniform(0.2, 0.4)
        return shape

    @staticmethod
    def usual(plant):
        return 0.05

    @staticmethod
    def value_for(size, inputs, velocities, shape):
        """The limit beyond which inputs have an rms of `size`, N m."""

        def lost(limit):
            return _out_of_reach(inputs, velocities, limit, shape["no_load"], shape.get("width"))

        return _limit_losing(size, lost, 10.0 * float(np.abs(inputs).max()))

    def effort(self, s):
        u, v = s.input[self.lanes], s.v[self.lanes]
        width = getattr(self, "width", None)
        lost = _out_of_reach(u, v, self.limit, self.no_load, width)
        return -self.amplitude * np.copysign(lost, u)


def _out_of_reach(u, v, limit, no_load, width):
    """What a current loop lacks of inputs at speed; the corner rounds off over the width."""
    reach = np.maximum(limit * (1.0 - np.sign(u) * v / no_load), 0.0)
    beyond = np.maximum(np.abs(u) - reach, 0.0)
    return beyond if width is None else beyond - width * np.tanh(beyond / width)


class CurrentLoopLag(Effect):
    """The input acts through a first-order lag of time a, exact for an input that is held.

    Foreign: two lags of half the time in a row, which is critically damped and as late.
    """

    forms = ("library", "foreign")
    hooks = ("effort",)

    @staticmethod
    def draw(rng, plant, form):
        return {"lags": 1.0 if form == "library" else 2.0}

    @staticmethod
    def usual(plant):
        return 1e-3

    def prepare(self):
        self.first = np.zeros_like(self.amplitude)
        self.second = np.zeros_like(self.amplitude)
        self._decay = None

    def effort(self, s):
        if self._decay is None:
            self._times(s.step)
        u, ratio, decay, mean = s.input[self.lanes], self._ratio, self._decay, self._mean
        # Distances from the input: they decay, and their mean over the step is what is lacking.
        first, second = self.first - u, self.second - u
        lacking = np.where(self.lags == 1.0, mean * first, mean * second + (mean - decay) * first)
        self.second = u + (second + ratio * first) * decay
        self.first = u + first * decay
        return np.where(self.amplitude > 0.0, lacking, 0.0)

    def _times(self, step):
        """Step over time of one lag, its decay in the step, and the mean of the decay."""
        time = np.where(self.amplitude > 0.0, self.amplitude / self.lags, step)
        self._ratio = step / time
        self._decay = np.exp(-self._ratio)
        self._mean = -np.expm1(-self._ratio) / self._ratio


class FrictionalLag(Effect):
    """Level 1 + a (g(v_f) - (1 - fall) g(v)), g(v) = exp(-(v/v_s)²), v_f' = (v - v_f) / T.

    Friction that falls with speed does so late; hidden is the lag alone, or the fall with it.
    Foreign: v_f is v of the time T before.
    """

    forms = ("library", "foreign")
    hooks = ("share",)
    # Beyond 1 a contact could drive the body.
    largest = 0.9

    @staticmethod
    def draw(rng, plant, form):
        return {
            "velocity": log_uniform(rng, 0.1, 1.0),
            "time": log_uniform(rng, 5e-3, 5e-2),
            "pure": float(form == "foreign"),
            "fall": float(rng.integers(2)),
        }

    @staticmethod
    def usual(plant):
        return 0.05

    def prepare(self):
        self.late = np.zeros_like(self.amplitude)
        self._before = np.zeros_like(self.amplitude)
        self._past = None

    def share(self, s):
        v = s.v[self.lanes]
        late = self._delayed(s, v) if np.all(self.pure) else self._filtered(s, v)
        now, then = (np.exp(-((w / self.velocity) ** 2)) for w in (v, late))
        return self.amplitude * (then - (1.0 - self.fall) * now)

    def _filtered(self, s, v):
        half = 0.5 * s.step / self.time
        self.late += 2.0 * half / (1.0 + half) * (0.5 * (self._before + v) - self.late)
        self._before = v
        return self.late

    def _delayed(self, s, v):
        """Speed of the time T before, from a ring of as many steps as the longest one takes."""
        if self._past is None:
            late = self.time / s.step
            self._whole = np.floor(late).astype(int)
            self._part = late - self._whole
            self._past = np.zeros((int(self._whole.max()) + 2, v.size))
            self._columns = np.arange(v.size)
        rows = len(self._past)
        self._past[s.n % rows] = v
        newer = self._past[(s.n - self._whole) % rows, self._columns]
        older = self._past[(s.n - self._whole - 1) % rows, self._columns]
        return (1.0 - self._part) * newer + self._part * older
