"""Laws on the spring with memory: Futami's regions and the Preisach plane."""

import numpy as np
import pytest
from scipy.integrate import dblquad
from tests.reference.laws import futami, preisach

import stiction as st

F_C, K_0 = 0.35, 3000.0
REACH = F_C / K_0
# 20 000 elements, or widths, of the oracles.
ORACLE_SHARE = 1e-6


def wander(seed, reach, n=150):
    """Moves from a hundredth of a reach to five of them."""
    rng = np.random.default_rng(seed)
    return reach * 10.0 ** rng.uniform(-2.0, 0.7, n) * rng.choice([-1.0, 1.0], n) / 1e-3


def moved(model, places):
    """Friction after each straight move to a place."""
    return model.simulate(np.diff(places, prepend=0.0) / 1e-3, 1e-3)


def loop_loss(model, low, high, points=20_001):
    """Work of one cycle between two places, entered at the lower one."""
    up = np.linspace(low, high, points)
    place = np.concatenate((up, up[-2::-1]))
    force = moved(model, place)
    return float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(place)))


@pytest.mark.parametrize("seed", range(3))
def test_futami_follows_its_oracle(seed):
    rng = np.random.default_rng(seed)
    values = {
        "coulomb": rng.uniform(0.1, 1.0),
        "initial_stiffness": 10.0 ** rng.uniform(2.5, 4.5),
        "linear_share": rng.uniform(0.01, 0.8),
        "curve_exponent": rng.uniform(1.5, 6.0),
        "viscous": rng.uniform(0.0, 0.1),
    }
    velocity = wander(seed, values["coulomb"] / values["initial_stiffness"])
    exact = futami.along(velocity, 1e-3, **values)
    ours = st.FrictionModel("futami", **values).simulate(velocity, 1e-3)
    assert np.abs(ours - exact).max() < ORACLE_SHARE * np.ptp(exact)


def guide(x_1=100e-9, x_2=100e-6, level=10.0, exponent=3.0):
    """A linear guide with Futami's lengths."""
    share = exponent / (exponent + x_2 / x_1 - 1.0)
    law = st.FrictionModel(
        "futami",
        coulomb=level,
        initial_stiffness=share * level / x_1,
        linear_share=share,
        curve_exponent=exponent,
    )
    return law, share * level / x_1


def test_futamis_guide_is_a_straight_line_up_to_100_nm_and_rolls_from_100_um():
    law, stiffness = guide()
    places = np.linspace(0.0, 100e-9, 21)[1:]
    assert moved(law, places) == pytest.approx(stiffness * places, rel=1e-12)
    assert abs(loop_loss(guide()[0], -99e-9, 99e-9)) < 1e-12 * stiffness * 99e-9**2
    assert loop_loss(guide()[0], -150e-9, 150e-9) > 0.0
    rolling = moved(guide()[0], np.array([99e-6, 100e-6, 150e-6]))
    assert rolling[0] < 10.0
    assert rolling[1:] == pytest.approx([10.0, 10.0], rel=1e-12)


def test_every_reverse_point_begins_with_twice_the_linear_region():
    law, stiffness = guide()
    top = moved(law, [40e-6])[0]
    back = np.linspace(40e-6, 40e-6 - 200e-9, 11)
    line = top - stiffness * (40e-6 - back)
    got = moved(law, np.concatenate(([40e-6], back)) - 40e-6)[1:]
    assert got == pytest.approx(line, rel=1e-12)


def test_futamis_nested_loops_close():
    law, _ = guide()
    turns = 1e-6 * np.array([30.0, -10.0, 20.0, 0.0, 10.0, 5.0, 10.0, 0.0, 20.0, -10.0, 30.0])
    force = moved(law, turns)
    assert force[6:] == pytest.approx(force[4::-1], rel=1e-12)
    assert len(law.state["reverse_points"]) == 0


def plane(**values):
    return st.FrictionModel("preisach", coulomb=F_C, initial_stiffness=K_0, **values)


@pytest.mark.parametrize("seed", range(3))
def test_the_plane_follows_its_oracle(seed):
    rng = np.random.default_rng(seed)
    values = {
        "coulomb": rng.uniform(0.1, 1.0),
        "initial_stiffness": 10.0 ** rng.uniform(2.5, 4.5),
        "edge_density": rng.uniform(0.0, 3.5),
        "viscous": rng.uniform(0.0, 0.1),
    }
    velocity = wander(seed, values["coulomb"] / values["initial_stiffness"])
    exact = preisach.along(velocity, 1e-3, **values)
    ours = st.FrictionModel("preisach", **values).simulate(velocity, 1e-3)
    assert np.abs(ours - exact).max() < ORACLE_SHARE * np.ptp(exact)


