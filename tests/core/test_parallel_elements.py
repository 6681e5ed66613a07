"""Elements that harden in parallel, stops with a density."""

import numpy as np
import pytest
from tests.reference.laws import parallel_elements, prandtl_ishlinskii

import stiction as st

F_C, K_0 = 0.35, 3000.0
REACH = F_C / K_0
RULES = ["kinematic", "isotropic", "independent"]
# Round-off of 200 samples against the oracle's own.
ORACLE_SHARE = 1e-11


def wander(seed, reach, n=200):
    """Moves from a hundredth of a reach to ten of them."""
    rng = np.random.default_rng(seed)
    return reach * 10.0 ** rng.uniform(-2.0, 1.0, n) * rng.choice([-1.0, 1.0], n) / 1e-3


def moved(model, places):
    """Friction after each straight move to a place."""
    return model.simulate(np.diff(places, prepend=0.0) / 1e-3, 1e-3)


def drawn(seed):
    rng = np.random.default_rng(seed)
    return {
        "coulomb": rng.uniform(0.1, 1.0),
        "initial_stiffness": 10.0 ** rng.uniform(2.5, 4.5),
        "viscous": rng.uniform(0.0, 0.1),
    }, rng


@pytest.mark.parametrize("hardening", RULES)
@pytest.mark.parametrize("seed", range(3))
def test_elements_follow_their_oracle(hardening, seed):
    values, rng = drawn(seed)
    values |= {
        "yield_spread": rng.uniform(0.0, 0.95),
        "hardening_share": rng.uniform(0.0, 0.5),
    }
    velocity = wander(seed, values["coulomb"] / values["initial_stiffness"])
    exact = parallel_elements.along(velocity, 1e-3, hardening=hardening, **values)
    model = st.FrictionModel("parallel_elements", hardening=hardening, **values)
    assert np.abs(model.simulate(velocity, 1e-3) - exact).max() < ORACLE_SHARE * np.ptp(exact)
    finer = st.FrictionModel("parallel_elements", hardening=hardening, **values)
    finer = finer.simulate(np.repeat(velocity, 5), 2e-4)[4::5]
    assert np.abs(finer - exact).max() < ORACLE_SHARE * np.ptp(exact)


@pytest.mark.parametrize("seed", range(3))
def test_stops_follow_their_oracle(seed):
    values, rng = drawn(seed)
    values["density_decay"] = rng.uniform(-5.0, 10.0)
    velocity = wander(seed, values["coulomb"] / values["initial_stiffness"])
    exact = prandtl_ishlinskii.along(velocity, 1e-3, **values)
    model = st.FrictionModel("prandtl_ishlinskii", **values)
    assert np.abs(model.simulate(velocity, 1e-3) - exact).max() < ORACLE_SHARE * np.ptp(exact)


def elements(**values):
    return st.FrictionModel(
        "parallel_elements", coulomb=F_C, initial_stiffness=K_0, yield_spread=0.0, **values
    )


def yield_range(law, forwards):
    """Forces of one element where it begins to yield backwards after a way forwards."""
    top = moved(law, [forwards])[0]
    lower = law.state["yield_shifts"][:, 0].sum() - F_C
    return top, lower


def test_yielding_one_way_moves_the_other_yield_point_by_the_rule():
    h, way = 0.1, 5.0 * REACH
    top = F_C + h * K_0 * (way - REACH)
    expected = {"kinematic": top - 2.0 * F_C, "isotropic": -top, "independent": -F_C}
    for rule, lower in expected.items():
        got = yield_range(elements(hardening=rule, hardening_share=h), way)
        assert got == pytest.approx((top, lower), rel=1e-12)


def test_kinematic_elements_are_plain_ones_beside_a_spring():
    h = 0.2
    velocity = wander(7, REACH)
    hardened = elements(hardening_share=h).simulate(velocity, 1e-3)
    plain = st.FrictionModel(
        "elastic_perfectly_plastic", coulomb=(1 - h) * F_C, initial_stiffness=(1 - h) * K_0
    ).simulate(velocity, 1e-3)
    spring = h * K_0 * np.cumsum(velocity) * 1e-3
    assert np.abs(hardened - plain - spring).max() < 1e-12 * np.ptp(hardened)


