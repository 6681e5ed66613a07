"""A dry contact read by a coarse encoder lacks nothing, and its simulation says so."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from tests.diagnosis import builders

import stiction as st
from stiction.diagnosis.data.evidence import Evidence
from stiction.diagnosis.findings.conclude import surrogates_of
from stiction.diagnosis.screening.base import fit_baseline
from stiction.diagnosis.screening.model import fit_model
from stiction.diagnosis.selection.moved import _powers, borne_out_in_motion
from stiction.diagnosis.selection.search import Search
from stiction.fitting.forms import Through
from stiction.fitting.rows import Nuisances
from stiction.plant.parameter import Parameter
from stiction.plant.stated import Effect
from stiction.residual.shooting import ShootingForm

INERTIA, COULOMB, VISCOUS = 2.4e-3, 0.13, 7.5e-3
DT = 2e-3
COUNTS = 1024
NOTHING = Nuisances()
FLICKER = 0.2
"""Counts."""
LOG_NOISE = 0.02
"""Of the friction."""


def plant(**stated: float) -> st.Plant:
    """Of the machine, as far as it is stated."""
    friction = {name: stated[name] for name in ("coulomb", "viscous") if name in stated}
    raw: dict[str, Any] = {
        "motion": {"kind": "rotary"},
        "drive": {"input": "torque_nm"},
        "friction": {"law": "coulomb", **friction},
        "sensor": {"counts_per_rev": COUNTS},
    }
    return st.Plant.from_dict(raw | ({"body": {"inertia": stated["inertia"]}} if stated else {}))


TRUE = {"inertia": INERTIA, "coulomb": COULOMB, "viscous": VISCOUS}


@cache
def recordings(noise: float = 0.0, number: int = 4, seconds: float = 10.0) -> list[st.Recording]:
    """Sums of sines, simulated from rest and read by the encoder."""
    found = []
    for k in range(number):
        rng = np.random.default_rng([59, k])
        time = np.arange(round(seconds / DT)) * DT
        hertz, phase = rng.uniform(0.2, 2.0, 4), rng.uniform(0.0, 2.0 * np.pi, 4)
        waves = np.sin(2.0 * np.pi * time[:, None] * hertz + phase)
        given = COULOMB * rng.uniform(0.8, 1.4) * waves.sum(axis=1)
        motor = plant(**TRUE).motor()
        moved = motor.simulate(given[:-1], np.full(len(time) - 1, DT)).position
        step = 2.0 * np.pi / COUNTS
        flicker = FLICKER * rng.standard_normal(len(time))
        read = step * np.round(np.concatenate([[0.0], moved]) / step + flicker)
        logged = given + noise * COULOMB * rng.standard_normal(len(time))
        found.append(st.Recording(time, input=logged, position=read, kind="sines"))
    return found


STUCK = {"inertia": 0.5, "coulomb": 10.0, "viscous": 1.0}
"""Of an arm that nothing moves beyond its break-away."""


@cache
def below() -> list[st.Recording]:
    """Of Dahl's spring at half its break-away, read well."""
    friction = {name: STUCK[name] for name in ("coulomb", "viscous")}
    spring = st.FrictionModel("dahl", initial_stiffness=4e4, **friction)
    found = []
    for k in range(3):
        time = np.arange(2500) * 4e-3
        given = 0.5 * STUCK["coulomb"] * np.sin(2.0 * np.pi * (0.5 + 0.1 * k) * time)
        moved = st.Motor(STUCK["inertia"], friction=spring).simulate(given[:-1], 4e-3).position
        rng = np.random.default_rng([60, k])
        read = np.concatenate([[0.0], moved]) + 2e-7 * rng.standard_normal(len(time))
        found.append(st.Recording(time, input=given, position=read, kind="below"))
    return found


def test_a_dry_contact_and_a_coarse_encoder_lack_nothing() -> None:
    found = st.diagnose(plant(), recordings(), threads=1)
    assert found.verdict == "nothing_missing"
    assert not found.effects
    assert "simulated" in found.data["residual"]


