"""Fits: true parameters come back, and what the data do not tell is said.

The data are made by the independent machines of ``tests/reference``, not by the core.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.reference.coulomb_reference import simulate_coulomb

import stiction as st
from stiction import InputError, Plant, Recording, fit
from stiction.cli import run
from stiction.fitting import minimise, solve
from stiction.fitting.minimise import HARDENING, Solution
from stiction.fitting.rows import Nuisances, Rows
from stiction.fitting.variables import Variables
from stiction.residual.weak_form import Start, WeakForm

DT = 1e-3
TRUE = {"inertia": 0.0076, "coulomb": 0.3, "viscous": 0.05}
# The kernel smears the kinks of stops and reversals; what is left of them biases by this share.
BIAS = 0.01
NOISE = 2e-3
COUNT = 2 * np.pi / 2**18


def swept(n: int, seed: int = 0) -> np.ndarray:
    """Sines of several sizes and a few rests, N·m."""
    time = np.arange(n) * DT
    rng = np.random.default_rng(seed)
    waves = sum(0.45 * np.sin(2 * np.pi * f * time + rng.uniform(0, 6)) for f in (0.4, 1.1, 2.3))
    return np.where(time % 5.0 > 4.5, 0.0, waves)


def moved(effort: np.ndarray) -> np.ndarray:
    """Where the independent Coulomb machine is at each stamp, rad."""
    run = simulate_coulomb(
        effort[:-1],
        DT,
        inertia=TRUE["inertia"],
        coulomb=TRUE["coulomb"],
        breakaway=TRUE["coulomb"],
        viscous=TRUE["viscous"],
    )
    return np.concatenate([[0.0], run["position"]])


def recorded(n: int = 10_000, seed: int = 0, noise: float = NOISE) -> Recording:
    """What a recorder keeps of the independent Coulomb machine: counts, and noisy effort."""
    rng = np.random.default_rng(seed + 100)
    effort = swept(n, seed)
    measured = effort + noise * rng.standard_normal(n)
    return Recording(np.arange(n) * DT, measured, np.round(moved(effort) / COUNT) * COUNT)


def plant(law: str = "coulomb", **more: object) -> Plant:
    return Plant.from_dict(
        {"drive": {"input": "torque_nm", "gain": 1.0}, "friction": {"law": law}, **more}
    )


@pytest.fixture(scope="module")
def recording() -> Recording:
    return recorded()


def test_naming_the_law_alone_brings_the_true_parameters_back(recording: Recording) -> None:
    found = fit(plant(), recording)
    assert found.success, found.message
    for name, value in TRUE.items():
        assert found[name].value == pytest.approx(value, rel=BIAS), name
        assert found[name].stderr < BIAS * value
        assert found[name].at_bound == ""
    assert found.heldout_relative is not None
    assert found.heldout_relative < 0.02
    assert found.r2 > 0.999
    assert not found.undetermined


def test_stated_numbers_are_where_it_starts_and_fixed_ones_stay(recording: Recording) -> None:
    start = plant(body={"inertia": {"value": 0.009, "fixed": True}})
    found = fit(start, recording)
    assert "body.inertia" not in found.parameters
    assert found.plant.inertia == 0.009
    free = fit(plant(body={"inertia": 0.02}), recording)
    assert free["inertia"].start == pytest.approx(0.02)
    assert free["inertia"].value == pytest.approx(TRUE["inertia"], rel=BIAS)


def test_a_bound_that_is_hit_is_said(recording: Recording) -> None:
    bounded = plant(friction={"law": "coulomb", "viscous": {"value": 0.02, "max": 0.03}})
    found = fit(bounded, recording)
    assert found["viscous"].at_bound == "upper"
    assert any("friction.viscous ended at its upper bound" in s for s in found.bounds_hit)


def test_what_the_data_do_not_tell_is_said(recording: Recording) -> None:
    # Equal levels: where nothing falls, its speed scale has no meaning.
    friction = {
        "law": "coulomb",
        "coulomb": 0.3,
        "breakaway": {"value": 0.3, "fixed": True},
        "stribeck_velocity": 0.1,
    }
    found = fit(plant(friction={**friction, "coulomb": {"value": 0.3, "fixed": True}}), recording)
    told = [s for s in found.undetermined if "friction.stribeck_velocity is not determined" in s]
    assert len(told) == 1
    assert told[0].endswith(" rad/s")
    assert found["stribeck_velocity"].stderr == np.inf
    told = json.loads(found.to_json(), parse_constant=pytest.fail)["parameters"]
    assert told["friction.stribeck_velocity"]["ci95"] == [None, None]
    assert told["body.inertia"]["ci95"] == list(found["inertia"].ci95)


def test_two_effects_that_act_alike_are_named_together(recording: Recording) -> None:
    still = plant(
        body={"gravity_amplitude": 0.0, "gravity_zero_rad": {"value": 0.0, "fixed": True}},
        effects=[{"name": "cogging", "order": {"value": 1.0, "fixed": True}}],
    )
    twin = Plant.from_dict(
        {
            **still.to_dict(),
            "effects": [{"name": "cogging", "sine": 0.0, "order": {"value": 1.0, "fixed": True}}],
        }
    )
    found = fit(twin, recording)
    assert any(
        "only a combination of" in s and "gravity_amplitude" in s and "cogging.sine" in s
        for s in found.undetermined
    )


def test_the_jacobian_is_that_of_the_residual(recording: Recording) -> None:
    machine = plant(
        "maxwell_slip",
        body={"inertia": 0.008, "gravity_amplitude": 0.01},
        effects=[{"name": "torque_bias", "bias": 0.02}, {"name": "stribeck", "excess": 0.1}],
    ).with_values({})
    whole = Plant.from_dict(
        {
            **machine.to_dict(),
            "friction": {
                "law": "maxwell_slip",
                "coulomb": 0.3,
                "initial_stiffness": 400.0,
                "yield_shape": 0.2,
                "viscous": 0.05,
            },
        }
    )
    form = WeakForm(whole, recording, every=0.005)
    paths = list(whole.parameters)
    exact = form.jacobian(whole, paths)
    for k, path in enumerate(paths):
        value = whole.parameters[path].value
        step = 1e-6 * max(abs(value), 1e-3)

        def residual(value: float, path: str = path) -> np.ndarray:
            measured, model = form.efforts(whole.with_values({path: value}))
            return measured - model

        chord = (residual(value + step) - residual(value - step)) / (2 * step)
        assert np.abs(exact[:, k] - chord).max() < 1e-5 * np.abs(chord).max(), path


@pytest.mark.parametrize(
    ("law", "stated"),
    [
        ("coulomb", {"coulomb": 0.3}),
        ("coulomb", {"breakaway": 0.4, "stribeck_velocity": 3.0}),
        ("hsieh_pan", {"initial_stiffness": 400.0, "creep_rate": 2.0, "breakaway": 0.4}),
    ],
)
def test_what_a_plant_leaves_open_moves_with_the_parameter_it_follows(
    recording: Recording, law: str, stated: dict[str, float]
) -> None:
    machine = plant(body={"inertia": 0.0076}, friction={"law": law, **stated})
    assert machine.following([f"friction.{name}" for name in stated])
    rows = Rows(machine, WeakForm(machine, recording, every=0.005), 0, np.ones(1, dtype=bool))
    for name, value in stated.items():
        path, step = f"friction.{name}", 1e-6 * value
        exact = rows.jacobian(machine, [path], Nuisances())[:, 0]
        ends = [
            rows.residual(machine.with_values({path: value + way * step}), Nuisances())
            for way in (1.0, -1.0)
        ]
        chord = (ends[0] - ends[1]) / (2 * step)
        assert np.abs(exact - chord).max() < 1e-4 * np.abs(chord).max(), path


@pytest.mark.slow
def test_intervals_cover_the_truth_about_as_often_as_they_say() -> None:
    # White noise on the effort alone, position exact: nothing but noise biases the estimate.
    covered = tried = 0
    for seed in range(12):
        found = fit(plant(), recorded(6000, seed=seed, noise=0.03))
        for name, value in TRUE.items():
            low, high = found[name].ci95
            # The kernel's bias counts as truth's own width here.
            covered += low - 0.004 * value <= value <= high + 0.004 * value
            tried += 1
    assert covered / tried > 0.8


def test_several_recordings_are_fitted_together() -> None:
    session = [recorded(6000, seed=seed) for seed in range(3)]
    found = fit(plant(), session)
    assert found["coulomb"].value == pytest.approx(TRUE["coulomb"], rel=BIAS)
    assert "test" in found.split
    assert found.heldout_rms is not None


def test_a_result_renders_as_text_html_and_json(recording: Recording) -> None:
    found = fit(plant(), recording)
    text = str(found)
    assert "friction.coulomb" in text
    assert "effort error held out" in text
    assert "<table>" in found._repr_html_()
    data = json.loads(found.to_json())
    assert data["parameters"]["friction.coulomb"]["unit"] == "N·m"
    assert np.array(data["covariance"]).shape == (3, 3)
    with pytest.raises(InputError, match="did you mean"):
        found["coulom"]


def test_interrupting_a_fit_keeps_the_best_so_far(
    recording: Recording, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls = 0
    residual = WeakForm.residual

    def interrupted(self: WeakForm, machine: Plant, start: Start = None) -> np.ndarray:
        nonlocal calls
        calls += 1
        if calls == 3:
            raise KeyboardInterrupt
        return residual(self, machine, start)

    monkeypatch.setattr(WeakForm, "residual", interrupted)
    found = fit(plant(), recording)
    assert not found.success
    assert "interrupted" in found.message
    assert found["coulomb"].value == pytest.approx(TRUE["coulomb"], rel=0.2)


def test_nothing_to_fit_is_refused_in_words(recording: Recording) -> None:
    fixed = plant(
        body={"inertia": {"value": 0.0076, "fixed": True}},
        friction={
            "law": "coulomb",
            "coulomb": {"value": 0.3, "fixed": True},
            "viscous": {"value": 0.05, "fixed": True},
        },
    )
    with pytest.raises(InputError, match="every parameter is fixed"):
        fit(fixed, recording)
    with pytest.raises(InputError, match="no recordings"):
        fit(plant(), [])
    still = Recording(np.arange(8000) * DT, np.zeros(8000), np.zeros(8000))
    with pytest.raises(InputError, match="nothing moves"):
        fit(plant(), still)


def test_the_command_writes_the_fitted_plant(
    recording: Recording, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "plant.toml").write_text(
        '[drive]\ninput = "torque_nm"\n[friction]\nlaw = "coulomb"\n'
    )
    assert recording.input is not None
    assert recording.position is not None
    table = np.column_stack([recording.time, recording.input, recording.position])
    np.savetxt(
        tmp_path / "run.csv",
        table,
        delimiter=",",
        comments="",
        header="time_s,torque_nm,position_rad",
    )
    session = tmp_path / "session.toml"
    session.write_text('plant = "plant.toml"\n[[recordings]]\nfile = "run.csv"\n')
    assert run(["fit", str(session), "-o", str(tmp_path / "out")]) == 0
    assert "friction.coulomb" in capsys.readouterr().out
    fitted = Plant.load(tmp_path / "out" / "plant.toml")
    assert fitted.parameters["friction.coulomb"].value == pytest.approx(0.3, rel=BIAS)
    assert run(["fit", str(session), "--json", "-o", str(tmp_path / "out")]) == 0
    assert json.loads(capsys.readouterr().out)["success"]
    session.write_text('[[recordings]]\nfile = "run.csv"\n')
    assert run(["fit", str(session)]) == 2
    assert "plant is missing" in capsys.readouterr().err


def test_emps_comes_out_near_its_published_parameters(shared_data: Path) -> None:
    columns = {
        "time": "t",
        "input": {"name": "vir", "unit": "V"},
        "position": {"name": "qm", "unit": "m"},
    }
    emps = Recording.load(
        shared_data / "emps" / "DATA_EMPS.mat", columns, motion="linear", drive="voltage_v"
    )
    machine = Plant.from_dict(
        {
            "motion": {"kind": "linear"},
            "drive": {"input": "voltage_v", "gain": 35.15065},
            "body": {"inertia": 50.0},
            "friction": {"law": "coulomb"},
            "effects": [{"name": "torque_bias", "bias": 0.0}],
        }
    )
    found = fit(machine, emps)
    published = {"inertia": 95.109, "viscous": 203.50, "coulomb": 20.39}
    for name, value in published.items():
        assert found[name].value == pytest.approx(value, rel=0.08), name
    assert found["bias"].value == pytest.approx(3.165, abs=1.2)
    assert found.train_relative < 0.045


def test_short_recordings_with_roles_are_fitted_as_they_are() -> None:
    true = st.Motor(0.0076, friction=st.FrictionModel("coulomb", coulomb=0.3, viscous=0.05))
    time = np.arange(3500) * 1e-3
    made = []
    for role, rate in (("train", 11.0), ("test", 13.0)):
        effort = 0.6 * np.sin(3.0 * time) + 0.4 * np.sin(rate * time)
        position = np.concatenate([[0.0], true.copy().simulate(effort[:-1], 1e-3).position])
        made.append(st.Recording(time, effort, position, role=role))
    machine = st.Plant.from_dict({"drive": {"input": "torque_nm"}, "friction": {"law": "coulomb"}})
    found = st.fit(machine, made)
    assert found["coulomb"].value == pytest.approx(0.3, rel=0.02)
    # A fit decides nothing, so nothing is cut or left out for a decision.
    assert "select" not in found.split
    assert "blocks" not in found.split


def hardening_solution() -> Solution:
    """A fit of `hsieh_pan` that has ended, with one exponent and a hardening that may vary."""
    stated = Plant.from_dict(
        {
            "drive": {"input": "torque_nm", "gain": 1.0},
            "body": {"inertia": 0.01},
            "friction": {
                "law": "hsieh_pan",
                "hardening_exponent": 3.0,
                "hardening_coefficient": 0.01,
            },
        }
    )
    variables = Variables.of(stated, ["friction.hardening_exponent", HARDENING])
    vector = variables.vector(np.array([3.0, 0.01]))
    return Solution(stated, variables, vector, vector, Nuisances(), True, False, "", 7, 5.0)


def test_other_starts_keep_to_the_evaluations_that_were_allowed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    solution, asked = hardening_solution(), []

    def few(plant: Plant, *_: object, most: int, **__: object) -> Solution:
        asked.append((plant.parameters[HARDENING].value, most))
        return replace(solution, power=4.0, success=False, evaluations=most)

    monkeypatch.setattr(minimise, "minimise", few)
    found = minimise.from_elsewhere(solution, [], most=3)
    assert asked == [(0.01, 3), (0.01, 3), (pytest.approx(0.04), 3)]
    assert (found.power, found.evaluations) == (4.0, 7 + 9)


def test_an_interrupted_other_start_keeps_the_solution(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object, **__: object) -> Solution:
        raise KeyboardInterrupt

    monkeypatch.setattr(minimise, "minimise", interrupted)
    solution = hardening_solution()
    found = minimise.from_elsewhere(solution, [])
    assert found.interrupted
    assert found.vector is solution.vector


def test_two_parameters_that_do_the_same_end_at_numbers() -> None:
    """A damper that fades at once does nothing, however strong: the two run away together."""
    stated = {"coulomb": 0.3, "viscous": 0.03, "damping_velocity": 1.0}
    free = plant("lugre", friction={"law": "lugre", **stated})
    found = fit(free, recorded())
    assert all(np.isfinite(p.value) for p in found.parameters.values())
    assert found.parameters["friction.coulomb"].value == pytest.approx(TRUE["coulomb"], rel=0.1)
    assert found.r2 > 0.9


@pytest.mark.parametrize("place", ["reweight", "evaluate"])
def test_a_fit_that_is_interrupted_near_its_end_keeps_what_it_has(
    place: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    strikes = [True]

    def struck(work: Any) -> Any:
        def once(*given: Any, **named: Any) -> Any:
            if strikes:
                strikes.pop()
                raise KeyboardInterrupt
            return work(*given, **named)

        return once

    monkeypatch.setattr(solve, place, struck(getattr(solve, place)))
    found = fit(plant(), recorded())
    assert not found.success
    assert "interrupted" in found.message
    assert np.isfinite(found.train_rms)


@pytest.mark.parametrize("per_effort", [1.0, 1000.0])
def test_a_limit_that_states_no_number_begins_within_the_commands(per_effort: float) -> None:
    # From the catalogue's own 1 it would be far beyond all commands, or nearly all beyond it.
    n = 10_000
    effort = swept(n)
    limit = 0.6 * float(np.max(np.abs(effort)))
    position = moved(np.clip(effort, -limit, limit))
    noise = NOISE * np.random.default_rng(3).standard_normal(n)
    given = per_effort * (effort + noise)
    recording = Recording(np.arange(n) * DT, given, np.round(position / COUNT) * COUNT)
    drive = {"input": "torque_nm", "gain": 1.0 / per_effort}
    machine = plant(drive=drive, effects=[{"name": "drive_saturation"}])
    found = fit(machine, recording)
    assert found["limit"].value == pytest.approx(per_effort * limit, rel=0.03)
    assert found["share"].value == pytest.approx(1.0, abs=0.1)


def test_correlations_that_mislead_are_told_the_largest_first() -> None:
    time = 1e-3 * np.arange(6000)
    speed = 20.0 + 2.0 * np.sin(3.0 * time)  # hardly changes: level and slope go together
    noise = 0.01 * np.random.default_rng(0).standard_normal(len(time))
    effort = 0.2 + 0.05 * speed + 0.0076 * 6.0 * np.cos(3.0 * time) + noise
    position = 20.0 * time - 2.0 / 3.0 * np.cos(3.0 * time)
    plant = st.Plant.from_dict({"drive": {"input": "torque_nm"}, "friction": {"law": "coulomb"}})
    found = st.fit(plant, st.Recording(time, effort, position))
    told = str(found).splitlines()
    names = "friction.coulomb and friction.viscous -"
    assert told[-1].startswith(f"  correlations above 0.5: {names}")
    assert names in found._repr_html_()
    inertia = next(line for line in told if line.startswith("body.inertia"))
    number = found["inertia"]
    assert f"({100.0 * number.stderr / number.value:.2g} %)" in inertia
