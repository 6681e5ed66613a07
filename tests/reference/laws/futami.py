"""Linear, nonlinear, rolling: very many springs behind sliders, followed one by one.

None yields below x_1, the last at x_2; neither reverse points nor Masing's rule occur here.
"""

import numpy as np
from tests.reference.golden import Golden

ELEMENTS = 20_000
GOLDEN = Golden(
    reach=6e-4,
    speed=0.05,
    # Chords of 20 000 elements below the curve.
    share=1e-6,
    parameters={
        "coulomb": 0.35,
        "initial_stiffness": 3000.0,
        "linear_share": 0.2,
        "curve_exponent": 2.5,
        "viscous": 0.05,
    },
)


def along(velocity, dt, *, coulomb, initial_stiffness, linear_share, curve_exponent, viscous):
    """Friction at the end of each sample."""
    first = linear_share * coulomb / initial_stiffness
    last = first + curve_exponent * (coulomb / initial_stiffness - first)
    # Denser where the force bends most.
    yields = first + (last - first) * np.linspace(0.0, 1.0, ELEMENTS + 1) ** 2
    missing = (1.0 - (yields - first) / (last - first)).clip(0.0) ** curve_exponent
    level = coulomb * (1.0 - (1.0 - linear_share) * missing)
    chords = np.append(initial_stiffness, np.append(np.diff(level) / np.diff(yields), 0.0))
    stiffness = -np.diff(chords)
    extension = np.zeros(ELEMENTS + 1)
    friction = []
    for v in velocity:
        extension = np.clip(extension + v * dt, -yields, yields)
        friction.append(stiffness @ extension + viscous * v)
    return np.array(friction)
