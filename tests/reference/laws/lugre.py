"""LuGre by Runge-Kutta on the deflection z: eqs. (6)-(8) of Hsieh and Pan (2000).

With the damping and the viscous term of Canudas de Wit et al. (1995). A body on such a contact is
integrated together with it.
"""

import numpy as np
from scipy.integrate import solve_ivp
from tests.reference.golden import Golden
from tests.reference.laws._held import carried

GOLDEN = Golden(
    reach=6e-4,
    speed=0.2,
    share=1e-8,
    parameters={
        "coulomb": 0.35,
        "breakaway": 0.5,
        "stribeck_velocity": 0.05,
        "stribeck_exponent": 2.0,
        "initial_stiffness": 3000.0,
        "damping": 0.8,
        "damping_velocity": 0.15,
        "viscous": 0.05,
    },
)
# Section III of Canudas de Wit et al., as others quote them too.
PUBLISHED = {
    "coulomb": 1.0,
    "breakaway": 1.5,
    "stribeck_velocity": 1e-3,
    "stribeck_exponent": 2.0,
    "initial_stiffness": 1e5,
    "damping": np.sqrt(1e5),
    "viscous": 0.4,
}


def level(v, *, coulomb, breakaway, stribeck_velocity, stribeck_exponent, **_):
    """Eq. (8), as a force."""
    fall = np.exp(-(np.abs(v / stribeck_velocity) ** stribeck_exponent))
    return coulomb + (breakaway - coulomb) * fall


def slipping(z, v, **p):
    """Eq. (6): dz/dt."""
    return v - p["initial_stiffness"] * np.abs(v) / level(v, **p) * z


def friction(z, v, *, rate=slipping, **p):
    """Eq. (7)."""
    damping = p["damping"] * np.exp(-((v / p.get("damping_velocity", np.inf)) ** 2))
    return p["initial_stiffness"] * z + damping * rate(z, v, **p) + p["viscous"] * v


def along(velocity, dt, *, rate=slipping, **p):
    """Friction at the end of each sample."""
    z = carried(lambda z, v: rate(z, v, **p), [0.0], velocity, dt, atol=1e-17)[:, 0]
    return np.array([friction(a, v, rate=rate, **p) for a, v in zip(z, velocity, strict=True)])


def body(effort, times, *, inertia, rate=slipping, rtol=1e-10, **p):
    """Position, velocity and deflection at these times of a body under effort(t, x)."""

    def rates(t, y):
        x, v, z = y
        resisted = friction(z, v, rate=rate, **p)
        return [v, (effort(t, x) - resisted) / inertia, rate(z, v, **p)]

    span = (0.0, times[-1])
    atol = [1e-13, 1e-11, 1e-15]
    done = solve_ivp(
        rates, span, [0.0] * 3, "LSODA", times, rtol=rtol, atol=atol, max_step=times[-1] / 500
    )
    return done.y
