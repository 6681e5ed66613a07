"""A load behind a gap whose ends yield, against its equations solved by another integrator."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiction as st

INERTIA, SHARE, GAP, CONTACT_TIME, RATIO, LOAD = 0.01, 0.35, 4e-3, 1.5e-3, 0.3, 0.8
DT = 1e-3
NUMBERS = {
    "inertia_share": SHARE,
    "gap": GAP,
    "contact_time": CONTACT_TIME,
    "damping_ratio": RATIO,
    "load_damping": LOAD,
}


def expected(efforts):
    near, far = (1.0 - SHARE) * INERTIA, SHARE * INERTIA
    stiffness = far / CONTACT_TIME**2
    damping = 2.0 * RATIO * np.sqrt(stiffness * near * far / INERTIA)

    def rates(_, y, effort):
        apart, rate = y[0] - y[2], y[1] - y[3]
        side = np.sign(apart)
        pressed = abs(apart) - 0.5 * GAP
        torque = max(stiffness * pressed + damping * rate * side, 0.0) * side * (pressed > 0.0)
        return [y[1], (effort - torque) / near, y[3], torque / far - LOAD * y[3]]

    y, positions = np.zeros(4), [0.0]
    for effort in efforts:
        done = solve_ivp(rates, (0.0, DT), y, args=(effort,), rtol=1e-9, atol=1e-13, max_step=2e-5)
        y = done.y[:, -1]
        positions.append(y[0])
    return np.array(positions)


@pytest.mark.parametrize("integrator", ["fast", "reference"])
def test_a_load_is_thrown_about_as_its_equations_say(integrator):
    efforts = np.repeat([0.3, -0.3, 0.2], [60, 120, 60])
    machine = st.Motor(
        inertia=INERTIA,
        friction=st.FrictionModel("coulomb", coulomb=1e-12),
        effects={"backlash": NUMBERS},
        integrator=integrator,
    )
    found = machine.simulate(efforts, DT).position
    exact = expected(efforts)
    rigid = st.Motor(
        inertia=INERTIA,
        friction=st.FrictionModel("coulomb", coulomb=1e-12),
        effects={"backlash": NUMBERS | {"contact_time": 0.0, "load_damping": 0.0}},
        integrator=integrator,
    )
    # Its damping sets in over a hundredth of the gap.
    bound = 0.02 * GAP
    assert np.abs(found - exact[-len(found) :]).max() < bound
    assert np.abs(rigid.simulate(efforts, DT).position - exact[-len(found) :]).max() > 5.0 * bound


def test_a_load_may_have_friction_behind_a_rigid_gap_too():
    """Along an even motion it takes s·J·β·v, and without friction of its own nothing."""
    position = 2.0 * DT * np.arange(2001)

    def needed(**numbers):
        machine = st.Motor(
            inertia=INERTIA,
            friction=st.FrictionModel("coulomb", coulomb=0.1),
            effects={"backlash": {"inertia_share": SHARE, "gap": GAP} | numbers},
        )
        _, ambient, friction, _ = machine.follow(st.Motion(position, np.zeros(2000), DT))
        return friction - ambient, friction

    plain, contact_alone = needed()
    taken = SHARE * INERTIA * LOAD * 2.0
    for contact in (0.0, CONTACT_TIME):
        loaded, friction = needed(contact_time=contact, load_damping=LOAD)
        assert np.mean((loaded - plain)[-200:]) == pytest.approx(taken, rel=1e-2)
        # What remembers the friction of the contact does not see that of the load.
        np.testing.assert_array_equal(friction, contact_alone)
