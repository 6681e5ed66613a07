"""Machines drawn at random, and the experiments of a session on them.

Every experiment returns an `Excitation`: what is commanded at each millisecond, as a torque
(open loop) or as a reference for the controller (closed loop). Torques are shares of the
friction level that a person in front of the machine would have found with a slow ramp.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .contact_reference import branch_curve
from .effect_reference import either_sign, log_uniform

KINDS = ("tracking", "ramps", "dwell", "pulses", "presliding", "sines")
BASES = ("maxwell_slip", "hsieh_pan", "coulomb")


@dataclass
class Excitation:
    """One experiment; the reference is None in open loop."""

    torque: np.ndarray  # N m
    reference: np.ndarray | None  # rad, from the start position


# --- machines


def draw_plant(base, rng, elements=None, one_curve=False):
    """True parameters of one machine, SI units.

    `elements` of its ladder are 14, or 28 of hsieh_pan; `one_curve` is for maxwell_slip alone.
    """
    coulomb = log_uniform(rng, 0.15, 0.6)
    plant = {
        "base": base,
        "inertia": log_uniform(rng, 0.003, 0.02),
        "coulomb": coulomb,
        "viscous": coulomb * rng.uniform(0.02, 0.1),
        # At least 30 counts of a sensor with 2^18 counts per turn.
        "presliding": log_uniform(rng, 1e-3, 1e-2),
    }
    if base == "maxwell_slip":
        if one_curve:
            plant |= _draw_one_curve(rng, coulomb, plant["presliding"], elements or 64)
        else:
            plant |= _draw_ladder(rng, coulomb, plant["presliding"], elements or 14)
    elif base == "hsieh_pan":
        plant["presliding"] = log_uniform(rng, 1e-3, 5e-3)
        plant |= _draw_series(rng, plant, elements or 28)
    elif base == "coulomb":
        plant["presliding"] = 1e-3  # of the effects that need a length
    else:
        raise ValueError(f"base is one of {', '.join(BASES)}, not {base!r}")
    return plant


def _draw_ladder(rng, coulomb, length, elements):
    """Slip distances in a geometric row up to the pre-sliding length; uneven slip forces."""
    spread = log_uniform(rng, 5.0, 20.0)
    slip_distance = length * np.geomspace(1.0 / spread, 1.0, elements)
    share = (slip_distance / length) ** rng.uniform(-0.3, 0.6)
    share *= np.exp(rng.normal(0.0, 0.25, elements))
    force = coulomb * share / share.sum()
    return {"slip_distance": slip_distance, "stiffness": force / slip_distance}


def _draw_one_curve(rng, coulomb, length, elements):
    """Elements whose virgin line meets F_c (1 - (1 - kappa y)^(1/kappa)), y = k_0 x / F_c.

    This is the curve of one shape parameter that a model with a continuous curve would take;
    98 % of F_c are reached at the pre-sliding length.
    """
    kappa = rng.uniform(-0.5, 0.5)
    share = 1.0 - (1.0 - np.arange(elements + 1) / elements) ** 2  # of F_c, dense near F_c
    share[-1] = 1.0 - 0.3 / elements**2  # where kappa < 0 the curve itself never ends
    y = (1.0 - (1.0 - share) ** kappa) / kappa
    x = y * length / ((1.0 - 0.02**kappa) / kappa)
    slope = np.append(np.diff(coulomb * share) / np.diff(x), 0.0)
    stiffness = slope[:-1] - slope[1:]
    stiffness *= coulomb / (stiffness @ x[1:])
    return {"slip_distance": x[1:], "stiffness": stiffness, "yield_shape": kappa}


def _draw_series(rng, plant, elements):
    """The illustrative rig, its length and force scaled and its shape varied."""
    coulomb, reach = plant["coulomb"], plant["presliding"]
    ratio, d_0 = rng.uniform(0.15, 0.35), reach * rng.uniform(0.8, 2.0)
    # The virgin curve G(2x)/2 meets F_c at the reach.
    k_0 = coulomb / (branch_curve(2.0 * reach, 1.0, ratio, d_0) / 2.0)
    exponent = rng.uniform(1.7, 2.5)
    return {
        "initial_stiffness": k_0,
        "final_stiffness": ratio * k_0,
        "decay_distance": d_0,
        "reach": reach,
        "elements": elements,
        "exponent": exponent,
        "hardening_coefficient": reach * rng.uniform(0.4, 1.1) / coulomb**exponent,
        "creep_rate": log_uniform(rng, 1.0, 4.0),
        "damping": 2.0 * rng.uniform(0.03, 0.06) * np.sqrt(k_0 * plant["inertia"]),
    }


def draw_controller(plant, rng):
    """Gains of a PD or PID controller with a closed loop of 4 to 8 Hz."""
    omega = 2.0 * np.pi * rng.uniform(4.0, 8.0)
    proportional = plant["inertia"] * omega**2
    return {
        "proportional": proportional,
        "derivative": 2.0 * rng.uniform(0.7, 1.0) * plant["inertia"] * omega,
        "integral": float(rng.choice([0.0, 1.0])) * proportional * omega * 0.08,
        "filter_time": rng.uniform(2e-3, 4e-3),
    }


# --- experiments


def excite(kind, plant, samples, sample_time, rng):
    """The experiment of this kind, `samples` rows long."""
    return _EXPERIMENTS[kind](plant, np.arange(samples) * sample_time, sample_time, rng)


def _closed(reference):
    return Excitation(np.zeros_like(reference), reference)


def _usual_acceleration(plant, share):
    """rad/s² at which inertia takes `share` of the friction."""
    return float(np.clip(share * plant["coulomb"] / plant["inertia"], 15.0, 250.0))


def _fade(t, time):
    """0 to 1 over `time`, without a corner."""
    s = np.clip(t / time, 0.0, 1.0)
    return s * s * (3.0 - 2.0 * s)


def _multisine(plant, t, step, rng):
    """Two turns and more from end to end, with harmonics up to 4 Hz, up to 10 rad/s."""
    span = t[-1] + step
    base = 2.0 * np.pi / span
    slow = np.sin(base * t + rng.uniform(0, 2 * np.pi))
    for n in (2, 3):
        slow += rng.uniform(0.0, 0.25) / n * np.sin(n * base * t + rng.uniform(0, 2 * np.pi))
    slow = _fade(t, 0.8) * (slow - slow[0])
    slow *= 4.0 * np.pi * rng.uniform(1.05, 1.2) / np.ptp(slow)
    speed = np.abs(np.gradient(slow, step)).max()
    if speed > 9.0:  # too short a recording for two turns at this speed
        slow *= 9.0 / speed
        speed = 9.0
    frequencies = np.exp(rng.uniform(np.log(0.5), np.log(4.0), 8)) * 2.0 * np.pi
    quick = sum(np.sin(w * t + rng.uniform(0, 2 * np.pi)) / w**1.5 for w in frequencies)
    rate = np.gradient(quick, step)
    acceleration = np.sqrt(np.mean(np.gradient(rate, step) ** 2))
    room = max(rng.uniform(8.5, 10.5) - speed, 2.0) / np.abs(rate).max()
    quick *= min(_usual_acceleration(plant, rng.uniform(0.5, 0.9)) / acceleration, room)
    return _closed(slow + _fade(t, 0.4) * (quick - quick[0]))


def _follow_speeds(speeds, t, step, limit):
    """Reference whose speed goes from value to value at the acceleration `limit`."""
    index = np.searchsorted(np.cumsum([d for _, d in speeds]), t, side="right")
    wanted = np.array([v for v, _ in speeds] + [0.0])[index]
    speed, now = np.empty_like(t), 0.0
    for k, goal in enumerate(wanted):
        now += min(max(goal - now, -limit * step), limit * step)
        speed[k] = now
    return np.concatenate([[0.0], np.cumsum(speed[:-1]) * step])


def _ramps(plant, t, step, rng):
    """Two-way constant speeds over three decades, slow ones for longer."""
    grid = np.geomspace(0.01, 10.0, 6) * np.exp(rng.uniform(-0.25, 0.25, 6))
    grid = np.minimum(grid, 10.0)
    weight = np.array([1.6, 1.3, 1.0, 0.8, 0.8, 0.9])
    order = rng.permutation(6)
    span = (t[-1] + step - 0.05) / (2.0 * weight.sum())
    side = either_sign(rng)
    speeds = [(0.0, 0.05)]
    for i in order:
        speeds += [(side * grid[i], weight[i] * span), (-side * grid[i], weight[i] * span)]
    return _closed(_follow_speeds(speeds, t, step, _usual_acceleration(plant, 3.0)))


def _dwell(plant, t, step, rng):
    """Rests of 0.1 to 5 s, each ended by a torque ramp past break-away and a short slide."""
    torque, now, end = np.zeros_like(t), 0.05, t[-1]
    rests = _cells(rng, np.geomspace(0.1, 5.0, 6) if end > 7.5 else np.geomspace(0.1, end / 3, 4))
    rates = _cells(rng, np.geomspace(1.5, 40.0, 5))
    side = either_sign(rng)
    while now < end:
        rest = min(next(rests), max(0.1, end - now - 0.9))
        rate = next(rates)
        peak = rng.uniform(1.22, 1.35)
        rise, slide = peak / rate, rng.uniform(0.02, 0.06)
        fall = 0.03
        now += rest
        shape = np.interp(
            t,
            now + np.array([0.0, rise, rise + slide, rise + slide + fall]),
            [0.0, peak, peak, 0.0],
        )
        torque += side * plant["coulomb"] * shape
        now += rise + slide + fall + 0.12  # the body comes to rest
        if rng.random() < 0.8:
            side = -side
    return Excitation(torque, None)


def _cells(rng, levels):
    """Every level in random order, again and again, each spread by 15 %."""
    while True:
        for level in rng.permutation(levels):
            yield level * np.exp(rng.uniform(-0.15, 0.15))


def _pulses(plant, t, step, rng):
    """Pulses from below break-away to three times friction, 15 to 150 ms, edges 4 to 12 ms."""
    torque, now, side = np.zeros_like(t), 0.1, either_sign(rng)
    while now < t[-1]:
        size = rng.uniform(0.3, 0.95) if rng.random() < 0.3 else rng.uniform(1.2, 3.0)
        width = log_uniform(rng, 0.015, 0.15)
        if size > 1.0:  # at most 9 rad/s
            width = min(width, 9.0 * plant["inertia"] / ((size - 1.0) * plant["coulomb"]))
        width = max(width, 0.008)
        edge = min(log_uniform(rng, 0.004, 0.012), width)
        shape = _fade(t - now, edge) * _fade(now + width + edge - t, edge)
        torque += side * size * plant["coulomb"] * shape
        coast = (size - 1.0) * width if size > 1.0 else 0.0
        now += width + coast + log_uniform(rng, 0.04, 0.4)
        if rng.random() < 0.75:
            side = -side
    return Excitation(torque, None)


def _presliding(plant, t, step, rng):
    """Torque loops below break-away: large, nested, minor, and holds at 0.3 to 0.92 F_c."""
    levels, times = [0.0], [0.0]

    def go(level, time, hold=0.0):
        levels.append(level)
        times.append(times[-1] + time)
        if hold:
            levels.append(level)
            times.append(times[-1] + hold)

    while times[-1] < t[-1] + 1.0:
        top, side = rng.uniform(0.55, 0.92), either_sign(rng)
        half = log_uniform(rng, 0.08, 0.5)
        go(side * top, half)
        go(-side * top, half)
        go(side * top * rng.uniform(0.9, 1.0), half)
        inner = rng.uniform(0.1, 0.5)
        for _ in range(rng.integers(1, 4)):  # nested, each within the last
            go(side * top * (1.0 - 2.0 * inner), half * 0.6)
            go(side * top * (1.0 - 0.2 * inner), half * 0.6)
            inner *= rng.uniform(0.4, 0.8)
        go(side * rng.uniform(0.3, 0.92), half, hold=rng.uniform(0.4, 1.6))
    piece = np.clip(np.searchsorted(times, t, side="right") - 1, 0, len(times) - 2)
    times, levels = np.array(times), np.array(levels)
    phase = (t - times[piece]) / (times[piece + 1] - times[piece])
    shape = levels[piece] + (levels[piece + 1] - levels[piece]) * 0.5 * (1 - np.cos(np.pi * phase))
    return Excitation(plant["coulomb"] * shape, None)


def _sines(plant, t, step, rng):
    """Blocks of sines, frequency by amplitude, one of them of high acceleration."""
    blocks = min(max(round((t[-1] + step) / 1.24), 2), 7)
    edges = np.linspace(0.0, t[-1] + step, blocks + 1)
    frequencies = rng.permutation(np.geomspace(0.6, 5.0, blocks)) * np.exp(rng.uniform(-0.1, 0.1))
    speeds = rng.permutation(np.geomspace(0.1, 7.0, blocks))
    reference = np.zeros_like(t)
    special = rng.integers(blocks)
    for i in range(blocks):
        length = edges[i + 1] - edges[i]
        half_cycles = max(round(2.0 * frequencies[i] * length), 1)
        omega = np.pi * half_cycles / length  # the block ends where it began
        amplitude = min(speeds[i] / omega, _usual_acceleration(plant, 2.0) / omega**2)
        if i == special:
            omega = np.pi * max(round(2.0 * rng.uniform(4.0, 7.0) * length), 1) / length
            amplitude = min(_usual_acceleration(plant, 6.0) / omega**2, 9.0 / omega)
        inside = (t >= edges[i]) & (t < edges[i + 1])
        local = t[inside] - edges[i]
        fade = _fade(local, 0.15) * _fade(length - local, 0.15)
        reference[inside] = either_sign(rng) * fade * amplitude * np.sin(omega * local)
    return _closed(reference)


_EXPERIMENTS = {
    "tracking": _multisine,
    "ramps": _ramps,
    "dwell": _dwell,
    "pulses": _pulses,
    "presliding": _presliding,
    "sines": _sines,
}
