"""Coulomb friction with a Stribeck fall: a formula of speed (Armstrong-Hélouvry et al. 1994)."""

import numpy as np
from tests.reference.coulomb_reference import CoulombParameters
from tests.reference.golden import Golden

GOLDEN = Golden(
    reach=0.01,
    speed=0.3,
    share=1e-12,
    parameters={
        "coulomb": 0.35,
        "breakaway": 0.5,
        "stribeck_velocity": 0.05,
        "stribeck_exponent": 1.5,
        "viscous": 0.05,
    },
)


def along(velocity, dt, **parameters):
    """Friction at the end of each sample; no effort has to be held at rest."""
    law = CoulombParameters(inertia=1.0, **parameters)
    return np.array([np.sign(v) * law.level(abs(v)) + law.viscous * v for v in velocity])
