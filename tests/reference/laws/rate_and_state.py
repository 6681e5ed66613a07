"""Rate-and-state friction by LSODA on the logarithm of the age: `rate_and_state_reference`."""

from tests.reference.golden import Golden
from tests.reference.rate_and_state_reference import RateAndState
from tests.reference.rate_and_state_reference import along as carried_along

GOLDEN = Golden(
    reach=1e-3,
    speed=0.1,
    share=1e-9,
    parameters={
        "coulomb": 0.35,
        "direct_effect": 0.02,
        "evolution_effect": 0.03,
        "slip_distance": 1e-4,
        "reference_velocity": 1e-3,
        "viscous": 0.05,
    },
    options={"evolution": "ageing"},
)


def along(
    velocity,
    dt,
    *,
    coulomb,
    direct_effect,
    evolution_effect,
    slip_distance,
    reference_velocity,
    viscous,
    evolution,
):
    """Friction at the end of each sample."""
    law = RateAndState(
        mu_0=1.0,
        a=direct_effect,
        b=evolution_effect,
        speed=reference_velocity,
        distance=slip_distance,
        normal=coulomb,
        viscous=viscous,
        evolution=evolution,
    )
    return carried_along(law, velocity, dt)[0]
