"""The Leuven model by Runge-Kutta on z, its hysteresis force from the whole history of z.

Swevers et al. (2000) with the rate of z of Lampaert et al. (2002):
dz/dt = v (1 - sgn(F_h/s) |F_h/s|^n), s with the sign of v. The force has no list of reverse
points: out of all values that z ever turned at, the dominant extremes are searched anew, and
Masing's branches between them are summed.
"""

import itertools

import numpy as np
from scipy.integrate import solve_ivp
from tests.reference.golden import Golden
from tests.reference.laws.lugre import level

GOLDEN = Golden(
    reach=1.2e-3,
    speed=0.2,
    share=5e-7,
    parameters={
        "coulomb": 0.35,
        "breakaway": 0.5,
        "stribeck_velocity": 0.05,
        "stribeck_exponent": 2.0,
        "initial_stiffness": 3000.0,
        "saturation": 1.4,
        "exponent": 1.5,
        "damping": 0.8,
        "damping_velocity": 0.15,
        "viscous": 0.05,
    },
)


def first_loading(z, *, initial_stiffness, breakaway, saturation, **_):
    """F_h of a contact that only ever moved one way."""
    most = saturation * breakaway
    return np.sign(z) * most * -np.expm1(-initial_stiffness * abs(z) / most)


def dominant(history):
    """Extremes that no later excursion passed: the greatest, then the other way, and so on."""
    history = np.asarray(history)
    found, at = [], int(np.flatnonzero(np.abs(history) == np.abs(history).max())[-1])
    way = np.sign(history[at])
    while True:
        found.append(history[at])
        rest = history[at + 1 :]
        if not rest.size:
            return found
        way = -way
        at += 1 + int(np.flatnonzero(way * rest == (way * rest).max())[-1])


def hysteresis(history, **p):
    """F_h at the end of this history of z."""
    extremes = dominant(history)
    force = first_loading(extremes[0], **p)
    for before, after in itertools.pairwise(extremes):
        force += 2.0 * first_loading((after - before) / 2.0, **p)
    return force


def slipping(force, v, *, exponent=1.0, **p):
    """dz/dt."""
    a = np.sign(v) * force / level(v, **p)
    return v * (1.0 - np.sign(a) * abs(a) ** exponent)


def along(velocity, dt, **p):
    """Friction at the end of each sample."""
    turned, z, going, friction = [0.0], 0.0, 0.0, []
    for v in velocity:
        if v != 0.0:
            force = hysteresis([*turned, z], **p)
            way = np.sign(slipping(force, v, **p))
            if way != going and going != 0.0:
                turned.append(z)
            going = way
            z = _held(turned, z, v, dt, way, **p)
        force = hysteresis([*turned, z], **p)
        damping = p.get("damping", 1.0) * np.exp(-((v / p.get("damping_velocity", np.inf)) ** 2))
        friction.append(force + damping * slipping(force, v, **p) + p.get("viscous", 0.0) * v)
    return np.array(friction)


def _held(turned, z, v, dt, way, **p):
    """z after dt; restarted where its way passes an earlier extreme, and so a kink."""
    passed = sorted(
        {x for y in turned for x in (y, -y) if (x - z) * way > 0.0}, key=lambda x: x * way
    )
    t = 0.0
    while t < dt:

        def reaches(_, y):
            return (y[0] - passed[0]) * way if passed else -1.0

        reaches.terminal = True
        done = solve_ivp(
            lambda _, y: [slipping(hysteresis([*turned, y[0]], **p), v, **p)],
            (t, dt),
            [z],
            "LSODA",
            rtol=1e-11,
            atol=1e-17,
            events=reaches,
        )
        z, t = done.y[0, -1], done.t[-1]
        if done.status == 1:
            z = passed.pop(0)
            # By round-off, so that the next part begins behind it.
            z = np.nextafter(z, way * np.inf)
    return z
