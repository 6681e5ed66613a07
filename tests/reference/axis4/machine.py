"""A single axis with dry friction, written from the interface's description alone: it imports nothing of stiction.

Two bodies at most: the motor's, which carries the encoder and the dry friction, and a load behind a shaft with play.

    J_m w' = T(u) - F_dry - (F_v + F_q|w|) w - ripple(x) - load(x) - bias - shaft
    J_l w_l' = shaft - c_l w_l

A step of h is the midpoint rule in the speed, implicit in the viscous terms. A rigid contact is solved at the level of the
impulse: where the speed would change its sign inside a step, the step ends there, the speed is exactly zero, and the rest
of the step begins from rest, where the contact holds whatever is below its level. A compliant contact (Dahl, LuGre) has a
bristle on the staggered grid, updated exactly for a speed held over h. SI units throughout.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np


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
    ripple: tuple[tuple[float, float, float], ...] = ()  # (amplitude, rad per unit of position, phase)
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
    """A cascade: position error times `position` is a speed, its error goes through a PI; speed by a filtered difference."""

    kind: str  # "velocity" or "position"
    proportional: float
    integral: float
    position: float
    filter_s: float
    limit: float


@dataclass
class Motion:
    """States at the samples, what was commanded from each sample to the next, and the balance over each interval."""

    time: np.ndarray
    position: np.ndarray
    speed: np.ndarray
    command: np.ndarray  # effort commanded
    direction: np.ndarray  # mean sign of the speed over the interval
    sliding: np.ndarray  # the contact slid one way through the whole interval
    energy: dict[str, float] = field(default_factory=dict)
    fine: tuple[np.ndarray, np.ndarray] | None = None


def delivered(m: Machine, command: float) -> float:
    """The effort that the drive settles to for a commanded one."""
    u = command
    if m.dead_band:
        u = math.copysign(max(abs(u) - m.dead_band, 0.0), u)
    if m.weakening:
        u *= 1.0 - m.weakening * min((u / m.weakening_at) ** 2, 1.0)
    return min(max(u, -m.limit), m.limit)


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
    fine: bool = False,
) -> Motion:
    """Runs the axis: `drive` is the effort held from each sample (no loop) or the reference (loop)."""
    n = len(drive)
    subs = max(1, math.ceil(dt / step - 1e-9))
    h0 = dt / subs
    two = m.load_inertia > 0.0
    jm = m.inertia - m.load_inertia if two else m.inertia
    jl, ks, cs, half, cl = m.load_inertia, m.shaft, m.shaft_damping, m.play / 2.0, m.load_viscous
    rigid = m.contact == "rigid"
    s0 = m.bristle
    s1 = m.bristle_damping if m.contact == "lugre" else 0.0
    x, w = float(start[0]), float(start[1])
    xl, wl = x, w
    z = 0.0
    effort = 0.0
    lagging = m.lag > 0.0
    keep = math.exp(-h0 / m.lag) if lagging else 0.0
    sin, exp, fabs = math.sin, math.exp, math.fabs
    level_varies = m.stribeck or m.load_share or m.patch or m.warm
    fc, fv, fq = m.coulomb, m.viscous, m.quadratic
    fields = bool(m.ripple or m.gravity or m.spring)
    work = lost_dry = lost_viscous = 0.0
    pos, vel, com = np.empty(n), np.empty(n), np.empty(n)
    direction, sliding = np.zeros(n), np.zeros(n, bool)
    fx: list[float] = []
    fw: list[float] = []
    # the loop
    seen_before = None
    speed_seen = 0.0
    integral = 0.0
    a_filter = 1.0 - exp(-dt / loop.filter_s) if loop else 0.0

    def level(at: float, speed: float, sign: float, u: float, now: float) -> float:
        f = fc * (1.0 + m.asymmetry * sign)
        if level_varies:
            if m.patch:
                f += fc * m.patch * sin(m.patch_wave * at + m.patch_phase)
            if m.warm:
                f += fc * m.warm * exp(-now / m.warm_time)
            if m.stribeck:
                f += m.stribeck * exp(-((speed / m.stribeck_speed) ** 2))
            if m.load_share:
                f += m.load_share * fabs(u)
        return f

    for k in range(n):
        pos[k], vel[k] = x, w
        if loop is None:
            command = float(drive[k])
        else:
            seen = math.floor(x / count) * count if count else x
            if seen_before is None:
                seen_before = seen
            speed_seen += a_filter * ((seen - seen_before) / dt - speed_seen)
            seen_before = seen
            ref = float(drive[k])
            if loop.kind == "position":
                ahead = (float(drive[min(k + 1, n - 1)]) - ref) / dt
                ref = loop.position * (ref - seen) + ahead
            error = ref - speed_seen
            command = loop.proportional * error + integral
            if fabs(command) < loop.limit:
                integral += loop.integral * error * dt
            command = min(max(command, -loop.limit), loop.limit)
        com[k] = command
        target = delivered(m, command)
        forward = 0.0
        whole = True
        for i in range(subs):
            if lagging:
                after = target + (effort - target) * keep
                u = 0.5 * (effort + after)
                effort = after
            else:
                u = effort = target
            left = h0
            now = clock + k * dt + i * h0
            for _ in range(4):  # a step is cut at most at a stop and once more
                h = left
                xm = x + 0.5 * h * w
                t = u - m.bias
                if fields:
                    for a, wave, phase in m.ripple:
                        t -= a * sin(wave * xm + phase)
                    if m.gravity:
                        t -= m.gravity * sin(xm - m.gravity_zero)
                    if m.spring:
                        t -= m.spring * xm
                shaft = 0.0
                if two:
                    wind = xm - (xl + 0.5 * h * wl)
                    if wind > half:
                        shaft = max(ks * (wind - half) + cs * (w - wl), 0.0)
                    elif wind < -half:
                        shaft = min(ks * (wind + half) + cs * (w - wl), 0.0)
                    t -= shaft
                c = fv + fq * fabs(w)
                if rigid:
                    if w == 0.0:
                        s = 1.0 if t > 0.0 else -1.0
                        f = level(xm, 0.0, s, u, now)
                        if fabs(t) <= f:
                            whole = False
                            if two:
                                xl, wl = x_load(xl, wl, shaft, cl, jl, h)
                            break
                    else:
                        s = 1.0 if w > 0.0 else -1.0
                        f = level(xm, w, s, u, now)
                    w1 = ((jm - 0.5 * h * c) * w + h * (t - s * f)) / (jm + 0.5 * h * c)
                    if w != 0.0 and w1 * s <= 0.0:
                        h *= w / (w - w1)
                        w1 = 0.0
                        whole = False
                    dry = s * f
                else:
                    s = 1.0 if w >= 0.0 else -1.0
                    g = level(xm, w, s, u, now) / s0
                    end = s * g
                    z = end + (z - end) * exp(-fabs(w) * h / g)
                    slip = min(max(1.0 - s * z / g, 0.0), 2.0)
                    if slip > 0.05:
                        whole = False
                    c1 = c + s1 * slip
                    w1 = ((jm - 0.5 * h * c1) * w + h * (t - s0 * z)) / (jm + 0.5 * h * c1)
                    dry = s0 * z + s1 * slip * 0.5 * (w + w1)
                mean = 0.5 * (w + w1)
                work += (t + shaft) * mean * h
                lost_dry += dry * mean * h
                lost_viscous += c * mean * mean * h
                forward += s * h
                x += mean * h
                w = w1
                if two:
                    xl, wl = x_load(xl, wl, shaft, cl, jl, h)
                left -= h
                if left <= 1e-12 * h0:
                    break
            if fine:
                fx.append(x)
                fw.append(w)
        direction[k] = forward / dt
        sliding[k] = whole and fabs(fabs(forward) / dt - 1.0) < 1e-9
    energy = {
        "work": work,
        "dry": lost_dry,
        "viscous": lost_viscous,
        "kinetic": 0.5 * jm * w * w + 0.5 * jl * wl * wl,
        "start": 0.5 * m.inertia * start[1] ** 2,
    }
    return Motion(
        np.arange(n) * dt, pos, vel, com, direction, sliding, energy, (np.array(fx), np.array(fw)) if fine else None
    )


def x_load(xl: float, wl: float, shaft: float, cl: float, jl: float, h: float) -> tuple[float, float]:
    w1 = ((jl - 0.5 * h * cl) * wl + h * shaft) / (jl + 0.5 * h * cl)
    return xl + 0.5 * h * (wl + w1), w1


def share(m: Machine, runs: list[Motion], dt: float, late: float = 0.0) -> tuple[float, float]:
    """What the plain machine (inertia, coulomb, viscous) leaves of the commanded effort along the logged motion, rms as a
    share of coulomb over the intervals that slide one way throughout; and the same after its three numbers are fitted."""
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
    return float(np.sqrt(np.mean(rest**2)) / m.coulomb), float(np.sqrt(np.mean(fitted**2)) / m.coulomb)
