"""Positioning as an environment: what Gymnasium asks for, and what a seed makes."""

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from tests.report import canned

import stiction as st
from stiction.fitting.result import FitParameter

gymnasium = pytest.importorskip("gymnasium")
from gymnasium.utils.env_checker import check_env  # noqa: E402

from stiction.gym import Positioning, VectorPositioning, intervals_of  # noqa: E402

INTERVALS = {"friction.coulomb": (0.05, 0.3), "inertia": (0.008, 0.012)}


def plant(**tables):
    return st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm", "gain": 1.0, "limit": 1.0},
            "body": {"inertia": 0.01},
            "friction": {"law": "coulomb", "coulomb": 0.2, "viscous": 0.01},
            "sensor": {"counts_per_rev": 4096},
        }
        | tables
    )


def test_the_checker_of_gymnasium_passes():
    check_env(Positioning(plant(), INTERVALS, length=50), skip_render_check=True)


def test_the_same_seed_gives_the_same_machine_and_another_seed_another():
    env = Positioning(plant(), INTERVALS)
    one, first = env.reset(seed=3)
    two, second = env.reset(seed=3)
    assert one.tolist() == two.tolist()
    assert first["parameters"] == second["parameters"]
    assert set(first["parameters"]) == {"friction.coulomb", "body.inertia"}
    drawn = [env.reset()[1]["parameters"]["friction.coulomb"] for _ in range(200)]
    assert 0.05 <= min(drawn) < 0.07
    assert 0.28 < max(drawn) <= 0.3


def test_a_step_is_that_of_the_motor_and_observed_by_its_encoder():
    env = Positioning(plant(), dt=2e-3)
    seen, _ = env.reset(seed=1, options={"target": 0.5})
    motor, count, before = plant().motor(), 2.0 * np.pi / 4096, 0.0
    assert seen.tolist() == [0.0, 0.0, 0.5]
    for effort in (0.9, 0.9, -0.3, 0.0, 2.0):
        seen, reward, terminated, truncated, info = env.step(np.array([effort]))
        position, velocity = motor.step(min(effort, 1.0), 2e-3)
        assert (info["position"], info["velocity"]) == (position, velocity)
        assert seen[0] == pytest.approx(round(position / count) * count, abs=1e-12)
        assert seen[1] == pytest.approx((seen[0] - before) / 2e-3)
        assert reward == pytest.approx(-abs(position - 0.5))
        assert not terminated
        assert not truncated
        before = seen[0]
    assert before > 0.0


def test_friction_that_was_given_is_that_of_the_episode():
    env = Positioning(plant(), INTERVALS)
    env.reset(seed=0, options={"values": {"friction.coulomb": 0.3, "body.inertia": 0.01}})
    for _ in range(20):
        *_, info = env.step(np.array([0.29]))
    assert info["position"] == 0.0
    env.reset(options={"values": {"friction.coulomb": 0.28, "body.inertia": 0.01}})
    *_, info = env.step(np.array([0.29]))
    assert info["position"] > 0.0


def test_an_episode_ends_at_its_length_or_beyond_its_reach():
    env = Positioning(plant(), length=3)
    env.reset(seed=0)
    assert [env.step(np.zeros(1))[3] for _ in range(3)] == [False, False, True]
    env = Positioning(plant(), reach=0.01)
    env.reset(seed=0)
    ended = [env.step(np.ones(1))[2] for _ in range(30)]
    assert ended[-1]
    assert not ended[0]


def test_many_machines_go_as_one_does():
    many = VectorPositioning(plant(), INTERVALS, num_envs=5, length=4)
    seen, info = many.reset(seed=7)
    assert seen.shape == (5, 3)
    assert many.observation_space.contains(seen)
    actions = np.linspace(-1.0, 1.0, 5)[:, None]
    for step in range(4):
        seen, rewards, terminated, truncated, run = many.step(actions)
        assert truncated.tolist() == [step == 3] * 5
        assert not terminated.any()
    for member in range(5):
        single = Positioning(plant(), INTERVALS, length=4)
        values = {path: float(each[member]) for path, each in info["parameters"].items()}
        single.reset(seed=0, options={"values": values, "target": seen[member, 2]})
        for _ in range(4):
            one, reward, _, _, own = single.step(actions[member])
        assert one.tolist() == seen[member].tolist()
        assert reward == pytest.approx(rewards[member])
        assert own["position"] == run["position"][member]
    # The next step begins anew, whatever it is given.
    again, rewards, *_, info = many.step(actions)
    assert not rewards.any()
    assert not again[:, :2].any()
    assert info["parameters"]["friction.coulomb"].shape == (5,)


def test_intervals_come_from_fits_diagnoses_and_their_files(tmp_path):
    rows = {"friction.coulomb": (0.1, 0.2), "friction.viscous": (float("-inf"), float("inf"))}
    numbers = {path: FitParameter(0.1, 0.0, ends, "", "", 0.1) for path, ends in rows.items()}
    wanted = {"friction.coulomb": (0.1, 0.2)}
    assert intervals_of(replace(fitted(), parameters=numbers)) == wanted
    found = canned.diagnosis("missing_effect")
    extended = replace(found.extended, parameters=numbers)
    assert intervals_of(replace(found, extended=extended)) == wanted
    written = {"friction.coulomb": {"ci95": [0.1, 0.2]}, "friction.viscous": {"ci95": [None, None]}}
    for name, data in (("findings.json", {"extended": {"parameters": written}}),
                       ("fit.json", {"parameters": written})):  # fmt: skip
        (tmp_path / name).write_text(json.dumps(data))
        assert intervals_of(tmp_path / name) == wanted


@cache
def fitted():
    machine, source = plant(), np.random.default_rng(0)
    recordings = []
    for seed in range(2):
        effort = np.repeat(source.uniform(-0.9, 0.9, 60), 50)
        moved = machine.simulate(effort, 1e-3, outputs=["position"]).position
        read = np.concatenate([[0.0], moved[:-1]]) + 1e-6 * source.standard_normal(3000)
        recordings.append(st.Recording(1e-3 * np.arange(3000), effort, read, kind=f"{seed}"))
    return st.fit(machine, recordings)


def test_a_fit_brings_its_plant_and_its_intervals():
    env = Positioning(fitted())
    assert env.reset(seed=0)[1]["parameters"].keys() >= {"friction.coulomb", "body.inertia"}


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Positioning("plant"), "give a Plant or a Diagnosis"),
        (lambda: Positioning(plant(), {"coulomb": (0.3, 0.1)}), "ends before it begins"),
        (lambda: Positioning(plant(), {"nonsense": (0.1, 0.3)}), "nonsense"),
        (lambda: Positioning(plant(), {"coulomb": 0.3}), "no interval"),
        (lambda: Positioning(plant(drive={"gain": 1.0})), "limit is missing"),
        (lambda: Positioning(plant(), reach=0.0), "reach = 0 is none"),
        (lambda: Positioning(plant()).step(np.zeros(1)), "call reset first"),
        (lambda: intervals_of("no-such.json"), "name findings.json"),
        (lambda: Positioning(plant(), {"coulomb": (-2.0, -1.0)}).reset(), "make a motor"),
        (lambda: Positioning(plant()).reset(options={"goal": 1.0}), "goal are none"),
        (lambda: VectorPositioning(plant()).reset(seed=[1]), "one seed"),
    ],
)
def test_what_is_none_is_a_sentence(make, words):
    with pytest.raises(st.InputError, match=words):
        make()
