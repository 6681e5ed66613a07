"""What is said of a parameter that ended at a bound: only a stated one can be widened."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.fit.test_fit import NOISE, plant, recorded

from stiction import Plant, Recording, fit
from stiction.fitting import FitResult


def ended(viscous: dict[str, Any] | None, push: float) -> tuple[FitResult, str]:
    """A fit where something adds ``push`` N·m·s/rad to the input, and the sentence of its bound."""
    seen = recorded()
    assert seen.position is not None
    assert seen.input is not None
    speed = np.gradient(seen.position, seen.dt)
    pushed = Recording(seen.time, seen.input + push * speed, seen.position)
    own: dict[str, Any] = {} if viscous is None else {"viscous": viscous}
    machine: Plant = plant(friction={"law": "coulomb", **own})
    found = fit(machine, pushed)
    (said,) = (each for each in found.bounds_hit if "viscous" in each)
    return found, said


def test_what_ends_at_0_has_no_bound_to_widen() -> None:
    found, said = ended(None, -0.08)
    assert found["friction.viscous"].value == pytest.approx(0.0, abs=NOISE)
    assert "widen" not in said
    assert "0" in said


def test_a_bound_of_the_plant_file_is_one_to_widen() -> None:
    _, said = ended({"value": 0.05, "max": 0.06}, 0.1)
    assert "widen the bound" in said
