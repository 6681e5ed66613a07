"""Elasto-slide elements in parallel, each a spring behind a slider (Iwan 1966), very many of them.

The elements yield where the first loading curve bends; each is followed by itself, so that neither
reverse points nor Masing's rule occur here.
"""

import numpy as np
from tests.reference.golden import Golden

ELEMENTS = 20_000
GOLDEN = Golden(
    reach=4e-4,
    speed=0.05,
    # Chords of 20 000 elements below the curve, and its last 1/20 000 of F_c.
    share=1e-4,
    parameters={
        "coulomb": 0.35,
        "initial_stiffness": 3000.0,
        "yield_shape": 0.25,
        "viscous": 0.05,
    },
)


def along(velocity, dt, *, coulomb, initial_stiffness, yield_shape, viscous):
    """Friction at the end of each sample."""
    level = np.linspace(0.0, 1.0, ELEMENTS + 1)
    # V = F_c (1 - (1 - kappa y)^(1/kappa)), solved for the displacement of each level.
    yields = coulomb / initial_stiffness * (1.0 - (1.0 - level) ** yield_shape) / yield_shape
    chords = coulomb * np.diff(level) / np.diff(yields)
    stiffness = chords - np.append(chords[1:], 0.0)
    limit = yields[1:]
    extension = np.zeros(ELEMENTS)
    friction = []
    for v in velocity:
        extension = np.clip(extension + v * dt, -limit, limit)
        friction.append(stiffness @ extension + viscous * v)
    return np.array(friction)
