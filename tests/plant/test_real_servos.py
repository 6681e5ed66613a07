"""Logs of two hobby servos on a pendulum, read where the folder of real recordings is present."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import stiction as st
from stiction.residual.effort import free_run

COLUMNS = {
    "time": {"name": "timestamp", "unit": "s"},
    "input": {"name": "goal_position", "unit": "rad"},
    "position": {"name": "position", "unit": "rad"},
    "enabled": "torque_enable",
}
XL330 = {
    "drive": {
        "kind": "servo",
        "proportional": 1.15,
        "supply_v": 7.3,
        "resistance_ohm": 3.5,
        "torque_constant": {"value": 0.4, "min": 0.05, "max": 2.0},
    },
    "body": {"inertia": 0.002, "payload_kg": 0.49, "payload_m": 0.1},
    "friction": {"law": "coulomb"},
    "effects": [{"name": "load_dependent_friction"}, {"name": "torque_constant_saturation"}],
}
STS3215 = {
    "drive": {
        "kind": "servo",
        "proportional": 3.0,
        "supply_v": 12.0,
        "resistance_ohm": 3.7,
        "torque_constant": {"value": 2.0, "min": 0.2, "max": 20.0},
    },
    "body": {"inertia": 0.02, "payload_kg": 1.0, "payload_m": 0.1},
    "friction": {"law": "coulomb"},
    "effects": [{"name": "input_delay"}],
}
PLAIN = {**STS3215, "effects": []}
HELD_BACK = {
    **STS3215,
    "effects": [{"name": "input_delay"}, {"name": "goal_rate_limit", "slowness": 0.1}],
}
DUTY = {"xl330": 0.0028774, "sts3215": 0.166}
"""Duty per rad and unit of the firmware's gain."""
ARM = 0.018
"""Kilogram at the end that pulls as the arm of the second rig does."""
HELD_BY_HAND = "183154"
"""A log in which the arm rests where its repeat does not."""


def logs(folder: Path, held) -> list[st.Recording]:
    """Logs of one servo; `held` says of a header whether the log is left out of the fit."""
    recordings = []
    for path in sorted(folder.glob("*.json")):
        header = json.loads(path.read_bytes())
        if HELD_BY_HAND in path.name:
            continue
        settings = {"proportional": header["kp"] * DUTY[folder.name]}
        if folder.name == "sts3215":
            settings["payload_kg"] = header["mass"] + ARM
        role = "test" if held(header) else "train"
        recordings.append(
            st.Recording.load(path, COLUMNS, drive="goal_rad", role=role, settings=settings)
        )
    return recordings


def mean_error(plant: st.Plant, recordings: list[st.Recording]) -> float:
    """Over the recordings that were not fitted."""
    held = [r for r in recordings if r.role == "test"]
    return float(np.mean([free_run(plant, r).mean_absolute for r in held]))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "table", "held", "published"),
    [
        ("xl330", XL330, lambda header: header["kp"] == 400, 0.0691),
        ("sts3215", STS3215, lambda header: header["mass"] == 0.969, 0.0309),
        ("sts3215", PLAIN, lambda header: header["mass"] == 0.969, 0.039),
        ("sts3215", HELD_BACK, lambda header: header["mass"] == 0.969, 0.02),
        ("sts3215", HELD_BACK, lambda header: header["mass"] > 1.1, 0.0309),
    ],
)
def test_a_servo_is_simulated_better_than_published(shared_data, name, table, held, published):
    """With a gain (a payload) that was not fitted, against models that were fitted to all logs.

    The plain plant ends at 0.046 rad where its fit starts from the friction that a regression of
    the guessed effort gives, which is none.
    """
    recordings = logs(shared_data / name, held)
    result = st.fit(st.Plant.from_dict(table), recordings)
    assert result.success
    assert mean_error(result.plant, recordings) < published
