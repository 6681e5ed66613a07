"""Bonds that tear: the reset integrator, micro and macro dynamics."""

import numpy as np
import pytest
from tests.reference.laws import reset_integrator, ro_hubbel

import stiction as st

F_C, F_S, K_0 = 0.35, 0.5, 3000.0


def wander(seed, reach, n=150):
    """Moves from a hundredth of a reach to ten of them."""
    rng = np.random.default_rng(seed)
    return reach * 10.0 ** rng.uniform(-2.0, 1.0, n) * rng.choice([-1.0, 1.0], n) / 1e-3


def drawn(seed):
    rng = np.random.default_rng(seed)
    return {
        "coulomb": rng.uniform(0.1, 1.0),
        "initial_stiffness": 10.0 ** rng.uniform(2.5, 4.5),
        "viscous": rng.uniform(0.0, 0.1),
    }, rng


def reset(**values):
    return st.FrictionModel(
        "reset_integrator", coulomb=F_C, breakaway=F_S, initial_stiffness=K_0, **values
    )


@pytest.mark.parametrize("seed", range(3))
def test_the_reset_integrator_follows_its_oracle(seed):
    values, rng = drawn(seed)
    values |= {
        "breakaway": values["coulomb"] * rng.uniform(1.0, 2.0),
        "damping": rng.uniform(0.0, 1.0),
    }
    velocity = wander(seed, values["breakaway"] / values["initial_stiffness"])
    exact = reset_integrator.along(velocity, 1e-3, **values)
    ours = st.FrictionModel("reset_integrator", **values).simulate(velocity, 1e-3)
    assert np.abs(ours - exact).max() < 1e-9 * np.ptp(exact)


def test_a_bond_tears_at_break_away_and_falls_to_coulomb():
    law = reset(damping=0.0)
    z_0 = F_S / K_0
    force = law.simulate(np.full(200, 0.01 * z_0 / 1e-3), 1e-3)
    assert force[98] == pytest.approx(0.99 * F_S)
    assert force[105:] == pytest.approx(np.full(95, F_C))
    # Turned round it sticks, stretched as far as it can be.
    assert law.step(-1e-12, 1e-3) == pytest.approx(F_S, rel=1e-9)


@pytest.mark.parametrize("integrator", ["fast", "reference"])
def test_a_pulled_body_on_a_bond_rings_with_its_damping_and_breaks_away_at_its_level(integrator):
    inertia, damping = 0.0076, 0.45

    def machine():
        return st.Motor(inertia=inertia, friction=reset(damping=damping), integrator=integrator)

    run = machine().simulate(np.full(3000, 0.2), 1e-5)
    decay = damping / (2.0 * inertia)
    omega = np.sqrt(K_0 / inertia - decay**2)
    t = run.time
    exact = (
        0.2
        / K_0
        * (1.0 - np.exp(-decay * t) * (np.cos(omega * t) + decay / omega * np.sin(omega * t)))
    )
    assert np.abs(run.position - exact).max() < 1e-3 * 0.2 / K_0
    slow = machine()
    effort = np.linspace(0.0, 0.6, 60_000)
    position = slow.simulate(effort, 1e-4).position
    broken = effort[np.argmax(position > 1.2 * F_S / K_0)]
    assert broken == pytest.approx(F_S, rel=0.01)


@pytest.mark.parametrize("seed", range(3))
def test_micro_and_macro_dynamics_follow_their_oracle(seed):
    values, rng = drawn(seed)
    values["damping"] = rng.uniform(0.0, 1.0)
    velocity = wander(seed, values["coulomb"] / values["initial_stiffness"])
    exact = ro_hubbel.along(velocity, 1e-3, **values)
    ours = st.FrictionModel("ro_hubbel", **values).simulate(velocity, 1e-3)
    assert np.abs(ours - exact).max() < 1e-11 * np.ptp(exact)


def test_micro_dynamics_are_a_damped_spring_and_macro_dynamics_a_level_with_viscosity():
    # Eq. (4): (B + B_fr)·u' + K_fr·(u − u_md).
    law = st.FrictionModel("ro_hubbel", damping=0.45, viscous=0.1)
    v = 0.2 * F_C / K_0 / 1e-3
    micro = law.simulate(np.full(4, v), 1e-3)
    assert micro == pytest.approx(0.55 * v + K_0 * v * 1e-3 * np.arange(1, 5))
    macro = law.simulate(np.full(10, v), 1e-3)[2:]
    assert macro == pytest.approx(np.full(8, F_C + 0.1 * v))


@pytest.mark.parametrize("law", ["reset_integrator", "ro_hubbel"])
def test_a_bond_does_not_see_how_a_motion_is_divided_into_samples(law):
    velocity = wander(4, F_C / K_0)
    whole = st.FrictionModel(law).simulate(velocity, 1e-3)
    parts = st.FrictionModel(law).simulate(np.repeat(velocity, 9), 1e-3 / 9.0)[8::9]
    assert np.abs(parts - whole).max() < 1e-12 * np.ptp(whole)


@pytest.mark.parametrize("law", ["reset_integrator", "ro_hubbel"])
def test_a_body_that_tears_off_and_sticks_converges_with_the_sample(law):
    def end(integrator, divided):
        machine = st.Motor(inertia=0.0076, friction=st.FrictionModel(law), integrator=integrator)
        effort = 0.7 * np.sin(2.0 * np.pi * 10.0 * 1e-4 * np.arange(2000))
        return machine.simulate(np.repeat(effort, divided), 1e-4 / divided).position[-1]

    exact = end("reference", 8)
    errors = [abs(end("fast", divided) / exact - 1.0) for divided in (1, 2, 4)]
    assert errors[0] < 4e-3
    # Second order: a tear that is located to round-off costs none.
    assert errors[1] < 0.4 * errors[0]
    assert errors[2] < 0.4 * errors[1]
    assert end("reference", 1) == pytest.approx(exact, rel=1e-5)


def test_the_two_damped_bonds_are_the_same_law_where_nothing_falls():
    velocity = wander(9, F_C / K_0)
    one = st.FrictionModel("reset_integrator", coulomb=F_C, breakaway=F_C, viscous=0.05)
    other = st.FrictionModel("ro_hubbel", coulomb=F_C, viscous=0.05)
    same = other.simulate(velocity, 1e-3)
    assert np.allclose(one.simulate(velocity, 1e-3), same, rtol=0.0, atol=1e-13)
    assert np.abs(reset(viscous=0.05).simulate(velocity, 1e-3) - same).max() > 0.1 * F_C
