"""Plants as differential equations, against the core's own steps."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiction as st
from stiction.ode import LAWS, equations, solve

DT = 1e-4
LEVELS = {"law": "coulomb", "coulomb": 0.3, "breakaway": 0.45, "stribeck_velocity": 0.2,
          "viscous": 0.03}  # fmt: skip


def plant(friction, *effects, **tables):
    return st.Plant.from_dict(
        {
            "drive": {"input": "current_a", "gain": 0.5},
            "body": {"inertia": 0.01},
            "friction": friction,
            "effects": list(effects),
        }
        | tables
    )


def current(time):
    return 1.1 * np.sin(9.0 * time) + 0.5 * np.sin(31.0 * time)


def stepped(machine, times, load=0.0):
    """The core under the same input: held, at the middle of each of many samples."""
    fine = 10
    dt = DT / fine
    middles = dt * (np.arange(fine * (len(times) - 1)) + 0.5)
    motor = machine.motor(integrator="reference")
    return motor.simulate(current(middles), dt, load=load).velocity[fine - 1 :: fine]


@pytest.mark.parametrize("law", [name for name in LAWS if name != "coulomb"])
def test_a_law_goes_as_in_the_core(law):
    own = {"damping_velocity": 0.4} if law in ("lugre", "elasto_plastic") else {}
    machine = plant({"law": law, "initial_stiffness": 300.0, "viscous": 0.02, **own})
    times = DT * np.arange(10_001)
    found = solve(machine, current, times)
    velocity = stepped(machine, times)
    assert np.ptp(velocity) > 1.0
    assert np.max(np.abs(found.velocity[1:] - velocity)) < 1e-4 * np.ptp(velocity)
    assert found.names == ("position", "velocity", found.names[2])
    assert found.evaluations > 100


def test_stick_and_slip_are_those_of_the_core():
    machine = plant(LEVELS)
    times = DT * np.arange(20_001)
    found, velocity = solve(machine, current, times), stepped(machine, times)
    assert len(found.switches) > 6
    assert np.max(np.abs(found.velocity[1:] - velocity)) < 1e-4 * np.ptp(velocity)
    # It rests in the same samples but for those in which something happens.
    rests = (found.velocity[1:] == 0.0) == (velocity == 0.0)
    assert np.mean(rests) > 0.999
    assert 0.05 < np.mean(velocity == 0.0) < 0.95


def test_stuck_means_stuck():
    machine = plant(LEVELS)
    times = np.linspace(0.0, 3600.0, 101)
    found = solve(machine, lambda _: 0.899, times, start=[0.123, 0.0])
    assert set(found.position.tolist()) == {0.123}
    assert not np.any(found.velocity)
    assert found.friction == pytest.approx(np.full(101, 0.4495))
    assert found.switches == ()


def test_it_breaks_away_when_more_acts_than_it_holds():
    machine = plant(LEVELS)
    # A ramp of 0.1 N·m/s that comes to 0.45 N·m after 4.5 s.
    found = solve(machine, lambda time: 0.2 * time, np.linspace(0.0, 5.0, 501))
    ((when, mode),) = found.switches
    assert when == pytest.approx(4.5, abs=1e-9)
    assert mode == 1
    assert not np.any(found.velocity[found.time <= 4.5])
    assert found.velocity[-1] > 0.1


def test_a_slide_that_is_turned_round_goes_on_the_other_way_at_once():
    machine = plant({"law": "coulomb", "coulomb": 0.1})
    found = solve(machine, lambda _: -1.0, np.linspace(0.0, 1.0, 101), start=[0.0, 3.0])
    ((when, mode),) = found.switches
    # 0.6 N·m slow it down, and it is at 3 rad/s.
    assert when == pytest.approx(0.05, rel=1e-6)
    assert mode == -1
    assert found.velocity[-1] == pytest.approx(-40.0 * 0.95, rel=1e-6)


def test_jumps_of_the_input_are_breaks():
    machine = plant({"law": "coulomb", "coulomb": 0.3})
    pulse = [(0.1, 0.11), (0.5, 0.52)]

    def pulses(time):
        return 2.0 if any(low <= time < high for low, high in pulse) else 0.0

    edges = [edge for pair in pulse for edge in pair]
    found = solve(machine, pulses, np.linspace(0.0, 1.0, 11), breaks=edges, max_step=1.0)
    held = np.array([pulses(1e-3 * (k + 0.5)) for k in range(1000)])
    own = machine.simulate(held, 1e-3)
    assert found.position[-1] == pytest.approx(own.position[-1], rel=1e-9)
    assert own.position[-1] > 0.01


def test_added_efforts_and_gravity_act():
    effects = [
        {"name": "cogging", "cosine": 0.1, "sine": -0.05, "order": 7.0, "sine_2": 0.03},
        {"name": "torque_bias", "bias": 0.05},
        {"name": "viscous_quadratic", "quadratic": 0.02},
    ]
    body = {"inertia": 0.01, "gravity_amplitude": 0.2, "gravity_zero_rad": 0.4}
    machine = plant(LEVELS, *effects, body=body)
    times = DT * np.arange(10_001)
    found = solve(machine, current, times, load=lambda _: -0.03)
    velocity = stepped(machine, times, load=-0.03)
    assert np.max(np.abs(found.velocity[1:] - velocity)) < 1e-4 * np.ptp(velocity)


def test_the_right_hand_side_goes_to_a_solver_of_ones_own():
    made = equations(plant(LEVELS), lambda _: 1.2)
    state = np.zeros(2)
    assert made.mode_at(0.0, state) == 1
    run = solve_ivp(made.rhs, (0.0, 0.5), state, args=(1,), events=made.events, rtol=1e-9)
    assert run.status == 0
    assert run.y[1, -1] > 1.0
    stopped = solve_ivp(made.rhs, (0.0, 0.5), [0.0, -1.0], args=(-1,), events=made.events)
    assert stopped.status == 1
    assert abs(stopped.y[1, -1]) < 1e-9


@pytest.mark.parametrize(
    ("friction", "effects", "words"),
    [
        ({"law": "hsieh_pan"}, (), "equations of hsieh_pan do not stand here"),
        (LEVELS, ({"name": "stribeck", "excess": 0.1},), "stribeck cannot be held"),
    ],
)
def test_what_is_not_held_is_a_sentence(friction, effects, words):
    with pytest.raises(st.InputError, match=words) as caught:
        equations(plant(friction, *effects), current)
    assert "stiction.control" in str(caught.value)


def test_what_is_none_is_a_sentence():
    machine = plant(LEVELS)
    with pytest.raises(st.InputError, match="no function of the time"):
        equations(machine, 3.0)
    with pytest.raises(st.InputError, match="times do not rise"):
        solve(machine, current, [0.0, 0.0])
    with pytest.raises(st.InputError, match="give position, velocity"):
        solve(machine, current, [0.0, 1.0], start=[0.0])
