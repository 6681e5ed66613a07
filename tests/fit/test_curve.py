"""A friction law fitted to a table of speed and friction."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import stiction as st
from stiction.cli import run

SPEED = np.linspace(-5.0, 5.0, 41)
COULOMB, BREAKAWAY, STRIBECK, VISCOUS = 0.3, 0.5, 0.7, 0.05


def friction(speed: np.ndarray, *, stribeck: bool = True) -> np.ndarray:
    """Armstrong's curve, written down here on its own."""
    fall = (BREAKAWAY - COULOMB) * np.exp(-((speed / STRIBECK) ** 2)) if stribeck else 0.0
    return np.sign(speed) * (COULOMB + fall) + VISCOUS * speed


@pytest.mark.parametrize("law", ["coulomb", "lugre", "gms", "elasto_plastic"])
def test_a_stribeck_curve_is_found_within_its_intervals(law: str) -> None:
    noise = 0.002 * np.random.default_rng(0).standard_normal(len(SPEED))
    found = st.fit_curve(SPEED, friction(SPEED) + noise, law)
    truth = {
        "coulomb": COULOMB, "breakaway": BREAKAWAY, "stribeck_velocity": STRIBECK,
        "viscous": VISCOUS,
    }  # fmt: skip
    for name, value in truth.items():
        one = found.parameters[name]
        assert abs(one.value - value) < 4.0 * one.stderr + 1e-3 * value, name
    assert found.rms < 0.003
    assert found.plant.friction.law == law


def test_intervals_hold_the_truth_as_often_as_they_say() -> None:
    source = np.random.default_rng(3)
    held = 0
    for _ in range(30):
        noise = 0.01 * source.standard_normal(len(SPEED))
        found = st.fit_curve(SPEED, friction(SPEED, stribeck=False) + noise)
        low, high = found.parameters["viscous"].ci95
        held += low < VISCOUS < high
    assert held >= 24  # less, at 95 % each, once in ten thousand


def test_no_stribeck_effect_is_found_where_there_is_none() -> None:
    noise = 0.002 * np.random.default_rng(1).standard_normal(len(SPEED))
    for readings in (friction(SPEED, stribeck=False), friction(SPEED, stribeck=False) + noise):
        found = st.fit_curve(SPEED, readings)
        assert set(found.parameters) == {"friction.coulomb", "friction.viscous"}
        assert "no Stribeck effect" in str(found)


def test_magnitudes_are_taken_as_they_are_published() -> None:
    found = st.fit_curve(SPEED, np.abs(friction(SPEED)))
    assert found.parameters["coulomb"].value == pytest.approx(COULOMB, rel=1e-3)


def test_directions_that_differ_are_told() -> None:
    noise = 0.002 * np.random.default_rng(2).standard_normal(len(SPEED))
    readings = friction(SPEED, stribeck=False) + 0.05 * (SPEED > 0.0) + noise
    assert "higher forward than the other way" in str(st.fit_curve(SPEED, readings))


def test_a_table_in_a_file_is_fitted_and_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "joint.csv"
    table = np.column_stack([SPEED * 30.0 / np.pi, 1e3 * friction(SPEED)])
    head = "speed [rpm],torque [mNm]"
    np.savetxt(path, table, delimiter=",", header=head, comments="")
    out = tmp_path / "out"
    assert run(["fit", str(path), "--law", "lugre", "-o", str(out), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["parameters"]["friction.breakaway"]["value"] == pytest.approx(BREAKAWAY, rel=1e-3)
    assert json.loads((out / "curve.json").read_text("utf-8"))["points"] == 40
    curve = st.Plant.load(out / "plant.toml").friction_curve([1.0])
    assert curve[0] == pytest.approx(friction(np.array([1.0]))[0], rel=1e-3)


def test_units_that_nobody_states_are_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "joint.csv"
    table = np.column_stack([SPEED, friction(SPEED)])
    np.savetxt(path, table, delimiter=",", header="speed,torque", comments="")
    assert run(["fit", str(path), "-o", str(tmp_path / "out")]) == 0
    assert "units: none stands in the header" in capsys.readouterr().out
    named = ["--columns", "velocity=speed [rpm], effort=torque [Nm]"]
    assert run(["fit", str(path), *named, "-o", str(tmp_path / "out")]) == 0
    assert "units: none" not in capsys.readouterr().out
    path.write_text(path.read_text().replace("torque", "torque [% rated]"))
    assert run(["fit", str(path), "-o", str(tmp_path / "out")]) == 2
    assert "'% rated', which is not known" in capsys.readouterr().err


@pytest.mark.parametrize("head", ["v_mm_s;mu", "Sliding speed (mm/s);COF"])
def test_a_table_of_a_friction_coefficient_is_fitted_per_newton(
    head: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """As a tribometer writes it, with decimal commas."""
    path = tmp_path / "disc.csv"
    curve = zip(SPEED, friction(SPEED), strict=True)
    rows = [f"{1e3 * v:.3f};{mu:.5f}" for v, mu in curve if v > 0]
    path.write_text("\n".join([head, *rows]).replace(".", ",") + "\n", encoding="utf-8")
    assert run(["fit", str(path), "-o", str(tmp_path / "out"), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    level = said["parameters"]["friction.breakaway"]
    assert level["value"] == pytest.approx(BREAKAWAY, rel=1e-2)
    assert level["unit"] == "N"
    assert "per N of normal force" in " ".join(said["assumed"])
    assert "units: none" not in " ".join(said["assumed"])


def test_a_curve_is_drawn_with_its_points() -> None:
    axes = st.fit_curve(SPEED, friction(SPEED)).plot()
    assert [line.get_label() for line in axes.lines] == ["table", "coulomb"]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("speed (rad/s)", "friction (N·m)")
