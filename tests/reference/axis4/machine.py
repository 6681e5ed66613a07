"""A single axis with dry friction, written from the interface's description alone.

Nothing of stiction is imported, and none of its equations was read. Two bodies at most: the
motor's, which carries the encoder and the dry friction, and a load behind a shaft with play.

    J_m w' = T(u) - F_dry - (F_v + F_q|w|) w - ripple(x) - load(x) - bias - shaft
    J_l w_l' = shaft - c_l w_l

A step of h is the midpoint rule in the speed, implicit in the viscous terms. A rigid contact is
solved at the level of the impulse: where the speed would change its sign inside a step, the step
ends there, the speed is exactly zero, and the rest of the step begins from rest, where the contact
holds whatever is below its level. A compliant contact (Dahl, LuGre) has a bristle on the staggered
grid, updated exactly for a speed held over h. SI units throughout.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

PIECES = 4
"""Of one step at most: it is cut at a stop, and perhaps once more."""
ALL = 1e-12
"""Share of a step that counts as nothing."""
SATURATED = 0.05
"""A bristle slides where it takes up less than this share of the speed."""


@dataclass
class Machine:
    """What the axis is. Effects at their neutral value do nothing."""

    inertia: float
    coulomb: float
    viscous: float
    contact: str = "rigid"  # or "dahl" or "lugre"
    bristle: float = 0.0  # stiffness of the compliant contact
    bristle_damping: float = 0.0
    gain: float = 1.0  # effort per unit of input
    # friction
    stribeck: float = 0.0  # level above coulomb at rest
    stribeck_speed: float = 1.0
    asymmetry: float = 0.0  # share of coulomb, added forwards and taken backwards
    quadratic: float = 0.0
    load_share: float = 0.0  # friction per unit of the motor's effort
    patch: float = 0.0  # share of coulomb that varies with the position
    patch_wave: float = 1.0  # rad per unit of position
    patch_phase: float = 0.0
    warm: float = 0.0  # share of coulomb that goes as the machine warms
    warm_time: float = 10.0
    # loads
    ripple: tuple[
        tuple[float, float, float], ...
    ] = ()  # (amplitude, rad per unit of position, phase)
    bias: float = 0.0
    gravity: float = 0.0
    gravity_zero: float = 0.0
    spring: float = 0.0
    # drive, in units of effort
    limit: float = math.inf
    dead_band: float = 0.0
    lag: float = 0.0
    weakening: float = 0.0  # share of the gain that is lost at `weakening_at`
    weakening_at: float = 1.0
    # transmission
    load_inertia: float = 0.0  # part of a second body; the motor then has inertia - load_inertia
    shaft: float = 0.0
    shaft_damping: float = 0.0
    play: float = 0.0  # whole gap
    load_viscous: float = 0.0


@dataclass
class Loop:
    """A cascade: the error of the position times `position` is a speed, whose error goes to a PI.

    The speed is a difference of readings, filtered; the integral waits while the output is cut.
    """

    kind: str  # "velocity" or "position"
    proportional: float
    integral: float
    position: float
    filter_s: float
    limit: float


@dataclass
class Motion:
    """States at the samples, and what went on from each of them to the next."""

    time: np.ndarray
    position: np.ndarray
    speed: np.ndarray
    command: np.ndarray  # effort commanded
    direction: np.ndarray  # mean sign of the speed over the interval
    sliding: np.ndarray  # the contact slid one way through the whole interval
    energy: dict[str, float] = field(default_factory=dict)


def simulate(
    m: Machine,
    drive: np.ndarray,
    dt: float,
    *,
    loop: Loop | None = None,
    count: float = 0.0,
    step: float = 2e-4,
    start: tuple[float, float] = (0.0, 0.0),
    clock: float = 0.0,
) -> Motion:
    """Runs the axis: `drive` is the effort held from each sample, or with a loop the reference."""
    n = len(drive)
    subs = max(1, math.ceil(dt / step - 1e-9))
    h = dt / subs
    axis, amplifier = _Axis(m, start), _Amplifier(m, h)
    control = _Control(loop, drive, dt, count) if loop else None
    pos, vel, com, direction = np.empty((4, n))
    sliding = np.zeros(n, bool)
    for k in range(n):
        pos[k], vel[k] = axis.x, axis.w
        com[k] = control.command(k, axis.x) if control else float(drive[k])
        target = amplifier.delivered(com[k])
        axis.forward, axis.whole = 0.0, True
        for i in range(subs):
            axis.advance(amplifier.effort(target), clock + k * dt + i * h, h)
        direction[k] = axis.forward / dt
        sliding[k] = axis.whole and abs(abs(axis.forward) / dt - 1.0) < 1e-9
    return Motion(np.arange(n) * dt, pos, vel, com, direction, sliding, axis.balance(start[1]))


class _Amplifier:
    """From a commanded effort to the one that acts."""

    def __init__(self, m: Machine, h: float) -> None:
        self.m, self.now = m, 0.0
        self.keep = math.exp(-h / m.lag) if m.lag else 0.0

    def delivered(self, command: float) -> float:
        """What it settles to."""
        m, u = self.m, float(command)
        if m.dead_band:
            u = math.copysign(max(abs(u) - m.dead_band, 0.0), u)
        if m.weakening:
            u *= 1.0 - m.weakening * min((u / m.weakening_at) ** 2, 1.0)
        return min(max(u, -m.limit), m.limit)

    def effort(self, target: float) -> float:
        """Mean over the next step."""
        if not self.keep:
            return target
        after = target + (self.now - target) * self.keep
        mean, self.now = 0.5 * (self.now + after), after
        return mean


class _Control:
    """The loop, once a sample."""

    def __init__(self, loop: Loop, reference: np.ndarray, dt: float, count: float) -> None:
        self.loop, self.reference, self.dt, self.count = loop, reference.tolist(), dt, count
        self.share = 1.0 - math.exp(-dt / loop.filter_s)
        self.before: float | None = None
        self.speed = self.integral = 0.0

    def command(self, k: int, x: float) -> float:
        loop, dt = self.loop, self.dt
        seen = math.floor(x / self.count) * self.count if self.count else x
        before = seen if self.before is None else self.before
        self.speed += self.share * ((seen - before) / dt - self.speed)
        self.before = seen
        wanted = self.reference[k]
        if loop.kind == "position":
            ahead = (self.reference[min(k + 1, len(self.reference) - 1)] - wanted) / dt
            wanted = loop.position * (wanted - seen) + ahead
        error = wanted - self.speed
        command = loop.proportional * error + self.integral
        if abs(command) < loop.limit:
            self.integral += loop.integral * error * dt
        return min(max(command, -loop.limit), loop.limit)


class _Axis:
    """State of the machine, and what went through it."""

    def __init__(self, m: Machine, start: tuple[float, float]) -> None:
        self.m = m
        self.x, self.w = float(start[0]), float(start[1])
        self.xl, self.wl, self.z = self.x, self.w, 0.0
        self.two = m.load_inertia > 0.0
        self.jm = m.inertia - m.load_inertia if self.two else m.inertia
        self.rigid = m.contact == "rigid"
        self.damping = m.bristle_damping if m.contact == "lugre" else 0.0
        self.varies = bool(m.stribeck or m.load_share or m.patch or m.warm)
        self.placed = bool(m.ripple or m.gravity or m.spring)
        self.work = self.dry = self.viscous = self.forward = self.slope = 0.0
        self.whole = True

    def balance(self, speed: float) -> dict[str, float]:
        """Energies at the end, and the kinetic one at the start."""
        return {
            "work": self.work,
            "dry": self.dry,
            "viscous": self.viscous,
            "kinetic": 0.5 * self.jm * self.w**2 + 0.5 * self.m.load_inertia * self.wl**2,
            "start": 0.5 * self.m.inertia * speed**2,
        }

    def advance(self, u: float, now: float, step: float) -> None:
        """One step under an effort, in pieces where the speed changes its sign."""
        left = step
        for _ in range(PIECES):
            left -= self._piece(u, now, left)
            if left <= ALL * step:
                return

    def _piece(self, u: float, now: float, h: float) -> float:
        """As much of h as goes one way; returns how much."""
        xm = self.x + 0.5 * h * self.w
        t = u - self.m.bias
        if self.placed:
            t -= self._at_place(xm)
        shaft = self._shaft(xm, h) if self.two else 0.0
        t -= shaft
        c = self.m.viscous
        if self.m.quadratic:
            # At the middle of the step, as far as the last one tells.
            c += self.m.quadratic * abs(self.w + 0.5 * h * self.slope)
        if self.rigid:
            s, w1, dry, h = self._rigid(t, c, xm, u, now, h)
        else:
            s, w1, dry = self._bristle(t, c, xm, u, now, h)
        if self.w != 0.0 or w1 != 0.0:
            mean = 0.5 * (self.w + w1)
            self.work += (t + shaft) * mean * h
            self.dry += dry * mean * h
            self.viscous += c * mean * mean * h
            self.forward += s * h
            self.x += mean * h
            self.slope = (w1 - self.w) / h
            self.w = w1
        if self.two:
            self._load(shaft, h)
        return h

    def _rigid(
        self, t: float, c: float, xm: float, u: float, now: float, h: float
    ) -> tuple[float, float, float, float]:
        """Direction, speed at the end, dry friction, and where the step is cut."""
        w = self.w
        s = (1.0 if t > 0.0 else -1.0) if w == 0.0 else (1.0 if w > 0.0 else -1.0)
        f = self._level(xm, w, s, u, now)
        if w == 0.0 and abs(t) <= f:
            self.whole = False
            return s, 0.0, t, h
        w1 = ((self.jm - 0.5 * h * c) * w + h * (t - s * f)) / (self.jm + 0.5 * h * c)
        if w != 0.0 and w1 * s <= 0.0:
            self.whole = False
            return s, 0.0, s * f, h * (w / (w - w1))
        return s, w1, s * f, h

    def _bristle(
        self, t: float, c: float, xm: float, u: float, now: float, h: float
    ) -> tuple[float, float, float]:
        """Direction, speed at the end, and what the bristle holds."""
        w, s0, s1 = self.w, self.m.bristle, self.damping
        s = 1.0 if w >= 0.0 else -1.0
        g = self._level(xm, w, s, u, now) / s0
        end = s * g
        self.z = end + (self.z - end) * math.exp(-abs(w) * h / g)
        slip = min(max(1.0 - s * self.z / g, 0.0), 2.0)
        if slip > SATURATED:
            self.whole = False
        c1 = c + s1 * slip
        w1 = ((self.jm - 0.5 * h * c1) * w + h * (t - s0 * self.z)) / (self.jm + 0.5 * h * c1)
        return s, w1, s0 * self.z + s1 * slip * 0.5 * (w + w1)

    def _level(self, at: float, speed: float, sign: float, u: float, now: float) -> float:
        """Height of the dry friction."""
        m = self.m
        f = m.coulomb * (1.0 + m.asymmetry * sign)
        if not self.varies:
            return f
        if m.patch:
            f += m.coulomb * m.patch * math.sin(m.patch_wave * at + m.patch_phase)
        if m.warm:
            f += m.coulomb * m.warm * math.exp(-now / m.warm_time)
        if m.stribeck:
            f += m.stribeck * math.exp(-((speed / m.stribeck_speed) ** 2))
        if m.load_share:
            f += m.load_share * abs(u)
        return f

    def _at_place(self, xm: float) -> float:
        """What resists for where the axis is."""
        m, t = self.m, 0.0
        for a, wave, phase in m.ripple:
            t += a * math.sin(wave * xm + phase)
        if m.gravity:
            t += m.gravity * math.sin(xm - m.gravity_zero)
        return t + m.spring * xm if m.spring else t

    def _shaft(self, xm: float, h: float) -> float:
        """What the shaft takes from the motor; it pushes and never pulls across the gap."""
        m, half = self.m, 0.5 * self.m.play
        wind = xm - (self.xl + 0.5 * h * self.wl)
        damped = m.shaft_damping * (self.w - self.wl)
        if wind > half:
            return max(m.shaft * (wind - half) + damped, 0.0)
        if wind < -half:
            return min(m.shaft * (wind + half) + damped, 0.0)
        return 0.0

    def _load(self, shaft: float, h: float) -> None:
        m = self.m
        c, j = 0.5 * h * m.load_viscous, m.load_inertia
        w1 = ((j - c) * self.wl + h * shaft) / (j + c)
        self.xl += 0.5 * h * (self.wl + w1)
        self.wl = w1


def share(m: Machine, runs: list[Motion], dt: float, late: float = 0.0) -> tuple[float, float]:
    """What the plain machine leaves of the commanded effort along the logged motion.

    The rms over the intervals that slide one way throughout, as a share of coulomb: with its true
    inertia, coulomb and viscous, and after these three were fitted to the same.
    """
    rests, columns = [], []
    for run in runs:
        x, w, s = run.position, run.speed, run.direction[:-1]
        use = run.sliding[:-1]
        if late:
            x, w = np.interp(run.time - late, run.time, x), np.interp(run.time - late, run.time, w)
            s = np.sign(w[:-1])
            use = use & (s == np.sign(w[1:])) & (s != 0)
        own = np.stack([np.diff(w) / dt, s, np.diff(x) / dt], axis=1)[use]
        columns.append(own)
        rests.append(run.command[:-1][use] - own @ [m.inertia, m.coulomb, m.viscous])
    rest, base = np.concatenate(rests), np.concatenate(columns)
    if len(rest) < 20:
        return 0.0, 0.0
    fitted = rest - base @ np.linalg.lstsq(base, rest, rcond=None)[0]
    return float(np.sqrt(np.mean(rest**2)) / m.coulomb), float(
        np.sqrt(np.mean(fitted**2)) / m.coulomb
    )
