"""Contacts of structural mechanics: elastic or rigid, then plastic."""

import numpy as np
import pytest
from tests.reference.laws import elastic_perfectly_plastic, rigid_perfectly_plastic

import stiction as st

F_C, K_0 = 0.35, 3000.0
REACH = F_C / K_0
# Of the level, against an oracle that integrates to 1e-12 over 120 samples.
ORACLE_SHARE = 1e-9


def moved(model, places, dt=1e-3):
    """Friction after each straight move to a place."""
    return model.simulate(np.diff(places, prepend=0.0) / dt, dt)


def elastic(**values):
    return st.FrictionModel(
        "elastic_perfectly_plastic", coulomb=F_C, initial_stiffness=K_0, **values
    )


def loss_of_a_cycle(law, amplitude, cycles=1, points=4000):
    """Work per cycle of the last one, by the trapezoid over fine steps."""
    angle = np.linspace(0.0, 2.0 * np.pi * cycles, points * cycles + 1)
    place = amplitude * np.sin(angle)
    force = moved(law, place[1:])
    last = slice(points * (cycles - 1), None)
    path, force = place[1:][last], force[last]
    return float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(path)))


@pytest.mark.parametrize("seed", range(4))
def test_an_elastic_contact_follows_its_oracle(seed):
    rng = np.random.default_rng(seed)
    values = {
        "coulomb": rng.uniform(0.1, 1.0),
        "initial_stiffness": 10.0 ** rng.uniform(2.5, 4.5),
        "unhardened_share": rng.uniform(0.05, 1.0),
        "viscous": rng.uniform(0.0, 0.1),
    }
    reach = values["coulomb"] / values["initial_stiffness"]
    values["hardening_distance"] = reach * 10.0 ** rng.uniform(-2.0, 1.0)
    # From a hundredth of the elastic reach a sample to thirty of them.
    velocity = reach * 10.0 ** rng.uniform(-2.0, 1.5, 120) * rng.choice([-1.0, 1.0], 120) / 1e-3
    exact = elastic_perfectly_plastic.along(velocity, 1e-3, **values)
    model = st.FrictionModel("elastic_perfectly_plastic", **values)
    ours = model.simulate(velocity, 1e-3)
    assert np.abs(ours - exact).max() < ORACLE_SHARE * (values["coulomb"] + np.abs(exact).max())
    finer = st.FrictionModel("elastic_perfectly_plastic", **values)
    finer = finer.simulate(np.repeat(velocity, 7), 1e-3 / 7.0)[6::7]
    assert np.abs(finer - ours).max() < 1e-12 * np.abs(exact).max()


@pytest.mark.parametrize("times", [0.5, 1.0, 2.0, 7.0])
def test_a_cycle_of_an_elastic_contact_loses_four_levels_times_the_slide(times):
    amplitude = times * REACH
    loss = loss_of_a_cycle(elastic(), amplitude, cycles=2)
    exact = 4.0 * F_C * max(0.0, amplitude - REACH)
    assert loss == pytest.approx(exact, rel=2e-3, abs=1e-3 * F_C * REACH)


def test_an_unhardened_contact_slides_at_its_share_and_hardens_in_either_direction():
    share, distance = 0.4, 5e-4
    law = elastic(unhardened_share=share, hardening_distance=distance)
    first = moved(law, np.linspace(0.0, 1.1 * share * REACH, 200)[1:])
    assert first.max() < 1.1 * share * F_C
    # Back and forth: the ways slid add up, the spring's do not.
    turns = 20 * REACH * np.array([1.0, -1.0, 1.0, -1.0])
    level = np.abs(moved(law, turns))
    assert np.all(np.diff(level) > 0.0)
    slid = law.state["hardening"]
    assert level[-1] == pytest.approx(F_C * (1.0 - (1.0 - share) * np.exp(-slid / distance)))
    assert slid == pytest.approx(20 * REACH * 7 - 2 * REACH * 3 - REACH, rel=0.05)


def test_without_hardening_it_is_one_element_of_a_ladder():
    rng = np.random.default_rng(3)
    moves = rng.normal(0.0, 1.0, 400) * REACH
    stretch, ladder = 0.0, []
    for move in moves:
        stretch = float(np.clip(stretch + move, -REACH, REACH))
        ladder.append(K_0 * stretch)
    assert np.abs(elastic().simulate(moves / 1e-3, 1e-3) - ladder).max() < 1e-13 * F_C


def test_an_elastic_contact_at_rest_keeps_its_force_to_the_bit():
    law = elastic(unhardened_share=0.5)
    held = moved(law, [0.3 * REACH])[0]
    assert np.all(law.simulate(np.zeros(100), 10.0, effort=0.2) == held)