def test_errors_of_readings_bend_no_parameter() -> None:
    _, base = fit_baseline(plant(), recordings())
    friction = base.plant.friction.parameters
    assert base.plant.inertia == pytest.approx(INERTIA, rel=0.01)
    assert friction["coulomb"].value == pytest.approx(COULOMB, rel=0.01)
    assert friction["viscous"].value == pytest.approx(VISCOUS, rel=0.02)


def test_what_is_exact_is_not_simulated() -> None:
    exact = [replace_position(recording) for recording in recordings()]
    stated = replace(plant(), sensor={})
    evidence, base = fit_baseline(stated, exact)
    assert not evidence.simulated
    assert base.plant.inertia == pytest.approx(INERTIA, rel=1e-3)


def replace_position(recording: st.Recording) -> st.Recording:
    """The same recording of a machine whose position is known as it is, and its input roughly."""
    assert recording.input is not None
    motor = plant(**TRUE).motor()
    steps = np.diff(recording.time)
    moved = motor.simulate(recording.input[:-1], steps).position
    rng = np.random.default_rng(len(recording))
    logged = recording.input + LOG_NOISE * COULOMB * rng.standard_normal(len(recording))
    position = np.concatenate([[0.0], moved])
    return st.Recording(recording.time, input=logged, position=position, kind="sines")


def test_a_residual_does_not_vanish_with_the_inertia() -> None:
    stuck = plant(**TRUE | {"coulomb": 100.0 * COULOMB})
    form = ShootingForm(plant(**TRUE), recordings()[0], horizon=0.3)
    light = stuck.with_values({"body.inertia": 1e-3 * INERTIA})
    moved = INERTIA * np.std(form.acceleration)
    assert np.std(form.residual(stuck)) > 0.5 * moved
    assert np.std(form.residual(light)) > 0.5 * moved


def test_replays_scatter_as_the_recording_does() -> None:
    evidence, base = fit_baseline(plant(), recordings(LOG_NOISE))
    assert evidence.simulated
    null, _ = surrogates_of(evidence, base, 12, 0)
    assert np.mean(null**2) == pytest.approx(np.mean(base.residual**2), rel=0.3)


def test_a_cause_that_freezes_the_machine_is_taken_back() -> None:
    known = plant(**TRUE)
    evidence = Evidence(known, recordings())
    limited = Effect(
        "drive_saturation", {"share": Parameter(1.0), "limit": Parameter(0.9 * COULOMB)}
    )
    models = [
        builders.model(evidence, each) for each in (known, replace(known, effects=(limited,)))
    ]
    named = builders.search("drive_saturation", models=models)
    left = borne_out_in_motion(named, evidence)
    assert not left.choices
    # As much as it gained has no name: it passed all else.
    assert left.imitated == named.choices[0].winner.gain > 0.0


def test_a_cause_is_taken_back_that_is_further_off_than_a_machine_that_hardly_moves() -> None:
    """Below break-away a dry contact that is too weak flies off, and any limit holds it back."""
    loose = replace(plant(**STUCK | {"coulomb": 1.0}), sensor={})
    evidence = Evidence(loose, below())
    limited = Effect("drive_saturation", {"share": Parameter(1.0), "limit": Parameter(2.0)})
    models = [
        builders.model(evidence, each) for each in (loose, replace(loose, effects=(limited,)))
    ]
    powers = _powers(models, evidence)
    assert powers is not None
    assert powers.left[1].sum() < 0.5 * powers.left[0].sum()
    named = builders.search("drive_saturation", models=models)
    assert not borne_out_in_motion(named, evidence).choices


def test_recordings_that_decide_are_asked_without_those_that_are_fitted() -> None:
    known = plant(**TRUE)
    evidence = Evidence(known, recordings())
    (plan,) = evidence.plans
    deciding = evidence.rows_with(plan.held)
    assert 0 < len(deciding) < len(evidence.shown)
    own = evidence.residual(known, NOTHING, deciding)
    assert np.array_equal(own, evidence.residual(known, NOTHING)[plan.held])


