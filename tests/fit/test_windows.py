"""Fits that go on simulated over windows, and what is told of it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.fit.test_fit import TRUE, plant, recorded

from stiction import InputError, Plant, fit
from stiction.fitting import first_pass, forms
from stiction.fitting.forms import followable, residual_sentence, restore_bounds, shows_its_ring
from stiction.fitting.minimise import Solution, launch
from stiction.fitting.rows import Rows
from stiction.residual.shooting import ShootingForm
from stiction.residual.weak_form import WeakForm


def bristles(stiffness: float | dict[str, Any], **others: float) -> Plant:
    own = {"law": "lugre", "coulomb": 0.3, "initial_stiffness": stiffness, **others}
    return plant("lugre", friction=own, body={"inertia": TRUE["inertia"]})


def test_a_rigid_contact_is_not_simulated_stiffer_and_stiffer() -> None:
    """Bristles on a machine without any: of a ring that no sample shows nothing is believed."""
    windows = [ShootingForm(plant(), recorded(), horizon=0.1)]
    stiff = bristles(1e9, damping=50.0)
    held = followable(stiff, windows).friction.parameters["initial_stiffness"]
    assert held.value == held.max
    assert not shows_its_ring(followable(stiff, windows), windows)
    damping = followable(stiff, windows).friction.parameters["damping"]
    # Critically, at the stiffness where it ends.
    critical = 2.0 * np.sqrt(held.value * TRUE["inertia"])
    assert damping.max == pytest.approx(critical, rel=1e-12)
    assert damping.value == min(50.0, critical)
    back = restore_bounds(followable(stiff, windows), stiff).friction.parameters
    assert back["damping"].max is None
    soft = bristles(100.0)
    assert followable(soft, windows).friction.parameters["initial_stiffness"].value == 100.0


def test_a_contact_that_is_made_softer_ends_below_where_it_begins() -> None:
    windows = [ShootingForm(plant(), recorded(), horizon=0.1)]
    own = {"law": "hsieh_pan", "initial_stiffness": 1e9, "final_stiffness": 9e8}
    stiff = plant("hsieh_pan", friction=own, body={"inertia": TRUE["inertia"]})
    softer = followable(stiff, windows)
    found = softer.friction.parameters
    assert found["initial_stiffness"].value < 1e9
    ratio = found["final_stiffness"].value / found["initial_stiffness"].value
    assert ratio == pytest.approx(0.9, rel=1e-12)
    softer.motor()


@pytest.mark.parametrize("most", [None, 5e4])
def test_the_end_of_what_windows_follow_is_no_bound_of_the_plant(most: float | None) -> None:
    windows = [ShootingForm(plant(), recorded(), horizon=0.1)]
    stated = {"value": 100.0} if most is None else {"value": 100.0, "max": most}
    given = bristles(stated)
    held = followable(given, windows)
    assert held.friction.parameters["initial_stiffness"].max is not None
    back = restore_bounds(held, given).friction.parameters["initial_stiffness"]
    assert (back.value, back.max) == (100.0, most)


def test_what_is_told_of_the_residual_is_true_of_the_plant() -> None:
    """Readings of 24 µrad: of a reach of 3 mrad they tell all, of 0.3 µrad nothing."""
    seen = [WeakForm(plant(), recorded(), every=0.005)]
    assert "fine enough" in residual_sentence(seen, plant())
    assert "fine enough" in residual_sentence(seen, bristles(100.0))
    assert "shows little" in residual_sentence(seen, bristles(5e4))
    assert "faster than it was sampled" not in residual_sentence(seen, bristles(5e4))
    assert "faster than it was sampled" in residual_sentence(seen, bristles(1e6))


def test_an_interrupt_over_windows_that_are_given_up_is_not_lost(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found: list[Solution] = []

    def launched(*given: Any, **named: Any) -> Solution:
        if not found:
            found.append(launch(*given, **named))
            return found[0]
        return replace(found[0], interrupted=True, success=False, message="interrupted")

    monkeypatch.setattr(first_pass, "launch", launched)
    monkeypatch.setattr(first_pass, "horizon_of", lambda *_: 0.1)
    best = fit(bristles({"value": 1e6, "fixed": True}), recorded(4000))
    assert not best.success
    assert "interrupted" in best.message
    assert best["body.inertia"].value == found[0].plant.inertia


def test_the_stiffest_contact_that_windows_follow_is_no_bound_to_widen(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(first_pass, "horizon_of", lambda *_: 0.1)
    monkeypatch.setattr(forms, "BEYOND_SHOWN", 2e-3)
    found = fit(bristles(100.0), recorded(4000))
    stiffness = found["friction.initial_stiffness"]
    assert stiffness.at_bound == "upper"
    assert stiffness.value == pytest.approx(2e-3 * TRUE["inertia"] * (np.pi / 1e-3) ** 2, rel=0.05)
    assert found.plant.friction.parameters["initial_stiffness"].max is None
    (said,) = (each for each in found.bounds_hit if "initial_stiffness" in each)
    assert "the stiffest contact that can be simulated" in said
    assert "widen" not in said


def test_a_bound_that_was_stated_is_one_to_widen() -> None:
    found = fit(bristles({"value": 100.0, "max": 150.0}), recorded(4000))
    assert found["friction.initial_stiffness"].at_bound == "upper"
    (said,) = (each for each in found.bounds_hit if "initial_stiffness" in each)
    assert "widen" in said


def test_a_plant_that_runs_away_from_every_start_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    gone = np.full_like
    whole = Rows.residual
    monkeypatch.setattr(Rows, "residual", lambda *given: gone(whole(*given), np.nan), raising=True)
    with pytest.raises(InputError, match=r"runs away from every start .* in recording 1;"):
        fit(plant(), recorded())


def test_a_plant_that_cannot_be_simulated_leaves_windows_as_they_are() -> None:
    """A contact too stiff for the samples: no error ends what asked for it."""
    windows = ShootingForm(plant(), recorded(), horizon=0.1)
    stiff = bristles(1e12, damping=50.0)
    assert np.all(np.isnan(windows.residual(stiff)))
    windows.go_by(stiff)
    assert np.all(windows.unit == TRUE["inertia"])
    columns = windows.signatures(stiff, [("cogging", {}), ("stribeck", {"velocity": 0.1})])
    assert columns.shape == (len(windows), 3)
    assert np.all(columns == 0.0)
