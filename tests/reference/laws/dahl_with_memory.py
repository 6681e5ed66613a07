"""Dahl's loop as very many sliders behind springs, which remember without any list of points.

The branch of a ladder of elasto-slide elements is its first loading at twice the size. So the first
loading at half the size has to be Dahl's way from -F_c, and that is inverted by quadrature of eq.
(1) of Hsieh and Pan (2000), not by its solution.
"""

import numpy as np
from scipy.integrate import cumulative_simpson
from tests.reference.golden import Golden

ELEMENTS = 20_000
GOLDEN = Golden(
    reach=3e-4,
    speed=0.05,
    # Chords of the elements below the curve.
    share=1e-4,
    parameters={"coulomb": 0.35, "initial_stiffness": 3000.0, "exponent": 1.5, "viscous": 0.05},
)


def along(velocity, dt, *, coulomb, initial_stiffness, exponent, viscous):
    """Friction at the end of each sample."""
    # The way from -F_c to F_c, finer towards its end, which it never reaches where i >= 1.
    left = np.geomspace(2.0, 1e-4, ELEMENTS + 1)
    slope = initial_stiffness * left**exponent
    # dx = F_c dr / slope, integrated over ln r.
    way = cumulative_simpson(coulomb * left / slope, x=-np.log(left), initial=0.0)
    level, yields = coulomb * (2.0 - left) / 2.0, way / 2.0
    chords = np.diff(level) / np.diff(yields)
    stiffness = chords - np.append(chords[1:], 0.0)
    extension, friction = np.zeros(ELEMENTS), []
    for v in velocity:
        extension = np.clip(extension + v * dt, -yields[1:], yields[1:])
        friction.append(stiffness @ extension + viscous * v)
    return np.array(friction)