def test_rows_that_test_stay_sealed_while_motion_is_asked() -> None:
    known = plant(**TRUE)
    evidence = Evidence(known, recordings(), through=Through())
    assert borne_out_in_motion(Search([]), evidence).choices == []
    assert evidence.sealed


def test_a_plant_that_stands_still_where_the_machine_moved_lacks_something() -> None:
    """A dry contact holds whatever acts on it."""
    told = st.diagnose(replace(plant(), sensor={}), below(), threads=1)
    assert told.verdict not in ("nothing_missing", "missing_effect")
    assert not any(cause.decided for cause in told.effects)


WAVE = 0.15 * COULOMB
ORDER = 20.0


def with_wave(stated: st.Plant) -> st.Plant:
    """The same with a cogging, as `waved` has it."""
    values = {"order": Parameter(ORDER, fixed=True)}
    values |= {name: Parameter(0.6 * WAVE) for name in ("cosine", "sine")}
    return replace(stated, effects=(Effect("cogging", values),))


@cache
def waved() -> list[st.Recording]:
    """Sums of sines of the machine with a cogging, simulated from rest and read by the encoder."""
    found = []
    for k in range(3):
        rng = np.random.default_rng([66, k])
        time = np.arange(round(8.0 / DT)) * DT
        hertz, phase = rng.uniform(0.2, 2.0, 4), rng.uniform(0.0, 2.0 * np.pi, 4)
        given = 1.1 * COULOMB * np.sin(2.0 * np.pi * time[:, None] * hertz + phase).sum(axis=1)
        motor = with_wave(plant(**TRUE)).motor()
        moved = motor.simulate(given[:-1], np.full(len(time) - 1, DT)).position
        step = 2.0 * np.pi / COUNTS
        flicker = FLICKER * rng.standard_normal(len(time))
        read = step * np.round(np.concatenate([[0.0], moved]) / step + flicker)
        found.append(st.Recording(time, input=given, position=read, kind="sines"))
    return found


def test_windows_of_a_plant_begin_in_its_own_motion() -> None:
    bare = plant(**TRUE)
    whole = with_wave(bare)
    form = ShootingForm(bare, waved()[0], horizon=0.3)
    assert form.with_leader(None) is form
    assert form.with_leader(bare) is form
    own = form.with_leader(whole)
    assert own is form.with_leader(whole)
    assert np.std(own.residual(whole)) < 0.8 * np.std(form.residual(whole))
    assert np.std(own.residual(whole)) < 0.2 * np.std(form.residual(bare))


def test_a_fit_is_not_pulled_towards_the_plant_that_it_began_with() -> None:
    bare = plant(inertia=1.06 * INERTIA, coulomb=1.1 * COULOMB, viscous=VISCOUS)
    windows = Evidence(bare, waved(), through=Through(horizon=0.3))
    found = fit_model(windows, with_wave(bare), NOTHING)
    friction = found.plant.friction.parameters
    assert found.plant.inertia == pytest.approx(INERTIA, rel=1e-3)
    assert friction["coulomb"].value == pytest.approx(COULOMB, rel=2e-3)
    (effect,) = found.plant.effects
    assert effect.parameters["cosine"].value == pytest.approx(0.6 * WAVE, rel=0.025)
    assert effect.parameters["sine"].value == pytest.approx(0.6 * WAVE, rel=0.025)


def test_windows_of_what_begins_in_motion_begin_in_it() -> None:
    """Begun at rest, the run that leads them is behind for a time constant of its pull."""
    whole = recordings()[0]
    assert whole.input is not None
    assert whole.position is not None
    first = int(np.argmax(np.abs(np.gradient(whole.position))))
    rows = slice(first, None)
    late = st.Recording(
        whole.time[rows], input=whole.input[rows], position=whole.position[rows], kind="sines"
    )
    form = ShootingForm(plant(**TRUE), late, horizon=0.3)
    left = np.abs(form.residual(plant(**TRUE)))
    assert np.max(left[:4]) < 0.05 * INERTIA * np.max(np.abs(form.acceleration))
