"""What a rigid contact needs along a motion that was sampled: it stops and turns between stamps."""

import numpy as np
import pytest
from tests.reference.coulomb_reference import simulate_coulomb, slide_closed_form

import stiction as st

DT = 1e-3
INERTIA, COULOMB, VISCOUS = 0.006, 0.3, 0.03
COUNT = 2.0 * np.pi / 2**18


def machine():
    friction = st.FrictionModel("coulomb", coulomb=COULOMB, viscous=VISCOUS)
    return st.Motor(inertia=INERTIA, friction=friction)


def sampled(effort, velocity=0.0):
    """Positions at the stamps, and the mean of the friction over each sample, by its momentum."""
    run = simulate_coulomb(
        effort,
        DT,
        velocity=velocity,
        slide=slide_closed_form,
        inertia=INERTIA,
        coulomb=COULOMB,
        viscous=VISCOUS,
    )
    position = np.concatenate([[0.0], run["position"]])
    speeds = np.concatenate([[velocity], run["velocity"]])
    return position, effort - INERTIA * np.diff(speeds) / DT


def about(means):
    """Means over the sample before each stamp and the one after it; the last over one alone."""
    return np.append(0.5 * (means[:-1] + means[1:]), means[-1])


def wandering(seed, samples=4000):
    """Efforts that let the machine slide, stop, rest and turn round many times."""
    source = np.random.default_rng(seed)
    time = np.arange(samples) * DT
    turns = source.uniform(1.0, 9.0, 4)
    phases = source.uniform(0.0, 2.0 * np.pi, 4)
    waves = np.sin(2.0 * np.pi * np.outer(turns, time) + phases[:, None])
    return COULOMB * source.uniform(0.5, 0.9) * waves.sum(axis=0)


@pytest.mark.parametrize("phase", np.linspace(0.0, 0.95, 20))
def test_a_machine_that_coasts_to_rest_loses_its_momentum_wherever_in_a_sample_it_stops(phase):
    velocity = (40.0 + phase) * DT * COULOMB / INERTIA
    position, means = sampled(np.zeros(80), velocity)
    friction = machine().follow(st.Motion(position, np.zeros(80), DT, averaged=True))[2]
    lost = INERTIA * velocity
    assert np.sum(means) * DT == pytest.approx(lost, rel=1e-12)
    # The first half sample lies before the first stamp.
    found = (np.sum(friction) + 0.5 * means[0] - 0.5 * friction[-1]) * DT
    assert found == pytest.approx(lost, rel=1e-3)


@pytest.mark.parametrize("seed", range(4))
def test_friction_along_exact_positions_is_its_mean_about_each_stamp(seed):
    effort = wandering(seed)
    position, means = sampled(effort)
    turns = np.count_nonzero(np.diff(np.sign(means)))
    assert turns > 20
    assert np.count_nonzero(np.diff(position) == 0.0) > 20
    friction = machine().follow(st.Motion(position, effort, DT, averaged=True))[2]
    miss = friction - about(means)
    # A jump by 2·F_c that is placed half a sample wrong would alone be F_c in two rows.
    assert np.sqrt(np.mean(miss**2)) < 0.012 * COULOMB
    assert np.abs(miss).max() < 0.5 * COULOMB


@pytest.mark.parametrize("seed", range(4))
def test_stops_are_found_in_readings_rounded_to_counts(seed):
    effort = wandering(seed)
    position, means = sampled(effort)
    read = np.round(position / COUNT) * COUNT
    friction = machine().follow(st.Motion(read, effort, DT, averaged=True))[2]
    # Jumps placed at stamps, half a sample wrong at random, would leave about 5 %.
    kernel = np.hanning(30) / np.hanning(30).sum()
    miss = np.convolve(friction - about(means), kernel, "valid")
    assert np.sqrt(np.mean(miss**2)) < 0.012 * COULOMB


def test_a_contact_at_rest_answers_every_effort_as_long_as_it_can():
    effort = np.concatenate([np.linspace(0.0, 2.0 * COULOMB, 50), np.linspace(0.0, -0.2, 50)])
    drive, ambient, friction, _ = machine().follow(
        st.Motion(np.zeros(101), effort, DT, averaged=True)
    )
    held = np.clip(effort, -COULOMB, COULOMB)
    np.testing.assert_allclose(friction, about(held), atol=1e-15)
    np.testing.assert_array_equal(drive, effort)
    assert not ambient.any()


def test_slow_motion_over_counts_is_no_rest():
    # A count every other sample: no machine stops five hundred times a second.
    position = COUNT * np.floor(np.arange(400) / 2.0)
    friction = machine().follow(st.Motion(position, np.zeros(399), DT, averaged=True))[2]
    speed = 0.5 * COUNT / DT
    np.testing.assert_allclose(friction[4:-4], COULOMB + VISCOUS * speed, rtol=1e-12)


@pytest.mark.parametrize("name", ["torque_bias", "drive_deadband", "cogging", "stribeck"])
def test_a_signature_vanishes_where_a_contact_at_rest_answers_the_effect(name):
    shape = {"cogging": {"order": 3.0}, "stribeck": {"velocity": 0.1}}.get(name, {})
    rng = np.random.default_rng(3)
    effort = 0.5 * COULOMB * np.sin(np.arange(300) * 0.05) + 0.01 * rng.standard_normal(300)
    rest = st.Motion(np.full(301, 0.4), effort, DT, averaged=True)
    needed, driven, ahead = machine().signatures(rest, [(name, shape)])
    # As `follow` has it: half of the sample before a stamp and half of the one after.
    centred = np.array([about(row) for row in driven])
    np.testing.assert_allclose(needed, centred, atol=1e-12)
    assert not ahead.any()


def test_signatures_of_a_rigid_contact_are_derivatives_also_where_it_rests():
    effort = wandering(7, 1500)
    position, _ = sampled(effort)
    motion = st.Motion(position, effort, DT, averaged=True)
    names = ("torque_bias", "direction_asymmetry", "cogging", "viscous_quadratic")
    gains = {effect.name: effect.gains for effect in st.effects()}
    needed, driven, _ = machine().signatures(motion, [(name, {}) for name in names])
    place = 0
    for name in names:
        friction = st.FrictionModel("coulomb", coulomb=COULOMB, viscous=VISCOUS)
        other = st.Motor(inertia=INERTIA, friction=friction, effects={name: {}})
        for gain in gains[name]:
            alone = other.follow_sensitivity(motion, [f"effects.{name}.{gain}"])
            size = np.linalg.norm(alone[0][0])
            assert np.linalg.norm(needed[place] - alone[0][0]) <= 1e-9 * size, (name, gain)
            np.testing.assert_allclose(driven[place], alone[1][0], atol=1e-12)
            place += 1
