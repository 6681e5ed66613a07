"""What every law of the catalogue has to do, whichever it is."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from tests.reference import golden

import stiction as st
from stiction.cli import run

from .rigs import same_state, wandering_velocity

REPOSITORY = Path(__file__).parents[2]
DT = 1e-3
NAMES = [law.name for law in st.laws()]
# What the paper discusses, and what its readers use since.
WANTED = {
    "bouc_wen",
    "bristle",
    "coulomb",
    "dahl",
    "dahl_with_memory",
    "elastic_perfectly_plastic",
    "elasto_plastic",
    "futami",
    "gms",
    "hsieh_pan",
    "leuven",
    "load_dependent",
    "lugre",
    "maxwell_slip",
    "parallel_elements",
    "prandtl_ishlinskii",
    "preisach",
    "rate_and_state",
    "reset_integrator",
    "rigid_perfectly_plastic",
    "ro_hubbel",
}
# Two laws that differ do so by more than this share of the range somewhere.
DIFFERENT = 1e-3


@pytest.fixture(params=NAMES)
def law(request):
    return request.param


def to_and_fro():
    """Speeds of loops inside loops, slides, rests, with an effort and a load beside them."""
    time = DT * np.arange(4000)
    velocity = 0.02 * np.sin(9.0 * time) + 0.4 * np.sin(2.0 * time) ** 9
    velocity[1000:1100] = 0.0
    return velocity, {"effort": 0.3 * np.cos(5.0 * time), "load": 0.1 * np.sin(3.0 * time)}


def test_the_family_is_complete():
    assert set(NAMES) >= WANTED


def test_a_law_builds_with_defaults_steps_and_simulates_in_a_machine(law):
    assert np.isfinite(st.FrictionModel(law).step(0.01, DT))
    machine = st.Motor(inertia=0.0076, friction=st.FrictionModel(law))
    moved = machine.simulate(0.7 * np.sin(0.01 * np.arange(1000)), DT)
    assert moved.success, moved.message
    assert np.ptp(moved.position) > 0.0


def test_simulate_equals_looped_step_to_the_bit(law):
    velocity = np.concatenate([wandering_velocity(seed, 400) for seed in range(3)])
    whole, looped = st.FrictionModel(law), st.FrictionModel(law)
    forces = whole.simulate(velocity, DT)
    assert np.array_equal(forces, [looped.step(float(v), DT) for v in velocity])
    assert same_state(whole.state, looped.state)


def test_a_machine_simulated_equals_one_stepped_to_the_bit(law):
    inputs = 0.6 * np.sin(0.02 * np.arange(600)) + 0.2 * np.sin(0.11 * np.arange(600))
    whole, looped = (st.Motor(inertia=0.0076, friction=st.FrictionModel(law)) for _ in range(2))
    moved = whole.simulate(inputs, DT)
    steps = np.array([looped.step(float(u), DT) for u in inputs])
    assert np.array_equal(moved.position, steps[:, 0])
    assert np.array_equal(moved.velocity, steps[:, 1])


def test_friction_takes_energy_on_the_whole(law):
    velocity, around = to_and_fro()
    for given in ({}, around):
        force = st.FrictionModel(law).simulate(velocity, DT, **given)
        assert np.mean(force * velocity) > 0.0


def test_no_two_laws_are_the_same():
    velocity, around = to_and_fro()
    forces = {name: st.FrictionModel(name).simulate(velocity, DT, **around) for name in NAMES}
    for one, other in itertools.combinations(NAMES, 2):
        size = max(np.ptp(forces[one]), np.ptp(forces[other]))
        assert np.abs(forces[one] - forces[other]).max() > DIFFERENT * size, (one, other)


def test_a_law_has_an_oracle_a_page_and_its_place_in_every_list(law, capsys):
    assert (golden.FOLDER / f"{law}.json").exists()
    page = f"theory/{law.replace('_', '-')}.md"
    text = (REPOSITORY / "docs" / page).read_text("utf-8")
    assert f"(`{law}`)" in text.splitlines()[0]
    assert page in (REPOSITORY / "docs/index.md").read_text("utf-8")
    assert f"| `{law}` |" in (REPOSITORY / "README.md").read_text("utf-8")
    assert f"| `{law}` |" in (REPOSITORY / "docs/compare.md").read_text("utf-8")
    assert run(["laws", law]) == 0
    shown = capsys.readouterr().out
    for parameter in st.FrictionModel(law).parameters:
        assert parameter in shown
