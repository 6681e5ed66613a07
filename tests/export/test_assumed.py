"""What nobody stated of a plant is said wherever its numbers go."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import stiction as st
from stiction import library
from stiction.cli import run
from stiction.export import targets

PLANT = '[drive]\ninput = "{input}"\n{gain}[body]\ninertia = 0.01\n[friction]\nlaw = "coulomb"\n'


def plant(where: Path, *, stated: bool) -> Path:
    file = where / "plant.toml"
    text = PLANT.format(input="current_a", gain="gain = 0.5\n" if stated else "")
    file.write_text(text + ("coulomb = 0.2\n" if stated else ""))
    return file


@pytest.mark.parametrize("target", ["c", "mujoco", "sdf", "table", "urdf"])
def test_an_export_says_that_its_numbers_are_in_amperes_and_of_the_catalogue(tmp_path, target):
    assert target in targets()
    made = st.Plant.load(plant(tmp_path, stated=False)).export(target)
    units, level = made.assumed
    assert "gain is not stated" in units
    assert "in A and not in N·m" in units
    assert "coulomb 0.35 A" in level
    assert "of the catalogue" in level
    assert f"taken for granted: {units}" in str(made)
    assert made.to_dict()["assumed"] == [units, level]
    assert st.Plant.load(plant(tmp_path, stated=True)).export(target).assumed == ()


def test_a_simulation_says_so_once_for_all_recordings(tmp_path, capsys):
    file = plant(tmp_path, stated=False)
    time = 1e-3 * np.arange(1500)
    rows = np.column_stack([time, np.sin(5.0 * time), 0.1 * np.sin(5.0 * time)])
    for name in ("a.csv", "b.csv"):
        head = "time_s,current_a,position_rad"
        np.savetxt(tmp_path / name, rows, delimiter=",", header=head, comments="")
    session = tmp_path / "session.toml"
    session.write_text(
        'plant = "plant.toml"\n[[recordings]]\nfile = "a.csv"\n[[recordings]]\nfile = "b.csv"\n'
    )
    run(["simulate", str(file), str(session), "-o", str(tmp_path / "out"), "--quiet"])
    told = capsys.readouterr().out
    assert told.count("gain is not stated") == 1
    assert told.count("states no level of friction") == 1
    run(["simulate", str(file), str(session), "-o", str(tmp_path / "out"), "--json", "--quiet"])
    both = json.loads(capsys.readouterr().out)
    assert [len(each["assumed"]) for each in both] == [2, 2]


@pytest.mark.parametrize("target", ["sdf", "urdf"])
def test_a_joint_without_a_drive_says_what_it_lacks_of_a_servo(target):
    made = library.entry("sts3215").plant.export(target)
    assert any("position loop of the servo" in sentence for sentence in made.lost)
    assert any("1.11 N·m·s/rad" in sentence for sentence in made.lost)
