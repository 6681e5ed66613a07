"""The oracle of rate-and-state friction against what is published of it, and closed forms."""

import math

import numpy as np
import pytest

from .rate_and_state_reference import (
    AGEING,
    SLIP,
    RateAndState,
    along,
    carried,
    critical_stiffness,
    pulled,
)

BOTH = pytest.mark.parametrize("evolution", [AGEING, SLIP])
MICRON = 1e-6


@BOTH
def test_a_step_of_speed_by_e_raises_friction_by_a_and_lets_it_fall_to_a_less_b(evolution):
    law = RateAndState(evolution=evolution, speed=MICRON, distance=10.0 * MICRON)
    fast = math.e * law.speed
    dt = 0.01 * law.distance / fast
    before = law.steady(law.speed)
    friction, psi = along(law, np.full(2000, fast), dt)
    assert law.force(fast, law.psi_at(law.speed)) - before == pytest.approx(law.a, rel=1e-9)
    assert friction[-1] - before == pytest.approx(law.a - law.b, rel=1e-6)
    # A slip distance later exp(-1) is left of ln theta (slip) or of theta (ageing).
    after = psi[99] - law.psi_at(fast)
    left = math.exp(-1.0)
    expected = left if evolution == SLIP else math.log1p((math.e - 1.0) * left)
    assert after == pytest.approx(expected, rel=1e-8)


def test_ageing_heals_by_b_for_each_factor_e_of_hold_and_slip_does_not():
    holds = 10.0 ** np.arange(2.0, 7.0)
    for evolution, slope in ((AGEING, 0.015), (SLIP, 0.0)):
        law = RateAndState(evolution=evolution)
        peaks = []
        for hold in holds:
            _, psi = along(law, [0.0], hold)
            peaks.append(law.force(law.speed, float(psi[-1])))
        growth = np.diff(peaks) / np.diff(np.log(holds))
        # The first hold still shows that theta starts at D_c/V_0, 10 s.
        assert growth[1:] == pytest.approx(np.full(3, slope), rel=0.02, abs=1e-12)


@BOTH
@pytest.mark.parametrize("share", [0.8, 1.25])
def test_steady_sliding_on_a_spring_is_stable_above_the_critical_stiffness(evolution, share):
    law = RateAndState(evolution=evolution)
    stiffness = share * critical_stiffness(law)
    # Near the critical stiffness it swings with sqrt((b - a)/a)·V/D_c.
    period = 2.0 * math.pi * math.sqrt(law.a / (law.b - law.a)) * law.distance / law.speed
    time, speeds = pulled(law, stiffness, law.speed, 6.0 * period, kick=1e-3)
    first = np.abs(speeds[time < 1.5 * period]).max()
    last = np.abs(speeds[time > time[-1] - 1.5 * period]).max()
    assert (last < 0.5 * first) == (share > 1.0)
    assert (last > 1.5 * first) == (share < 1.0)


def test_a_body_under_half_its_limit_creeps_at_the_speed_that_asinh_says():
    law = RateAndState(mu_0=0.5, a=0.05, b=0.0, speed=1e-3)
    half = 0.5 * law.mu_0
    run = carried(law, np.full(5, half), 1.0, inertia=0.01)
    creep = 2.0 * law.speed * math.exp(-law.mu_0 / law.a) * math.sinh(half / law.a)
    assert run["velocity"][-1] == pytest.approx(creep, rel=1e-6)
    assert run["friction"][-1] == pytest.approx(half, rel=1e-8)
    assert run["position"][-1] == pytest.approx(5.0 * creep, rel=1e-3)
