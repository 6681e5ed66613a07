"""The second residual: short simulations, where the encoder is too coarse to drive friction."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import stiction as st
from stiction.bench.ordinary.draw import Spec, ordinary
from stiction.bench.ordinary.files import write
from stiction.diagnosis.data.evidence import Evidence
from stiction.diagnosis.data.surrogates import surrogate_residuals
from stiction.diagnosis.screening.model import Model, fit_model
from stiction.fitting.forms import HORIZONS_S, Through, horizon_of, residual_sentence
from stiction.fitting.replay import noise_of
from stiction.fitting.rows import Nuisances
from stiction.residual.shooting import ShootingForm
from stiction.residual.weak_form import WeakForm

DT = 1e-3
COARSE, FINE = 2**12, 2**18
COULOMB, REACH = 0.25, 1.2e-3
BIAS = 0.01
NOISE = 0.004


def recorded(seed: int, counts: int, *, bias: float = 0.0, **labels: object) -> st.Recording:
    """A machine of the core, moved by sines, seen by an encoder of so many counts a turn."""
    source = np.random.default_rng(seed)
    time = np.arange(8000) * DT
    waves = [0.22 * np.sin(w * time + source.uniform(0, 6)) for w in (2.0, 5.3, 13.0)]
    effort = np.sum(waves, axis=0)
    motor = st.Motor(
        0.006,
        friction=st.FrictionModel(
            "maxwell_slip", coulomb=COULOMB, initial_stiffness=COULOMB / REACH, viscous=0.02
        ),
        effects={"torque_bias": {"bias": bias}},
    )
    position = np.concatenate([[0.0], motor.simulate(effort[:-1], DT).position])
    count = 2.0 * math.pi / counts
    measured = effort + NOISE * source.standard_normal(len(time))
    return st.Recording(time, measured, np.round(position / count) * count, **labels)


def session(counts: int, *, bias: float = 0.0) -> list[st.Recording]:
    roles = ("train", "train", "select", "test")
    return [recorded(k, counts, bias=bias, role=role) for k, role in enumerate(roles)]


def plant(counts: int) -> st.Plant:
    return st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm"},
            "body": {"inertia": 0.006},
            "friction": {
                "law": "maxwell_slip",
                "coulomb": COULOMB,
                "initial_stiffness": COULOMB / REACH,
                "viscous": 0.02,
            },
            "sensor": {"counts_per_rev": counts},
        }
    )


@pytest.fixture(scope="module")
def coarse() -> list[st.Recording]:
    return session(COARSE)


def chosen(counts: int) -> tuple[float | None, Model]:
    evidence = Evidence(plant(counts), session(counts))
    base = fit_model(evidence, plant(counts))
    return horizon_of(base.plant, base.nuisances, evidence.train, evidence.forms), base


def test_a_coarse_encoder_is_looked_at_by_short_simulations() -> None:
    horizon, base = chosen(COARSE)
    assert horizon is not None
    assert HORIZONS_S[0] <= horizon <= HORIZONS_S[1]
    assert "weak form" in residual_sentence(base.evidence.forms, base.plant)
    evidence = Evidence(plant(COARSE), session(COARSE), through=Through(horizon=horizon))
    assert all(isinstance(form, ShootingForm) for form in evidence.forms)
    assert "shooting" in residual_sentence(evidence.forms, base.plant)


def test_a_fine_encoder_keeps_the_weak_form() -> None:
    assert chosen(FINE)[0] is None


def test_prescribed_motion_is_never_simulated(coarse: list[st.Recording]) -> None:
    moved = [st.Recording(r.time, None, r.position, effort=r.input, role=r.role) for r in coarse]
    machine = st.Plant.from_dict(
        {
            "drive": {"kind": "prescribed_motion"},
            "body": {"inertia": 0.006},
            "friction": {
                "law": "maxwell_slip",
                "coulomb": COULOMB,
                "initial_stiffness": COULOMB / REACH,
            },
            "sensor": {"counts_per_rev": COARSE},
        }
    )
    evidence = Evidence(machine, moved)
    assert horizon_of(machine, Nuisances(), evidence.train, evidence.forms) is None


def test_the_residual_is_that_of_the_weak_form_and_much_smaller() -> None:
    """A hidden effort shows with the same sign; viscous friction of what it adds takes a part."""
    recording = recorded(3, COARSE, bias=-BIAS)
    shot, led = (
        ShootingForm(plant(COARSE), recording, horizon=0.1),
        WeakForm(plant(COARSE), recording, support=0.1, every=0.025),
    )
    residuals = []
    for form in (shot, led):
        measured, needed = form.efforts(plant(COARSE))
        residuals.append((measured - needed)[20:])
    fast = np.abs(shot.velocity[20:]) > 0.5
    assert np.median(residuals[0][fast]) == pytest.approx(BIAS, rel=0.25)
    right = ShootingForm(plant(COARSE), recorded(3, COARSE), horizon=0.1)
    measured, needed = right.efforts(plant(COARSE))
    assert np.std((measured - needed)[20:]) < 0.2 * np.std(residuals[1])


def test_derivatives_of_the_residual_equal_differences(coarse: list[st.Recording]) -> None:
    form = ShootingForm(plant(COARSE), coarse[0], horizon=0.1)
    paths = ["body.inertia", "friction.coulomb", "friction.viscous", "start.force"]
    start = {"force": 0.02}
    exact = form.jacobian(plant(COARSE), paths, start)
    for column, path in zip(exact.T, paths, strict=True):
        sides = []
        value = 0.02 if path == "start.force" else plant(COARSE).parameters[path].value
        step = 1e-6 * value
        for sign in (1.0, -1.0):
            if path == "start.force":
                own, brought = plant(COARSE), {"force": value + sign * step}
            else:
                own, brought = plant(COARSE).with_values({path: value + sign * step}), start
            measured, needed = form.efforts(own, brought)
            sides.append(measured - needed)
        chord = (sides[0] - sides[1]) / (2.0 * step)
        wrong = np.abs(column - chord) > 1e-3 * np.abs(column).max()
        assert wrong.mean() < 0.05, path


def test_a_plant_too_stiff_to_simulate_looks_bad_and_breaks_nothing(
    coarse: list[st.Recording],
) -> None:
    form = ShootingForm(plant(COARSE), coarse[0], horizon=0.1)
    stiff = plant(COARSE).with_values({"friction.initial_stiffness": 1e15})
    _, needed = form.efforts(stiff)
    assert np.all(np.isnan(needed))
    assert not form.jacobian(stiff, ["friction.coulomb"]).any()


def test_surrogates_and_noise_are_those_of_a_right_model(coarse: list[st.Recording]) -> None:
    evidence = Evidence(plant(COARSE), coarse, through=Through(horizon=0.1))
    residual = evidence.residual(plant(COARSE), Nuisances())
    null, noises = surrogate_residuals(evidence, plant(COARSE), Nuisances(), 6, 0)
    assert 0.6 < np.std(residual) / np.std(null) < 1.5
    for rows in evidence.shown:
        found = noise_of(rows, plant(COARSE), Nuisances())
        assert noises[rows.index] == found
        assert found.count == pytest.approx(2.0 * math.pi / COARSE)


def test_a_right_model_on_a_coarse_encoder_lacks_nothing(coarse: list[st.Recording]) -> None:
    found = st.diagnose(plant(COARSE), coarse, threads=1)
    assert "shooting" in found.data["residual"]
    assert found.verdict == "nothing_missing"


def test_a_hidden_effort_is_found_through_a_coarse_encoder() -> None:
    found = st.diagnose(plant(COARSE), session(COARSE, bias=BIAS), threads=1)
    assert "torque_bias" in {found.effects[0].name, *found.effects[0].look_alikes}
    assert len(found.effects) == 1
    assert found.gain is not None
    assert found.gain.ci95[0] > 0.5


KICKED = {"law": "coulomb", "contact": "dry", "recordings": 4, "seconds": 60.0, "linear": False}


def test_a_window_that_its_start_decides_bends_no_fit(tmp_path: Path) -> None:
    # The controller's derivative kicks a contact that barely breaks away, or does not, as the
    # counts fall: weighing as much as all others these windows bent an inertia by 5 %.
    off = []
    for seed in (701022, 701026, 701027):
        made = ordinary(Spec(seed, loop="pd", **KICKED))
        found = st.fit(st.load(write(made, tmp_path / str(seed)))).parameters
        off.append(found["body.inertia"].value / made.machine.inertia - 1.0)
        assert found["friction.coulomb"].value == pytest.approx(made.machine.coulomb, rel=0.015)
    assert np.max(np.abs(off)) < 0.04
    assert np.mean(np.abs(off)) < 0.015


def test_windows_that_their_starts_decide_count_less(tmp_path: Path) -> None:
    session = st.load(write(ordinary(Spec(701022, loop="pd", **KICKED)), tmp_path))
    fit = st.fit(session)
    low = 0
    for recording in session:
        form = ShootingForm(fit.plant, recording, horizon=0.12)
        whole = form.residual(fit.plant)
        form.go_by(fit.plant)
        weights = form.unit / fit.plant.inertia
        assert np.all((weights > 0.0) & (weights <= 1.0))
        assert np.mean(weights < 1.0) < 0.2
        assert np.allclose(form.residual(fit.plant), weights * whole, rtol=1e-9, atol=1e-15)
        paths = ["body.inertia", "friction.coulomb"]
        slopes = form.jacobian(fit.plant, paths)
        bare = ShootingForm(fit.plant, recording, horizon=0.12).jacobian(fit.plant, paths)
        assert np.allclose(slopes, weights[:, None] * bare, rtol=1e-9, atol=1e-15)
        low += int(np.sum(weights < 1.0))
    assert low > 0


@pytest.mark.slow
def test_a_dead_band_is_found_where_a_start_decides_single_windows(tmp_path: Path) -> None:
    spec = Spec(701004, hidden="drive_deadband", size=0.18, loop="pd", **KICKED)
    found = st.diagnose(st.load(write(ordinary(spec), tmp_path)))
    assert [cause.name for cause in found.effects] == ["drive_deadband"]


def test_windows_follow_damping_between_slow_samples():
    """At 10 ms a time constant of 90 ms was followed to a thousandth, which readings show."""
    dt, parts = 1e-2, 64
    time = np.arange(800) * dt
    effort = 0.06 * np.sign(np.sin(2.0 * time)) + 0.03 * np.sign(np.sin(5.3 * time))
    plant = st.Plant.from_dict(
        {
            "body": {"inertia": 7e-5},
            "drive": {"input": "torque_nm", "gain": 1.0},
            "friction": {"law": "coulomb", "coulomb": 0.03, "viscous": 8e-4},
        }
    )
    truth = plant.simulate(np.repeat(effort, parts), dt / parts).position[parts - 1 :: parts]
    recording = st.Recording(time, effort, np.append(0.0, truth[:-1]))
    form = ShootingForm(plant, recording, horizon=0.3, overlap=2.0)
    # Of most windows: where one begins as the effort changes, its start is what is off.
    left = float(np.median(np.abs(form.residual(plant))))
    assert left < 1e-4 * float(np.sqrt(np.mean(effort**2)))
