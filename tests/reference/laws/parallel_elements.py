"""Elements in parallel by plastic slips: return mapping with a plastic modulus for each.

An element is a spring k behind a slider that moved by p and hardens with H = h·k/(1 − h); neither
its force nor its yield points are remembered.
"""

import numpy as np
from tests.reference.golden import Golden

ELEMENTS = 4
GOLDEN = Golden(
    reach=6e-4,
    speed=0.05,
    share=1e-11,
    parameters={
        "coulomb": 0.35,
        "initial_stiffness": 3000.0,
        "yield_spread": 0.6,
        "hardening_share": 0.05,
        "viscous": 0.05,
    },
    options={"hardening": "kinematic"},
)


def along(
    velocity,
    dt,
    *,
    coulomb,
    initial_stiffness,
    yield_spread,
    hardening_share,
    viscous,
    hardening,
):
    """Friction at the end of each sample."""
    stiffness = initial_stiffness / ELEMENTS
    modulus = hardening_share * stiffness / (1.0 - hardening_share)
    yields = coulomb / ELEMENTS * (1.0 + yield_spread * np.linspace(-1.0, 1.0, ELEMENTS))
    slip = np.zeros(ELEMENTS)
    ways = np.zeros((2, ELEMENTS))  # slid forwards, slid backwards
    place, friction = 0.0, []
    for v in velocity:
        place += v * dt
        force = stiffness * (place - slip)
        for side, own in ((1.0, 0), (-1.0, 1)):
            if hardening == "kinematic":
                limit = yields + side * modulus * slip
            elif hardening == "isotropic":
                limit = yields + modulus * ways.sum(axis=0)
            else:
                limit = yields + modulus * ways[own]
            more = np.maximum(0.0, side * force - limit) / (stiffness + modulus)
            slip += side * more
            ways[own] += more
            force = stiffness * (place - slip)
        friction.append(force.sum() + viscous * v)
    return np.array(friction)
