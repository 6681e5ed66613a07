"""Bristles that bond, stretch and break: Haessig and Friedland's first model."""

import numpy as np
import pytest
from tests.reference.laws import bristle

import stiction as st

F_C, K_0 = 0.35, 3000.0
REACH = F_C / K_0
# Places are told to 1e-16 of the way since the start.
ROUND_OFF = 1e-9


def drawn(seed):
    rng = np.random.default_rng(seed)
    values = {
        "coulomb": rng.uniform(0.1, 1.0),
        "initial_stiffness": 10.0 ** rng.uniform(2.5, 4.5),
        "viscous": rng.uniform(0.0, 0.1),
        "scatter": rng.uniform(0.0, 0.95),
        "seed": float(rng.integers(0, 1000)),
    }
    reach = values["coulomb"] / values["initial_stiffness"]
    way = reach * 10.0 ** rng.uniform(-2.0, 1.0, 150) * rng.choice([-1.0, 1.0], 150)
    return values, way / 1e-3


@pytest.mark.parametrize("seed", range(4))
def test_bristles_follow_their_oracle_at_any_step(seed):
    values, velocity = drawn(seed)
    exact = bristle.along(velocity, 1e-3, **values)
    ours = st.FrictionModel("bristle", **values).simulate(velocity, 1e-3)
    assert np.abs(ours - exact).max() < ROUND_OFF * np.ptp(exact)
    finer = st.FrictionModel("bristle", **values).simulate(np.repeat(velocity, 9), 1e-3 / 9.0)
    assert np.abs(finer[8::9] - exact).max() < ROUND_OFF * np.ptp(exact)


@pytest.mark.parametrize("scatter", [0.0, 0.5, 0.9])
def test_a_long_slide_has_the_mean_level_and_begins_with_the_stiffness(scatter):
    law = st.FrictionModel("bristle", coulomb=F_C, initial_stiffness=K_0, scatter=scatter)
    assert law.trial(1e-9 / 1e-3, 1e-3)[0] == pytest.approx(K_0 * 1e-9, rel=1e-6)
    force = law.simulate(np.full(400_000, 0.0103 * REACH / 1e-3), 1e-3)[2000:]
    assert force.mean() == pytest.approx(F_C, rel=3e-3)
    # Sites that do not scatter are passed one after the other: a saw of F_c/20·2, 1/√12 of it rms.
    saw = 0.1 * F_C / np.sqrt(12.0)
    if scatter == 0.0:
        assert force.std() == pytest.approx(saw, rel=0.01)
    else:
        assert 2.0 * saw < force.std() < 0.22 * F_C


def test_a_slide_repeats_at_each_place_and_seeds_differ():
    way = np.full(500, 1e-4 / 1e-3)
    one, other = (st.FrictionModel("bristle", seed=float(s)) for s in (1, 2))
    first = one.simulate(way, 1e-3)
    assert np.abs(first - other.simulate(way, 1e-3)).max() > 0.05 * F_C
    assert np.array_equal(st.FrictionModel("bristle", seed=1.0).simulate(way, 1e-3), first)
    back = one.simulate(-way, 1e-3)
    assert back[20:-20].mean() == pytest.approx(-F_C, rel=0.05)
    # Out again over the same sites: the same forces once every bristle has turned round.
    again = one.simulate(way, 1e-3)
    assert again[20:] == pytest.approx(first[20:], abs=ROUND_OFF)


def test_unscattered_sites_do_not_ask_for_a_seed():
    velocity = np.linspace(-0.3, 0.5, 200)
    runs = [
        st.FrictionModel("bristle", scatter=0.0, seed=s).simulate(velocity, 1e-3)
        for s in (1.0, 77.0)
    ]
    assert np.array_equal(*runs)


def slide(integrator, dt, **values):
    machine = st.Motor(
        0.0076, friction=st.FrictionModel("bristle", **values), integrator=integrator
    )
    effort = np.full(round(0.1 / dt), 0.8)
    run = machine.simulate(effort, dt)
    return run.time, run.position, run.velocity


def work(places, **values):
    """∫F dx from 0 to each place, by a fine walk of the oracle."""
    fine = np.linspace(0.0, places[-1], 400_001)
    force = bristle.along(np.diff(fine), 1.0, **values)
    # The force rises evenly between the points but for the breaks, which are many and small.
    lost = np.concatenate(
        [[0.0], np.cumsum(0.5 * np.diff(fine) * (force + np.append(0.0, force[:-1])))]
    )
    return np.interp(places, fine, lost)


@pytest.mark.long
@pytest.mark.parametrize(("dt", "share"), [(1e-3, 2e-2), (1e-4, 2e-4)])
def test_a_body_passes_many_breaks_in_a_step_and_loses_what_each_takes(dt, share):
    values = {
        "coulomb": F_C,
        "initial_stiffness": K_0,
        "scatter": 0.8,
        "seed": 5.0,
        "viscous": 0.0,
    }
    _, position, velocity = slide("fast", dt, **values)
    # More than a hundred bristles a sample break at the end.
    spacing = REACH / 0.4467 / bristle.BRISTLES
    assert velocity[-1] * 1e-3 > 100 * spacing
    kinetic = 0.5 * 0.0076 * velocity**2
    balance = 0.8 * position - work(position, **values)
    assert np.abs(kinetic - balance).max() < share * kinetic[-1]


def test_the_fast_integrator_converges_on_the_reference_through_a_slide():
    _, exact, _ = slide("reference", 1e-4, viscous=0.05)
    errors = []
    for dt in (4e-4, 2e-4, 1e-4):
        _, position, _ = slide("fast", dt, viscous=0.05)
        stride = round(dt / 1e-4)
        errors.append(np.abs(position - exact[stride - 1 :: stride]).max() / exact[-1])
    assert errors[0] < 1e-3
    assert errors[2] < 1e-4


@pytest.mark.parametrize("name", ["coulomb", "initial_stiffness"])
def test_derivatives_hold_where_the_same_breaks_fall_into_the_same_steps(name):
    # Some fifty breaks in 5 ms; a difference so small moves none of them into another step.
    values = {"coulomb": F_C, "initial_stiffness": K_0}
    effort = np.full(50, 0.8)

    def machine(factor):
        own = values | {name: values[name] * factor}
        return st.Motor(0.0076, friction=st.FrictionModel("bristle", **own))

    ends = [machine(f).simulate(effort, 1e-4) for f in (1.0, 1.0 + 1e-7, 1.0 - 1e-7)]
    assert ends[0].position[-1] > 2.0 * REACH / 0.4467
    found, _ = machine(1.0).sensitivity(effort, 1e-4, [f"friction.{name}"])
    chord = (ends[1].position[-1] - ends[2].position[-1]) / (2e-7 * values[name])
    assert found[0, -1] == pytest.approx(chord, rel=1e-5)


@pytest.mark.parametrize(
    "rows",
    [np.zeros((19, 2)), np.zeros((20, 2)), np.column_stack([np.arange(20), np.full(20, 0.5)])],
)
def test_sites_that_are_none_are_refused(rows):
    law = st.FrictionModel("bristle")
    with pytest.raises(st.InputError, match="sites"):
        law.state = law.state | {"sites": rows}
