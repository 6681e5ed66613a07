"""A rigid contact that hardens: its level by dF_y/dκ = (F_c − F_y)/κ_0 along the way slid."""

import numpy as np
from scipy.integrate import solve_ivp
from tests.reference.golden import Golden

GOLDEN = Golden(
    reach=0.02,
    speed=0.3,
    share=1e-9,
    parameters={
        "coulomb": 0.35,
        "unhardened_share": 0.5,
        "hardening_distance": 0.03,
        "viscous": 0.05,
    },
)


def along(velocity, dt, *, coulomb, unhardened_share, hardening_distance, viscous):
    """Friction at the end of each sample; no effort has to be held at rest."""
    slid = np.cumsum(np.abs(velocity)) * dt

    def rate(_, level):
        return (coulomb - level) / hardening_distance

    ways, back = np.unique(slid, return_inverse=True)
    level = solve_ivp(
        rate,
        (0.0, ways[-1]),
        [unhardened_share * coulomb],
        t_eval=ways,
        rtol=1e-12,
        atol=1e-14,
        method="Radau" if ways[-1] > 100.0 * hardening_distance else "DOP853",
    ).y[0]
    return np.sign(velocity) * level[back] + viscous * np.asarray(velocity)
