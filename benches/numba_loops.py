"""The same loop as `benches/c/hsieh_pan.c`, in numba: constants known when it is compiled.

What happens rarely is left to functions of their own, as there; what runs stays in locals.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit, prange

INERTIA, DT = 0.0076, 1e-4
K_0, K_INF, D_0 = 3000.0, 810.0, 2.908882086657216e-4
HARDENING, CREEP_RATE, C_S = 1.6e-3, 2.0, 0.45
F_S, F_C, V_S, REACH = 0.5, 0.35, 0.1, 2e-5
FADING, PER_D_0, PER_INERTIA = K_0 - K_INF, 1.0 / D_0, 1.0 / INERTIA
LEVER = 0.5 * DT * DT * PER_INERTIA
BRAKING = 0.5 * DT / (INERTIA + 0.5 * DT * C_S)
KEPT = (INERTIA - 0.5 * DT * C_S) / (INERTIA + 0.5 * DT * C_S)
SHORT, SHORTER, SYNCHRONISED = 0.02, 0.01, 256
# Places of the state.
X, V, MODE, AT, FORCE, SLOPE, WAY, HARD, STEPS, POINTS, BREAKS, STICKS = range(12)


@njit(inline="always")
def second_share(z):
    return (0.49999999999989186 - z * 0.16666666632048885) + (z * z) * (
        0.04166649351978712 - z * 0.008305611273979163
    )


@njit(inline="always")
def short_way(force, slope, displacement, z):
    """Force and slope a short way further along a branch."""
    near = 0.499999999998275 - z * 0.16666666390556875
    far = 0.0416659759297064 - z * 0.008278000311740141
    excess, square = slope - K_INF, z * z
    bent, fallen = (excess * displacement) * z, excess * z
    eased = fallen * z
    return (
        ((force + displacement * slope) - bent * near) - (bent * square) * far,
        ((slope - fallen) + eased * near) + (eased * square) * far,
    )


@njit
def branch(d):
    gone = -math.expm1(-d * PER_D_0)
    return K_INF * d + FADING * D_0 * gone, K_0 - FADING * gone


@njit
def virgin(x):
    s = -1.0 if x < 0.0 else 1.0
    force, slope = branch(2.0 * s * x)
    return 0.5 * s * force, slope


@njit
def virgin_inverse(force):
    target = abs(force)
    x = target / K_0
    for _ in range(60):
        there, slope = virgin(x)
        following = max(x + (target - there) / slope, 0.0)
        moved = abs(following - x)
        x = following
        if moved <= 8.9e-16 * x:
            break
    return math.copysign(x, force)


@njit(inline="always")
def creep(force, slope, way, hardening, displacement, span):
    """Hardening gained and what is left to the spring."""
    size = abs(force)
    if size == 0.0 or span <= 0.0:
        return 0.0, displacement
    s = math.copysign(1.0, force)
    margin = HARDENING * size * size - hardening
    held = CREEP_RATE * span * margin if margin > 0.0 else 0.0
    net = displacement - s * held
    direction = math.copysign(1.0, net) if net != 0.0 else -s
    stiffness = slope if direction == way else K_0
    gain = 2.0 * HARDENING * size * stiffness
    pace = (CREEP_RATE * span * 2.0 * HARDENING) * size * stiffness
    risen = gain * displacement * s
    z = CREEP_RATE * span + pace
    if margin > 0.0:
        second = second_share(z) if z < SHORTER else (1.0 + math.expm1(-z) / z) / z
        mean = 1.0 - z * second
        if risen >= 0.0 or margin * (1.0 - z * mean) + risen * mean >= 0.0:
            lagged = second * (held * s * z - pace * displacement)
            return held - lagged * s, (displacement - s * held) + lagged
    elif risen <= 0.0 or margin + risen <= 0.0:
        return 0.0, displacement
    rate, rise = CREEP_RATE * (1.0 + gain), risen / span
    if margin > 0.0:
        u = rate * margin / rise
        left = -(margin / rise) * (
            1.0 + u / 2 + u * u / 3 if abs(u) < 1e-5 else -math.log1p(-u) / u
        )
        start = margin
    else:
        left, start = span + margin / rise, 0.0
    z = rate * left
    second = second_share(z) if z < SHORTER else (1.0 + math.expm1(-z) / z) / z
    gained = (start * left * (1.0 - z * second) + rise * left * left * second) * CREEP_RATE
    return gained, displacement - s * gained


@njit
def walk(state, point, position, ds):
    """Force, slope, direction, points kept and whether one is added."""
    way = state[WAY] if ds == 0.0 else math.copysign(1.0, ds)
    added = way != state[WAY] and state[WAY] != 0.0
    kept = int(state[POINTS])
    while True:
        if added:
            target = -state[AT] if kept == 0 else point[kept - 1, 0]
            wiped = 0 if kept == 0 else 1
        elif kept == 0:
            break
        else:
            target = -point[0, 0] if kept == 1 else point[kept - 2, 0]
            wiped = 1 if kept == 1 else 2
        if way * (position - target) < 0.0:
            break
        kept -= wiped
        added = False
    if added or kept > 0:
        x_r = state[AT] if added else point[kept - 1, 0]
        f_r = state[FORCE] if added else point[kept - 1, 1]
        force, slope = branch((position - x_r) * way)
        return f_r + way * force, slope, way, kept, added
    force, slope = virgin(position)
    return force, slope, way, kept, added


@njit(inline="always")
def level(v):
    share = v * (1.0 / V_S)
    return F_C + (F_S - F_C) * math.exp(-share * share)


@njit(inline="always")
def slip(x, v, force, mode, effort, span):
    """Position, velocity, force and pull."""
    a = (effort - force) * PER_INERTIA
    displacement = span * (v + 0.5 * span * a)
    start, end = level(v), level(v + span * a)
    z = abs(displacement) * (1.0 / REACH)
    gone = -math.expm1(-z) if z < 0.5 else 1.0 - math.exp(-z)
    share = 0.5 * z if z < 1e-5 else 1.0 - gone * (1.0 / z)
    sigma = start + (end - start) * share + (force * mode - start) * (1.0 - gone)
    after = v + 0.5 * span * PER_INERTIA * ((effort - force) + (effort - sigma * mode))
    return x + displacement, after, sigma * mode, end - sigma


@njit
def attempt(state, point, effort, span):
    """Position, velocity, force, slope, elongation, gain of hardening, way, kept, added, pull."""
    x, v, force = state[X], state[V], state[FORCE]
    if state[MODE] != 0.0:
        x, v, force, pull = slip(x, v, force, state[MODE], effort, span)
        return x, v, force, 0.0, 0.0, 0.0, 0.0, 0, False, pull
    a = (effort - force) - C_S * v
    displacement = span * v + (0.5 * span * span * PER_INERTIA) * a
    gained, ds = creep(force, state[SLOPE], state[WAY], state[HARD], displacement, span)
    after, slope, way, kept, added = walk(state, point, state[AT] + ds, ds)
    v = (INERTIA * v + 0.5 * span * (a + (effort - after))) / (INERTIA + 0.5 * span * C_S)
    return x + displacement, v, after, slope, state[AT] + ds, gained, way, kept, added, 0.0


@njit
def margin(state, step):
    """Of the event that a step may run past: positive before it."""
    if state[MODE] == 0.0:
        return F_S - abs(step[2]) if step[1] * step[2] > 0.0 else 1.0
    if REACH * K_INF - step[9] <= 0.0 and abs(step[2]) < F_S:
        stiffness = virgin(virgin_inverse(step[2]))[1]
        return min(REACH * stiffness - step[9], step[1] * state[MODE])
    return step[1] * state[MODE]


@njit
def through_events(state, point, effort):
    left = DT
    for _ in range(16):
        if state[MODE] * state[V] < 0.0:
            change(state)
            continue
        step = attempt(state, point, effort, left)
        due = margin(state, step) <= 0.0
        span = left
        if due:
            low, high = 0.0, left
            for _ in range(60):
                span = 0.5 * (low + high)
                if margin(state, attempt(state, point, effort, span)) > 0.0:
                    low = span
                else:
                    high = span
            step = attempt(state, point, effort, span)
        if state[MODE] == 0.0:
            if step[8]:
                point[step[7], 0], point[step[7], 1] = state[AT], state[FORCE]
            state[POINTS] = step[7] + (1 if step[8] else 0)
            state[AT], state[SLOPE], state[WAY], state[STEPS] = step[4], step[3], step[6], 0
            state[HARD] += step[5]
        state[X], state[V], state[FORCE] = step[0], step[1], step[2]
        if not due:
            return
        change(state)
        left -= span
        if left <= 1e-15 * DT:
            left = 0.0


@njit
def change(state):
    if state[MODE] == 0.0:
        state[MODE] = math.copysign(1.0, state[FORCE])
        state[BREAKS] += 1
    else:
        if abs(state[V]) < 1e-12:
            state[V] = 0.0
        state[MODE], state[HARD] = 0.0, 0.0
        state[STICKS] += 1
    state[AT] = virgin_inverse(state[FORCE])
    state[SLOPE] = virgin(state[AT])[1]
    state[WAY] = math.copysign(1.0, state[FORCE])
    state[POINTS], state[STEPS] = 0, 0


@njit
def hsieh_pan(effort, position, velocity):
    """Fills positions and velocities from rest; numbers of break-aways and sticks."""
    state, point = np.zeros(12), np.zeros((4096, 2))
    state[SLOPE] = K_0
    samples = len(effort)
    k = 0
    while k < samples:
        x, v, force, mode = state[X], state[V], state[FORCE], state[MODE]
        if mode == 0.0:
            at, slope, way, hardening = state[AT], state[SLOPE], state[WAY], state[HARD]
            steps, points = int(state[STEPS]), int(state[POINTS])
            per = PER_D_0 if points > 0 else 2.0 * PER_D_0
            target = math.inf
            if points > 0:
                target = way * (-point[0, 0] if points == 1 else point[points - 2, 0])
            while k < samples:
                u = effort[k]
                push = u - force
                displacement = (DT - LEVER * C_S) * v + LEVER * push
                gained, ds = creep(force, slope, way, hardening, displacement, DT)
                z = ds * (way * per)
                if not (0.0 < z < SHORT and (at + ds) * way < target and steps < SYNCHRONISED):
                    break
                after, slope_after = short_way(force, slope, ds, z)
                arrived = (KEPT * v + BRAKING * (push + u)) - BRAKING * after
                if abs(after) >= F_S and arrived * after > 0.0:
                    break
                x += displacement
                v, force, at = arrived, after, at + ds
                slope = slope_after
                hardening += gained
                steps += 1
                position[k], velocity[k] = x, v
                k += 1
            state[AT], state[SLOPE], state[HARD], state[STEPS] = at, slope, hardening, steps
        else:
            while k < samples:
                there, arrived, after, pull = slip(x, v, force, mode, effort[k], DT)
                if REACH * K_INF - pull <= 0.0 or mode * arrived <= 0.0:
                    break
                x, v, force = there, arrived, after
                position[k], velocity[k] = x, v
                k += 1
        state[X], state[V], state[FORCE] = x, v, force
        if k < samples:
            through_events(state, point, effort[k])
            position[k], velocity[k] = state[X], state[V]
            k += 1
    return int(state[BREAKS]), int(state[STICKS])


@njit(parallel=True)
def hsieh_pan_ensemble(efforts, found):
    """Root mean square of the position of each member, members shared among the threads."""
    for member in prange(efforts.shape[0]):
        position, velocity = np.empty(efforts.shape[1]), np.empty(efforts.shape[1])
        hsieh_pan(efforts[member], position, velocity)
        found[member] = math.sqrt(np.mean(position * position))
