"""The sticking contact by elements in parallel and Runge-Kutta: `hsieh_pan_reference`."""

from tests.reference.golden import Golden
from tests.reference.hsieh_pan_reference import follow_motion

GOLDEN = Golden(
    reach=1.5e-4,
    speed=1.5e-3,
    # 512 elements, and creep that the core steps by a sample of a third of a millisecond.
    share=3e-4,
    parameters={
        "initial_stiffness": 3000.0,
        "final_stiffness": 800.0,
        "decay_distance": 2.9e-4,
        "hardening_coefficient": 1.6e-3,
        "hardening_exponent": 2.0,
        "creep_rate": 2.0,
        "damping": 0.45,
    },
)


def along(velocity, dt, **parameters):
    """Friction at the end of each sample."""
    return follow_motion(
        velocity, dt, step=dt / 8.0, inertia=1.0, elements=512, **parameters
    ).friction
