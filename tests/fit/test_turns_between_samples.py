"""What a contact that yields leaves to its own true plant, along a motion sampled coarsely."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

import stiction as st
from stiction.residual.weak_form import WeakForm

INERTIA, LEVEL, STIFFNESS, VISCOUS = 0.0067, 0.9, 18.9, 0.024
FINE = 64
"""Steps of the simulation here in a sample of a recording."""


def recorded(dt: float, damping: float) -> st.Recording:
    """Bristles of dahl or, with damping, of lugre, under inputs that are held; by steps of its own.

    The deflection and the speed take turns (leapfrog), FINE times in each sample.
    """
    samples, h = round(30.0 / dt), dt / FINE
    time = np.arange(samples + 1) * dt
    held = 2.0 * LEVEL * np.sin(2.0 * np.pi * (0.1 + 0.075 * time) * time) + 0.3 * LEVEL
    position: npt.NDArray[np.float64] = np.zeros(samples + 1)
    x = v = z = 0.0
    drag = VISCOUS + damping
    for k in range(samples):
        for _ in range(FINE):
            x += 0.5 * h * v
            # dz/dt = v - |v| z / reach, exactly over the step at this speed.
            reach = LEVEL / STIFFNESS
            end = reach * np.sign(v)
            z = end + (z - end) * np.exp(-abs(v) * h / reach)
            rate = v - abs(v) * z / reach
            v += (
                h
                * (held[k] - STIFFNESS * z - damping * rate - VISCOUS * v)
                / (INERTIA + 0.5 * h * drag)
            )
            x += 0.5 * h * v
        position[k + 1] = x
    return st.Recording(time, held, position)


def left(law: str, dt: float, damping: float = 0.0) -> float:
    """rms of the residual of the true plant, as a share of the level of its friction."""
    own = {"law": law, "coulomb": LEVEL, "initial_stiffness": STIFFNESS, "viscous": VISCOUS}
    own |= {"damping": damping} if law == "lugre" else {"exponent": 1.0}
    plant = st.Plant.from_dict(
        {
            "motion": {"kind": "rotary"},
            "drive": {"input": "torque_nm", "gain": 1.0},
            "body": {"inertia": INERTIA},
            "friction": own,
        }
    )
    form = WeakForm(plant, recorded(dt, damping), every=0.005)
    return float(np.sqrt(np.mean(form.residual(plant)[20:] ** 2))) / LEVEL


@pytest.mark.parametrize(
    ("dt", "most"),
    [(0.01, 3e-3), (0.004, 6e-4), (0.001, 5e-5)],
)
def test_a_contact_that_yields_is_followed_to_where_it_turns(dt: float, most: float) -> None:
    """Straight from stamp to stamp it left 1.4e-2, 3.4e-3 and 2.2e-4."""
    assert left("dahl", dt) < most


@pytest.mark.parametrize(("dt", "most"), [(0.01, 1.4e-2), (0.004, 4e-3)])
def test_one_that_is_damped_as_well(dt: float, most: float) -> None:
    """It left 1.7e-2 and 5.1e-3: what damps goes by velocities at the stamps."""
    assert left("lugre", dt, damping=0.2) < most
