"""Curves of steady friction and of effort over the position, against equations by hand."""

import numpy as np
import pytest

import stiction as st

SPEEDS = np.array([-3.0, -0.2, -0.01, 0.0, 0.01, 0.2, 3.0])


def plant(friction, *effects, **parts):
    table = {
        "motion": {"kind": "rotary"},
        "drive": {"input": "torque_nm", "gain": 1.0},
        "body": {"inertia": 0.01},
        "friction": friction,
        "effects": list(effects),
    }
    return st.Plant.from_dict(table | parts)


def test_a_dry_contact_is_that_of_stribeck():
    law = {"coulomb": 0.3, "breakaway": 0.5, "stribeck_velocity": 0.1, "viscous": 0.02}
    curve = plant({"law": "coulomb", **law}).friction_curve(SPEEDS)
    size = 0.3 + 0.2 * np.exp(-((SPEEDS / 0.1) ** 2))
    assert curve == pytest.approx(np.sign(SPEEDS) * size + 0.02 * SPEEDS, rel=1e-9)


@pytest.mark.parametrize("law", ["lugre", "elasto_plastic", "gms"])
def test_a_law_with_bristles_slides_as_its_stribeck_curve(law):
    numbers = {"coulomb": 0.3, "breakaway": 0.5, "stribeck_velocity": 0.1, "viscous": 0.02}
    curve = plant({"law": law, **numbers}).friction_curve([0.01, 0.2, 3.0])
    speeds = np.array([0.01, 0.2, 3.0])
    by_hand = 0.3 + 0.2 * np.exp(-((speeds / 0.1) ** 2)) + 0.02 * speeds
    assert curve == pytest.approx(by_hand, rel=2e-3)


@pytest.mark.parametrize("law", [each.name for each in st.laws()])
def test_every_law_has_a_curve(law):
    curve = plant({"law": law}).friction_curve([-1.0, 0.0, 1.0])
    assert np.all(np.isfinite(curve))
    assert curve[0] < 0.0 == curve[1] < curve[2]


def test_effects_that_go_with_the_speed_are_in_the_curve():
    law = {"law": "coulomb", "coulomb": 0.3}
    uneven = plant(
        law,
        {"name": "direction_asymmetry", "coulomb": 0.1},
        {"name": "viscous_quadratic", "quadratic": 0.05},
        {"name": "cogging", "cosine": 0.04, "order": 6.0},
        {"name": "warm_up", "coulomb": 0.5, "time": 10.0},
        {"name": "input_delay", "delay": 0.01},
    )
    curve = uneven.friction_curve([-2.0, 2.0])
    assert curve == pytest.approx([-0.3 * 0.9 - 0.2, 0.3 * 1.1 + 0.2], rel=1e-5)


def test_what_goes_with_the_position_bears_gravity_and_waves():
    hanging = plant(
        {"law": "coulomb", "coulomb": 0.3},
        {"name": "cogging", "cosine": 0.04, "order": 6.0},
        {"name": "torque_bias", "bias": 0.02},
        {"name": "viscous_quadratic", "quadratic": 0.05},
        body={"inertia": 0.01, "gravity_amplitude": 0.5},
    )
    places = np.linspace(-4.0, 9.0, 31)
    by_hand = 0.5 * np.sin(places) - 0.04 * np.cos(6.0 * places) - 0.02
    assert hanging.position_effort(places) == pytest.approx(by_hand, abs=1e-12)
    assert hanging.position_effort([]).shape == (0,)
    assert hanging.position_effort(0.3).shape == ()


def test_curves_refuse_what_is_no_speed():
    for wrong in ([np.nan], ["a"], [[1.0], [2.0, 3.0]]):
        with pytest.raises(st.InputError, match="speeds"):
            plant({"law": "coulomb"}).friction_curve(wrong)
        with pytest.raises(st.InputError, match="positions"):
            plant({"law": "coulomb"}).position_effort(wrong)


@pytest.mark.parametrize("decay_distance", [1.0, 6e4, 1e6])
def test_a_length_that_never_acts_leaves_the_curve(decay_distance):
    # Data that hold no pre-sliding leave it open, and a fit ends anywhere.
    law = {"law": "hsieh_pan", "coulomb": 0.08, "breakaway": 0.08, "decay_distance": decay_distance}
    curve = plant({**law, "viscous": 0.005}).friction_curve([-1e-4, 1e-4, 2.0])
    assert curve == pytest.approx([-0.08, 0.08, 0.09], rel=1e-3)
