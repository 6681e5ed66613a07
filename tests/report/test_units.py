"""Reports say in which unit efforts were measured: not every sliding test measures a force."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import stiction as st
from stiction._support.scale import Scale, scale_for
from stiction.fitting.variables import with_effort_in
from stiction.report.sections import data

PLANT = st.Plant.from_dict(
    {
        "motion": {"kind": "linear"},
        "drive": {"kind": "prescribed_motion"},
        "friction": {"law": "coulomb"},
    }
)


def sheared(tmp_path: Path, *, normal: str) -> st.Recording:
    """A friction coefficient about 0.6 over to-and-fro motion; ``normal`` is the unit beside it."""
    time = np.arange(4000) * 0.01
    moved = 1e-3 * np.sin(0.9 * time)
    speed = 0.9e-3 * np.cos(0.9 * time)
    noise = 1e-3 * np.random.default_rng(1).standard_normal(time.size)
    coefficient = 0.6 * np.sign(speed) + 20.0 * speed + noise
    table = np.column_stack([time, moved, coefficient, np.full(time.size, 20.0)])
    np.savetxt(tmp_path / "s.csv", table, "%.9g", ",", header="t,x,mu,n", comments="")
    columns: dict[str, object] = {
        "time": {"name": "t", "unit": "s"},
        "position": {"name": "x", "unit": "m"},
        "friction_coefficient": "mu",
    }
    if normal:
        columns["normal_force"] = {"name": "n", "unit": normal}
    return st.Recording.load(tmp_path / "s.csv", columns)


@pytest.mark.parametrize(
    ("normal", "unit", "damping", "shown"),
    [
        ("MPa", "Pa", "Pa·s/m", "MPa"),
        ("N", "N", "N·s/m", "N"),
        ("", "1", "s/m", ""),
    ],
)
def test_what_is_fitted_is_told_in_the_unit_that_was_measured(
    tmp_path: Path, normal: str, unit: str, damping: str, shown: str
) -> None:
    found = st.fit(PLANT, sheared(tmp_path, normal=normal))
    assert found.unit == unit
    assert found["friction.coulomb"].unit == unit
    assert found["friction.viscous"].unit == damping
    assert scale_for([found["friction.coulomb"].value], found.unit).unit == shown


@pytest.mark.parametrize(
    ("path", "stress", "ratio"),
    [
        ("friction.coulomb", "Pa", "1"),
        ("body.inertia", "Pa·s²/m", "s²/m"),
        ("effects.viscous_quadratic.quadratic", "Pa·s²/m²", "s²/m²"),
        ("effects.stribeck.velocity", "m/s", "m/s"),
    ],
)
def test_every_unit_with_a_force_in_it_goes_along(path: str, stress: str, ratio: str) -> None:
    table = PLANT.to_dict() | {"effects": [{"name": "viscous_quadratic"}, {"name": "stribeck"}]}
    machine = st.Plant.from_dict(table)
    assert with_effort_in("Pa", machine, path) == stress
    assert with_effort_in("1", machine, path) == ratio
    turning = replace(machine, motion="rotary")
    assert "N·m" not in with_effort_in("1", turning, path)


def test_large_and_pure_numbers_are_written_plainly() -> None:
    assert scale_for([13926.9], "Pa").text(13926.9) == "13.9\u00a0kPa"
    assert scale_for([0.003], "1") == Scale(1.0, "")
    assert Scale(1.0, "").on_axis("residual") == "residual"


@pytest.mark.parametrize(
    ("timing", "told"),
    [
        ((-0.9998e-3, -7.6e-4), "are 1 ms late before and 0.76 ms late after"),
        ((0.0, 2e-3), "are right before and 2 ms early after"),
        ((-1e-3, 5e-4), "are 1 ms late before and 0.5 ms early after"),
    ],
)
def test_what_a_fit_makes_of_the_time_stamps_is_said_in_words(
    timing: tuple[float, float], told: str
) -> None:
    assert told in data._through({"timing_s": timing}).replace("\xa0", " ")
    assert data._through({"timing_s": (0.0, 0.0)}) == ""


def test_noise_that_does_not_show_is_no_number() -> None:
    row = data._noise({"recording": "a", "position": 0.0, "count": 0.0, "effort": 0.0}, "rad", "A")
    assert {row["position"], row["count"], row["effort"]} == {"none seen"}
    row = data._noise({"recording": "a", "position": 0.0, "count": 0.0, "effort": 0.1}, "rad", "A")
    assert row["effort"] == "0.10\xa0A"
