"""The hook and the Coulomb oracle against closed forms."""

import math

import numpy as np
import pytest

from .coulomb_reference import pulled_coulomb, simulate_coulomb, slide_closed_form
from .hook_reference import (
    HookedMachine,
    follow_motion_with_events,
    pulled_mass,
    simulate_with_events,
)
from .hsieh_pan_reference import ARC_SECOND, HsiehPanParameters, simulate_sticking
from .ladder_spring import branch_force

EVENT_TIME = 1e-10  # s, accuracy of located events
RIG = {"breakaway": 0.5, "coulomb": 0.35, "stribeck_velocity": 0.05, "elements": 128}
NO_CREEP = {"hardening_coefficient": 1e-12}


def hook_never_goes_back(out, machine):
    """Up to the ladder's error in x_s, which the derived x_hook inherits."""
    error = machine.spring.virgin_error_bound() / machine.parameters.final_stiffness
    return np.all(np.diff(out.hook) >= -error)


def test_drivers_agree_while_the_hook_sticks():
    pulses = np.concatenate((np.full(20, 0.15), np.zeros(30), np.full(20, -0.2), np.zeros(30)))
    fixed = simulate_sticking(pulses, 1e-3, elements=128)
    located, machine = simulate_with_events(pulses, 1e-3, elements=128)
    assert machine.events == []
    assert np.abs(fixed.position - located.position).max() < 2e-3 * ARC_SECOND
    assert np.abs(fixed.hardening - located.hardening).max() < 1e-4 * ARC_SECOND


def test_break_away_is_located_where_the_virgin_curve_meets_it():
    speed = 0.003
    _, machine = follow_motion_with_events(np.full(50, speed), 0.01, **RIG, **NO_CREEP)
    time, kind, force, _ = machine.events[0]
    assert kind == "break-away"
    assert time == pytest.approx(machine.spring.virgin_inverse(0.5) / speed, abs=EVENT_TIME)
    assert force == pytest.approx(0.5, abs=1e-10)


def test_slip_force_relaxes_over_the_slip_distance():
    speed, length = 0.04, 1e-3
    out, machine = follow_motion_with_events(
        np.full(40, speed), 1e-3, **RIG, **NO_CREEP, slip_distance=length, viscous=0.2
    )
    broke = machine.events[0][0]
    sliding = 0.35 + 0.15 * math.exp(-((speed / 0.05) ** 2)) + 0.2 * speed
    slipping = out.time > broke
    travelled = speed * (out.time[slipping] - broke)
    exact = sliding + (0.5 - sliding) * np.exp(-travelled / length)
    assert np.allclose(out.friction[slipping], exact, rtol=0, atol=1e-9)
    assert np.all(np.diff(out.hook[slipping]) > 0.0)


def test_reversed_slip_sticks_with_continuous_force_on_a_fresh_branch():
    p = HsiehPanParameters(**RIG)
    velocity = np.concatenate((np.full(30, 0.04), np.full(10, -0.002)))
    out, machine = follow_motion_with_events(velocity, 1e-3, **RIG, **NO_CREEP, damping=0.0)
    assert [e[1] for e in machine.events] == ["break-away", "velocity zero"]
    caught, kept = machine.events[1][2], out.spring_force[29]
    assert caught == kept
    back = 0.002 * (out.time[30:] - out.time[29])
    curve = (p.initial_stiffness, p.final_stiffness, p.decay_distance)
    tolerance = 2.0 * machine.spring.virgin_error_bound()
    assert np.allclose(out.friction[30:], kept - branch_force(back, *curve), rtol=0, atol=tolerance)


def test_slowing_hook_sticks_before_the_body_stops():
    # The Stribeck rise asks for 0.15 N m over 2e-6 rad, more than the spring can give.
    velocity = np.concatenate((np.full(20, 0.2), np.full(5, 0.01)))
    _, machine = follow_motion_with_events(
        velocity, 1e-3, **RIG, **NO_CREEP, slip_distance=2e-6, slip_method="Radau"
    )
    kinds = [e[1] for e in machine.events]
    assert kinds[:2] == ["break-away", "hook reversal"]
    assert machine.events[1][0] == pytest.approx(0.02, abs=1e-6)


def test_fast_break_away_never_moves_the_hook_backwards():
    # At 5 rad/s T is 0.85 N m, above break-away: the hook must wait for the spring.
    out, machine = follow_motion_with_events(
        np.full(40, 5.0), 1e-5, **RIG, **NO_CREEP, viscous=0.1, slip_distance=1e-5
    )
    assert [e[1] for e in machine.events] == ["break-away"]
    assert hook_never_goes_back(out, machine)
    assert out.friction[-1] == pytest.approx(0.85, abs=1e-3)


@pytest.mark.parametrize(("after_slip", "kept"), [("reset", False), ("keep", True)])
def test_hardening_after_slip_is_an_option(after_slip, kept):
    velocity = np.concatenate((np.full(100, 0.001), np.full(20, 0.04), [0.0]))
    out, machine = follow_motion_with_events(velocity, 0.005, **RIG, after_slip=after_slip)
    assert machine.mode == 0
    before = out.hardening[-2]
    assert before > 1e-5
    assert (out.hardening[-1] >= before) == kept


