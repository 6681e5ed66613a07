"""A contact that yields is led by a motion of its own where counts are steps of its pre-sliding."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import stiction as st
from stiction.diagnosis.screening.base import fit_baseline
from stiction.fitting.forms import windows_of
from stiction.fitting.readings import readings_mislead
from stiction.fitting.rows import Nuisances
from stiction.plant.parameter import Parameter
from stiction.residual.weak_form import WeakForm

REACH = 1e-4
"""rad, in which the contacts below break away."""
TRUE = {"coulomb": 0.3, "initial_stiffness": 0.3 / REACH, "viscous": 0.02}
DT = 1e-3
COGGING = {"name": "cogging", "cosine": 0.03, "order": 7.0}


def yielding(law: str, *effects: dict[str, Any], **stated: Any) -> st.Plant:
    """A contact that yields, as far as it is stated."""
    raw: dict[str, Any] = {"drive": {"input": "torque_nm"}, "body": {"inertia": 0.01}}
    raw |= {"friction": {"law": law, **stated}, "effects": list(effects)}
    return st.Plant.from_dict(raw)


@cache
def moved(law: str, cogs: bool = False, number: int = 4) -> list[tuple[Any, Any]]:
    """Sums of sines and the positions before each of their samples."""
    machine, found = yielding(law, *([COGGING] if cogs else []), **TRUE), []
    for k in range(number):
        rng = np.random.default_rng([67, k])
        time = np.arange(8000) * DT
        hertz, phase = rng.uniform(0.1, 3.0, 4), rng.uniform(0.0, 2.0 * np.pi, 4)
        size = rng.uniform(0.1, 0.35, 4)
        given = (size * np.sin(2.0 * np.pi * time[:, None] * hertz + phase)).sum(axis=1)
        found.append((given, machine.motor().simulate(given, DT).position))
    return found


def read(law: str, counts_in_reach: float, cogs: bool = False) -> list[st.Recording]:
    """The same over a reach of so many counts of the encoder."""
    count = REACH / counts_in_reach
    return [
        st.Recording(
            np.arange(len(given)) * DT,
            input=given,
            position=count * np.round(np.concatenate([[0.0], position[:-1]]) / count),
            kind="sines",
        )
        for given, position in moved(law, cogs)
    ]


@pytest.mark.parametrize("law", ["lugre", "maxwell_slip", "dahl"])
@pytest.mark.parametrize("counts", [5.0, 17.0])
def test_a_contact_that_counts_mislead_lacks_nothing(law: str, counts: float) -> None:
    """Readings make up to 8 % of the effort beside it, and no effect does."""
    found = st.diagnose(yielding(law), read(law, counts), threads=1)
    assert found.verdict == "nothing_missing"
    assert "near the readings by itself" in found.data["residual"]


def test_a_cause_is_found_though_counts_mislead_beside_it() -> None:
    """Along readings alone it left what nothing explained: they are most of what is left then."""
    found = st.diagnose(yielding("lugre"), read("lugre", 5.0, cogs=True), threads=1)
    assert [cause.name for cause in found.effects] == ["cogging"]
    assert found.effects[0].decided
    assert found.verdict == "missing_effect"
    assert "motion of its own" in found.data["residual"]  # over windows, where it stays unexplained


def test_readings_that_are_fine_lead_a_contact_themselves() -> None:
    evidence, base = fit_baseline(yielding("maxwell_slip"), read("maxwell_slip", 3000.0))
    assert not evidence.leads
    assert not readings_mislead(base.plant, base.nuisances, evidence.train)
    evidence, _ = fit_baseline(yielding("lugre"), read("lugre", 17.0))
    assert evidence.leads
    assert not evidence.simulated


def test_a_contact_that_is_rigid_is_asked_over_windows_instead() -> None:
    assert not readings_mislead(yielding("coulomb", coulomb=0.3, viscous=0.02), Nuisances(), [])


def test_friction_of_a_plant_that_is_right_goes_with_its_own_motion() -> None:
    machine = yielding("lugre", **TRUE)
    form = WeakForm(machine, read("lugre", 5.0)[0])
    assert not form.leads
    before = form.residual(machine)
    form.lead(machine, 120.0)
    assert form.leads
    assert np.std(form.residual(machine)) < 0.3 * np.std(before)
    # Another plant leads a copy, and the recording stays as it was.
    other = form.with_leader(yielding("lugre", **TRUE | {"coulomb": 0.31}))
    assert not np.array_equal(other.position, form.position)
    assert form.with_leader(machine) is form
    assert form.with_leader(None) is form


def test_a_drawn_contact_is_not_simulated() -> None:
    """Which place of it breaks in which window hangs on the last digits of its parameters."""
    assert yielding("bristle").friction.random
    assert not yielding("lugre").friction.random
    evidence, _ = fit_baseline(yielding("bristle", initial_stiffness=3e3), read("lugre", 5.0))
    assert not evidence.simulated


SPRING = {"coulomb": 0.61, "initial_stiffness": 158.5, "exponent": 1.0, "viscous": 0.56}


@cache
def slow(number: int, fastest: float, size: float = 0.4, seed: int = 68) -> list[st.Recording]:
    """Sines of a machine of .041 kg·m² up to a rate, at 250 Hz and ten counts to its reach."""
    machine = replace(yielding("dahl", **SPRING), body={"inertia": Parameter(0.041)})
    found = []
    for k in range(number):
        rng = np.random.default_rng([seed, k])
        time = np.arange(2500) * 4e-3
        hertz, phase = rng.uniform(0.05, fastest, 4), rng.uniform(0.0, 2.0 * np.pi, 4)
        given = size * np.sin(2.0 * np.pi * time[:, None] * hertz + phase).sum(axis=1)
        position = machine.motor().simulate(given[:-1], 4e-3).position
        count = 2.0 * np.pi / 16384
        readings = count * np.round(np.concatenate([[0.0], position]) / count)
        found.append(st.Recording(time, input=given, position=readings, kind="sines"))
    return found


def stated() -> st.Plant:
    """Its law alone."""
    exponent = {"value": 1.0, "fixed": True}
    return replace(yielding("dahl", exponent=exponent), body={})


def test_parameters_are_those_of_the_machine() -> None:
    """Along counts of a tenth of its reach the contact seemed nine times as stiff."""
    _, base = fit_baseline(stated(), slow(3, 2.0))
    friction = base.plant.friction.parameters
    assert base.plant.inertia == pytest.approx(0.041, rel=0.02)
    assert friction["initial_stiffness"].value == pytest.approx(158.5, rel=0.1)


@pytest.mark.parametrize(("fastest", "size"), [(0.5, 0.4), (0.3, 0.5)])
def test_windows_are_asked_where_an_inertia_hardly_shows(fastest: float, size: float) -> None:
    """Noise of the accelerations pulls it down by a sixth; led so, a sure delay made up for it."""
    found = st.diagnose(stated(), slow(5, fastest, size, seed=69), threads=1)
    assert found.verdict == "nothing_missing"
    assert "simulated from the measured state" in found.data["residual"]
    assert found.baseline.parameters["body.inertia"].value == pytest.approx(0.041, rel=0.02)


def test_a_long_session_is_not_searched_over_windows() -> None:
    plant = yielding("lugre", **TRUE)
    evidence, base = fit_baseline(yielding("lugre"), read("lugre", 17.0))
    rows = evidence.train
    assert windows_of(plant, evidence.forms, rows) is None
    assert windows_of(base.plant, evidence.forms, rows, yielding=True) is not None
    assert windows_of(base.plant, 6 * list(evidence.forms), rows, yielding=True) is None
