"""Bouc-Wen by Runge-Kutta in Wen's own parameters A, beta, gamma, n (1976), from memory."""

import numpy as np
from tests.reference.golden import Golden
from tests.reference.laws._held import carried

GOLDEN = Golden(
    reach=3e-4,
    speed=0.05,
    share=1e-7,
    parameters={
        "coulomb": 0.35,
        "initial_stiffness": 3000.0,
        "exponent": 1.7,
        "unloading_share": 0.8,
        "viscous": 0.05,
    },
)


def along(velocity, dt, *, coulomb, initial_stiffness, exponent, unloading_share, viscous):
    """Friction at the end of each sample."""
    both = initial_stiffness / coulomb**exponent
    beta, gamma = unloading_share * both, (1.0 - unloading_share) * both

    def rate(z, v):
        # A stage of the integration may try states beyond F_c that no solution reaches.
        bend = (beta * np.sign(z * v) + gamma) * np.minimum(np.abs(z), 1.5 * coulomb) ** exponent
        return v * (initial_stiffness - bend)

    return carried(rate, [0.0], velocity, dt)[:, 0] + viscous * np.asarray(velocity)
