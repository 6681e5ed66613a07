"""Prandtl-Ishlinskii by its play operators: F = Σ w·(x − P_r[x]), P_r by two comparisons."""

import numpy as np
from tests.reference.golden import Golden

OPERATORS = 10
GOLDEN = Golden(
    reach=6e-4,
    speed=0.05,
    share=1e-11,
    parameters={
        "coulomb": 0.35,
        "initial_stiffness": 3000.0,
        "density_decay": 2.0,
        "viscous": 0.05,
    },
)


def along(velocity, dt, *, coulomb, initial_stiffness, density_decay, viscous):
    """Friction at the end of each sample."""
    spots = np.arange(0.5, OPERATORS) / OPERATORS
    density = np.exp(-density_decay * spots)
    weights = initial_stiffness * density / density.sum()
    radii = spots * coulomb / (weights @ spots)
    play = np.zeros(OPERATORS)
    place, friction = 0.0, []
    for v in velocity:
        place += v * dt
        play = np.maximum(place - radii, np.minimum(place + radii, play))
        friction.append(weights @ (place - play) + viscous * v)
    return np.array(friction)