@pytest.mark.parametrize("edge", [0.0, 0.5, 2.0, 3.5])
def test_the_plane_begins_with_its_stiffness_and_slides_at_its_level(edge):
    law = plane(edge_density=edge)
    assert moved(law, [1e-10])[0] == pytest.approx(K_0 * 1e-10, rel=1e-6)
    rise = moved(plane(edge_density=edge), np.linspace(0.0, 4.0 * REACH, 4001)[1:])
    assert np.all(np.diff(rise) >= -1e-14)
    assert rise[-1] == pytest.approx(F_C, rel=1e-12)


def density(edge):
    even = 1.0 / (2.0 + edge)
    reach = (4.0 * even + 4.0 / 3.0 * edge * even) * REACH
    return even, edge * even, reach


@pytest.mark.parametrize("middle", [0.0, 0.3, -0.6])
def test_a_loop_loses_what_its_relays_lose(middle):
    even, edge, reach = density(2.0)
    half = 0.25
    law = plane()
    loss = loop_loss(law, (middle - half) * reach, (middle + half) * reach)
    # The first cycle closes at its end only where the way there was outside of it.
    low = middle - half
    if abs(low) < abs(middle + half):
        law = plane()
        moved(law, np.array([middle + 2.0 * half]) * reach)
        shifted = [(low - middle - 2.0 * half) * reach, 0.5 * reach]
        moved(law, shifted[:1])
        high = 2.0 * half * reach
        loss = loop_loss(law, 0.0, high)
    relays = dblquad(
        lambda beta, alpha: 2.0 * (alpha - beta) * (even + edge * (0.5 * (alpha + beta)) ** 2),
        low,
        low + 2.0 * half,
        low,
        lambda alpha: alpha,
    )[0]
    form = 8.0 / 3.0 * half**3 * (even + edge * middle**2 + 0.1 * edge * half**2)
    assert form == pytest.approx(relays, rel=1e-9)
    assert loss == pytest.approx(F_C * reach * relays, rel=1e-5)


def test_small_loops_lose_more_near_break_away_with_an_uneven_density_only():
    for edge, ratio in ((0.0, 1.0), (2.0, 1.0 + 2.0 * 0.85**2)):
        _, _, reach = density(edge)
        losses = []
        for middle in (0.0, 0.85):
            law = plane(edge_density=edge)
            # Reached from below, after a way up beyond the loop and down to its lower end.
            moved(law, np.array([middle + 0.08]) * reach)
            moved(law, np.array([-0.13]) * reach)
            losses.append(loop_loss(law, 0.0, 0.1 * reach))
        assert losses[1] / losses[0] == pytest.approx(ratio, rel=2e-3)


def test_an_even_plane_is_maxwell_slip_with_evenly_spread_yield_points_and_an_uneven_one_is_not():
    velocity = wander(11, REACH, 400)
    ladder = st.FrictionModel(
        "maxwell_slip", coulomb=F_C, initial_stiffness=K_0, yield_shape=0.5
    ).simulate(velocity, 1e-3)
    assert np.abs(plane(edge_density=0.0).simulate(velocity, 1e-3) - ladder).max() < 1e-9 * F_C
    assert np.abs(plane().simulate(velocity, 1e-3) - ladder).max() > 0.02 * F_C


def test_a_slide_wipes_the_plane_out_wherever_it_leads():
    _, _, reach = density(2.0)
    mess, fresh = plane(), plane()
    moved(mess, 0.9 * reach * (-0.95) ** np.arange(50))
    assert len(mess.state["reverse_points"]) > 2
    for law in (mess, fresh):
        law.step(7.0, 1.0)
        assert len(law.state["reverse_points"]) == 0
    back = wander(5, REACH, 100)
    assert np.array_equal(mess.simulate(back, 1e-3), fresh.simulate(back, 1e-3))


@pytest.mark.parametrize("edge", [0.0, 2.0, 3.5])
def test_the_plane_gives_nothing_back_on_a_random_way(edge):
    _, _, reach = density(edge)
    law = plane(edge_density=edge)
    steps = np.random.default_rng(1).normal(0.0, 0.02 * reach, 200_000)
    force = np.concatenate(([0.0], law.simulate(steps / 1e-3, 1e-3)))
    work = np.cumsum(0.5 * (force[1:] + force[:-1]) * steps)
    assert work.min() > -1e-4 * F_C * reach
    assert work[-1] > 10.0 * F_C * reach
