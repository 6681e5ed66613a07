"""Bristles by their list of sites: each holds on to one until it is stretched to its limit.

The sites of the whole way are drawn beforehand; the walk goes through them one after the other.
"""

import numpy as np
from tests.reference.golden import Golden

BRISTLES = 20
WORD = (1 << 64) - 1
GOLDEN = Golden(
    reach=1e-3,
    speed=0.05,
    share=1e-9,
    parameters={
        "coulomb": 0.35,
        "initial_stiffness": 3000.0,
        "scatter": 0.7,
        "seed": 3.0,
        "viscous": 0.05,
    },
)


def scattered(seed, bristle, site):
    """Splitmix64 of the three, over -1/2 to 1/2; 0 for the first site of every bristle."""
    if site == 0:
        return 0.0
    odd = (0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB)
    z = (seed * odd[0] + (bristle + 1) * odd[1] + site * odd[2]) & WORD
    z = ((z ^ (z >> 30)) * odd[1]) & WORD
    z = ((z ^ (z >> 27)) * odd[2]) & WORD
    return ((z ^ (z >> 31)) >> 11) / 2.0**53 - 0.5


def along(velocity, dt, *, coulomb, initial_stiffness, scatter, seed, viscous):
    """Friction at the end of each sample."""
    limit = coulomb / initial_stiffness / (0.5 - scatter**2 / 12.0)
    places = np.cumsum(np.asarray(velocity) * dt)
    most = int(np.abs(places).max() / limit) + 4
    numbers = range(-most, most + 1)
    sites = [
        [limit * (k + (i + 0.5) / BRISTLES - 0.5 + scatter * scattered(int(seed), i, k))
         for k in numbers]
        for i in range(BRISTLES)
    ]  # fmt: skip
    held = [most] * BRISTLES
    friction = []
    for place, v in zip(places, velocity, strict=True):
        total = 0.0
        for i, own in enumerate(sites):
            while place - own[held[i]] > limit:
                held[i] += 1
            while own[held[i]] - place > limit:
                held[i] -= 1
            total += place - own[held[i]]
        friction.append(initial_stiffness / BRISTLES * total + viscous * v)
    return np.array(friction)