def test_break_away_falls_with_the_rate_of_loading():
    # A practically linear spring, pulled steadily: sigma = r t, q lags by r tau (1 - e^(-t/tau)).
    stiffness, speed, tau, scale = 1000.0, 0.002, 0.1, 3.0
    _, machine = follow_motion_with_events(
        np.full(60, speed),
        0.005,
        initial_stiffness=stiffness * (1.0 + 1e-9),
        final_stiffness=stiffness,
        loading_rate_scale=scale,
        loading_rate_time=tau,
        **RIG,
        **NO_CREEP,
    )
    time, _, force, _ = machine.events[0]
    rate = stiffness * speed * -math.expm1(-time / tau)
    assert force == pytest.approx(0.35 + 0.15 * math.exp(-rate / scale), abs=1e-7)
    assert force == pytest.approx(stiffness * speed * time, rel=1e-6)


def test_pulled_mass_keeps_its_force_and_latch_through_every_event():
    out, machine = pulled_mass(0.3, duration=0.9, viscous=0.05, **RIG)
    breaks = [e for e in machine.events if e[1] == "break-away"]
    assert len(breaks) >= 3
    assert np.allclose([e[2] for e in breaks], 0.5, rtol=0, atol=1e-9)
    assert hook_never_goes_back(out, machine)
    # A limit cycle: every later catch repeats the one before.
    caught = [e[2] for e in machine.events if e[1] != "break-away"]
    assert caught[-1] == pytest.approx(caught[1], abs=1e-3)


@pytest.mark.parametrize(
    ("viscous", "speed", "sticks"),
    [(0.05, 0.1, True), (0.05, 0.5, True), (0.05, 1.0, False), (0.1, 0.3, True), (0.1, 0.5, False)],
)
def test_stick_slip_gives_way_to_smooth_sliding(viscous, speed, sticks):
    _, machine = pulled_mass(speed, duration=1.0, sample_time=0.05, viscous=viscous, **RIG)
    catches = [e for e in machine.events if e[1] != "break-away"]
    assert (len(catches) >= 3) == sticks
    assert (machine.events[-1][0] < 0.3) == (not sticks)


def test_stiff_contact_stick_slips_like_coulomb():
    # Nearly rigid: contact 250 times as stiff as the pulling spring, flank and fall narrow.
    _, machine = pulled_mass(
        0.2,
        duration=0.5,
        initial_stiffness=6000.0,
        final_stiffness=5000.0,
        breakaway=0.5,
        coulomb=0.35,
        stribeck_velocity=1e-3,
        slip_distance=5e-6,
        elements=128,
        **NO_CREEP,
    )
    breaks = [e[0] for e in machine.events if e[1] == "break-away"]
    rigid = pulled_coulomb(0.2, 20.0, inertia=0.0076, coulomb=0.35, breakaway=0.5)
    assert breaks[-1] - breaks[-2] == pytest.approx(sum(rigid), rel=0.02)


def test_machine_at_rest_stays_at_rest():
    out, machine = simulate_with_events(np.zeros(20), 0.01, **RIG)
    assert np.all(out.position == 0.0)
    assert isinstance(machine, HookedMachine)


COULOMB = {"inertia": 0.0076, "coulomb": 0.35, "viscous": 0.05}


@pytest.mark.parametrize("viscous", [0.0, 0.05])
def test_located_and_exact_coulomb_slides_agree(viscous):
    rng = np.random.default_rng(3)
    effort = np.repeat(rng.uniform(-1.0, 1.0, 40), 5)
    law = COULOMB | {"viscous": viscous}
    located = simulate_coulomb(effort, 0.01, **law)
    exact = simulate_coulomb(effort, 0.01, slide=slide_closed_form, **law)
    for name in ("position", "velocity", "friction"):
        assert np.allclose(located[name], exact[name], rtol=0, atol=1e-8)
    assert np.any(exact["velocity"] == 0.0)
    assert np.any(exact["velocity"] < 0.0)


def test_coulomb_stops_after_the_exact_distance():
    out = simulate_coulomb(np.zeros(100), 0.001, velocity=1.0, **COULOMB | {"viscous": 0.0})
    assert out["position"][-1] == pytest.approx(0.0076 / (2.0 * 0.35), rel=1e-9)
    assert out["velocity"][-1] == 0.0


def test_stuck_shaft_does_not_creep():
    out = simulate_coulomb(np.full(1000, 0.34), 3.6, **COULOMB)
    assert np.all(out["position"] == 0.0)
    assert np.all(out["friction"] == 0.34)


def test_coulomb_starts_only_above_break_away():
    effort = np.concatenate((np.full(10, 0.49), np.full(10, 0.51), np.full(10, 0.4)))
    out = simulate_coulomb(effort, 0.01, breakaway=0.5, stribeck_velocity=0.05, **COULOMB)
    assert np.all(out["position"][:10] == 0.0)
    assert np.all(np.diff(out["position"][9:]) > 0.0)
    assert out["velocity"][-1] > 0.0