def test_isotropic_cycles_shake_down_and_kinematic_ones_go_on_losing():
    amplitude = 3.0 * REACH
    turns = amplitude * np.where(np.arange(60) % 2, -1.0, 1.0)
    loss = {}
    for rule in RULES:
        law = elements(hardening=rule, hardening_share=0.3)
        moved(law, turns)
        fine = amplitude * np.cos(np.linspace(np.pi, 3.0 * np.pi, 4001))
        force = moved(law, np.concatenate(([fine[0]], fine)) - turns[-1])[1:]
        loss[rule] = float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(fine)))
    assert abs(loss["isotropic"]) < 1e-6 * K_0 * amplitude**2
    exact = 4.0 * 0.7 * F_C * (amplitude - REACH)
    assert loss["kinematic"] == pytest.approx(exact, rel=1e-3)
    assert loss["isotropic"] < 1e-3 * loss["kinematic"]


@pytest.mark.parametrize("law", ["prandtl_ishlinskii", "parallel_elements"])
def test_reverse_points_are_recovered_and_branches_are_twice_the_first_loading(law):
    still = {"hardening_share": 0.0} if law == "parallel_elements" else {}
    a, b, c, d = REACH * np.array([3.0, -1.0, 2.0, 0.0])
    forces = moved(st.FrictionModel(law, **still), [a, b, c, d, c, b, a])
    assert forces[4] == pytest.approx(forces[2], abs=1e-13)
    assert forces[5] == pytest.approx(forces[1], abs=1e-13)
    assert forces[6] == pytest.approx(forces[0], abs=1e-13)
    for way in REACH * np.array([0.3, 1.0, 2.5]):
        first = moved(st.FrictionModel(law, **still), [way])[0]
        branch = moved(st.FrictionModel(law, **still), [9 * REACH, 9 * REACH - 2.0 * way])
        assert branch[0] - branch[1] == pytest.approx(2.0 * first, rel=1e-12)


@pytest.mark.parametrize("decay", [-4.0, 0.0, 3.0, 12.0])
def test_stops_begin_with_the_stiffness_slide_at_the_level_and_lose_by_their_density(decay):
    law = st.FrictionModel("prandtl_ishlinskii", density_decay=decay)
    assert moved(law, [1e-9])[0] == pytest.approx(K_0 * 1e-9, rel=1e-12)
    assert moved(law, [1.0])[0] == pytest.approx(F_C, rel=1e-12)
    spots = np.arange(0.5, 10) / 10
    weights = np.exp(-decay * spots)
    weights *= K_0 / weights.sum()
    thresholds = spots * F_C / (weights @ spots)
    amplitude = 1.3 * REACH
    angle = np.linspace(0.0, 4.0 * np.pi, 80_001)
    place = amplitude * np.sin(angle)
    force = moved(st.FrictionModel("prandtl_ishlinskii", density_decay=decay), place)
    half = 0.5 * (force[40_001:] + force[40_000:-1])
    loss = float(np.sum(half * np.diff(place[40_000:])))
    exact = np.sum(4.0 * weights * thresholds * np.maximum(0.0, amplitude - thresholds))
    assert loss == pytest.approx(exact, rel=1e-5)


@pytest.mark.parametrize("law", ["prandtl_ishlinskii", "parallel_elements"])
def test_gradients_see_where_the_kinks_lie(law):
    # A body pulled through every kink: position by the level, against a fine difference.
    effort = np.linspace(0.0, 0.6, 200)

    def end(coulomb):
        machine = st.Motor(inertia=0.0076, friction=st.FrictionModel(law, coulomb=coulomb))
        return machine.simulate(effort, 1e-3).position[-1]

    machine = st.Motor(inertia=0.0076, friction=st.FrictionModel(law, coulomb=F_C))
    exact = machine.sensitivity(effort, 1e-3, ["friction.coulomb"])[0][0][-1]
    chord = (end(F_C * (1 + 1e-3)) - end(F_C * (1 - 1e-3))) / (2e-3 * F_C)
    assert exact == pytest.approx(chord, rel=2e-3)
