"""The reset integrator: dz/dt integrated by LSODA up to the tear, located as an event."""

import numpy as np
from scipy.integrate import solve_ivp
from tests.reference.golden import Golden

GOLDEN = Golden(
    reach=6e-4,
    speed=0.05,
    share=1e-9,
    parameters={
        "coulomb": 0.3,
        "breakaway": 0.5,
        "initial_stiffness": 3000.0,
        "damping": 0.45,
        "viscous": 0.05,
    },
)


def along(velocity, dt, *, coulomb, breakaway, initial_stiffness, damping, viscous):
    """Friction at the end of each sample."""
    # Haessig and Friedland's own constants.
    z_0 = breakaway / initial_stiffness
    sigma_0 = coulomb / z_0
    a = breakaway / coulomb - 1.0

    def torn(_, y, side):
        return side * y[0] - 1.0

    torn.terminal = True
    z, slips, friction = 0.0, 0.0, []
    for v in velocity:
        side = np.sign(v)
        if slips * side <= 0.0:
            slips = 0.0
        if slips == 0.0 and side:
            if side * z >= z_0 * (1.0 - 1e-13):
                slips = side
            else:
                way = solve_ivp(
                    lambda t, y, _, v=v: [v / z_0],
                    (0.0, dt),
                    [z / z_0],
                    events=torn,
                    args=(side,),
                    rtol=1e-12,
                    atol=1e-14,
                )
                z = z_0 * way.y[0, -1]
                slips = side if way.status == 1 else 0.0
        if slips:
            z = slips * z_0
        rate = 0.0 if slips else v
        friction.append((1.0 + (0.0 if slips else a)) * sigma_0 * z + damping * rate + viscous * v)
    return np.array(friction)
