"""A rotor pulled through a spring."""

from __future__ import annotations

import numpy as np
import pytest

from stiction import paper
from stiction.errors import InputError

STEP = 1e-4  # s
# Share of the amplitude by which a finer step may change it; the prototype saw 0.1 %.
AMPLITUDE = 2e-3


def amplitude(run):
    numbers = run.numbers
    return (
        numbers["greatest torque of the spring"].value - numbers["least torque of the spring"].value
    )


@pytest.mark.parametrize("speed", [0.05, 0.1, 0.3, 0.5])
def test_slow_pulling_sticks_and_slips(speed):
    run = paper.stick_slip(speed, dt=STEP)
    assert run.numbers["break-aways"].value > 1
    assert run.numbers["share of time standing still"].value > 0.1
    assert amplitude(run) > 0.2


def test_fast_pulling_slides_smoothly():
    run = paper.stick_slip(1.0, dt=STEP)
    assert run.breakaways == 1
    assert run.numbers["break-aways"].value == 0
    assert np.ptp(run.velocity[len(run.velocity) // 2 :]) < 0.05


def test_amplitude_does_not_depend_on_the_step():
    wide, fine = (amplitude(paper.stick_slip(0.1, dt=dt)) for dt in (4e-4, 1e-4))
    assert wide == pytest.approx(fine, rel=AMPLITUDE)


def test_both_integrators_stick_and_slip_alike():
    one, other = (
        amplitude(paper.stick_slip(0.1, dt=STEP, integrator=name)) for name in ("reference", "fast")
    )
    assert one == pytest.approx(other, rel=AMPLITUDE)


def test_standing_still_is_not_a_speed():
    with pytest.raises(InputError, match="speed"):
        paper.stick_slip(0.0)
