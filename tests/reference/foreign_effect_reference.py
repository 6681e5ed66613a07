"""Effects that no library of friction effects has, for testing what a diagnosis says then."""

from __future__ import annotations

import numpy as np

from .effect_reference import Effect, either_sign, log_uniform


class AccelerationFriction(Effect):
    """Level 1 + a tanh(d(v) x''/a_0): more friction while speeding up than slowing."""

    hooks = ("share",)
    FILTER = 5e-3  # s

    @staticmethod
    def draw(rng, plant, form):
        scale = plant["coulomb"] / plant["inertia"]
        return {"sign": either_sign(rng), "scale": scale * rng.uniform(0.2, 0.8)}

    def prepare(self):
        self.filtered = np.zeros_like(self.amplitude)

    def share(self, s):
        lag = s.acceleration[self.lanes] - self.filtered
        self.filtered += lag * (s.step / self.FILTER)
        v = s.v[self.lanes]
        direction = v / np.sqrt(v * v + 1e-4)
        return self.amplitude * np.tanh(direction * self.filtered / self.scale)


class StickPatch(Effect):
    """Level 1 + a exp(-(angle to the patch / width)² / 2), one patch in a turn."""

    hooks = ("share",)

    @staticmethod
    def draw(rng, plant, form):
        return {"place": rng.uniform(-np.pi, np.pi), "width": rng.uniform(0.08, 0.3)}

    @staticmethod
    def usual(plant):
        return 0.04

    def share(self, s):
        away = s.x[self.lanes] - self.place
        # 2 (1 - cos) is the square of the angle nearby and periodic.
        return self.amplitude * np.exp((np.cos(away) - 1.0) / self.width**2)


class TorqueBursts(Effect):
    """Half-sine bursts of torque of either sign at random times on the session clock."""

    hooks = ("effort",)
    HORIZON = 4000.0  # s

    @staticmethod
    def draw(rng, plant, form):
        gap, now, times = log_uniform(rng, 0.7, 2.5), 0.0, []
        while now < TorqueBursts.HORIZON:
            now += 0.2 + rng.exponential(gap)
            times.append(now)
        count = len(times)
        return {
            "times": np.array(times),
            "lengths": rng.uniform(0.04, 0.15, count),
            "sizes": rng.choice([-1.0, 1.0], count) * rng.uniform(0.5, 1.0, count),
        }

    @staticmethod
    def usual(plant):
        return 0.04 * plant["coulomb"]

    def effort(self, s):
        clock = s.clock[self.lanes]
        if s.n == 0:
            self._now = [
                max(int(np.searchsorted(t, c)) - 1, 0)
                for t, c in zip(self.times, clock, strict=True)
            ]
            self._load()
        late = np.flatnonzero(clock >= self._next)
        if late.size:
            for i in late:
                self._now[i] += 1
            self._load()
        phase = np.clip((clock - self._begin) / self._length, 0.0, 1.0)
        return self.amplitude * self._size * np.sin(np.pi * phase)

    def _load(self):
        at = list(enumerate(self._now))
        self._begin = np.array([self.times[i][j] for i, j in at])
        self._next = np.array([self.times[i][j + 1] for i, j in at])
        self._length = np.array([self.lengths[i][j] for i, j in at])
        self._size = np.array([self.sizes[i][j] for i, j in at])


class HalfTurnAsymmetry(Effect):
    """Level 1 + a d(v) on one half of a turn and 1 - a d(v) on the other."""

    hooks = ("share",)

    @staticmethod
    def draw(rng, plant, form):
        return {"phase": rng.uniform(0, 2 * np.pi)}

    def share(self, s):
        v = s.v[self.lanes]
        half = np.tanh(np.sin(s.x[self.lanes] - self.phase) / 0.1)
        return self.amplitude * half * v / np.sqrt(v * v + 1e-4)


class RootSpeedDrag(Effect):
    """Effort -a sgn(v) sqrt(|v| / v_r), rounded below a hundredth of v_r."""

    hooks = ("effort",)

    @staticmethod
    def draw(rng, plant, form):
        return {"speed": log_uniform(rng, 1.0, 5.0)}

    @staticmethod
    def usual(plant):
        return 0.015 * plant["coulomb"]

    def effort(self, s):
        ratio = s.v[self.lanes] / self.speed
        size = np.abs(ratio)
        return -self.amplitude * ratio / np.sqrt(size + 0.01)


class WanderingBias(Effect):
    """Torque that wanders over the session: the spectrum of a random walk between two corners."""

    hooks = ("effort",)

    @staticmethod
    def draw(rng, plant, form):
        frequencies = np.geomspace(0.004, 0.5, 20) * np.exp(rng.uniform(-0.1, 0.1, 20))
        # Power falls with 1/f² on a logarithmic grid: amplitudes with 1/sqrt(f).
        sizes = rng.normal(0.0, 1.0, 20) / np.sqrt(frequencies)
        return {
            "frequencies": frequencies,
            "sizes": sizes / np.sqrt(0.5 * np.sum(sizes**2)),
            "phases": rng.uniform(0, 2 * np.pi, 20),
        }

    @staticmethod
    def usual(plant):
        return 0.01 * plant["coulomb"]

    def effort(self, s):
        if s.n == 0:
            self._omega = 2.0 * np.pi * np.column_stack(self.frequencies)
            self._sizes, self._phases = np.column_stack(self.sizes), np.column_stack(self.phases)
        if s.n % s.substeps == 0:
            angle = self._omega * s.clock[self.lanes] + self._phases
            self._now = self.amplitude * (self._sizes * np.sin(angle)).sum(axis=0)
        return self._now


class MainsRipple(Effect):
    """Torque a sin(2 pi 50 Hz t + phase) on the session clock."""

    hooks = ("effort",)

    @staticmethod
    def draw(rng, plant, form):
        return {"phase": rng.uniform(0, 2 * np.pi), "frequency": 50.0}

    @staticmethod
    def usual(plant):
        return 0.014 * plant["coulomb"]

    def effort(self, s):
        angle = 2.0 * np.pi * self.frequency * s.clock[self.lanes] + self.phase
        return self.amplitude * np.sin(angle)
