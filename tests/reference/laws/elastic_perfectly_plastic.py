"""A spring behind a slider that hardens: elastic stretches in closed form, slides by Runge-Kutta.

While it slides dκ/dx = k_0/(k_0 + F_y'(κ)): the slip is integrated along the displacement, no
equation of a whole step is solved.
"""

import numpy as np
from scipy.integrate import solve_ivp
from tests.reference.golden import Golden

GOLDEN = Golden(
    reach=4e-4,
    speed=0.05,
    share=1e-9,
    parameters={
        "coulomb": 0.35,
        "initial_stiffness": 3000.0,
        "unhardened_share": 0.5,
        "hardening_distance": 3e-4,
        "viscous": 0.05,
    },
)


def along(
    velocity, dt, *, coulomb, initial_stiffness, unhardened_share, hardening_distance, viscous
):
    """Friction at the end of each sample."""
    missing = coulomb * (1.0 - unhardened_share)

    def level(slid):
        return coulomb - missing * np.exp(-slid / hardening_distance)

    def rate(_, slid, way):
        # The way to slide is 1 and the tolerances mean shares of it.
        rise = missing / hardening_distance * np.exp(-slid * way / hardening_distance)
        return initial_stiffness / (initial_stiffness + rise)

    force, slid, friction = 0.0, 0.0, []
    for v in velocity:
        side, left = np.sign(v), abs(v) * dt
        elastic = min(left, max(0.0, (level(slid) - side * force) / initial_stiffness))
        force += side * initial_stiffness * elastic
        left -= elastic
        if left > 0.0:
            start = [slid / left]
            way = solve_ivp(
                rate, (0.0, 1.0), start, method="DOP853", args=(left,), rtol=1e-12, atol=1e-12
            )
            slid = way.y[0, -1] * left
            force = side * level(slid)
        friction.append(force + viscous * v)
    return np.array(friction)
