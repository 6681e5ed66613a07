"""Dahl's loop with a memory of reverse points, beside Dahl without one."""

import numpy as np
import pytest
from tests.reference.laws import dahl_with_memory as oracle

import stiction as st

DT = 1e-3
PAPER = {"coulomb": 0.5, "initial_stiffness": 2063.0, "exponent": 2.0}
REACH = 0.5 / 2063.0
# The oracle's chords.
ORACLE_SHARE = 1e-4


def moved(name, displacements, **values):
    """Friction after each of these displacements."""
    model = st.FrictionModel(name, **values)
    return np.array([model.step(d / DT, DT) for d in displacements]), model


@pytest.mark.parametrize("exponent", [0.6, 1.0, 1.5, 2.0, 3.0])
def test_random_motions_follow_sliders_without_number(exponent):
    values = {"coulomb": 0.35, "initial_stiffness": 3000.0, "exponent": exponent, "viscous": 0.02}
    velocity = np.random.default_rng(5).uniform(-1.0, 1.0, 150) * 0.35 / 3000.0 / DT
    friction = oracle.along(velocity, DT, **values)
    ours = st.FrictionModel("dahl_with_memory", **values).simulate(velocity, DT)
    assert np.abs(ours - friction).max() < ORACLE_SHARE * 0.35


@pytest.mark.parametrize("exponent", [0.5, 1.0, 1.5])
def test_between_the_coulomb_levels_it_is_dahls_loop(exponent):
    values = {"coulomb": 0.35, "initial_stiffness": 3000.0, "exponent": exponent}
    model, plain = (st.FrictionModel(name, **values) for name in ("dahl_with_memory", "dahl"))
    # A long way: the one is at F_c but for a tail, the other is put there.
    model.simulate(np.full(4000, 0.05), 1.0)
    tail = 0.35 - model.state["spring_force"]
    assert tail < 1e-4
    plain.state = plain.state | {"dry_friction": 0.35, "direction": 1.0}
    back = np.full(40, -2e-5 / DT)
    gap = np.abs(model.simulate(back, DT) - plain.simulate(back, DT)).max()
    assert gap <= 1.01 * tail + 1e-9


def test_loops_of_static_1_close_where_dahls_drift():
    # Displacements over which this law goes 0.16, 0.02, 0.16 N·m.
    def place(name, forces):
        model, places, at = st.FrictionModel(name, **PAPER), [], 0.0
        for force in forces:
            low, high = -20.0 * REACH, 20.0 * REACH
            for _ in range(200):
                middle = 0.5 * (low + high)
                if model.trial((middle - at) / DT, DT)[0] < force:
                    low = middle
                else:
                    high = middle
            model.step((low - at) / DT, DT)
            at = low
            places.append(at)
        return np.array(places) * 180.0 * 3600.0 / np.pi

    forces = [0.16, 0.02, 0.16, 0.02, 0.16]
    ours, theirs = place("dahl_with_memory", forces), place("dahl", forces)
    assert ours[2] - ours[0] == pytest.approx(0.0, abs=1e-9)
    assert ours[4] - ours[0] == pytest.approx(0.0, abs=1e-9)
    assert theirs[2] - theirs[0] == pytest.approx(11.25, abs=0.01)


def test_reverse_points_are_recovered_and_loops_wiped_out():
    turns = np.array([3.0, -2.0, 2.0, -1.0, 1.5, 0.0, 1.0]) * REACH
    path = np.concatenate((turns, turns[-2::-1], [4.0 * REACH]))
    forces, model = moved("dahl_with_memory", np.diff(path, prepend=0.0), **PAPER)
    inward, outward = forces[:7], forces[7:13]
    assert outward == pytest.approx(inward[-2::-1], abs=1e-12)
    assert len(model.state["reverse_points"]) == 0
    assert forces[-1] == pytest.approx(moved("dahl_with_memory", path[-1:], **PAPER)[0][0])


def test_it_is_the_closed_ladder_of_maxwell_slip_with_other_names():
    velocity = np.random.default_rng(2).uniform(-1.0, 1.0, 300)
    ours = st.FrictionModel(
        "dahl_with_memory", coulomb=0.35, initial_stiffness=1000.0, exponent=1.5
    ).simulate(velocity, 1e-4)
    ladder = st.FrictionModel(
        "maxwell_slip", coulomb=0.35, initial_stiffness=1000.0 * 2.0**1.5, yield_shape=-0.5
    ).simulate(velocity, 1e-4)
    assert ours == pytest.approx(ladder, rel=1e-12)


def test_noise_of_a_measured_position_leaves_the_force():
    noise = np.random.default_rng(0).uniform(-0.4, 0.4, 5001) * 0.05 * REACH
    left = {}
    for name in ("dahl_with_memory", "dahl"):
        model = st.FrictionModel(name, **PAPER)
        model.step(REACH / DT, DT)
        held = model.step(0.0, DT)
        left[name] = model.simulate(np.diff(noise) / DT, DT)[-200:].mean() / held
    assert left["dahl_with_memory"] > 0.8
    assert left["dahl"] < 0.3
