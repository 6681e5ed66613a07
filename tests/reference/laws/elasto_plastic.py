"""The elasto-plastic model by Runge-Kutta on the deflection z: Dupont et al. (2002), from memory.

All but the share of a motion that slips is LuGre's.
"""

import numpy as np
from tests.reference.golden import Golden
from tests.reference.laws import lugre

GOLDEN = Golden(
    reach=6e-4,
    speed=0.2,
    share=1e-7,
    parameters=lugre.GOLDEN.parameters | {"elastic_share": 0.7},
)


def plasticity(z, v, z_ba, z_ss):
    """alpha(z, v)."""
    if np.sign(z) != np.sign(v) or abs(z) <= z_ba:
        return 0.0
    if abs(z) >= z_ss:
        return 1.0
    return 0.5 * np.sin(np.pi * (abs(z) - 0.5 * (z_ss + z_ba)) / (z_ss - z_ba)) + 0.5


def slipping(z, v, *, elastic_share, **p):
    """dz/dt."""
    z_ss = lugre.level(v, **p) / p["initial_stiffness"]
    z_ba = elastic_share * p["coulomb"] / p["initial_stiffness"]
    alpha = np.array([plasticity(a, v, z_ba, z_ss) for a in np.atleast_1d(z)]).reshape(np.shape(z))
    return v * (1.0 - alpha * z / z_ss * np.sign(v))


def along(velocity, dt, **p):
    """Friction at the end of each sample."""
    return lugre.along(velocity, dt, rate=slipping, **p)
