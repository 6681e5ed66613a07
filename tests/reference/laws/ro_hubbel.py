"""Ro and Hubbel by positions: u and its reference are followed, eqs. (2) to (4) of the paper."""

import numpy as np
from tests.reference.golden import Golden

GOLDEN = Golden(
    reach=4e-4,
    speed=0.05,
    share=1e-11,
    parameters={
        "coulomb": 0.35,
        "initial_stiffness": 3000.0,
        "damping": 0.45,
        "viscous": 0.05,
    },
)


def along(velocity, dt, *, coulomb, initial_stiffness, damping, viscous):
    """Friction at the end of each sample."""
    reach = coulomb / initial_stiffness
    u = reference = 0.0
    macro, friction = 0.0, []
    for v in velocity:
        if macro * v <= 0.0:
            macro = 0.0
        u += v * dt
        if abs(u - reference) > reach * (1.0 + 1e-13):
            macro = np.sign(v)
        if macro:
            reference = u - macro * reach
        moving = v if macro else 0.0
        friction.append(viscous * v + damping * (v - moving) + initial_stiffness * (u - reference))
    return np.array(friction)