def test_a_pulled_body_rings_at_the_frequency_of_the_contact_and_does_not_slide():
    inertia, dt = 0.0076, 1e-5
    machine = st.Motor(inertia=inertia, friction=elastic())
    run = machine.simulate(np.full(4000, 0.4 * F_C), dt)
    omega = np.sqrt(K_0 / inertia)
    exact = 0.4 * REACH * (1.0 - np.cos(omega * run.time))
    assert np.abs(run.position - exact).max() < 2e-3 * REACH


def test_a_start_force_stands_in_the_spring():
    machine = st.Motor(inertia=0.0076, friction=elastic())
    held = machine.follow(st.Motion(np.zeros(11), np.zeros(10), 1e-3), start={"force": 0.2})[2]
    assert held == pytest.approx(np.full(10, 0.2))


def rigid(**values):
    return st.FrictionModel("rigid_perfectly_plastic", coulomb=F_C, **values)


@pytest.mark.parametrize("seed", range(3))
def test_a_rigid_contact_follows_its_oracle(seed):
    rng = np.random.default_rng(seed)
    values = {
        "coulomb": rng.uniform(0.1, 1.0),
        "unhardened_share": rng.uniform(0.05, 0.95),
        "hardening_distance": 10.0 ** rng.uniform(-3.0, -1.0),
        "viscous": rng.uniform(0.0, 0.1),
    }
    velocity = 10.0 ** rng.uniform(-3.0, 0.0, 100) * rng.choice([-1.0, 0.0, 1.0], 100)
    exact = rigid_perfectly_plastic.along(velocity, 1e-3, **values)
    ours = st.FrictionModel("rigid_perfectly_plastic", **values).simulate(velocity, 1e-3)
    assert np.abs(ours - exact).max() < ORACLE_SHARE * values["coulomb"]


def test_a_rigid_contact_holds_up_to_its_present_level_and_not_beyond():
    share, distance = 0.6, 1e-2
    law = rigid(unhardened_share=share, hardening_distance=distance)
    for way in (0.0, 0.003, 0.02, 1.0):
        if way:
            law.step(-way / 1e-3, 1e-3)
        slid = law.state["hardening"]
        level = F_C * (1.0 - (1.0 - share) * np.exp(-slid / distance))
        assert law.step(0.0, 1e-3, effort=0.999 * level) == 0.999 * level
        assert law.step(0.0, 1e-3, effort=-5.0) == pytest.approx(-level, rel=1e-12)


def test_a_rigid_contact_without_hardening_is_coulomb_and_with_it_differs():
    rng = np.random.default_rng(1)
    current = np.repeat(rng.uniform(-0.6, 0.6, 40), 50)

    def run(law):
        return st.Motor(inertia=0.0076, friction=law).simulate(current, 1e-3).position

    coulomb = run(st.FrictionModel("coulomb", coulomb=F_C, viscous=0.05))
    assert np.array_equal(run(rigid(unhardened_share=1.0, viscous=0.05)), coulomb)
    hardened = run(rigid(viscous=0.05))
    assert np.abs(hardened - coulomb).max() > 0.01 * np.ptp(coulomb)


def test_each_push_of_a_rigid_contact_goes_less_far_than_the_one_before():
    machine = st.Motor(
        inertia=0.0076, friction=rigid(unhardened_share=0.5, hardening_distance=0.02)
    )
    push = np.concatenate((np.full(200, 0.33), np.zeros(800)))
    rests = [0.0] + [machine.simulate(push, 1e-4).position[-1] for _ in range(5)]
    ways = np.diff(rests)
    assert np.all(ways > 0.0)
    assert np.all(np.diff(ways) < 0.0)
    # It rests, to the bit.
    run = machine.simulate(np.full(10_000, 0.1), 1e-3)
    assert np.all(run.position == rests[-1])


@pytest.mark.parametrize("integrator", ["fast", "reference"])
def test_a_push_that_hardens_the_contact_stops_where_its_energy_is_spent(integrator):
    # ∫F_y dκ over the way equals the kinetic energy at the start.
    share, distance, inertia = 0.5, 0.02, 0.0076
    machine = st.Motor(
        inertia=inertia,
        friction=rigid(unhardened_share=share, hardening_distance=distance),
        integrator=integrator,
    )
    machine.reset(0.0, 2.0)
    way = machine.simulate(np.zeros(3000), 1e-4).position[-1]
    work = F_C * (way - (1.0 - share) * distance * (1.0 - np.exp(-way / distance)))
    assert work == pytest.approx(0.5 * inertia * 4.0, rel=1e-4)
