"""A mass on Coulomb, Stribeck and viscous friction with true stick, with located events.

    J v' = u + load - F,
    F = sgn(v) (F_c + (F_s - F_c) exp(-|v / v_s|^delta)) + F_v v       v != 0,
    F = u + load                                                      v = 0, |u + load| <= F_s.

Armstrong-Helouvry, Dupont and Canudas de Wit, Automatica 30 (1994); true stick after
Karnopp 1985. Input is constant over each sample; the only events inside a sample are the
zeros of v. A stuck body starts at the edge of a sample whose effort exceeds F_s.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp


@dataclass(frozen=True, kw_only=True)
class CoulombParameters:
    """inertia kg m^2 or kg; coulomb and breakaway N m or N; viscous per unit of velocity."""

    inertia: float
    coulomb: float
    breakaway: float = math.nan  # default: coulomb
    viscous: float = 0.0
    stribeck_velocity: float = 0.01
    stribeck_exponent: float = 2.0

    def __post_init__(self):
        if math.isnan(self.breakaway):
            object.__setattr__(self, "breakaway", self.coulomb)
        if self.breakaway < self.coulomb:
            raise ValueError("breakaway lies at or above coulomb")

    def level(self, speed):
        """Friction without its viscous part at a speed >= 0."""
        fall = math.exp(-((speed / self.stribeck_velocity) ** self.stribeck_exponent))
        return self.coulomb + (self.breakaway - self.coulomb) * fall


def slide(parameters, velocity, effort, direction, duration):
    """Slide in `direction` for `duration` or until v = 0; returns (time, distance, velocity)."""
    p, s = parameters, direction

    def rates(t, y):
        v = s * max(s * y[1], 0.0)
        return (y[1], (effort - s * p.level(abs(v)) - p.viscous * v) / p.inertia)

    def stops(t, y):
        return s * y[1]

    stops.terminal, stops.direction = True, -1
    run = solve_ivp(
        rates, (0.0, duration), (0.0, velocity), "DOP853", events=stops, rtol=1e-11, atol=1e-14
    )
    stopped = run.t_events[0].size > 0
    return float(run.t[-1]), float(run.y[0, -1]), 0.0 if stopped else float(run.y[1, -1])


def slide_closed_form(parameters, velocity, effort, direction, duration):
    """The same for breakaway = coulomb, exactly.

    v(t) = w + (v_0 - w) exp(-t / T), T = J / F_v, w = (u - s F_c) / F_v, or for F_v = 0
    v(t) = v_0 + a t. The slide ends at v = 0 when w and v_0 lie on opposite sides of it.
    """
    p = parameters
    drive = effort - direction * p.coulomb
    if p.viscous == 0.0:
        a = drive / p.inertia
        stop = -velocity / a if a * direction < 0.0 else math.inf
        t = min(duration, stop)
        return t, velocity * t + a * t * t / 2.0, 0.0 if stop <= duration else velocity + a * t
    constant, w = p.inertia / p.viscous, drive / p.viscous
    stop = constant * math.log1p(-velocity / w) if w * direction < 0.0 else math.inf
    t = min(duration, stop)
    part = -math.expm1(-t / constant)
    return (
        t,
        w * t + (velocity - w) * constant * part,
        (0.0 if stop <= duration else velocity + (w - velocity) * part),
    )


def simulate_coulomb(
    effort, sample_time, *, load=0.0, position=0.0, velocity=0.0, slide=slide, **parameters
):
    """Position, velocity and friction at the end of each input sample.

    Parameters
    ----------
    effort, load : array_like, shape (n,)
        u and load, N m or N; row k holds from k * sample_time to (k + 1) * sample_time.
    slide : callable
        `slide` (any Stribeck curve) or `slide_closed_form` (breakaway = coulomb only).

    Returns
    -------
    dict of ndarray
        time, position, velocity, friction. At rest friction is what holds the body under
        the effort of the sample just ended.
    """
    p = CoulombParameters(**parameters)
    effort = np.asarray(effort, dtype=float)
    total = (effort + np.broadcast_to(load, effort.shape)).tolist()
    rows = []
    x, v = position, velocity
    for k, u in enumerate(total):
        left = sample_time
        while left > 0.0:
            if v == 0.0 and abs(u) <= p.breakaway:
                break
            s = math.copysign(1.0, v if v != 0.0 else u)
            used, distance, v = slide(p, v, u, s, left)
            x += distance
            left = left - used if v == 0.0 else 0.0
        s = math.copysign(1.0, v)
        held = min(max(u, -p.breakaway), p.breakaway)
        friction = held if v == 0.0 else s * p.level(abs(v)) + p.viscous * v
        rows.append(((k + 1) * sample_time, x, v, friction))
    time, xs, vs, fs = np.array(rows).T
    return {"time": time, "position": xs, "velocity": vs, "friction": fs}


def pulled_coulomb(speed, spring_stiffness, *, inertia, coulomb, breakaway):
    """Stick-slip of a mass pulled through a spring at constant speed: (slip, stick) in s.

    With no viscous part and no Stribeck flank y = V t - x - F_c / K obeys
    J y'' + K y = 0 from y = A = (F_s - F_c) / K, y' = V. The body stops where y' = V again:
    tan(omega t / 2) = -A omega / V. There y = -A, so the spring has 2 A to make good.
    """
    omega = math.sqrt(spring_stiffness / inertia)
    a = (breakaway - coulomb) / spring_stiffness
    slip = 2.0 * (math.pi - math.atan(a * omega / speed)) / omega
    return slip, 2.0 * a / speed
