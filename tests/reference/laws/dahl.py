"""Dahl's model by Runge-Kutta over the displacement: eq. (1) of Hsieh and Pan (2000)."""

import numpy as np
from tests.reference.golden import Golden
from tests.reference.laws._held import carried

GOLDEN = Golden(
    reach=3e-4,
    speed=0.05,
    share=1e-9,
    parameters={"coulomb": 0.35, "initial_stiffness": 3000.0, "exponent": 1.5, "viscous": 0.05},
)


def along(velocity, dt, *, coulomb, initial_stiffness, exponent, viscous):
    """Friction at the end of each sample."""

    def rate(force, v):
        left = 1.0 - force / coulomb * np.sign(v)
        return initial_stiffness * np.abs(left) ** exponent * np.sign(left) * v

    return carried(rate, [0.0], velocity, dt)[:, 0] + viscous * np.asarray(velocity)
